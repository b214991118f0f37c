//! Group 1 of every pass that shades: the scene's uniforms, the images that stand for its sky, and those that lie on its surface.

use super::layers::FIRST_TEXTURE;
use crate::images::MOST_TEXTURES;
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

/// The binding of the scene's own cubemap, as `capture/read.wgsl` declares it; that of its sampler is the next.
const CAPTURE: u32 = FIRST_TEXTURE + MOST_TEXTURES as u32;

/// The images of a scene on the device.
#[derive(Debug)]
pub(crate) struct SceneImages {
    /// The light of the sky, and what matte surfaces see of it.
    sky: Option<(wgpu::TextureView, wgpu::Buffer)>,
    textures: Vec<wgpu::TextureView>,
    once: wgpu::Sampler,
    repeated: wgpu::Sampler,
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

/// The layout of the uniforms alone.
pub(super) fn plain_layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
    uniform_layout(gpu, "surefoot scene", size_of::<SceneUniforms>() as u64, wgpu::ShaderStages::VERTEX_FRAGMENT)
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
    if features.capture.is_some() {
        entries.push(entry(CAPTURE, texture(wgpu::TextureViewDimension::Cube)));
        entries.push(entry(CAPTURE + 1, sampler));
    }
    gpu.device().create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("surefoot scene"), entries: &entries })
}

impl SceneImages {
    /// On the device; a sky or textures that could not be read change nothing.
    pub fn new(gpu: &Gpu, features: Features, images: &Images) -> Self {
        let sky = features.environment.then(|| match &images.environment {
            Some(cube) => sky(gpu, cube),
            None => sky(gpu, &shade::plain_sky()),
        });
        let textures = images.textures.iter().take(features.textures as usize).map(|t| upload_texture(gpu, t)).collect();
        Self { sky, textures, once: sampler(gpu, wgpu::AddressMode::ClampToEdge), repeated: sampler(gpu, wgpu::AddressMode::Repeat) }
    }

    /// Those of a scene whose images are not read yet.
    pub fn missing(gpu: &Gpu, features: Features, compiled: &Compiled) -> Self {
        let textures = compiled.functions.textures();
        let textures = textures.iter().map(|(_, kind)| Arc::new(Texture::missing(*kind))).collect();
        Self::new(gpu, features, &Images { environment: None, textures })
    }
}

fn sampler(gpu: &Gpu, address: wgpu::AddressMode) -> wgpu::Sampler {
    gpu.device().create_sampler(&wgpu::SamplerDescriptor {
        label: Some("surefoot images"),
        address_mode_u: address,
        address_mode_v: address,
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        ..Default::default()
    })
}

impl SceneGroup {
    /// A group of this layout, which nothing is bound to yet.
    pub fn new(gpu: &Gpu, features: Features, layout: wgpu::BindGroupLayout) -> Self {
        let size = size_of::<SceneUniforms>() as u64;
        Self { block: UniformBlock::new(gpu, "surefoot scene", &plain_layout(gpu), size), layout, features, group: None }
    }

    /// Binds images, as far as the passes have them, and the cubemap of the scene itself.
    pub fn bind(&mut self, gpu: &Gpu, images: &SceneImages, capture: Option<&wgpu::TextureView>) {
        let Features { environment, textures: count, .. } = self.features;
        let Some(scene) = self.block.buffer().filter(|_| environment || count > 0 || capture.is_some()) else { return };
        let mut entries = vec![wgpu::BindGroupEntry { binding: 0, resource: scene.as_entire_binding() }];
        let mut push = |binding, resource| entries.push(wgpu::BindGroupEntry { binding, resource });
        if let Some((view, harmonics)) = &images.sky {
            push(1, wgpu::BindingResource::TextureView(view));
            push(2, wgpu::BindingResource::Sampler(&images.once));
            push(3, harmonics.as_entire_binding());
        }
        if count > 0 {
            push(FIRST_TEXTURE - 1, wgpu::BindingResource::Sampler(&images.repeated));
        }
        for (binding, view) in (FIRST_TEXTURE..).zip(&images.textures) {
            push(binding, wgpu::BindingResource::TextureView(view));
        }
        if let Some(capture) = capture {
            push(CAPTURE, wgpu::BindingResource::TextureView(capture));
            push(CAPTURE + 1, wgpu::BindingResource::Sampler(&images.once));
        }
        self.group = Some(gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("surefoot scene"),
            layout: &self.layout,
            entries: &entries,
        }));
    }

    /// Writes the uniforms unless they are there already; answers whether they were new.
    pub fn write(&mut self, queue: &wgpu::Queue, uniforms: &SceneUniforms) -> bool {
        self.block.write(queue, bytemuck::bytes_of(uniforms))
    }

    /// The uniforms alone, for what shows no light: [`plain_layout`].
    pub fn plain(&self) -> &wgpu::BindGroup {
        self.block.group()
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
