//! A sphere has a closed form: every pixel is asserted.

mod common;

use common::{EYE, gpu, sphere, sphere_in};
use glam::DVec3;
use surefoot_compiler::compile;
use surefoot_compiler::compiled::{Export, MemoryLoader, Options};
use surefoot_runtime::headless::{self, FORMAT, Shot};
use surefoot_runtime::passes::scene::Features;
use surefoot_runtime::{Gpu, Picture, View, ViewMode, evaluate};

/// Where the ray of a pixel meets a sphere about the origin: the normal there, and how far beside the rim the ray passes.
fn truth(x: u32, y: u32, (width, height): (u32, u32), radius: f64) -> (Option<DVec3>, f64) {
    let eye = DVec3::from(EYE);
    let forward = (-eye).normalize();
    let right = forward.cross(DVec3::Y).normalize();
    let up = right.cross(forward);
    let half = (0.8f64 / 2.0).tan();
    let across = (2.0 * (f64::from(x) + 0.5) - f64::from(width)) / f64::from(height);
    let down = 2.0 * (f64::from(y) + 0.5) / f64::from(height) - 1.0;
    let direction = (forward + half * (across * right - down * up)).normalize();
    let middle = -eye.dot(direction);
    let nearest = (eye + middle * direction).length();
    let beside = nearest - radius;
    if beside >= 0.0 {
        return (None, beside);
    }
    let t = middle - (radius * radius - nearest * nearest).sqrt();
    (Some((eye + t * direction) / radius), beside)
}

#[test]
fn silhouette_and_normals_are_those_of_the_formula() {
    let gpu = gpu();
    // Wider than a tile, and neither side a multiple of one, so that the seams are looked at too.
    let size = (701, 530);
    let compiled = sphere(1.3);
    let shot = Shot { mode: ViewMode::Normals, ..Shot::new(size.0, size.1) };
    let pixels = headless::render(&gpu, &compiled, &compiled.live(), &shot).unwrap();
    let background = pixels.get(0, 0);
    let mut hits = 0;
    for y in 0..size.1 {
        for x in 0..size.0 {
            let (normal, beside) = truth(x, y, size, 1.3);
            let got = pixels.get(x, y);
            if beside.abs() < 2e-3 {
                continue; // Within a fifth of a pixel of the rim, either answer is right.
            }
            let Some(normal) = normal else {
                assert_eq!(got, background, "a ray that misses, at {x}, {y}");
                continue;
            };
            hits += 1;
            // Where a ray touches the rim, a hit that is off by the tolerance turns the normal by its root.
            let allowed = if beside > -0.02 { 6 } else { 2 };
            for (got, want) in got.into_iter().zip(normal.to_array()) {
                let want = 255.0 * (0.5 + 0.5 * want);
                assert!(
                    (f64::from(got) - want).abs() <= f64::from(allowed),
                    "at {x}, {y}: {got}, not {want}"
                );
            }
        }
    }
    assert!(hits > 40_000, "{hits} hits");
}

#[test]
fn all_views_draw_and_differ() {
    let gpu = gpu();
    let compiled = sphere(1.0);
    let modes = [ViewMode::Shaded, ViewMode::Normals, ViewMode::Steps, ViewMode::Depth];
    let pictures = modes.map(|mode| {
        let shot = Shot { mode, ..Shot::new(64, 48) };
        headless::render(&gpu, &compiled, &compiled.live(), &shot).unwrap()
    });
    for (i, a) in pictures.iter().enumerate() {
        assert_ne!(a.get(32, 24), a.get(0, 0), "{:?} shows the sphere", modes[i]);
        for b in &pictures[..i] {
            assert_ne!(a, b);
        }
    }
}

