//! What meshes are made of: formulas in their own space, and images by their own coordinates or from three sides.

use crate::common::alike::{draw_with_meshes, png, save, scene_with_meshes, share_off};
use crate::common::gpu;
use surefoot_compiler::MemoryLoader;
use surefoot_runtime::Gpu;
use surefoot_runtime::headless::{Pixels, Shot};
use surefoot_tests::solids::cuboid;

/// A rectangle before z = 0, its lower left corner at the origin; with coordinates that lay an image on it once, or without.
fn sheet(width: f64, height: f64, mapped: bool) -> String {
    let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
    let mut text = String::new();
    for (x, y) in corners {
        text += &format!("v {} {} 0\n", x * width, y * height);
    }
    if mapped {
        // An OBJ's second coordinate goes up.
        corners.iter().for_each(|(x, y)| text += &format!("vt {x} {y}\n"));
        text + "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n"
    } else {
        text + "f 1 2 3\nf 1 3 4\n"
    }
}

fn files(text: &str) -> MemoryLoader {
    let wave = |x: u32, y: u32| {
        let part = |i: u32, n: f64| (f64::from(i) / n * std::f64::consts::TAU).sin();
        [(127.5 + 60.0 * (part(x, 32.0) + part(2 * y, 32.0))).round() as u8; 3]
    };
    MemoryLoader::new()
        .with("main.sdf", text)
        .with("box.obj", cuboid([1.0, 1.4, 0.8]).obj())
        .with("mapped.obj", sheet(2.0, 0.5, true))
        .with("plain.obj", sheet(2.0, 0.5, false))
        .with("img/quarters.png", png(64, 16, |x, y| [(x * 4) as u8, (y * 15) as u8, if x < 32 { 40 } else { 200 }]))
        .with("img/wave.png", png(32, 32, wave))
        .with("img/wide.png", png(64, 16, wave))
}

fn draw(gpu: &Gpu, name: &str, text: &str) -> Pixels {
    let (compiled, assets) = scene_with_meshes(&files(text));
    let pixels = draw_with_meshes(gpu, &compiled, &assets, &Shot::new(240, 160));
    save(&format!("mesh-material-{name}"), &pixels);
    pixels
}

const LIGHT: &str = "light sun { direction: (-1, -2, -1.5), shadow: none }
    render { ambient_occlusion: (0.5, 0) }
    camera { eye: (1.3, 1.3, 2.5), target: (0.2, 0.3, -0.1), fov: 40deg }\n";

/// A mesh looks as a field of the same shape, of the same material, in the same place.
#[test]
fn a_mesh_looks_as_a_field_of_its_material() {
    let gpu = gpu();
    let materials = [
        ("own point", "let t = step(0.5, fract(3 * p.x + 2 * p.y * p.z)); color: mix(#204060, #f0e0c0, t), roughness: 0.3 + 0.5 * t"),
        ("world", "color: (fract(world.x), fract(2 * world.y), 0.5 + 0.5 * sin(4 * world.z)), roughness: 0.7"),
        ("normal", "color: abs(normal), metallic: step(0, normal.y), roughness: 0.5"),
        ("live", "color: mix(#802010, #f0e0c0, step(t, fract(2.3 * p.y + time)))"),
        ("another shape", "color: if sphere(0.6).at(p) < 0 { #d04020 } else { #e8e0d0 }"),
        ("bump", "color: #b07040, bump: 0.03 * sin(12 * p.x) * sin(12 * p.y) * sin(9 * p.z)"),
        ("image", "texture: \"img/quarters.png\", texture_scale: 0.8, roughness: \"img/wave.png\""),
        ("image's bump", "color: #b07040, bump: \"img/wave.png\", bump_height: 0.04, metallic: 1, roughness: 0.4"),
    ];
    for (name, material) in materials {
        let head = format!("param t = 0.4 in 0..1\nparam turn = 0.6 in 0..2\nmaterial m {{ {material} }}\n{LIGHT}");
        let mesh = "scene = nothing\nmesh b \"box.obj\" { rotate: (0.4, turn, -0.3), scale: 0.9, translate: (0.2, 0.3, -0.1), material: m }\n";
        let field = "scene = box(1, 1.4, 0.8).material(m).scale(0.9).rotate(x, 0.4).rotate(y, turn).rotate(z, -0.3).translate(0.2, 0.3, -0.1)\n";
        let [a, b] = [("mesh", mesh), ("field", field)].map(|(kind, text)| draw(&gpu, &format!("{name}-{kind}"), &format!("{head}{text}")));
        let off = share_off(&a, &b);
        println!("{name}: {:.3} % of the pixels differ", 100.0 * off);
        assert!(off < 0.01, "{name}: {off}");
    }
}

/// Where a file says so, an image lies by the mesh's own coordinates: on a sheet once, as it would from its front.
#[test]
fn images_lie_by_a_meshs_own_coordinates() {
    let gpu = gpu();
    let camera = "light sun { direction: (-1, -2, -1.5), shadow: none }
        render { ambient_occlusion: (0.5, 0) }
        camera { eye: (1.4, 0.9, 2.6), target: (1, 0.25, 0), fov: 40deg }
        scene = nothing\n";
    let materials = [
        ("colour", "color: \"img/quarters.png\""),
        ("bump", "color: #b07040, bump: \"img/wave.png\", bump_height: 0.05, roughness: 0.4"),
        ("wide bump", "color: #b07040, bump: \"img/wide.png\", bump_height: 0.05, metallic: 1, roughness: 0.4"),
    ];
    for (name, material) in materials {
        // By its own coordinates the image is 2 wide and as high as the sheet: from three sides it is as high as its pixels say, here the same for
        // the wide ones.
        let sheets = [("mapped.obj", 1.0), ("plain.obj", 0.5)].map(|(file, scale)| {
            let text = format!("{camera}material m {{ {material}, texture_scale: {scale} }}\nmesh s \"{file}\" {{ material: m }}\n");
            draw(&gpu, &format!("{name}-{file}"), &text)
        });
        let off = share_off(&sheets[0], &sheets[1]);
        println!("{name}: {:.3} % of the pixels differ", 100.0 * off);
        if name == "bump" {
            assert!(off > 0.05, "a square image is stretched by the coordinates: {off}");
        } else {
            assert!(off < 0.01, "{name}: {off}");
        }
    }
    // Left is left and up is up.
    let front = "scene = nothing\nmaterial m { color: \"img/quarters.png\", roughness: 1 }\nmesh s \"mapped.obj\" { material: m }
        light sun { direction: (0, 0, -1), shadow: none }\nrender { ambient_occlusion: (0.5, 0) }\ncamera { eye: (1, 0.25, 3), target: (1, 0.25, 0), fov: 40deg }\n";
    let seen = draw(&gpu, "front", front);
    let at = |x: u32, y: u32| seen.get(x, y);
    let (left, right, low, high) = (at(60, 80), at(180, 80), at(120, 92), at(120, 68));
    assert!(right[0] > left[0] + 60 && right[2] > left[2] + 60, "{left:?} {right:?}");
    assert!(low[1] > high[1] + 40, "{low:?} {high:?}");
}
