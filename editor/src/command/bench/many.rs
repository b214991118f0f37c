//! `surefoot bench --many`: what a union costs as it grows, with the lists of its cells and without.

use super::timing::milliseconds;
use crate::command::bar::LateBar;
use crate::command::console::{Exit, Failure, print};
use crate::command::page;
use plotters::prelude::*;
use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;
use surefoot_compiler::compiled::Compiled;
use surefoot_compiler::{MemoryLoader, Options, compile};
use surefoot_runtime::headless::{self, FORMAT, Shot};
use surefoot_runtime::{Gpu, Picture, ViewMode};

/// Numbers of spheres.
const COUNTS: [usize; 8] = [10, 32, 100, 316, 1001, 3162, 6000, 10_000];
/// Beyond so many the whole list takes minutes.
const MOST_WHOLE: usize = 1001;
/// First pictures of which the median counts, up to so many operands; beyond one says enough.
const FIRSTS: usize = 5;
/// More pixels than edges make differ.
const MOST_DIFFERENT: usize = 1000;
/// Side of the pictures in pixels.
const SIDE: u32 = 512;

/// What is measured: a name, how many operands it has, and its text without light.
struct Subject {
    name: String,
    count: usize,
    text: String,
}

const CAMERA: &str = "camera { eye: (2.4, 1.6, 2.8), target: (0, 0, 0) }\n";
/// Light with all that costs.
const LIT: &str = "light sun { direction: (-1, -2, -1.5), shadow: soft(16) }\n";
/// Light that costs nothing, so that the eye's rays are all that is traced.
const BARE: &str = "light sun { direction: (-1, -2, -1.5), shadow: none }\nrender { ambient_occlusion: (0, 0) }\n";

/// Spheres smoothly joined, in a cube that they fill alike however many they are; some of them `moving`.
fn spheres(count: usize, moving: bool) -> Subject {
    let size = (count as f64 / 1001.0).cbrt().recip();
    let (radius, reach) = (0.04 * size, 0.03 * size);
    let up = if moving { format!(" + {radius} * sin(time + i)") } else { String::new() };
    let text = format!(
        "scene = for i in 0..{count} by smooth_union({reach}) {{
  sphere({radius} + {radius} * hash(i, 3)).translate(2 * hash(i, 0) - 1, 2 * hash(i, 1) - 1{up}, 2 * hash(i, 2) - 1)
}}
{CAMERA}"
    );
    Subject { name: if moving { "spheres, moving" } else { "spheres" }.to_owned(), count, text }
}

/// Rounded boxes, joined by a tree of smooth unions 41 deep.
fn boxes() -> Subject {
    let text = format!(
        "shape piece(i: int) = rounded_box((0.1 + 0.2 * hash(i, 5), 0.1 + 0.2 * hash(i, 6), 0.1 + 0.2 * hash(i, 7)), 0.02)
  .rotate(y, hash(i, 3) * 90deg).rotate(x, hash(i, 4) * 90deg)
  .translate(2 * hash(i, 0) - 1, 2 * hash(i, 1) - 1, 2 * hash(i, 2) - 1)
scene = smooth_union(for i in 0..37 by smooth_union(0.05) {{ for j in 0..5 by smooth_union(0.02) {{ piece(5 * i + j) }} }}, piece(185), 0.05)
{CAMERA}"
    );
    Subject { name: "boxes in a tree".to_owned(), count: 186, text }
}

/// Times in milliseconds.
struct Row {
    subject: Subject,
    compile: f64,
    lists: f64,
    /// From text to picture: lists and pipeline too.
    first: f64,
    next: f64,
    /// From text in which a number changed to the next picture.
    reload: f64,
    /// The eye's rays alone.
    rays: f64,
    /// The same with the whole list everywhere.
    whole: Option<f64>,
    /// Pixels that differ by more than a 255th.
    different: usize,
}