#[test]
fn a_slider_builds_nothing_and_what_is_the_same_writes_nothing() {
    let gpu = gpu();
    let compiled = sphere(1.0);
    let mut picture = Picture::prepare(&gpu, &compiled, FORMAT, ViewMode::Normals).unwrap();
    let built = gpu.stats();
    assert_eq!(built.pipelines, 2, "that of the field, and that of its cones");
    let mut live = compiled.live();
    let frame = compiled.frame(&live);
    let mut view = View { camera: frame.cameras[0].1, size: [64.0, 48.0], corner: [0.0, 0.0], sample: 0 };
    assert!(picture.update(gpu.queue(), &compiled, &live, &view));
    assert!(!picture.update(gpu.queue(), &compiled, &live, &view), "nothing changed");
    let shot = Shot { mode: ViewMode::Normals, ..Shot::new(64, 48) };
    let mut covered = Vec::new();
    for radius in [0.5, 1.0, 1.5] {
        live.components[0] = radius;
        assert!(picture.update(gpu.queue(), &compiled, &live, &view));
        let pixels = headless::render_with(&gpu, &mut picture, &compiled, &live, &shot).unwrap();
        let background = pixels.get(0, 0);
        covered.push(pixels.rgba.chunks(4).filter(|p| **p != background).count());
    }
    assert!(covered[0] < covered[1] && covered[1] < covered[2], "{covered:?}");
    view.camera.eye = [0.0, 0.0, 5.0];
    assert!(picture.update(gpu.queue(), &compiled, &live, &view));
    assert_eq!(gpu.stats(), built, "no module and no pipeline for all that");
    // The same scene again is there already.
    Picture::prepare(&gpu, &sphere(1.4), FORMAT, ViewMode::Normals).unwrap();
    assert_eq!((gpu.stats().pipelines, gpu.stats().reused), (2, 2));
}

#[test]
fn what_the_device_refuses_comes_back_as_text() {
    let gpu = gpu();
    gpu.device().on_uncaptured_error(std::sync::Arc::new(|error| panic!("uncaptured: {error}")));
    for broken in ["fn sf_field(p: vec3f) -> f32 { return p; }", "nonsense", ""] {
        let compiled = sphere_in(broken, 1.0, (0.5, 2.0));
        let refused = Picture::prepare(&gpu, &compiled, FORMAT, ViewMode::Normals).map(|_| ());
        assert!(refused.is_err_and(|text| !text.is_empty()), "{broken}");
        let refused = evaluate(&gpu, &compiled, &compiled.live(), [0.0; 3], Export::Field, &[]);
        assert!(refused.is_err(), "{broken}");
    }
    // A block that is smaller than what the shader reads.
    let mut compiled = sphere(1.0);
    compiled.module.uniform_size = 0;
    assert!(Picture::prepare(&gpu, &compiled, FORMAT, ViewMode::Normals).is_err());
    // A function that the pass needs and the module lacks.
    let mut compiled = sphere(1.0);
    compiled.module.exports.clear();
    assert!(Picture::prepare(&gpu, &compiled, FORMAT, ViewMode::Normals).is_err());
    let good = sphere(1.0);
    for (width, height) in [(0, 10), (10, 0), (1 << 20, 1 << 20)] {
        let shot = Shot::new(width, height);
        assert!(headless::render(&gpu, &good, &good.live(), &shot).is_err());
    }
    assert!(headless::render(&gpu, &good, &good.live(), &Shot::new(3, 1)).is_ok());
}

#[test]
fn functions_at_points() {
    let gpu = gpu();
    let compiled = sphere(1.25);
    let live = compiled.live();
    let points: Vec<[f32; 3]> = (0..1000)
        .map(|i| [i as f32 * 0.01 - 5.0, (i % 7) as f32 - 3.0, (i % 11) as f32 - 5.0])
        .collect();
    let origin = [0.25, 0.5, -0.75];
    for export in [Export::Field, Export::Bound, Export::Distance] {
        let got = evaluate(&gpu, &compiled, &live, origin, export, &points).unwrap();
        assert_eq!(got.len(), points.len());
        for (p, got) in points.iter().zip(got) {
            let want = (DVec3::from(p.map(f64::from)) + DVec3::from(origin)).length() - 1.25;
            assert!((f64::from(got) - want).abs() < 1e-5, "{p:?}: {got}, not {want}");
        }
    }
    let got = evaluate(&gpu, &compiled, &live, [0.0; 3], Export::Gradient, &points).unwrap();
    for (p, got) in points.iter().zip(got.chunks(4)) {
        let want = DVec3::from(p.map(f64::from));
        let direction = want.normalize_or_zero();
        let got = DVec3::new(got[0].into(), got[1].into(), got[2].into());
        assert!(got.distance(direction) < 1e-5, "{p:?}: {got}, not {direction}");
    }
    assert!(evaluate(&gpu, &compiled, &live, [0.0; 3], Export::Field, &[]).unwrap().is_empty());
    assert!(evaluate(&gpu, &compiled, &live, [0.0; 3], Export::Trace, &points).is_err());
}

