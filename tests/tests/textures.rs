//! Images and relief on surfaces: the GPU's picture is the CPU's.

use crate::common;
use crate::common::alike::{on_the_gpu, on_the_processor, png, save, scene, share_off};
use crate::common::{Disk, gpu};
use std::fs;
use std::sync::Arc;
use std::time::{Duration, Instant};
use surefoot_compiler::compiled::Options;
use surefoot_compiler::diagnostic::Code;
use surefoot_compiler::{MemoryLoader, compile};
use surefoot_runtime::headless::{self, FORMAT, Pixels, Shot};
use surefoot_runtime::images::{Gallery, decode};
use surefoot_runtime::live::{LiveScene, Setup, Update};
use surefoot_runtime::{Gpu, ViewMode};

/// Stones of several greys, dark where they meet.
fn stones(x: u32, y: u32) -> [u8; 3] {
    let (row, across) = (y / 16, (x + 16 * ((y / 16) % 2)) % 64);
    let joint = y % 16 < 2 || across % 32 < 2;
    let tint = 120 + 40 * ((row * 7 + across / 32 * 3) % 3) as u8;
    if joint { [40, 38, 36] } else { [tint, tint - 10, tint - 25] }
}

fn files(text: &str) -> MemoryLoader {
    let wave = |x: u32, y: u32| {
        let part = |i: u32| (f64::from(i) / 32.0 * std::f64::consts::TAU).sin();
        [(127.5 + 60.0 * (part(x) + part(y))).round() as u8; 3]
    };
    MemoryLoader::new()
        .with("main.sdf", text)
        .with("img/stone.png", png(64, 64, stones))
        .with("img/wave.png", png(32, 32, wave))
        .with("img/wide.png", png(64, 16, |x, y| [(x * 4) as u8, (y * 16) as u8, 128]))
}

const STAGE: &str = "camera { eye: (3, 2.5, 5), target: (0, 0.9, 0), fov: 40deg }
    light sun { direction: (-1, -2, -1), shadow: soft(12) }\n";

