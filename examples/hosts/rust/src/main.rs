//! A program with a wgpu device, a texture and a render pass of its own. It lets Surefoot draw into that pass and writes a PNG file; the
//! balls of the scene fall on that device for so many seconds before:
//!
//!     cargo run -- ../../still_life.sdf picture.png
//!     cargo run -- ../../balls_bowl.sdf picture.png 2

use std::sync::Arc;
use surefoot_compiler::sampled::{Grid, Settings};
use surefoot_compiler::{Loader, Options, compile, diagnostic};
use surefoot_runtime::gpu::depth_attachment;
use surefoot_runtime::physics::STEP;
use surefoot_runtime::{Gpu, Physics, Picture, View, ViewMode};

const WIDTH: u32 = 960;
const HEIGHT: u32 = 540;

/// The scene's files lie on the disk. A program can as well keep them elsewhere.
struct Disk;

impl Loader for Disk {
    fn read(&self, path: &str) -> Result<Vec<u8>, String> {
        std::fs::read(path).map_err(|error| error.to_string())
    }

    /// What `mesh_field` names.
    fn grid(&self, path: &str, settings: Settings) -> Result<Arc<Grid>, String> {
        surefoot_runtime::mesh::field::grid(self, path, settings, &|_| {})
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(scene), Some(out)) = (arguments.next(), arguments.next()) else {
        return Err("usage: surefoot-host SCENE.sdf PICTURE.png [SECONDS]".into());
    };
    let seconds: f64 = arguments.next().map_or(Ok(0.0), |text| text.parse())?;
    let outcome = compile(&Disk, &scene, &Options::default());
    eprint!("{}", diagnostic::render(&outcome.sources, &outcome.diagnostics, false));
    let compiled = outcome.compiled.ok_or("the scene has errors")?;

    // What any program with wgpu does.
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let adapter = pollster::block_on(instance.request_adapter(&Default::default()))?;
    let (device, queue) = pollster::block_on(adapter.request_device(&Default::default()))?;
    let size = wgpu::Extent3d { width: WIDTH, height: HEIGHT, depth_or_array_layers: 1 };
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    // 960 pixels are 15 times 256 bytes; other widths need rows with a gap.
    let pixels = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(4 * WIDTH * HEIGHT),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });

    // What Surefoot adds: a picture on that device, and a call within the pass.
    let gpu = Gpu::from_parts(device.clone(), queue.clone());
    let mut picture = Picture::prepare(&gpu, &compiled, texture.format(), ViewMode::Shaded)?;
    let mut live = compiled.live();
    // Its balls, one step after another; `physics.buffer()` is where they are, for a program that draws them itself.
    if let Some(mut physics) = Physics::prepare(&gpu, &compiled, &live)? {
        while live.time + STEP <= seconds + 1e-6 {
            let before = live.clone();
            live.time += STEP;
            physics.step(&compiled, &before, &live)?;
        }
        picture.show_balls(&compiled, &live, Some(&physics));
        println!("{} balls, {} steps", physics.count(), physics.steps());
    }
    let (_, camera) = compiled.frame(&live).cameras[0];
    let view = View { camera, size: [WIDTH as f32, HEIGHT as f32], corner: [0.0, 0.0], sample: 0 };
    picture.update(&queue, &compiled, &live, &view);
    let depth = picture.depth(size);
    let target = texture.create_view(&Default::default());
    let mut encoder = device.create_command_encoder(&Default::default());
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &target,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations::default(),
        })],
        depth_stencil_attachment: depth.as_ref().map(depth_attachment),
        ..Default::default()
    });
    picture.draw(&mut pass);
    drop(pass);

    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * WIDTH), rows_per_image: None };
    let copy = wgpu::TexelCopyBufferInfo { buffer: &pixels, layout };
    encoder.copy_texture_to_buffer(texture.as_image_copy(), copy, size);
    queue.submit([encoder.finish()]);
    pixels.map_async(wgpu::MapMode::Read, .., |result| result.expect("the device gives the pixels"));
    device.poll(wgpu::PollType::wait_indefinitely())?;
    let bytes = pixels.get_mapped_range(..)?.to_vec();
    image::save_buffer(out, &bytes, WIDTH, HEIGHT, image::ColorType::Rgba8)?;
    Ok(())
}
