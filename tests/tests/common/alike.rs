//! Scenes of files in memory, drawn on both machines.

use image::{ColorType, ImageEncoder};
use rayon::prelude::*;
use surefoot_compiler::compiled::{Compiled, Export, Live, Options};
use surefoot_compiler::images::Images;
use surefoot_compiler::srgb::{decode, encode};
use surefoot_compiler::reference::{Area, Reference, View, film, rgb8};
use surefoot_compiler::verify::{Settings, WORK, verify};
use surefoot_compiler::{MemoryLoader, compile, diagnostic};
use surefoot_runtime::headless::{self, FORMAT, Pixels, Shot};
use surefoot_runtime::images::{Gallery, Loaded};
use surefoot_runtime::mesh::Assets;
use surefoot_runtime::{Gpu, Picture, ViewMode, evaluate};

/// The scene of some files, whose own is `main.sdf`, with its images.
pub fn scene(files: &MemoryLoader) -> (Compiled, Loaded) {
    let outcome = compile(files, "main.sdf", &Options::default());
    let words = diagnostic::render(&outcome.sources, &outcome.diagnostics, false);
    let compiled = outcome.compiled.unwrap_or_else(|| panic!("{words}"));
    let loaded = Gallery::new().load(&compiled, files);
    (compiled, loaded)
}

/// The same with its meshes.
pub fn scene_with_meshes(files: &MemoryLoader) -> (Compiled, Assets) {
    let outcome = compile(files, "main.sdf", &Options::default());
    let words = diagnostic::render(&outcome.sources, &outcome.diagnostics, false);
    let compiled = outcome.compiled.unwrap_or_else(|| panic!("{words}"));
    let mut assets = Assets::new();
    let broken = assets.load(files, &compiled, &|_, _, _| {});
    assert!(broken.is_empty(), "{broken:?}");
    (compiled, assets)
}

/// No bound of a scene is farther than its surface, in 64 bits and on the device, and some balls within it are certified to be empty.
pub fn bound_holds(gpu: &Gpu, name: &str, scene: &Compiled) {
    let device = |live: &Live, points: &[[f32; 3]]| evaluate(gpu, scene, live, [0.0; 3], Export::Bound, points);
    let settings = Settings { samples: 2000, certified: 24, seed: 7, work: WORK };
    let report = verify(scene, settings, Some(&device), &|_| {}).unwrap();
    assert!(report.violations.is_empty(), "{name}: {:?}", report.violations);
    assert!(report.empty > 0 && report.device.is_some_and(|device| device.larger == 0), "{name}: {report:?}");
}

/// Holds a scene's normals and depths, as the device draws them, against those of the reference.
pub fn drawn_alike(gpu: &Gpu, name: &str, scene: &Compiled) {
    let (width, height) = (96, 72);
    let live = scene.live();
    let frame = scene.frame(&live);
    let reference = Reference::new(scene, &live).unwrap();
    for (mode, view) in [(ViewMode::Normals, View::Normals), (ViewMode::Depth, View::Depth)] {
        let drawn = headless::render(gpu, scene, &live, &Shot { mode, ..Shot::new(width, height) }).unwrap();
        let area = Area { left: 0, top: 0, width, height };
        let computed = rgb8(&reference.light_at(&frame, &frame.cameras[0].1, (width, height), view, area, 0), area, view);
        let background = computed[..3].to_vec();
        let differ = |(drawn, computed): (&[u8], &[u8])| drawn.iter().zip(computed).any(|(a, b)| a.abs_diff(*b) > 8);
        let count = drawn.rgba.chunks_exact(4).zip(computed.chunks_exact(3)).filter(|pair| differ(*pair)).count();
        let seen = computed.chunks_exact(3).filter(|pixel| **pixel != background[..]).count();
        assert!(seen > 200, "{name}: {seen} pixels of {mode:?} show anything");
        assert!(count * 100 < (width * height) as usize, "{name}: {count} pixels of {mode:?} differ");
    }
}

/// The picture of the GPU, with meshes.
pub fn draw_with_meshes(gpu: &Gpu, compiled: &Compiled, assets: &Assets, shot: &Shot) -> Pixels {
    let mut picture = prepare_with_meshes(gpu, compiled, assets);
    headless::render_with(gpu, &mut picture, compiled, &compiled.live(), shot).unwrap()
}