/// Draws into a rectangle of a larger target, as a window's panel does.
fn draw_within(
    gpu: &Gpu,
    format: wgpu::TextureFormat,
    at: (u32, u32),
    size: (u32, u32),
) -> Vec<u8> {
    let compiled = sphere(1.0);
    let live = compiled.live();
    let mut picture = Picture::prepare(gpu, &compiled, format, ViewMode::Shaded).unwrap();
    let view = View {
        camera: compiled.frame(&live).cameras[0].1,
        size: [size.0 as f32, size.1 as f32],
        corner: [at.0 as f32, at.1 as f32],
        sample: 0,
    };
    picture.update(gpu.queue(), &compiled, &live, &view);
    // A row of 128 pixels is a multiple of 256 bytes.
    let (width, height) = (128, 96);
    let device = gpu.device();
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(4 * width * height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    let target = texture.create_view(&Default::default());
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &target,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations::default(),
        })],
        ..Default::default()
    });
    pass.set_viewport(at.0 as f32, at.1 as f32, size.0 as f32, size.1 as f32, 0.0, 1.0);
    pass.set_scissor_rect(at.0, at.1, size.0, size.1);
    picture.draw(&mut pass);
    drop(pass);
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(4 * width),
                rows_per_image: None,
            },
        },
        texture.size(),
    );
    gpu.queue().submit([encoder.finish()]);
    buffer.map_async(wgpu::MapMode::Read, .., |result| result.unwrap());
    device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    let all = buffer.get_mapped_range(..).unwrap().to_vec();
    let rows = all.chunks(4 * width as usize).skip(at.1 as usize).take(size.1 as usize);
    rows.flat_map(|row| row[4 * at.0 as usize..][..4 * size.0 as usize].to_vec()).collect()
}

#[test]
fn a_panel_shows_the_same_picture_whatever_encodes_its_colours() {
    let gpu = gpu();
    let (at, size) = ((40, 21), (64, 48));
    let compiled = sphere(1.0);
    let want =
        headless::render(&gpu, &compiled, &compiled.live(), &Shot::new(size.0, size.1)).unwrap();
    let plain = draw_within(&gpu, wgpu::TextureFormat::Rgba8Unorm, at, size);
    // The corner is added and taken away again in 32 bits: a digit of the colour may turn over.
    let off = |got: &[u8]| want.rgba.iter().zip(got).map(|(a, b)| a.abs_diff(*b)).max().unwrap();
    assert!(off(&plain) <= 1, "{}", off(&plain));
    let encoded = draw_within(&gpu, wgpu::TextureFormat::Rgba8UnormSrgb, at, size);
    assert!(off(&encoded) <= 1, "{}", off(&encoded));
}

#[test]
fn a_foreign_device_will_do() {
    let instance = wgpu::Instance::default();
    let adapter = pollster::block_on(instance.request_adapter(&Default::default())).unwrap();
    // As little as a program can ask for.
    let descriptor = wgpu::DeviceDescriptor {
        required_limits: wgpu::Limits::downlevel_defaults(),
        ..Default::default()
    };
    let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).unwrap();
    let gpu = Gpu::from_parts(device, queue);
    assert!(!gpu.name().is_empty());
    let compiled = sphere(1.0);
    let pixels = headless::render(&gpu, &compiled, &compiled.live(), &Shot::new(40, 30)).unwrap();
    assert_ne!(pixels.get(20, 15), pixels.get(0, 0));
    assert_eq!(pixels.get(40, 0), [0; 4], "outside");
}

#[test]
fn what_a_scene_does_not_need_is_not_compiled() {
    let gpu = gpu();
    let dark = "light l { direction: (0, -1, 0), shadow: none }\n";
    let soft = "light l { direction: (0, -1, 0), shadow: soft(8) }\n";
    let open = "render { ambient_occlusion: (0.5, 0) }\n";
    let unlit = "render { ambient_occlusion: (0.5, 0), shadows: off }\n";
    let live = "param on = true\nrender { ambient_occlusion: (0, 1), shadows: on }\n";
    // A scene, whether its pictures know shadows, and whether they know occlusion.
    for (text, shadows, occlusion) in [
        (String::new(), true, true),
        (dark.to_owned(), false, true),
        (soft.to_owned(), true, true),
        (open.to_owned(), true, false),
        (unlit.to_owned(), false, false),
        (format!("{soft}{unlit}"), false, false),
        (format!("{dark}{open}"), false, false),
        (format!("{soft}{live}"), true, false),
    ] {
        let loader = MemoryLoader::new().with("a.sdf", format!("scene = sphere(1)\n{text}"));
        let compiled = compile(&loader, "a.sdf", &Options::default()).compiled.expect(&text);
        let features = Features::of(&compiled, ViewMode::Shaded);
        assert_eq!((features.shadows, features.occlusion), (shadows, occlusion), "{text}");
        let pass = features.wgsl(&compiled);
        assert_eq!(pass.contains("sf_shadow"), shadows, "{text}");
        assert_eq!(pass.contains("sf_occlusion"), occlusion, "{text}");
        let picture = Picture::prepare(&gpu, &compiled, FORMAT, ViewMode::Shaded).unwrap();
        let [only] = picture.passes() else { panic!("one pass: {:?}", picture.passes()) };
        assert_eq!(only.reason.contains("shadows"), shadows, "{text}");
        assert_eq!(only.reason.contains("corners"), occlusion, "{text}");
        // The other views know neither, nor materials.
        for mode in [ViewMode::Normals, ViewMode::Steps, ViewMode::Depth] {
            let features = Features::of(&compiled, mode);
            assert!(!features.shadows && !features.occlusion);
            assert!(!features.wgsl(&compiled).contains("sf_surface"));
        }
    }
}

