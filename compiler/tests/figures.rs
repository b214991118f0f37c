//! Curves, tubes, polyhedra and hulls: distances against plain methods, errors and their places.

use rayon::prelude::*;
use std::time::{Duration, Instant};
use surefoot_compiler::diagnostic::Severity;
use surefoot_compiler::evaluate::Tape;
use surefoot_compiler::figure::{Bow, Figure, Line, Stretch, closed, hull, triangles, turn};
use surefoot_compiler::graph::Function;
use surefoot_compiler::random::Random;
use surefoot_compiler::sampled::{Sign, Surface};
use surefoot_compiler::vector::{Vec3, add, cross, dot, length, mix, scale, sub};
use surefoot_compiler::verify::{Settings, WORK, verify};
use surefoot_compiler::{Compiled, MemoryLoader, Options, Outcome, compile};

const PLACES: u64 = 100_000;
/// So many random curves are swept along, unless SUREFOOT_SWEEPS says how many.
const SWEEPS: u64 = 6;

fn outcome(text: &str) -> Outcome {
    compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default())
}

fn compiled(text: &str) -> Compiled {
    let outcome = outcome(text);
    assert!(!outcome.has_errors(), "{text}: {:?}", outcome.diagnostics);
    outcome.compiled.expect("it has no error")
}

fn value(scene: &Compiled, p: Vec3) -> f64 {
    let field = scene.functions.formulas[&(scene.root, Function::Field)];
    let tape = Tape::new(&scene.graph, &scene.functions.formulas, &[field], &scene.live(), 1 << 20).unwrap();
    let mut found = 0.0;
    tape.evaluator().at(&[p], &[], |_, v| found = v[0]);
    found
}

fn point(random: &mut Random, half: f64) -> Vec3 {
    random.within(half)
}

fn curve(kind: &str, points: &[Vec3], is_closed: bool) -> Line {
    match kind {
        "bezier" => Line::bezier(points, is_closed),
        "catmull_rom" => Line::catmull_rom(points, is_closed),
        _ => Line::polyline(points, is_closed),
    }
    .unwrap()
}

/// The least way to a curve that is given by its places, of which the nearest of many is refined.
fn plain(at: &(dyn Fn(f64) -> Vec3 + Sync), coarse: &[Vec3], q: Vec3) -> f64 {
    let way = |p: Vec3| length(sub(p, q));
    let steps = coarse.len() - 1;
    let mut near: Vec<usize> = (0..=steps).filter(|&i| (i == 0 || way(coarse[i]) <= way(coarse[i - 1])) && (i == steps || way(coarse[i]) <= way(coarse[i + 1]))).collect();
    near.sort_by(|a, b| way(coarse[*a]).total_cmp(&way(coarse[*b])));
    near.iter().take(4).fold(f64::INFINITY, |best: f64, &i| {
        let [mut low, mut high] = [i.saturating_sub(1), (i + 1).min(steps)].map(|i| i as f64 / steps as f64);
        for _ in 0..60 {
            let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if way(at(a)) < way(at(b)) { high = b } else { low = a }
        }
        best.min(way(at(0.5 * (low + high))))
    })
}

/// The distance to a chain of arcs against that to the curve that was asked for, at many places.
fn tube_holds(name: &str, line: &Line, at: &(dyn Fn(f64) -> Vec3 + Sync), size: f64) {
    let figure = Figure::of_bows(&line.bows).unwrap();
    let coarse: Vec<Vec3> = (0..=800).map(|i| at(f64::from(i) / 800.0)).collect();
    let worst = (0..PLACES)
        .into_par_iter()
        .map(|i| {
            let mut random = Random(i.wrapping_mul(0x9E37_79B9_7F4A_7C15));
            let q = point(&mut random, if i % 4 == 0 { 4.0 * size } else { size });
            let found = figure.at(q);
            assert!((length(found.gradient) - 1.0).abs() < 1e-9, "{name}: {found:?}");
            let least = line.bows.iter().map(|bow| length(bow.away(q))).fold(f64::INFINITY, f64::min);
            assert!((found.value - least).abs() < 1e-12 * size.max(1.0), "{name}: the nearest piece at {q:?}");
            (found.value - plain(at, &coarse, q)).abs()
        })
        .reduce(|| 0.0, f64::max);
    println!("{name}: {} arcs, off by {:.1e} of the size", line.bows.len(), worst / size);
    assert!(worst < 1e-5 * size, "{name}: off by {worst} of {size}");
    for pair in line.bows.windows(2) {
        assert!(length(sub(pair[0].ends()[1], pair[1].ends()[0])) < 1e-9 * size, "{name}: a gap");
    }
}

/// A vector turned about an axis of length one.
fn turned(v: Vec3, axis: Vec3, angle: f64) -> Vec3 {
    let (sine, cosine) = angle.sin_cos();
    add(add(scale(v, cosine), scale(cross(axis, v), sine)), scale(axis, dot(axis, v) * (1.0 - cosine)))
}

fn cubic([a, b, c, d]: [Vec3; 4], t: f64) -> Vec3 {
    let [ab, bc, cd] = [mix(a, b, t), mix(b, c, t), mix(c, d, t)];
    mix(mix(ab, bc, t), mix(bc, cd, t), t)
}

