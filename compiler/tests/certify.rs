//! The oracle is held to what is known in closed form: roots along rays, suprema of gradients, distances.

use crate::common::Disk;
use surefoot_compiler::certify::{Ball, Box3, Claim, Hit, Truth, falsify};
use surefoot_compiler::evaluate::Tape;
use surefoot_compiler::graph::Function;
use surefoot_compiler::graph::interval::Interval;
use surefoot_compiler::camera::Basis;
use surefoot_compiler::reference_text::{CHAPTERS, entries};
use surefoot_compiler::random::Random;
use surefoot_compiler::{Compiled, MemoryLoader, Options, compile};

fn scene(text: &str) -> Compiled {
    let outcome = compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default());
    outcome.compiled.unwrap_or_else(|| {
        panic!("{text}: {}", surefoot_compiler::diagnostic::render(&outcome.sources, &outcome.diagnostics, false))
    })
}

fn truth(text: &str) -> Truth {
    let scene = scene(text);
    Truth::new(&scene, &scene.live(), 1_000_000).unwrap()
}

fn cube(half: f64) -> Box3 {
    [Interval { lo: -half, hi: half }; 3]
}

/// How many of something are tried: by the environment, or by default.
fn asked(name: &str, otherwise: u32) -> u32 {
    std::env::var(name).ok().and_then(|s| s.parse().ok()).unwrap_or(otherwise)
}

/// Rays for each shape; `SUREFOOT_RAYS` raises it.
fn rays() -> usize {
    asked("SUREFOOT_RAYS", 2000) as usize
}

/// Where a ray enters and leaves an interval of each of some convex conditions, first and last of all.
fn slabs(parts: &[Option<(f64, f64)>]) -> Option<f64> {
    let mut span = (f64::NEG_INFINITY, f64::INFINITY);
    for part in parts {
        let (a, b) = (*part)?;
        span = (span.0.max(a), span.1.min(b));
    }
    (span.0 < span.1).then_some(span.0)
}

/// Where |o + t d|² < r² over some of the axes.
fn round(o: [f64; 3], d: [f64; 3], axes: &[usize], r: f64) -> Option<(f64, f64)> {
    let sum = |f: &dyn Fn(usize) -> f64| axes.iter().map(|&i| f(i)).sum::<f64>();
    let (a, b, c) = (sum(&|i| d[i] * d[i]), sum(&|i| o[i] * d[i]), sum(&|i| o[i] * o[i]) - r * r);
    let root = b * b - a * c;
    (root > 0.0).then(|| ((-b - root.sqrt()) / a, (-b + root.sqrt()) / a))
}

fn slab(o: f64, d: f64, half: f64) -> Option<(f64, f64)> {
    let (a, b) = ((-half - o) / d, (half - o) / d);
    Some((a.min(b), a.max(b)))
}

/// Where a polynomial, lowest power first, changes its sign within `span`, rising: between the roots of its derivative it is monotone.
fn roots(polynomial: &[f64], span: (f64, f64)) -> Vec<f64> {
    let derivative: Vec<f64> = (1..polynomial.len()).map(|i| polynomial[i] * i as f64).collect();
    let mut ends = vec![span.0];
    if derivative.len() > 1 {
        ends.extend(roots(&derivative, span));
    }
    ends.push(span.1);
    let value = |t: f64| polynomial.iter().rev().fold(0.0, |sum, c| sum * t + c);
    let crossed = ends.windows(2).filter(|w| value(w[0]) * value(w[1]) < 0.0);
    let bisected = crossed.map(|w| {
        let (mut lo, mut hi, before) = (w[0], w[1], value(w[0]) > 0.0);
        for _ in 0..80 {
            let middle = 0.5 * (lo + hi);
            if (value(middle) > 0.0) == before { lo = middle } else { hi = middle }
        }
        0.5 * (lo + hi)
    });
    bisected.collect()
}

