//! The pass that scatters light: from a picture of linear light to one that is developed, still linear, ended by the tone curve.

use crate::gpu::{Gpu, PipelineKey, UniformBlock, uniform_layout};
use crate::sheets::{self, LINEAR, attachment, sheet};
use std::sync::{Mutex, PoisonError};
use surefoot_compiler::reference::film::glow_levels;

/// Pipelines and textures of a scene whose light is scattered.
#[derive(Debug)]
pub(crate) struct Bloom {
    gpu: Gpu,
    layout: wgpu::BindGroupLayout,
    half: wgpu::RenderPipeline,
    spread: wgpu::RenderPipeline,
    develop: wgpu::RenderPipeline,
    /// How much of the light is scattered.
    share: f32,
    /// Whether it only develops: to measure what the rest costs.
    idle: bool,
    kept: Mutex<Kept>,
}

/// What it draws on, of the newest size.
#[derive(Debug)]
struct Kept {
    uniforms: UniformBlock,
    size: [u32; 2],
    /// Halves of the picture, halves of these, and so on.
    halves: Vec<wgpu::Texture>,
    /// What is spread over each, but the last.
    spread: Vec<wgpu::Texture>,
    developed: Option<wgpu::Texture>,
}

const LABEL: &str = "surefoot bloom";

impl Bloom {
    /// With the text of a tone curve.
    pub fn new(gpu: &Gpu, tone: &str) -> Result<Self, String> {
        let layout = sheets::layout(gpu, true);
        let pipeline = |fragment| {
            let key = PipelineKey {
                wgsl: format!("{tone}\n{}", include_str!("bloom/bloom.wgsl")),
                constants: Vec::new(),
                format: Some(LINEAR),
                entries: ["vertex", fragment],
                depth: None,
                corners: None,
            };
            gpu.screen_pipeline(LABEL, key, &[Some(&layout)])
        };
        let uniforms = UniformBlock::new(gpu, LABEL, &uniform_layout(gpu, LABEL, 16, wgpu::ShaderStages::FRAGMENT), 16);
        let kept = Kept { uniforms, size: [0; 2], halves: Vec::new(), spread: Vec::new(), developed: None };
        Ok(Self {
            half: pipeline("half")?,
            spread: pipeline("spread")?,
            develop: pipeline("develop")?,
            layout,
            gpu: gpu.clone(),
            share: 0.0,
            idle: false,
            kept: Mutex::new(kept),
        })
    }

    /// Scatters so much of the light from now on; answers whether that is new.
    pub fn update(&mut self, share: f64) -> bool {
        let share = share as f32;
        std::mem::replace(&mut self.share, share) != share
    }

    /// Only develops from now on, or does all of it.
    pub fn set_idle(&mut self, idle: bool) {
        self.idle = idle;
    }

    /// Orders what becomes of a picture of `size` pixels in the upper left corner of a texture, and answers on what it will be.
    pub fn develop(&self, encoder: &mut wgpu::CommandEncoder, picture: &wgpu::Texture, size: [u32; 2]) -> wgpu::Texture {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let Kept { uniforms, halves, spread, developed, size: of } = &mut *kept;
        if *of != size {
            let sizes: Vec<[u32; 2]> = (1..=glow_levels(size.into())).map(|level| size.map(|side| side.div_ceil(1 << level).max(1))).collect();
            *halves = sizes.iter().map(|size| sheet(&self.gpu, *size, LINEAR)).collect();
            *spread = sizes.iter().rev().skip(1).rev().map(|size| sheet(&self.gpu, *size, LINEAR)).collect();
            *of = size;
        }
        let developed = match developed.take().filter(|t| t.size() == picture.size()) {
            Some(texture) => developed.insert(texture),
            None => developed.insert(sheet(&self.gpu, [picture.width(), picture.height()], LINEAR)),
        };
        let share = if self.idle { 0.0 } else { self.share };
        uniforms.write(self.gpu.queue(), bytemuck::cast_slice(&[size[0] as f32, size[1] as f32, share, 0.0]));
        let mut cover = |pipeline, from: &wgpu::Texture, onto: &wgpu::Texture, target: &wgpu::Texture| {
            let Some(uniforms) = uniforms.buffer() else { return };
            let [from, onto, view] = [from, onto, target].map(|t| t.create_view(&Default::default()));
            let group = self.gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some(LABEL),
                layout: &self.layout,
                entries: &[
                    wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&from) },
                    wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(&onto) },
                    wgpu::BindGroupEntry { binding: 2, resource: uniforms.as_entire_binding() },
                ],
            });
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some(LABEL),
                color_attachments: &[Some(attachment(&view))],
                ..Default::default()
            });
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.draw(0..3, 0..1);
        };
        let mut from = picture;
        if !self.idle {
            for half in halves.iter() {
                cover(&self.half, from, picture, half);
                from = half;
            }
            for (half, target) in halves.iter().zip(spread.iter()).rev() {
                cover(&self.spread, from, half, target);
                from = target;
            }
        }
        cover(&self.develop, from, picture, developed);
        developed.clone()
    }
}
