//! The pass over the screen on the GPU: pipeline, uniforms, draw.

use super::balls::BallsPipeline;
use super::capture::{self, Capture};
use super::cones::Cones;
use super::meshes::MeshesPipeline;
use super::scene::{Features, SceneUniforms};
use super::shadows::{Moment, Shadows};
use super::surroundings::{self, SceneGroup, SceneImages};
use crate::gpu::{DEPTH, DEPTH_AS_READ, Gpu, PipelineKey};
use crate::module::{self, ModuleGroup};
use crate::view::View;
use surefoot_compiler::compiled::{Compiled, Live, UniformSource};
use surefoot_compiler::images::Images;

/// A compiled scene as a pipeline. Its uniforms change; it itself does not.
#[derive(Debug)]
pub struct ScenePipeline {
    gpu: Gpu,
    pipeline: wgpu::RenderPipeline,
    module: ModuleGroup,
    scene: SceneGroup,
    features: Features,
    /// Whether images were shown since the last update.
    fresh: bool,
    balls: Option<BallsPipeline>,
    meshes: Option<MeshesPipeline>,
    shadows: Option<Shadows>,
    capture: Option<Capture>,
    cones: Option<Cones>,
    /// The cones' reaches for the field's pass, where it reads nothing else in their group.
    before: Option<wgpu::BindGroup>,
    /// How many passes are drawn, where not all are.
    first: Option<u32>,
    /// The newest view.
    view: Option<View>,
}

impl ScenePipeline {
    /// Builds the pipeline that draws a scene on targets of a format, or says what naga or the device finds wrong in it.
    pub(crate) fn prepare_with(gpu: &Gpu, compiled: &Compiled, format: wgpu::TextureFormat, features: Features) -> Result<Self, String> {
        for export in features.exports() {
            if !compiled.module.exports.contains(&export) {
                return Err(format!("the module has no function `{}`", export.name()));
            }
        }
        let label = "surefoot scene";
        let stage = wgpu::ShaderStages::VERTEX_FRAGMENT;
        let key = PipelineKey {
            wgsl: format!("{}\n{}", features.module(compiled)?, features.wgsl(compiled)),
            constants: features.constants(format),
            format: Some(format),
            entries: ["vertex", "fragment"],
            // The field is drawn first, whatever was there.
            depth: features.depth().then_some(wgpu::CompareFunction::Always),
            corners: None,
        };
        gpu.catch(|| {
            let module_layout = module::layout(gpu, &compiled.module, stage);
            let scene_layout = surroundings::layout(gpu, features);
            let shadows = match features.maps() {
                true => Some(Shadows::new(gpu, compiled, features)?),
                false => None,
            };
            // The same layout, bound or built again, is the same to wgpu: a pipeline that was kept fits.
            let lookup = shadows.as_ref().map(Shadows::layout);
            let balls = match features.balls {
                true => Some(BallsPipeline::prepare(gpu, compiled, format, features, lookup)?),
                false => None,
            };
            let meshes = match features.meshes {
                true => Some(MeshesPipeline::prepare(gpu, compiled, format, features, lookup)?),
                false => None,
            };
            let before_layout = features.reads_before().then(|| before_layout(gpu, features));
            let layouts = [Some(&module_layout), Some(&scene_layout), before_layout.as_ref(), lookup];
            let count = if lookup.is_some() { 4 } else if before_layout.is_some() { 3 } else { 2 };
            let layouts = &layouts[..count];
            // The driver makes both at the same time.
            let plain = surroundings::plain_layout(gpu);
            let (pipeline, cones) = std::thread::scope(|scope| {
                let cones = || features.cones.then(|| Cones::prepare(gpu, compiled, features.eye(), &module_layout, &plain)).transpose();
                let beside = std::thread::Builder::new().spawn_scoped(scope, cones);
                let pipeline = gpu.screen_pipeline(label, key, layouts)?;
                let cones = match beside {
                    Ok(thread) => thread.join().unwrap_or_else(|_| Err("the cones' pipeline could not be built".to_owned())),
                    Err(_) => cones(),
                };
                Ok::<_, String>((pipeline, cones?))
            })?;
            let capture = match features.capture {
                Some(size) => Some(Capture::new(gpu, compiled, features.of_capture(), size, balls.as_ref(), meshes.as_ref(), lookup)?),
                None => None,
            };
            let mut new = Self {
                gpu: gpu.clone(),
                pipeline,
                module: ModuleGroup::new(gpu, compiled, &module_layout),
                scene: SceneGroup::new(gpu, features, scene_layout),
                features,
                fresh: false,
                balls,
                meshes,
                shadows,
                capture,
                cones,
                before: None,
                first: None,
                view: None,
            };
            new.bind(gpu, &SceneImages::missing(gpu, features, compiled));
            Ok(new)
        })?
    }