#[test]
fn tubes_are_as_far_as_the_curves_asked_for() {
    let mut random = Random(5);
    for i in 0..4 {
        let four = [0; 4].map(|_| point(&mut random, 1.0));
        tube_holds(&format!("bezier {i}"), &curve("bezier", &four, false), &|t| cubic(four, t), 2.0);
    }
    let points: Vec<Vec3> = (0..12).map(|_| point(&mut random, 1.0)).collect();
    let at = |t: f64| {
        let t = t * 11.0;
        let i = (t as usize).min(10);
        mix(points[i], points[i + 1], t - i as f64)
    };
    tube_holds("polyline", &curve("polyline", &points, false), &at, 2.0);
    let at = |t: f64| {
        let angle = (t - 0.5) * 3.0 * std::f64::consts::TAU;
        [0.7 * angle.sin(), 0.5 * angle / std::f64::consts::TAU, 0.7 * angle.cos()]
    };
    tube_holds("helix", &Line::helix(0.7, 0.5, 3.0).unwrap(), &at, 2.0);
    let circle = Line::arc([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0]).unwrap();
    tube_holds("arc", &circle, &|t| [(t * 1.5 * std::f64::consts::PI).cos(), (t * 1.5 * std::f64::consts::PI).sin(), 0.0], 2.0);
}

#[test]
fn catmull_rom_passes_its_points_without_a_kink() {
    let mut random = Random(9);
    for is_closed in [false, true] {
        let points: Vec<Vec3> = (0..9).map(|_| point(&mut random, 1.0)).collect();
        let line = curve("catmull_rom", &points, is_closed);
        let figure = Figure::of_bows(&line.bows).unwrap();
        assert!(points.iter().all(|p| figure.at(*p).value < 1e-9), "it misses a point");
        let joints = line.bows.iter().zip(line.bows.iter().cycle().skip(1)).take(line.bows.len() - usize::from(!is_closed));
        for (a, b) in joints {
            let [end, start] = [a.at(a.half).1, b.at(-b.half).1];
            assert!(dot(end, start) > 1.0 - 1e-6, "a kink: {end:?} {start:?}");
        }
    }
}

#[test]
fn frames_stand_at_right_angles_and_do_not_spin() {
    let mut random = Random(2);
    for i in 0..20 {
        let points: Vec<Vec3> = (0..7).map(|_| point(&mut random, 1.0)).collect();
        let line = curve(if i % 2 == 0 { "catmull_rom" } else { "polyline" }, &points, i % 4 < 2);
        let frames = line.frames();
        for (bow, [start, end]) in line.bows.iter().zip(&frames) {
            for frame in [start, end] {
                let rows = [frame.x, frame.y, frame.forth];
                for (j, a) in rows.iter().enumerate() {
                    for (k, b) in rows.iter().enumerate() {
                        assert!((dot(*a, *b) - f64::from(u8::from(j == k))).abs() < 1e-9, "{frame:?}");
                    }
                }
                assert!(dot(cross(frame.x, frame.y), frame.forth) > 0.999, "left-handed");
            }
            let (axis, angle) = turn([start.x, start.y, start.forth]);
            let back = |v: Vec3| turned(v, axis, angle);
            for (unit, to) in [([1.0, 0.0, 0.0], start.x), ([0.0, 1.0, 0.0], start.y), ([0.0, 0.0, 1.0], start.forth)] {
                assert!(length(sub(back(unit), to)) < 1e-9, "the turn of {start:?} is {axis:?} by {angle}");
            }
            // What does not spin keeps its angle to the arc's axis.
            let axis = cross(bow.out, bow.forth);
            assert!((dot(start.y, axis) - dot(end.y, axis)).abs() < 1e-9, "it spins");
        }
        // The place at a share of the length, and a whole turn of a closed curve.
        let [first, last] = [0.0, 1.0].map(|share| line.at(share, &frames).unwrap());
        if line.is_closed {
            assert!(length(sub(first.at, last.at)) < 1e-9, "open");
            let smooth = i % 2 == 0;
            assert!(!smooth || length(sub(first.y, last.y)) < 1e-4, "{first:?} {last:?}");
        }
    }
}

/// The boxes and prisms of which a solid's faces are, and one that is not convex.
fn solids() -> Vec<(&'static str, Vec<Vec3>, Vec<Vec<usize>>)> {
    let prism = |outline: &[[f64; 2]]| {
        let n = outline.len();
        let at = |z: f64| outline.iter().map(move |[x, y]| [*x, *y, z]);
        let points: Vec<Vec3> = at(-0.4).chain(at(0.5)).collect();
        let sides = (0..n).map(|i| vec![i, (i + 1) % n, n + (i + 1) % n, n + i]);
        let faces: Vec<Vec<usize>> = [(0..n).collect(), (n..2 * n).collect()].into_iter().chain(sides).collect();
        (points, faces)
    };
    let star: Vec<[f64; 2]> = (0..10).map(|i| [if i % 2 == 0 { 1.0 } else { 0.35 }, f64::from(i) * 0.2 * std::f64::consts::PI]).map(|[r, a]| [r * a.sin(), r * a.cos()]).collect();
    let hook = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-0.5, 1.0], [-0.5, 0.3], [0.6, 0.3], [0.6, -0.4], [-1.0, -0.4]];
    let (star, hook) = (prism(&star), prism(&hook));
    let tent = vec![[-1.0, -0.7, -0.7], [1.0, -0.7, -0.7], [1.0, -0.7, 0.7], [-1.0, -0.7, 0.7], [0.3, 0.9, 0.1]];
    let faces = vec![vec![0, 1, 2, 3], vec![0, 1, 4], vec![1, 2, 4], vec![2, 3, 4], vec![3, 0, 4]];
    vec![("star", star.0, star.1), ("hook", hook.0, hook.1), ("tent", tent, faces)]
}

