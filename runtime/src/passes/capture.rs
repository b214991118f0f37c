//! The scene itself as a cubemap: six pictures from one place, in linear light, blurred for each roughness. They are drawn again only where
//! something that they show has changed.

use super::balls::BallsPipeline;
use super::meshes::MeshesPipeline;
use super::scene::{Features, SceneUniforms};
use super::surroundings::{self, SceneGroup, SceneImages};
use crate::gpu::{DEPTH, Gpu, PipelineKey};
use crate::module;
use crate::readback::read;
use crate::sheets::LINEAR;
use half::f16;
use surefoot_compiler::camera::Basis;
use surefoot_compiler::compiled::{Compiled, Frame, Rounding};
use surefoot_compiler::mesh::Placed;
use surefoot_compiler::vector::Vec3;

const LABEL: &str = "surefoot capture";
/// Sides of the most blurred level, as in `capture/levels.wgsl`.
const SMALLEST: u32 = 8;

/// The cubemap of a scene, and what draws it.
#[derive(Debug)]
pub(crate) struct Capture {
    gpu: Gpu,
    field: wgpu::RenderPipeline,
    balls: Option<wgpu::RenderPipeline>,
    meshes: Option<wgpu::RenderPipeline>,
    halve: wgpu::RenderPipeline,
    blur: wgpu::RenderPipeline,
    levels_layout: wgpu::BindGroupLayout,
    /// One for each face.
    groups: Vec<SceneGroup>,
    depth: Option<wgpu::TextureView>,
    /// What is drawn, each level the means of the one before.
    means: wgpu::Texture,
    /// What is read: each level as blurred as a roughness wants it.
    cube: wgpu::Texture,
    view: wgpu::TextureView,
    drawn: Option<Drawn>,
    count: u64,
}

/// What the cubemap shows: where nothing of it changed, it is right.
#[derive(Debug, PartialEq)]
struct Drawn {
    uniforms: SceneUniforms,
    field: Vec<u8>,
    placed: Vec<Placed>,
    meshes: Option<u64>,
    balls: Option<(u64, u64)>,
}

/// A moment of the scene, as the cubemap wants it.
pub(crate) struct Moment<'a> {
    pub frame: &'a Frame,
    /// From where.
    pub place: Vec3,
    /// The scene's point at which the module's `p` is zero.
    pub origin: Vec3,
    /// What rounding of the module grows with.
    pub rounding: Rounding,
    /// Group 0: the module's uniforms.
    pub module: &'a wgpu::BindGroup,
    /// Their bytes, the origin zero: what the field depends on.
    pub field: Vec<u8>,
    /// Group 3, where there are shadow maps.
    pub shadows: Option<&'a wgpu::BindGroup>,
    pub meshes: Option<&'a MeshesPipeline>,
    pub placed: &'a [Placed],
    pub balls: Option<&'a BallsPipeline>,
}

impl Capture {
    /// Builds what draws it. `features` are those of what captures; `shadows` is group 3, where the scene has shadow maps.
    pub fn new(
        gpu: &Gpu,
        compiled: &Compiled,
        features: Features,
        side: u32,
        balls: Option<&BallsPipeline>,
        meshes: Option<&MeshesPipeline>,
        shadows: Option<&wgpu::BindGroupLayout>,
    ) -> Result<Self, String> {
        if gpu.is_gl() {
            return Err("the environment's `capture` needs Vulkan, Metal or DirectX, not OpenGL".to_owned());
        }
        let module = module::layout(gpu, &compiled.module, wgpu::ShaderStages::VERTEX_FRAGMENT);
        let scene = surroundings::layout(gpu, features);
        let layouts = [Some(&module), Some(&scene), None, shadows];
        let key = |wgsl: String, constants, entries, depth| PipelineKey {
            wgsl,
            constants,
            format: Some(LINEAR),
            entries,
            depth,
            corners: None,
        };
        let text = format!("{}\n{}", compiled.module.code(), features.wgsl(compiled));
        let field = key(text, features.constants(LINEAR), ["vertex", "fragment"], features.depth().then_some(wgpu::CompareFunction::Always));
        let field = gpu.screen_pipeline(LABEL, field, if shadows.is_some() { &layouts } else { &layouts[..2] })?;
        let balls = balls.map(|balls| balls.other(gpu, compiled, LINEAR, features, shadows)).transpose()?;
        let meshes = meshes.map(|meshes| meshes.other(gpu, compiled, LINEAR, features, shadows)).transpose()?;
        let levels_layout = levels_layout(gpu);
        let level = |entry| {
            let key = key(include_str!("capture/levels.wgsl").to_owned(), Vec::new(), ["level_vertex", entry], None);
            gpu.screen_pipeline(LABEL, key, &[Some(&levels_layout)])
        };
        let (halve, blur) = (level("half_fragment")?, level("blur_fragment")?);
        let groups = (0..6).map(|_| SceneGroup::new(gpu, features, surroundings::layout(gpu, features))).collect();
        let texture = |format, faces, levels, more| {
            gpu.device().create_texture(&wgpu::TextureDescriptor {
                label: Some(LABEL),
                size: wgpu::Extent3d { width: side, height: side, depth_or_array_layers: faces },
                mip_level_count: levels,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | more,
                view_formats: &[],
            })
        };
        let read = wgpu::TextureUsages::TEXTURE_BINDING;
        let means = texture(LINEAR, 6, side.ilog2() + 1, read | wgpu::TextureUsages::COPY_SRC);
        let cube = texture(LINEAR, 6, (side / SMALLEST).max(1).ilog2() + 1, read | wgpu::TextureUsages::COPY_DST);
        let depth = features.depth().then(|| texture(DEPTH, 1, 1, wgpu::TextureUsages::empty()).create_view(&Default::default()));
        let view = cube_view(&cube);
        let (gpu, drawn, count) = (gpu.clone(), None, 0);
        Ok(Self { gpu, field, balls, meshes, halve, blur, levels_layout, groups, depth, means, cube, view, drawn, count })
    }

