//! The trial of every example and of every scene that documents the prelude, on the processor and on the device.
//!
//! `SUREFOOT_POINTS=1000000` probes at so many points of each, `SUREFOOT_CERTIFIED=10000` certifies so many, `SUREFOOT_SCENE=chess` tries one,
//! and `SUREFOOT_DEVICE=cpu` leaves the device out. The table tells of each what could not be decided and how tight the bound is.

mod common;

use common::{compile_file, examples, gpu, prelude};
use surefoot_compiler::compiled::{Compiled, Export, Live};
use surefoot_compiler::verify::{Settings, verify};
use surefoot_runtime::evaluate;

fn number(name: &str, otherwise: usize) -> usize {
    std::env::var(name).ok().and_then(|s| s.parse().ok()).unwrap_or(otherwise)
}

#[test]
fn every_bound_holds() {
    let settings = Settings { samples: number("SUREFOOT_POINTS", 400), certified: number("SUREFOOT_CERTIFIED", 8), seed: 1 };
    let only = std::env::var("SUREFOOT_SCENE").ok();
    let gpu = (std::env::var("SUREFOOT_DEVICE").as_deref() != Ok("cpu")).then(gpu);
    let files = examples().into_iter().map(|(name, path)| (name, compile_file(&path).unwrap_or_else(|words| panic!("{words}"))));
    let scenes: Vec<(String, Compiled)> = files.chain(prelude(&[Export::Bound])).collect();
    assert!(scenes.len() > 110, "only {} scenes", scenes.len());
    println!("on {}", gpu.as_ref().map_or("the processor alone", |gpu| gpu.name()));
    println!(
        "{:24} {:>8} {:>10} {:>7} {:>9} {:>8} {:>6} {:>6} {:>13} {:>8}",
        "scene", "points", "violations", "empty", "undecided", "settled", "p5", "p50", "device, worst", "seconds"
    );
    let mut wrong = Vec::new();
    let (mut points, mut empty, mut undecided) = (0, 0, 0);
    for (name, compiled) in scenes.iter().filter(|(name, _)| only.as_ref().is_none_or(|only| only == name)) {
        let start = std::time::Instant::now();
        let bound = |live: &Live, points: &[[f32; 3]]| {
            let gpu = gpu.as_ref().ok_or("no device")?;
            evaluate(gpu, compiled, live, [0.0; 3], Export::Bound, points)
        };
        let report = verify(compiled, settings, gpu.as_ref().map(|_| &bound as surefoot_compiler::verify::Device), &|_| {}).unwrap();
        let percent = |p: usize| report.tightness(p).map_or("-".to_owned(), |t| format!("{t:.3}"));
        println!(
            "{name:24} {:8} {:10} {:7} {:9} {:8} {:>6} {:>6} {:13.3} {:8.1}",
            report.points,
            report.violations.len(),
            report.empty,
            report.undecided,
            report.tightness.len(),
            percent(5),
            percent(50),
            report.device.map_or(0.0, |d| d.worst),
            start.elapsed().as_secs_f64()
        );
        (points, empty, undecided) = (points + report.points, empty + report.empty, undecided + report.undecided);
        for violation in report.violations.iter().take(3) {
            wrong.push(format!("{name}: {violation:?} at {:?}", report.moments.get(violation.moment)));
        }
    }
    println!("{points} points, {empty} balls empty, {undecided} undecided");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
