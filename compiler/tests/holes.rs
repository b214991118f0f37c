//! Thin things that turn fast, seen from all around: no hole in a picture, and how many there are where no factor is known.
//!
//! `SUREFOOT_DIRECTIONS=64 cargo test --release -p surefoot-compiler --test compiler holes:: -- --nocapture` looks from 64 directions, at larger
//! pictures, and prints the table.

use std::sync::atomic::{AtomicUsize, Ordering};
use surefoot_compiler::evaluate::{LANES, Tape, lanes};
use surefoot_compiler::reference::Reference;
use surefoot_compiler::camera::Basis;
use surefoot_compiler::reference::march::Ray;
use surefoot_compiler::compiled::Camera;
use surefoot_compiler::{Compiled, Live, MemoryLoader, Options, compile};

/// Name, text, and the radius of a ball about the origin that holds it.
const SCENES: [(&str, &str, f64); 3] = [
    ("blade about its length", "scene = box((4, 0.16, 1)).twist(x, 3)\n", 2.1),
    ("blade about its 0.16", "scene = box((4, 0.16, 1)).twist(y, 3)\n", 2.1),
    (
        "twisted shell",
        "scene = box((0.55, 1.5, 0.42)).twist(y, 18).displace(0.0045 * sin(115 * p.y)).shell(0.028)\n",
        0.86,
    ),
];

fn scene(text: &str) -> Compiled {
    let outcome = compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default());
    outcome.compiled.unwrap_or_else(|| panic!("{text}: {:?}", outcome.diagnostics))
}

/// How many directions, and pixels a side: the variable raises both.
fn size() -> (usize, u32) {
    let directions = std::env::var("SUREFOOT_DIRECTIONS").ok().and_then(|s| s.parse().ok());
    directions.map_or((12, 64), |n| (n, 192))
}

/// Directions spread over the sphere (Fibonacci lattice: Swinbank and Purser 2006).
fn direction(i: usize, of: usize) -> [f64; 3] {
    let up = 1.0 - (2.0 * i as f64 + 1.0) / of as f64;
    let (across, turn) = ((1.0 - up * up).sqrt(), i as f64 * std::f64::consts::PI * (3.0 - 5f64.sqrt()));
    [across * turn.cos(), up, across * turn.sin()]
}

/// The rays of a picture of a ball of this radius, each from where it enters the ball to where it leaves it.
fn rays(toward: [f64; 3], radius: f64, side: u32) -> (Vec<Option<Ray>>, f64) {
    let camera = Camera { eye: toward.map(|x| 4.0 * radius * x), target: [0.0; 3], fov: 2.0 * 0.25f64.asin(), ..Camera::PLAIN };
    let basis = Basis::of(&camera);
    let pixel = |i: u32| (f64::from(i % side) + 0.5, f64::from(i / side) + 0.5);
    let ray = |i| Ray { origin: camera.eye, direction: basis.direction(pixel(i), (side, side)), t_min: 0.0, t_max: 6.0 * radius };
    ((0..side * side).map(|i| ray(i).clip(radius)).collect(), basis.footprint(side))
}

/// Where each ray first meets what is below zero, if it steps by `part` of the field's size, and never less than `least`.
fn stepped(field: &Tape, rays: &[Option<Ray>], part: f64, least: f64) -> Vec<Option<f64>> {
    let mut found = vec![None; rays.len()];
    let mut going: Vec<(usize, Ray, f64)> = rays.iter().enumerate().filter_map(|(i, ray)| ray.map(|r| (i, r, r.t_min))).collect();
    let mut field = field.evaluator();
    for _ in 0..1_000_000 {
        if going.is_empty() {
            break;
        }
        for batch in going.chunks_mut(LANES) {
            let points: Vec<[f64; 3]> = batch.iter().map(|(_, ray, t)| ray.at(*t)).collect();
            field.run(&lanes(&points));
            for ((i, ray, t), value) in batch.iter_mut().zip(field.output(0)) {
                if *value <= 0.0 {
                    found[*i] = Some(*t);
                    *t = f64::INFINITY;
                } else {
                    *t += (part * value).max(least);
                    *t = if *t > ray.t_max { f64::INFINITY } else { *t };
                }
            }
        }
        going.retain(|(_, _, t)| t.is_finite());
    }
    found
}

/// Connected groups of pixels that are solid in truth and show nothing, or what is behind; pixels at the edge of what is solid do not count.
fn holes(truth: &[Option<f64>], seen: &[Option<f64>], side: u32, tolerance: f64) -> (usize, usize) {
    let side = side as i32;
    let at = |x: i32, y: i32| (x >= 0 && y >= 0 && x < side && y < side).then_some((y * side + x) as usize);
    let around = |x: i32, y: i32| (-1..=1).flat_map(move |dx| (-1..=1).map(move |dy| (x + dx, y + dy)));
    let missing = |x: i32, y: i32| {
        at(x, y).is_some_and(|i| {
            let far = truth[i].is_some_and(|t| seen[i].is_none_or(|s| s > t + tolerance));
            // Where the picture has an edge, half a pixel beside it is something else.
            let edge = around(x, y).any(|(x, y)| at(x, y).is_none_or(|n| truth[n].zip(truth[i]).is_none_or(|(a, b)| (a - b).abs() > tolerance)));
            far && !edge
        })
    };
    let mut seen_before = vec![false; truth.len()];
    let (mut groups, mut pixels) = (0, 0);
    for start in 0..side * side {
        let mut open = vec![(start % side, start / side)];
        let mut size = 0;
        while let Some((x, y)) = open.pop() {
            let Some(i) = at(x, y).filter(|&i| !seen_before[i] && missing(x, y)) else { continue };
            seen_before[i] = true;
            size += 1;
            open.extend([(x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1)]);
        }
        groups += usize::from(size > 0);
        pixels += size;
    }
    (groups, pixels)
}

