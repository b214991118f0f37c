//! What light does between a scene and a screen: the light of scenes that say nothing of it, tone curves, fog.

use surefoot_compiler::compiled::{Compiled, Options};
use surefoot_compiler::reference::{Area, Reference, View};
use surefoot_compiler::{MemoryLoader, compile, diagnostic};

fn scene(text: &str) -> Compiled {
    let outcome = compile(&MemoryLoader::new().with("s.sdf", text), "s.sdf", &Options::default());
    let words = diagnostic::render(&outcome.sources, &outcome.diagnostics, false);
    outcome.compiled.unwrap_or_else(|| panic!("{text}: {words}"))
}

const SIZE: (u32, u32) = (120, 80);

/// The picture through the first camera: colours as a screen wants them, and how far the surface is.
fn picture(text: &str) -> Vec<[f32; 4]> {
    let compiled = scene(text);
    let live = compiled.live();
    let frame = compiled.frame(&live);
    let area = Area { left: 0, top: 0, width: SIZE.0, height: SIZE.1 };
    Reference::new(&compiled, &live).unwrap().tile(&frame, &frame.cameras[0].1, SIZE, View::Shaded, area)
}

fn at(picture: &[[f32; 4]], x: u32, y: u32) -> [f32; 4] {
    picture[(y * SIZE.0 + x) as usize]
}

#[test]
fn a_white_body_stays_white_in_the_light_of_a_scene_that_has_none() {
    let bodies = [
        "scene = sphere(1).translate(0, 1, 0) | plane(y)",
        "material white { color: #fff }\nscene = (sphere(1).translate(0, 1, 0) | plane(y)).material(white)",
        "material white { color: #fff }\nscene = (box(1.4).rotate(y, 0.4).translate(0, 0.7, 0) | torus(1.2, 0.2).translate(0, 0.2, 0) | plane(y)).material(white)",
        "material paper { color: #fff, roughness: 0.2 }\nscene = (cone(1, 2).translate(0, 1, 0) | plane(y)).material(paper)\nrender { reflections: 2 }",
        "material gray { color: #555 }\nscene = (box((3, 2, 0.2)).translate(0, 1, 0) | plane(y)).material(gray)",
    ];
    for text in bodies {
        let surface: Vec<[f32; 4]> = picture(text).into_iter().filter(|pixel| pixel[3] >= 0.0).collect();
        let light = |[r, g, b, _]: &[f32; 4]| r.max(*g).max(*b);
        let most = surface.iter().map(light).fold(0.0, f32::max);
        let dark = surface.iter().filter(|pixel| light(pixel) < 0.7 * most).count();
        assert!(dark > 200 && surface.len() - dark > 1000, "{text}: {dark} of {} pixels are in shadow", surface.len());
        for pixel in surface {
            let [r, g, b, _] = pixel;
            assert!(r.max(g).max(b) <= 1.06 * r.min(g).min(b), "{text}: {pixel:?}");
        }
    }
}

/// A mirror shows the sky above and the horizon beside, though no ray is followed.
#[test]
fn metal_mirrors_the_sky_without_reflections() {
    for render in ["", "render { reflections: 0 }", "render { reflections: 1 }"] {
        let ball = format!(
            "material metal {{ color: #fff, metallic: 1, roughness: 0.1 }}\nscene = sphere(1).material(metal)\n\
             camera {{ eye: (0, 0, 6), target: (0, 0, 0), fov: 24deg }}\n\
             light off {{ direction: (0, -1, 0), intensity: 0 }}\nenvironment {{ sky: gradient(#0000ff, #ff0000) }}\n{render}"
        );
        let seen = picture(&ball);
        // Half way up the ball mirrors what is nearly above.
        let above = at(&seen, 60, 12);
        let beside = at(&seen, 60, 39);
        assert!(above[2] > 0.8 && above[0] < 0.45, "{render}: {above:?}");
        assert!(beside[0] > 0.6 && beside[2] < 0.3, "{render}: {beside:?}");
    }
}

