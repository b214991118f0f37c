//! Every example is drawn by the GPU, in every view, and its picture is the CPU's, which computes in 64 bits.

use crate::common;
use crate::common::{compile_file, examples, gpu, pictures};
use rayon::prelude::*;
use std::collections::BTreeSet;
use surefoot_compiler::compiled::{Compiled, Live};
use surefoot_compiler::reference::{Area, Reference, film, rgb8};
use surefoot_runtime::ViewMode;
use surefoot_runtime::headless::{self, Pixels, Shot};

const SIZE: (u32, u32) = (320, 180);
/// A pixel differs where a channel does by more than this.
const LEVELS: u8 = 8;
/// Of all pixels at most this share may differ.
const SHARE: f64 = 0.005;

/// The picture in 64 bits, row by row.
fn reference(compiled: &Compiled, live: &Live, mode: ViewMode) -> Pixels {
    let reference = Reference::new(compiled, live).unwrap();
    let frame = compiled.frame(live);
    let camera = frame.cameras[0].1;
    let (width, height) = SIZE;
    let bands: Vec<Vec<[f32; 4]>> = (0..height)
        .step_by(12)
        .collect::<Vec<u32>>()
        .into_par_iter()
        .map(|top| {
            let area = Area { left: 0, top, width, height: 12.min(height - top) };
            reference.light_at(&frame, &camera, SIZE, mode, area, 0)
        })
        .collect();
    let mut pixels: Vec<[f32; 4]> = bands.into_iter().flatten().collect();
    if mode == ViewMode::Shaded {
        let light: Vec<[f64; 3]> = pixels.iter().map(|&[r, g, b, _]| [r, g, b].map(f64::from)).collect();
        let light = if frame.bloom > 0.0 { film::bloom(&light, SIZE, frame.bloom) } else { light };
        for ([r, g, b, _], light) in pixels.iter_mut().zip(light) {
            [*r, *g, *b] = film::develop(frame.tone, light).map(|c| c as f32);
        }
    }
    let rgba = rgb8(&pixels, Area { left: 0, top: 0, width, height }, mode);
    Pixels { width, height, rgba: rgba.chunks_exact(3).flat_map(|c| [c[0], c[1], c[2], 255]).collect() }
}

/// The share of pixels that differ, and where, in red.
fn compare(a: &Pixels, b: &Pixels) -> (f64, Vec<u8>) {
    let mut differ = 0;
    let mut map = Vec::new();
    for (a, b) in a.rgba.chunks(4).zip(b.rgba.chunks(4)) {
        let far = a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > LEVELS);
        differ += usize::from(far);
        let grey = (a.iter().take(3).map(|c| u32::from(*c)).sum::<u32>() / 6) as u8;
        map.extend(if far { [255, 0, 0, 255] } else { [grey, grey, grey, 255] });
    }
    (differ as f64 / (a.rgba.len() / 4) as f64, map)
}

#[test]
fn gpu_and_cpu_draw_the_same() {
    let gpu = gpu();
    let modes = [("shaded", ViewMode::Shaded), ("normals", ViewMode::Normals), ("depth", ViewMode::Depth), ("steps", ViewMode::Steps)];
    let mut wrong = Vec::new();
    println!(
        "on {}: share of {}×{} pixels with a channel more than {LEVELS}/255 off",
        gpu.name(),
        SIZE.0,
        SIZE.1
    );
    println!("{:14} {:>9} {:>9} {:>9}", "scene", "shaded", "normals", "depth");
    for (name, path) in examples() {
        let mut compiled = match compile_file(&path) {
            Ok(compiled) => compiled,
            Err(words) => {
                wrong.push(format!("{name} does not compile:\n{words}"));
                continue;
            }
        };
        // Which the processor's picture leaves out.
        compiled.blocks.capture = None;
        let live = compiled.live();
        let mut row = format!("{name:14}");
        for (view, mode) in modes {
            let shot = Shot { mode, ..Shot::new(SIZE.0, SIZE.1) };
            let gpu = headless::render(&gpu, &compiled, &live, &shot).unwrap();
            let save = |what: &str, pixels: &[u8]| {
                let file = pictures().join(format!("{name}-{view}-{what}.png"));
                image::save_buffer(file, pixels, SIZE.0, SIZE.1, image::ColorType::Rgba8).unwrap();
            };
            save("gpu", &gpu.rgba);
            let colors = gpu.rgba.chunks(4).collect::<BTreeSet<_>>().len();
            // A picture of one colour, or of two, shows nothing; the normals of a sponge are those of its three faces, the cut and the floor.
            let least = if (&*name, mode) == ("menger", ViewMode::Normals) { 5 } else { 8 };
            if colors < least {
                wrong.push(format!("{name}, {view}: {colors} colours"));
            }
            // A ray of the processor begins at the eye and not where a cone ended. So it takes more steps.
            if mode == ViewMode::Steps {
                continue;
            }
            let cpu = reference(&compiled, &live, mode);
            let (share, map) = compare(&gpu, &cpu);
            row += &format!(" {:7.3} %", 100.0 * share);
            save("cpu", &cpu.rgba);
            save("difference", &map);
            if share > SHARE {
                wrong.push(format!("{name}, {view}: {:.3} % of the pixels differ", 100.0 * share));
            }
        }
        println!("{row}");
    }
    assert!(wrong.is_empty(), "{}\nSee {}", wrong.join("\n"), pictures().display());
}

/// Scenes of the corpus that are very small, or of which the ground is part of something very large.
const SIZES: [&str; 10] = [
    "tiny_ball", "tiny_ball_micrometre", "tiny_parts", "tiny_scaled", "tiny_table", "planet", "planet_raised", "planet_turned", "planet_slab", "planet_pipe",
];

#[test]
fn what_is_tiny_or_huge_is_drawn_as_in_64_bits() {
    let gpu = gpu();
    let folder = common::root().join("tests/corpus/cases");
    let scene = |name: &str| compile_file(folder.join(format!("{name}.sdf")).to_str().unwrap()).unwrap();
    let mut wrong = Vec::new();
    for name in SIZES {
        let compiled = scene(name);
        let live = compiled.live();
        let camera = Some(compiled.frame(&live).cameras[0].1);
        for mode in [ViewMode::Shaded, ViewMode::Normals] {
            let seen = headless::render(&gpu, &compiled, &live, &Shot { mode, camera, ..Shot::new(SIZE.0, SIZE.1) }).unwrap();
            let (share, _) = compare(&seen, &reference(&compiled, &live, mode));
            println!("{name}: {share:.5} {mode:?}");
            if share > SHARE {
                wrong.push(format!("{name} {mode:?}: {share}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
    // A ball fills the picture as any other does.
    let normals = |name: &str| {
        let compiled = scene(name);
        reference(&compiled, &compiled.live(), ViewMode::Normals)
    };
    let usual = normals("ball");
    for name in ["tiny_ball", "tiny_ball_micrometre"] {
        assert!(compare(&normals(name), &usual).0 <= SHARE, "{name}");
    }
}