/// Holes and their pixels in all pictures of a scene: as drawn, by plain sphere tracing, with a factor of 0.7 for all; and solid pixels.
fn look(compiled: &Compiled, live: &Live, radius: f64, (directions, side): (usize, u32)) -> ([(usize, usize); 3], usize) {
    let reference = Reference::new(compiled, live).unwrap();
    let next = AtomicUsize::new(0);
    let work = || {
        let (mut sums, mut solid) = ([(0, 0); 3], 0);
        loop {
            let i = next.fetch_add(1, Ordering::Relaxed);
            if i >= directions {
                return (sums, solid);
            }
            let (rays, footprint) = rays(direction(i, directions), radius, side);
            let truth = stepped(reference.field(), &rays, 0.02, 1e-4 * radius);
            let all: Vec<Ray> = rays.iter().flatten().copied().collect();
            let mut hits = reference.trace(&all, footprint, 2.0 * radius).into_iter();
            let ours = rays.iter().map(|ray| ray.and_then(|_| hits.next().filter(|h| h.hit).map(|h| h.t))).collect();
            let tiny = 1e-4 * radius;
            let pictures = [ours, stepped(reference.field(), &rays, 1.0, tiny), stepped(reference.field(), &rays, 0.7, tiny)];
            for (sum, picture) in sums.iter_mut().zip(&pictures) {
                let (groups, pixels) = holes(&truth, picture, side, 0.1 * radius);
                *sum = (sum.0 + groups, sum.1 + pixels);
            }
            solid += truth.iter().flatten().count();
        }
    };
    std::thread::scope(|scope| {
        let threads = [scope.spawn(work), scope.spawn(work)];
        threads.into_iter().map(|t| t.join().unwrap()).fold(([(0, 0); 3], 0), |(a, m), (b, n)| {
            ([0, 1, 2].map(|i| (a[i].0 + b[i].0, a[i].1 + b[i].1)), m + n)
        })
    })
}

#[test]
fn a_thin_blade_has_no_hole_and_without_factors_it_has() {
    let size = size();
    println!("{:<26}{:>10}{:>10}{:>22}{:>22}{:>22}", "", "factor", "solid", "surefoot", "plain", "times 0.7");
    let (mut wrong, mut with_one_factor) = (Vec::new(), 0);
    for (name, text, radius) in SCENES {
        let compiled = scene(text);
        let (holes, solid) = look(&compiled, &compiled.live(), radius, size);
        let cell = |(groups, pixels): (usize, usize)| format!("{groups} of {pixels} px");
        let factor = compiled.summary.factor;
        println!("{name:<26}{factor:>10.3}{solid:>10}{:>22}{:>22}{:>22}", cell(holes[0]), cell(holes[1]), cell(holes[2]));
        with_one_factor += holes[2].0;
        if holes[0].0 > 0 || holes[1].0 == 0 || solid < 100 {
            wrong.push(format!("{name}: {holes:?}, {solid} solid"));
        }
    }
    // The first blade is gentle enough for 0.7; the others are not.
    assert!(wrong.is_empty() && with_one_factor > 0, "{}", wrong.join("\n"));
}

/// A slider from nothing to more than the ball holds: at nothing it costs nothing, at the end there is no hole.
#[test]
fn a_displacement_from_nothing_to_far_too_much() {
    // The box about a scene is that of all values of its sliders, so it is left away where steps are compared.
    let boxless = |mut scene: Compiled| {
        scene.functions.ahead.region = None;
        scene
    };
    let moved = scene(
        "param amount = 0 in 0..20\nrender { extent: 60, max_distance: 200 }\n\
         scene = sphere(6).displace(amount * sin(p.x) * sin(p.y) * sin(p.z))\n",
    );
    let moved = boxless(moved);
    let plain = boxless(scene("render { extent: 60, max_distance: 200 }\nscene = sphere(6)\n"));
    let mut live = moved.live();
    moved.follow(&mut live, Compiled::QUICK);
    let (rays, footprint) = rays(direction(1, 5), 26.0, 32);
    let rays: Vec<Ray> = rays.into_iter().flatten().collect();
    let steps = |scene: &Compiled, live: &Live| {
        let hits = Reference::new(scene, live).unwrap().trace(&rays, footprint, 60.0);
        hits.iter().map(|h| h.steps).sum::<u32>()
    };
    let (at_rest, sphere) = (steps(&moved, &live), steps(&plain, &plain.live()));
    println!("steps at rest {at_rest}, of the sphere {sphere}");
    assert_eq!(at_rest, sphere);
    for (amount, least) in [(1.0, 1.5), (20.0, 10.0)] {
        live.components[0] = amount;
        moved.follow(&mut live, Compiled::QUICK);
        let factors: Vec<f64> = (0..moved.graph.factors.len()).map(|i| live.factor(&moved.graph, i as u32)).collect();
        let cost = steps(&moved, &live);
        let (holes, solid) = look(&moved, &live, 27.0, (3, 32));
        println!("amount {amount}: factors {factors:?}, {cost} steps, holes {holes:?} of {solid}");
        assert!(holes[0].0 == 0 && solid > 100 && factors.iter().any(|f| *f > least), "{amount}: {holes:?}, {factors:?}");
    }
}
