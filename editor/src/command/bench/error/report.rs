//! The numbers as a table for people and as JSON for programs.

use super::methods::METHODS;
use super::truth::{Errors, Unknown, Wrong};
use super::rows::{Args, Row, Scene};
use crate::command::console::{Failure, print};
use crate::command::page;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use surefoot_runtime::Gpu;
use surefoot_runtime::passes::rays::FUNCTIONS;

/// So many wrong pixels of a method are listed in tables.
const FEW: usize = 8;

/// A scene's table.
pub fn table(scene: &Scene) -> String {
    let pixels = scene.rows.first().map_or(String::new(), |row| {
        let e = &row.errors;
        format!("{} pixels judged, {} silhouettes, {} unknown", e.judged, e.silhouettes, scene.unknown.len())
    });
    let mut text = format!("\n{} (factor {:.3}; {pixels})\n", scene.path, scene.factor);
    text += &format!(
        "  {:<20}{:>9}{:>7}{:>8}{:>9}{:>8}{:>7}{:>8}{:>9}{:>9}{:>9}{:>9}\n",
        "method", "ms", "ratio", "steps", "ops/ray", "missed", "false", "inside", "p50 px", "p99 px", "max px", "normal°"
    );
    for row in &scene.rows {
        let e = &row.errors;
        let depth = |percent| Errors::percentile(&e.depth, percent);
        text += &format!(
            "  {:<20}{:>9.2}{:>7.2}{:>8.1}{:>9.0}{:>8}{:>7}{:>8}{:>9.4}{:>9.4}{:>9.3}{:>9.3}\n",
            row.method,
            row.time.as_secs_f64() * 1e3,
            row.ratio,
            steps(row),
            row.operations,
            e.missed,
            e.false_hits,
            e.inside,
            depth(50.0),
            depth(99.0),
            depth(100.0),
            Errors::percentile(&e.normal, 99.0),
        );
        text += &few_wrong(row).map(|pixel| format!("    {}\n", wrong_line(pixel))).collect::<String>();
    }
    for (method, why) in &scene.left_out {
        text += &format!("  {method:<20}not to be had: {why}\n");
    }
    text
}

/// What came of all scenes, and of those of each folder.
pub fn summary(scenes: &[Scene], methods: &[&str]) -> String {
    let all: Vec<&Scene> = scenes.iter().collect();
    let mut text = group("all", &all, methods);
    let folder = |s: &Scene| Path::new(&s.path).parent().map(Path::to_path_buf).unwrap_or_default();
    let folders: BTreeSet<PathBuf> = scenes.iter().map(folder).collect();
    for own in folders.iter().filter(|_| folders.len() > 1) {
        let of: Vec<&Scene> = scenes.iter().filter(|s| folder(s) == *own).collect();
        text += &group(&own.display().to_string(), &of, methods);
    }
    text
}

/// Ratios to the first method, errors, and sums of wrong pixels of some scenes, where they are several.
fn group(name: &str, scenes: &[&Scene], methods: &[&str]) -> String {
    if scenes.len() < 2 {
        return String::new();
    }
    let mut text = format!(
        "\n{name}, {} scenes: ratios to the first method, in the median and at least; wrong pixels; errors at the 99th percentile, in the median and at most\n  {:<14}{:>7}{:>7}{:>7}{:>7}{:>8}{:>7}{:>8}{:>9}{:>9}{:>9}{:>9}\n",
        scenes.len(),
        "method",
        "scenes",
        "time",
        "ops",
        "least",
        "missed",
        "false",
        "inside",
        "px",
        "most px",
        "normal°",
        "most °"
    );
    for method in methods {
        let rows: Vec<(&Row, &Row)> = scenes
            .iter()
            .filter_map(|s| Some((s.rows.iter().find(|r| r.method == **method)?, s.rows.first()?)))
            .collect();
        if rows.is_empty() {
            continue;
        }
        let at = |percent: f64, f: &dyn Fn(&(&Row, &Row)) -> f64| Errors::percentile(&rows.iter().map(f).collect::<Vec<_>>(), percent);
        let sum = |f: &dyn Fn(&Errors) -> usize| rows.iter().map(|(r, _)| f(&r.errors)).sum::<usize>();
        let operations = |(r, first): &(&Row, &Row)| r.operations / first.operations.max(1.0);
        let depth = |(r, _): &(&Row, &Row)| Errors::percentile(&r.errors.depth, 99.0);
        let normal = |(r, _): &(&Row, &Row)| Errors::percentile(&r.errors.normal, 99.0);
        text += &format!(
            "  {method:<14}{:>7}{:>7.2}{:>7.2}{:>7.2}{:>8}{:>7}{:>8}{:>9.4}{:>9.4}{:>9.3}{:>9.3}\n",
            rows.len(),
            at(50.0, &|(r, _)| r.ratio),
            at(50.0, &operations),
            at(0.0, &operations),
            sum(&|e| e.missed),
            sum(&|e| e.false_hits),
            sum(&|e| e.inside),
            at(50.0, &depth),
            at(100.0, &depth),
            at(50.0, &normal),
            at(100.0, &normal),
        );
    }
    text
}