    /// What surfaces read.
    pub fn view(&self) -> &wgpu::TextureView {
        &self.view
    }

    /// Pixels of a face's side.
    pub fn side(&self) -> u32 {
        self.cube.width()
    }

    /// Binds images.
    pub fn bind(&mut self, gpu: &Gpu, images: &SceneImages) {
        for group in &mut self.groups {
            group.bind(gpu, images, None);
        }
        self.forget();
    }

    /// Draws with the next update, though nothing moved.
    pub fn forget(&mut self) {
        self.drawn = None;
    }

    /// How often it was drawn.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Draws where what it shows is not what it was. Answers whether it did.
    pub fn update(&mut self, moment: &Moment) -> bool {
        let size = [self.side() as f32; 2];
        let seen = |face: usize, origin: Vec3| {
            SceneUniforms::seen(moment.frame, moment.place, &face_basis(face), origin, size).rounded(moment.rounding)
        };
        let drawn = Drawn {
            // The origin goes with the eye, and changes nothing.
            uniforms: seen(0, [0.0; 3]),
            field: moment.field.clone(),
            placed: moment.placed.to_vec(),
            meshes: moment.meshes.map(|meshes| meshes.triangles.version),
            balls: moment.balls.map(|balls| (balls.now().map_or(0, |now| now.version), balls.looks_version)),
        };
        if self.drawn.as_ref() == Some(&drawn) {
            return false;
        }
        self.drawn = Some(drawn);
        for (face, group) in self.groups.iter_mut().enumerate() {
            group.write(self.gpu.queue(), &seen(face, moment.origin));
            let mut encoder = self.gpu.device().create_command_encoder(&Default::default());
            let target = face_view(&self.means, 0, face as u32);
            let mut pass = begin(&mut encoder, &target, self.depth.as_ref());
            pass.set_pipeline(&self.field);
            pass.set_bind_group(0, moment.module, &[]);
            pass.set_bind_group(1, group.group(), &[]);
            if let Some(shadows) = moment.shadows {
                pass.set_bind_group(3, shadows, &[]);
            }
            pass.draw(0..3, 0..1);
            if let Some((pipeline, meshes)) = self.meshes.as_ref().zip(moment.meshes) {
                pass.set_pipeline(pipeline);
                meshes.triangles.draw(&mut pass);
            }
            if let Some((pipeline, balls)) = self.balls.as_ref().zip(moment.balls) {
                balls.draw_with(pipeline, &mut pass);
            }
            drop(pass);
            // One by one: a driver gives up on a piece of work that is too long.
            self.gpu.queue().submit([encoder.finish()]);
        }
        self.blur();
        self.count += 1;
        true
    }