/// Grounds lit evenly: the picture before it is rounded.
const WALL: &str = "material wall { color: #000, emission: (0.25, 0.5, 1) }
    scene = box((40, 40, 0.1)).material(wall)
    camera { eye: (0, 0, 10), target: (0, 0, 0), fov: 20deg }
    light off { direction: (0, -1, 0), intensity: 0 }
    environment { sky: #000 }
    render { ambient_occlusion: (0, 0), tone: none, ENTRIES }";

fn wall(entries: &str) -> [f64; 3] {
    let [r, g, b, _] = at(&picture(&WALL.replace("ENTRIES", entries)), 60, 40);
    [r, g, b].map(|c| surefoot_compiler::srgb::decode(c.into()))
}

#[test]
fn fog_takes_light_by_its_way_and_gives_its_colour() {
    let near = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 2e-3);
    let plain = wall("");
    // A black wall still mirrors a little of a black sky: nothing.
    assert!(near(plain, [0.25, 0.5, 1.0]), "{plain:?}");
    for density in [0.0, 0.02, 0.1, 0.5] {
        let seen = wall(&format!("fog: (#f00, {density})"));
        let clear = (-density * 9.95f64).exp();
        // The wall mirrors a little of the fog too.
        let [r, wanted] = [seen[0], 0.25 * clear + 1.0 - clear];
        assert!(near([0.0, seen[1], seen[2]], [0.0, 0.5 * clear, clear]), "{density}: {seen:?}");
        assert!((wanted - 2e-3..=wanted + 0.05 * clear).contains(&r), "{density}: {seen:?}, {wanted}");
    }
    // The sky is as far as one sees.
    let sky = |density: f64| {
        let text = format!("scene = sphere(0.01)\nenvironment {{ sky: #00f }}\nrender {{ tone: none, max_distance: 50, fog: (#f00, {density}) }}");
        let [r, _, b, _] = at(&picture(&text), 0, 0);
        [r, b].map(|c| surefoot_compiler::srgb::decode(c.into()))
    };
    let [r, b] = sky(0.02);
    assert!((b - (-1.0f64).exp()).abs() < 2e-3 && (r - (1.0 - (-1.0f64).exp())).abs() < 2e-3, "{r} {b}");
}

#[test]
fn a_mirror_shows_the_fog_behind_the_eye() {
    let mirror = |entries: &str| {
        picture(&format!(
            "material glass {{ color: #fff, metallic: 1, roughness: 0 }}\nmaterial wall {{ color: #000, emission: (0, 0, 1) }}\n\
             scene = box((40, 40, 0.1)).material(glass) | box((40, 40, 0.1)).translate(0, 0, 20).material(wall)\n\
             camera {{ eye: (0, 0, 10), target: (0, 0, 0), fov: 20deg }}\nlight off {{ direction: (0, -1, 0), intensity: 0 }}\n\
             environment {{ sky: #000 }}\nrender {{ ambient_occlusion: (0, 0), tone: none, reflections: 1, {entries} }}"
        ))
    };
    let blue = |picture: Vec<[f32; 4]>| surefoot_compiler::srgb::decode(at(&picture, 60, 40)[2].into());
    let (clear, foggy) = (blue(mirror("")), blue(mirror("fog: (#000, 0.05)")));
    // 9.95 to the mirror and 19.9 from there to the wall.
    assert!((foggy / clear - (-0.05f64 * 29.85).exp()).abs() < 3e-3, "{clear} {foggy}");
}

#[test]
fn tone_is_the_one_that_the_text_names() {
    let of = |tone: &str| {
        let text = WALL.replace("tone: none, ENTRIES", tone);
        let [r, g, b, _] = at(&picture(&text), 60, 40);
        [r, g, b]
    };
    let curves = ["tone: aces", "tone: agx", "tone: neutral", "tone: none"].map(of);
    for (i, curve) in curves.iter().enumerate() {
        assert!(curves[..i].iter().all(|other| other.iter().zip(curve).any(|(a, b)| (a - b).abs() > 0.02)), "{curves:?}");
    }
    assert_eq!(of(""), curves[0]);
}

/// A wall that shines red above and blue below the middle, behind what `body` says.
fn before_a_wall(body: &str, material: &str, entries: &str) -> Vec<[f32; 4]> {
    picture(&format!(
        "material wall {{ color: #000, emission: if p.y > 0 {{ (0.5, 0, 0) }} else {{ (0, 0, 0.5) }} }}\n\
         material glass {{ color: #fff, roughness: 0, {material} }}\n\
         scene = box((40, 40, 0.1)).translate(0, 0, -6).material(wall) | ({body}).material(glass)\n\
         camera {{ eye: (0, 0, 10), target: (0, 0, 0), fov: 20deg }}\nlight off {{ direction: (0, -1, 0), intensity: 0 }}\n\
         environment {{ sky: #000 }}\nrender {{ ambient_occlusion: (0, 0), tone: none, {entries} }}"
    ))
}

