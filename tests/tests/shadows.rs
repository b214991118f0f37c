//! The four ways of shadows, each alone, against edges that are known: of a sphere on a plane, either of which is a field or a mesh.

use crate::common::{gpu, pictures};
use surefoot_compiler::compiled::{Camera, Compiled, Options};
use surefoot_compiler::camera::Basis;
use surefoot_compiler::vector::{Vec3, add, along, dot, length, scale, sub, unit};
use surefoot_compiler::{MemoryLoader, compile, diagnostic};
use surefoot_runtime::headless::{self, FORMAT, Pixels, Shot};
use surefoot_runtime::mesh::Assets;
use surefoot_runtime::{Gpu, Picture, ViewMode};
use surefoot_tests::solids::{cuboid, sphere};

const SIZE: (u32, u32) = (320, 240);
const CAMERA: Camera = Camera { eye: [-5.0, 6.0, 5.0], target: [-0.5, 0.5, 0.0], fov: 0.8, ..Camera::PLAIN };

fn draw(gpu: &Gpu, text: &str) -> Pixels {
    let (eye, target) = (CAMERA.eye, CAMERA.target);
    let text = format!("{text}camera {{ eye: ({}, {}, {}), target: ({}, {}, {}), fov: 0.8 }}\n", eye[0], eye[1], eye[2], target[0], target[1], target[2]);
    let loader = MemoryLoader::new().with("s.sdf", text).with("ball.obj", sphere(96).obj()).with("box.obj", cuboid([1.0; 3]).obj()).with("coarse.obj", sphere(10).obj());
    let outcome = compile(&loader, "s.sdf", &Options::default());
    let words = diagnostic::render(&outcome.sources, &outcome.diagnostics, false);
    assert!(words.is_empty(), "{words}");
    let compiled: Compiled = outcome.compiled.unwrap();
    let mut assets = Assets::new();
    assert!(assets.load(&loader, &compiled, &|_, _, _| {}).is_empty());
    let mut picture = Picture::prepare(gpu, &compiled, FORMAT, ViewMode::Shaded).unwrap();
    picture.show_meshes(&assets.meshes(&compiled)).unwrap();
    headless::render_with(gpu, &mut picture, &compiled, &compiled.live(), &Shot::new(SIZE.0, SIZE.1)).unwrap()
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Field,
    Mesh,
}

#[derive(Clone, Copy, Debug)]
enum Light {
    Direction(Vec3),
    Position(Vec3),
}

impl Light {
    fn text(self, shadow: &str, intensity: f64) -> String {
        let (key, v, more) = match self {
            Light::Direction(v) => ("direction", v, 1.0),
            Light::Position(v) => ("position", v, 30.0),
        };
        format!("light l {{ {key}: ({}, {}, {}), shadow: {shadow}, intensity: {} }}\n", v[0], v[1], v[2], intensity * more)
    }

    /// Toward the light from a place, and how far it is.
    fn toward(self, p: Vec3) -> (Vec3, f64) {
        match self {
            Light::Direction(v) => (unit(scale(v, -1.0)).unwrap(), f64::INFINITY),
            Light::Position(v) => (unit(sub(v, p)).unwrap(), length(sub(v, p))),
        }
    }
}

/// A sphere of radius 1 at a height over the plane y = 0.
fn scene(caster: Kind, receiver: Kind, height: f64) -> String {
    let sphere = format!("sphere(1).translate(0, {height}, 0)");
    let field = match (caster, receiver) {
        (Kind::Field, Kind::Field) => format!("{sphere} | plane(y)"),
        (Kind::Field, Kind::Mesh) => sphere,
        (Kind::Mesh, Kind::Field) => "plane(y)".to_owned(),
        (Kind::Mesh, Kind::Mesh) => "nothing".to_owned(),
    };
    let mut text = format!("scene = {field}\nrender {{ ambient_occlusion: (0, 0) }}\n");
    if caster == Kind::Mesh {
        text += &format!("mesh ball \"ball.obj\" {{ translate: (0, {height}, 0) }}\n");
    }
    if receiver == Kind::Mesh {
        text += "mesh floor \"box.obj\" { scale: (24, 1, 24), translate: (0, -0.5, 0) }\n";
    }
    text
}

/// The first of sphere and plane that a ray meets: how far, and whether it is the sphere.
fn met(eye: Vec3, direction: Vec3, height: f64) -> Option<(f64, bool)> {
    let plane = if direction[1] < 0.0 { -eye[1] / direction[1] } else { f64::INFINITY };
    let sphere = hit(eye, direction, height, 1.0);
    match sphere {
        Some(t) if t < plane => Some((t, true)),
        _ => plane.is_finite().then_some((plane, false)),
    }
}

