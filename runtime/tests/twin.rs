//! The GPU's picture of each example is the processor's: fewer than one pixel in two hundred differs by more than 8 of 255.

mod common;

use common::gpu;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use surefoot_compiler::compiled::{Loader, Options};
use surefoot_compiler::reference::{Area, Reference, View, film, rgb8};
use surefoot_compiler::{compile, diagnostic};
use surefoot_compiler::sampled::{Grid, Settings};
use surefoot_runtime::headless::{self, Shot};

const SIZE: (u32, u32) = (160, 90);

struct Files;

impl Loader for Files {
    fn read(&self, path: &str) -> Result<Vec<u8>, String> {
        std::fs::read(path).map_err(|e| e.to_string())
    }

    fn grid(&self, path: &str, settings: Settings) -> Result<Arc<Grid>, String> {
        surefoot_runtime::mesh::field::grid(self, path, settings, &|_| {})
    }
}

fn examples() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples");
    let mut paths: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "sdf"))
        .collect();
    paths.sort();
    paths
}

#[test]
fn every_example_looks_alike_on_both() {
    let gpu = gpu();
    let (width, height) = SIZE;
    let mut apart = Vec::new();
    for path in examples() {
        let name = path.to_str().unwrap();
        let outcome = compile(&Files, name, &Options::default());
        let words = diagnostic::render(&outcome.sources, &outcome.diagnostics, false);
        let Some(mut compiled) = outcome.compiled else { apart.push(words); continue };
        // Which the processor's picture leaves out.
        compiled.blocks.capture = None;
        let live = compiled.live();
        let frame = compiled.frame(&live);
        let reference = Reference::new(&compiled, &live).unwrap();
        for mode in [View::Shaded, View::Normals, View::Depth] {
            let shot = Shot { mode, ..Shot::new(width, height) };
            let drawn = headless::render(&gpu, &compiled, &live, &shot).unwrap();
            let area = Area { left: 0, top: 0, width, height };
            let mut pixels = reference.light_at(&frame, &frame.cameras[0].1, SIZE, mode, area, 0);
            if mode == View::Shaded {
                let light: Vec<[f64; 3]> = pixels.iter().map(|&[r, g, b, _]| [r, g, b].map(f64::from)).collect();
                let light = if frame.bloom > 0.0 { film::bloom(&light, SIZE, frame.bloom) } else { light };
                for ([r, g, b, _], light) in pixels.iter_mut().zip(light) {
                    [*r, *g, *b] = film::develop(frame.tone, light).map(|c| c as f32);
                }
            }
            let computed = rgb8(&pixels, area, mode);
            let differ = |(drawn, computed): (&[u8], &[u8])| {
                drawn.iter().zip(computed).any(|(a, b)| a.abs_diff(*b) > 8)
            };
            let pairs = drawn.rgba.chunks_exact(4).zip(computed.chunks_exact(3));
            let count = pairs.filter(|pair| differ(*pair)).count();
            let share = count as f64 / f64::from(width * height);
            println!("{share:8.5} {mode:?} {}", path.file_stem().unwrap().display());
            if share >= 0.005 {
                apart.push(format!("{:.2} % {mode:?} of {name}", 100.0 * share));
            }
        }
    }
    assert!(apart.is_empty(), "{}", apart.join("\n"));
}
