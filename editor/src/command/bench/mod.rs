//! `surefoot bench`: run time against error, how long the compiler takes, and how tight its factors are.

#[cfg(feature = "gpu")]
mod ablation;
#[cfg(feature = "gpu")]
mod balls;
mod certified;
mod edits;
#[cfg(feature = "gpu")]
pub mod error;
mod factors;
#[cfg(feature = "gpu")]
mod hand;
#[cfg(feature = "gpu")]
mod light;
#[cfg(feature = "gpu")]
mod many;
mod operands;
#[cfg(feature = "gpu")]
mod parts;
mod timing;
#[cfg(feature = "gui")]
mod window;

use timing::{in_memory, milliseconds, percentile};
use super::console::{Exit, Failure, compile_file, print, show_diagnostics};
use serde_json::json;
use std::time::{Duration, Instant};
use surefoot_compiler::{Loader, Memory, Options, Stage, compile_remembering, emit};

/// What to measure.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Trace these scenes with several methods, and compare each with certified results.
    #[arg(required_unless_present_any = ["compile", "edits", "factors", "rules", "many", "balls", "parts", "hand", "operands", "operand", "light", "ablation", "window", "certified"])]
    scenes: Vec<String>,
    #[cfg(feature = "gpu")]
    #[command(flatten)]
    error: error::Args,
    /// Measure the compilation of this scene.
    #[arg(long, value_name = "SCENE", conflicts_with = "scenes")]
    compile: Option<String>,
    /// Measure recompiling this scene, with cached results, after each of its numbers is edited in turn.
    #[arg(long, value_name = "SCENE", conflicts_with_all = ["scenes", "compile"])]
    edits: Option<String>,
    /// Compare the factors of these scenes with the steepest place found: at once, within an edit, and after a long search.
    #[arg(long, value_name = "SCENES", num_args = 1.., conflicts_with_all = ["scenes", "compile", "edits"])]
    factors: Vec<String>,
    /// Compare the factor of each rule of this file with the certified supremum.
    #[arg(long, value_name = "RULES", conflicts_with_all = ["scenes", "compile", "edits", "factors"])]
    rules: Option<String>,
    /// Measure unions of 10 to 10,000 spheres, with and without the operand lists of cells.
    #[arg(long, conflicts_with_all = ["scenes", "compile", "edits", "factors", "rules"])]
    many: bool,
    /// Measure the steps per second of these scenes with 1,000 to 1,000,000 balls.
    #[arg(long, value_name = "SCENES", num_args = 1.., conflicts_with_all = ["scenes", "compile", "edits", "factors", "rules", "many"])]
    balls: Vec<String>,
    /// Measure the frames of these scenes with one part of the tracer switched off at a time.
    #[arg(long, value_name = "SCENES", num_args = 1.., conflicts_with_all = ["scenes", "compile", "edits", "factors", "rules", "many", "balls"])]
    parts: Vec<String>,
    /// Compare hand-written WGSL (tests/hand/*.wgsl) with the modules of the same scenes: time and error.
    #[arg(long, value_name = "WGSL", num_args = 1.., conflicts_with_all = ["scenes", "compile", "edits", "factors", "rules", "many", "balls"])]
    hand: Vec<std::path::PathBuf>,
    /// Compile unions, blends and drawings of many operands with a small stack: result, time and memory.
    #[arg(long, conflicts_with_all = ["scenes", "compile", "edits", "factors", "rules", "many", "balls", "parts", "hand"])]
    operands: bool,
    /// How many operands.
    #[arg(long, value_name = "N,…", value_delimiter = ',', default_values_t = [1000, 3000, 10_000], requires = "operands")]
    counts: Vec<usize>,
    /// One of these scenes, by its text, in this process.
    #[arg(long, hide = true, conflicts_with_all = ["scenes", "operands"])]
    operand: Option<String>,
    /// Compare shadow and occlusion of these scenes with the truth.
    #[arg(long, value_name = "SCENES", num_args = 1..)]
    light: Vec<String>,
    /// Measure what each rule for bounds gains, in its own scene and in these.
    #[arg(long, value_name = "SCENES", num_args = 1..)]
    ablation: Vec<String>,
    /// Measure a window on this scene, or one of 1,000 lines: the delay of a key and of the picture after it, and the cost of a caret.
    #[arg(long, value_name = "SCENE", num_args = 0..=1, default_missing_value = "", conflicts_with_all = ["scenes", "compile", "edits", "factors", "rules", "many", "balls", "parts", "hand", "operands"])]
    window: Option<String>,
    /// Mesh these scenes, and prove how far the meshes are from the surfaces at most.
    #[arg(long, value_name = "SCENES", num_args = 1.., conflicts_with_all = ["scenes", "compile", "edits", "factors", "rules", "many", "balls", "parts", "hand", "operands"])]
    certified: Vec<String>,
    /// Cells along the longest side of a mesh.
    #[arg(long, default_value_t = 64, value_name = "N", requires = "certified")]
    cells: u32,
    /// Write the tables to this file, as a section of a page; of scenes, the curves beside it, and for a subset of the methods only the errors.
    #[arg(long, value_name = "FILE")]
    page: Option<std::path::PathBuf>,
    /// The largest number of balls.
    #[arg(long, default_value_t = 1_000_000, value_name = "N", requires = "balls")]
    most: u32,
    /// The number of runs.
    #[arg(long, default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..))]
    runs: u32,
    /// Write one JSON object: with --compile, in place of the table; with scenes, into this file besides the tables.
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "-")]
    json: Option<std::path::PathBuf>,
}