/// The first root of the quartic of a torus about the y axis: (|p|² + R² - r²)² = 4 R² (x² + z²).
fn torus(o: [f64; 3], d: [f64; 3], major: f64, minor: f64) -> Option<f64> {
    // From the ray's point nearest to the centre the coefficients are small.
    let start = -[0, 1, 2].map(|i| o[i] * d[i]).iter().sum::<f64>();
    let o = [0, 1, 2].map(|i| o[i] + start * d[i]);
    let sum = |f: &dyn Fn(usize) -> f64, axes: &[usize]| axes.iter().map(|&i| f(i)).sum::<f64>();
    let all = [0, 1, 2];
    let (a, b) = (sum(&|i| d[i] * d[i], &all), 2.0 * sum(&|i| o[i] * d[i], &all));
    let c = sum(&|i| o[i] * o[i], &all) + major * major - minor * minor;
    let flat = 4.0 * major * major;
    let quartic = [
        c * c - flat * sum(&|i| o[i] * o[i], &[0, 2]),
        2.0 * b * c - flat * 2.0 * sum(&|i| o[i] * d[i], &[0, 2]),
        b * b + 2.0 * a * c - flat * sum(&|i| d[i] * d[i], &[0, 2]),
        2.0 * a * b,
        a * a,
    ];
    roots(&quartic, (-2.0 * (major + minor), 2.0 * (major + minor))).first().map(|t| t + start)
}

#[test]
fn first_hits_agree_with_roots_in_closed_form() {
    type Root = fn([f64; 3], [f64; 3]) -> Option<f64>;
    let shapes: [(&str, Root); 6] = [
        ("scene = sphere(1)", |o, d| slabs(&[round(o, d, &[0, 1, 2], 1.0)])),
        ("scene = box((2, 1, 1.5))", |o, d| slabs(&[slab(o[0], d[0], 1.0), slab(o[1], d[1], 0.5), slab(o[2], d[2], 0.75)])),
        ("scene = cylinder(0.75, 1.5)", |o, d| slabs(&[round(o, d, &[0, 2], 0.75), slab(o[1], d[1], 0.75)])),
        ("scene = torus(0.75, 0.25)", |o, d| torus(o, d, 0.75, 0.25)),
        ("scene = plane(y, -0.5)", |o, d| if d[1] < 0.0 { Some((-0.5 - o[1]) / d[1]) } else { None }),
        // The ray crosses the borders of many cells.
        ("scene = sphere(0.25).repeat((0.625, 0, 0.625))", |o, d| {
            let cells = (-40..=40).flat_map(|x| (-40..=40).map(move |z| [f64::from(x), 0.0, f64::from(z)]));
            let first = |cell: [f64; 3]| slabs(&[round([0, 1, 2].map(|i| o[i] - 0.625 * cell[i]), d, &[0, 1, 2], 0.25)]);
            cells.filter_map(first).filter(|t| *t > 0.0).min_by(f64::total_cmp)
        }),
    ];
    for (text, root) in shapes {
        let truth = truth(text);
        let mut prover = truth.prover();
        let mut random = Random(7);
        let (mut hits, mut ambiguous, mut wrong) = (0, 0, Vec::new());
        for _ in 0..rays() {
            let (mut from, to) = (random.within(1.0), random.within(0.9));
            let length = from.iter().map(|x| x * x).sum::<f64>().sqrt().max(0.1);
            from = from.map(|x| 3.0 * x / length);
            from[1] = from[1].abs() + 0.8;
            let toward = [0, 1, 2].map(|i| to[i] - from[i]);
            let length = toward.iter().map(|x| x * x).sum::<f64>().sqrt();
            let direction = toward.map(|x| x / length);
            let expected = root(from, direction).filter(|t| *t < 20.0);
            match (prover.first_hit(from, direction, 0.0, 20.0, 20_000), expected) {
                (Hit::Hit(t), Some(root)) if (t - root).abs() <= 1e-9 => hits += 1,
                (Hit::Miss, None) => {}
                (Hit::Ambiguous(_), _) => ambiguous += 1,
                (found, expected) => wrong.push(format!("from {from:?} to {to:?}: {found:?}, not {expected:?}")),
            }
        }
        println!("{text}: {hits} hits, {ambiguous} ambiguous, {:.1} segments a ray", prover.boxes() as f64 / rays() as f64);
        assert!(hits > rays() / 4 && ambiguous * 1000 <= rays() && wrong.is_empty(), "{text}: {ambiguous} {wrong:?}");
    }
}

