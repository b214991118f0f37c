//! Meshes in the picture: the seam with the field, and files replaced under a running scene.

use crate::common;
use crate::common::{Disk, gpu, pictures};
use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};
use surefoot_compiler::compiled::{Camera, Compiled, Options};
use surefoot_compiler::camera::Basis;
use surefoot_compiler::vector::{Vec3, add, dot, scale, sub};
use surefoot_compiler::{MemoryLoader, compile, diagnostic};
use surefoot_runtime::headless::{self, FORMAT, Pixels, Shot};
use surefoot_runtime::live::{LiveScene, Setup, Update};
use surefoot_runtime::mesh::Assets;
use surefoot_runtime::{Gpu, Picture, ViewMode};
use surefoot_tests::solids::{cuboid, sphere, sphere_error};

/// A scene that may name `ball.obj`, a fine sphere of radius 1, and `box.obj`, a cube of side 1.
fn scene(text: &str) -> (Compiled, Assets) {
    let loader = MemoryLoader::new().with("s.sdf", text).with("ball.obj", sphere(ROWS).obj()).with("box.obj", cuboid([1.0; 3]).obj());
    let outcome = compile(&loader, "s.sdf", &Options::default());
    let words = diagnostic::render(&outcome.sources, &outcome.diagnostics, false);
    let compiled = outcome.compiled.unwrap_or_else(|| panic!("{words}"));
    let mut assets = Assets::new();
    let broken = assets.load(&loader, &compiled, &|_, _, _| {});
    assert!(broken.is_empty(), "{broken:?}");
    (compiled, assets)
}

fn prepare(gpu: &Gpu, compiled: &Compiled, assets: &Assets, mode: ViewMode) -> Picture {
    let mut picture = Picture::prepare(gpu, compiled, FORMAT, mode).unwrap();
    picture.show_meshes(&assets.meshes(compiled)).unwrap();
    picture
}

fn save(name: &str, pixels: &Pixels) {
    let path = pictures().join(format!("{name}.png"));
    image::save_buffer(&path, &pixels.rgba, pixels.width, pixels.height, image::ColorType::Rgba8).unwrap();
}

const ROWS: u32 = 160;
const SIZE: (u32, u32) = (240, 160);

/// A sphere of triangles that sinks into a plane: which of the two each pixel shows, by their normals, against rays in 64 bits.
#[test]
fn the_seam_lies_where_it_should() {
    let gpu = gpu();
    for (far, field) in [(0.0, "plane(y)"), (1e3, "plane(y)"), (1e5, "plane(y)"), (1e5, "nothing")] {
        let place = [far, far, -far];
        let text = format!(
            "scene = {field}.translate({far}, {far}, {0})\nmesh m \"ball.obj\" {{ translate: ({far}, {far} - 0.3, {0}) }}\nrender {{ extent: 1e6 }}\n",
            -far
        );
        let (compiled, assets) = scene(&text);
        let mut picture = prepare(&gpu, &compiled, &assets, ViewMode::Normals);
        // What the flat sides of the sphere lack, in pixels at the distance of 4, is less than the pixel that is allowed.
        assert!(sphere_error(ROWS) < 0.3 * 4.0 * 0.7 / f64::from(SIZE.1));
        for view in 0..8 {
            let (turn, height): (f64, f64) = (f64::from(view) * 0.785, 0.4 + 0.35 * f64::from(view % 4));
            // A little further each time, as a hand moves.
            for step in 0..2 {
                let turn = turn + 1e-3 * f64::from(step);
                let out = [turn.cos() * height.cos(), height.sin(), turn.sin() * height.cos()];
                let camera = Camera { eye: add(place, scale(out, 4.0)), target: place, fov: 0.7, ..Camera::PLAIN };
                let shot = Shot { camera: Some(camera), mode: ViewMode::Normals, ..Shot::new(SIZE.0, SIZE.1) };
                let live = compiled.live();
                let pixels = headless::render_with(&gpu, &mut picture, &compiled, &live, &shot).unwrap();
                if step == 0 {
                    let again = headless::render_with(&gpu, &mut picture, &compiled, &live, &shot).unwrap();
                    assert_eq!(pixels, again, "the same view twice");
                }
                let off = beyond_the_seam(&pixels, &camera, place, field != "nothing");
                if off.0 > 0 {
                    save(&format!("seam-{far}-{view}"), &pixels);
                }
                println!("{far} view {view}: {} pixels off the seam by more than one, {} at it", off.0, off.1);
                assert_eq!(off.0, 0, "{far}, view {view}");
            }
        }
    }
}

