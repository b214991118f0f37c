//! The shadows that balls throw: on the field and on each other, from the first light that is infinitely far and throws any.

use crate::gpu::{DEPTH, Gpu, PipelineKey, UniformBlock, uniform_layout};
use crate::physics::Physics;
use bytemuck::{Pod, Zeroable};
use surefoot_compiler::compiled::Frame;
use surefoot_compiler::reference::shade;
use surefoot_compiler::reference::vector::{Vec3, cross, scale, unit};

/// Side of the map in pixels.
const SIDE: u32 = 2048;

/// The map, and what draws it.
#[derive(Debug)]
pub struct Shadow {
    bounds: wgpu::ComputePipeline,
    map: wgpu::RenderPipeline,
    light: UniformBlock,
    box_of_all: wgpu::Buffer,
    view: wgpu::TextureView,
    balls_layout: wgpu::BindGroupLayout,
    /// The light and the box, to be written.
    measure: wgpu::BindGroup,
    /// The same, to be read while the map is drawn.
    draw: wgpu::BindGroup,
    /// The same with the map.
    read: wgpu::BindGroup,
    /// Version of the balls that it was drawn of.
    drawn: Option<u64>,
}

/// The light, as `cast.wgsl` declares it.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
struct BallLight {
    across: [f32; 3],
    balls: u32,
    above: [f32; 3],
    padding_a: f32,
    along: [f32; 3],
    padding_b: f32,
}

/// What the passes that look shadows up are bound to: group 3.
pub(super) fn read_layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
    let texture = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Depth,
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    layout(gpu, wgpu::ShaderStages::FRAGMENT, &[UNIFORM, storage(true), texture])
}

const UNIFORM: wgpu::BindingType =
    wgpu::BindingType::Buffer { ty: wgpu::BufferBindingType::Uniform, has_dynamic_offset: false, min_binding_size: None };

fn storage(read_only: bool) -> wgpu::BindingType {
    wgpu::BindingType::Buffer { ty: wgpu::BufferBindingType::Storage { read_only }, has_dynamic_offset: false, min_binding_size: None }
}

fn layout(gpu: &Gpu, visibility: wgpu::ShaderStages, types: &[wgpu::BindingType]) -> wgpu::BindGroupLayout {
    let entries: Vec<_> = (0u32..)
        .zip(types)
        .map(|(binding, &ty)| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None })
        .collect();
    gpu.device().create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("surefoot shadows of balls"), entries: &entries })
}

impl Shadow {
    pub fn new(gpu: &Gpu) -> Result<Self, String> {
        use wgpu::ShaderStages as On;
        let label = "surefoot shadows of balls";
        let text = |last| [include_str!("cast.wgsl"), include_str!("../../physics/ball.wgsl"), last].join("\n");
        let on = On::COMPUTE | On::VERTEX_FRAGMENT;
        let balls_layout = layout(gpu, on, &[storage(true)]);
        let measure_layout = layout(gpu, On::COMPUTE, &[UNIFORM, storage(false)]);
        let draw_layout = layout(gpu, On::VERTEX_FRAGMENT, &[UNIFORM, storage(true)]);
        let read_layout = read_layout(gpu);
        let groups = |own| [None, None, Some(&balls_layout), Some(own)];
        let bounds = gpu.compute_pipeline(label, &text(include_str!("bounds.wgsl")), "bounds", &groups(&measure_layout))?;
        let key = PipelineKey {
            wgsl: text(include_str!("map.wgsl")),
            constants: Vec::new(),
            format: None,
            entries: ["map_vertex", "map_fragment"],
            depth: Some(wgpu::CompareFunction::Less),
            triangles: false,
        };
        let map = gpu.screen_pipeline(label, key, &groups(&draw_layout))?;
        let block_layout = uniform_layout(gpu, label, size_of::<BallLight>() as u64, On::VERTEX_FRAGMENT);
        let light = UniformBlock::new(gpu, label, &block_layout, size_of::<BallLight>() as u64);
        let box_of_all = gpu.device().create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: 24,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let view = gpu
            .device()
            .create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width: SIDE, height: SIDE, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: DEPTH,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            })
            .create_view(&Default::default());
        let Some(uniform) = light.buffer() else { return Err("the light of balls has no block".to_owned()) };
        let parts = [uniform.as_entire_binding(), box_of_all.as_entire_binding(), wgpu::BindingResource::TextureView(&view)];
        let group = |layout: &wgpu::BindGroupLayout, count: usize| {
            let entries: Vec<_> = (0u32..)
                .zip(parts.iter().take(count))
                .map(|(binding, part)| wgpu::BindGroupEntry { binding, resource: part.clone() })
                .collect();
            gpu.device().create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
        };
        let (measure, draw, read) = (group(&measure_layout, 2), group(&draw_layout, 2), group(&read_layout, 3));
        Ok(Self { bounds, map, light, box_of_all, view, balls_layout, measure, draw, read, drawn: None })
    }

    /// What looks the shadows up: group 3.
    pub fn group(&self) -> &wgpu::BindGroup {
        &self.read
    }

    /// Draws the map where balls or light are not what they were. Answers whether it did.
    pub fn update(&mut self, gpu: &Gpu, frame: &Frame, physics: Option<&Physics>) -> bool {
        let lamps = shade::lamps(frame);
        let lamp = lamps.iter().find(|lamp| !lamp.position && lamp.softness >= 0.0);
        let (along, count) = match (lamp, physics) {
            (Some(lamp), Some(physics)) => (scale(lamp.vector, -1.0), physics.count()),
            _ => ([0.0, -1.0, 0.0], 0),
        };
        let changed = self.light.write(gpu.queue(), bytemuck::bytes_of(&light(along, count)));
        let version = physics.map(Physics::version);
        let Some(physics) = physics.filter(|_| count > 0 && (changed || self.drawn != version)) else { return changed };
        self.drawn = version;
        // The box of nothing: what is least is greater than all, what is greatest less.
        gpu.queue().write_buffer(&self.box_of_all, 0, bytemuck::cast_slice(&[u32::MAX, u32::MAX, u32::MAX, 0, 0, 0]));
        let balls = gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &self.balls_layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: physics.buffer().as_entire_binding() }],
        });
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&self.bounds);
        pass.set_bind_group(2, &balls, &[]);
        pass.set_bind_group(3, &self.measure, &[]);
        pass.dispatch_workgroups(count.div_ceil(64), 1, 1);
        drop(pass);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("surefoot shadows of balls"),
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.view,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&self.map);
        pass.set_bind_group(2, &balls, &[]);
        pass.set_bind_group(3, &self.draw, &[]);
        pass.draw(0..6, 0..count);
        drop(pass);
        gpu.queue().submit([encoder.finish()]);
        true
    }
}

/// The axes of a light that travels along a direction of length one.
fn light(along: Vec3, balls: u32) -> BallLight {
    let upright = if along[1].abs() > 0.9 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let across = unit(cross(along, upright)).unwrap_or([1.0, 0.0, 0.0]);
    let narrow = |v: Vec3| v.map(|c| c as f32);
    BallLight { across: narrow(across), balls, above: narrow(cross(across, along)), padding_a: 0.0, along: narrow(along), padding_b: 0.0 }
}