/// Measures and prints; writes the table and its curve where a page is asked for.
pub fn run(page: Option<&Path>) -> Result<Exit, Failure> {
    let gpu = Gpu::headless().map_err(|e| Failure { exit: Exit::NoGraphics, words: e.to_string() })?;
    let bar = LateBar::new();
    let mut subjects: Vec<Subject> = COUNTS.into_iter().map(|count| spheres(count, false)).collect();
    subjects.extend([boxes(), spheres(1001, true)]);
    let all = subjects.len() as f64;
    let mut rows = Vec::new();
    for subject in subjects {
        rows.push(row(&gpu, subject).map_err(|words| Failure { exit: Exit::Errors, words })?);
        bar.show(rows.len() as f64 / all);
    }
    drop(bar);
    let table = table(&gpu, &rows);
    print(table.as_bytes())?;
    if let Some(file) = page {
        let curve = file.with_file_name("many.svg");
        draw_curve(&curve, &rows).map_err(|e| Failure::usage(format!("can't write {}: {e}", curve.display())))?;
        let words = format!(
            "## Unions of many\n\nWritten by `surefoot bench --many --page {}`.\n\n{table}\n![Time against the number of spheres](many.svg)\n",
            file.display()
        );
        page::put(file, "many", &words)?;
    }
    Ok(Exit::Fine)
}

fn row(gpu: &Gpu, subject: Subject) -> Result<Row, String> {
    let lit = subject.text.clone() + LIT;
    // Each first picture is that of a new device, which knows no pipeline yet.
    let mut firsts = Vec::new();
    for _ in 0..if subject.count <= MOST_WHOLE { FIRSTS } else { 1 } {
        let cold = Gpu::headless().map_err(|e| e.to_string())?;
        let start = Instant::now();
        let compiled = scene(&lit)?;
        let compile = milliseconds(start.elapsed());
        draw(&cold, &mut Picture::prepare(&cold, &compiled, FORMAT, ViewMode::Shaded)?, &compiled)?;
        firsts.push((milliseconds(start.elapsed()), compile));
    }
    firsts.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let (first, compile) = firsts.get(firsts.len() / 2).copied().unwrap_or_default();
    let compiled = scene(&lit)?;
    let mut picture = Picture::prepare(gpu, &compiled, FORMAT, ViewMode::Shaded)?;
    draw(gpu, &mut picture, &compiled)?;
    let start = Instant::now();
    draw(gpu, &mut picture, &compiled)?;
    let next = milliseconds(start.elapsed());
    let start = Instant::now();
    let changed = scene(&lit.replace("hash(i, 0)", "hash(i, 8)"))?;
    draw(gpu, &mut Picture::prepare(gpu, &changed, FORMAT, ViewMode::Shaded)?, &changed)?;
    let reload = milliseconds(start.elapsed());
    let again = scene(&lit)?;
    let start = Instant::now();
    if let Some(tables) = &again.module.tables {
        tables.lists();
    }
    let lists = milliseconds(start.elapsed());

    let mut bare = scene(&(subject.text.clone() + BARE))?;
    let (rays, pixels) = show(gpu, &bare)?;
    let (mut whole, mut different) = (None, 0);
    if subject.count <= MOST_WHOLE
        && let Some(tables) = bare.module.tables.take()
    {
        bare.module.tables = Some(Arc::new(tables.whole()));
        let (time, others) = show(gpu, &bare)?;
        different = pixels.chunks(4).zip(others.chunks(4)).filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 1)).count();
        whole = Some(time);
    }
    Ok(Row { subject, compile, lists, first, next, reload, rays, whole, different })
}

fn scene(text: &str) -> Result<Compiled, String> {
    let loader = MemoryLoader::new().with("many.sdf", text);
    compile(&loader, "many.sdf", &Options::default()).compiled.ok_or_else(|| "the scene does not compile".to_owned())
}

fn draw(gpu: &Gpu, picture: &mut Picture, compiled: &Compiled) -> Result<Vec<u8>, String> {
    Ok(headless::render_with(gpu, picture, compiled, &compiled.live(), &Shot::new(SIDE, SIDE))?.rgba)
}

