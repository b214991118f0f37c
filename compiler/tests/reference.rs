//! Pictures in 64 bits: a sphere has a closed form, and what a pixel shows does not depend on its neighbours.

use surefoot_compiler::compiled::{Camera, Compiled, MemoryLoader};
use surefoot_compiler::evaluate::lanes;
use surefoot_compiler::reference::area::{on_disc, toward};
use surefoot_compiler::camera::Basis;
use surefoot_compiler::reference::march::Ray;
use surefoot_compiler::reference::shade::Seen;
use surefoot_compiler::reference::{Area, Reference, View, rgb8};
use surefoot_compiler::{Options, compile, diagnostic};

fn scene(text: &str) -> Compiled {
    let loader = MemoryLoader::new().with("scene.sdf", text);
    let outcome = compile(&loader, "scene.sdf", &Options::default());
    let words = diagnostic::render(&outcome.sources, &outcome.diagnostics, false);
    outcome.compiled.unwrap_or_else(|| panic!("{words}"))
}

fn reference(compiled: &Compiled) -> Reference {
    Reference::new(compiled, &compiled.live()).unwrap()
}

fn whole((width, height): (u32, u32)) -> Area {
    Area { left: 0, top: 0, width, height }
}

const CAMERA: Camera = Camera { eye: [1.0, 2.0, 4.0], target: [0.0; 3], fov: 0.8, ..Camera::PLAIN };