/// Distances and sides against every face in turn and the winding number.
fn solid_holds(name: &str, figure: &Figure, points: &[Vec3], faces: &[[u32; 3]]) {
    let surface = Surface::new(points, faces, Sign::Winding).unwrap();
    let worst = (0..PLACES)
        .into_par_iter()
        .map(|i| {
            let mut random = Random(i.wrapping_mul(0x9E37_79B9_7F4A_7C15));
            let q = point(&mut random, if i % 4 == 0 { 6.0 } else { 1.2 });
            let found = figure.at(q);
            let (way, winding) = surface.plain(q);
            assert!((length(found.gradient) - 1.0).abs() < 1e-9);
            if way > 1e-9 {
                assert_eq!(found.value < 0.0, winding.abs() > 0.5, "{name}: the side of {q:?}, {found:?}");
            }
            (found.value.abs() - way).abs()
        })
        .reduce(|| 0.0, f64::max);
    println!("{name}: {} triangles, off by {worst:.1e}", faces.len());
    assert!(worst < 1e-9, "{name}: off by {worst}");
}

#[test]
fn polyhedra_are_as_far_as_their_faces() {
    for (name, points, faces) in solids() {
        let cut = triangles(&points, &faces).unwrap();
        let figure = Figure::of_faces(&closed(&points, &cut).unwrap()).unwrap();
        solid_holds(name, &figure, &points, &cut);
    }
}

