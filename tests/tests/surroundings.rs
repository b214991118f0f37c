//! What surrounds a scene and is mirrored in it: the GPU's picture is the CPU's, and each direction shows what stands there.

mod common;

use common::alike::{draw_with_meshes, on_the_gpu, on_the_processor, png, save, scene, scene_with_meshes, share_off};
use common::gpu;
use surefoot_compiler::MemoryLoader;
use surefoot_compiler::compiled::{Camera, Tone};
use surefoot_compiler::camera::Basis;
use surefoot_compiler::reference::film::develop;
use surefoot_compiler::reference::shade::Shading;
use surefoot_compiler::vector::{Vec3, add, along, dot, scale, sub, unit};
use surefoot_runtime::Gpu;
use surefoot_runtime::headless::Shot;
use surefoot_tests::solids::sphere;

/// The colour of a place on a face that says which face and which place: three levels for the face, `s` and `t` beside them.
fn told(face: usize, s: f64, t: f64) -> [u8; 3] {
    [40 + 35 * face as u8, (40.0 + 180.0 * s).round() as u8, (40.0 + 180.0 * t).round() as u8]
}

/// The tables of OpenGL 4.6 (8.13) and Vulkan (16.5.4): face, `s` and `t` of a direction, written here once more.
fn place(d: Vec3) -> (usize, f64, f64) {
    let [x, y, z] = d;
    let m = x.abs().max(y.abs()).max(z.abs());
    let (face, sc, tc) = if z.abs() == m {
        if z > 0.0 { (4, x, -y) } else { (5, -x, -y) }
    } else if y.abs() == m {
        if y > 0.0 { (2, x, z) } else { (3, x, -z) }
    } else if x > 0.0 {
        (0, -z, -y)
    } else {
        (1, z, -y)
    };
    (face, 0.5 * (sc / m + 1.0), 0.5 * (tc / m + 1.0))
}

/// Six faces that say where they are, as files of a folder.
fn faces_that_tell(files: MemoryLoader, folder: &str, side: u32) -> MemoryLoader {
    ["px", "nx", "py", "ny", "pz", "nz"].iter().enumerate().fold(files, |files, (face, name)| {
        let middle = |i: u32| (f64::from(i) + 0.5) / f64::from(side);
        files.with(&format!("{folder}/{name}.png"), png(side, side, |x, y| told(face, middle(x), middle(y))))
    })
}

