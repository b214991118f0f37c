//! Meshes as grids of distances: exact at the samples, the right side, bounds that hold, and files that may be broken.

use rayon::prelude::*;
use std::panic::catch_unwind;
use surefoot_compiler::sampled::{Findings, Grid, MOST_TRIANGLES, Settings, Sign, Surface, bake, measure};
use surefoot_tests::solids::{Solid, cuboid, knot, sphere};

type Vec3 = [f64; 3];

/// A mesh.
#[derive(Clone)]
struct Made {
    corners: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

impl Made {
    fn surface(&self, sign: Sign) -> Surface {
        Surface::new(&self.corners, &self.triangles, sign).unwrap()
    }

    fn with(mut self, other: Made) -> Self {
        let first = self.corners.len() as u32;
        self.corners.extend(other.corners);
        self.triangles.extend(other.triangles.into_iter().map(|t| t.map(|i| i + first)));
        self
    }

    fn moved(mut self, by: Vec3, times: f64) -> Self {
        for corner in &mut self.corners {
            *corner = [0, 1, 2].map(|i| corner[i] * times + by[i]);
        }
        self
    }

    fn turned(mut self) -> Self {
        self.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        self
    }
}

impl From<Solid> for Made {
    fn from(solid: Solid) -> Self {
        Self { corners: solid.corners.iter().map(|c| c.map(f64::from)).collect(), triangles: solid.triangles }
    }
}

fn ball() -> Made {
    sphere(8).into()
}

fn cube(size: f32) -> Made {
    cuboid([size; 3]).into()
}

fn torus() -> Made {
    let (along, around) = (20u32, 10u32);
    let mut made = Made { corners: Vec::new(), triangles: Vec::new() };
    for i in 0..along {
        for j in 0..around {
            let [a, b] = [(i, along), (j, around)].map(|(i, n)| std::f64::consts::TAU * f64::from(i) / f64::from(n));
            let out = 1.0 + 0.4 * b.cos();
            made.corners.push([out * a.cos(), out * a.sin(), 0.4 * b.sin()]);
            let at = |i: u32, j: u32| i % along * around + j % around;
            let [p, q, r, s] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            made.triangles.extend([[p, q, r], [p, r, s]]);
        }
    }
    made
}

/// The half of a ball that lies above y = 0.
fn bowl() -> Made {
    let mut made = ball();
    let above = |t: &[u32; 3]| t.iter().all(|i| made.corners[*i as usize][1] > -1e-6);
    made.triangles = made.triangles.iter().copied().filter(above).collect();
    made
}

/// A strip of triangles that are thirty thousand times as long as high.
fn needles() -> Made {
    let mut made = Made { corners: Vec::new(), triangles: Vec::new() };
    for i in 0..20 {
        let x = 3e-5 * f64::from(i);
        made.corners.extend([[x, 0.0, 0.1 * x], [x + 1e-5, 1.0, 0.0]]);
    }
    made.triangles = (0..38).map(|i| if i % 2 == 0 { [i, i + 1, i + 2] } else { [i, i + 2, i + 1] }).collect();
    made
}

/// Meshes with a name.
fn meshes() -> Vec<(&'static str, Made)> {
    let mut branching = cube(1.0);
    branching.corners.push([0.0, 2.0, 0.0]);
    branching.triangles.push([0, 1, 8]);
    vec![
        ("ball", ball()),
        ("torus", torus()),
        ("cube", cube(1.0)),
        ("knot", knot(0.3, 60, 6).into()),
        ("bowl, open", bowl()),
        ("branching", branching),
        ("two balls", ball().with(ball().moved([2.5, 0.3, 0.0], 0.7))),
        ("ball with a hollow", ball().with(cube(0.5).turned())),
        ("ball in a ball", ball().with(cube(0.5))),
        ("balls that cross", ball().with(ball().moved([0.7, 0.1, 0.2], 0.8))),
        ("cube, inside out", cube(1.0).turned()),
        ("sheet", Made { corners: vec![[0.0; 3], [1.0, 0.0, 0.2], [1.0, 1.0, 0.0], [0.0, 1.0, 0.1]], triangles: vec![[0, 1, 2], [0, 2, 3]] }),
        ("thin plate", Made::from(cuboid([1.0, 0.001, 1.0]))),
        ("needles", needles()),
        ("far away", torus().moved([1e6, -3e5, 1e4], 0.1)),
    ]
}

fn chance(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

fn size(surface: &Surface) -> f64 {
    let [low, high] = surface.bounds();
    (0..3).map(|i| high[i] - low[i]).fold(0.0, f64::max)
}

/// So many places in the box about a mesh and somewhat beyond.
fn places(surface: &Surface, count: usize) -> Vec<Vec3> {
    let [low, high] = surface.bounds();
    let mut chance = chance(count as u64);
    let room = 0.1 * size(surface);
    (0..count).map(|_| [0, 1, 2].map(|i| low[i] - room + (high[i] - low[i] + 2.0 * room) * chance())).collect()
}

#[test]
fn samples_are_those_of_the_plain_method() {
    for (name, made) in meshes() {
        let surface = made.surface(Sign::Auto);
        let grid = bake(&surface, Settings { resolution: 32, padding: 0.05 }, &|_| {}).unwrap();
        let samples = grid.samples();
        assert!(samples.len() > 500, "{name}: {} samples", samples.len());
        let most = 1e-6 * size(&surface);
        // A third of them: the others are no different.
        samples.par_iter().step_by(3).for_each(|(at, value)| {
            let p = grid.shape().at(*at);
            let (distance, winding) = surface.plain(p);
            assert!((f64::from(value.abs()) - distance).abs() < most, "{name}: {value} and {distance} at {p:?}");
            let inside = winding.abs() >= 0.5;
            // At a half itself a hole has no side.
            assert!(distance < most || (*value < 0.0) == inside || (winding.abs() - 0.5).abs() < 0.02, "{name}: {value} and {winding} at {p:?}");
            // Read again at the same place, but for the last digits of that.
            let rounded = 4.0 * f64::EPSILON * p.iter().fold(2.0 * size(&surface), |most: f64, c| most.max(c.abs()));
            assert!((grid.value(p) - f64::from(*value)).abs() <= rounded, "{name}: {} and {value} at {p:?}", grid.value(p));
        });
    }
}

/// The distance to a triangle by searching it, not by its regions.
#[test]
fn the_closest_point_is_the_closest() {
    let mut chance = chance(3);
    let mut point = |size: f64| [0; 3].map(|_| size * (2.0 * chance() - 1.0));
    for turn in 0..2000 {
        // Every fourth is a needle.
        let a = point(1.0);
        let b = point(1.0);
        let c = if turn % 4 == 0 { let d = point(1e-6); [0, 1, 2].map(|i| 0.3 * a[i] + 0.7 * b[i] + d[i]) } else { point(1.0) };
        let p = point(1.5);
        let triangle = surefoot_compiler::sampled::Triangle::new([a, b, c]);
        let (found, at, _) = triangle.closer(p, f64::INFINITY).unwrap();
        let away = |q: Vec3| (0..3).map(|i| (q[i] - p[i]).powi(2)).sum::<f64>();
        assert!((away(at).sqrt() - found.sqrt()).abs() < 1e-9, "{triangle:?} {p:?}");
        // Ever smaller steps in barycentric coordinates, along each side and each way across.
        let place = |[u, v]: [f64; 2]| [0, 1, 2].map(|i| a[i] + u * (b[i] - a[i]) + v * (c[i] - a[i]));
        let inside = |[u, v]: [f64; 2]| u >= 0.0 && v >= 0.0 && u + v <= 1.0;
        let (mut best, mut step) = ([1.0 / 3.0; 2], 0.25);
        while step > 1e-6 {
            let ways = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [0.3, -1.0], [-0.7, 1.0]];
            let next = ways.map(|w| [best[0] + step * w[0], best[1] + step * w[1]]).into_iter().filter(|q| inside(*q) && away(place(*q)) < away(place(best)));
            match next.min_by(|a, b| away(place(*a)).total_cmp(&away(place(*b)))) {
                Some(next) => best = next,
                None => step *= 0.5,
            }
        }
        let searched = away(place(best)).sqrt();
        assert!(found.sqrt() <= searched + 1e-9 && searched <= found.sqrt() + 1e-3, "{triangle:?} {p:?}: {} and {searched}", found.sqrt());
    }
}

/// Sides at places of the box about closed meshes, by each method, against winding numbers by each triangle in turn.
#[test]
fn every_method_finds_the_side_of_what_is_closed() {
    for (name, made) in [("ball", ball()), ("torus", torus()), ("cube", cube(1.0)), ("hollow", ball().with(cube(0.5).turned()))] {
        let plain = made.surface(Sign::Auto);
        assert_eq!(plain.sign, Sign::Pseudonormal, "{name}");
        let all = places(&plain, 100_000);
        let truth: Vec<bool> = all.par_iter().map(|p| plain.plain(*p).1 >= 0.5).collect();
        for (sign, surface) in [Sign::Pseudonormal, Sign::Winding, Sign::Parity].map(|sign| (sign, made.surface(sign))) {
            let wrong = all.par_iter().zip(&truth).filter(|(p, inside)| (surface.signed(**p, &mut 0) < 0.0) != **inside).count();
            assert_eq!(wrong, 0, "{name} by {}", sign.name());
        }
    }
}

/// Broken meshes, each with the whole one that a person means, and the least share of places whose side is right by pseudonormals, winding numbers, parity.
#[test]
fn sides_of_what_is_broken_are_mostly_right() {
    let mut holed = ball();
    holed.triangles.retain(|t| t.iter().sum::<u32>() % 11 != 0);
    let mut mixed = ball();
    mixed.triangles.iter_mut().step_by(3).for_each(|t| t.swap(0, 1));
    let doubled = Made { triangles: ball().triangles.into_iter().flat_map(|[a, b, c]| [[a, b, c], [c, b, a]]).collect(), ..ball() };
    let crossing = ball().with(ball().moved([0.7, 0.1, 0.2], 0.8));
    let rows = [
        ("holes", holed, ball(), [0.9, 0.97, 0.9]),
        ("faces turned", mixed, ball(), [1.0; 3]),
        ("doubled", doubled, ball(), [1.0; 3]),
        ("crossing", crossing.clone(), crossing, [0.9, 1.0, 0.8]),
        ("one in another", ball().with(cube(0.5)), ball(), [0.5, 1.0, 0.9]),
    ];
    println!("mesh | pseudonormal | winding | parity | auto");
    for (name, made, whole, least) in &rows {
        let whole = whole.surface(Sign::Winding);
        let all = places(&made.surface(Sign::Winding), 8_000);
        let truth: Vec<bool> = all.par_iter().map(|p| whole.plain(*p).1.abs() >= 0.5).collect();
        let share = |sign: Sign| {
            let surface = made.surface(sign);
            let right = all.par_iter().zip(&truth).filter(|(p, inside)| (surface.signed(**p, &mut 0) < 0.0) == **inside).count();
            right as f64 / all.len() as f64
        };
        let shares = [Sign::Pseudonormal, Sign::Winding, Sign::Parity].map(share);
        let auto = share(Sign::Auto);
        println!("{name} | {:.4} | {:.4} | {:.4} | {auto:.4}", shares[0], shares[1], shares[2]);
        for (share, least) in shares.iter().zip(least) {
            assert!(share >= least, "{name}: {shares:?}");
        }
        assert!(auto >= shares[0].max(shares[1]) - 1e-9, "{name}: auto {auto} of {shares:?}");
    }
}

#[test]
fn what_is_wrong_is_found() {
    let found = |made: Made| made.surface(Sign::Auto).findings;
    let near = |a: Option<f64>, b: f64| a.is_some_and(|a| (a - b).abs() < 1e-6);
    let of_cube = Findings { vertices: 8, triangles: 12, shells: 1, ..Findings::default() };
    let cubed = found(cube(1.0));
    assert!(near(cubed.volume, 1.0));
    assert_eq!(cubed, Findings { volume: cubed.volume, ..of_cube.clone() });
    // Each triangle with corners of its own, as an STL file has them.
    let corners = cube(1.0).triangles.iter().flatten().map(|i| cube(1.0).corners[*i as usize]).collect();
    let soup = Made { corners, triangles: (0..12).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect() };
    assert_eq!(found(soup).vertices, 8);
    let mut open = cube(1.0);
    open.triangles.pop();
    assert_eq!(found(open), Findings { open_edges: 3, triangles: 11, ..of_cube.clone() });
    let mut one = cube(1.0);
    one.triangles[4].swap(0, 1);
    let one = found(one);
    assert!(one.turned == 1 && near(one.volume, 1.0), "{one:?}");
    let over = found(cube(1.0).turned());
    assert!(over.inside_out == 1 && over.turned == 0 && near(over.volume, 1.0), "{over:?}");
    let mut twice = cube(1.0);
    twice.triangles.push([0, 4, 6]);
    twice.triangles.push([1, 1, 2]);
    let twice = found(twice);
    assert!(twice.duplicates == 1 && twice.flat == 1 && twice.is_closed() && !twice.is_oriented(), "{twice:?}");
    let hollow = found(ball().with(cube(0.5).turned()));
    assert!(hollow.shells == 2 && hollow.overlapping == 0 && hollow.inside_out == 0, "{hollow:?}");
    assert_eq!(found(ball().with(cube(0.5))).overlapping, 1);
    assert!(found(ball().with(ball().moved([0.7, 0.1, 0.2], 0.8))).crossing_edges > 10);
    // Two cubes that touch at a corner, and two at an edge.
    assert_eq!(found(cube(1.0).with(cube(1.0).moved([1.0; 3], 1.0))).pinched, 1);
    assert_eq!(found(cube(1.0).with(cube(1.0).moved([1.0, 1.0, 0.0], 1.0))).branching_edges, 1);
    assert!(found(needles()).needles == 38);
    // A strip of three quads, turned by half before it is closed.
    let corners = (0..6).map(|i| { let a = f64::from(i / 2) * 2.1; [a.cos(), a.sin(), f64::from(i % 2) * 0.3 + 0.01 * f64::from(i)] }).collect();
    let strip = Made { corners, triangles: vec![[0, 2, 1], [1, 2, 3], [2, 4, 3], [3, 4, 5], [4, 1, 5], [5, 1, 0]] };
    assert!(found(strip).one_sided_edges > 0);
}

#[test]
fn what_is_no_mesh_is_an_error_with_its_place() {
    let refused = |corners: &[Vec3], triangles: &[[u32; 3]]| Surface::new(corners, triangles, Sign::Auto).unwrap_err();
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    assert_eq!(refused(&corners, &[]), "it has no triangles");
    assert_eq!(refused(&corners, &[[0, 1, 2], [0, 1, 7]]), "triangle 2 names vertex 8, and there are 3");
    assert_eq!(refused(&[[0.0; 3], [f64::NAN; 3], [1.0; 3]], &[[0, 1, 2]]), "vertex 2 is nowhere: a coordinate is not a number, or too large");
    assert!(refused(&corners, &vec![[0, 1, 2]; MOST_TRIANGLES + 1]).contains("4000001 triangles, and 4000000 triangles are the most"));
    assert_eq!(refused(&[[2.0; 3]], &[[0, 0, 0]]), "all of it is at one place");
    let surface = cube(1.0).surface(Sign::Auto);
    assert!(bake(&surface, Settings { resolution: 4, padding: 0.05 }, &|_| {}).is_err());
    assert!(bake(&surface, Settings { resolution: 32, padding: 0.0 }, &|_| {}).is_err());
    let nowhere = cube(1.0).moved([9e14; 3], 1.0);
    assert!(nowhere.surface(Sign::Auto).bounds() == [[9e14 - 0.5; 3], [9e14 + 0.5; 3]]);
    let fine = Settings { resolution: 32, padding: 0.05 };
    assert!(bake(&nowhere.surface(Sign::Auto), fine, &|_| {}).unwrap_err().contains("too small for where it stands"));
}

/// The value changes no faster than the constants say, across bricks too, and never exceeds the distance by more than is said.
#[test]
fn constants_and_errors_hold() {
    for (name, made) in meshes() {
        let surface = made.surface(Sign::Auto);
        let grid = bake(&surface, Settings { resolution: 48, padding: 0.2 }, &|_| {}).unwrap();
        for measured in measure(&grid, &surface, 4_000) {
            assert_eq!(measured.unsound, 0.0, "{name}: {measured:?}");
        }
        let shape = grid.shape();
        let steepest = grid.facts().iter().map(|f| f64::from(f.lipschitz)).fold(1.0, f64::max);
        let mut chance = chance(5);
        let end = shape.end();
        for _ in 0..10_000 {
            let p: Vec3 = [0, 1, 2].map(|i| shape.origin[i] + (end[i] - shape.origin[i]) * (1.4 * chance() - 0.2));
            let step = shape.cell * chance() * 2.0;
            let q: Vec3 = p.map(|c| c + step * (chance() - 0.5));
            let way = (0..3).map(|i| (p[i] - q[i]).powi(2)).sum::<f64>().sqrt();
            let (a, b) = (grid.value(p), grid.value(q));
            assert!((a - b).abs() <= steepest * way + 1e-6 * size(&surface), "{name}: {a} at {p:?}, {b} at {q:?}, {steepest}");
            // Outside of the grid it is no more than the distance and the error at the wall.
            let wall: Vec3 = [0, 1, 2].map(|i| p[i].clamp(shape.origin[i], end[i]));
            if wall != p {
                let most = surface.plain(p).0 + f64::from(grid.facts_at(wall).excess);
                assert!(a > 0.0 && a <= most, "{name}: {a} at {p:?}, and {most} at most");
            }
        }
    }
}

#[test]
fn a_file_says_what_the_grid_said() {
    for (name, made) in meshes() {
        let grid = bake(&made.surface(Sign::Auto), Settings { resolution: 16, padding: 0.05 }, &|_| {}).unwrap();
        assert_eq!(Grid::from_bytes(&grid.to_bytes()), Ok(grid), "{name}");
    }
}

/// Files that are cut, longer, or changed by chance: an error or a grid, never a panic.
#[test]
fn no_file_stops_the_reader() {
    let grid = bake(&cube(1.0).surface(Sign::Auto), Settings { resolution: 16, padding: 0.05 }, &|_| {}).unwrap();
    let bytes = grid.to_bytes();
    for length in (0..64).chain([bytes.len() / 2, bytes.len() - 1]) {
        assert!(Grid::from_bytes(&bytes[..length]).is_err(), "cut after {length}");
    }
    assert!(Grid::from_bytes(&[bytes.as_slice(), &[0]].concat()).is_err());
    let put = |at: usize, new: &[u8]| {
        let mut bytes = bytes.clone();
        bytes[at..at + new.len()].copy_from_slice(new);
        Grid::from_bytes(&bytes)
    };
    // Another file, version, size of bricks; no bricks or too many; nowhere; not a number in a sample, an index that is none.
    let wrong: [(usize, &[u8]); 9] = [
        (0, b"X"),
        (6, &[2]),
        (8, &[9]),
        (12, &[0; 4]),
        (12, &[255; 12]),
        (24, &[255; 4]),
        (28, &f64::NAN.to_le_bytes()),
        (52, &0f64.to_le_bytes()),
        (60, &f32::NAN.to_le_bytes()),
    ];
    for (at, new) in wrong {
        assert!(put(at, new).is_err(), "{new:?} at {at}");
    }
    let mut chance = chance(9);
    let mut good = 0;
    for _ in 0..60 {
        let mut bytes = bytes.clone();
        for _ in 0..3 {
            // Half of them in the header.
            let length = if chance() < 0.5 { 60 } else { bytes.len() };
            bytes[(chance() * length as f64) as usize] = (chance() * 256.0) as u8;
        }
        let read = catch_unwind(|| Grid::from_bytes(&bytes).map(|grid| grid.value([0.1, 0.2, 0.3]))).unwrap();
        good += usize::from(read.is_ok());
    }
    println!("{good} of 60 changed files were still grids");
}