/// A scene with a bit of everything: a plane, blends, a warp, noise, copies, two lights.
const PARTS: &str = "
param k = 0.3 in 0.1..0.5
material stripes { color: mix(#204060, #f0e0c0, step(0.5, fract(4 * p.y))), roughness: 0.4 }
scene = plane(y, -1)
      | smooth_union(sphere(0.7), box(1).translate(0.6, 0.3, 0), k).material(stripes)
      | for i in 0..7 { sphere(0.15 + 0.02 * i).translate(1.4, 0, 0).rotate(y, i * 1turn / 7) }
      | box(0.4, 1.6, 0.4).twist(y, 2).translate(-1.3, 0, 0.5)
light sun { direction: (-1, -2, -1), color: #fff2dd, intensity: 3, shadow: soft(16) }
light lamp { position: (2, 2, 2), color: #ffd0a0, intensity: 5, shadow: hard }
";

#[test]
fn a_sphere_is_where_the_formula_says() {
    let compiled = scene("scene = sphere(1.3)");
    let reference = reference(&compiled);
    let frame = compiled.frame(&compiled.live());
    let size = (157, 101);
    let basis = Basis::of(&CAMERA);
    let depth = reference.tile(&frame, &CAMERA, size, View::Depth, whole(size));
    let normals = reference.tile(&frame, &CAMERA, size, View::Normals, whole(size));
    let mut hits = 0;
    for (i, (depth, normal)) in depth.iter().zip(&normals).enumerate() {
        let at = ((i % 157) as f64 + 0.5, (i / 157) as f64 + 0.5);
        let d = basis.direction(at, size);
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let middle = -dot(CAMERA.eye, d);
        let rest = 1.3 * 1.3 - dot(CAMERA.eye, CAMERA.eye) + middle * middle;
        if rest.abs() < 0.05 {
            continue; // At the rim a ray hits what it passes within half a pixel.
        }
        if rest < 0.0 {
            assert_eq!(depth[3], -1.0);
            continue;
        }
        hits += 1;
        let t = middle - rest.sqrt();
        // A slanted ray is farther from its end by the slant.
        let slant = 1.3 / rest.sqrt();
        let tolerance = 0.01 * basis.footprint(size.1) * t * slant;
        let off = t - f64::from(depth[3]);
        assert!((-1e-5..=tolerance).contains(&off), "at {at:?}: {off} off");
        for axis in 0..3 {
            let wanted = 0.5 + 0.5 * (CAMERA.eye[axis] + d[axis] * t) / 1.3;
            let found = f64::from(normal[axis]);
            assert!((found - wanted).abs() < tolerance.max(1e-6), "at {at:?}: {found}, not {wanted}");
        }
    }
    assert!(hits > 3000, "{hits} hits");
}

#[test]
fn a_hit_is_on_the_surface_however_slanted_the_ray() {
    let reference = reference(&scene("scene = plane(y)"));
    let footprint = 0.003;
    for degrees in [2f64, 3.0, 5.0, 10.0, 40.0, 90.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let ray = Ray { origin: [0.0, 10.0 * sin, 0.0], direction: [0.0, -sin, cos], t_min: 0.0, t_max: 100.0 };
        let hit = reference.trace(&[ray], footprint, 1000.0)[0];
        let pixels = (hit.t - 10.0) / (10.0 * footprint);
        assert!(hit.hit && pixels.abs() < 0.1, "{degrees} degrees: {pixels} pixels beside the surface in {} looks", hit.steps);
        assert!(hit.steps < 100, "{degrees} degrees: {} looks", hit.steps);
    }
}

#[test]
fn what_is_thin_is_met_before_what_lies_behind() {
    // A sheet of a hundredth of a pixel stands before a wall: nearer to it than a leap is wide.
    let reference = reference(&scene("scene = box((8, 8, 0.0003)) | box((8, 8, 1)).translate(0, 0, -0.55)"));
    for i in 0..200 {
        let x = 0.03 * f64::from(i) - 3.0;
        let length = (100.0 + x * x).sqrt();
        let ray = Ray { origin: [0.0, 0.0, 10.0], direction: [x / length, 0.0, -10.0 / length], t_min: 0.0, t_max: 100.0 };
        let hit = reference.trace(&[ray], 0.003, 1000.0)[0];
        let wanted = length * (10.0 - 0.00015) / 10.0;
        assert!(hit.hit && (hit.t - wanted).abs() < 0.001, "{x}: {}, not {wanted}", hit.t);
    }
}

#[test]
fn where_faces_touch_no_ray_goes_between_them() {
    // A box stands on a table. Rays skim the table toward where the two meet.
    let reference = reference(&scene("scene = plane(y) | box((4, 2, 4)).translate(2, 1, 0)"));
    let footprint = 0.003;
    for degrees in [0.3f64, 1.0, 3.0, 10.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        for i in 0..300 {
            // So many pixels before or behind the box's foot the ray would meet the table.
            let beyond = (0.03 * f64::from(i) - 3.0) * 10.0 * footprint;
            let origin = [beyond - 10.0 * cos, 10.0 * sin, 0.1];
            let ray = Ray { origin, direction: [cos, -sin, 0.0], t_min: 0.0, t_max: 100.0 };
            let hit = reference.trace(&[ray], footprint, 1000.0)[0];
            let deep = (hit.t - (10.0 - beyond.max(0.0) / cos)) / (10.0 * footprint);
            assert!(hit.hit && deep < 0.5, "{degrees} degrees, {i}: {deep} pixels behind the surface");
        }
    }
}

#[test]
fn no_ray_goes_over_a_low_step() {
    // A step on a table, a part of a pixel high and a few long. Rays skim the table, cut the step, and would meet the table behind it.
    let footprint = 0.003;
    let pixel = 10.0 * footprint;
    let mut cut = 0;
    for (high, long) in [(0.1, 1.0), (0.2, 1.5), (0.2, 3.0), (0.4, 2.0)] {
        let step = format!("box(({}, {}, 4)).translate({}, 0, 0)", long * pixel, 2.0 * high * pixel, 0.5 * long * pixel);
        let reference = reference(&scene(&format!("scene = box((20, 1, 4)).translate(0, -0.5, 0) | {step}")));
        for degrees in [3f64, 6.0, 10.0, 15.0] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            for i in 0..200 {
                // Where the ray would meet the table, behind the step's front.
                let beyond = 0.03 * f64::from(i) * pixel;
                if beyond * sin / cos > high * pixel {
                    continue;
                }
                let origin = [beyond - 10.0 * cos, 10.0 * sin, 0.1];
                let ray = Ray { origin, direction: [cos, -sin, 0.0], t_min: 0.0, t_max: 100.0 };
                let hit = reference.trace(&[ray], footprint, 1000.0)[0];
                let deep = (origin[0] + hit.t * cos) / pixel;
                assert!(hit.hit && deep < 0.5, "{high} high, {long} long, {degrees} degrees, {i}: {deep} pixels behind the step's front");
                cut += 1;
            }
        }
    }
    assert!(cut > 500, "{cut} rays cut the step");
}

#[test]
fn what_comes_in_flat_or_hardly_gets_on_throws_a_shadow() {
    let shadow = |text: &str, origin: [f64; 3], direction: [f64; 3]| {
        let rays = [Ray { origin, direction, t_min: 0.0, t_max: 50.0 }];
        [0.0, 8.0].map(|softness| reference(&scene(text)).shadow(&rays, softness, 1000.0)[0])
    };
    // A ray that meets the top of a slab at half a degree needs more looks than there are; so does one that meets a sphere by the cube of its distance.
    for degrees in [0.5f64, 1.0, 1.5] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let [hard, soft] = shadow("scene = box((6, 0.3, 6))", [-2.0, 0.15 + sin, 0.0], [cos, -sin, 0.0]);
        assert_eq!(hard, 0.0, "{degrees}");
        // Of the disc the part above the slab is seen: of one with a half-angle of atan(1/8), so much less than the half.
        let seen = 0.5 - 8.0 * degrees.to_radians().tan() * 2.0 / std::f64::consts::PI;
        assert!((soft - seen).abs() < 0.05, "{degrees}: {soft}, {seen}");
        // And one that leaves it is lit as long as nothing stands in its way.
        assert_eq!(shadow("scene = box((6, 0.3, 6))", [2.0, 0.15 + 2.0 * sin, 0.0], [cos, sin, 0.0])[0], 1.0, "{degrees}");
    }
    let cube = "field f = { let a = dot(p, p) - 1; a * a * a }\nscene = f.within(box(3))";
    assert_eq!(shadow(cube, [0.1, -1.4, 0.0], [0.0, 1.0, 0.0]), [0.0, 0.0]);
    assert_eq!(shadow(cube, [1.3, -1.4, 0.0], [0.0, 1.0, 0.0])[0], 1.0);
}

#[test]
fn terraces_of_noise_are_met() {
    // The walls of the noise's own cells are no jumps, for what it is claimed to be is continuous there.
    // The bound of simplex noise is loose, so that some rays spend all their looks before its steps.
    let scenes =
        [("0.25 * floor(4 * perlin(p.xz))", 398), ("0.3 * round(3 * simplex(p.xz)) / 3", 375), ("0.1 * step(0.2, value_noise(2 * p.xz))", 398)];
    for (formula, least) in scenes {
        let reference = reference(&scene(&format!("scene = heightfield({formula})")));
        let mut field = reference.field().evaluator();
        let (mut met, mut on) = (0, 0);
        for i in 0..400 {
            let (x, z) = (0.37 * f64::from(i % 20) - 3.5, 0.41 * f64::from(i / 20) - 3.9);
            let ray = Ray { origin: [x, 4.0, z], direction: [0.6, -0.8, 0.0], t_min: 0.0, t_max: 20.0 };
            let hit = reference.trace(&[ray], 0.003, 100.0)[0];
            met += u32::from(hit.hit);
            let half = 0.5 * 0.003 * hit.t;
            field.run(&lanes(&[ray.at(hit.t - half), ray.at(hit.t + half)]));
            on += u32::from(hit.hit && field.output(0)[0] > 0.0 && field.output(0)[1] < 0.0);
        }
        // Some go over an edge that is thinner than a pixel.
        assert!(met >= least && on >= met - 10, "{formula}: {met} of 400 rays met it, {on} within half a pixel");
    }
}

#[test]
fn a_pixel_does_not_depend_on_its_neighbours() {
    let compiled = scene(PARTS);
    let reference = reference(&compiled);
    let frame = compiled.frame(&compiled.live());
    let size = (90, 60);
    for view in [View::Shaded, View::Normals, View::Steps, View::Depth] {
        let all = reference.tile(&frame, &CAMERA, size, view, whole(size));
        for (left, top) in [(0, 0), (45, 30), (44, 31), (20, 40), (70, 50), (31, 32), (89, 59)] {
            let area = Area { left, top, width: 1, height: 1 };
            let alone = reference.tile(&frame, &CAMERA, size, view, area);
            assert_eq!(alone[0], all[(top * 90 + left) as usize], "{view:?} at {left}, {top}");
        }
        let area = Area { left: 13, top: 7, width: 40, height: 33 };
        let part = reference.tile(&frame, &CAMERA, size, view, area);
        for (i, pixel) in part.iter().enumerate() {
            let (x, y) = (13 + i % 40, 7 + i / 40);
            assert_eq!(*pixel, all[y * 90 + x], "{view:?} at {x}, {y}");
        }
    }
}

#[test]
fn shadows_and_occlusion_are_those_of_simple_bodies() {
    let compiled = scene("scene = plane(y) | sphere(1).translate(0, 3, 0)");
    let reference = reference(&compiled);
    let up = |x: f64| Ray {
        origin: [x, 0.01, 0.0],
        direction: [0.0, 1.0, 0.0],
        t_min: 0.01,
        t_max: 50.0,
    };
    let rays: Vec<Ray> = [0.0, 0.9, 0.999, 1.001, 1.1, 4.0].map(up).to_vec();
    assert_eq!(reference.shadow(&rays, 0.0, 100.0), [0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
    let soft = reference.shadow(&rays, 8.0, 100.0);
    // At the edge of the hard shadow half of the disc is seen, and a tenth inside and outside as much less and more.
    assert!(soft[0] == 0.0 && soft[5] > 0.99, "{soft:?}");
    assert!(soft[2..4].iter().all(|s| (s - 0.5).abs() < 0.02) && (soft[1] + soft[4] - 1.0).abs() < 0.03 && (0.3..0.36).contains(&soft[1]), "{soft:?}");
    // Beyond the extent there is nothing that throws a shadow.
    assert_eq!(reference.shadow(&rays[..1], 0.0, 1.5), [1.0]);
}

#[test]
fn what_a_lamp_hangs_from_hides_what_rays_to_its_disc_say() {
    let lamp = [0.0, 0.8, 0.0];
    let softness = 8.0;
    let toward_lamp = |floor: f64, x: f64| {
        let way = [lamp[0] - x, lamp[1] - floor, lamp[2]];
        let far = (way[0] * way[0] + way[1] * way[1]).sqrt();
        Ray { origin: [x, floor, 0.0], direction: way.map(|c| c / far), t_min: 1e-3, t_max: far }
    };
    for floor in ["plane(y, -1)", "box(20, 1, 20).translate(0, -1.5, 0)"] {
        let rays: Vec<Ray> = (0..60).map(|i| toward_lamp(-1.0 + 1e-3, 0.05 * f64::from(i))).collect();
        // The board over it, and a ball in the midst of the way.
        for body in ["box(2, 0.1, 2).translate(0, 1, 0)", "sphere(0.2).translate(0, -0.1, 0)"] {
            let compiled = scene(&format!("scene = {floor} | {body}\nlight lamp {{ position: (0, 0.8, 0) }}"));
            let reference = reference(&compiled);
            let lit = reference.shadow(&rays, softness, 100.0);
            let mut truth = vec![0.0; rays.len()];
            for sample in 1..=256 {
                let place = on_disc(sample);
                let longer = (1.0 + (place[0].powi(2) + place[1].powi(2)) / softness.powi(2)).sqrt();
                let aimed = |ray: &Ray| Ray { direction: toward(ray.direction, 1.0 / softness, place), t_max: ray.t_max * longer, ..*ray };
                let seen = reference.shadow(&rays.iter().map(aimed).collect::<Vec<_>>(), 0.0, 100.0);
                truth.iter_mut().zip(seen).for_each(|(truth, seen)| *truth += seen / 256.0);
            }
            let apart = lit.iter().zip(&truth).map(|(a, b)| (a - b).abs());
            assert!(apart.clone().sum::<f64>() < 0.06 * 60.0 && apart.fold(0.0, f64::max) < 0.15, "{floor}, {body}: {lit:?} {truth:?}");
        }
    }
}

#[test]
fn the_edge_of_a_wedge_gets_its_share_of_the_sky() {
    // How far the wall leans away from upright.
    for lean in [-60, -30, 0, 30, 60] {
        let compiled = scene(&format!("scene = plane(y) | plane(x).rotate(z, {lean}deg)"));
        let reference = reference(&compiled);
        let edge = [Seen { point: [0.0; 3], normal: [0.0, 1.0, 0.0], direction: [0.0, -1.0, 0.0], t: 1.0 }];
        let share = (1.0 - f64::from(90 + lean).to_radians().cos()) / 2.0;
        let found = reference.occlusion(&edge, 0.5, 1.0)[0];
        // The text's angle has 32 bits.
        assert!((found - share).abs() < 1e-7, "leaning {lean}: {found} and not {share}");
        assert!((reference.occlusion(&edge, 0.5, 0.5)[0] - (1.0 + share) / 2.0).abs() < 1e-7);
    }
}

#[test]
fn the_extent_and_the_greatest_distance_end_a_scene() {
    let compiled = scene("scene = sphere(1)");
    let reference = reference(&compiled);
    let ray =
        |t_max| Ray { origin: [0.0, 0.0, 5.0], direction: [0.0, 0.0, -1.0], t_min: 0.0, t_max };
    let hits = reference.trace(&[ray(100.0), ray(3.9), ray(4.0)], 1e-4, 100.0);
    assert!(hits[0].hit && (hits[0].t - 4.0).abs() < 1e-3);
    assert!(!hits[1].hit);
    assert!(hits[2].hit, "the end itself is looked at");
    // A scene that reaches over its extent is cut there.
    assert!((reference.trace(&[ray(100.0)], 1e-4, 0.5)[0].t - 4.5).abs() < 1e-12);
    let beside = Ray { origin: [0.0, 0.9, 5.0], ..ray(100.0) };
    assert!(reference.trace(&[beside], 1e-4, 100.0)[0].hit);
    assert!(!reference.trace(&[beside], 1e-4, 0.8)[0].hit);
}

#[test]
fn awkward_cameras_and_sizes_still_give_a_picture() {
    let compiled = scene(PARTS);
    let reference = reference(&compiled);
    let frame = compiled.frame(&compiled.live());
    let cameras = [
        Camera { eye: [0.0, 5.0, 0.0], target: [0.0; 3], fov: 0.8, ..Camera::PLAIN },
        Camera { eye: [0.0; 3], target: [0.0; 3], fov: 0.8, ..Camera::PLAIN },
        Camera { eye: [0.0, -50.0, 0.0], target: [0.0; 3], fov: 3.2, ..Camera::PLAIN },
        Camera { eye: [1e7, 1e7, 1e7], target: [0.0; 3], fov: 1e-9, ..Camera::PLAIN },
    ];
    for camera in cameras {
        for size in [(1, 1), (33, 2), (3, 40)] {
            let pixels = reference.tile(&frame, &camera, size, View::Shaded, whole(size));
            assert_eq!(rgb8(&pixels, whole(size), View::Shaded).len(), 3 * (size.0 * size.1) as usize);
            assert!(pixels.iter().flatten().all(|c| c.is_finite()), "{camera:?} {size:?}");
        }
    }
}

/// A body without a material is grey beside one that has one, a cut shows what cut it, if that has one.
#[test]
fn what_has_no_material_looks_as_it_would_alone() {
    // On the cube's right side, and on the ball that stands out of its top or dents it.
    let (side, top, dent) = ([1.0, -0.5, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 0.0]);
    const RED: f64 = 1.0;
    const GREY: f64 = 0.55;
    for (text, places) in [
        ("cube | ball.material(red)", [(side, GREY), (top, RED)]),
        ("cube - ball.material(red)", [(side, GREY), (dent, RED)]),
        ("cube.material(red) - ball", [(side, RED), (dent, RED)]),
        ("cube.material(red) & ball", [(side, RED), (top, RED)]),
        ("smooth_union(cube, ball.material(red), 0.1)", [(side, GREY), (top, RED)]),
        ("smooth_union(cube.material(red), ball, 0.1)", [(side, RED), (top, GREY)]),
        ("smooth_difference(cube, ball.material(red), 0.1)", [(side, GREY), (dent, RED)]),
        ("smooth_difference(cube.material(red), ball, 0.1)", [(side, RED), (dent, RED)]),
        ("smooth_intersection(cube.material(red), ball, 0.1)", [(side, RED), (top, RED)]),
        ("cube.material(red).displace(0.05 * ball)", [(side, RED), (top, RED)]),
        ("mix(cube.material(red), cube, 0.5)", [(side, 0.5 * (RED + GREY)), (side, 0.5 * (RED + GREY))]),
        ("for i in 0..5 by smooth_union(0.05) { if i == 2 { ball.material(red) } else { cube.translate(0, 0, 4 * i) } }", [(side, GREY), (top, RED)]),
    ] {
        let compiled = scene(&format!(
            "material red {{ color: (1, 0.1, 0.1) }}\nshape cube = box(2)\nshape ball = sphere(1).translate(0, 1, 0)\nscene = {text}"
        ));
        let reference = reference(&compiled);
        for (point, want) in places {
            let place = Seen { point, normal: [0.0, 1.0, 0.0], direction: [0.0, -1.0, 0.0], t: 1.0 };
            let red = reference.surfaces(&[place])[0].color[0];
            assert!((red - want).abs() < 0.01, "{text} at {point:?}: {red} and not {want}");
        }
    }
}

#[test]
fn what_nobody_has_coloured_stands_out_from_the_sky_that_nobody_has_painted() {
    let compiled = scene("scene = sphere(1)");
    let frame = compiled.frame(&compiled.live());
    let size = (90, 60);
    let picture = reference(&compiled).tile(&frame, &frame.cameras[0].1, size, View::Shaded, whole(size));
    let grey = |x: usize, y: usize| picture[y * 90 + x][..3].iter().sum::<f32>() / 3.0;
    let (sky, lit, shaded) = (grey(5, 5), grey(39, 24), grey(50, 43));
    assert!(lit > sky + 0.12 && shaded < sky - 0.12, "{lit} in the light, {shaded} in the shade, {sky} behind");
}