/// What compiling a scene again and again took.
#[derive(Default)]
struct Runs {
    /// The stages in their order, and what each run took in them.
    stages: Vec<(&'static str, Vec<Duration>)>,
    /// How many steps of formulas the analysis of one run looked at: the same each time and on each machine.
    steps: u64,
}

/// Measures and prints. Files are read once and then kept, so that the disk is not what is measured.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    if let Some(path) = &args.edits {
        return edits::run(path, args.runs);
    }
    if let Some(path) = &args.rules {
        return factors::rules(path);
    }
    if !args.factors.is_empty() {
        return factors::run(&args.factors);
    }
    if let Some(text) = &args.operand {
        return operands::one(text);
    }
    if args.operands {
        let table = operands::run(&args.counts, args.json.is_some())?;
        return keep(args, &table);
    }
    if let Some(path) = &args.window {
        return in_window(path);
    }
    if !args.certified.is_empty() {
        return certified::run(&args.certified, args.cells, args.page.as_deref());
    }
    let Some(path) = &args.compile else { return drawn(args) };
    let first = compile_file(path, &Options::default())?;
    show_diagnostics(&first);
    if first.compiled.is_none() {
        return Ok(Exit::Errors);
    }
    let loader = in_memory(&first);
    // The first runs fill caches and are not counted.
    for _ in 0..args.runs.div_ceil(20) {
        measure(&loader, path, &mut Runs::default());
    }
    let mut runs = Runs::default();
    for _ in 0..args.runs {
        measure(&loader, path, &mut runs);
    }
    for (_, times) in &mut runs.stages {
        times.sort_unstable();
    }
    let text = if args.json.is_some() { in_json(path, args.runs, &runs) } else { table(path, args.runs, &runs) };
    print(text.as_bytes())?;
    Ok(Exit::Fine)
}

/// Writes the table of operands into a page, where one is asked for.
fn keep(args: &Args, table: &str) -> Result<Exit, Failure> {
    if let Some(file) = &args.page {
        let words = format!("## Many operands\n\nWritten by `surefoot bench --operands --page {}`.\n\n{table}", file.display());
        super::page::put(file, "operands", &words)?;
    }
    Ok(Exit::Fine)
}