/// Steps of a ray in the mean.
pub fn steps(row: &Row) -> f64 {
    row.errors.steps as f64 / row.errors.rays.max(1) as f64
}

/// Writes the tables as the first section of a page of Markdown.
pub fn write_page(file: &Path, curves: &Path, gpu: &Gpu, args: &Args, scenes: &[Scene]) -> Result<(), Failure> {
    let adapter = gpu.name();
    let software = match gpu.is_software() {
        true => "No graphics card was to be had where this page was written: the adapter is a program, whose times say nothing about graphics cards.\n\n",
        false => "",
    };
    let command = std::env::args().skip(1).collect::<Vec<_>>().join(" ");
    let name = curves.file_name().unwrap_or_default().to_string_lossy();
    let mut text = format!(
        "# Run time against error\n\n\
         Written by `surefoot {command}` on {adapter}: {}×{} pixels, {} views of each scene around what its camera looks at, medians of {} \
         rounds in which the methods take turns.\n\n{software}\
         What each ray meets is certified in intervals first. *Missed* pixels are those whose ray surely hits, and does not; *false* ones \
         surely miss, and hit; *inside* are hits deeper in the solid than half a pixel. Silhouettes are not judged: the neighbour meets \
         something else, or the ray passes a surface within a pixel's width before it meets one. Depth is the error along the ray in widths of a pixel, the normal's is in degrees, both at the 99th percentile. \
         Operations are those of the formulas, for each ray.\n\n\
         All methods stop as near to the surface as ours, so that a ratio compares what comes to about the same, but for *half-pixel* and *fixed*: \
         the first is auto-relaxation as it is published, which stops half a pixel before the surface, takes fewer looks for that, and errs by as much as its \
         columns say; *no-leap* is the same method with our tolerance. Ratios are a method's over ours, so ours takes at most one part in *least* of its \
         operations anywhere.\n\n![Time against error]({name})\n\n## The methods\n\n",
        args.size.0, args.size.1, args.views, args.rounds()
    );
    for (method, about) in METHODS {
        text += &format!("- **{method}**: {about}\n");
    }
    let methods: Vec<&str> = METHODS.iter().map(|(name, _)| *name).collect();
    text += &format!("\n## All scenes\n\n```\n{}```\n\n## Scene by scene\n\n```\n", summary(scenes, &methods).trim_start());
    text += scenes.iter().map(table).collect::<String>().trim_start();
    text += "```\n";
    page::put(file, "bench", &text)
}

/// Writes the errors of some methods, a line for each scene, as a section of a page of Markdown.
pub fn write_errors(file: &Path, adapter: &str, args: &Args, scenes: &[Scene]) -> Result<(), Failure> {
    let command = std::env::args().skip(1).collect::<Vec<_>>().join(" ");
    let mut text = format!(
        "## Errors, scene by scene\n\n\
         Written by `surefoot {command}` on {adapter}: {}×{} pixels, {} views of each scene around what its camera looks at, judged as above. \
         *Apart* are silhouettes at which hit and miss are the other way round.\n\n\
         | scene | pixels judged | silhouettes | unknown | method | missed | false | inside | apart | depth, p99 | normal, p99 |\n\
         |---|---:|---:|---:|---|---:|---:|---:|---:|---:|---:|\n",
        args.size.0,
        args.size.1,
        args.views,
    );
    for scene in scenes {
        for (i, row) in scene.rows.iter().enumerate() {
            let e = &row.errors;
            text += &match i {
                0 => format!("| {} | {} | {} | {} ", name(scene), e.judged, e.silhouettes, scene.unknown.len()),
                _ => "| | | | ".to_owned(),
            };
            text += &format!(
                "| {} | {} | {} | {} | {} | {:.4} px | {:.3}° |\n",
                row.method,
                e.missed,
                e.false_hits,
                e.inside,
                e.silhouettes_apart,
                Errors::percentile(&e.depth, 99.0),
                Errors::percentile(&e.normal, 99.0),
            );
        }
    }
    let unknown: Vec<String> = scenes.iter().flat_map(|scene| scene.unknown.iter().map(move |pixel| unknown_line(scene, pixel))).collect();
    if !unknown.is_empty() {
        text += &format!("\nPixels of which it is not certain what they show:\n\n{}", unknown.concat());
    }
    let wrong = scenes.iter().flat_map(|scene| scene.rows.iter().flat_map(move |row| few_wrong(row).map(move |pixel| (scene, row, pixel))));
    let wrong: Vec<String> = wrong.map(|(scene, row, pixel)| format!("- {}, {}, {}\n", name(scene), row.method, wrong_line(pixel))).collect();
    if !wrong.is_empty() {
        text += &format!("\nWrong pixels of methods that have but a few in a scene:\n\n{}", wrong.concat());
    }
    page::put(file, "errors", &text)
}