fn linear(pixel: [f32; 4]) -> [f64; 3] {
    let [r, g, b, _] = pixel;
    [r, g, b].map(|c| surefoot_compiler::srgb::decode(c.into()))
}

#[test]
fn a_pane_lets_through_what_fresnel_leaves() {
    let pane = "box((4, 4, 0.4))";
    for (material, share) in [
        // What bends nothing mirrors nothing.
        ("transmission: 1, ior: 1", 1.0),
        ("transmission: 1", 0.96 * 0.96),
        ("transmission: 1, ior: 2", 64.0 / 81.0),
        ("transmission: 0.5, ior: 1", 0.5),
    ] {
        let seen = linear(at(&before_a_wall(pane, material, ""), 60, 36))[0] / 0.5;
        assert!((seen - share).abs() < 4e-3, "{material}: {seen}, {share}");
    }
    // A tint counts at both surfaces. Where no surface may be met inside, the sky is seen.
    let tinted = before_a_wall(pane, "transmission: 1, ior: 1", "");
    let tinted_glass = picture_of_tint();
    assert!((linear(at(&tinted_glass, 60, 36))[0] / linear(at(&tinted, 60, 36))[0] - 0.25).abs() < 4e-3);
    assert!(linear(at(&before_a_wall(pane, "transmission: 1, ior: 1", "reflections: 1"), 60, 36))[0] > 0.49);
    assert!(linear(at(&before_a_wall(pane, "transmission: 1, ior: 1", "reflections: 0"), 60, 36))[0] < 0.01);
}

fn picture_of_tint() -> Vec<[f32; 4]> {
    picture(
        "material wall { color: #000, emission: (0.5, 0, 0) }
         material glass { color: (0.5, 0.5, 0.5), roughness: 0, transmission: 1, ior: 1 }
         scene = box((40, 40, 0.1)).translate(0, 0, -6).material(wall) | box((4, 4, 0.4)).material(glass)
         camera { eye: (0, 0, 10), target: (0, 0, 0), fov: 20deg }
         light off { direction: (0, -1, 0), intensity: 0 }
         environment { sky: #000 }
         render { ambient_occlusion: (0, 0), tone: none }",
    )
}

/// A ball of glass is a lens: it shows what is behind it upside down.
#[test]
fn a_ball_of_glass_turns_what_is_behind_it() {
    let plain = before_a_wall("sphere(0.01).translate(9, 9, 0)", "transmission: 1", "");
    let lens = before_a_wall("sphere(1)", "transmission: 1", "");
    for (y, [r, b]) in [(30, [0.5, 0.0]), (50, [0.0, 0.5])] {
        let [seen, _, blue] = linear(at(&plain, 60, y));
        assert!((seen - r).abs() < 0.01 && (blue - b).abs() < 0.01, "{seen} {blue}");
        let [seen, _, blue] = linear(at(&lens, 60, y));
        assert!(if r > b { blue > 0.4 && seen < 0.05 } else { seen > 0.4 && blue < 0.05 }, "{y}: {seen} {blue}");
    }
}

#[test]
fn the_shadow_of_glass_has_what_comes_straight_through() {
    let floor = |material: &str| {
        let text = format!(
            "material glass {{ color: #fff, roughness: 0.1, {material} }}\n\
             scene = plane(y) | box((2, 0.2, 2)).translate(0, 3, 0).material(glass)\n\
             camera {{ eye: (0, 1.5, 4), target: (0, 0, 0), fov: 30deg }}\nlight sun {{ direction: (0, -1, 0), shadow: hard }}\n\
             environment {{ sky: #000 }}\nrender {{ ambient_occlusion: (0, 0), tone: none, exposure: -1 }}"
        );
        let seen = picture(&text);
        (linear(at(&seen, 60, 40))[0], linear(at(&seen, 4, 40))[0])
    };
    let (under, beside) = floor("transmission: 1");
    assert!((under / beside - 0.96 * 0.96).abs() < 0.02, "{under} {beside}");
    let (under, beside) = floor("transmission: 0");
    assert!(under < 0.2 * beside, "{under} {beside}");
    // Of `transmission: 0` nothing is in the module.
    assert!(!scene("material m { transmission: 0, ior: 2 }\nscene = sphere(1).material(m)").module.code().contains("glass"));
    assert!(scene("material m { transmission: 1 }\nscene = sphere(1).material(m) | box(1)").module.code().contains("fn sf_glass("));
}
