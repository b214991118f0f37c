//! Images and relief on surfaces: the GPU's picture is the CPU's.

mod common;

use common::alike::{on_the_gpu, on_the_processor, png, save, scene, share_off};
use common::gpu;
use surefoot_compiler::MemoryLoader;
use surefoot_runtime::headless::Shot;

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