    /// Makes the levels.
    fn blur(&self) {
        let mut encoder = self.gpu.device().create_command_encoder(&Default::default());
        encoder.copy_texture_to_texture(
            self.means.as_image_copy(),
            self.cube.as_image_copy(),
            wgpu::Extent3d { width: self.side(), height: self.side(), depth_or_array_layers: 6 },
        );
        for level in 1..self.means.mip_level_count() {
            // A pass may not read what it draws on.
            let before = self.means.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2Array),
                base_mip_level: level - 1,
                mip_level_count: Some(1),
                ..Default::default()
            });
            let group = self.group(&self.view, &before);
            self.draw_level(&mut encoder, &self.halve, &group, &self.means, level);
        }
        let faces = self.means.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..Default::default()
        });
        let group = self.group(&cube_view(&self.means), &faces);
        for level in 1..self.cube.mip_level_count() {
            self.draw_level(&mut encoder, &self.blur, &group, &self.cube, level);
        }
        self.gpu.queue().submit([encoder.finish()]);
    }

    fn group(&self, cube: &wgpu::TextureView, faces: &wgpu::TextureView) -> wgpu::BindGroup {
        let sampler = self.gpu.device().create_sampler(&wgpu::SamplerDescriptor {
            label: Some(LABEL),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        });
        let parts = [
            wgpu::BindingResource::TextureView(cube),
            wgpu::BindingResource::Sampler(&sampler),
            wgpu::BindingResource::TextureView(faces),
        ];
        let entries: Vec<_> =
            (0u32..).zip(parts).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
        self.gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(LABEL),
            layout: &self.levels_layout,
            entries: &entries,
        })
    }

    fn draw_level(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        pipeline: &wgpu::RenderPipeline,
        group: &wgpu::BindGroup,
        texture: &wgpu::Texture,
        level: u32,
    ) {
        for face in 0..6 {
            let target = face_view(texture, level, face);
            let mut pass = begin(encoder, &target, None);
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, group, &[]);
            let which = 6 * level + face;
            pass.draw(0..3, which..which + 1);
        }
    }

    /// The pixels of the sharpest level, face by face.
    pub fn read(&self) -> Result<Vec<[f32; 4]>, String> {
        let side = self.side();
        let stride = (8 * side).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let (buffer, submitted) = self.gpu.catch(|| {
            let buffer = self.gpu.device().create_buffer(&wgpu::BufferDescriptor {
                label: Some(LABEL),
                size: u64::from(stride) * u64::from(side) * 6,
                usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
                mapped_at_creation: false,
            });
            let mut encoder = self.gpu.device().create_command_encoder(&Default::default());
            let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(stride), rows_per_image: Some(side) };
            encoder.copy_texture_to_buffer(
                self.means.as_image_copy(),
                wgpu::TexelCopyBufferInfo { buffer: &buffer, layout },
                wgpu::Extent3d { width: side, height: side, depth_or_array_layers: 6 },
            );
            let submitted = self.gpu.queue().submit([encoder.finish()]);
            (buffer, submitted)
        })?;
        let bytes = read(&self.gpu, &buffer, submitted)?;
        let number = |pair: &[u8]| f16::from_le_bytes(pair.try_into().unwrap_or_default()).to_f32();
        let rows = bytes.chunks_exact(stride as usize).flat_map(|row| row.chunks_exact(8).take(side as usize));
        Ok(rows.map(|pixel| [0, 1, 2, 3].map(|i| pixel.get(2 * i..2 * i + 2).map_or(0.0, number))).collect())
    }
}

/// The axes along which a face is seen: to its right, up and ahead, as cubemaps lie. They are those of a mirror's world.
fn face_basis(face: usize) -> Basis {
    let (right, up, forward) = match face {
        0 => ([0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]),
        1 => ([0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]),
        2 => ([1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]),
        3 => ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]),
        4 => ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]),
        _ => ([-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]),
    };
    Basis { right, up, forward, tan_half_fov: 1.0, parallel: None, lean: [0.0; 2] }
}

fn levels_layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
    let texture = |view_dimension| wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable: true },
        view_dimension,
        multisampled: false,
    };
    let types = [
        texture(wgpu::TextureViewDimension::Cube),
        wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
        texture(wgpu::TextureViewDimension::D2Array),
    ];
    let entry = |(binding, ty)| wgpu::BindGroupLayoutEntry { binding, visibility: wgpu::ShaderStages::FRAGMENT, ty, count: None };
    let entries: Vec<_> = (0u32..).zip(types).map(entry).collect();
    gpu.device().create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(LABEL), entries: &entries })
}

fn cube_view(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor { dimension: Some(wgpu::TextureViewDimension::Cube), ..Default::default() })
}

fn face_view(texture: &wgpu::Texture, level: u32, face: u32) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2),
        base_mip_level: level,
        mip_level_count: Some(1),
        base_array_layer: face,
        array_layer_count: Some(1),
        ..Default::default()
    })
}

/// Begins to draw on a face; whatever was there is drawn over.
fn begin<'a>(encoder: &'a mut wgpu::CommandEncoder, target: &wgpu::TextureView, depth: Option<&wgpu::TextureView>) -> wgpu::RenderPass<'a> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(LABEL),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: target,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store: wgpu::StoreOp::Store },
        })],
        depth_stencil_attachment: depth.map(crate::gpu::depth_attachment),
        ..Default::default()
    })
}