/// What a graphics adapter is measured with.
#[cfg(feature = "gpu")]
fn drawn(args: &Args) -> Result<Exit, Failure> {
    let page = args.page.as_deref();
    if !args.light.is_empty() {
        light::run(&args.light, page)
    } else if !args.ablation.is_empty() {
        ablation::run(&args.ablation, page)
    } else if args.many {
        many::run(page)
    } else if !args.balls.is_empty() {
        balls::run(&args.balls, args.most, page)
    } else if !args.parts.is_empty() {
        parts::run(&args.parts, page)
    } else if !args.hand.is_empty() {
        hand::run(&args.hand, args.error.rounds.unwrap_or(20), page)
    } else {
        error::run(&args.scenes, &args.error, args.json.as_deref(), page)
    }
}

#[cfg(feature = "gui")]
use window::run as in_window;

#[cfg(not(feature = "gui"))]
fn in_window(_: &str) -> Result<Exit, Failure> {
    Err(Failure::usage("this program was built without a window"))
}

#[cfg(not(feature = "gpu"))]
fn drawn(_: &Args) -> Result<Exit, Failure> {
    Err(Failure { exit: Exit::NoGraphics, words: "this program was built without graphics".to_owned() })
}

/// One run: the time of each stage, of all together, and of naga's validation, which is not a part of compiling.
fn measure(loader: &dyn Loader, path: &str, runs: &mut Runs) {
    let start = Instant::now();
    let mut last = start;
    let mut stages: Vec<(Stage, Duration)> = Vec::new();
    let mut memory = Memory::default();
    let outcome = compile_remembering(loader, path, &Options::default(), &mut memory, &mut |stage| {
        let now = Instant::now();
        stages.push((stage, now - last));
        last = now;
    });
    let whole = start.elapsed();
    for (stage, took) in stages {
        runs.add(stage.name(), took);
    }
    runs.add("all of it", whole);
    if let Some(compiled) = &outcome.compiled {
        let start = Instant::now();
        // Whether it is valid is not asked here.
        let valid = emit::validate(&compiled.module.wgsl);
        runs.add("naga's check", start.elapsed());
        drop(valid);
    }
    runs.steps = memory.steps;
}

impl Runs {
    fn add(&mut self, name: &'static str, took: Duration) {
        match self.stages.iter_mut().find(|(known, _)| *known == name) {
            Some((_, times)) => times.push(took),
            None => self.stages.push((name, vec![took])),
        }
    }
}

fn table(path: &str, count: u32, runs: &Runs) -> String {
    let mut text = format!("{path}, {count} runs{:>13}{:>12}\n", "median", "p95");
    for (name, times) in &runs.stages {
        let (median, p95) =
            (milliseconds(percentile(times, 50)), milliseconds(percentile(times, 95)));
        text.push_str(&format!("  {name:<20}{median:>9.3} ms{p95:>9.3} ms\n"));
    }
    text.push_str(&format!("  {} steps of formulas looked at\n", runs.steps));
    text
}

fn in_json(path: &str, count: u32, runs: &Runs) -> String {
    let stages = runs.stages.iter().map(|(name, times)| {
        json!({
            "name": name,
            "median_ms": milliseconds(percentile(times, 50)),
            "p95_ms": milliseconds(percentile(times, 95)),
        })
    });
    format!(
        "{}\n",
        json!({ "scene": path, "runs": count, "stages": stages.collect::<Vec<_>>(), "steps": runs.steps })
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_values_that_were_measured() {
        let times: Vec<_> = (1..=200).map(Duration::from_millis).collect();
        assert_eq!(percentile(&times, 50), Duration::from_millis(100));
        assert_eq!(percentile(&times, 95), Duration::from_millis(190));
        assert_eq!(percentile(&times[..1], 95), Duration::from_millis(1));
    }
}
