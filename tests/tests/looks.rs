//! Film, cameras and lights: what the GPU makes of them is what the processor computes in 64 bits.

use crate::common::alike::{on_the_gpu, samples_on_the_processor, save, scene, share_off};
use crate::common::gpu;
use surefoot_compiler::MemoryLoader;
use surefoot_runtime::ViewMode;
use surefoot_runtime::headless::Shot;
use surefoot_runtime::passes::scene::Features;

const SIZE: (u32, u32) = (160, 104);

/// A floor, a ball that shines, and what stands behind it.
fn still_life(blocks: &str) -> String {
    format!(
        "material lamp {{ color: #000, emission: (30, 18, 8) }}
         material chrome {{ color: #d8dade, metallic: 1, roughness: 0.15 }}
         scene = plane(y) | sphere(0.3).translate(0.9, 0.3, 0.5).material(lamp) | box((1, 2, 0.4)).translate(-0.9, 1, -1)
               | sphere(0.6).translate(0, 0.6, 0).material(chrome) | cylinder(0.3, 1.2).translate(1.5, 0.6, -2)
         {blocks}"
    )
}

#[test]
fn film_cameras_and_lights_are_alike_on_both() {
    let gpu = gpu();
    let cases = [
        ("plain", "", 1),
        ("mean", "", 4),
        ("agx", "render { tone: agx }", 1),
        ("neutral", "render { tone: neutral, exposure: 0.5 }", 1),
        ("none", "render { tone: none, exposure: -1 }", 1),
        ("fog", "render { fog: (#cfd8e0, 0.12) }", 1),
        ("fog-in-mirrors", "param thick = 0.1 in 0..1\nrender { fog: (#7080a0, thick), reflections: 2 }", 1),
        ("bloom", "render { bloom: 0.3 }", 1),
        ("bloom-mean", "render { bloom: 0.15, tone: agx }", 4),
        ("orthographic", "camera { eye: (3, 3, 4), target: (0, 0.5, 0), projection: orthographic, height: 4 }", 1),
        ("orthographic-of-an-angle", "camera { eye: (0, 6, 0.1), target: (0, 0, 0), projection: orthographic }", 2),
        ("up", "camera { eye: (3, 3, 4), target: (0, 0.5, 0), up: (1, 1, 0) }", 1),
        ("lens", "camera { eye: (2, 1.5, 4), target: (0, 0.6, 0), lens: 0.15, focus: 3.2 }", 8),
        ("lens-of-parallel-rays", "camera { eye: (2, 1.5, 4), target: (0, 0.6, 0), lens: 0.2, projection: orthographic, height: 3 }", 8),
        ("glass", "render { fog: (#a0a8b0, 0.02) }", 1),
        ("lamp", "light lamp { position: (1, 2.5, 1.5), size: 0.3, intensity: 12 }", 1),
        ("sun", "light sun { direction: (-1, -2, -1), size: 3deg }", 1),
        ("point", "light lamp { position: (1, 2.5, 1.5), size: 0 }", 1),
    ];
    let mut wrong = Vec::new();
    for (name, blocks, samples) in cases {
        let mut text = still_life(blocks);
        if name == "glass" {
            text = text.replace("metallic: 1, roughness: 0.15", "transmission: 0.9, roughness: 0.05");
        }
        let (compiled, loaded) = scene(&MemoryLoader::new().with("main.sdf", text));
        let shot = Shot { samples, ..Shot::new(SIZE.0, SIZE.1) };
        let drawn = on_the_gpu(&gpu, &compiled, &loaded.images, &shot);
        let computed = samples_on_the_processor(&compiled, &loaded.images, SIZE, samples);
        save(&format!("looks-{name}-gpu"), &drawn);
        save(&format!("looks-{name}-cpu"), &computed);
        let share = share_off(&drawn, &computed);
        println!("{name:26} {:.3} %", 100.0 * share);
        if share > 0.01 {
            wrong.push(format!("{name}: {:.2} % of the pixels are off", 100.0 * share));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// What a scene does not use is not in the text of its pass.
#[test]
fn a_pass_has_no_text_of_what_its_scene_does_not_use() {
    let text = |blocks: &str| {
        let (compiled, _) = scene(&MemoryLoader::new().with("main.sdf", still_life(blocks)));
        Features::of(&compiled, ViewMode::Shaded).wgsl(&compiled)
    };
    let plain = text("");
    let words = ["scene.density", "scene.lean", "scene.away", "into * linear", "65000"];
    assert!(words.iter().all(|word| !plain.contains(word)), "{plain}");
    for (blocks, word) in [
        ("render { fog: (#fff, 0.1) }", words[0]),
        ("camera { lens: 0.1 }", words[1]),
        ("camera { projection: orthographic }", words[2]),
        ("render { tone: agx }", words[3]),
        ("render { bloom: 0.1 }", words[4]),
    ] {
        assert!(text(blocks).contains(word), "{blocks}");
    }
    for none in ["render { fog: (#fff, 0), bloom: 0 }", "camera { lens: 0, up: (0, 0, 1) }", "render { tone: aces }", "light l { position: (0, 2, 0), size: 1 }"] {
        let pass = text(none);
        assert!(words.iter().all(|word| !pass.contains(word)), "{none}");
    }
}
