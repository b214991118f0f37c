//! No ray may step through a surface: within the bound at a point the field keeps its sign, along every direction.
//!
//! This is the quick falsifier: it can't prove a bound, but a wrong factor does not pass it for long. Every example of the prelude's
//! documentation and every scene of the examples is tried, at points near and far, inside and outside.

use crate::common::Disk;
use surefoot_compiler::certify::{Claim, falsify};
use surefoot_compiler::evaluate::Tape;
use surefoot_compiler::graph::Function;
use surefoot_compiler::random::Random;
use surefoot_compiler::prelude::PRELUDE;
use surefoot_compiler::{compile, Compiled, MemoryLoader, Options};

fn add(p: [f64; 3], d: [f64; 3], t: f64) -> [f64; 3] {
    [0, 1, 2].map(|i| p[i] + t * d[i])
}

/// What the falsifier found in a scene.
struct Found {
    points: usize,
    violations: Vec<String>,
}

fn try_scene(scene: &Compiled, half: f64, points: usize, seed: u64) -> Found {
    let mut random = Random(seed);
    let mut live = scene.live();
    let mut violations = Vec::new();
    let mut tried = 0;
    // At the defaults, and at other values of the parameters and the time.
    for round in 0..3 {
        if round > 0 {
            live.time = random.next() * 20.0;
            for (value, p) in live.components.iter_mut().zip(&scene.graph.parameters) {
                *value = p.min + (p.max - p.min) * random.next();
            }
        }
        let roots = [Function::Field, Function::Bound, Function::Distance]
            .map(|f| scene.functions.formulas[&(scene.root, f)]);
        let tape = Tape::new(&scene.graph, &scene.functions.formulas, &roots, &live, 4_000_000).unwrap();
        let mut evaluator = tape.evaluator();
        let mut starts: Vec<[f64; 3]> = (0..points / 3).map(|_| random.within(half)).collect();
        // As many near the surface: walked there by the bound.
        for _ in 0..12 {
            let half_of_them = starts.len() / 2;
            let mut moved = starts[..half_of_them].to_vec();
            evaluator.at(&starts[..half_of_them], &[], |i, values| {
                let step = values[1].abs().min(half);
                if step > 1e-3 {
                    moved[i] = add(moved[i], [0.5, -0.7, 0.5], 0.9 * step);
                }
            });
            starts[..half_of_them].copy_from_slice(&moved);
        }
        starts.retain(|p| p.iter().map(|c| c * c).sum::<f64>().sqrt() < scene.blocks.extent);
        let mut at = vec![[0.0; 3]; starts.len()];
        evaluator.at(&starts, &[], |i, values| at[i] = [values[0], values[1], values[2]]);
        tried += starts.len();
        let mut claims = Vec::new();
        for (p, [field, bound, distance]) in starts.iter().zip(at) {
            assert!(field.is_finite() && bound.is_finite() && distance.is_finite(), "not finite at {p:?}: {field}, {bound}, {distance}");
            if field.signum() != bound.signum() && field.abs() > 1e-9 && bound.abs() > 1e-9 {
                violations.push(format!("at {p:?} the field is {field} and the bound {bound}"));
            }
            // Across a jump a ray steps by a hair.
            let radius = if bound.abs() <= 1.1e-4 { 0.0 } else { bound.abs().min(2.0 * half) };
            claims.push(Claim { point: *p, radius, field });
        }
        for found in falsify(&mut evaluator, &claims, || random.direction(), 8, &[0.3, 0.6, 0.9, 0.995], scene.blocks.extent) {
            let Claim { point, radius, field } = claims[found.claim];
            violations.push(format!("from {point:?} (field {field}, bound {radius}) to {:?} (field {})", found.at, found.field));
        }
    }
    Found { points: tried, violations }
}

fn samples() -> usize {
    std::env::var("SUREFOOT_SAMPLES").ok().and_then(|s| s.parse().ok()).unwrap_or(3000)
}

fn report(name: &str, found: &Found) -> bool {
    println!("{name:<40} {:>7} points {:>5} violations", found.points, found.violations.len());
    for violation in found.violations.iter().take(3) {
        println!("    {violation}");
    }
    found.violations.is_empty()
}

#[test]
fn every_example_of_the_prelude_keeps_its_bound() {
    let mut bad = Vec::new();
    for (file, text) in PRELUDE {
        let lines: Vec<&str> = text.lines().collect();
        for (i, line) in lines.iter().enumerate() {
            let Some(example) = line.trim().strip_prefix("/// Example:") else { continue };
            let declaration = lines[i..].iter().find(|l| !l.starts_with("///")).unwrap_or(&"");
            let name = format!("{} {}", file.rsplit('/').next().unwrap(), declaration.split('(').next().unwrap());
            let loader = MemoryLoader::new().with("main.sdf", format!("scene = {example}"));
            let outcome = compile(&loader, "main.sdf", &Options::default());
            let Some(scene) = &outcome.compiled else {
                println!("{name}: does not compile");
                bad.push(name);
                continue;
            };
            if !report(&name, &try_scene(scene, 2.5, samples(), i as u64)) {
                bad.push(name);
            }
        }
    }
    assert!(bad.is_empty(), "{bad:?}");
}

#[test]
fn every_scene_of_the_examples_keeps_its_bound() {
    try_folder(concat!(env!("CARGO_MANIFEST_DIR"), "/../examples"));
}

/// Scenes made to break a bound: jumps, twists, formulas that are no distance, bodies wider than their cells.
#[test]
fn every_hard_scene_keeps_its_bound() {
    try_folder(concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/corpus/sound"));
}

fn try_folder(folder: &str) {
    let mut paths: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .filter_map(|e| e.ok().map(|e| e.path()))
        .filter(|p| p.extension().is_some_and(|e| e == "sdf"))
        .collect();
    paths.sort();
    assert!(paths.len() >= 10);
    let mut bad = Vec::new();
    for path in paths {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let outcome = compile(&Disk, &path.to_string_lossy(), &Options::default());
        let Some(scene) = &outcome.compiled else {
            println!("{name}: does not compile");
            println!("{}", surefoot_compiler::diagnostic::render(&outcome.sources, &outcome.diagnostics, false));
            bad.push(name);
            continue;
        };
        println!("{:?}", scene.graph.factors.iter().map(|f| f.lipschitz).collect::<Vec<_>>());
        if !report(&name, &try_scene(scene, 6.0, samples(), 1)) {
            bad.push(name);
        }
    }
    assert!(bad.is_empty(), "{bad:?}");
}
