//! Group 1 of every pass that shades: the scene's uniforms, the images that stand for its sky, and those that lie on its surface.

use super::layers::FIRST_TEXTURE;
use super::scene::{Features, SceneUniforms};
use crate::gpu::{Gpu, UniformBlock, uniform_layout};
use bytemuck::{Pod, Zeroable};
use half::f16;
use std::sync::Arc;
use surefoot_compiler::compiled::Compiled;
use surefoot_compiler::images::{Cube, Images, Texture};
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
    features: Features,
    /// With its images, where the pass has some.
    group: Option<wgpu::BindGroup>,
}

/// The group's layout for a pass with these features.
pub(super) fn layout(gpu: &Gpu, features: Features) -> wgpu::BindGroupLayout {
    let stage = wgpu::ShaderStages::VERTEX_FRAGMENT;
    let size = size_of::<SceneUniforms>() as u64;
    let entry = |binding, ty| wgpu::BindGroupLayoutEntry { binding, visibility: stage, ty, count: None };
    let uniform = |size| wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: wgpu::BufferSize::new(size),
    };
    let texture = |view_dimension| wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable: true },
        view_dimension,
        multisampled: false,
    };
    let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
    let mut entries = vec![entry(0, uniform(size))];
    if features.environment {
        entries.push(entry(1, texture(wgpu::TextureViewDimension::Cube)));
        entries.push(entry(2, sampler));
        entries.push(entry(3, uniform(size_of::<Harmonics>() as u64)));
    }
    if features.textures > 0 {
        entries.push(entry(FIRST_TEXTURE - 1, sampler));
        let textures = (0..features.textures).map(|i| entry(FIRST_TEXTURE + i, texture(wgpu::TextureViewDimension::D2)));
        entries.extend(textures);
    }
    gpu.device().create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("surefoot scene"), entries: &entries })
}

impl SceneGroup {
    /// A group of this layout. Until images are shown its sky is that of a scene that says nothing of it, and what lies on the surface
    /// changes nothing.
    pub fn new(gpu: &Gpu, features: Features, compiled: &Compiled, layout: wgpu::BindGroupLayout) -> Self {
        let size = size_of::<SceneUniforms>() as u64;
        let plain = uniform_layout(gpu, "surefoot scene", size, wgpu::ShaderStages::VERTEX_FRAGMENT);
        let mut new = Self { block: UniformBlock::new(gpu, "surefoot scene", &plain, size), layout, features, group: None };
        let textures = compiled.functions.surface.textures();
        new.show(gpu, &Images {
            environment: None,
            textures: textures.iter().map(|(_, kind)| Arc::new(Texture::missing(*kind))).collect(),
        });
        new
    }

    /// Shows images, as far as the passes have them. Answers whether they have any.
    pub fn show(&mut self, gpu: &Gpu, images: &Images) -> bool {
        let Features { environment, textures: count, .. } = self.features;
        let count = count as usize;
        let Some(scene) = self.block.buffer().filter(|_| (environment || count > 0) && images.textures.len() >= count) else {
            return false;
        };
        let device = gpu.device();
        let cube = environment.then(|| match &images.environment {
            Some(cube) => sky(gpu, cube),
            None => sky(gpu, &shade::plain_sky()),
        });
        let textures: Vec<wgpu::TextureView> = images.textures.iter().take(count).map(|t| upload_texture(gpu, t)).collect();
        let sampler = |address| device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("surefoot images"),
            address_mode_u: address,
            address_mode_v: address,
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        });
        let (once, repeated) = (sampler(wgpu::AddressMode::ClampToEdge), sampler(wgpu::AddressMode::Repeat));
        let mut entries = vec![wgpu::BindGroupEntry { binding: 0, resource: scene.as_entire_binding() }];
        if let Some((view, harmonics)) = &cube {
            entries.push(wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(view) });
            entries.push(wgpu::BindGroupEntry { binding: 2, resource: wgpu::BindingResource::Sampler(&once) });
            entries.push(wgpu::BindGroupEntry { binding: 3, resource: harmonics.as_entire_binding() });
        }
        if count > 0 {
            entries.push(wgpu::BindGroupEntry { binding: FIRST_TEXTURE - 1, resource: wgpu::BindingResource::Sampler(&repeated) });
        }
        for (binding, view) in (FIRST_TEXTURE..).zip(&textures) {
            entries.push(wgpu::BindGroupEntry { binding, resource: wgpu::BindingResource::TextureView(view) });
        }
        self.group = Some(device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("surefoot scene"),
            layout: &self.layout,
            entries: &entries,
        }));
        true
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

/// A sky's light, and what matte surfaces see of it.
fn sky(gpu: &Gpu, cube: &Cube) -> (wgpu::TextureView, wgpu::Buffer) {
    let side = cube.side().max(1) as u32;
    let levels: Vec<&[[f32; 3]]> = cube.levels().iter().map(Vec::as_slice).collect();
    let texture = upload(gpu, [side, side], 6, &levels);
    let view = texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::Cube),
        ..Default::default()
    });
    let matte = cube.harmonics().map(|c| [c[0] as f32, c[1] as f32, c[2] as f32, 0.0]);
    let last = cube.levels().len().saturating_sub(1) as f32;
    let buffer = gpu.device().create_buffer(&wgpu::BufferDescriptor {
        label: Some("surefoot sky"),
        size: size_of::<Harmonics>() as u64,
        usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    gpu.queue().write_buffer(&buffer, 0, bytemuck::bytes_of(&Harmonics { matte, last, padding: [0.0; 3] }));
    (view, buffer)
}

fn upload_texture(gpu: &Gpu, texture: &Texture) -> wgpu::TextureView {
    let levels: Vec<&[[f32; 3]]> = texture.levels().iter().map(|l| l.texels.as_slice()).collect();
    let size = texture.levels().first().map_or([1, 1], |l| [l.width, l.height].map(|side| side as u32));
    upload(gpu, size, 1, &levels).create_view(&Default::default())
}

/// Levels as a texture of 16-bit floats.
fn upload(gpu: &Gpu, [width, height]: [u32; 2], layers: u32, levels: &[&[[f32; 3]]]) -> wgpu::Texture {
    let extent = |level: u32| wgpu::Extent3d {
        width: (width >> level).max(1),
        height: (height >> level).max(1),
        depth_or_array_layers: layers,
    };
    let texture = gpu.device().create_texture(&wgpu::TextureDescriptor {
        label: Some("surefoot image"),
        size: extent(0),
        mip_level_count: levels.len().max(1) as u32,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba16Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (level, texels) in (0..).zip(levels) {
        // What is brighter than 16 bits hold is as bright as they hold.
        let narrow = |c: f32| f16::from_f32(c.clamp(-65504.0, 65504.0)).to_bits();
        let bytes: Vec<u16> = texels.iter().flat_map(|&[r, g, b]| [narrow(r), narrow(g), narrow(b), 0]).collect();
        let size = extent(level);
        gpu.queue().write_texture(
            wgpu::TexelCopyTextureInfo {
                texture: &texture,
                mip_level: level,
                origin: wgpu::Origin3d::ZERO,
                aspect: wgpu::TextureAspect::All,
            },
            bytemuck::cast_slice(&bytes),
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(8 * size.width), rows_per_image: Some(size.height) },
            size,
        );
    }
    texture
}