/// A picture whose pipeline is there, and the time that it took. A driver builds some of it only when it first draws.
fn show(gpu: &Gpu, compiled: &Compiled) -> Result<(f64, Vec<u8>), String> {
    let mut picture = Picture::prepare(gpu, compiled, FORMAT, ViewMode::Shaded)?;
    draw(gpu, &mut picture, compiled)?;
    let start = Instant::now();
    let pixels = draw(gpu, &mut picture, compiled)?;
    Ok((milliseconds(start.elapsed()), pixels))
}

fn table(gpu: &Gpu, rows: &[Row]) -> String {
    let mut text = format!(
        "Operands smoothly joined, {SIDE}×{SIDE} on {}; milliseconds. *First* is the first picture of a new device with soft shadows and occlusion, from its text on, the median of {FIRSTS} up to {MOST_WHOLE} operands; \
         *next* one more; *reload* the picture after a number of the text changed, from the text on. *Rays* are those of the eye alone, with the \
         lists of the cells and with the whole list everywhere.\n\n\
         | | operands | compiled | lists | first | next | reload | rays | with whole lists | times as long | pixels that differ |\n\
         |---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n",
        gpu.name()
    );
    let mut cut = false;
    for row in rows {
        let Row { subject: Subject { name, count, .. }, compile, lists, first, next, reload, rays, .. } = row;
        let (whole, times, different) = match row.whole {
            Some(whole) => {
                let short = row.different > MOST_DIFFERENT;
                cut |= short;
                (format!("{whole:.0}"), format!("{}{:.1}", if short { "> " } else { "" }, whole / rays), row.different.to_string())
            }
            None => ["-"; 3].map(str::to_owned).into(),
        };
        let _ = writeln!(
            text,
            "| {name} | {count} | {compile:.1} | {lists:.1} | {first:.0} | {next:.0} | {reload:.0} | {rays:.0} | {whole} | {times} | {different} |"
        );
    }
    if cut {
        text.push_str(
            "\nWhere many pixels differ it is the whole list that is cut short: a driver that is a program ends the loops of a pixel after 65,535 turns\n\
             in all. So the time beside them is too short too.\n",
        );
    }
    text
}

/// Time against the number of spheres, both logarithmic.
fn draw_curve(file: &Path, rows: &[Row]) -> Result<(), Box<dyn std::error::Error>> {
    let rows: Vec<&Row> = rows.iter().filter(|r| r.subject.name == "spheres").collect();
    let counts = |of: &dyn Fn(&Row) -> Option<f64>| -> Vec<(f64, f64)> {
        rows.iter().filter_map(|r| Some((r.subject.count as f64, of(r)?))).collect()
    };
    let lines = [
        ("first picture", counts(&|r| Some(r.first))),
        ("reload", counts(&|r| Some(r.reload))),
        ("next picture", counts(&|r| Some(r.next))),
        ("rays", counts(&|r| Some(r.rays))),
        ("rays, whole lists", counts(&|r| r.whole)),
    ];
    let times = || lines.iter().flat_map(|(_, places)| places.iter().map(|p| p.1));
    let (least, most) = (times().fold(f64::INFINITY, f64::min), times().fold(1.0, f64::max));
    let area = SVGBackend::new(file, (760, 480)).into_drawing_area();
    area.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&area)
        .margin(16)
        .x_label_area_size(40)
        .y_label_area_size(70)
        .build_cartesian_2d((8.0..14_000.0).log_scale(), (0.7 * least..1.5 * most).log_scale())?;
    chart.configure_mesh().x_desc("spheres").y_desc("milliseconds").draw()?;
    for (i, (name, places)) in lines.iter().enumerate() {
        let color = Palette99::pick(i).to_rgba();
        let dots = places.iter().map(|p| Circle::new(*p, 3, color.filled()));
        chart.draw_series(dots)?;
        chart.draw_series(LineSeries::new(places.iter().copied(), color))?.label(*name).legend(move |(x, y)| Circle::new((x + 8, y), 4, color.filled()));
    }
    chart.configure_series_labels().position(SeriesLabelPosition::UpperLeft).border_style(BLACK).background_style(WHITE).draw()?;
    area.present()?;
    Ok(())
}