    /// Writes the uniforms of one moment. Answers whether anything changed: where nothing did, the picture is the same.
    pub fn update(
        &mut self,
        queue: &wgpu::Queue,
        compiled: &Compiled,
        live: &Live,
        view: &View,
    ) -> bool {
        let frame = compiled.frame(live);
        let origin = origin(compiled, view);
        let View { camera, size, corner, sample } = *view;
        let uniforms = SceneUniforms::new(&frame, &camera, origin, size, corner)
            .of_sample(sample)
            .rounded(compiled.module.rounding);
        let uniforms = match frame.section.filter(|_| self.features.section.is_some()) {
            Some(section) => uniforms.cut_at(section.place(&camera)),
            None => uniforms,
        };
        let module = self.module.write(queue, &compiled.uniform_bytes(live, origin));
        let scene = self.scene.write(queue, &uniforms);
        let placed = if self.meshes.is_some() { compiled.meshes(live) } else { Vec::new() };
        let meshes = self.meshes.as_mut().is_some_and(|m| m.triangles.update(queue, &placed, origin));
        let shadows = self.shadows.as_mut().is_some_and(|shadows| {
            shadows.update(&Moment {
                frame: &frame,
                origin,
                triangles: self.meshes.as_ref().map(|m| &m.triangles),
                placed: &placed,
                balls: self.balls.as_ref().and_then(BallsPipeline::now),
                module: self.module.group(),
                field: compiled.uniform_bytes(live, [0.0; 3]),
            })
        });
        let captured = self.capture.as_mut().zip(frame.capture).is_some_and(|(capture, place)| {
            capture.update(&capture::Moment {
                frame: &frame,
                place,
                origin,
                rounding: compiled.module.rounding,
                module: self.module.group(),
                field: compiled.uniform_bytes(live, [0.0; 3]),
                shadows: self.shadows.as_ref().map(Shadows::group),
                meshes: self.meshes.as_ref(),
                placed: &placed,
                balls: self.balls.as_ref(),
            })
        });
        self.view = Some(*view);
        if let Some(cones) = self.cones.as_mut().filter(|cones| module || scene || cones.is_stale()) {
            cones.march(&self.gpu, view, self.module.group(), self.scene.plain());
            if !self.features.meshes_first {
                self.before = Some(self.group_before(None));
            }
        }
        std::mem::take(&mut self.fresh) || module || scene || meshes || shadows || captured
    }

    /// Binds images everywhere.
    fn bind(&mut self, gpu: &Gpu, images: &SceneImages) {
        self.scene.bind(gpu, images, self.capture.as_ref().map(Capture::view));
        if let Some(capture) = &mut self.capture {
            capture.bind(gpu, images);
        }
    }

    /// Shows the images that the scene names, as far as they could be read.
    pub fn show_images(&mut self, gpu: &Gpu, images: &Images) {
        let Features { environment, textures, .. } = self.features;
        if (environment || textures > 0) && images.textures.len() >= textures as usize {
            self.bind(gpu, &SceneImages::new(gpu, self.features, images));
            self.fresh = true;
        }
    }

    /// What draws the balls, where the scene has some.
    pub fn balls_mut(&mut self) -> Option<&mut BallsPipeline> {
        self.balls.as_mut()
    }

    /// What draws the meshes, where the scene has some.
    pub fn meshes_mut(&mut self) -> Option<&mut MeshesPipeline> {
        self.meshes.as_mut()
    }

    /// How many shadow maps there are, and how many pixels a side of one has.
    pub(crate) fn maps(&self) -> (usize, u32) {
        self.shadows.as_ref().map_or((0, 0), Shadows::size)
    }

    /// The cubemap of the scene itself, where there is one.
    pub(crate) fn capture(&mut self) -> Option<&mut Capture> {
        self.capture.as_mut()
    }

    /// Draws the shadow maps again with the next update.
    pub(crate) fn forget_maps(&mut self) {
        if let Some(shadows) = &mut self.shadows {
            shadows.forget();
        }
    }

    /// Tiles of pixels that have a cone, across and down, where there are any.
    pub(crate) fn tiles(&self) -> Option<[u32; 2]> {
        self.cones.as_ref().and_then(Cones::tiles)
    }

    /// Marches the cones again with the next update.
    pub(crate) fn forget_cones(&mut self) {
        if let Some(cones) = &mut self.cones {
            cones.forget();
        }
    }