fn hit(eye: Vec3, direction: Vec3, height: f64, radius: f64) -> Option<f64> {
    let way = sub([0.0, height, 0.0], eye);
    let middle = dot(way, direction);
    let rest = radius * radius - (dot(way, way) - middle * middle);
    (rest > 0.0 && middle > 0.0).then(|| (middle - rest.sqrt()).max(0.0))
}

fn shadowed(p: Vec3, light: Light, height: f64) -> bool {
    let (l, far) = light.toward(p);
    hit(p, l, height, 1.0).is_some_and(|t| t < far)
}

/// The share of the light that arrives at each pixel, by pictures with its shadow, without, and without the light.
fn shares(gpu: &Gpu, scene: &str, light: Light, shadow: &str) -> (Vec<f64>, Pixels) {
    let sum = |pixels: &Pixels, i: usize| pixels.rgba[4 * i..4 * i + 3].iter().map(|c| f64::from(*c)).sum::<f64>();
    let drawn = draw(gpu, &format!("{scene}{}", light.text(shadow, 3.0)));
    let lit = draw(gpu, &format!("{scene}{}", light.text("none", 3.0)));
    let dark = draw(gpu, &format!("{scene}{}", light.text("none", 0.0)));
    let share = |i| {
        let (a, b) = (sum(&dark, i), sum(&lit, i));
        if b - a < 24.0 { f64::NAN } else { (sum(&drawn, i) - a) / (b - a) }
    };
    ((0..(SIZE.0 * SIZE.1) as usize).map(share).collect(), drawn)
}

#[derive(Debug, Default, PartialEq)]
struct Counted {
    /// Pixels of the plane on the wrong side of the edge by more than two texels or pixels.
    off: u32,
    /// Pixels that are lit and drawn with shadow.
    acne: u32,
    /// Pixels in the midst of the shadow that are drawn lit.
    detached: u32,
    seen: u32,
    dark: u32,
}

fn judge(shares: &[f64], light: Light, height: f64, texel: f64) -> Counted {
    let basis = Basis::of(&CAMERA);
    let mut counted = Counted::default();
    for (i, share) in shares.iter().enumerate().filter(|(_, share)| share.is_finite()) {
        let (x, y) = (i as u32 % SIZE.0, i as u32 / SIZE.0);
        let direction = basis.direction((f64::from(x) + 0.5, f64::from(y) + 0.5), SIZE);
        let Some((t, ball)) = met(CAMERA.eye, direction, height) else { continue };
        let p = along(CAMERA.eye, direction, t);
        let (l, _) = light.toward(p);
        let pixel = t * basis.footprint(SIZE.1) / if ball { 1.0 } else { -direction[1] };
        if ball {
            let n = sub(p, [0.0, height, 0.0]);
            // The lit side of the sphere, but for where the light grazes it (there its flat triangles turn away) and where the plane cuts it.
            let cut = dot(n, scale(direction, -1.0)) < 0.2 || p[1] < 2.0 * pixel;
            if dot(n, l) > 0.15 && !cut {
                counted.seen += 1;
                counted.acne += u32::from(*share < 0.9);
            }
            continue;
        }
        // Where the sphere stands before it, within two pixels, a pixel shows it.
        let near = |by: f64| {
            let turns = (0..8).map(|k| f64::from(k) * std::f64::consts::FRAC_PI_4);
            turns.map(move |a| add(p, [by * a.cos(), 0.0, by * a.sin()])).collect::<Vec<_>>()
        };
        if length([p[0], p[2], 0.0]) > 9.0 || near(2.0 * pixel).iter().any(|q| met(CAMERA.eye, unit(sub(*q, CAMERA.eye)).unwrap(), height).is_some_and(|m| m.1)) {
            continue;
        }
        counted.seen += 1;
        let reach = 2.0 * pixel.max(texel / l[1]);
        let truth = shadowed(p, light, height);
        counted.dark += u32::from(truth);
        let around: Vec<bool> = [0.5 * reach, reach].into_iter().flat_map(near).map(|q| shadowed(q, light, height)).chain([truth]).collect();
        let drawn = *share < 0.5;
        counted.off += u32::from(!around.contains(&drawn));
        if around.iter().all(|dark| !dark) {
            counted.acne += u32::from(*share < 0.9);
        }
        if around.iter().all(|dark| *dark) {
            counted.detached += u32::from(*share > 0.1);
        }
    }
    counted
}

