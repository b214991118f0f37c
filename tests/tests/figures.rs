//! Curves and solids of points: bounds, and pictures of both machines.

use crate::common::alike::{bound_holds, drawn_alike, scene};
use crate::common::gpu;
use surefoot_compiler::MemoryLoader;
use surefoot_compiler::compiled::Compiled;

const KNOT: &str = "catmull_rom([for i in 0..14 { let t = i / 14 * tau; (sin(t) + 2 * sin(2 * t), cos(t) - 2 * cos(2 * t), -sin(3 * t)) * 0.4 }], closed: true)";
const STAR: &str = "polyhedron([for k in 0..20 { let i = k % 10; let r = if i % 2 == 0 { 1 } else { 0.4 }; (r * sin(i * 36deg), r * cos(i * 36deg), if k < 10 { -0.3 } else { 0.3 }) }], \
    [[0, 1, 2, 3, 4, 5, 6, 7, 8, 9], [10, 11, 12, 13, 14, 15, 16, 17, 18, 19], [0, 1, 11, 10], [1, 2, 12, 11], [2, 3, 13, 12], [3, 4, 14, 13], [4, 5, 15, 14], [5, 6, 16, 15], [6, 7, 17, 16], \
    [7, 8, 18, 17], [8, 9, 19, 18], [9, 0, 10, 19]])";

fn compile_text(text: &str) -> Compiled {
    scene(&MemoryLoader::new().with("main.sdf", text)).0
}

/// Alone, and in all that the language does with shapes.
fn scenes() -> Vec<(&'static str, String)> {
    vec![
        ("knot", format!("scene = tube({KNOT}, 0.12)")),
        ("pipes", "scene = tube(polyline([(-1, 0, 0), (-0.2, 0.9, 0.3), (0.4, -0.6, 0), (1, 0.7, -0.4)]), 0.15) - tube(polyline([(-2, 0, 0), (2, 0, 0)]), 0.2)".to_owned()),
        ("spring", "param r = 0.1 in 0.05..0.2\nscene = tube(helix(0.7, 0.4, 4), r).rotate(x, time)".to_owned()),
        ("swollen", "scene = tube(bezier([(-1, -0.6, 0), (-0.6, 1.4, 0.8), (0.6, -1.4, -0.8), (1, 0.6, 0)]), 0.1 + 0.04 * sin(9 * p.x))".to_owned()),
        ("twisted", format!("scene = {STAR}.twist(z, 1)")),
        ("blended", format!("scene = smooth_union({STAR}, tube({KNOT}, 0.08), 0.2)")),
        ("hull", "scene = hull([for i in 0..60 { normalize(hash3(i) - 0.5) * (0.9, 0.6, 1.1) }]).shell(0.05) & box(2).translate(0, 0, 1)".to_owned()),
        ("beads", format!("scene = box((0.3, 0.2, 0.06)).along({KNOT}, 40)")),
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
