//! Group 1 of every pass that shades: the scene's uniforms, and the images that stand for its sky.

use super::scene::{Features, SceneUniforms};
use crate::gpu::{Gpu, UniformBlock, uniform_layout};
use bytemuck::{Pod, Zeroable};
use half::f16;
use surefoot_compiler::images::Cube;
use surefoot_compiler::reference::shade;

/// What matte surfaces see of the sky, as `scene/sky_images.wgsl` declares it.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
struct Harmonics {
    matte: [[f32; 4]; 9],
    last: f32,
    padding: [f32; 3],
}

/// The group's uniforms and images.
#[derive(Debug)]
pub(super) struct SceneGroup {
    block: UniformBlock,
    layout: wgpu::BindGroupLayout,
    /// With its images, where the pass has some.
    group: Option<wgpu::BindGroup>,
}

/// The group's layout for a pass with these features.
pub(super) fn layout(gpu: &Gpu, features: Features) -> wgpu::BindGroupLayout {
    let stage = wgpu::ShaderStages::VERTEX_FRAGMENT;
    let size = size_of::<SceneUniforms>() as u64;
    if !features.environment {
        return uniform_layout(gpu, "surefoot scene", size, stage);
    }
    let entry = |binding, ty| wgpu::BindGroupLayoutEntry { binding, visibility: stage, ty, count: None };
    let uniform = |size| wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: wgpu::BufferSize::new(size),
    };
    let cube = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable: true },
        view_dimension: wgpu::TextureViewDimension::Cube,
        multisampled: false,
    };
    gpu.device().create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("surefoot scene"),
        entries: &[
            entry(0, uniform(size)),
            entry(1, cube),
            entry(2, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)),
            entry(3, uniform(size_of::<Harmonics>() as u64)),
        ],
    })
}

impl SceneGroup {
    /// A group of this layout, its sky that of a scene that says nothing of it until images are shown.
    pub fn new(gpu: &Gpu, features: Features, layout: wgpu::BindGroupLayout) -> Self {
        let size = size_of::<SceneUniforms>() as u64;
        let plain = uniform_layout(gpu, "surefoot scene", size, wgpu::ShaderStages::VERTEX_FRAGMENT);
        let mut new = Self { block: UniformBlock::new(gpu, "surefoot scene", &plain, size), layout, group: None };
        if features.environment {
            new.show(gpu, &shade::plain_sky());
        }
        new
    }

    /// Shows another sky. Only where the features have an environment.
    pub fn show(&mut self, gpu: &Gpu, cube: &Cube) {
        let device = gpu.device();
        let texture = upload(gpu, cube);
        let view = texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::Cube),
            ..Default::default()
        });
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("surefoot sky"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        });
        let matte = cube.harmonics().map(|c| [c[0] as f32, c[1] as f32, c[2] as f32, 0.0]);
        let last = cube.levels().len().saturating_sub(1) as f32;
        let harmonics = Harmonics { matte, last, padding: [0.0; 3] };
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("surefoot sky"),
            size: size_of::<Harmonics>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        gpu.queue().write_buffer(&buffer, 0, bytemuck::bytes_of(&harmonics));
        let Some(scene) = self.block.buffer() else { return };
        self.group = Some(device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("surefoot scene"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: scene.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(&view) },
                wgpu::BindGroupEntry { binding: 2, resource: wgpu::BindingResource::Sampler(&sampler) },
                wgpu::BindGroupEntry { binding: 3, resource: buffer.as_entire_binding() },
            ],
        }));
    }

    /// Writes the uniforms unless they are there already; answers whether they were new.
    pub fn write(&mut self, queue: &wgpu::Queue, uniforms: &SceneUniforms) -> bool {
        self.block.write(queue, bytemuck::bytes_of(uniforms))
    }

    /// What a pass is bound to.
    pub fn group(&self) -> &wgpu::BindGroup {
        self.group.as_ref().unwrap_or(self.block.group())
    }
}

/// The levels of a cube as a texture of 16-bit floats.
fn upload(gpu: &Gpu, cube: &Cube) -> wgpu::Texture {
    let side = cube.side().max(1) as u32;
    let extent = |side| wgpu::Extent3d { width: side, height: side, depth_or_array_layers: 6 };
    let texture = gpu.device().create_texture(&wgpu::TextureDescriptor {
        label: Some("surefoot sky"),
        size: extent(side),
        mip_level_count: cube.levels().len().max(1) as u32,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba16Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (level, texels) in cube.levels().iter().enumerate() {
        let side = (side >> level).max(1);
        // What is brighter than 16 bits hold is as bright as they hold.
        let narrow = |c: f32| f16::from_f32(c.clamp(0.0, 65504.0)).to_bits();
        let bytes: Vec<u16> = texels.iter().flat_map(|&[r, g, b]| [narrow(r), narrow(g), narrow(b), 0]).collect();
        gpu.queue().write_texture(
            wgpu::TexelCopyTextureInfo {
                texture: &texture,
                mip_level: level as u32,
                origin: wgpu::Origin3d::ZERO,
                aspect: wgpu::TextureAspect::All,
            },
            bytemuck::cast_slice(&bytes),
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(8 * side), rows_per_image: Some(side) },
            extent(side),
        );
    }
    texture
}