#[test]
fn hulls_are_convex_and_as_far_as_their_faces() {
    let mut random = Random(3);
    let cloud: Vec<Vec3> = (0..200).map(|_| point(&mut random, 1.0)).collect();
    let ball: Vec<Vec3> = (0..300).map(|_| point(&mut random, 1.0)).map(|p| scale(p, 1.0 / length(p))).collect();
    let grid: Vec<Vec3> = (0..125).map(|i| [i % 5, i / 5 % 5, i / 25].map(|c| 0.4 * f64::from(c) - 0.8)).collect();
    let tall: Vec<Vec3> = (0..40).map(|i| [(f64::from(i) * 0.7).sin(), 1e-3 * f64::from(i % 2), (f64::from(i) * 0.7).cos()]).collect();
    for (name, points) in [("cloud", cloud), ("ball", ball), ("grid", grid), ("plate", tall)] {
        let faces = hull(&points).unwrap();
        // No point is beyond a face, and each corner is a point.
        for face in &faces {
            let [a, b, c] = face.corners;
            let normal = cross(sub(b, a), sub(c, a));
            if length(normal) > 1e-9 {
                let normal = scale(normal, 1.0 / length(normal));
                assert!(points.iter().all(|p| dot(sub(*p, a), normal) < 1e-7), "{name}: a point is outside");
            }
            assert!(face.corners.iter().all(|corner| points.iter().any(|p| length(sub(*p, *corner)) < 1e-8)), "{name}: a corner of its own");
        }
        if name == "plate" {
            // So flat that what is inside is decided by less than rounding.
            continue;
        }
        let corners: Vec<Vec3> = faces.iter().flat_map(|face| face.corners).collect();
        let numbers: Vec<[u32; 3]> = (0..faces.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let figure = Figure::of_faces(&faces).unwrap();
        solid_holds(name, &figure, &corners, &numbers);
        // Points inside know how deep they are by the nearest plane.
        let middle = scale(points.iter().fold([0.0; 3], |sum, p| add(sum, *p)), 1.0 / points.len() as f64);
        assert!(figure.at(middle).value < -0.3, "{name}: {:?}", figure.at(middle));
    }
}

/// What a plane with a normal that just holds balls says of the distance to their hull: no more than it is.
fn off_plane(balls: &[(Vec3, f64)], normal: Vec3, p: Vec3) -> f64 {
    balls.iter().map(|(c, r)| dot(normal, sub(p, *c)) - r).fold(f64::INFINITY, f64::min)
}

fn direction(random: &mut Random) -> Vec3 {
    loop {
        let n = random.within(1.0);
        if (0.1..1.0).contains(&length(n)) {
            return scale(n, 1.0 / length(n));
        }
    }
}

/// The distance of a point to a hull: the most that a plane with a normal says. Searched for from all directions at once, then nearer and nearer to the best; inside, where it has several
/// maxima, to some of the best.
fn off_hull(off_plane: impl Fn(Vec3) -> f64, random: &mut Random) -> f64 {
    let mut tried: Vec<(f64, Vec3)> = (0..400).map(|_| direction(random)).map(|n| (off_plane(n), n)).collect();
    tried.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut starts: Vec<(f64, Vec3)> = Vec::new();
    for (value, n) in tried {
        if starts.iter().all(|(_, other)| dot(*other, n) < 0.97) && starts.len() < if value > 0.0 { 1 } else { 12 } {
            starts.push((value, n));
        }
    }
    let climbed = starts.into_iter().map(|(mut best, mut n)| {
        let mut reach = 0.3;
        while reach > 1e-7 {
            let moved = (0..40).map(|_| add(n, scale(direction(random), reach))).map(|n| scale(n, 1.0 / length(n)));
            let (value, found) = moved.map(|n| (off_plane(n), n)).max_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
            if value > best {
                (best, n) = (value, found);
            } else {
                reach *= 0.85;
            }
        }
        best
    });
    climbed.fold(f64::NEG_INFINITY, f64::max)
}

#[test]
fn hulls_of_shapes_are_exact() {
    let corners = |[x, y, z]: Vec3, r: f64| (0..8).map(move |i| ([x * f64::from(i & 1) - x / 2.0, y * f64::from(i >> 1 & 1) - y / 2.0, z * f64::from(i >> 2) - z / 2.0], r));
    let moved = |balls: Vec<(Vec3, f64)>, by: Vec3| balls.into_iter().map(move |(c, r)| (add(c, by), r)).collect::<Vec<_>>();
    let box_and_balls = [vec![([-0.6, 0.3, 0.0], 0.5), ([0.8, 0.7, 0.0], 0.2)], moved(corners([0.9, 0.2, 0.9], 0.0).collect(), [0.0, -0.8, 0.0])].concat();
    let hexagon = (0..6).flat_map(|i| [0.2, -0.2].map(|z| ([0.7 * (f64::from(i) * std::f64::consts::FRAC_PI_3).sin(), 0.7 * (f64::from(i) * std::f64::consts::FRAC_PI_3).cos(), z], 0.0)));
    let stone: Vec<(Vec3, f64)> = vec![([0.0, 0.0, 0.0], 0.5), ([0.7, 0.0, 0.1], 0.2), ([0.0, 0.8, 0.0], 0.1), ([-0.5, -0.5, 0.3], 0.35), ([0.1, 0.2, -0.9], 0.05), ([0.0, 0.0, 0.62], 0.02)];
    let written: String = stone.iter().map(|([x, y, z], r)| format!("sphere({r}).translate({x}, {y}, {z})")).collect::<Vec<_>>().join(" | ");
    let all: Vec<(String, Vec<(Vec3, f64)>)> = vec![
        ("hull(sphere(0.5).translate(-0.6, 0.3, 0), sphere(0.2).translate(0.8, 0.7, 0), box(0.9, 0.2, 0.9).translate(0, -0.8, 0))".into(), box_and_balls),
        // Balls of one radius in a line, in a plane and in space.
        ("hull(sphere(0.3).translate(-1, 0, 0), sphere(0.3).translate(1, 0, 0))".into(), vec![([-1.0, 0.0, 0.0], 0.3), ([1.0, 0.0, 0.0], 0.3)]),
        ("hull(sphere(0.3), sphere(0.3).translate(1, 0, 0), sphere(0.3).translate(0, 1, 0))".into(), vec![([0.0; 3], 0.3), ([1.0, 0.0, 0.0], 0.3), ([0.0, 1.0, 0.0], 0.3)]),
        ("hull(rounded_box((1.4, 0.8, 1), 0.2), capsule((0, 0, 0), (0, 1, 0.3), 0.2))".into(), [corners([1.0, 0.4, 0.6], 0.2).collect(), vec![([0.0; 3], 0.2), ([0.0, 1.0, 0.3], 0.2)]].concat()),
        ("hull(regular_polygon(6, 0.7).extrude(0.4) | sphere(0.3).translate(0, 0, 1))".into(), hexagon.chain([([0.0, 0.0, 1.0], 0.3)]).collect()),
        // A large ball with small ones on two sides, one within another, and one within the hull.
        ("hull(sphere(0.7), sphere(0.1).translate(1, 0, 0), sphere(0.2).translate(-1, 0, 0), sphere(0.3), sphere(0.05).translate(0.6, 0.3, 0))".into(), vec![([0.0; 3], 0.7), ([1.0, 0.0, 0.0], 0.1), ([-1.0, 0.0, 0.0], 0.2), ([0.6, 0.3, 0.0], 0.05)]),
        (format!("hull({written})"), stone.clone()),
        // Moved, turned, scaled and made thicker, from outside and from inside.
        (
            "hull((box(1) | sphere(0.1).translate(0, 1, 0)).rotate(z, 90deg).scale(0.5).round(0.1).translate(0.2, 0, 0))".into(),
            moved([corners([0.5; 3], 0.1).collect(), vec![([-0.5, 0.0, 0.0], 0.15)]].concat(), [0.2, 0.0, 0.0]),
        ),
        ("hull(hull(box(0.5), sphere(0.2).translate(0, 0.8, 0)), octahedron(0.6), box(0.2, 0.2, 1.6))".into(), {
            let tips = (0..6).map(|i| ([0, 1, 2].map(|axis| if i / 2 == axis { 0.6 - 1.2 * f64::from(i % 2) } else { 0.0 }), 0.0));
            [corners([0.5; 3], 0.0).collect(), vec![([0.0, 0.8, 0.0], 0.2)], tips.collect(), corners([0.2, 0.2, 1.6], 0.0).collect()].concat()
        }),
    ];
    // Drawings: theirs is the hull of discs, here extruded without an end.
    let discs = |all: &[([f64; 2], f64)]| all.iter().map(|([x, y], r)| ([*x, *y, 0.0], *r)).collect::<Vec<_>>();
    let drawings = [
        ("hull(circle(0.6), circle(0.25).translate(1.1, 0.3), circle(0.1).translate(0.2, 1))", discs(&[([0.0; 2], 0.6), ([1.1, 0.3], 0.25), ([0.2, 1.0], 0.1)])),
        ("hull(circle(0.8) | circle(0.1).translate(1, 0) | circle(0.2).translate(-1, 0), circle(0.1))", discs(&[([0.0; 2], 0.8), ([1.0, 0.0], 0.1), ([-1.0, 0.0], 0.2)])),
        (
            "hull(rectangle(1).rotate(90deg).scale(0.8), rounded_rectangle((0.4, 0.6), 0.1).translate(0, 0.7), segment((-1, 0), (-1, 0.2))).round(0.05)",
            discs(&[([0.4, 0.4], 0.05), ([-0.4, 0.4], 0.05), ([0.4, -0.4], 0.05), ([-0.4, -0.4], 0.05), ([0.1, 0.9], 0.15), ([-0.1, 0.9], 0.15), ([0.1, 0.5], 0.15), ([-0.1, 0.5], 0.15), ([-1.0, 0.0], 0.05), ([-1.0, 0.2], 0.05)]),
        ),
    ];
    let drawn = drawings.into_iter().map(|(text, discs)| (format!("{text}.extrude(40)"), discs));
    for (text, balls) in all.into_iter().chain(drawn) {
        let (text, balls) = (&text, &balls);
        let is_drawn = text.ends_with(".extrude(40)");
        let off_plane = |n: Vec3, p: Vec3| match is_drawn {
            true => off_plane(balls, scale([n[0], n[1], 0.0], 1.0 / n[0].hypot(n[1]).max(1e-12)), p),
            false => off_plane(balls, n, p),
        };
        let scene = compiled(&format!("scene = {text}"));
        assert!(scene.graph.factors.is_empty(), "{text}: {:?}", scene.graph.factors);
        let field = scene.functions.formulas[&(scene.root, Function::Field)];
        let tape = Tape::new(&scene.graph, &scene.functions.formulas, &[field], &scene.live(), 1 << 20).unwrap();
        let worst = (0..PLACES).into_par_iter().map(|i| {
            let mut random = Random(1 + i);
            let [x, y, z] = random.within(1.6);
            let p = [x, y, if is_drawn { 0.0 } else { z }];
            let mut found = 0.0;
            tape.evaluator().at(&[p], &[], |_, v| found = v[0]);
            // The search takes long: elsewhere no plane says more.
            let error = match i % 1000 {
                0 => (found - off_hull(|n| off_plane(n, p), &mut random)).abs(),
                _ => off_plane(direction(&mut random), p) - found,
            };
            (error, p)
        });
        let (error, p) = worst.reduce(|| (0.0, [0.0; 3]), |a, b| if a.0 >= b.0 { a } else { b });
        assert!(error < 1e-5, "{text}: {error} at {p:?}");
        let bounds = scene.bounds().unwrap();
        let wanted = |axis: usize, sign: f64| balls.iter().map(|(c, r)| sign * c[axis] + r).fold(f64::MIN, f64::max);
        assert!((0..if is_drawn { 2 } else { 3 }).all(|axis| (bounds[1][axis] - wanted(axis, 1.0)).abs() < 1e-3 && (bounds[0][axis] + wanted(axis, -1.0)).abs() < 1e-3), "{text}: {bounds:?}");
        let report = verify(&scene, Settings { samples: 500, certified: 4, seed: 1, work: WORK }, None, &|_| {}).unwrap();
        assert!(report.violations.is_empty(), "{text}: {:?}", report.violations);
    }
}

#[test]
fn values_within_boxes_hold() {
    let mut random = Random(17);
    let line = Line::helix(0.7, 0.5, 3.0).unwrap();
    let (_, points, faces) = solids().remove(0);
    let star = Figure::of_faces(&closed(&points, &triangles(&points, &faces).unwrap()).unwrap()).unwrap();
    for figure in [Figure::of_bows(&line.bows).unwrap(), star] {
        for _ in 0..5_000 {
            let (a, b) = (point(&mut random, 2.0), point(&mut random, 2.0));
            let (low, high) = ([0, 1, 2].map(|i| a[i].min(b[i])), [0, 1, 2].map(|i| a[i].max(b[i])));
            let [least, most] = figure.value_within(low, high);
            let q = [0, 1, 2].map(|i| low[i] + (high[i] - low[i]) * random.next());
            let value = figure.at(q).value;
            assert!(least <= value && value <= most, "{value} at {q:?} is not in {least}..{most}");
        }
    }
}

#[test]
fn an_arc_goes_through_its_points_however_flat_it_is() {
    let mut random = Random(21);
    for i in 0..2_000 {
        let (a, c) = (point(&mut random, 1.0), point(&mut random, 1.0));
        let b = add(mix(a, c, 0.2 + 0.6 * random.next()), scale(point(&mut random, 1.0), 10f64.powf(-f64::from(i % 9))));
        let bow = Bow::through(a, b, c).unwrap();
        let [from, to] = bow.ends();
        for (p, q) in [(from, a), (to, c)] {
            assert!(length(sub(p, q)) < 1e-9, "{bow:?} ends at {p:?}, not {q:?}");
        }
        assert!(length(bow.away(b)) < 1e-7, "{bow:?} misses {b:?}");
        let [low, high] = bow.bounds();
        for k in 0..=20 {
            let (p, _) = bow.at(bow.half * (f64::from(k) / 10.0 - 1.0));
            assert!((0..3).all(|i| low[i] - 1e-9 <= p[i] && p[i] <= high[i] + 1e-9), "{p:?} is not in {low:?} {high:?}");
            assert!(length(bow.away(p)) < 1e-7, "{p:?} is on it");
        }
    }
}

#[test]
fn what_is_exact_needs_no_factor() {
    for text in [
        "scene = tube(polyline([(-1, 0, 0), (0, 1, 0), (1, 0, 0.5)]), 0.2)",
        "scene = tube(bezier([(-1, 0, 0), (0, 2, 0), (1, 0, 0.5)]), 0.2)",
        "scene = tube(catmull_rom([(-1, 0, 0), (0, 1, 0), (1, 0, 0.5)], closed: true), 0.2).round(0.1)",
        "scene = tube(helix(1, 0.4, 3), 0.1)",
        "scene = tube(arc((-1, 0, 0), (0, 1, 0), (1, 0, 0.5)), 0.1)",
        "scene = polyhedron([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]])",
        "scene = hull([for i in 0..30 { hash3(i) }]).round(0.1)",
        "scene = box(0.2).along(helix(1, 0.6, 2), 12)",
    ] {
        let scene = compiled(text);
        assert!(scene.graph.factors.is_empty(), "{text}: {:?}", scene.graph.factors);
        let bounds = scene.bounds().unwrap();
        assert!(bounds.iter().flatten().all(|c| c.abs() < 1.7), "{text}: {bounds:?}");
    }
    // A radius that is a formula costs what it changes by.
    let scene = compiled("scene = tube(helix(1, 0.6, 2), 0.1 + 0.05 * sin(6 * p.y))");
    let factor = scene.graph.factors.first().map(|factor| factor.lipschitz);
    assert!(factor.is_some_and(|factor| (1.29..1.31).contains(&factor)), "{factor:?}");
}

#[test]
fn what_is_no_curve_or_solid_is_an_error_at_its_place() {
    let tetrahedron = "[(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]";
    let start = Instant::now();
    let wrong = [
        ("scene = tube(polyline([(1, 0, 0)]), 0.1)".to_owned(), "polyline"),
        ("scene = tube(polyline([(1, 0, 0), (1, 0, 0)]), 0.1)".to_owned(), "at one place"),
        ("scene = tube(polyline([(1, 0, 0), (2, 0, 0)], closed: true), 0.1)".to_owned(), "closed one needs 3"),
        ("scene = tube(bezier([(1, 0, 0), (2, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)]), 0.1)".to_owned(), "it has 5 points"),
        ("scene = tube(bezier([(1, 0, 0), (1, 0, 0), (1, 0, 0), (1, 0, 0)]), 0.1)".to_owned(), "at one place"),
        ("scene = tube(arc((0, 0, 0), (2, 0, 0), (1, 0, 0)), 0.1)".to_owned(), "lie in a line"),
        ("scene = tube(arc((0, 0, 0), (0, 0, 0), (1, 0, 0)), 0.1)".to_owned(), "at one place"),
        ("scene = tube(helix(0, 1, 3), 0.1)".to_owned(), "helix"),
        ("scene = tube(helix(1, 1, 0), 0.1)".to_owned(), "helix"),
        ("scene = tube(helix(1, 1, 1e9), 0.1)".to_owned(), "1000 are the most"),
        ("scene = tube(polyline([(1, 0, 0), (1e20, 0, 0)]), 0.1)".to_owned(), "nowhere"),
        ("scene = tube(polyline([(1, 0, 0), (sqrt(p.x), 0, 0)]), 0.1)".to_owned(), "p"),
        ("param a = 1 in 0..2\nscene = tube(polyline([(1, 0, 0), (a, 1, 0)]), 0.1)".to_owned(), "known while compiling"),
        ("scene = tube([(1, 0, 0), (2, 0, 0)], 0.1)".to_owned(), "a curve"),
        ("scene = tube(polyline([for i in 0..1000000 { (i, 0, 0) }]), 0.1)".to_owned(), ""),
        ("scene = tube(polyline([for i in 0..50000 { (i, 0, 0) }]), 0.1)".to_owned(), "are the most"),
        (format!("scene = polyhedron({tetrahedron}, [[0, 1, 2], [0, 1, 3], [0, 2, 3]])"), "faces"),
        (format!("scene = polyhedron({tetrahedron}, [[0, 1, 2], [0, 1, 3], [0, 2, 3], [0, 1, 2]])"), "an edge has two"),
        (format!("scene = polyhedron({tetrahedron}, [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2]])"), "face 3 of this solid is wrong: it has 2 corners"),
        (format!("scene = polyhedron({tetrahedron}, [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 4]])"), "it names point 4"),
        (format!("scene = polyhedron({tetrahedron}, [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 1]])"), "comes to point 1 twice"),
        ("scene = polyhedron([(0, 0, 0), (1, 0, 0), (2, 0, 0), (0, 0, 1)], [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]])".to_owned(), "no area"),
        ("scene = polyhedron([(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (0, 0, 2)], [[0, 2, 1, 3], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])".to_owned(), "is wrong"),
        ("scene = polyhedron([(-1, -1, -1), (1, -1, -1), (1, 1, 0), (-1, 1, -1), (0, 0, 2)], [[0, 1, 2, 3], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])".to_owned(), "not flat"),
        (crossed(), "go through a face"),
        ("scene = hull([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)])".to_owned(), "in one plane"),
        ("scene = hull([(0, 0, 0), (0, 0, 0), (0, 0, 0), (0, 0, 0)])".to_owned(), "at one place"),
        ("scene = hull([(0, 0, 0), (1, 0, 0), (0, 1, 0)])".to_owned(), "points"),
        ("scene = hull([for i in 0..9000 { hash3(i) }])".to_owned(), "4000"),
        ("scene = polyhedron([(-0.6, 0, -0.6), (0.6, 0, -0.6), (0, 0, 0.6), (0, 0, 0)], [[0, 1, 2], [0, 1, 3], [1, 2, 3], [2, 0, 3]])".to_owned(), "enclose nothing"),
        ("scene = hull(torus(1, 0.2), sphere(1))".to_owned(), "hull of this shape is not known"),
        ("scene = hull(sphere(1), box(1).stretch(1, 1, 8).round(0.1))".to_owned(), "hull of this shape is not known"),
        ("scene = hull(sphere(1), sphere(1) - box(1))".to_owned(), "hull of this shape is not known"),
        ("param r = 1 in 0.5..2\nscene = hull(sphere(r), box(3))".to_owned(), "hull of this shape is not known"),
        ("scene = hull(for i in 0..99 { sphere(0.1 + 0.001 * i).translate(sin(i), cos(i), 0.01 * i) })".to_owned(), "64 are the most"),
    ];
    for (text, words) in wrong {
        let found = outcome(&text).diagnostics;
        let says = |d: &surefoot_compiler::diagnostic::Diagnostic| {
            let place = text.get(d.span.start as usize..d.span.end as usize).unwrap_or("");
            d.severity == Severity::Error && (d.message.contains(words) || place.contains(words)) && !d.help.is_empty() && !place.is_empty()
        };
        assert!(found.iter().any(says), "{text}: {found:?}");
    }
    assert!(start.elapsed() < Duration::from_secs(60), "{:?}", start.elapsed());
}

/// A closed solid of two tetrahedra that go through each other.
fn crossed() -> String {
    let points = "(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0.2, 0.2, 0.2), (1.2, 0.2, 0.2), (0.2, 1.2, 0.2), (0.2, 0.2, 1.2)";
    let faces = |k: u32| format!("[{}, {}, {}], [{}, {}, {}], [{}, {}, {}], [{}, {}, {}]", k, k + 1, k + 2, k, k + 1, k + 3, k, k + 2, k + 3, k + 1, k + 2, k + 3);
    format!("scene = polyhedron([{points}], [{}, {}])", faces(0), faces(4))
}

#[test]
fn a_function_of_a_curve_takes_one() {
    compiled("shape rail(c: curve, r: float = 0.1) = tube(c, r) | sphere(2 * r).translate(c.at(0.5))\nlet way = arc((-1, 0, 0), (0, 1, 0), (1, 0, 0))\nscene = rail(way) | box(way.length).translate(0, 4, 0)");
    // One that nobody calls is read too.
    compiled("shape rail(points: [vec3]) = tube(catmull_rom(points), 0.1) | hull(points)\nscene = sphere(1)");
}

/// A random curve as text, and a drawing that is as wide as it bends.
fn random_sweep(i: u64, twist: &str) -> String {
    let mut random = Random(i);
    let points: Vec<String> = (0..4 + i % 3).map(|_| point(&mut random, 0.8)).map(|[x, y, z]| format!("({x:.3}, {y:.3}, {z:.3})")).collect();
    let kind = if i % 3 == 0 { "polyline" } else { "catmull_rom" };
    let drawing = ["rectangle((0.5, 0.1))", "circle(0.12)", "star(5, 0.2, 0.1)", "rectangle((0.1, 0.4)).translate(0.1, 0.1)"][(i % 4) as usize];
    format!("scene = {drawing}.sweep({kind}([{}], closed: {}){twist})", points.join(", "), i % 2 == 0)
}

#[test]
fn sweeps_along_random_curves_are_not_stepped_through() {
    let count = std::env::var("SUREFOOT_SWEEPS").ok().and_then(|count| count.parse().ok()).unwrap_or(SWEEPS);
    for i in 0..count {
        let text = random_sweep(i, "");
        let scene = compiled(&text);
        let report = verify(&scene, Settings { samples: 200, certified: 2, seed: i, work: WORK }, None, &|_| {}).unwrap();
        assert!(report.violations.is_empty(), "{text}: {:?}", report.violations);
        assert!(scene.graph.factors.is_empty(), "{text}: {:?}", scene.graph.factors);
    }
}

#[test]
fn twisted_sweeps_are_not_stepped_through() {
    let count = std::env::var("SUREFOOT_SWEEPS").ok().and_then(|count| count.parse().ok()).unwrap_or(SWEEPS);
    for i in 0..count {
        let twist = 400.0 * (i % 5) as f64 - 700.0;
        let text = random_sweep(i, &format!(", {twist}deg"));
        let scene = compiled(&text);
        let report = verify(&scene, Settings { samples: 200, certified: 2, seed: i, work: WORK }, None, &|_| {}).unwrap();
        assert!(report.violations.is_empty(), "{text}: {:?}", report.violations);
    }
}

#[test]
fn a_twist_turns_the_drawing_on_the_way() {
    let curves = ["polyline([(-1, 0, 0), (1, 0.5, 0.3)])", "arc((-1, 0, 0), (0, 1, 0.2), (1, 0, 0))", "catmull_rom([(-1, 0, 0), (0, 0.5, 0.3), (1, 0, 0)])"];
    let lines = [
        Line::polyline(&[[-1.0, 0.0, 0.0], [1.0, 0.5, 0.3]], false),
        Line::arc([-1.0, 0.0, 0.0], [0.0, 1.0, 0.2], [1.0, 0.0, 0.0]),
        Line::catmull_rom(&[[-1.0, 0.0, 0.0], [0.0, 0.5, 0.3], [1.0, 0.0, 0.0]], false),
    ];
    for (curve, line) in curves.iter().zip(lines) {
        let line = line.unwrap();
        let scene = compiled(&format!("scene = circle(0.05).translate(0.2, 0).sweep({curve}, 500deg)"));
        for share in [0.02, 0.2, 0.5, 0.77, 0.98] {
            let frame = line.at(share, &line.frames()).unwrap();
            let at = |angle: f64| value(&scene, add(frame.at, scale(add(scale(frame.x, angle.cos()), scale(frame.y, angle.sin())), 0.2)));
            let turned = share * 500f64.to_radians();
            assert!(at(turned) < -1e-3 && at(turned + 0.5) > 0.0 && at(turned - 0.5) > 0.0, "{curve} at {share}: {} {} {}", at(turned), at(turned + 0.5), at(turned - 0.5));
        }
        let factor = scene.graph.factors.iter().map(|factor| factor.lipschitz).fold(1.0, f64::max);
        let least = (1.0 + (0.25 * 500f64.to_radians() / line.length()).powi(2)).sqrt();
        assert!(factor >= least * 0.999, "{curve}: {factor} is below {least}");
        // A straight piece has no more than the formula says; the disc about the drawing is a little larger than 0.25.
        assert!(!curve.starts_with("polyline") || factor <= least * 1.02, "{curve}: {factor} is above {least}");
    }
}

#[test]
fn a_drawing_shrinks_to_a_part_of_its_size() {
    let scene = compiled("scene = rectangle((2, 1)).extrude_to(2, 0)");
    for (p, solid) in [([0.9, 0.4, -0.95], true), ([0.0, 0.0, 0.9], true), ([0.4, 0.2, 0.0], true), ([0.55, 0.0, 0.0], false), ([0.0, 0.3, 0.0], false), ([0.1, 0.0, 0.9], false), ([0.0, 0.0, 1.05], false)] {
        assert_eq!(value(&scene, p) < 0.0, solid, "{p:?}: {}", value(&scene, p));
    }
}

#[test]
fn stretches_of_a_sweep_meet() {
    let mut random = Random(41);
    for i in 0..30 {
        let points: Vec<Vec3> = (0..6).map(|_| point(&mut random, 1.0)).collect();
        let line = curve(if i % 2 == 0 { "catmull_rom" } else { "polyline" }, &points, i % 4 < 2);
        let (all, kinks) = line.stretches(1.0);
        // Where a curve turns back it has flat ends.
        let bends = line.bows.iter().zip(line.bows.iter().cycle().skip(1)).take(line.bows.len() - usize::from(!line.is_closed));
        let mitred = bends.filter(|(a, b)| (-0.9..1.0 - 1e-7).contains(&dot(a.at(a.half).1, b.at(-b.half).1))).count();
        assert_eq!(kinks.len(), if i % 2 == 1 { mitred } else { 0 }, "kinks");
        for stretch in &all {
            // The middle of each lies between its planes.
            assert!(stretch.ends.iter().all(|(out, far)| dot(*out, stretch.bow.middle) < *far), "{stretch:?}");
        }
        for pair in all.windows(2) {
            // Beside the joint, where one ends the other has begun, turned alike.
            let [one, other] = [pair[0], pair[1]];
            let at = one.bow.ends()[1];
            assert!(dot(one.ends[1].0, at) <= one.ends[1].1 + 1e-9 && dot(other.ends[0].0, at) <= other.ends[0].1 + 1e-9, "a gap at {at:?}");
            if i % 2 == 0 && !line.is_closed {
                let y = |stretch: &Stretch, way: f64| {
                    let bow = stretch.bow;
                    let angle = stretch.turn;
                    let out = add(scale(bow.out, (bow.bend * way).cos()), scale(bow.forth, (bow.bend * way).sin()));
                    add(scale(cross(bow.out, bow.forth), angle.sin()), scale(out, angle.cos()))
                };
                let (a, b) = (y(&one, one.bow.half), y(&other, -other.bow.half));
                assert!(length(sub(a, b)) < 1e-3, "it is turned from {a:?} to {b:?}");
            }
        }
    }
}

#[test]
fn a_revolution_by_an_angle_ends_there() {
    for (angle, inside, outside) in [(90.0, 45.0, 135.0), (210.0, 200.0, 220.0), (350.0, 345.0, 355.0), (360.0, 359.9, 400.0)] {
        let scene = compiled(&format!("scene = circle(0.3).translate(0.7, 0).revolve({angle}deg)"));
        assert!(scene.graph.factors.is_empty(), "{:?}", scene.graph.factors);
        let at = |degrees: f64| {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            value(&scene, [0.7 * cosine, 0.0, -0.7 * sine])
        };
        assert!(at(inside) < -1e-4, "{angle}: {}", at(inside));
        assert!(angle == 360.0 || at(outside) > 1e-4, "{angle}: {}", at(outside));
    }
}
