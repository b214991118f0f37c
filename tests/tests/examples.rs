//! Every example compiles and is drawn by the GPU, in every view.

use crate::common::{compile_file, examples, gpu, pictures};
use std::fmt::Write;
use std::time::Instant;
use surefoot_runtime::ViewMode;
use surefoot_runtime::headless::{self, Shot};

const MODES: [(ViewMode, &str); 4] = [
    (ViewMode::Shaded, "shaded"),
    (ViewMode::Normals, "normals"),
    (ViewMode::Steps, "steps"),
    (ViewMode::Depth, "depth"),
];

#[test]
fn every_example_is_drawn() {
    let gpu = gpu();
    let mut table = format!(
        "on {}\n{:14} {:>10} {:>8} {:>10} {:>10}\n",
        gpu.name(),
        "scene",
        "compile ms",
        "WGSL KB",
        "shaded ms",
        "colours"
    );
    let mut wrong = Vec::new();
    for (name, path) in examples() {
        let start = Instant::now();
        let compiled = match compile_file(&path) {
            Ok(compiled) => compiled,
            Err(words) => {
                wrong.push(format!("{name} does not compile:\n{words}"));
                continue;
            }
        };
        let compiling = start.elapsed();
        let mut row = String::new();
        for (mode, view) in MODES {
            let start = Instant::now();
            let shot = Shot { mode, ..Shot::new(320, 180) };
            let pixels = match headless::render(&gpu, &compiled, &compiled.live(), &shot) {
                Ok(pixels) => pixels,
                Err(error) => {
                    wrong.push(format!("{name}, {view}: {error}"));
                    continue;
                }
            };
            let mut colors: Vec<_> = pixels.rgba.chunks(4).collect();
            colors.sort();
            colors.dedup();
            // A picture of one colour, or of two, shows nothing; the normals of a sponge are those of its three faces, the cut and the floor.
            let least = if (&*name, mode) == ("menger", ViewMode::Normals) { 5 } else { 8 };
            if colors.len() < least {
                wrong.push(format!("{name}, {view}: {} colours", colors.len()));
            }
            if mode == ViewMode::Shaded {
                let (drawing, kilobytes) =
                    (start.elapsed(), compiled.module.wgsl.len() as f64 / 1024.0);
                let (a, b) = (compiling.as_secs_f64() * 1e3, drawing.as_secs_f64() * 1e3);
                write!(row, "{name:14} {a:10.1} {kilobytes:8.1} {b:10.1} {:10}", colors.len())
                    .unwrap();
            }
            let file = pictures().join(format!("{name}-{view}.png"));
            image::save_buffer(file, &pixels.rgba, 320, 180, image::ColorType::Rgba8).unwrap();
        }
        writeln!(table, "{row}").unwrap();
    }
    println!("{table}");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
