//! Pictures of many samples: an edge covers its pixels as much as geometry says.

use crate::common::gpu;
use surefoot_compiler::compiled::Options;
use surefoot_compiler::camera::Basis;
use surefoot_compiler::vector::{add, dot, scale};
use surefoot_compiler::reference::{Area, Reference, View};
use surefoot_compiler::{Compiled, MemoryLoader, compile, diagnostic};
use surefoot_runtime::headless::{self, Shot};

const SIZE: (u32, u32) = (96, 64);

/// A ball that is as bright as a screen can show, before black.
const BALL: &str = "material lamp { color: #000, emission: (60, 60, 60), roughness: 1 }
    scene = sphere(1).material(lamp)
    environment { sky: #000000 }
    light none { direction: (0, -1, 0), intensity: 0, shadow: none }
    camera { eye: (0.3, 0.4, 5), target: (0.05, 0, 0), fov: 30deg }
    render { ambient_occlusion: (0.5, 0) }";

fn ball() -> Compiled {
    let outcome = compile(&MemoryLoader::new().with("s.sdf", BALL), "s.sdf", &Options::default());
    let words = diagnostic::render(&outcome.sources, &outcome.diagnostics, false);
    outcome.compiled.unwrap_or_else(|| panic!("{words}"))
}

fn linear(c: u8) -> f64 {
    let c = f64::from(c) / 255.0;
    if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

/// How much of each pixel the ball covers, by 32 × 32 rays.
fn coverage(compiled: &Compiled) -> Vec<f64> {
    let frame = compiled.frame(&compiled.live());
    let camera = frame.cameras[0].1;
    let basis = Basis::of(&camera);
    let places = (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y)));
    places
        .map(|(x, y)| {
            let met = (0..1024).filter(|i| {
                let part = |n: u32| (f64::from(n) + 0.5) / 32.0;
                let ray = basis.direction((f64::from(x) + part(i % 32), f64::from(y) + part(i / 32)), SIZE);
                let nearest = add(camera.eye, scale(ray, -dot(camera.eye, ray)));
                dot(nearest, nearest) < 1.0
            });
            met.count() as f64 / 1024.0
        })
        .collect()
}

#[test]
fn an_edge_covers_its_pixels_as_geometry_says() {
    let gpu = gpu();
    let compiled = ball();
    let wanted = coverage(&compiled);
    assert!(wanted.iter().filter(|c| **c > 0.05 && **c < 0.95).count() > 80);
    // A ray ends within a 128th of a pixel of the surface, so an edge lies at most so far outside.
    for (samples, worst) in [(1, 0.6), (16, 0.28), (64, 0.12), (256, 0.08)] {
        let shot = Shot { samples, ..Shot::new(SIZE.0, SIZE.1) };
        let drawn = headless::render(&gpu, &compiled, &compiled.live(), &shot).unwrap();
        let off = drawn.rgba.chunks(4).zip(&wanted).map(|(p, c)| (linear(p[0]) - c).abs());
        let (most, sum) = off.fold((0.0f64, 0.0), |(most, sum), o| (most.max(o), sum + o));
        println!("{samples:3} samples: at most {most:.3} of a pixel off, {:.5} in the mean", sum / wanted.len() as f64);
        assert!(most <= worst, "{samples} samples: {most}");
    }
}

#[test]
fn samples_of_the_processor_are_those_of_the_gpu() {
    let gpu = gpu();
    let compiled = ball();
    let (live, samples) = (compiled.live(), 5);
    let drawn = headless::render(&gpu, &compiled, &live, &Shot { samples, ..Shot::new(SIZE.0, SIZE.1) }).unwrap();
    let reference = Reference::new(&compiled, &live).unwrap();
    let frame = compiled.frame(&live);
    let area = Area { left: 0, top: 0, width: SIZE.0, height: SIZE.1 };
    let mut mean = vec![0.0; (SIZE.0 * SIZE.1) as usize];
    for sample in 0..samples {
        let tile = reference.tile_at(&frame, &frame.cameras[0].1, SIZE, View::Shaded, area, sample);
        for (mean, pixel) in mean.iter_mut().zip(tile) {
            *mean += linear((255.0 * pixel[0]).round() as u8) / f64::from(samples);
        }
    }
    let off = drawn.rgba.chunks(4).zip(&mean).filter(|(p, m)| (linear(p[0]) - **m).abs() > 0.02);
    let off = off.count();
    println!("{off} of {} pixels differ", mean.len());
    assert!(off * 200 <= mean.len(), "{off}");
}

#[test]
fn a_picture_for_a_screen_takes_one_sample() {
    let gpu = gpu();
    let compiled = ball();
    let mut picture = surefoot_runtime::Picture::prepare(&gpu, &compiled, headless::FORMAT, View::Shaded).unwrap();
    let shot = Shot { samples: 4, ..Shot::new(8, 8) };
    assert!(headless::render_with(&gpu, &mut picture, &compiled, &compiled.live(), &shot).is_err());
    assert!(headless::render_with(&gpu, &mut picture, &compiled, &compiled.live(), &Shot::new(8, 8)).is_ok());
}