    /// Draws only so many passes from now on: the field, the meshes, the balls, as far as the scene has them.
    pub(crate) fn draw_first(&mut self, passes: Option<u32>) {
        self.first = passes;
    }

    /// Whether it draws with depth.
    pub fn has_depth(&self) -> bool {
        self.features.depth()
    }

    /// Draws the depth of the meshes for a target of this size, and answers with what the field's pass is bound to, so that its rays end there.
    /// None where the field is drawn first.
    pub(crate) fn draw_before(&self, size: wgpu::Extent3d) -> Option<wgpu::BindGroup> {
        let meshes = self.meshes.as_ref().filter(|_| self.features.meshes_first)?;
        let view = self.view?;
        let gpu = &self.gpu;
        let texture = gpu.device().create_texture(&wgpu::TextureDescriptor {
            label: Some("surefoot meshes, depth"),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: DEPTH,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let target = texture.create_view(&Default::default());
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("surefoot meshes, depth"),
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &target,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        set_viewport(&mut pass, &view);
        pass.set_bind_group(1, self.scene.plain(), &[]);
        meshes.draw_before(&mut pass);
        drop(pass);
        gpu.queue().submit([encoder.finish()]);
        Some(self.group_before(Some(&target)))
    }

    /// What the field's pass reads of the passes before it.
    fn group_before(&self, depth: Option<&wgpu::TextureView>) -> wgpu::BindGroup {
        let cones = self.cones.as_ref().and_then(Cones::reached);
        let entries = [(0, depth), (1, cones.as_ref())];
        let entries = entries.into_iter().filter_map(|(binding, view)| Some(wgpu::BindGroupEntry { binding, resource: wgpu::BindingResource::TextureView(view?) }));
        self.gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("surefoot before"),
            layout: &before_layout(&self.gpu, self.features),
            entries: &entries.collect::<Vec<_>>(),
        })
    }

    /// Draws over the whole of the pass's viewport and scissors. `before` is what [`Self::draw_before`] answered.
    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, before: Option<&wgpu::BindGroup>) {
        let mut left = self.first.unwrap_or(u32::MAX);
        let mut next = || {
            let draws = left > 0;
            left = left.saturating_sub(1);
            draws
        };
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, self.module.group(), &[]);
        pass.set_bind_group(1, self.scene.group(), &[]);
        if let Some(shadows) = &self.shadows {
            pass.set_bind_group(3, shadows.group(), &[]);
        }
        let before = before.or(self.before.as_ref());
        if let Some(before) = before {
            pass.set_bind_group(2, before, &[]);
        }
        // Without the depth that its rays end at, and where they begin, the field's pass has nothing to be drawn with.
        if next() && (before.is_some() || !self.features.reads_before()) {
            pass.draw(0..3, 0..1);
        }
        let Some(view) = self.view.filter(|_| self.has_depth()) else { return };
        set_viewport(pass, &view);
        if let Some(meshes) = self.meshes.as_ref().filter(|_| next()) {
            meshes.draw(pass);
        }
        if let Some(balls) = self.balls.as_ref().filter(|_| next()) {
            balls.draw(pass);
        }
    }
}

/// What the field's pass reads of those before it: group 2. The depth of meshes, and how far cones reached.
fn before_layout(gpu: &Gpu, features: Features) -> wgpu::BindGroupLayout {
    let texture = |binding, sample_type| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::FRAGMENT,
        ty: wgpu::BindingType::Texture { sample_type, view_dimension: wgpu::TextureViewDimension::D2, multisampled: false },
        count: None,
    };
    let depth = features.meshes_first.then(|| texture(0, DEPTH_AS_READ));
    let cones = features.cones.then(|| texture(1, wgpu::TextureSampleType::Uint));
    gpu.device().create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("surefoot before"),
        entries: &depth.into_iter().chain(cones).collect::<Vec<_>>(),
    })
}

/// The whole picture, of which the target may be a tile; parts of pixels are for `scene_project` in base.wgsl.
fn set_viewport(pass: &mut wgpu::RenderPass<'_>, view: &View) {
    let View { size: [width, height], corner: [left, top], .. } = *view;
    pass.set_viewport(left.floor(), top.floor(), width.max(1.0), height.max(1.0), 0.0, 1.0);
}

/// The scene's point at which the module's `p` is zero: the eye as 32 bits hold it, where the module can be moved at all.
fn origin(compiled: &Compiled, view: &View) -> [f64; 3] {
    let moves = compiled.module.uniforms.iter().any(|u| u.source == UniformSource::Origin);
    if moves { view.camera.eye.map(|c| f64::from(c as f32)) } else { [0.0; 3] }
}
