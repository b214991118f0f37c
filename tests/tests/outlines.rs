//! Words and paths: bounds, pictures of both machines, and texts that need no buffers.

use crate::common::alike::{bound_holds, drawn_alike, scene};
use crate::common::gpu;
use surefoot_compiler::MemoryLoader;
use surefoot_compiler::compiled::{Compiled, Options};

const WAVE: &str = "M 0 0 C 1 2 3 -2 4 0 S 6 3 4 4 Q 2 6 0 4 Z M 2 1 A 0.6 0.6 0 1 1 1.9 1.1 Z";

fn compile_text(text: &str) -> Compiled {
    scene(&MemoryLoader::new().with("main.sdf", text)).0
}

/// Alone, and in all that the language does with drawings.
fn scenes() -> Vec<(&'static str, String)> {
    let path = format!("path(\"{WAVE}\").scale(0.4).translate(-0.8, 0.8)");
    vec![
        ("words", "scene = text(\"Sure\\nfoot\", align: \"center\").extrude(0.3).rotate(y, 0.4)".to_owned()),
        ("path", format!("scene = {path}.extrude(0.4)")),
        ("stroke", format!("scene = {path}.stroke(0.1).extrude(0.4) | text(\"&\", size: 0.7).round(0.03).extrude(0.6)")),
        ("twisted", "scene = text(\"twist\", size: 1, align: \"center\").extrude(0.4).twist(y, 0.8)".to_owned()),
        ("blended", format!("scene = smooth_union({path}.extrude(0.4), sphere(0.5).translate(0.4, 0, 0.2), 0.3)")),
        ("revolved", "scene = text(\"8\", size: 1.6).translate(0.2, -0.5).revolve()".to_owned()),
        ("moved", "param x = 0.2 in -1..1\nscene = text(\"A\").extrude(0.3).translate(x, 0.3 * sin(time), 0) | text(\"B\", size: 0.6).extrude(0.8).translate(0, 1, 0)".to_owned()),
        ("engraved", "material red { color: #b02020 }\nscene = box((4, 1.4, 0.5)) - text(\"cut\", size: 1, align: \"center\").extrude(0.3).translate(0, -0.35, 0.3)".to_owned()),
        ("copies", "scene = for i in 0..30 { text(\"o\", size: 0.4).extrude(0.1).translate(0.3 * (i % 6), 0.3 * floor(i / 6), 0.05 * i) }".to_owned()),
    ]
}

#[test]
fn no_bound_is_too_large() {
    let gpu = gpu();
    for (name, text) in scenes() {
        bound_holds(&gpu, name, &compile_text(&text));
    }
}

#[test]
fn both_machines_draw_the_same() {
    let gpu = gpu();
    for (name, text) in scenes() {
        drawn_alike(&gpu, name, &compile_text(&text));
    }
}

#[test]
fn long_texts_stand_beside_a_module() {
    let words = "The quick brown fox jumps over the lazy dog. ".repeat(5);
    let scene = compile_text(&format!("scene = text(\"{words}\").extrude(0.3)"));
    assert!(scene.module.needs_buffers && scene.module.wgsl.contains("var<storage, read>") && scene.module.wgsl.len() < 100_000);
}

#[test]
fn words_stand_in_the_text_of_a_module() {
    let scene = compile_text("scene = text(\"Surefoot\").extrude(0.3)");
    assert!(!scene.module.needs_buffers && !scene.module.wgsl.contains("var<storage"), "it needs no buffer");
    let (with, [_, lists]) = scene.module.with_buffers(&Options::default()).unwrap();
    assert!(with.wgsl.contains("var<storage, read>") && lists.len() > 4 * 1_000);
}
