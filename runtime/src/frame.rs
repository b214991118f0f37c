//! One frame is a list of passes. A pass that a scene does not need is not in it: nothing of it is compiled and it has no buffers.

use crate::gpu::Gpu;
use crate::passes::ScenePipeline;
use crate::passes::scene::{Features, ViewMode};
use crate::view::View;
use surefoot_compiler::compiled::{Compiled, Live};

/// A pass by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PassKind {
    /// Rays through the field, over the whole screen.
    Scene,
}

/// A pass of a frame, and why it is there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlannedPass {
    /// Which.
    pub kind: PassKind,
    /// Its name, for people.
    pub name: &'static str,
    /// Why the frame needs it.
    pub reason: String,
}

/// The passes that a view of a scene needs, in the order in which they run.
pub fn plan(compiled: &Compiled, mode: ViewMode) -> Vec<PlannedPass> {
    let features = Features::of(compiled, mode);
    let parts = [
        (features.shadows, "a light throws shadows"),
        (features.occlusion, "corners are kept from the sky's light"),
        (features.depth, "meshes are drawn after it"),
    ];
    let reasons: Vec<&str> = parts.into_iter().filter(|(on, _)| *on).map(|(_, why)| why).collect();
    vec![PlannedPass {
        kind: PassKind::Scene,
        name: "scene",
        reason: match reasons.is_empty() {
            true => "a ray for each pixel".to_owned(),
            false => format!("a ray for each pixel; {}", reasons.join(", ")),
        },
    }]
}

/// A compiled scene, ready to be drawn.
#[derive(Debug)]
pub struct Picture {
    mode: ViewMode,
    passes: Vec<PlannedPass>,
    scene: ScenePipeline,
}

impl Picture {
    /// Builds what the scene's passes need. May take a while: `live` does it on another thread.
    pub fn prepare(
        gpu: &Gpu,
        compiled: &Compiled,
        format: wgpu::TextureFormat,
        mode: ViewMode,
    ) -> Result<Self, String> {
        Ok(Self {
            mode,
            passes: plan(compiled, mode),
            scene: ScenePipeline::prepare(gpu, compiled, format, mode)?,
        })
    }

    /// What it shows.
    pub fn mode(&self) -> ViewMode {
        self.mode
    }

    /// The passes of each frame, in their order.
    pub fn passes(&self) -> &[PlannedPass] {
        &self.passes
    }

    /// Writes what changed since the last call, and answers whether anything did: where nothing did, there is nothing to draw.
    /// `compiled` is the scene that the picture was prepared from.
    pub fn update(
        &mut self,
        queue: &wgpu::Queue,
        compiled: &Compiled,
        live: &Live,
        view: &View,
    ) -> bool {
        self.scene.update(queue, compiled, live, view)
    }

    /// Draws the frame.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.scene.draw(pass);
    }
}