/// Whether a ray meets the sphere before the plane.
fn shows_sphere(eye: Vec3, direction: Vec3, plane: bool) -> bool {
    let plane = if plane && direction[1] < 0.0 { -eye[1] / direction[1] } else { f64::INFINITY };
    let way = sub([0.0, -0.3, 0.0], eye);
    let along = dot(way, direction);
    let rest = 1.0 - (dot(way, way) - along * along);
    rest > 0.0 && along - rest.sqrt() < plane
}

/// How many pixels show what no place within a pixel should, and how many show the other one at all.
fn beyond_the_seam(pixels: &Pixels, camera: &Camera, place: Vec3, plane: bool) -> (u32, u32) {
    let basis = Basis::of(camera);
    let eye = sub(camera.eye, place);
    let (mut off, mut at) = (0, 0);
    for y in 0..pixels.height {
        for x in 0..pixels.width {
            let [r, g, b, _] = pixels.get(x, y).map(i32::from);
            // The plane's normal is up, and nothing is dark grey.
            let (up, nothing) = ((r - 128).abs() <= 3 && g >= 250 && (b - 128).abs() <= 3, [r, g, b] == [31; 3]);
            let drawn = !up && !nothing;
            // The sphere's top has the plane's normal.
            let direction = |dx: f64, dy: f64| basis.direction((f64::from(x) + 0.5 + dx, f64::from(y) + 0.5 + dy), (pixels.width, pixels.height));
            let near_top = |d: Vec3| {
                let way = sub([0.0, 0.7, 0.0], eye);
                dot(d, way) / dot(way, way).sqrt() > 0.9995
            };
            let expected = |dx, dy| shows_sphere(eye, direction(dx, dy), plane);
            if drawn == expected(0.0, 0.0) || near_top(direction(0.0, 0.0)) {
                continue;
            }
            at += 1;
            let offsets = [-1.0, -0.5, 0.0, 0.5, 1.0];
            off += u32::from(!offsets.iter().any(|dx| offsets.iter().any(|dy| expected(*dx, *dy) == drawn)));
        }
    }
    (off, at)
}

/// What is behind the eye or at it is cut away and does not fold over.
#[test]
fn triangles_are_cut_at_the_eye() {
    let gpu = gpu();
    let (compiled, assets) = scene("scene = nothing\nmesh m \"box.obj\" { scale: (40, 1, 40), translate: (0, -1, 0) }\n");
    let mut picture = prepare(&gpu, &compiled, &assets, ViewMode::Normals);
    let camera = Camera { eye: [0.1, 0.0, 0.1], target: [1.0, 0.0, 0.4], fov: 1.2, ..Camera::PLAIN };
    let shot = Shot { camera: Some(camera), mode: ViewMode::Normals, ..Shot::new(120, 80) };
    let pixels = headless::render_with(&gpu, &mut picture, &compiled, &compiled.live(), &shot).unwrap();
    let up = |y: u32| (0..120).filter(|x| pixels.get(*x, y)[1] > 250).count();
    assert_eq!((up(0), up(35)), (0, 0), "nothing above the horizon");
    assert_eq!((up(44), up(79)), (120, 120), "the floor below it");
}

