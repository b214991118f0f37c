//! Where there is no Vulkan, Metal or DirectX, OpenGL draws the same.

use crate::common;
use crate::common::alike::{draw_with_meshes, share_off};
use crate::common::{Disk, compile_file, examples, gpu, pictures};
use surefoot_runtime::film::LINEAR;
use surefoot_runtime::headless::{self, Shot};
use surefoot_runtime::mesh::Assets;
use surefoot_runtime::{Gpu, Picture, ViewMode};

/// A device through OpenGL.
fn opengl() -> Gpu {
    let descriptor = wgpu::InstanceDescriptor {
        backends: wgpu::Backends::GL,
        ..wgpu::InstanceDescriptor::new_without_display_handle_from_env()
    };
    let instance = wgpu::Instance::new(descriptor);
    pollster::block_on(async {
        let adapter = instance.request_adapter(&Default::default()).await.expect("the tests need OpenGL: apt-get install libegl1 libgl1-mesa-dri");
        let (device, queue) = adapter.request_device(&Gpu::device_descriptor(&adapter)).await.unwrap();
        Gpu::from_parts(device, queue)
    })
}

#[test]
fn it_draws_what_vulkan_draws() {
    let (one, other) = (gpu(), opengl());
    let shot = Shot::new(240, 135);
    let mut wrong = Vec::new();
    for (name, path) in examples() {
        let compiled = compile_file(&path).unwrap();
        let mut assets = Assets::new();
        assets.load(&Disk, &compiled, &|_, _, _| {});
        if compiled.blocks.capture.is_some() {
            // What it can't draw it says, so that the program takes the processor.
            let refused = Picture::prepare(&other, &compiled, headless::FORMAT, ViewMode::Shaded).unwrap_err();
            assert!(refused.contains("`capture` needs Vulkan"), "{refused}");
            continue;
        }
        let [one, other] = [&one, &other].map(|gpu| draw_with_meshes(gpu, &compiled, &assets, &shot));
        let share = share_off(&one, &other);
        println!("{name:14} {:7.3} %", 100.0 * share);
        if share > 0.005 {
            let file = pictures().join(format!("{name}-opengl.png"));
            image::save_buffer(&file, &other.rgba, shot.width, shot.height, image::ColorType::Rgba8).unwrap();
            wrong.push(format!("{name}: {:.3} % of the pixels differ, see {}", 100.0 * share, file.display()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn many_samples_become_one_picture() {
    let (one, other) = (gpu(), opengl());
    // A mesh's edges are as smooth as the field's.
    let compiled = compile_file(common::root().join("examples/statue.sdf").to_str().unwrap()).unwrap();
    let mut assets = Assets::new();
    assets.load(&Disk, &compiled, &|_, _, _| {});
    let shot = Shot { samples: 16, ..Shot::new(160, 90) };
    let [one, other] = [&one, &other].map(|gpu| {
        let mut picture = Picture::prepare(gpu, &compiled, LINEAR, ViewMode::Shaded).unwrap();
        picture.show_images(assets.images());
        picture.show_meshes(&assets.meshes(&compiled)).unwrap();
        headless::render_with(gpu, &mut picture, &compiled, &compiled.live(), &shot).unwrap()
    });
    // The mean is kept in 16 bits there.
    let share = share_off(&one, &other);
    assert!(share < 0.005, "{:.3} % of the pixels differ", 100.0 * share);
}