/// A look of few operations costs no more than to read where a ray begins; and some views show looks.
#[test]
fn cones_are_left_out_where_they_do_not_pay() {
    let cones = |text: &str, view| {
        let compiled = compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default()).compiled.unwrap();
        Features::of(&compiled, view).cones
    };
    assert!(!cones("scene = plane(y)", ViewMode::Shaded));
    let boxes = "scene = box(1) | box(1).translate(2, 0, 0)";
    assert!(cones(boxes, ViewMode::Shaded) && !cones(boxes, ViewMode::Steps) && !cones(boxes, ViewMode::Slice(0)));
}

/// Rays that begin where their tile's cone ends meet what they met before: within the tolerance, and none passes through what is thin.
#[test]
fn cones_change_no_picture() {
    let gpu = gpu();
    let rods = "capsule((-2, 0, 0), (2, 1, -1), 0.004) | capsule((0, -2, 0), (0.3, 2, 0), 0.002) | box(0.4).translate(0.8, -0.5, 0)";
    let scenes = [
        // A plane that rays graze, and what is thinner than a pixel.
        format!("scene = {rods} | plane(y, -0.9)\ncamera {{ eye: (3, -0.8, 5), target: (0, -0.4, 0) }}\n"),
        // A field whose bound is much less than the distance, seen from outside of the extent.
        "scene = torus(1, 0.3).twist(y, 2) | sphere(0.2).repeat((0.7, 0, 0.7))\ncamera { eye: (9, 5, 9), target: (0, 0, 0) }\nrender { extent: 4, max_distance: 40 }\n".to_owned(),
        // Rays side by side, and through a lens.
        format!("scene = {rods}\ncamera {{ eye: (3, 2, 5), target: (0, 0, 0), projection: orthographic, height: 4 }}\n"),
        format!("scene = {rods}\ncamera {{ eye: (3, 2, 5), target: (0, 0, 0), lens: 0.05 }}\n"),
        // The eye in a corner, and in the solid.
        "scene = box(8) - box(3) | sphere(0.5).translate(1.2, 1.2, 0)\ncamera { eye: (1.49, 0, 1.49), target: (0, 0.4, 0) }\n".to_owned(),
        "scene = box(3) | sphere(2).translate(3, 0, 0) | torus(2, 0.1)\ncamera { eye: (1, 0, 1), target: (0, 0, 0) }\n".to_owned(),
    ];
    for text in scenes {
        let loader = MemoryLoader::new().with("main.sdf", text.as_str());
        let outcome = compile(&loader, "main.sdf", &Options::default());
        let compiled = outcome.compiled.unwrap_or_else(|| panic!("{text}: {:?}", outcome.diagnostics));
        let features = Features::of(&compiled, ViewMode::Depth);
        assert!(features.cones, "{text}");
        // Neither side is a multiple of a tile's.
        let shot = Shot { mode: ViewMode::Depth, ..Shot::new(531, 301) };
        let drawn = |features| {
            let mut picture = Picture::prepare_with(&gpu, &compiled, FORMAT, features).unwrap();
            headless::render_with(&gpu, &mut picture, &compiled, &compiled.live(), &shot).unwrap()
        };
        let (with, without) = (drawn(features), drawn(Features { cones: false, ..features }));
        let mut seen = 0;
        for y in 0..shot.height {
            for x in 0..shot.width {
                let (a, b) = (with.get(x, y), without.get(x, y));
                seen += u32::from(b[0] > 0);
                assert!(a[0].abs_diff(b[0]) <= 1, "{text}: {a:?} and {b:?} at {x}, {y}");
            }
        }
        assert!(seen > 200, "{text}: {seen}");
    }
}
