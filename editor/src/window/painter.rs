//! Draws the window where the adapter is a program. egui's own shader can also filter textures by hand, with some hundred divisions of whole numbers for a
//! pixel. A graphics card passes over that branch. A program computes both sides of each branch, and took 100 ms for a window. So what egui made of a frame
//! is drawn by a shader without it: the same triangles, textures and blending.

use super::meter::lock;
use eframe::egui_wgpu::{Callback, CallbackResources, CallbackTrait, RenderState, ScreenDescriptor};
use egui::epaint::{ClippedPrimitive, ClippedShape, Primitive};
use egui::{Context, FullOutput, PaintCallbackInfo, Rect, Shape};
use std::sync::{Arc, Mutex};

const SHADER: &str = "
struct Seen { @builtin(position) position: vec4f, @location(0) uv: vec2f, @location(1) color: vec4f }
@group(0) @binding(0) var<uniform> size: vec2f;
@group(1) @binding(0) var image: texture_2d<f32>;
@group(1) @binding(1) var filtered: sampler;
@vertex fn corner(@location(0) at: vec2f, @location(1) uv: vec2f, @location(2) color: vec4f) -> Seen {
  return Seen(vec4f(2.0 * at.x / size.x - 1.0, 1.0 - 2.0 * at.y / size.y, 0.0, 1.0), uv, color);
}
@fragment fn pixel(seen: Seen) -> @location(0) vec4f {
  return seen.color * textureSample(image, filtered, seen.uv);
}
";

/// Bytes of a corner: a place, a place of the texture, a colour.
const CORNER: usize = 20;

/// What takes a frame's shapes before eframe draws them.
pub struct Painter {
    render: RenderState,
    tools: Arc<Mutex<Tools>>,
}

/// What is drawn with.
struct Tools {
    pipeline: wgpu::RenderPipeline,
    size: wgpu::Buffer,
    of_window: wgpu::BindGroup,
    corners: wgpu::Buffer,
    indices: wgpu::Buffer,
}

impl Painter {
    /// Takes over the drawing of a window. None where colours are not written as they are: then egui's own does it.
    pub fn of(render: &RenderState) -> Option<Self> {
        let device = &render.device;
        if render.target_format.is_srgb() {
            return None;
        }
        let entry = |binding, visibility, ty| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None };
        let uniform = |bytes| wgpu::BindingType::Buffer { ty: wgpu::BufferBindingType::Uniform, has_dynamic_offset: false, min_binding_size: std::num::NonZeroU64::new(bytes) };
        let layout = |entries: &[_]| device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("surefoot window"), entries });
        let window = layout(&[entry(0, wgpu::ShaderStages::VERTEX, uniform(8))]);
        // The same as egui's, whose groups of textures are used.
        let sampled = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: true },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let fragment = wgpu::ShaderStages::FRAGMENT;
        let texture = layout(&[
            entry(0, fragment, sampled),
            entry(1, fragment, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)),
            entry(2, fragment, uniform(16)),
        ]);
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("surefoot window"),
            bind_group_layouts: &[Some(&window), Some(&texture)],
            immediate_size: 0,
        });
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some("surefoot window"), source: wgpu::ShaderSource::Wgsl(SHADER.into()) });
        let over = |src_factor, dst_factor| wgpu::BlendComponent { src_factor, dst_factor, operation: wgpu::BlendOperation::Add };
        let blend = wgpu::BlendState {
            color: over(wgpu::BlendFactor::One, wgpu::BlendFactor::OneMinusSrcAlpha),
            alpha: over(wgpu::BlendFactor::OneMinusDstAlpha, wgpu::BlendFactor::One),
        };
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("surefoot window"),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("corner"),
                compilation_options: Default::default(),
                buffers: &[Some(wgpu::VertexBufferLayout {
                    array_stride: CORNER as u64,
                    step_mode: wgpu::VertexStepMode::Vertex,
                    attributes: &wgpu::vertex_attr_array![0 => Float32x2, 1 => Float32x2, 2 => Unorm8x4],
                })],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("pixel"),
                compilation_options: Default::default(),
                targets: &[Some(wgpu::ColorTargetState { format: render.target_format, blend: Some(blend), write_mask: wgpu::ColorWrites::ALL })],
            }),
            multiview_mask: None,
            cache: None,
        });
        let size = buffer(device, 8, wgpu::BufferUsages::UNIFORM);
        let of_window = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("surefoot window"),
            layout: &window,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: size.as_entire_binding() }],
        });
        let corners = buffer(device, 1 << 16, wgpu::BufferUsages::VERTEX);
        let indices = buffer(device, 1 << 16, wgpu::BufferUsages::INDEX);
        let tools = Arc::new(Mutex::new(Tools { pipeline, size, of_window, corners, indices }));
        Some(Self { render: render.clone(), tools })
    }
}

