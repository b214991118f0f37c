//! Pictures that a plane cuts open: against the same scene cut by an intersection, on both machines.

use crate::common::alike::save;
use crate::common::gpu;
use surefoot_compiler::camera::Basis;
use surefoot_compiler::compiled::{Compiled, Live, Options};
use surefoot_compiler::reference::{Area, Reference, View, rgb8};
use surefoot_compiler::section::{Across, Cut, Section};
use surefoot_compiler::{MemoryLoader, compile, diagnostic};
use surefoot_runtime::headless::{self, FORMAT, Pixels, Shot};
use surefoot_runtime::mesh::Assets;
use surefoot_runtime::passes::scene::Features;
use surefoot_runtime::physics::Physics;
use surefoot_runtime::{Gpu, Picture, Showing};
use surefoot_tests::solids::sphere;

const SIZE: (u32, u32) = (160, 120);

/// Shapes with walls to be seen, and cameras that stand on either side of the planes.
const SHAPES: [(&str, &str); 3] = [
    ("sphere(1).shell(0.2) | box(0.9).twist(y, 0.8).translate(1.6, 0, 0.2) | plane(y, -1.1)", "eye: (3, 2.2, 5), target: (0.5, 0, 0)"),
    ("smooth_union(torus(0.8, 0.35), box(0.9).shell(0.15), 0.2)", "eye: (-4, -2, 3), target: (0, 0, 0), projection: orthographic, height: 4.13"),
    ("sphere(0.4).shell(0.1).repeat((1, 1, 1), 2)", "eye: (3, 2, 4), target: (0, 0, 0)"),
];

fn scene(text: &str) -> (Compiled, Assets) {
    let loader = MemoryLoader::new().with("s.sdf", text).with("ball.obj", sphere(60).obj());
    let outcome = compile(&loader, "s.sdf", &Options::default());
    let words = diagnostic::render(&outcome.sources, &outcome.diagnostics, false);
    let compiled = outcome.compiled.unwrap_or_else(|| panic!("{words}\n{text}"));
    let mut assets = Assets::new();
    let broken = assets.load(&loader, &compiled, &|_, _, _| {});
    assert!(broken.is_empty(), "{broken:?}");
    (compiled, assets)
}

fn sections() -> Vec<Section> {
    let sides = |across| [false, true].map(|keeps_above| Section { cut: Cut { across, keeps_above }, at: 0.13 });
    Across::ALL.into_iter().flat_map(sides).collect()
}

/// The picture of the GPU.
fn drawn(gpu: &Gpu, compiled: &Compiled, live: &Live, view: View) -> Pixels {
    let showing = Showing { view, section: live.section.map(|section| section.cut), beside: None };
    let mut picture = Picture::prepare(gpu, compiled, FORMAT, showing).unwrap();
    headless::render_with(gpu, &mut picture, compiled, live, &Shot { mode: view, ..Shot::new(SIZE.0, SIZE.1) }).unwrap()
}

/// Where each ray hits in 64 bits; below 0 where it hits nothing.
fn ways(compiled: &Compiled, live: &Live, view: View) -> Vec<[f32; 4]> {
    let frame = compiled.frame(live);
    let area = Area { left: 0, top: 0, width: SIZE.0, height: SIZE.1 };
    Reference::new(compiled, live).unwrap().light_at(&frame, &frame.cameras[0].1, SIZE, view, area, 0)
}

#[test]
fn a_section_hits_what_an_intersection_with_its_side_has() {
    for (shape, camera) in SHAPES {
        let around = format!("camera {{ {camera}, fov: 40deg }}");
        let (whole, _) = scene(&format!("scene = {shape}\n{around}"));
        let camera = whole.frame(&whole.live()).cameras[0].1;
        let footprint = Basis::of(&camera).footprint(SIZE.1);
        for section in sections() {
            let plane = section.plane(&camera);
            let [x, y, z] = plane.normal;
            let (cut, _) = scene(&format!("scene = ({shape}) & plane(({x:?}, {y:?}, {z:?}), {:?})\n{around}", plane.offset));
            let wanted = ways(&cut, &cut.live(), View::Normals);
            let found = ways(&whole, &Live { section: Some(section), ..whole.live() }, View::Normals);
            let (mut hits, mut missed, mut far, mut turned) = (0, 0, 0, 0);
            for (wanted, found) in wanted.iter().zip(&found) {
                let (a, b) = (f64::from(wanted[3]), f64::from(found[3]));
                hits += u32::from(a >= 0.0);
                missed += u32::from((a >= 0.0) != (b >= 0.0));
                if a >= 0.0 && b >= 0.0 {
                    far += u32::from((a - b).abs() > 0.05 * footprint * a);
                    turned += u32::from((0..3).any(|i| (wanted[i] - found[i]).abs() > 0.02));
                }
            }
            let words = format!("{shape} {section:?}: of {hits} hits {missed} missed, {far} far, {turned} turned");
            println!("{words}");
            // A ray that grazes an edge may meet either side of it.
            let few = 2 + hits / 300;
            assert!(hits > 500 && missed <= few && far <= few && turned <= few, "{words}");
        }
    }
}

