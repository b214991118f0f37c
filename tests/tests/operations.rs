//! The view of operations: what a module that counts says of its rays.

use crate::common::alike::save;
use crate::common::gpu;
use surefoot_compiler::compiled::{Compiled, Options};
use surefoot_compiler::emit::counted::COUNTER;
use surefoot_compiler::reference::march::Ray;
use surefoot_compiler::reference::shade::{OPERATIONS, operations_color};
use surefoot_compiler::reference::{Reference, View};
use surefoot_compiler::camera::Basis;
use surefoot_compiler::{MemoryLoader, compile, diagnostic};
use surefoot_runtime::Gpu;
use surefoot_runtime::headless::{self, Shot};
use surefoot_runtime::passes::scene::Features;

const SIZE: (u32, u32) = (96, 72);

fn scene(text: &str) -> Compiled {
    let outcome = compile(&MemoryLoader::new().with("s.sdf", text), "s.sdf", &Options::default());
    let words = diagnostic::render(&outcome.sources, &outcome.diagnostics, false);
    outcome.compiled.unwrap_or_else(|| panic!("{words}"))
}

/// What each pixel's ray counts on the GPU, as its colour says it, and its steps in 64 bits.
fn counts(gpu: &Gpu, name: &str, compiled: &Compiled) -> Vec<(f64, u32)> {
    let (width, height) = SIZE;
    let live = compiled.live();
    let drawn = headless::render(gpu, compiled, &live, &Shot { mode: View::Operations, ..Shot::new(width, height) }).unwrap();
    save(&format!("operations-{name}"), &drawn);
    let frame = compiled.frame(&live);
    let camera = frame.cameras[0].1;
    let basis = Basis::of(&camera);
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (f64::from(x) + 0.5, f64::from(y) + 0.5)));
    let ray = |at| Ray { origin: basis.start(camera.eye, at, SIZE), direction: basis.direction(at, SIZE), t_min: 0.0, t_max: frame.max_distance };
    let rays: Vec<Ray> = places.map(ray).collect();
    let hits = Reference::new(compiled, &live).unwrap().trace(&rays, basis.footprint(height), frame.extent);
    let scale: Vec<(f64, [f64; 3])> = (0..=1000)
        .map(|i| OPERATIONS.0 * (OPERATIONS.1 / OPERATIONS.0).powf(f64::from(i) / 1000.0))
        .map(|count| (count, operations_color(count).map(|c| 255.0 * c)))
        .collect();
    let apart = |a: &[f64; 3], b: &[u8]| a.iter().zip(b).map(|(a, b)| (a - f64::from(*b)).powi(2)).sum::<f64>();
    let count = |pixel: &[u8]| scale.iter().min_by(|a, b| apart(&a.1, pixel).total_cmp(&apart(&b.1, pixel))).unwrap().0;
    drawn.rgba.chunks_exact(4).map(count).zip(hits.iter().map(|hit| hit.steps)).collect()
}

#[test]
fn each_look_at_a_ball_costs_the_same() {
    let compiled = scene("scene = sphere(1)\ncamera { eye: (0.3, 1, 5), target: (0, 0, 0), fov: 40deg }");
    let counts = counts(&gpu(), "ball", &compiled);
    let each: Vec<f64> = counts.iter().filter(|(_, steps)| *steps >= 4).map(|(count, steps)| count / f64::from(*steps)).collect();
    let (least, most) = each.iter().fold((f64::INFINITY, 0.0f64), |(least, most), each| (least.min(*each), most.max(*each)));
    println!("{least:.0} to {most:.0} operations for each of the steps of {} rays", each.len());
    // The steps of the tracer itself are among them, what is done once, and a look more or less by rounding.
    assert!(each.len() > 300 && least > 20.0 && most < 200.0 && most < 2.5 * least, "{least} to {most}");
}

#[test]
fn of_a_large_union_a_look_counts_what_its_cell_has() {
    let text = "scene = for i in 0..600 { sphere(0.12).translate(4 * hash3(i) - 2) }\ncamera { eye: (0, 1, 9), target: (0, 0, 0), fov: 40deg }";
    let compiled = scene(text);
    assert!(compiled.module.tables.is_some(), "it is a table");
    let reference = Reference::new(&compiled, &compiled.live()).unwrap();
    let all = reference.operations("bound") as f64;
    let counts = counts(&gpu(), "union", &compiled);
    let mut share: Vec<f64> = counts.iter().filter(|(_, steps)| *steps >= 4).map(|(count, steps)| count / (all * f64::from(*steps))).collect();
    share.sort_by(f64::total_cmp);
    let median = share[share.len() / 2];
    println!("{all} operations in all, of which a look does {median:.4} at the median, of {} rays", share.len());
    assert!(share.len() > 1000 && median < 0.25, "{median}");
}

#[test]
fn no_other_view_counts() {
    let compiled = scene("scene = sphere(1).twist(y, 1)");
    assert!(!compiled.module.wgsl.contains(COUNTER));
    for view in [View::Shaded, View::Steps, View::Normals] {
        let features = Features::of(&compiled, view);
        assert!(!features.module(&compiled).unwrap().contains(COUNTER) && !features.wgsl(&compiled).contains(COUNTER), "{view:?}");
    }
    assert!(Features::of(&compiled, View::Operations).module(&compiled).unwrap().contains(COUNTER));
}