/// Rays along faces, through corners and edges, and tangent: what only touches is ambiguous just there, and a hair beside it is not.
#[test]
fn a_ray_that_touches_is_ambiguous_and_one_beside_it_is_not() {
    let (x, down) = ([1.0, 0.0, 0.0], [0.0, -1.0, 0.0]);
    let cases: [(&str, [f64; 3], [f64; 3], Hit); 22] = [
        ("box((2, 1, 1.5))", [-3.0, 0.5, 0.0], x, Hit::Ambiguous(2.0)),
        ("box((2, 1, 1.5))", [-3.0, 0.5 + 1e-6, 0.0], x, Hit::Miss),
        ("box((2, 1, 1.5))", [-3.0, 0.5 - 1e-6, 0.0], x, Hit::Hit(2.0)),
        // Along an edge.
        ("box((2, 1, 1.5))", [-3.0, 0.5, 0.75], x, Hit::Ambiguous(2.0)),
        ("box((2, 1, 1.5))", [-3.0, 0.5 - 1e-6, 0.75 - 1e-6], x, Hit::Hit(2.0)),
        // Across an edge.
        ("box((2, 1, 1.5))", [-0.5, 2.0, 0.0], [1.0, -1.0, 0.0], Hit::Ambiguous(1.5)),
        ("box((2, 1, 1.5))", [-0.5 + 1e-6, 2.0, 0.0], [1.0, -1.0, 0.0], Hit::Miss),
        ("box((2, 1, 1.5))", [-0.5 - 1e-6, 2.0, 0.0], [1.0, -1.0, 0.0], Hit::Hit(1.5)),
        // Through a corner into the inside, and past it.
        ("box((2, 1, 1.5))", [3.0, 1.5, 2.25], [-1.0, -0.5, -0.75], Hit::Hit(2.0)),
        ("box((2, 1, 1.5))", [0.0, 1.5, 0.75], [1.0, -1.0, 0.0], Hit::Ambiguous(1.0)),
        ("box((2, 1, 1.5))", [2.0, 1.5, 0.25], [-1.0, -1.0, 0.5], Hit::Ambiguous(1.0)),
        // Tangent.
        ("sphere(1)", [-2.0, 1.0, 0.0], x, Hit::Ambiguous(2.0)),
        ("sphere(1)", [-2.0, 1.0 + 1e-9, 0.0], x, Hit::Miss),
        ("sphere(1)", [-2.0, 1.0 - 1e-9, 0.0], x, Hit::Hit(2.0 - 2e-9_f64.sqrt())),
        ("cylinder(0.75, 1.5)", [0.75, 3.0, 0.0], down, Hit::Ambiguous(2.25)),
        ("cylinder(0.75, 1.5)", [0.75 - 1e-6, 3.0, 0.0], down, Hit::Hit(2.25)),
        ("torus(0.75, 0.25)", [0.0, 3.0, 0.0], down, Hit::Miss),
        ("torus(0.75, 0.25)", [0.5, 3.0, 0.0], down, Hit::Ambiguous(3.0)),
        ("torus(0.75, 0.25)", [-3.0, 0.25, 0.0], x, Hit::Ambiguous(2.25)),
        ("torus(0.75, 0.25)", [-3.0, 0.25 + 1e-9, 0.0], x, Hit::Miss),
        // From within, and on the surface all along.
        ("box((2, 1, 1.5))", [0.0; 3], x, Hit::Hit(1.0)),
        ("plane(y, -0.5)", [0.0, -0.5, 0.0], x, Hit::Ambiguous(0.0)),
    ];
    for (shape, from, direction, expected) in cases {
        let truth = truth(&format!("scene = {shape}"));
        let found = truth.prover().first_hit(from, direction, 0.0, 20.0, 20_000);
        let right = match (found, expected) {
            (Hit::Hit(t), Hit::Hit(root)) => (t - root).abs() <= 1e-9,
            // The root of what rounding leaves open about a tangent.
            (Hit::Ambiguous(t), Hit::Ambiguous(touch)) => (t - touch).abs() <= 1e-6,
            (Hit::Miss, Hit::Miss) => true,
            _ => false,
        };
        assert!(right, "{shape} from {from:?} along {direction:?}: {found:?}, not {expected:?}");
    }
}

