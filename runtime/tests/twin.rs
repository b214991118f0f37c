//! The GPU's picture of each example is the processor's: fewer than one pixel in two hundred differs by more than 8 of 255.

mod common;

use common::gpu;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use surefoot_compiler::compiled::{Live, Loader, Options};
use surefoot_compiler::camera::Basis;
use surefoot_compiler::reference::march::Ray;
use surefoot_compiler::reference::shade::steps_color;
use surefoot_compiler::reference::{Area, Reference, View, film, rgb8};
use surefoot_compiler::{compile, diagnostic};
use surefoot_compiler::sampled::{Grid, Settings};
use surefoot_runtime::headless::{self, Shot};
use surefoot_runtime::passes::scene::Features;
use surefoot_runtime::{Gpu, Picture};

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

/// Compares views of a scene; `apart` gets what differs, and what is wrong with its text.
fn compare(gpu: &Gpu, path: &Path, modes: &[View], apart: &mut Vec<String>) {
    let (width, height) = SIZE;
    let name = path.to_str().unwrap();
    let outcome = compile(&Files, name, &Options::default());
    let words = diagnostic::render(&outcome.sources, &outcome.diagnostics, false);
    let Some(mut compiled) = outcome.compiled else { return apart.push(words) };
    // Which the processor's picture leaves out.
    compiled.blocks.capture = None;
    let live = Live { slice: 0.21, ..compiled.live() };
    let frame = compiled.frame(&live);
    let reference = Reference::new(&compiled, &live).unwrap();
    for &mode in modes {
        let shot = Shot { mode, ..Shot::new(width, height) };
        // The processor's rays begin at the eye: it looks where the GPU looks without cones.
        let features = Features { cones: false, ..Features::of(&compiled, mode) };
        let mut picture = Picture::prepare_with(gpu, &compiled, headless::format(&compiled, mode, 1), features).unwrap();
        let drawn = headless::render_with(gpu, &mut picture, &compiled, &live, &shot).unwrap();
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
        let differ = |(drawn, computed): (&[u8], &[u8])| drawn.iter().zip(computed).any(|(a, b)| a.abs_diff(*b) > 8);
        let pairs = drawn.rgba.chunks_exact(4).zip(computed.chunks_exact(3));
        let count = pairs.filter(|pair| differ(*pair)).count();
        let share = count as f64 / f64::from(width * height);
        println!("{share:8.5} {mode:?} {}", path.file_stem().unwrap().display());
        if share >= 0.005 {
            apart.push(format!("{:.2} % {mode:?} of {name}", 100.0 * share));
        }
    }
}

#[test]
fn every_example_looks_alike_on_both() {
    let (gpu, mut apart) = (gpu(), Vec::new());
    for path in examples() {
        compare(&gpu, &path, &[View::Shaded, View::Normals, View::Depth], &mut apart);
    }
    assert!(apart.is_empty(), "{}", apart.join("\n"));
}

#[test]
fn views_of_the_field_and_of_light_look_alike_on_both() {
    let (gpu, mut apart) = (gpu(), Vec::new());
    for name in ["csg", "statue", "lantern", "stone_column", "isometric"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples").join(name).with_extension("sdf");
        let modes = [View::Gradient, View::Factor, View::Occlusion, View::Shadow, View::Slice(0), View::Slice(1), View::Slice(2)];
        compare(&gpu, &path, &modes, &mut apart);
    }
    assert!(apart.is_empty(), "{}", apart.join("\n"));
}

/// The pixel of the view of steps that a ray's march makes.
#[test]
fn the_march_of_a_ray_has_the_steps_that_the_gpu_shows() {
    let gpu = gpu();
    for name in ["csg.sdf", "statue.sdf", "still_life.sdf"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples").join(name);
        let compiled = compile(&Files, path.to_str().unwrap(), &Options::default()).compiled.unwrap();
        let live = compiled.live();
        let frame = compiled.frame(&live);
        let camera = compiled.camera_in(frame.cameras[0].1, f64::from(SIZE.0) / f64::from(SIZE.1));
        let shot = Shot { mode: View::Steps, camera: Some(camera), ..Shot::new(SIZE.0, SIZE.1) };
        let drawn = headless::render(&gpu, &compiled, &live, &shot).unwrap();
        let (basis, reference) = (Basis::of(&camera), Reference::new(&compiled, &live).unwrap());
        let (mut same, mut count, mut steps) = (0, 0, 0);
        for y in (0..SIZE.1).step_by(3) {
            for x in (0..SIZE.0).step_by(3) {
                let at = (f64::from(x) + 0.5, f64::from(y) + 0.5);
                let ray = Ray { origin: basis.start(camera.eye, at, SIZE), direction: basis.direction(at, SIZE), t_min: 0.0, t_max: frame.max_distance };
                let march = reference.march_of(&ray, basis.footprint(SIZE.1), frame.extent);
                let wanted = steps_color(march.steps.len() as u32).map(|c| (255.0 * c).round() as i32);
                let found = &drawn.rgba[4 * (y * SIZE.0 + x) as usize..][..3];
                same += usize::from(found.iter().zip(wanted).all(|(found, wanted)| (i32::from(*found) - wanted).abs() <= 2));
                count += 1;
                steps += march.steps.len();
            }
        }
        println!("{name}: {same} of {count}, {steps} steps");
        // Rounding in 32 bits takes a look more or less at some.
        assert!(same * 100 >= count * 95 && steps > 2 * count, "{name}: {same} of {count} pixels");
    }
}
