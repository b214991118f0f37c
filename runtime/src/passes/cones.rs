//! The pass before the field's: a cone for each tile of pixels, which says where their rays begin.

use crate::gpu::{Gpu, PipelineKey};
use crate::view::View;
use surefoot_compiler::compiled::Compiled;
use surefoot_compiler::shading;

/// Pixels of a tile's side.
const TILE: u32 = 8;
/// Looks of a cone at most.
const LOOKS: u32 = 32;
/// How far cones reach: the bits of a number for each. OpenGL draws on no texture of such numbers themselves.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;

/// What marches the cones of a picture, and how far they reached.
#[derive(Debug)]
pub(super) struct Cones {
    pipeline: wgpu::RenderPipeline,
    /// Those of the newest view; none where they have to be marched though nothing moved.
    reached: Option<wgpu::Texture>,
}

/// What both passes know of tiles.
fn tile() -> String {
    format!("const SCENE_TILE: f32 = {TILE}.0;")
}

/// What the field's pass has of it.
pub(super) fn begin() -> String {
    [&tile(), include_str!("cones/begin.wgsl")].join("\n")
}

impl Cones {
    /// Builds what marches the cones of a scene. `eye` is the text of its camera's rays; `module` and `scene` are the layouts of the
    /// first two groups.
    pub(super) fn prepare(gpu: &Gpu, compiled: &Compiled, eye: &str, module: &wgpu::BindGroupLayout, scene: &wgpu::BindGroupLayout) -> Result<Self, String> {
        let constants = format!("{}\nconst SCENE_LOOKS: u32 = {LOOKS}u;", tile());
        let ahead = &compiled.functions.ahead;
        let free = match (ahead.region.is_some(), ahead.planes.is_some()) {
            (false, _) => ["", include_str!("cones/free.wgsl")],
            (true, false) => [include_str!("cones/box.wgsl"), include_str!("cones/free_boxed.wgsl")],
            (true, true) => [include_str!("cones/box.wgsl"), include_str!("cones/free_planes.wgsl")],
        };
        let text = [
            compiled.module.code(),
            shading::BASE,
            include_str!("scene/bindings.wgsl"),
            eye,
            shading::TRIANGLE,
            &constants,
            free[0],
            free[1],
            include_str!("cones/march.wgsl"),
        ];
        let key = PipelineKey {
            wgsl: text.join("\n"),
            constants: Vec::new(),
            format: Some(FORMAT),
            entries: ["vertex", "fragment"],
            depth: None,
            corners: None,
        };
        let pipeline = gpu.screen_pipeline("surefoot cones", key, &[Some(module), Some(scene)])?;
        Ok(Self { pipeline, reached: None })
    }

    /// Marches the cones of a view, with these first two groups.
    pub(super) fn march(&mut self, gpu: &Gpu, view: &View, module: &wgpu::BindGroup, scene: &wgpu::BindGroup) {
        // A picture may begin within a pixel.
        let size = view.size.map(|side| (side.max(1.0) as u32 + 1).div_ceil(TILE));
        let size = wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 };
        let kept = self.reached.take().filter(|reached| reached.size() == size);
        let device = gpu.device();
        let reached = kept.unwrap_or_else(|| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some("surefoot cones"),
                size,
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: FORMAT,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            })
        });
        let target = reached.create_view(&Default::default());
        let mut encoder = device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("surefoot cones"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &target,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store: wgpu::StoreOp::Store },
            })],
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, module, &[]);
        pass.set_bind_group(1, scene, &[]);
        pass.draw(0..3, 0..1);
        drop(pass);
        gpu.queue().submit([encoder.finish()]);
        self.reached = Some(reached);
    }

    /// Whether they have to be marched though nothing moved.
    pub(super) fn is_stale(&self) -> bool {
        self.reached.is_none()
    }

    /// Marches them again with the next update.
    pub(super) fn forget(&mut self) {
        self.reached = None;
    }

    /// How many there are, across and down, once they were marched.
    pub(super) fn tiles(&self) -> Option<[u32; 2]> {
        self.reached.as_ref().map(|reached| [reached.width(), reached.height()])
    }

    /// How far they reached, once they were marched.
    pub(super) fn reached(&self) -> Option<wgpu::TextureView> {
        self.reached.as_ref().map(|reached| reached.create_view(&Default::default()))
    }
}