/// The example scenes, by name.
fn examples() -> Vec<(String, Compiled)> {
    let folder = format!("{}/../examples", env!("CARGO_MANIFEST_DIR"));
    let files = std::fs::read_dir(folder).unwrap().map(|file| file.unwrap().path());
    let mut files: Vec<_> = files.filter(|path| path.extension().is_some_and(|e| e == "sdf")).collect();
    files.sort();
    let open = |path: std::path::PathBuf| {
        let compiled = compile(&Disk, path.to_str().unwrap(), &Options::default()).compiled.unwrap();
        (path.file_stem().unwrap().to_string_lossy().into_owned(), compiled)
    };
    files.into_iter().map(open).collect()
}

/// Of how many rays in a thousand more is left open: how a figure's distance changes over a box is not known, as that of a formula is.
const OPEN: [(&str, u32); 1] = [("along", 20)];

/// Camera rays of the example scenes: at most one in a thousand is left open, but for those of [`OPEN`]. `SUREFOOT_RAYS` says how many.
#[test]
fn hardly_a_camera_ray_is_left_open() {
    let height = (f64::from(asked("SUREFOOT_RAYS", 384)) / 1.5).sqrt().round() as u32;
    let width = height * 3 / 2;
    let rays = width * height;
    let mut wrong = Vec::new();
    println!("{:14} {:>6} {:>9} {:>9} {:>14} {:>8}", "scene", "rays", "ambiguous", "exhausted", "segments a ray", "ms a ray");
    for (name, scene) in examples() {
        let frame = scene.frame(&scene.live());
        let truth = Truth::new(&scene, &scene.live(), 4_000_000).unwrap();
        let mut prover = truth.prover();
        let camera = &frame.cameras[0].1;
        let basis = Basis::of(camera);
        let (mut ambiguous, mut exhausted) = (0, 0);
        let start = std::time::Instant::now();
        for i in 0..rays {
            let at = (f64::from(i % width) + 0.5, f64::from(i / width) + 0.5);
            let direction = basis.direction(at, (width, height));
            let hit = prover.first_hit(camera.eye, direction, 0.0, frame.max_distance, 20_000);
            ambiguous += u32::from(matches!(hit, Hit::Ambiguous(_)));
            exhausted += u32::from(matches!(hit, Hit::Exhausted(_)));
        }
        let each = |x: f64| x / f64::from(rays);
        let (segments, time) = (each(prover.boxes() as f64), each(1e3 * start.elapsed().as_secs_f64()));
        println!("{name:14} {rays:6} {ambiguous:9} {exhausted:9} {segments:14.1} {time:8.2}");
        let most = OPEN.iter().find(|(known, _)| *known == name).map_or(1, |(_, most)| *most);
        if (ambiguous + exhausted) * 1000 > most * rays {
            wrong.push(format!("{name}: {ambiguous} ambiguous, {exhausted} exhausted"));
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// Jumps, forms and shorter codes: no value leaves what is certain of its box, and no ball that is proven to be empty holds another sign.
#[test]
fn what_is_certain_holds_at_points() {
    let noise = ["value_noise(3 * p)", "perlin(3 * p)", "simplex(2 * p)", "cellular(2 * p)", "fbm(2 * p, 3)"];
    let mut scenes: Vec<(String, Compiled)> =
        noise.iter().map(|noise| (noise.to_string(), scene(&format!("scene = sphere(0.8).displace(0.2 * {noise})")))).collect();
    for text in [
        "scene = for k in polar(y, 5) { sphere(0.3 + 0.05 * k).translate(1, 0, 0) }",
        "scene = for k in polar(y, 8) { box((0.2, 0.4, 0.3)).translate(1, 0, 0) }",
        "field f = p.y - 0.3 * (p.x % 0.7) + 0.1 * sign(p.z) * smoothstep(-1, 1, p.x)\nscene = f.within(box(3))",
        "field f = mix(length(p) - 1, abs(p.y + round(p.x)) - 0.2, fract(3 * p.z))\nscene = f.within(box(3))",
    ] {
        scenes.push((text.to_string(), scene(text)));
    }
    scenes.extend(examples());
    for (name, scene) in scenes {
        let truth = Truth::new(&scene, &scene.live(), 4_000_000).unwrap();
        let mut prover = truth.prover();
        let mut random = Random(5);
        let mut empty = 0;
        for _ in 0..60 {
            let centre = random.within(2.0);
            let radius = 10f64.powf(-2.5 * random.next());
            let over = prover.over(centre.map(|c| Interval { lo: c - radius, hi: c + radius }));
            let field = prover.value(centre);
            let ball = prover.empty_ball(centre, radius, 500);
            empty += u32::from(ball == Ball::Empty);
            for _ in 0..40 {
                let off = random.within(radius);
                let at = [0, 1, 2].map(|i| centre[i] + off[i]);
                let value = prover.value(at);
                assert!(over.value.grow(1e-12).contains(value), "{name} at {at:?}: {value} is not in {over:?}");
                let inside = off.iter().map(|x| x * x).sum::<f64>() < radius * radius;
                let turned = value * field < 0.0 && value.abs() > 1e-12;
                assert!(!(inside && turned && ball == Ball::Empty), "{name}: {value} at {at:?}, {field} at {centre:?}, {radius}");
            }
        }
        assert!(empty > 5, "{name}: only {empty} balls are empty");
    }
}

/// A ball that reaches a hair beyond a point of the other sign is never proven to be empty, for any scene that documents the prelude: nothing
/// that is cut away from a box, or left to another piece, holds the surface.
#[test]
fn no_ball_that_holds_another_sign_is_empty() {
    let mut random = Random(9);
    let (mut asked, mut crossed) = (0, 0);
    for entry in CHAPTERS.iter().flat_map(|(file, _, text)| entries(file, text)) {
        let scene = scene(&format!("scene = {}", entry.example));
        let truth = Truth::new(&scene, &scene.live(), 4_000_000).unwrap();
        let mut prover = truth.prover();
        for _ in 0..6 {
            let from = random.within(1.5);
            let found = prover.distance(from, 3.0, 0.01, 200);
            let (here, there) = (prover.value(from), prover.value(found.beyond));
            if found.at_most > 0.0 && found.at_most.is_finite() && here * there < 0.0 {
                for part in [1e-9, 1e-4, 0.1] {
                    let ball = prover.empty_ball(from, found.at_most * (1.0 + part), 200);
                    assert_ne!(ball, Ball::Empty, "{}: {here} at {from:?}, {there} at {:?}", entry.example, found.beyond);
                    asked += 1;
                    crossed += u32::from(matches!(ball, Ball::Crossed(_)));
                }
            }
        }
    }
    println!("{asked} balls, {crossed} of them certainly hold another sign");
    assert!(asked > 1000 && 2 * crossed > asked, "{asked} balls, {crossed} certain");
}

/// What is steeper nowhere may still jump: a ball that holds a jump through zero is not empty.
#[test]
fn a_jump_is_seen() {
    let truth = truth("field wall = if p.x < 0.3 { 1 } else { -1 }\nscene = wall");
    let mut prover = truth.prover();
    assert!(prover.over(cube(0.5)).jump);
    assert!(prover.steepest(cube(0.5), 1.05, 100).jump);
    assert_eq!(prover.empty_ball([0.0; 3], 0.29, 10_000), Ball::Empty);
    assert!(matches!(prover.empty_ball([0.0; 3], 0.35, 10_000), Ball::Crossed(_)));
}

#[test]
fn suprema_are_those_in_closed_form() {
    // With the ratio of the upper end to the supremum, over the cube from -1 to 1.
    for (text, expected, loose) in [
        ("scene = sphere(1)", 1.0, 1.05),
        ("scene = box((1.5, 1.4, 1))", 1.0, 1.05),
        ("scene = torus(0.75, 0.25)", 1.0, 1.05),
        // The twisted plane is x cos(y) - z sin(y), up to the sense of the turn. Its slope along y is at most the distance from the axis,
        // and is that where the plane has turned by half a right angle: the gradient there is as long as the root of 1 + 2.
        ("scene = plane(x, 0).twist(y, 1)", 3f64.sqrt(), 1.05),
        // With g = sin x cos y + sin y cos z + sin z cos x no gradient of g is longer than the one at the origin, (1, 1, 1).
        ("scene = gyroid(2, 0.1)", 1.0, 1.05),
        // The mixed gradients of a smooth blend overestimate by what they vary over a box.
        ("scene = smooth_union(sphere(0.6).translate(-0.4, 0, 0), sphere(0.5).translate(0.5, 0.2, 0), 0.4)", 1.0, 1.25),
    ] {
        let truth = truth(text);
        let found = truth.prover().steepest(cube(1.0), 1.05, 40_000);
        println!("{text}: {found:?}");
        let attained = found.at_least <= expected * (1.0 + 1e-9) && found.at_least >= expected / 1.05;
        assert!(attained && found.at_most >= expected * (1.0 - 1e-9) && !found.jump, "{text}: {found:?}");
        assert!(found.at_most <= expected * loose * (1.0 + 1e-3), "{text}: {found:?}");
    }
}

#[test]
fn distances_are_those_in_closed_form() {
    let shapes: [(&str, fn([f64; 3]) -> f64); 2] = [
        ("scene = sphere(1)", |p| (p.iter().map(|x| x * x).sum::<f64>().sqrt() - 1.0).abs()),
        ("scene = box((2, 1, 1.5))", |p| {
            let q = [p[0].abs() - 1.0, p[1].abs() - 0.5, p[2].abs() - 0.75];
            let outside = q.iter().map(|x| x.max(0.0) * x.max(0.0)).sum::<f64>().sqrt();
            (outside + q[0].max(q[1]).max(q[2]).min(0.0)).abs()
        }),
    ];
    for (text, distance) in shapes {
        let truth = truth(text);
        let mut prover = truth.prover();
        let mut random = Random(3);
        for _ in 0..40 {
            let p = random.within(2.0);
            let expected = distance(p);
            let found = prover.distance(p, 6.0, 1e-2, 20_000);
            let within = found.at_least <= expected * (1.0 + 1e-9) && found.at_most >= expected * (1.0 - 1e-9);
            assert!(within && found.at_most <= expected * 1.02, "{text} at {p:?}: {expected} not in {found:?}");
            assert_eq!(prover.empty_ball(p, expected * 0.99, 20_000), Ball::Empty, "{text} at {p:?}");
            assert!(matches!(prover.empty_ball(p, expected * 1.05, 20_000), Ball::Crossed(_)), "{text} at {p:?}");
        }
    }
}

/// Where three conditions meet, each of them holds on its own side and not all together: no point lies in that piece.
#[test]
fn a_piece_without_a_point_is_no_crossing() {
    let truth = truth("scene = sphere(0.8).displace(0.12 * simplex(2 * p))");
    let mut prover = truth.prover();
    for (point, radius) in [
        ([0.2558321952819824, -0.2569023668766022, 0.7556093335151672], 0.0134),
        ([0.249629408121109, -0.22378942370414734, 0.7726006507873535], 0.0353),
    ] {
        let found = prover.empty_ball(point, radius, 4000);
        assert!(!matches!(found, Ball::Crossed(_)), "{found:?} about {point:?}");
    }
}

/// However large the ball is in which it is looked for, what is found beyond the surface is there, and the distance is the same.
#[test]
fn a_distance_does_not_depend_on_how_far_is_looked() {
    let text = "let post = box((0.025, 0.42, 0.025)).translate(0.25, 0, 0)
                scene = cylinder(0.17, 0.36) | (for k in polar(y, 8) { post }) | cone(0.36, 0.3).translate(0, 0.36, 0)";
    let scene = scene(text);
    let truth = Truth::new(&scene, &scene.live(), 1_000_000).unwrap();
    let mut prover = truth.prover();
    let mut random = Random(5);
    let mut points = vec![[-0.11395576740275383, 0.33605146137837, -0.08421806021068264]];
    points.extend((0..20).map(|_| random.within(0.5)));
    for p in points {
        let inside = prover.value(p) < 0.0;
        let (mut least, mut most) = (0.0, f64::INFINITY);
        for k in 0..12 {
            let found = prover.distance(p, 0.2 + 0.013 * f64::from(k), 0.01, 20_000);
            if found.at_most < f64::INFINITY {
                assert!((prover.value(found.beyond) < 0.0) != inside, "{p:?}: {found:?}");
            }
            (least, most) = (found.at_least.max(least), found.at_most.min(most));
            assert!(least <= most, "{p:?}: {found:?}, and it was {least} to {most}");
        }
    }
}

#[test]
fn a_wrong_bound_is_falsified_and_a_right_one_is_not() {
    let scene = scene("scene = sphere(1)");
    let field = scene.functions.formulas[&(scene.root, Function::Field)];
    let tape = Tape::new(&scene.graph, &scene.functions.formulas, &[field], &scene.live(), 1000).unwrap();
    let claim = |radius| [Claim { point: [2.0, 0.0, 0.0], radius, field: 1.0 }];
    let look = |radius| falsify(&mut tape.evaluator(), &claim(radius), || [-1.0, 0.0, 0.0], 1, &[0.5, 0.999], 10.0);
    assert!(look(1.0).is_empty());
    assert_eq!(look(1.1).len(), 1);
}

/// The intervals are the ground of it all: no value may fall outside of them.
#[test]
fn every_operation_lies_within_its_interval() {
    use surefoot_compiler::graph::kernel::{KERNEL, Op};
    let mut random = Random(11);
    for row in KERNEL {
        for _ in 0..4000 {
            let scale = 10f64.powf(6.0 * random.next() - 3.0);
            let ranges = [0, 1, 2, 3].map(|i| {
                // A condition is 0 or 1, and nothing else.
                if matches!(row.op, Op::And | Op::Or | Op::Not) || row.op == Op::Select && i == 0 {
                    return [Interval::ZERO, Interval::ONE, Interval { lo: 0.0, hi: 1.0 }][(random.next() * 3.0) as usize];
                }
                let (a, b) = ((2.0 * random.next() - 1.0) * scale, (2.0 * random.next() - 1.0) * scale);
                Interval { lo: a.min(b), hi: a.max(b) }
            });
            let all = (row.interval)(ranges);
            for _ in 0..8 {
                let mut at = ranges.map(|r| (r.lo + random.next() * (r.hi - r.lo)).clamp(r.lo, r.hi));
                at.iter_mut().zip(ranges).filter(|(_, r)| r.lo == 0.0 && r.hi == 1.0).for_each(|(x, _)| *x = x.round());
                let value = (row.value)(at);
                // The value itself is rounded.
                let slack = 1e-15 * at.iter().fold(value.abs(), |s, x| s.max(x.abs()));
                assert!(all.lo - slack <= value && value <= all.hi + slack, "{} of {at:?} is {value}, not in {all:?}", row.name);
            }
        }
    }
}