#[test]
fn every_way_has_its_edge() {
    let gpu = gpu();
    let lights = [Light::Direction([-1.0, -2.0, 0.5]), Light::Position([2.5, 5.0, -1.5])];
    let mut wrong = Vec::new();
    for (caster, receiver) in [(Kind::Field, Kind::Field), (Kind::Field, Kind::Mesh), (Kind::Mesh, Kind::Field), (Kind::Mesh, Kind::Mesh)] {
        for light in lights {
            for shadow in ["hard", "map"] {
                // In the air, and sunk into the plane.
                for height in [1.8, 0.6] {
                    let (shares, pixels) = shares(&gpu, &scene(caster, receiver, height), light, shadow);
                    // The pixels of a map: of the box that holds what throws or is seen, or of a side of the cube.
                    let texel = match light {
                        Light::Direction(_) => 36.0 / 2048.0,
                        Light::Position(_) => 2.0 * 6.0 / 1024.0,
                    };
                    let counted = judge(&shares, light, height, texel);
                    let name = format!("{caster:?} on {receiver:?}, {light:?}, {shadow}, {height}");
                    println!("{name}: {counted:?}");
                    assert!(counted.dark > 300 && counted.seen > 20_000, "{name}: {counted:?}");
                    if counted.off + counted.acne + counted.detached > 0 {
                        let way = match light {
                            Light::Direction(_) => "far",
                            Light::Position(_) => "near",
                        };
                        let path = pictures().join(format!("shadow-{caster:?}-{receiver:?}-{way}-{shadow}-{height}.png"));
                        image::save_buffer(&path, &pixels.rgba, pixels.width, pixels.height, image::ColorType::Rgba8).unwrap();
                        wrong.push(format!("{name}: {counted:?}"));
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The penumbra of a field's shadow is the same on a mesh as on the field.
#[test]
fn a_soft_shadow_is_as_soft_on_triangles() {
    let gpu = gpu();
    let light = Light::Direction([-1.0, -2.0, 0.5]);
    let [field, mesh] = [Kind::Field, Kind::Mesh].map(|receiver| shares(&gpu, &scene(Kind::Field, receiver, 1.8), light, "soft(8)").0);
    let both: Vec<f64> = field.iter().zip(&mesh).map(|(a, b)| (a - b).abs()).filter(|d| d.is_finite()).collect();
    let apart = both.iter().filter(|d| **d > 0.03).count();
    let soft = field.iter().filter(|s| **s > 0.1 && **s < 0.9).count();
    println!("{apart} of {} pixels differ; {soft} lie in the penumbra", both.len());
    assert!(soft > 500);
    assert!(apart * 200 < both.len(), "{apart} of {}", both.len());
}

/// Twenty triangles around: where the shape that they stand for is lit, so are they.
#[test]
fn a_coarse_mesh_is_lit_as_its_shape() {
    let gpu = gpu();
    let height = 1.8;
    for light in [Light::Direction([-1.0, -2.0, 0.5]), Light::Position([2.5, 5.0, -1.5]), Light::Direction([1.0, -0.2, 0.3])] {
        let text = format!("scene = nothing\nrender {{ ambient_occlusion: (0, 0) }}\nmesh m \"coarse.obj\" {{ translate: (0, {height}, 0) }}\n");
        let (shares, pixels) = shares(&gpu, &text, light, "hard");
        let counted = judge(&shares, light, height, 0.0);
        println!("{light:?}: {counted:?}");
        let path = pictures().join("coarse.png");
        image::save_buffer(&path, &pixels.rgba, pixels.width, pixels.height, image::ColorType::Rgba8).unwrap();
        assert!(counted.seen > 300 && counted.acne == 0, "{light:?}: {counted:?}");
    }
}

/// A union of many, whose operands stand in buffers, is in a light's map as it is.
#[test]
fn a_union_of_many_is_in_a_map() {
    let gpu = gpu();
    let text = |shadow: &str| {
        format!(
            "scene = plane(y) | for i in 0..40 {{ sphere(0.3).translate(3 * hash(i, 1) - 1.5, 0.4 + hash(i, 2), 3 * hash(i, 3) - 1.5) }}
            light l {{ direction: (-0.4, -1, -0.3), shadow: {shadow} }}\n"
        )
    };
    let (map, traced) = (draw(&gpu, &text("map")), draw(&gpu, &text("hard")));
    let apart = map.rgba.chunks(4).zip(traced.rgba.chunks(4)).filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 40)).count();
    println!("{apart} pixels differ");
    assert!(apart * 50 < map.rgba.len() / 4, "{apart}");
}
