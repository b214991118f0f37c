//! `surefoot bench --parts`: what a frame takes, and how much less without each of its parts.

use super::timing::milliseconds;
use crate::command::bar::LateBar;
use crate::command::console::{Exit, Failure, compile_file, print};
use crate::command::page;
use crate::files::FileLoader;
use std::fmt::Write;
use std::path::Path;
use std::time::{Duration, Instant};
use surefoot_compiler::compiled::Compiled;
use surefoot_compiler::Options;
use surefoot_runtime::headless::{self, FORMAT, Shot};
use surefoot_runtime::mesh::Assets;
use surefoot_runtime::passes::scene::Features;
use surefoot_runtime::{Gpu, Picture, ViewMode};

/// Width and height of the pictures in pixels.
const SIZE: (u32, u32) = (480, 320);
/// Of so many rounds, in which all variants take turns, the quickest counts: others share the machine.
const ROUNDS: usize = 7;

/// A part of a frame: its name, whether some features have it, and how they are without it.
struct Part(&'static str, fn(&Features) -> bool, fn(&mut Features));

const PARTS: [Part; 9] = [
    Part("meshes", |f| f.meshes, |f| (f.meshes, f.meshes_first) = (false, false)),
    Part("depth first", |f| f.meshes_first, |f| f.meshes_first = false),
    Part("cones", |f| f.cones, |f| f.cones = false),
    Part("shadows", |f| f.shadows, |f| (f.shadows, f.field_maps) = (false, false)),
    Part("occlusion", |f| f.occlusion, |f| f.occlusion = false),
    Part("reflections", |f| f.reflections > 0, |f| f.reflections = 0),
    Part("capture", |f| f.capture.is_some(), |f| f.capture = None),
    Part("sky's images", |f| f.environment, |f| f.environment = false),
    Part("surface's images", |f| f.textures > 0, |f| f.textures = 0),
];

/// Measures and prints; writes the table where a page is asked for.
pub fn run(scenes: &[String], page: Option<&Path>) -> Result<Exit, Failure> {
    let gpu = Gpu::headless().map_err(|e| Failure { exit: Exit::NoGraphics, words: e.to_string() })?;
    let bar = LateBar::new();
    let mut table = String::from("| scene | whole |");
    PARTS.iter().for_each(|part| table += &format!(" {} |", part.0));
    table += "\n|---|---|";
    PARTS.iter().for_each(|_| table += "---|");
    table.push('\n');
    for (i, path) in scenes.iter().enumerate() {
        let outcome = compile_file(path, &Options::default())?;
        let compiled = outcome.compiled.ok_or_else(|| Failure::usage(format!("{path} does not compile")))?;
        let times = times(&gpu, &compiled).map_err(|words| Failure { exit: Exit::Errors, words })?;
        let name = Path::new(path).file_stem().and_then(|name| name.to_str()).unwrap_or(path);
        let _ = write!(table, "| {name} | {:.1} ms |", times.0);
        for time in times.1 {
            match time {
                Some(time) => {
                    let _ = write!(table, " {:+.1} ms |", time - times.0);
                }
                None => table += " |",
            }
        }
        table.push('\n');
        bar.show((i + 1) as f64 / scenes.len() as f64);
    }
    drop(bar);
    print(table.as_bytes())?;
    if let Some(file) = page {
        let words = format!(
            "## Parts of a frame\n\nWritten by `surefoot bench --parts {} --page {}` on {}: {}×{} pixels, the quickest of {ROUNDS} rounds in which the variants \
take turns. Shadow maps and captures are drawn anew in each frame, as if all moved. Beside what the whole frame takes stands by how much that changes \
where one part is left out; `depth first` is that rays end at the depth of meshes, which is drawn before. An empty field: the scene has no such part.\n\n{table}",
            scenes.join(" "),
            file.display(),
            gpu.name(),
            SIZE.0,
            SIZE.1,
        );
        page::put(file, "parts", &words)?;
    }
    Ok(Exit::Fine)
}

/// What the whole frame takes, and what it takes without each of the parts that it has; in milliseconds.
fn times(gpu: &Gpu, compiled: &Compiled) -> Result<(f64, Vec<Option<f64>>), String> {
    let mut assets = Assets::new();
    assets.load(&FileLoader, compiled, &|_, _, _| {});
    let whole = Features::of(compiled, ViewMode::Shaded);
    let without = PARTS.iter().map(|Part(_, has, leave)| {
        has(&whole).then(|| {
            let mut features = whole;
            leave(&mut features);
            features
        })
    });
    let mut pictures = Vec::new();
    for features in std::iter::once(Some(whole)).chain(without) {
        pictures.push(match features {
            Some(features) => {
                let mut picture = Picture::prepare_with(gpu, compiled, FORMAT, features)?;
                picture.show_images(assets.images());
                picture.show_meshes(&assets.meshes(compiled))?;
                Some((picture, Vec::new()))
            }
            None => None,
        });
    }
    let live = compiled.live();
    // The first round makes what is made only once.
    for round in 0..=ROUNDS {
        for (picture, times) in pictures.iter_mut().flatten() {
            picture.forget();
            let start = Instant::now();
            headless::render_with(gpu, picture, compiled, &live, &Shot::new(SIZE.0, SIZE.1))?;
            if round > 0 {
                times.push(start.elapsed());
            }
        }
    }
    let least = |times: Vec<Duration>| milliseconds(times.into_iter().min().unwrap_or_default());
    let mut least: Vec<Option<f64>> = pictures.into_iter().map(|of| of.map(|(_, times)| least(times))).collect();
    let whole = least.remove(0).unwrap_or_default();
    Ok((whole, least))
}