fn buffer(device: &wgpu::Device, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    let usage = usage | wgpu::BufferUsages::COPY_DST;
    device.create_buffer(&wgpu::BufferDescriptor { label: Some("surefoot window"), size, usage, mapped_at_creation: false })
}

impl egui::Plugin for Painter {
    fn debug_name(&self) -> &'static str {
        "surefoot painter"
    }

    fn output_hook(&mut self, ctx: &Context, output: &mut FullOutput) {
        let scale = output.pixels_per_point;
        let primitives = ctx.tessellate(std::mem::take(&mut output.shapes), scale);
        let mut frame = Drawn { tools: self.tools.clone(), corners: Vec::new(), indices: Vec::new(), meshes: Vec::new() };
        let mut renderer = self.render.renderer.write();
        // Where the frame's textures are new, they are needed now.
        for (id, changes) in output.textures_delta.set.drain() {
            for change in changes {
                renderer.update_texture(&self.render.device, &self.render.queue, id, &change);
            }
        }
        for ClippedPrimitive { clip_rect, primitive } in primitives {
            let Primitive::Mesh(mesh) = primitive else { continue };
            let Some(texture) = renderer.texture(&mesh.texture_id) else { continue };
            let first = frame.indices.len() as u32 / 4;
            let base = (frame.corners.len() / CORNER) as i32;
            frame.corners.reserve(CORNER * mesh.vertices.len());
            for corner in &mesh.vertices {
                let numbers = [corner.pos.x, corner.pos.y, corner.uv.x, corner.uv.y].map(f32::to_ne_bytes);
                frame.corners.extend_from_slice(numbers.as_flattened());
                frame.corners.extend_from_slice(&corner.color.to_array());
            }
            frame.indices.extend(mesh.indices.iter().flat_map(|index| index.to_ne_bytes()));
            let count = mesh.indices.len() as u32;
            frame.meshes.push(Mesh { clip: clip_rect, indices: first..first + count, base, texture: texture.bind_group.clone() });
        }
        drop(renderer);
        let window = ctx.viewport_rect();
        let callback = Callback::new_paint_callback(window, frame);
        output.shapes = vec![ClippedShape { clip_rect: window, shape: Shape::Callback(callback), transform_after_tessellation: Default::default() }];
    }
}

/// A mesh: its indices, its first corner, and what it is seen through.
struct Mesh {
    clip: Rect,
    indices: std::ops::Range<u32>,
    base: i32,
    texture: wgpu::BindGroup,
}

/// A frame to be drawn.
struct Drawn {
    tools: Arc<Mutex<Tools>>,
    corners: Vec<u8>,
    indices: Vec<u8>,
    meshes: Vec<Mesh>,
}

impl CallbackTrait for Drawn {
    fn prepare(&self, device: &wgpu::Device, queue: &wgpu::Queue, screen: &ScreenDescriptor, _: &mut wgpu::CommandEncoder, _: &mut CallbackResources) -> Vec<wgpu::CommandBuffer> {
        let mut tools = lock(&self.tools);
        let size = screen.size_in_pixels.map(|side| (side as f32 / screen.pixels_per_point).to_ne_bytes());
        queue.write_buffer(&tools.size, 0, size.as_flattened());
        let fit = |held: &mut wgpu::Buffer, bytes: &[u8], usage| {
            if held.size() < bytes.len() as u64 {
                *held = buffer(device, (bytes.len() as u64).next_power_of_two(), usage);
            }
            queue.write_buffer(held, 0, bytes);
        };
        fit(&mut tools.corners, &self.corners, wgpu::BufferUsages::VERTEX);
        fit(&mut tools.indices, &self.indices, wgpu::BufferUsages::INDEX);
        Vec::new()
    }

    fn paint(&self, info: PaintCallbackInfo, pass: &mut wgpu::RenderPass<'static>, _: &CallbackResources) {
        let tools = lock(&self.tools);
        let [width, height] = info.screen_size_px;
        pass.set_viewport(0.0, 0.0, width as f32, height as f32, 0.0, 1.0);
        pass.set_pipeline(&tools.pipeline);
        pass.set_bind_group(0, &tools.of_window, &[]);
        pass.set_vertex_buffer(0, tools.corners.slice(..));
        pass.set_index_buffer(tools.indices.slice(..), wgpu::IndexFormat::Uint32);
        for mesh in &self.meshes {
            let pixel = |at: f32, most: u32| ((at * info.pixels_per_point).round().max(0.0) as u32).min(most);
            let (left, right) = (pixel(mesh.clip.min.x, width), pixel(mesh.clip.max.x, width));
            let (top, bottom) = (pixel(mesh.clip.min.y, height), pixel(mesh.clip.max.y, height));
            if left >= right || top >= bottom {
                continue;
            }
            pass.set_scissor_rect(left, top, right - left, bottom - top);
            pass.set_bind_group(1, &mesh.texture, &[]);
            pass.draw_indexed(mesh.indices.clone(), mesh.base, 0..1);
        }
    }
}
