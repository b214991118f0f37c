//! `surefoot bench --balls`: how many steps a second there are of 1,000 balls and more, on the adapter at hand.

use crate::command::bar::LateBar;
use crate::command::console::{Exit, Failure, compile_file, print, show_diagnostics};
use crate::command::page;
use std::fmt::Write;
use std::path::Path;
use std::time::{Duration, Instant};
use surefoot_compiler::Options;
use surefoot_compiler::compiled::Compiled;
use surefoot_compiler::physics::{Group, State, spawn};
use surefoot_runtime::physics::STEP;
use surefoot_runtime::{Gpu, Physics};

/// Numbers of balls.
const COUNTS: [u32; 4] = [1_000, 10_000, 100_000, 1_000_000];
/// How long balls fall before they are measured, in steps and in time.
const POUR: (u32, Duration) = (60, Duration::from_secs(20));
/// How long they are measured.
const MEASURE: (u32, Duration) = (300, Duration::from_secs(10));

/// What was measured of so many balls.
struct Row {
    count: u32,
    /// Steps while they fell, and how long those took.
    pour: (u32, Duration),
    /// The same of the steps after them.
    after: (u32, Duration),
    /// What they took of all processors, where a program computes them.
    processor: Option<Duration>,
    /// How many of them sleep at the end.
    asleep: usize,
}

impl Row {
    /// Steps a second.
    fn rate(&self) -> f64 {
        f64::from(self.after.0) / self.after.1.as_secs_f64().max(1e-9)
    }

    /// Seconds of a step: of the processors where a program computes it, so that it does not count what else the machine does.
    fn cost(&self) -> f64 {
        self.processor.map_or(1.0 / self.rate(), |took| took.as_secs_f64() / f64::from(self.after.0))
    }
}

/// What all threads of this program had of the processors so far, where the system says it.
fn processor() -> Option<Duration> {
    let mut sum = 0;
    for thread in std::fs::read_dir("/proc/self/task").ok()?.flatten() {
        let said = std::fs::read_to_string(thread.path().join("schedstat")).ok()?;
        sum += said.split(' ').next()?.parse::<u64>().ok()?;
    }
    Some(Duration::from_nanos(sum))
}

/// Measures each scene and prints tables of Markdown, or makes them a section of a page. `most` is the greatest number of balls.
pub fn run(scenes: &[String], most: u32, file: Option<&Path>) -> Result<Exit, Failure> {
    let gpu = Gpu::headless().map_err(|e| Failure { exit: Exit::NoGraphics, words: e.to_string() })?;
    let counts: Vec<u32> = COUNTS.into_iter().filter(|count| *count <= most).collect();
    let bar = LateBar::new();
    let mut text = head(&gpu, scenes);
    for (at, path) in scenes.iter().enumerate() {
        let outcome = compile_file(path, &Options::default())?;
        show_diagnostics(&outcome);
        let Some(compiled) = &outcome.compiled else { return Ok(Exit::Errors) };
        let Some(group) = compiled.groups(&compiled.live()).into_iter().next() else {
            return Err(Failure::usage(format!("{path} has no balls: write `balls drops {{ count: 100 }}`")));
        };
        let mut rows = Vec::new();
        for (i, &count) in counts.iter().enumerate() {
            bar.show((at * counts.len() + i) as f64 / (scenes.len() * counts.len()) as f64);
            rows.push(row(&gpu, compiled, &group, count).map_err(|words| Failure { exit: Exit::Errors, words })?);
        }
        table(&mut text, path, compiled.summary.factor, &rows);
    }
    bar.finish();
    match file {
        Some(file) => page::put(file, "balls", &text)?,
        None => print(text.as_bytes())?,
    }
    Ok(Exit::Fine)
}

/// So many balls in the box of a group, of a size that fills as much of it however many they are.
fn row(gpu: &Gpu, compiled: &Compiled, group: &Group, count: u32) -> Result<Row, String> {
    let [low, high] = group.spawn;
    let volume: f64 = low.iter().zip(&high).map(|(l, h)| (h - l).abs().max(0.1)).product();
    let radius = [0.3 * (volume / f64::from(count)).cbrt(); 2];
    let balls = spawn::spawn(&[Group { count, radius, ..group.clone() }]);
    let mut physics = Physics::with(gpu, compiled, &balls)?;
    let mut live = compiled.live();
    let mut go = |(most, patience): (u32, Duration)| {
        let begun = Instant::now();
        let mut steps = 0;
        while steps < most && (steps == 0 || begun.elapsed() < patience) {
            let before = live.clone();
            live.time += STEP;
            physics.step(compiled, &before, &live)?;
            physics.wait()?;
            steps += 1;
        }
        Ok::<_, String>((steps, begun.elapsed()))
    };
    let pour = go(POUR)?;
    let before = processor();
    let after = go(MEASURE)?;
    let took = processor().zip(before).map(|(after, before)| after.saturating_sub(before));
    let asleep = physics.read()?.iter().filter(|b| b.state == State::Asleep).count();
    Ok(Row { count, pour, after, processor: took.filter(|_| gpu.is_software()), asleep })
}

fn head(gpu: &Gpu, scenes: &[String]) -> String {
    let (steps, patience) = POUR;
    format!(
        "# What balls cost\n\n\
         Written by `surefoot bench --balls {} --page docs/performance.md` on {}.\n\n\
         The balls of a scene's first group, as many as each line says and of a size that fills the same share of its box, fall for {steps} steps of a\n\
         60th of a second, or for {} s where those take longer. The steps after that are counted; each is waited for. `physics` is as the scene has it.\n\
         {}\n",
        scenes.join(" "),
        gpu.name(),
        patience.as_secs(),
        match gpu.is_software() {
            true => "What a step costs is the time of all processors; on a machine that does nothing else, two of them take half of it.",
            false => "What a step costs is the time until it is done.",
        }
    )
}

fn table(text: &mut String, path: &str, factor: f64, rows: &[Row]) {
    let _ = write!(
        text,
        "\n## {path}\n\nThe field's factor is {factor:.2}.\n\n\
         | balls | steps a second | ms of a step | µs a ball | of the line before | while falling | asleep |\n\
         |---:|---:|---:|---:|---:|---:|---:|\n"
    );
    let mut last: Option<f64> = None;
    for row in rows {
        let (rate, cost) = (row.rate(), row.cost());
        let (steps, took) = row.pour;
        let falling = f64::from(steps) / took.as_secs_f64().max(1e-9);
        let times = last.map_or("-".to_owned(), |last| format!("{:.1} ×", cost / last));
        let _ = writeln!(
            text,
            "| {} | {rate:.2} | {:.1} | {:.2} | {times} | {falling:.2} | {} |",
            row.count,
            1e3 * cost,
            1e6 * cost / f64::from(row.count),
            row.asleep
        );
        last = Some(cost);
    }
}