#[test]
fn both_machines_draw_a_section_alike() {
    let gpu = gpu();
    for (i, (shape, camera)) in SHAPES.into_iter().enumerate() {
        let text = format!("material red {{ color: #c03018, roughness: 0.4 }}\nscene = ({shape}) | sphere(0.4).material(red)\ncamera {{ {camera}, fov: 40deg }}");
        let (compiled, _) = scene(&text);
        for (j, section) in sections().into_iter().enumerate() {
            let live = Live { section: Some(section), ..compiled.live() };
            let view = [View::Shaded, View::Normals, View::Depth, View::Steps, View::Gradient, View::Occlusion, View::Shadow, View::Factor][(i + j) % 8];
            for view in [view, View::Normals] {
                let drawn = drawn(&gpu, &compiled, &live, view);
                let mut pixels = ways(&compiled, &live, view);
                if view == View::Shaded {
                    let frame = compiled.frame(&live);
                    for [r, g, b, _] in &mut pixels {
                        [*r, *g, *b] = surefoot_compiler::reference::film::develop(frame.tone, [*r, *g, *b].map(f64::from)).map(|c| c as f32);
                    }
                }
                let computed = rgb8(&pixels, Area { left: 0, top: 0, width: SIZE.0, height: SIZE.1 }, view);
                let differs = |(drawn, computed): (&[u8], &[u8])| drawn.iter().zip(computed).any(|(a, b)| a.abs_diff(*b) > 8);
                let count = drawn.rgba.chunks_exact(4).zip(computed.chunks_exact(3)).filter(|pair| differs(*pair)).count();
                save(&format!("section-{i}-{j}-{view:?}"), &drawn);
                // Steps count each look, of which rounding makes one more or less.
                let most = if view == View::Steps { 25 } else { 100 };
                assert!(count * most < (SIZE.0 * SIZE.1) as usize, "{shape} {section:?} {view:?}: {count} pixels differ");
            }
        }
    }
}

/// What is rasterised is cut where the field is: a ball of triangles and a ball that falls beside one of the field.
#[test]
fn meshes_and_balls_are_cut_too() {
    let gpu = gpu();
    let around = "camera { eye: (0, 3, 6), target: (0, 0, 0), fov: 40deg }\nlight sun { direction: (0.3, -1, -0.5), shadow: none }";
    let (mesh, assets) = scene(&format!("scene = nothing\nmesh m \"ball.obj\" {{ translate: (0, 0, 0) }}\n{around}"));
    let (balls, _) = scene(&format!("scene = nothing\nballs b {{ count: 0 }}\n{around}"));
    let (field, _) = scene(&format!("scene = sphere(1)\n{around}"));
    let physics = Physics::with(&gpu, &balls, &[surefoot_compiler::physics::Ball::at([0.0; 3], 1.0)]).unwrap();
    for (i, section) in sections().into_iter().enumerate() {
        let with = |compiled: &Compiled| Live { section: Some(section), ..compiled.live() };
        let showing = Showing { view: View::Normals, section: Some(section.cut), beside: None };
        let shot = Shot { mode: View::Normals, ..Shot::new(SIZE.0, SIZE.1) };
        let wanted = drawn(&gpu, &field, &with(&field), View::Normals);
        let apart = |found: &Pixels| {
            let pairs = wanted.rgba.chunks_exact(4).zip(found.rgba.chunks_exact(4));
            pairs.filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 8)).count()
        };
        let mut picture = Picture::prepare(&gpu, &mesh, FORMAT, showing).unwrap();
        picture.show_meshes(&assets.meshes(&mesh)).unwrap();
        let found = headless::render_with(&gpu, &mut picture, &mesh, &with(&mesh), &shot).unwrap();
        save(&format!("section-mesh-{i}"), &found);
        // Its outline has corners.
        assert!(apart(&found) < 250, "{section:?}: {} pixels of the mesh", apart(&found));
        let mut picture = Picture::prepare(&gpu, &balls, FORMAT, showing).unwrap();
        picture.show_balls(&balls, &balls.live(), Some(&physics));
        let found = headless::render_with(&gpu, &mut picture, &balls, &with(&balls), &shot).unwrap();
        assert!(apart(&found) < 40, "{section:?}: {} pixels of the ball", apart(&found));
    }
}

#[test]
fn the_usual_picture_has_nothing_of_it() {
    let (compiled, _) = scene("scene = sphere(1)");
    let usual = Features::of(&compiled, View::Shaded);
    assert!(!usual.wgsl(&compiled).contains("section"));
    let cut = usual.with_section(Some(Cut::default()));
    assert!(cut.wgsl(&compiled).contains("scene_section_height"));
    assert_eq!(Features::of(&compiled, View::Slice(1)).with_section(Some(Cut::default())).section, None, "a slice has its own plane");
}
