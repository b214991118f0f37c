//! `surefoot bench --hand`: our modules beside WGSL that a person wrote for the same scenes.

use super::error::truth::{Answer, BOXES, Errors, View};
use super::timing::milliseconds;
use crate::command::bar::LateBar;
use crate::command::console::{Exit, Failure, compile_file, print, show_diagnostics};
use crate::command::page;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;
use surefoot_compiler::Options;
use surefoot_compiler::reference::Reference;
use surefoot_runtime::Gpu;
use surefoot_runtime::passes::rays::{Follower, Rays};

/// Pixels of a picture, each way.
const SIDE: u32 = 128;
/// The light of a scene by the functions of a module.
const LIT: &str = include_str!("hand/lit.wgsl");

/// What came of one text in one scene.
struct Row {
    scene: String,
    name: &'static str,
    /// Of the rays alone, and with normal, shadow and occlusion: median time, and median of the ratios to ours in the same round.
    times: [(Duration, f64); 2],
    steps: f64,
    errors: Errors,
}

/// Measures the texts, in so many timed rounds: each names its scene in its first line, and stands beside `demo.wgsl`.
pub fn run(files: &[PathBuf], rounds: u32, into: Option<&Path>) -> Result<Exit, Failure> {
    let gpu = Gpu::headless().map_err(|why| Failure { exit: Exit::NoGraphics, words: why.to_string() })?;
    let bar = LateBar::new();
    let mut rows = Vec::new();
    for (i, file) in files.iter().enumerate() {
        let read = |path: &Path| std::fs::read_to_string(path).map_err(|e| Failure::usage(format!("can't read {}: {e}", path.display())));
        let text = read(file)?;
        let demo = read(&file.with_file_name("demo.wgsl"))?;
        let scene = text.lines().next().and_then(|l| l.strip_prefix("// Scene: "));
        let scene = scene.ok_or_else(|| Failure::usage(format!("the first line of {} is no `// Scene: FILE`", file.display())))?;
        let outcome = compile_file(scene, &Options::default())?;
        let Some(compiled) = &outcome.compiled else {
            show_diagnostics(&outcome);
            return Ok(Exit::Errors);
        };
        let show = |part: f64| bar.show((i as f64 + part) / files.len() as f64);
        rows.extend(measure(&gpu, scene, compiled, &format!("{text}\n{demo}"), rounds, &show).map_err(Failure::usage)?);
    }
    bar.finish();
    let table = table(&gpu, rounds, &rows);
    if let Some(file) = into {
        page::put(file, "hand", &table)?;
    }
    print(table.as_bytes())?;
    Ok(Exit::Fine)
}

fn measure(
    gpu: &Gpu,
    path: &str,
    scene: &surefoot_compiler::Compiled,
    hand: &str,
    rounds: u32,
    show: &dyn Fn(f64),
) -> Result<[Row; 2], String> {
    let live = scene.live();
    let frame = scene.frame(&live);
    let (_, camera) = frame.cameras.first().ok_or("there is no camera")?;
    let mut view = View::new(scene, &live, camera, (SIDE, SIDE), BOXES, &|| {})?;
    // A person's text knows nothing of another origin.
    view.picture.origin = [0.0; 3];
    for (gpu, ray) in view.picture.rays.iter_mut().zip(&view.rays) {
        gpu.origin = ray.origin.map(|c| c as f32);
    }
    let reference = Reference::new(scene, &live).map_err(|e| e.to_string())?;
    let consts = hand.lines().filter(|l| l.starts_with("const SUN") || l.starts_with("const SOFTNESS"));
    let own = format!("{}\n{LIT}", consts.collect::<Vec<_>>().join("\n"));
    let follow = |wgsl: &str, name: &str| Rays::new(gpu, scene, &live, &Follower { wgsl, name, count: false }, &view.picture);
    let programs = [follow("", "sf_trace")?, follow(&own, "lit")?, follow(hand, "demo_trace")?, follow(hand, "lit")?];
    let mut times: [Vec<Duration>; 4] = Default::default();
    // The first round makes the machine code and is not counted.
    for round in 0..=rounds {
        show(0.5 + 0.5 * f64::from(round) / f64::from(rounds));
        for (program, times) in programs.iter().zip(&mut times) {
            let took = program.run()?;
            if round > 0 {
                times.push(took);
            }
        }
    }
    let median = |values: Vec<f64>| Errors::percentile(&values, 50.0);
    let row = |name, traced: usize| {
        let answers: Vec<Answer> = programs[traced].read()?.iter().map(Answer::from).collect();
        let mut errors = Errors::default();
        view.judge(&reference, &answers, &mut errors);
        let time = |program: usize, ours: usize| {
            let seconds = times[program].iter().map(Duration::as_secs_f64);
            let ratios = seconds.clone().zip(&times[ours]).map(|(a, b)| a / b.as_secs_f64());
            (Duration::from_secs_f64(median(seconds.clone().collect())), median(ratios.collect()))
        };
        let steps = errors.steps as f64 / errors.rays.max(1) as f64;
        Ok::<_, String>(Row { scene: path.to_owned(), name, times: [time(traced, 0), time(traced + 1, 1)], steps, errors })
    };
    Ok([row("ours", 0)?, row("by hand", 2)?])
}

fn table(gpu: &Gpu, rounds: u32, rows: &[Row]) -> String {
    let command = std::env::args().skip(1).collect::<Vec<_>>().join(" ");
    let mut text = format!(
        "## Beside WGSL by hand\n\n\
         Written by `surefoot {command}` on {}: {SIDE}×{SIDE} pixels, medians of {rounds} rounds in which the four programs take turns. The same \
         shapes, camera and light, written as for a demo: its own map, a hundred steps of a factor, a hit at a thousandth of the way, a normal from four \
         looks, a soft shadow and occlusion. *Of ours* is its time over that of our module in the same round: above 1 ours is faster. *Lit* is with normal, \
         shadow and occlusion. Errors are those of the rays alone, as in the tables above.\n\n\
         | scene | | rays, ms | of ours | lit, ms | of ours | steps | missed | false | inside | p50 px | p99 px | normal° p99 |\n\
         |---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n",
        gpu.name()
    );
    for row in rows {
        let (e, [rays, lit]) = (&row.errors, &row.times);
        let at = |values: &[f64], percent| Errors::percentile(values, percent);
        let _ = writeln!(
            text,
            "| {} | {} | {:.2} | {:.2} | {:.2} | {:.2} | {:.1} | {} | {} | {} | {:.3} | {:.3} | {:.2} |",
            row.scene,
            row.name,
            milliseconds(rays.0),
            rays.1,
            milliseconds(lit.0),
            lit.1,
            row.steps,
            e.missed,
            e.false_hits,
            e.inside,
            at(&e.depth, 50.0),
            at(&e.depth, 99.0),
            at(&e.normal, 99.0)
        );
    }
    text
}