#[test]
fn mirrored_fields_are_the_same_on_both() {
    let gpu = gpu();
    let scenes = [
        ("one", "render { reflections: 1 }"),
        ("three", "render { reflections: 3 }"),
        ("live", "param n: int = 2 in 0..4\nrender { reflections: n, ambient_occlusion: (0.4, 0.8) }"),
    ];
    for (name, render) in scenes {
        let text = format!(
            "material mirror {{ color: #e0e0e8, roughness: 0, metallic: 1, reflectivity: 1 }}
            material satin {{ color: #b07040, roughness: 0.35, metallic: 1 }}
            material floor {{ color: mix(#303840, #c8c0b0, step(0.5, fract(p.x) ) ), roughness: 0.15 }}
            scene = plane(y).material(floor) | sphere(1).translate(0, 1, 0).material(mirror)
                  | smooth_union(sphere(0.5).translate(1.5, 0.5, 0.8), box(0.6).translate(1.9, 0.4, 1.2), 0.3).material(satin)
                  | box(0.5, 2, 2).translate(-2, 1, 0).rotate(y, 0.4)
            camera {{ eye: (3, 2.2, 5), target: (0, 0.8, 0), fov: 40deg }}
            light sun {{ direction: (-1, -2, -1), shadow: soft(12) }}
            {render}"
        );
        let (compiled, loaded) = scene(&MemoryLoader::new().with("main.sdf", text));
        let size = (240, 160);
        let drawn = on_the_gpu(&gpu, &compiled, &loaded.images, &Shot::new(size.0, size.1));
        let wanted = on_the_processor(&compiled, &loaded.images, size);
        save(&format!("mirror-{name}-gpu"), &drawn);
        save(&format!("mirror-{name}-cpu"), &wanted);
        let off = share_off(&drawn, &wanted);
        println!("{name}: {:.3} % of the pixels are more than 2/255 off", 100.0 * off);
        assert!(off < 0.01, "{name}: {off}");
    }
}

#[test]
fn images_light_and_are_mirrored_the_same_on_both() {
    let gpu = gpu();
    let text = "environment { sky: cubemap(\"sky/\") }
        material mirror { color: #ffffff, roughness: 0, metallic: 1, reflectivity: 1 }
        material satin { color: #e0b080, roughness: 0.4, metallic: 1 }
        scene = sphere(1).material(mirror) | sphere(0.8).translate(2, 0, 0).material(satin) | sphere(0.8).translate(-2, 0, 0)
        camera { eye: (0, 1, 6), target: (0, 0, 0), fov: 50deg }
        render { reflections: 2 }";
    let (compiled, loaded) = scene(&faces_that_tell(MemoryLoader::new().with("main.sdf", text), "sky", 64));
    assert!(loaded.diagnostics.is_empty(), "{:?}", loaded.diagnostics);
    let size = (240, 160);
    let drawn = on_the_gpu(&gpu, &compiled, &loaded.images, &Shot::new(size.0, size.1));
    let wanted = on_the_processor(&compiled, &loaded.images, size);
    save("cube-gpu", &drawn);
    save("cube-cpu", &wanted);
    let off = share_off(&drawn, &wanted);
    println!("{:.3} % of the pixels are more than 2/255 off", 100.0 * off);
    assert!(off < 0.01, "{off}");
}

/// The directions to the middles, edges and corners of a cube, and a thousand others.
fn directions() -> Vec<Vec3> {
    let three = [-1.0, 0.0, 1.0];
    let all = three.iter().flat_map(|&x| three.iter().flat_map(move |&y| three.map(|z| [x, y, z])));
    let mut state = 7u32;
    let mut chance = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1 << 23) - 1.0
    };
    let others = std::iter::repeat_with(move || [chance(), chance(), chance()]).filter(|d| dot(*d, *d) < 1.0);
    let directions: Vec<Vec3> = all.filter_map(unit).chain(others.filter_map(unit).take(1000)).collect();
    assert_eq!(directions.len(), 1026);
    directions
}

/// A polished ball seen from two sides.
const BALL: &str = "material mirror { color: #ffffff, roughness: 0, metallic: 1, reflectivity: 1 }
    scene = sphere(1).material(mirror)
    camera front { eye: (1, 2, 8), target: (0, 0, 0), fov: 15.5deg }
    camera back { eye: (-2, -1, -8), target: (0, 0, 0), fov: 15.5deg }
    render { extent: 20, reflections: 1, ambient_occlusion: (0.5, 0) }\n";

/// The same, as triangles.
const MESH: &str = "material mirror { color: #ffffff, roughness: 0, metallic: 1, reflectivity: 1 }
    scene = nothing
    mesh ball \"ball.obj\" { material: mirror }
    camera front { eye: (1, 2, 8), target: (0, 0, 0), fov: 15.5deg }
    camera back { eye: (-2, -1, -8), target: (0, 0, 0), fov: 15.5deg }
    render { extent: 20, ambient_occlusion: (0.5, 0) }\n";

/// The most by which what the ball shows differs from what stands in the directions that it mirrors. `wanted` says what stands in a
/// direction, as a screen's colour; what a direction shows must lie between all that stands within `blur` of it.
fn check_mirror(gpu: &Gpu, name: &str, files: &MemoryLoader, wanted: impl Fn(Vec3) -> [u8; 3], blur: f64, tolerance: f64) {
    let (compiled, assets) = scene_with_meshes(files);
    let side = 512;
    let frame = compiled.frame(&compiled.live());
    let shading = Shading::of(&frame, assets.images().environment.clone());
    let pictures: Vec<_> = frame.cameras.iter().map(|(which, camera)| {
        let shot = Shot { camera: Some(*camera), ..Shot::new(side, side) };
        let pixels = draw_with_meshes(gpu, &compiled, &assets, &shot);
        save(&format!("{name}-{which}"), &pixels);
        (*camera, Basis::of(camera), pixels)
    }).collect();
    let linear = |c: u8| {
        let c = f64::from(c) / 255.0;
        if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    };
    // What a polished white metal leaves of it, and the film.
    let shown = |d: Vec3| develop(Tone::Aces, shading.exposed(wanted(d).map(|c| 0.967 * linear(c)))).map(|c| 255.0 * c);
    let mut worst: (f64, Vec3) = (0.0, [0.0; 3]);
    for d in directions() {
        let toward = |camera: &Camera| dot(unit(camera.eye).unwrap(), d);
        let (camera, basis, pixels) = pictures.iter().max_by(|a, b| toward(&a.0).total_cmp(&toward(&b.0))).unwrap();
        // The pixel that shows the place whose normal lies between the eye and the direction.
        let n = unit(add(unit(camera.eye).unwrap(), d)).unwrap();
        let way = sub(n, camera.eye);
        let depth = dot(way, basis.forward) * basis.tan_half_fov;
        let pixel = [dot(way, basis.right) / depth, -dot(way, basis.up) / depth].map(|c| (0.5 * (c + 1.0) * f64::from(side)).floor());
        // What its ray mirrors exactly.
        let ray = basis.direction((pixel[0] + 0.5, pixel[1] + 0.5), (side, side));
        let middle = -dot(camera.eye, ray);
        let nearest = along(camera.eye, ray, middle);
        let n = along(camera.eye, ray, middle - (1.0 - dot(nearest, nearest)).sqrt());
        let mirrored = sub(ray, scale(n, 2.0 * dot(ray, n)));
        let around = [-1.0, 0.0, 1.0].map(|x| [-1.0, 0.0, 1.0].map(|y| [-1.0, 0.0, 1.0].map(|z| add(mirrored, scale([x, y, z], blur)))));
        let around: Vec<Vec3> = around.iter().flatten().flatten().map(|d| shown(*d)).collect();
        let got = pixels.get(pixel[0] as u32, pixel[1] as u32);
        for channel in 0..3 {
            let low = around.iter().map(|c| c[channel]).fold(f64::INFINITY, f64::min);
            let high = around.iter().map(|c| c[channel]).fold(0.0, f64::max);
            let off = (low - f64::from(got[channel])).max(f64::from(got[channel]) - high).max(0.0);
            if off > worst.0 {
                worst = (off, mirrored);
            }
        }
    }
    println!("{name}: at most {:.2}/255 off, toward {:?}", worst.0, worst.1);
    assert!(worst.0 <= tolerance, "{name}: {:.2}/255 off toward {:?}", worst.0, worst.1);
}

#[test]
fn a_mirror_shows_of_each_direction_what_stands_there() {
    let gpu = gpu();
    let tells = |d: Vec3| {
        let (face, s, t) = place(d);
        told(face, s, t)
    };
    let cubemap = format!("environment {{ sky: cubemap(\"sky\") }}\n{BALL}");
    check_mirror(&gpu, "faces", &faces_that_tell(MemoryLoader::new().with("main.sdf", cubemap), "sky", 128), tells, 0.012, 2.0);
    // The same as one image of all directions; -z is in its middle.
    let equirect = format!("environment {{ sky: equirect(\"sky.png\") }}\n{BALL}");
    let (width, height) = (1024, 512);
    let image = png(width, height, |x, y| {
        let around = ((f64::from(x) + 0.5) / f64::from(width) - 0.5) * std::f64::consts::TAU;
        let down = (f64::from(y) + 0.5) / f64::from(height) * std::f64::consts::PI;
        tells([around.sin() * down.sin(), down.cos(), -around.cos() * down.sin()])
    });
    let files = MemoryLoader::new().with("main.sdf", equirect).with("sky.png", image);
    check_mirror(&gpu, "equirect", &files, tells, 0.02, 2.0);
    // On triangles, whose normals between corners are those of a ball but for a thousandth of a radian.
    let ball = sphere(160).obj();
    let cubemap = format!("environment {{ sky: cubemap(\"sky\") }}\n{MESH}");
    let files = MemoryLoader::new().with("main.sdf", cubemap).with("ball.obj", ball);
    check_mirror(&gpu, "faces-mesh", &faces_that_tell(files, "sky", 128), tells, 0.012, 2.0);
}
