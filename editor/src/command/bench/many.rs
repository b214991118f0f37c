//! `surefoot bench --many`: what a union costs as it grows, with the lists of its cells and without.

use super::milliseconds;
use crate::command::bar::LateBar;
use crate::command::{Exit, Failure, print};
use std::fmt::Write;
use std::sync::Arc;
use std::time::Instant;
use surefoot_compiler::compiled::Compiled;
use surefoot_compiler::{MemoryLoader, Options, compile};
use surefoot_runtime::headless::{self, FORMAT, Shot};
use surefoot_runtime::{Gpu, Picture, ViewMode};

/// Numbers of spheres.
const COUNTS: [usize; 7] = [10, 32, 100, 316, 1001, 3162, 10_000];
/// Beyond so many the whole list takes minutes.
const MOST_WHOLE: usize = 1001;
/// More pixels than edges make differ.
const MOST_DIFFERENT: usize = 1000;
/// Side of the pictures in pixels.
const SIDE: u32 = 512;

/// Spheres smoothly joined, in a cube that they fill alike however many they are.
fn text(count: usize) -> String {
    let size = (count as f64 / 1001.0).cbrt().recip();
    let (radius, reach) = (0.04 * size, 0.03 * size);
    format!(
        "scene = for i in 0..{count} by smooth_union({reach}) {{
  sphere({radius} + {radius} * hash(i, 3)).translate(2 * hash(i, 0) - 1, 2 * hash(i, 1) - 1, 2 * hash(i, 2) - 1)
}}
camera {{ eye: (2.4, 1.6, 2.8), target: (0, 0, 0) }}
{}
"
    , std::env::var("TAIL").unwrap_or_default())
}

/// Times in milliseconds.
struct Row {
    count: usize,
    compile: f64,
    lists: f64,
    /// Pipeline and first picture, and one more picture.
    drawn: (f64, f64),
    /// The same with the whole list everywhere.
    whole: Option<(f64, f64)>,
    /// Pixels that differ by more than a 255th.
    different: usize,
}

/// Measures and prints.
pub fn run() -> Result<Exit, Failure> {
    let gpu = Gpu::headless().map_err(|e| Failure { exit: Exit::NoGraphics, words: e.to_string() })?;
    let bar = LateBar::new();
    let mut rows = Vec::new();
    for (i, count) in COUNTS.into_iter().enumerate() {
        rows.push(row(&gpu, count).map_err(|words| Failure { exit: Exit::Errors, words })?);
        bar.show((i + 1) as f64 / COUNTS.len() as f64);
    }
    drop(bar);
    print(table(&gpu, &rows).as_bytes())?;
    Ok(Exit::Fine)
}

fn row(gpu: &Gpu, count: usize) -> Result<Row, String> {
    let loader = MemoryLoader::new().with("many.sdf", text(count));
    let start = Instant::now();
    let outcome = compile(&loader, "many.sdf", &Options::default());
    let took = milliseconds(start.elapsed());
    let mut compiled = outcome.compiled.ok_or("the scene does not compile")?;
    let start = Instant::now();
    if let Some(tables) = &compiled.module.tables {
        tables.lists();
    }
    let lists = milliseconds(start.elapsed());
    let (drawn, pixels) = draw(gpu, &compiled)?;
    let (mut whole, mut different) = (None, 0);
    if count <= MOST_WHOLE
        && let Some(tables) = compiled.module.tables.take()
    {
        compiled.module.tables = Some(Arc::new(tables.whole()));
        let (times, others) = draw(gpu, &compiled)?;
        different = pixels.chunks(4).zip(others.chunks(4)).filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 1)).count();
        whole = Some(times);
    }
    Ok(Row { count, compile: took, lists, drawn, whole, different })
}

/// The times of the first picture and of another one, and what it shows.
fn draw(gpu: &Gpu, compiled: &Compiled) -> Result<((f64, f64), Vec<u8>), String> {
    let live = compiled.live();
    let shot = Shot::new(SIDE, SIDE);
    let start = Instant::now();
    let mut picture = Picture::prepare(gpu, compiled, FORMAT, ViewMode::Shaded)?;
    headless::render_with(gpu, &mut picture, compiled, &live, &shot)?;
    let first = milliseconds(start.elapsed());
    let start = Instant::now();
    let pixels = headless::render_with(gpu, &mut picture, compiled, &live, &shot)?;
    Ok(((first, milliseconds(start.elapsed())), pixels.rgba))
}

fn table(gpu: &Gpu, rows: &[Row]) -> String {
    let mut text = format!(
        "Spheres smoothly joined, {SIDE}×{SIDE} with soft shadows and occlusion, on {}; milliseconds.\n\n\
         | spheres | compiled | lists | first picture | next picture | with whole lists | times as long | pixels that differ |\n\
         |---:|---:|---:|---:|---:|---:|---:|---:|\n",
        gpu.name()
    );
    let mut cut = false;
    for row in rows {
        let (whole, times, different) = match row.whole {
            Some((_, next)) => (format!("{next:.0}"), format!("{:.1}", next / row.drawn.1), row.different.to_string()),
            None => ("-".to_owned(), "-".to_owned(), "-".to_owned()),
        };
        let Row { count, compile, lists, drawn: (first, next), .. } = row;
        cut |= row.different > MOST_DIFFERENT;
        let _ = writeln!(text, "| {count} | {compile:.1} | {lists:.1} | {first:.0} | {next:.0} | {whole} | {times} | {different} |");
    }
    if cut {
        text.push_str(
            "\nWhere many pixels differ it is the whole list that is cut short: a driver that is a program ends the loops of a pixel after 65,535 turns\n\
             in all. So the time beside them is too short too.\n",
        );
    }
    text
}
