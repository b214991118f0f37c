//! Balls over the field: instances that share its uniforms, its light and its depth.

use super::scene::{Features, ViewMode};
use super::section;
use super::shadows::BallsNow;
use super::surroundings;
use crate::gpu::{Gpu, PipelineKey, storage_layout};
use crate::module;
use crate::physics::Physics;
use bytemuck::{Pod, Zeroable};
use std::borrow::Cow;
use surefoot_compiler::compiled::{Compiled, Live};
use surefoot_compiler::physics::Group;

/// Draws balls.
#[derive(Debug)]
pub struct BallsPipeline {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    looks: wgpu::Buffer,
    written: Vec<Look>,
    /// Grows with each change of what they are made of.
    pub(super) looks_version: u64,
    /// The balls that are drawn, where there are any.
    shown: Option<Shown>,
}

/// Balls that are drawn.
#[derive(Debug)]
struct Shown {
    group: wgpu::BindGroup,
    buffer: wgpu::Buffer,
    count: u32,
    version: u64,
}

/// A group's material, as `balls.wgsl` declares it.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
struct Look {
    color: [f32; 3],
    roughness: f32,
    emission: [f32; 3],
    metallic: f32,
    reflectivity: f32,
    /// The speed from which on balls are red; 0 where they have the material's colour.
    red_at: f32,
    padding: [f32; 2],
}

impl BallsPipeline {
    /// Builds what draws the balls of a scene. `shadows` is group 3, where the pass looks shadows up.
    pub(super) fn prepare(
        gpu: &Gpu,
        compiled: &Compiled,
        format: wgpu::TextureFormat,
        features: Features,
        shadows: Option<&wgpu::BindGroupLayout>,
    ) -> Result<Self, String> {
        gpu.catch(|| {
            let layout = storage_layout(gpu, LABEL, wgpu::ShaderStages::VERTEX_FRAGMENT, 2);
            let pipeline = pipeline(gpu, compiled, format, features, &layout, shadows)?;
            let looks = gpu.device().create_buffer(&wgpu::BufferDescriptor {
                label: Some(LABEL),
                size: (size_of::<Look>() * compiled.blocks.balls.len().max(1)) as u64,
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            Ok(Self { pipeline, layout, looks, written: Vec::new(), looks_version: 0, shown: None })
        })?
    }

    /// What draws the same balls on other targets.
    pub(super) fn other(
        &self,
        gpu: &Gpu,
        compiled: &Compiled,
        format: wgpu::TextureFormat,
        features: Features,
        shadows: Option<&wgpu::BindGroupLayout>,
    ) -> Result<wgpu::RenderPipeline, String> {
        pipeline(gpu, compiled, format, features, &self.layout, shadows)
    }

    /// The balls that are drawn, as what throws shadows.
    pub(super) fn now(&self) -> Option<BallsNow<'_>> {
        self.shown.as_ref().map(|shown| BallsNow { buffer: &shown.buffer, count: shown.count, version: shown.version })
    }

    /// Shows balls as they are now, or none.
    pub fn show(&mut self, gpu: &Gpu, compiled: &Compiled, live: &Live, physics: Option<&Physics>) {
        self.shown = physics.filter(|p| p.count() > 0).map(|physics| {
            let group = gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some(LABEL),
                layout: &self.layout,
                entries: &[
                    wgpu::BindGroupEntry { binding: 0, resource: physics.buffer().as_entire_binding() },
                    wgpu::BindGroupEntry { binding: 1, resource: self.looks.as_entire_binding() },
                ],
            });
            Shown { group, buffer: physics.buffer().clone(), count: physics.count(), version: physics.version() }
        });
        let look = |group: &Group| {
            let [r, g, b, x, y, z, roughness, metallic, reflectivity] = group.look.map(|c| c as f32);
            let red_at = group.red_at.map_or(0.0, |speed| speed as f32);
            Look { color: [r, g, b], roughness, emission: [x, y, z], metallic, reflectivity, red_at, padding: [0.0; 2] }
        };
        let looks: Vec<Look> = compiled.groups(live).iter().map(look).collect();
        if looks != self.written {
            gpu.queue().write_buffer(&self.looks, 0, bytemuck::cast_slice(&looks));
            self.written = looks;
            self.looks_version += 1;
        }
    }

    /// Draws after the field, whose groups 0 and 1 are set.
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.draw_with(&self.pipeline, pass);
    }

    /// The same with what [`Self::other`] answered.
    pub(super) fn draw_with(&self, pipeline: &wgpu::RenderPipeline, pass: &mut wgpu::RenderPass<'_>) {
        let Some(shown) = &self.shown else { return };
        pass.set_pipeline(pipeline);
        pass.set_bind_group(2, &shown.group, &[]);
        pass.draw(0..6, 0..shown.count);
    }
}

const LABEL: &str = "surefoot balls, picture";

/// What draws balls on targets of a format.
fn pipeline(
    gpu: &Gpu,
    compiled: &Compiled,
    format: wgpu::TextureFormat,
    features: Features,
    layout: &wgpu::BindGroupLayout,
    shadows: Option<&wgpu::BindGroupLayout>,
) -> Result<wgpu::RenderPipeline, String> {
    let shading = features.shading(compiled);
    let mut sections = vec![compiled.module.code()];
    sections.extend(shading.iter().map(|s| &**s));
    sections.push(include_str!("../physics/ball.wgsl"));
    let balls = match features.section {
        Some(_) => section::balls(include_str!("balls/balls.wgsl")).into(),
        None => Cow::Borrowed(include_str!("balls/balls.wgsl")),
    };
    sections.push(&balls);
    sections.push(match features.view {
        ViewMode::Normals => include_str!("balls/normals.wgsl"),
        ViewMode::Depth => include_str!("balls/depth.wgsl"),
        _ => include_str!("balls/shaded.wgsl"),
    });
    let key = PipelineKey {
        wgsl: sections.join("\n"),
        constants: features.constants(format),
        format: Some(format),
        entries: ["ball_vertex", "ball_fragment"],
        depth: Some(wgpu::CompareFunction::GreaterEqual),
        corners: None,
    };
    let module = module::layout(gpu, &compiled.module, wgpu::ShaderStages::VERTEX_FRAGMENT);
    let scene = surroundings::layout(gpu, features);
    let layouts = [Some(&module), Some(&scene), Some(layout), shadows];
    gpu.screen_pipeline(LABEL, key, if shadows.is_some() { &layouts } else { &layouts[..3] })
}
