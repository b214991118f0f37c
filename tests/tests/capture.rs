//! The scene drawn into a cubemap, for what mirrors it.

use crate::common::alike::{draw_with_meshes, png, prepare_with_meshes, save, scene_with_meshes};
use crate::common::gpu;
use surefoot_compiler::MemoryLoader;
use surefoot_compiler::compiled::{Camera, Tone};
use surefoot_compiler::camera::Basis;
use surefoot_compiler::reference::film::develop;
use surefoot_compiler::reference::shade::Shading;
use surefoot_compiler::vector::{Vec3, add, dot, sub};
use surefoot_runtime::frame::PassKind;
use surefoot_runtime::headless::{self, Shot};
use surefoot_runtime::passes::scene::Features;
use surefoot_runtime::{Gpu, ViewMode};
use surefoot_tests::solids::{cuboid, sphere};

const SIDE: usize = 128;
const PLACE: Vec3 = [0.3, 1.1, -0.2];

/// Fields, triangles and balls all around a place, and no two directions alike.
const AROUND: &str = "material ground { color: mix(#303840, #c8b090, step(0.5, fract((floor(p.x) + floor(p.z)) / 2))), roughness: 0.9 }
    material red { color: #b02a20 }
    material blue { color: #2040b0, roughness: 0.4 }
    scene = plane(y).material(ground) | sphere(0.8).translate(2.5, 1, 0.4).material(red) | torus(0.8, 0.2).translate(-0.4, 3.2, 0).material(blue)
          | box(0.6, 2.4, 0.6).rotate(y, 0.5).translate(-1.2, 1, 2.4)
    mesh one \"box.obj\" { translate: (-2.4, 1, -0.6), rotate: (0.3, 0.4, 0), material: blue }
    mesh two \"ball.obj\" { translate: (0.6, 1.4, -2.6), scale: 0.7, material: red }
    light sun { direction: (-1, -2, -1), shadow: soft(12) }
    light lamp { position: (1.5, 2.8, 1.5), color: #ffe0b0, intensity: 8, shadow: hard }
    camera { eye: (6, 4, 6), target: (0, 1, 0) }\n";

fn files(text: &str) -> MemoryLoader {
    MemoryLoader::new().with("main.sdf", text).with("box.obj", cuboid([1.0; 3]).obj()).with("ball.obj", sphere(64).obj())
}

fn capture(place: Vec3) -> String {
    format!("environment {{ capture: ({}, {}, {}), size: {SIDE} }}\n", place[0], place[1], place[2])
}

/// What the cubemap of a scene holds.
fn captured(gpu: &Gpu, text: &str) -> Vec<[f32; 4]> {
    let (compiled, assets) = scene_with_meshes(&files(text));
    let mut picture = prepare_with_meshes(gpu, &compiled, &assets);
    headless::render_with(gpu, &mut picture, &compiled, &compiled.live(), &Shot::new(8, 8)).unwrap();
    let cube = picture.captured().unwrap().unwrap();
    assert_eq!(cube.len(), 6 * SIDE * SIDE);
    cube
}

/// The tables of OpenGL 4.6 (8.13) and Vulkan (16.5.4): face, and the place on it in pixels.
fn place([x, y, z]: Vec3) -> (usize, f64, f64) {
    let m = x.abs().max(y.abs()).max(z.abs());
    let (face, s, t) = if z.abs() == m {
        if z > 0.0 { (4, x, -y) } else { (5, -x, -y) }
    } else if y.abs() == m {
        if y > 0.0 { (2, x, z) } else { (3, x, -z) }
    } else if x > 0.0 {
        (0, -z, -y)
    } else {
        (1, z, -y)
    };
    (face, 0.5 * (s / m + 1.0) * SIDE as f64, 0.5 * (t / m + 1.0) * SIDE as f64)
}

/// The pixels around a direction, the one that it meets first.
fn around(cube: &[[f32; 4]], d: Vec3) -> Vec<[f32; 4]> {
    let (face, s, t) = place(d);
    let cell = |at: f64, more: i32| (at as i32 + more).clamp(0, SIDE as i32 - 1) as usize;
    let steps = [(0, 0), (-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)];
    steps.iter().map(|(x, y)| cube[(face * SIDE + cell(t, *y)) * SIDE + cell(s, *x)]).collect()
}

fn light([r, g, b, _]: [f32; 4]) -> Vec3 {
    [r, g, b].map(f64::from)
}

/// From its place the scene looks as the cubemap has it, whichever way one looks.
#[test]
fn a_capture_is_the_picture_from_its_place() {
    let gpu = gpu();
    let cube = captured(&gpu, &format!("{AROUND}{}", capture(PLACE)));
    // Without a capture: what surfaces mirror in the capture is the sky.
    let (compiled, assets) = scene_with_meshes(&files(AROUND));
    let shading = Shading::of(&compiled.frame(&compiled.live()), None);
    let ways = [[1.0, 0.2, 0.1], [-0.7, 0.1, 0.9], [0.3, 0.8, 0.5], [0.2, -0.9, -0.3], [-1.0, -0.1, -0.8], [0.5, 0.1, -1.0]];
    let side = 160;
    let (mut off, mut worst) = (0, 0.0f64);
    for (i, way) in ways.into_iter().enumerate() {
        let camera = Camera { eye: PLACE, target: add(PLACE, way), fov: 1.5, ..Camera::PLAIN };
        let shot = Shot { camera: Some(camera), ..Shot::new(side, side) };
        let drawn = draw_with_meshes(&gpu, &compiled, &assets, &shot);
        save(&format!("capture-direct-{i}"), &drawn);
        let basis = Basis::of(&camera);
        for (x, y) in (0..side).flat_map(|y| (0..side).map(move |x| (x, y))) {
            let d = basis.direction((f64::from(x) + 0.5, f64::from(y) + 0.5), (side, side));
            let near: Vec<Vec3> = around(&cube, d).into_iter().map(|c| develop(Tone::Aces, shading.exposed(light(c))).map(|c| 255.0 * c)).collect();
            let got = drawn.get(x, y).map(f64::from);
            let beyond = (0..3).map(|c| {
                let low = near.iter().map(|n| n[c]).fold(f64::INFINITY, f64::min);
                let high = near.iter().map(|n| n[c]).fold(0.0, f64::max);
                (low - got[c]).max(got[c] - high)
            });
            let beyond = beyond.fold(0.0, f64::max);
            off += u32::from(beyond > 2.0);
            worst = worst.max(beyond);
        }
    }
    let count = 6 * side * side;
    println!("{off} of {count} pixels differ by more than 2/255, one by {worst:.1}");
    // Thin edges fall between the cubemap's pixels.
    assert!(off * 500 < count, "{off}");
}

/// A mirror in the middle of its capture, and one under an image of all directions made of the same, show the same.
#[test]
fn an_image_of_all_directions_made_of_a_capture_is_mirrored_the_same() {
    let gpu = gpu();
    let mirror = "material mirror { color: #ffffff, roughness: 0, metallic: 1, reflectivity: 1 }
        mesh mirror \"ball.obj\" { translate: (0.3, 1.1, -0.2), scale: 0.5, material: mirror }\n";
    let render = "render { ambient_occlusion: (0.5, 0) }\n";
    let here = format!("{AROUND}{mirror}{render}{}", capture(PLACE)).replace("soft(12)", "none").replace("hard", "none");
    let cube = captured(&gpu, &here);
    // The mirror itself is not in it: from its middle its sides are seen from behind.
    let without = captured(&gpu, &here.replace("translate: (0.3, 1.1, -0.2), scale: 0.5", "translate: (0, -9, 0)"));
    assert!(cube == without, "the mirror is in its own capture");
    let (width, height) = (1024u32, 512u32);
    let mut texels: Vec<image::Rgb<f32>> = Vec::new();
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let turn = ((f64::from(x) + 0.5) / f64::from(width) - 0.5) * std::f64::consts::TAU;
        let down = (f64::from(y) + 0.5) / f64::from(height) * std::f64::consts::PI;
        let [r, g, b, _] = around(&cube, [turn.sin() * down.sin(), down.cos(), -turn.cos() * down.sin()])[0];
        texels.push(image::Rgb([r, g, b]));
    }
    let mut sky = Vec::new();
    image::codecs::hdr::HdrEncoder::new(&mut sky).encode(&texels, width as usize, height as usize).unwrap();
    let there = format!(
        "scene = nothing\n{mirror}{render}environment {{ sky: equirect(\"sky.hdr\") }}
        light sun {{ direction: (-1, -2, -1), shadow: none }}
        light lamp {{ position: (1.5, 2.8, 1.5), color: #ffe0b0, intensity: 8, shadow: none }}
        camera {{ eye: (6, 4, 6), target: (0, 1, 0) }}\n"
    );
    let camera = Camera { eye: [1.5, 2.0, 2.2], target: PLACE, fov: 0.4, ..Camera::PLAIN };
    let shot = Shot { camera: Some(camera), ..Shot::new(240, 240) };
    let [a, b] = [files(&here), files(&there).with("sky.hdr", sky)].map(|files| {
        let (compiled, assets) = scene_with_meshes(&files);
        draw_with_meshes(&gpu, &compiled, &assets, &shot)
    });
    save("capture-mirrored", &a);
    save("capture-equirect", &b);
    let basis = Basis::of(&camera);
    let (mut seen, mut off) = (0u32, 0u32);
    for (x, y) in (0..240).flat_map(|y| (0..240).map(move |x| (x, y))) {
        let way = sub(PLACE, camera.eye);
        let along = dot(way, basis.direction((f64::from(x) + 0.5, f64::from(y) + 0.5), (240, 240)));
        // Within the ball, and away from its rim.
        if dot(way, way) - along * along > 0.2 {
            continue;
        }
        seen += 1;
        // Within the filter: between the pixels beside it.
        let near: Vec<[u8; 4]> = (0..9).map(|i| b.get(x + i % 3 - 1, y + i / 3 - 1)).collect();
        let got = a.get(x, y);
        let beyond = (0..3).any(|c| {
            let (low, high) = near.iter().fold((255, 0), |(low, high), n| (n[c].min(low), n[c].max(high)));
            got[c].saturating_add(4) < low || got[c] > high.saturating_add(4)
        });
        off += u32::from(beyond);
    }
    println!("{off} of {seen} pixels of the mirror differ");
    assert!(seen > 10_000 && off * 100 < seen, "{off} of {seen}");
}

/// What lies around the place is seen though the place is in the solid; and a mirror of the field sees meshes.
#[test]
fn a_place_in_the_solid_sees_what_is_beyond_it() {
    let gpu = gpu();
    let ball = format!("sphere(0.5).translate({}, {}, {})", PLACE[0], PLACE[1], PLACE[2]);
    // Neither light nor corners may tell of the ball.
    let plain = AROUND.replace("soft(12)", "none").replace("hard", "none") + "render { ambient_occlusion: (0.5, 0) }\n";
    let with = plain.replace("scene = ", &format!("scene = {ball} | "));
    let (without, with) = (captured(&gpu, &(plain + &capture(PLACE))), captured(&gpu, &(with + &capture(PLACE))));
    let apart = |(a, b): &(&[f32; 4], &[f32; 4])| a.iter().zip(*b).any(|(a, b)| (a - b).abs() > 0.01 * (a.abs() + 0.05));
    let off = without.iter().zip(&with).filter(apart).count();
    println!("{off} of {} pixels differ", with.len());
    // The floor blends nowhere; edges move by a rounding.
    assert!(off * 200 < with.len(), "{off}");
    assert!(with.iter().all(|c| c.iter().all(|c| c.is_finite())));
}

/// A capture is drawn when something of it moves, and not when the eye does.
#[test]
fn a_capture_is_drawn_anew_only_where_something_moved() {
    let gpu = gpu();
    let text = format!("param spin = 0 in 0..6\n{}{}", AROUND.replace("rotate: (0.3, 0.4, 0)", "rotate: (0.3, spin, 0)"), capture(PLACE));
    let (compiled, assets) = scene_with_meshes(&files(&text));
    let mut picture = prepare_with_meshes(&gpu, &compiled, &assets);
    assert_eq!(picture.captured().unwrap(), None);
    let mut live = compiled.live();
    let draw = |picture: &mut surefoot_runtime::Picture, live: &_, eye: Vec3| {
        let camera = Camera { eye, target: [0.0; 3], fov: 0.7, ..Camera::PLAIN };
        headless::render_with(&gpu, picture, &compiled, live, &Shot { camera: Some(camera), ..Shot::new(48, 32) }).unwrap();
        picture.captures()
    };
    assert_eq!(draw(&mut picture, &live, [4.0, 3.0, 5.0]), 1);
    assert_eq!(draw(&mut picture, &live, [4.0, 3.0, 5.0]), 1);
    assert_eq!(draw(&mut picture, &live, [-4.0, 2.0, 5.0]), 1, "the eye moved");
    let before = picture.captured().unwrap();
    live.components[0] = 1.0;
    assert_eq!(draw(&mut picture, &live, [-4.0, 2.0, 5.0]), 2, "a mesh turned");
    assert!(picture.captured().unwrap() != before);
    picture.show_meshes(&assets.meshes(&compiled)).unwrap();
    assert_eq!(draw(&mut picture, &live, [-4.0, 2.0, 5.0]), 3, "meshes were replaced");
}

/// Blurred levels are means, and what needs no capture has none.
#[test]
fn a_capture_is_a_pass_of_its_own() {
    let gpu = gpu();
    let kinds = |text: &str| {
        let (compiled, assets) = scene_with_meshes(&files(text));
        let mut picture = prepare_with_meshes(&gpu, &compiled, &assets);
        let kinds: Vec<PassKind> = picture.passes().iter().map(|pass| pass.kind).collect();
        let wgsl = Features::of(&compiled, ViewMode::Shaded).wgsl(&compiled);
        assert_eq!(wgsl.contains("scene_capture"), kinds.contains(&PassKind::Capture), "{text}");
        let explained = surefoot_runtime::explain::explain(&gpu, &mut picture, &compiled, &compiled.live(), &Shot::new(32, 24)).unwrap();
        let size = explained.passes.iter().find(|pass| pass.name == "capture").map(|pass| pass.size.clone());
        (kinds, size, explained.left_out.iter().any(|(what, _)| *what == "capture"))
    };
    assert_eq!(kinds("scene = sphere(1)\n"), (vec![PassKind::Scene], None, true));
    let text = "scene = sphere(1)\nenvironment { capture: (0, 3, 0), size: 32 }\n";
    assert_eq!(kinds(text), (vec![PassKind::Capture, PassKind::Scene], Some("6 of 32x32".to_owned()), false));
    // A rough mirror sees of it what it sees of an image of the same sky.
    let mirror = "scene = nothing\nlight none { direction: (0, -1, 0), intensity: 0 }
        material mirror { color: #ffffff, roughness: 0.5, metallic: 1 }\nmesh m \"ball.obj\" { material: mirror }\ncamera { eye: (0, 0, 3), target: (0, 0, 0) }\n";
    let shown = |sky: &str| {
        let files = files(&format!("{mirror}environment {{ {sky} }}\n")).with("grey.png", png(64, 32, |_, _| [128; 3]));
        let (compiled, assets) = scene_with_meshes(&files);
        draw_with_meshes(&gpu, &compiled, &assets, &Shot::new(33, 33)).get(16, 16)
    };
    let (captured, image) = (shown("sky: #808080, capture: (0, 3, 0), size: 32"), shown("sky: equirect(\"grey.png\")"));
    assert!(captured[0].abs_diff(image[0]) <= 2, "{captured:?} {image:?}");
}