/// A scene with meshes, ready to be drawn.
pub fn prepare_with_meshes(gpu: &Gpu, compiled: &Compiled, assets: &Assets) -> Picture {
    let mut picture = Picture::prepare(gpu, compiled, FORMAT, ViewMode::Shaded).unwrap();
    picture.show_images(assets.images());
    picture.show_meshes(&assets.meshes(compiled)).unwrap();
    picture
}

/// The picture of the GPU.
pub fn on_the_gpu(gpu: &Gpu, compiled: &Compiled, images: &Images, shot: &Shot) -> Pixels {
    let format = headless::format(compiled, ViewMode::Shaded, shot.samples);
    let mut picture = Picture::prepare(gpu, compiled, format, ViewMode::Shaded).unwrap();
    picture.show_images(images);
    headless::render_with(gpu, &mut picture, compiled, &compiled.live(), shot).unwrap()
}

/// The picture in 64 bits.
pub fn on_the_processor(compiled: &Compiled, images: &Images, size: (u32, u32)) -> Pixels {
    samples_on_the_processor(compiled, images, size, 1)
}

/// The same of some samples.
pub fn samples_on_the_processor(compiled: &Compiled, images: &Images, size: (u32, u32), samples: u32) -> Pixels {
    let live = compiled.live();
    let reference = Reference::new(compiled, &live).unwrap().with_images(images);
    let frame = compiled.frame(&live);
    let mut sum = vec![[0.0; 3]; (size.0 * size.1) as usize];
    for sample in 0..samples {
        let camera = frame.cameras[0].1.sampled(sample);
        let bands: Vec<Vec<[f32; 4]>> = (0..size.1)
            .into_par_iter()
            .step_by(12)
            .map(|top| {
                let area = Area { left: 0, top, width: size.0, height: 12.min(size.1 - top) };
                reference.light_at(&frame, &camera, size, View::Shaded, area, sample)
            })
            .collect();
        let light: Vec<[f64; 3]> = bands.iter().flatten().map(|&[r, g, b, _]| [r, g, b].map(f64::from)).collect();
        let light = if frame.bloom > 0.0 { film::bloom(&light, size, frame.bloom) } else { light };
        for (sum, light) in sum.iter_mut().zip(light) {
            let seen = film::develop(frame.tone, light).map(decode);
            *sum = [0, 1, 2].map(|i| sum[i] + seen[i] / f64::from(samples));
        }
    }
    let colors: Vec<[f32; 4]> = sum.into_iter().map(|c| c.map(|c| encode(c) as f32)).map(|[r, g, b]| [r, g, b, 0.0]).collect();
    let whole = Area { left: 0, top: 0, width: size.0, height: size.1 };
    let rgba = rgb8(&colors, whole, View::Shaded).chunks_exact(3).flat_map(|c| [c[0], c[1], c[2], 255]).collect();
    Pixels { width: size.0, height: size.1, rgba }
}

/// The share of pixels of which a channel is off by more than two of 255.
pub fn share_off(a: &Pixels, b: &Pixels) -> f64 {
    let off = a.rgba.chunks(4).zip(b.rgba.chunks(4)).filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 2));
    off.count() as f64 / f64::from(a.width * a.height)
}

/// Keeps a picture for a person to look at.
pub fn save(name: &str, pixels: &Pixels) {
    let file = super::pictures().join(format!("alike-{name}.png"));
    image::save_buffer(file, &pixels.rgba, pixels.width, pixels.height, ColorType::Rgba8).unwrap();
}

/// The bytes of a PNG of so many pixels, by their places.
pub fn png(width: u32, height: u32, color: impl Fn(u32, u32) -> [u8; 3]) -> Vec<u8> {
    let pixels: Vec<u8> = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).flat_map(|(x, y)| color(x, y)).collect();
    let mut bytes = Vec::new();
    image::codecs::png::PngEncoder::new(&mut bytes).write_image(&pixels, width, height, image::ExtendedColorType::Rgb8).unwrap();
    bytes
}
