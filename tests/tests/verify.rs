//! The trial of every example and of every scene that documents the prelude, on the processor and on the device.
//!
//! `SUREFOOT_POINTS=1000000` probes at so many points of each, `SUREFOOT_CERTIFIED=10000` certifies so many, `SUREFOOT_SCENE=chess` tries one,
//! and `SUREFOOT_DEVICE=cpu` leaves the device out. With `SUREFOOT_TABLE=table.txt` each row is written there as soon as it is known, and what
//! has a row is not tried again, so that a long trial can be broken off and taken up. The table tells of each what could not be decided and
//! how tight the bound is. All of it, in the background and for about an hour:
//!
//! ```text
//! SUREFOOT_POINTS=1000000 SUREFOOT_CERTIFIED=10000 SUREFOOT_TABLE=table.txt \
//!     nice cargo test --release -p surefoot-tests --test end_to_end verify:: -- --nocapture
//! ```

use crate::common::{compile_file, examples, gpu, prelude};
use std::io::Write;
use surefoot_compiler::compiled::{Compiled, Export, Live};
use surefoot_compiler::verify::{Settings, Violation, WORK, verify};
use surefoot_runtime::{Gpu, evaluate};

fn number(name: &str, otherwise: usize) -> usize {
    std::env::var(name).ok().and_then(|s| s.parse().ok()).unwrap_or(otherwise)
}

/// The rows of a trial: printed, and kept where `SUREFOOT_TABLE` says.
struct Table {
    kept: String,
    file: Option<std::fs::File>,
}

impl Table {
    fn new() -> Self {
        let Ok(path) = std::env::var("SUREFOOT_TABLE") else { return Self { kept: String::new(), file: None } };
        let kept = std::fs::read_to_string(&path).unwrap_or_default();
        let file = std::fs::File::options().create(true).append(true).open(&path);
        Self { kept, file: Some(file.unwrap_or_else(|error| panic!("{path}: {error}"))) }
    }

    /// The row of a scene that was tried before.
    fn row(&self, name: &str) -> Option<&str> {
        self.kept.lines().find(|row| row.split_whitespace().next() == Some(name))
    }

    fn add(&mut self, row: &str) {
        println!("{row}");
        if let Some(file) = &mut self.file {
            writeln!(file, "{row}").unwrap();
        }
    }
}

#[test]
fn every_bound_holds() {
    let settings = Settings { samples: number("SUREFOOT_POINTS", 400), certified: number("SUREFOOT_CERTIFIED", 8), seed: 1, work: WORK };
    let only = std::env::var("SUREFOOT_SCENE").ok();
    let gpu = (std::env::var("SUREFOOT_DEVICE").as_deref() != Ok("cpu")).then(gpu);
    let files = examples().into_iter().map(|(name, path)| (name, compile_file(&path).unwrap_or_else(|words| panic!("{words}"))));
    let mut scenes: Vec<(String, Compiled)> = files.chain(prelude(&[Export::Bound])).collect();
    assert!(scenes.len() > 110, "only {} scenes", scenes.len());
    // Overloads have one name: the second one is `cone.2`.
    let names: Vec<String> = scenes.iter().map(|(name, _)| name.clone()).collect();
    for (i, (name, _)) in scenes.iter_mut().enumerate() {
        let before = names.iter().take(i).filter(|other| *other == name).count();
        if before > 0 {
            *name = format!("{name}.{}", before + 1);
        }
    }
    // The smallest first, so that of a long trial most is soon done.
    scenes.sort_by_key(|(_, compiled)| compiled.module.operations.0);
    let mut table = Table::new();
    println!("on {}", gpu.as_ref().map_or("the processor alone", |gpu| gpu.name()));
    println!(
        "{:24} {:>8} {:>10} {:>7} {:>9} {:>8} {:>6} {:>6} {:>13} {:>8}",
        "scene", "points", "violations", "empty", "undecided", "settled", "p5", "p50", "device, worst", "seconds"
    );
    let mut wrong = Vec::new();
    let mut sums = [0; 4];
    for (name, compiled) in scenes.iter().filter(|(name, _)| only.as_ref().is_none_or(|only| only == name)) {
        let row = table.row(name).map(str::to_owned).unwrap_or_else(|| {
            let (row, faults) = tried(name, compiled, settings, gpu.as_ref());
            table.add(&row);
            wrong.extend(faults);
            row
        });
        let numbers: Vec<usize> = row.split_whitespace().skip(1).map_while(|number| number.parse().ok()).collect();
        assert!(numbers.len() >= sums.len(), "no row: {row}");
        sums.iter_mut().zip(numbers).for_each(|(sum, number)| *sum += number);
    }
    let [points, violations, empty, undecided] = sums;
    println!("{points} points, {violations} violations, {empty} balls empty, {undecided} undecided");
    assert!(wrong.is_empty() && violations == 0, "{}", wrong.join("\n"));
}

/// The row of a scene, and what is wrong with it.
fn tried(name: &str, compiled: &Compiled, settings: Settings, gpu: Option<&Gpu>) -> (String, Vec<String>) {
    let start = std::time::Instant::now();
    let bound = |live: &Live, points: &[[f32; 3]]| {
        evaluate(gpu.ok_or("no device")?, compiled, live, [0.0; 3], Export::Bound, points)
    };
    let report = verify(compiled, settings, gpu.map(|_| &bound as surefoot_compiler::verify::Device), &|_| {}).unwrap();
    let percent = |p: usize| report.tightness(p).map_or("-".to_owned(), |t| format!("{t:.3}"));
    let row = format!(
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
    let words = |v: &Violation| format!("{name}: {v:?} at {:?}", report.moments.get(v.moment));
    (row, report.violations.iter().take(3).map(words).collect())
}