fn folder(name: &str) -> std::path::PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn next(live: &LiveScene) -> Update {
    let start = Instant::now();
    loop {
        if let Some(update) = live.poll() {
            return update;
        }
        assert!(start.elapsed() < Duration::from_secs(60), "no update: {:?}", live.report());
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn draw(gpu: &Gpu, update: Update) -> Pixels {
    let ready = update.ready.expect("a scene");
    let mut picture = ready.picture.expect("a picture");
    let camera = Camera { eye: [0.0, 0.5, 4.0], target: [0.0; 3], fov: 0.7, ..Camera::PLAIN };
    let shot = Shot { camera: Some(camera), mode: ViewMode::Normals, ..Shot::new(60, 40) };
    headless::render_with(gpu, &mut picture, &ready.compiled, &ready.compiled.live(), &shot).unwrap()
}

/// A mesh that is replaced on the disk is read anew; nothing is compiled and no pipeline built. One that breaks stays as it was.
#[test]
fn a_mesh_is_replaced_under_a_running_scene() {
    let gpu = gpu();
    let folder = folder("mesh-replaced");
    fs::write(folder.join("m.obj"), sphere(16).obj()).unwrap();
    fs::write(folder.join("s.sdf"), "scene = plane(y).translate(0, -1, 0)\nmesh m \"m.obj\" { }\n").unwrap();
    let live = LiveScene::start(Setup {
        path: folder.join("s.sdf").to_str().unwrap().to_owned(),
        options: Options::default(),
        loader: Arc::new(Disk),
        compile: Arc::new(compile),
        target: Some((gpu.clone(), FORMAT)),
        mode: ViewMode::Normals,
        wake: Arc::new(|| {}),
    })
    .unwrap();
    let first = next(&live);
    assert!(first.words.diagnostics.is_empty(), "{:?}", first.words.diagnostics);
    let ball = draw(&gpu, first);
    let (built, compiled) = (gpu.stats().pipelines, live.report().compilations);

    let started = Instant::now();
    fs::write(folder.join("new"), cuboid([1.0; 3]).obj()).unwrap();
    fs::rename(folder.join("new"), folder.join("m.obj")).unwrap();
    let second = next(&live);
    println!("replaced and ready after {:?}", started.elapsed());
    assert!(second.words.diagnostics.is_empty(), "{:?}", second.words.diagnostics);
    let cube = draw(&gpu, second);
    assert_ne!(ball, cube);
    assert_eq!((gpu.stats().pipelines, live.report().compilations), (built, compiled));

    fs::write(folder.join("m.obj"), "v 0 0 0\nf 1 2").unwrap();
    let third = next(&live);
    let found = &third.words.diagnostics[..];
    assert!(matches!(found, [d] if d.code == diagnostic::Code::BrokenFile), "{found:?}");
    assert_eq!(draw(&gpu, third), cube, "the last good mesh stays");

    fs::write(folder.join("m.obj"), sphere(16).obj()).unwrap();
    let fourth = next(&live);
    assert!(fourth.words.diagnostics.is_empty(), "{:?}", fourth.words.diagnostics);
    assert_eq!(draw(&gpu, fourth), ball);
    assert_eq!((gpu.stats().pipelines, live.report().compilations), (built, compiled));
}

/// A frame has the passes that its scene needs and no others, and says so.
#[test]
fn a_frame_is_what_its_scene_needs() {
    use surefoot_runtime::frame::PassKind::{self, Balls, Meshes, Scene, Shadows};
    let gpu = gpu();
    let mesh = "mesh m \"box.obj\" { translate: (0, 2, 0) }\n";
    let map = "light l { direction: (0, -1, 0), shadow: map }\n";
    let none = "light l { direction: (0, -1, 0), shadow: none }\n";
    let scenes: [(&str, &[PassKind], &str); 6] = [
        ("", &[Scene], "meshes balls shadow maps reflections capture images of the sky fog glass bloom lens and parallel rays"),
        (mesh, &[Shadows, Scene, Meshes], "balls reflections capture images of the sky fog glass bloom lens and parallel rays"),
        (&format!("{mesh}{none}"), &[Scene, Meshes], "balls shadows shadow maps reflections capture images of the sky fog glass bloom lens and parallel rays"),
        (&format!("{mesh}render {{ shadows: off, ambient_occlusion: (0, 0) }}\n"), &[Scene, Meshes], "balls shadows shadow maps occlusion reflections capture images of the sky fog glass bloom lens and parallel rays"),
        (map, &[Shadows, Scene], "meshes balls reflections capture images of the sky fog glass bloom lens and parallel rays"),
        ("balls b { count: 3 }\n", &[Shadows, Scene, Balls], "meshes reflections capture images of the sky fog glass bloom lens and parallel rays"),
    ];
    for (text, wanted, left_out) in scenes {
        let (compiled, assets) = scene(&format!("scene = plane(y)\n{text}"));
        let mut picture = prepare(&gpu, &compiled, &assets, ViewMode::Shaded);
        let kinds: Vec<PassKind> = picture.passes().iter().map(|pass| pass.kind).collect();
        assert_eq!(kinds, wanted, "{text}");
        let wgsl = surefoot_runtime::passes::scene::Features::of(&compiled, ViewMode::Shaded).wgsl(&compiled);
        assert_eq!(wgsl.contains("shadow_maps"), wanted.contains(&Shadows), "{text}");
        assert_eq!(wgsl.contains("frag_depth"), wanted.contains(&Meshes) || wanted.contains(&Balls), "{text}");
        assert_eq!(wgsl.contains("@group(3)"), wanted.contains(&Shadows), "{text}");
        let explained = surefoot_runtime::explain::explain(&gpu, &mut picture, &compiled, &compiled.live(), &Shot::new(64, 48)).unwrap();
        let names: Vec<&str> = explained.left_out.iter().map(|(what, _)| *what).collect();
        assert_eq!(names.join(" "), left_out, "{text}");
        assert_eq!(explained.passes.len(), wanted.len());
        for pass in &explained.passes {
            let size = if pass.name == "shadow maps" { "1 of 2048x2048" } else { "64x48" };
            assert_eq!(pass.size, size, "{pass:?}");
        }
        let time: Duration = explained.passes.iter().map(|pass| pass.time).sum();
        assert!(time > Duration::ZERO, "{explained:?}");
    }
}

/// A pass is bound to what its scene needs and to nothing else, and has no text of what it does not do.
#[test]
fn a_pass_has_the_bindings_that_its_scene_needs() {
    use surefoot_runtime::passes::scene::Features;
    let bindings = |text: &str| {
        let (compiled, _) = common::alike::scene(&MemoryLoader::new().with("main.sdf", format!("scene = plane(y)\n{text}")));
        let wgsl = Features::of(&compiled, ViewMode::Shaded).wgsl(&compiled);
        let number = |text: &str, word: &str| text.split_once(word).and_then(|(_, rest)| rest.split_once(')')).map(|(n, _)| n.to_owned());
        let found = wgsl.lines().filter(|line| line.starts_with("@group("));
        let found = found.map(|line| format!("{}.{}", number(line, "@group(").unwrap(), number(line, "@binding(").unwrap()));
        (found.collect::<Vec<_>>().join(" "), wgsl)
    };
    let (plain, text) = bindings("light l { direction: (0, -1, 0), shadow: none }\nrender { ambient_occlusion: (0, 0) }\n");
    assert_eq!(plain, "1.0");
    for word in ["sf_shadow", "sf_occlusion", "shadow_", "scene_cube", "scene_captured", "scene_followed", "scene_image", "scene_before", "frag_depth"] {
        assert!(!text.contains(word), "{word}");
    }
    let scenes = [
        ("mesh m \"box.obj\" { }\n", "1.0 3.0 3.1 3.2 2.0", "scene_before"),
        ("render { reflections: 1 }\n", "1.0", "scene_followed"),
        ("environment { sky: cubemap(\"sky/\") }\n", "1.0 1.1 1.2 1.3", "scene_cube"),
        ("environment { capture: (0, 1, 0) }\n", "1.0 1.13 1.14", "scene_captured"),
        ("material m { texture: \"a.png\" }\nmesh m \"box.obj\" { material: m }\nrender { shadows: off }\n", "1.0 1.4 1.5 2.0", "scene_image"),
    ];
    for (text, wanted, word) in scenes {
        let (found, wgsl) = bindings(text);
        assert_eq!(found, wanted, "{text}");
        assert!(wgsl.contains(word), "{word}");
    }
}

/// The meshes' depth drawn before the field, so that rays end at it, or the field drawn first: the same picture. `ORDER=1` measures both, on
/// scenes where the mesh hides much, a little and nothing.
#[test]
fn both_orders_draw_the_same() {
    use surefoot_runtime::passes::scene::Features;
    let gpu = gpu();
    let field = "scene = plane(y) | menger_sponge(2, 3).translate(0, 1, 0) | gyroid(0.5, 0.05).within(sphere(1.2)).translate(-2.4, 1.2, 0)\n";
    let camera = "camera { eye: (1, 2.5, 6), target: (-0.6, 1, 0) }\n";
    let meshes = [
        ("much", "mesh m \"ball.obj\" { translate: (-0.4, 1.2, 1.6), scale: 1.9 }\n"),
        ("a little", "mesh m \"ball.obj\" { translate: (1.4, 0.4, 1.2), scale: 0.6 }\nmesh n \"box.obj\" { translate: (-1, 1, 0.6) }\n"),
        ("nothing", "mesh m \"ball.obj\" { translate: (0, -9, 0) }\n"),
    ];
    let measured = std::env::var_os("ORDER").is_some();
    let size = if measured { (640, 360) } else { (160, 90) };
    for (name, mesh) in meshes {
        let (compiled, assets) = scene(&format!("{field}{camera}{mesh}"));
        let live = compiled.live();
        let draw = |meshes_first: bool| {
            let features = Features { meshes_first, ..Features::of(&compiled, ViewMode::Shaded) };
            let mut picture = Picture::prepare_with(&gpu, &compiled, FORMAT, features).unwrap();
            picture.show_meshes(&assets.meshes(&compiled)).unwrap();
            let shot = Shot::new(size.0, size.1);
            let pixels = headless::render_with(&gpu, &mut picture, &compiled, &live, &shot).unwrap();
            let mut times: Vec<Duration> = (0..if measured { 9 } else { 0 })
                .map(|_| {
                    let start = Instant::now();
                    headless::render_with(&gpu, &mut picture, &compiled, &live, &shot).unwrap();
                    start.elapsed()
                })
                .collect();
            times.sort();
            (pixels, times.get(4).copied().unwrap_or_default())
        };
        let ((before, before_time), (after, after_time)) = (draw(true), draw(false));
        if measured {
            println!("the mesh hides {name}: its depth first {before_time:.1?}, the field first {after_time:.1?}");
        }
        // Where both are as deep as each other, the digits decide.
        let differ = before.rgba.chunks_exact(4).zip(after.rgba.chunks_exact(4)).filter(|(a, b)| a != b).count();
        assert!(differ * 1000 <= (size.0 * size.1) as usize, "{name}: {differ} pixels differ");
        save(&format!("order-{name}"), &before);
    }
}

/// Far from the origin a scene has the light and the shadows that it has at it.
#[test]
fn the_light_is_the_same_far_out() {
    let gpu = gpu();
    let draw = |far: Vec3, shape: &str| {
        let at = |p: Vec3| format!("({}, {}, {})", far[0] + p[0], far[1] + p[1], far[2] + p[2]);
        let text = format!(
            "shape post = box(0.6, 2, 0.6).translate(1.4, 1, 0.8)\nscene = {}\nmesh m \"ball.obj\" {{ translate: {} }}\n\
             light sun {{ direction: (-1, -1.2, -0.5), shadow: soft(12) }}\ncamera {{ eye: {}, target: {} }}\nrender {{ extent: 1e6, max_distance: 100 }}\n",
            shape.replace("AWAY", &format!("translate{}", at([0.0; 3]))), at([0.0, 0.5, 0.0]), at([-2.0, 4.0, 5.0]), at([0.0, 0.5, 0.0])
        );
        let (compiled, assets) = scene(&text);
        let mut picture = prepare(&gpu, &compiled, &assets, ViewMode::Shaded);
        let pixels = headless::render_with(&gpu, &mut picture, &compiled, &compiled.live(), &Shot::new(SIZE.0, SIZE.1)).unwrap();
        save(&format!("far-{}-{}", far[0], far[1]), &pixels);
        pixels
    };
    let near = draw([0.0; 3], "plane(y) | post");
    let apart = |(a, b): &(&[u8], &[u8])| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 3);
    // All of it far out, and what is far out over a floor that is not.
    for (far, shape) in [([1e5, 1e5, -1e5], "(plane(y) | post).AWAY"), ([1e4, 0.0, -1e4], "plane(y) | post.AWAY")] {
        let away = draw(far, shape);
        let differ = near.rgba.chunks_exact(4).zip(away.rgba.chunks_exact(4)).filter(apart).count();
        println!("{differ} pixels differ");
        assert!(differ * 100 < (SIZE.0 * SIZE.1) as usize, "{shape}: {differ} pixels differ");
    }
}