const SCENES: [(&str, &str); 5] = [
    (
        "column",
        "material stone { texture: \"img/stone.png\", texture_scale: 0.8, roughness: 0.8 }
        scene = plane(y).material(stone) | box(1, 2.4, 1).twist(y, 0.7).translate(0, 1.2, 0).material(stone)",
    ),
    (
        "every slot",
        "material wet { color: #d0a080, texture: \"img/wide.png\", roughness: \"img/wave.png\", metallic: \"img/stone.png\",
            bump: \"img/wave.png\", bump_height: 0.04, texture_sharpness: 4 }
        scene = plane(y) | sphere(1).translate(0, 1, 0).material(wet) | torus(0.6, 0.2).rotate(x, 0.6).translate(1.6, 0.5, 1).material(wet)",
    ),
    (
        "blended",
        "material stone { texture: \"img/stone.png\" }
        material wide { texture: \"img/wide.png\", bump: \"img/wave.png\", roughness: 0.4 }
        material plain { color: #206040, bump: 0.02 * sin(20 * p.x) * sin(20 * p.y) }
        scene = plane(y) | smooth_union(smooth_union(sphere(0.7).translate(-0.6, 0.8, 0).material(stone),
            box(1).translate(0.6, 0.6, 0).material(wide), 0.5), sphere(0.5).translate(0, 1.6, 0).material(plain), 0.4)",
    ),
    (
        "mirrored",
        "param t = 0.6 in 0.2..2
        material stone { texture: \"img/stone.png\", texture_scale: t, bump: 0.02 * sin(8 * p.x) }
        material mirror { color: #fff, roughness: 0, metallic: 1 }
        scene = plane(y).material(stone) | sphere(1).translate(0, 1, 0).material(mirror) | box(1).translate(1.8, 0.5, 0.6).material(stone)
        render { reflections: 2 }",
    ),
    (
        "chosen",
        "param wet = true
        material a { texture: \"img/stone.png\" }
        material b { texture: \"img/wide.png\", bump: 0.02 * sin(20 * p.y) }
        scene = plane(y) | sphere(1).translate(0, 1, 0).material(if wet { a } else { b }) | box(1).translate(1.8, 0.5, 0).material(if wet { b } else { a })
          | (box(1) - sphere(0.6).material(b)).translate(-1.8, 0.5, 0).paint(plane(y), a)",
    ),
];

#[test]
fn surfaces_of_images_are_the_same_on_both() {
    let gpu = gpu();
    let size = (240, 160);
    for (name, text) in SCENES {
        let (compiled, loaded) = scene(&files(&format!("{text}\n{STAGE}")));
        assert!(loaded.diagnostics.is_empty(), "{name}: {:?}", loaded.diagnostics);
        let drawn = on_the_gpu(&gpu, &compiled, &loaded.images, &Shot::new(size.0, size.1));
        let wanted = on_the_processor(&compiled, &loaded.images, size);
        save(&format!("{name}-gpu"), &drawn);
        save(&format!("{name}-cpu"), &wanted);
        let off = share_off(&drawn, &wanted);
        println!("{name}: {:.3} % of the pixels are more than 2/255 off", 100.0 * off);
        assert!(off < 0.01, "{name}: {off}");
    }
}

/// Broken images, each by what is wrong with it: whole ones that were cut, flipped, emptied, renamed and enlarged in their heads.
fn broken() -> Vec<(String, Vec<u8>)> {
    use image::ImageEncoder;
    let pixels: Vec<u8> = (0..48 * 48 * 3).map(|i| (i * 7 % 251) as u8).collect();
    let mut jpg = Vec::new();
    image::codecs::jpeg::JpegEncoder::new(&mut jpg).write_image(&pixels, 48, 48, image::ExtendedColorType::Rgb8).unwrap();
    let mut hdr = Vec::new();
    let light: Vec<image::Rgb<f32>> = pixels.chunks(3).map(|c| image::Rgb([0, 1, 2].map(|i| f32::from(c[i])))).collect();
    image::codecs::hdr::HdrEncoder::new(&mut hdr).encode(&light, 48, 48).unwrap();
    let whole = [("png", png(48, 48, |x, y| [x as u8, y as u8, (x * y) as u8])), ("jpg", jpg), ("hdr", hdr)];
    let mut all = vec![("empty".to_owned(), Vec::new()), ("text".to_owned(), b"no image at all".to_vec()), ("zeros".to_owned(), vec![0; 4096])];
    for (name, bytes) in &whole {
        assert!(decode(bytes, true).is_ok(), "{name}");
        for part in [1, 2, 3, 5, 8, 12, 16] {
            all.push((format!("{name} cut at {part}/20"), bytes[..bytes.len() * part / 20].to_vec()));
        }
        for at in [0, 1, 3] {
            let mut flipped = bytes.clone();
            flipped[at] ^= 0x55;
            all.push((format!("{name} with another byte {at}"), flipped));
        }
    }
    // Heads that promise more than anybody has.
    for (width, height) in [(1u32 << 30, 1u32 << 30), (20_000, 4), (16_384, 16_384), (0, 48)] {
        let mut huge = whole[0].1.clone();
        huge[16..20].copy_from_slice(&width.to_be_bytes());
        huge[20..24].copy_from_slice(&height.to_be_bytes());
        all.push((format!("png of {width} by {height}"), huge));
        let text = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n");
        all.push((format!("hdr of {width} by {height}"), text.into_bytes()));
    }
    all
}

#[test]
fn a_broken_image_is_said_at_its_place_and_the_rest_goes_on() {
    let broken = broken();
    assert!(broken.len() >= 30, "{}", broken.len());
    let sphere = "material a { texture: \"img/x.png\", color: #20c040 }\nscene = sphere(1).material(a)\n";
    let sky = "environment { sky: equirect(\"img/x.png\") }\nscene = sphere(1)\n";
    let mut refused = 0;
    for (name, bytes) in &broken {
        for (text, column) in [(sphere, 23), (sky, 29)] {
            let files = MemoryLoader::new().with("main.sdf", text).with("img/x.png", bytes.clone());
            let outcome = compile(&files, "main.sdf", &Options::default());
            let compiled = outcome.compiled.unwrap_or_else(|| panic!("{name}"));
            let loaded = Gallery::new().load(&compiled, &files);
            // A JPEG that is cut may still show what is left of it.
            if let [found] = &loaded.diagnostics[..] {
                refused += 1;
                assert_eq!(found.code, Code::BadImage, "{name}");
                assert_eq!(outcome.sources.position(found.span.file, found.span.start), ("main.sdf", 1, column), "{name}");
            } else {
                assert!(loaded.diagnostics.is_empty() && (name.contains("jpg") || name.contains("hdr") || name.contains("byte")), "{name}: {:?}", loaded.diagnostics);
            }
        }
    }
    println!("{refused} of {} were refused", 2 * broken.len());
    assert!(refused >= 2 * 30, "{refused}");
    // With one of them the scene is drawn, in its colour.
    let gpu = gpu();
    let files = MemoryLoader::new().with("main.sdf", sphere).with("img/x.png", broken[0].1.clone());
    let (compiled, loaded) = scene(&files);
    let [r, g, b, _] = on_the_gpu(&gpu, &compiled, &loaded.images, &Shot::new(64, 48)).get(32, 24);
    assert!(g > r && g > b, "{r} {g} {b}");
}

#[test]
fn a_face_that_is_missing_or_of_another_size_is_said() {
    let text = "environment { sky: cubemap(\"sky/\") }\nscene = sphere(1)\n";
    let face = |side| png(side, side, |x, y| [x as u8, y as u8, 9]);
    let with = |files: MemoryLoader, names: &[&str]| names.iter().fold(files, |f, n| f.with(&format!("sky/{n}.png"), face(8)));
    let some = with(MemoryLoader::new().with("main.sdf", text), &["px", "nx", "py", "ny", "pz"]);
    let said = |files: &MemoryLoader| scene(files).1.diagnostics.iter().map(|d| d.message.clone()).collect::<Vec<_>>().join("; ");
    assert!(said(&some).contains("sky/nz"), "{}", said(&some));
    assert!(said(&some.clone().with("sky/nz.png", face(16))).contains("16 by 16"));
    assert_eq!(said(&some.with("sky/nz.png", face(8))), "");
}

fn next(live: &LiveScene) -> Update {
    let deadline = Instant::now() + Duration::from_secs(60);
    loop {
        if let Some(update) = live.poll() {
            return update;
        }
        assert!(Instant::now() < deadline, "nothing came");
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn draw(gpu: &Gpu, update: Update) -> Pixels {
    let ready = update.ready.unwrap();
    let mut picture = ready.picture.unwrap();
    headless::render_with(gpu, &mut picture, &ready.compiled, &ready.compiled.live(), &Shot::new(64, 48)).unwrap()
}

#[test]
fn images_are_replaced_under_a_running_scene() {
    let gpu = gpu();
    let folder = common::pictures().join("replaced");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(folder.join("sky")).unwrap();
    let plain = |color: [u8; 3]| png(8, 8, move |_, _| color);
    for face in ["px", "nx", "py", "ny", "pz", "nz"] {
        fs::write(folder.join(format!("sky/{face}.png")), plain([90, 120, 200])).unwrap();
    }
    fs::write(folder.join("a.png"), plain([200, 40, 40])).unwrap();
    fs::write(
        folder.join("s.sdf"),
        "environment { sky: cubemap(\"sky/\") }\nmaterial a { texture: \"a.png\" }\nscene = sphere(1).material(a)\ncamera { eye: (0, 0, 4), target: (0, 0, 0) }",
    )
    .unwrap();
    let live = LiveScene::start(Setup {
        path: folder.join("s.sdf").to_str().unwrap().to_owned(),
        options: Options::default(),
        loader: Arc::new(Disk),
        compile: Arc::new(compile),
        target: Some((gpu.clone(), FORMAT)),
        mode: ViewMode::Shaded,
        wake: Arc::new(|| {}),
    })
    .unwrap();
    let first = next(&live);
    assert!(first.words.diagnostics.is_empty(), "{:?}", first.words.diagnostics);
    let before = draw(&gpu, first);
    let built = gpu.stats().pipelines;
    let put = |name: &str, bytes: Vec<u8>| {
        fs::write(folder.join("new"), bytes).unwrap();
        fs::rename(folder.join("new"), folder.join(name)).unwrap();
    };
    let started = Instant::now();
    put("a.png", plain([40, 200, 40]));
    let second = next(&live);
    println!("an image is replaced and ready after {:?}", started.elapsed());
    let green = draw(&gpu, second);
    let (was, is) = (before.get(32, 24), green.get(32, 24));
    assert!(was[0] > was[1] && is[1] > is[0], "{was:?} {is:?}");
    assert_eq!(before.get(0, 0), green.get(0, 0), "the sky is as it was");

    put("sky/nz.png", plain([250, 250, 10]));
    let third = draw(&gpu, next(&live));
    assert_ne!(third.get(0, 0), green.get(0, 0), "the face behind the ball is another");

    put("a.png", b"broken".to_vec());
    let fourth = next(&live);
    assert!(matches!(&fourth.words.diagnostics[..], [d] if d.code == Code::BadImage), "{:?}", fourth.words.diagnostics);
    assert_eq!(draw(&gpu, fourth), third, "the last good image stays");
    assert_eq!(gpu.stats().pipelines, built, "no pipeline was built again");
}