fn name(scene: &Scene) -> std::borrow::Cow<'_, str> {
    Path::new(&scene.path).file_stem().unwrap_or_default().to_string_lossy()
}

fn unknown_line(scene: &Scene, pixel: &Unknown) -> String {
    let (x, y) = pixel.at;
    format!("- {}, view {}, column {x}, row {y}: {} at {:.4}\n", name(scene), pixel.view, pixel.doubt.why, pixel.doubt.t)
}

/// The wrong pixels of a method that has so few of them that each can be looked at, else none.
fn few_wrong(row: &Row) -> impl Iterator<Item = &Wrong> {
    row.errors.wrong.iter().filter(|_| row.errors.wrong.len() <= FEW)
}

fn wrong_line(pixel: &Wrong) -> String {
    let (x, y) = pixel.at;
    let truth = if pixel.truth.is_finite() { format!("the surface is at {:.4}", pixel.truth) } else { "there is no surface".to_owned() };
    format!("view {}, column {x}, row {y}: {}, {truth}, the ray ended at {:.4}", pixel.view, pixel.what, pixel.answered)
}

/// Writes all numbers.
pub fn write_json(file: &Path, adapter: &str, args: &Args, scenes: &[Scene]) -> Result<(), Failure> {
    let value = json!({
        "adapter": adapter,
        "size": [args.size.0, args.size.1],
        "views": args.views,
        "rounds": args.rounds(),
        "scenes": scenes.iter().map(scene_json).collect::<Vec<_>>(),
    });
    let text = format!("{value:#}\n");
    if file == Path::new("-") {
        return print(text.as_bytes());
    }
    std::fs::write(file, text).map_err(|e| Failure::usage(format!("can't write {}: {e}", file.display())))
}

fn scene_json(scene: &Scene) -> Value {
    json!({
        "scene": scene.path,
        "factor": scene.factor,
        "methods": scene.rows.iter().map(row_json).collect::<Vec<_>>(),
        "unknown": scene.unknown.iter().map(unknown_json).collect::<Vec<_>>(),
        "left_out": scene.left_out.iter().map(|(method, why)| json!({ "method": method, "why": why })).collect::<Vec<_>>(),
    })
}

fn unknown_json(pixel: &Unknown) -> Value {
    json!({ "view": pixel.view, "x": pixel.at.0, "y": pixel.at.1, "t": pixel.doubt.t, "why": pixel.doubt.why })
}

fn wrong_json(pixel: &Wrong) -> Value {
    let truth = pixel.truth.is_finite().then_some(pixel.truth);
    json!({ "view": pixel.view, "x": pixel.at.0, "y": pixel.at.1, "what": pixel.what, "t": truth, "answered": pixel.answered })
}

fn row_json(row: &Row) -> Value {
    let e = &row.errors;
    let spread = |values: &[f64]| {
        let at = |percent| Errors::percentile(values, percent);
        json!({ "p50": at(50.0), "p99": at(99.0), "max": at(100.0) })
    };
    let looks = FUNCTIONS.iter().zip(e.looks).map(|(name, looks)| ((*name).to_owned(), looks.into()));
    json!({
        "method": row.method,
        "about": row.about,
        "milliseconds": row.time.as_secs_f64() * 1e3,
        "ratio": row.ratio,
        "steps_per_ray": steps(row),
        "operations_per_ray": row.operations,
        "looks": looks.collect::<serde_json::Map<_, _>>(),
        "rays": e.rays,
        "judged": e.judged,
        "silhouettes": e.silhouettes,
        "unknown": e.unknown,
        "missed": e.missed,
        "false": e.false_hits,
        "inside": e.inside,
        "wrong": e.wrong.iter().map(wrong_json).collect::<Vec<_>>(),
        "silhouettes_apart": e.silhouettes_apart,
        "depth_pixels": spread(&e.depth),
        "normal_degrees": spread(&e.normal),
    })
}
