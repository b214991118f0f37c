//! The film: pictures of one scene, each seen through other places of its pixels, become one without steps at its edges.
//!
//! A picture falls on a target of 16-bit floats, after the tone curve and before the encoding for a screen, and its mean with those
//! before is kept in 32 bits. The mean is taken after the curve: a lamp that covers a tenth of a pixel makes it a tenth brighter; a
//! mean of the light itself would be as bright as the lamp, and its edge had steps again.

use crate::frame::Picture;
use crate::gpu::{Gpu, PipelineKey, UniformBlock, depth_attachment, uniform_layout};
use crate::sheets::{attachment, layout, sheet};
use std::ops::Range;
use surefoot_compiler::reference::sample_offset;
use surefoot_compiler::shading;

pub use crate::sheets::LINEAR;

/// What means are kept in: floats of 32 bits, or of 16 where the device can't draw on those, as through OpenGL.
fn mean_format(gpu: &Gpu) -> wgpu::TextureFormat {
    let exact = wgpu::TextureFormat::Rgba32Float;
    gpu.catch(|| sheet(gpu, [1, 1], exact)).map_or(LINEAR, |_| exact)
}

/// Where in its pixels the picture of a number looks: [`sample_offset`].
pub fn offset(index: u32) -> [f32; 2] {
    sample_offset(index).map(|c| c as f32)
}

/// A film of some size.
#[derive(Debug)]
pub struct Film {
    gpu: Gpu,
    mean: wgpu::RenderPipeline,
    show: wgpu::RenderPipeline,
    layouts: [wgpu::BindGroupLayout; 2],
    share: UniformBlock,
    sheets: Sheets,
    /// How many pixels of it the newest picture has.
    drawn: [u32; 2],
    count: u32,
}

/// What is drawn on.
#[derive(Debug)]
struct Sheets {
    picture: wgpu::Texture,
    /// The newest mean is the one with the number of pictures, modulo two.
    means: [wgpu::Texture; 2],
}

impl Film {
    /// A film of so many pixels, to be shown on targets of a format that takes encoded colours.
    pub fn new(gpu: &Gpu, size: [u32; 2], target: wgpu::TextureFormat) -> Result<Self, String> {
        let key = |wgsl: &str, format| PipelineKey {
            wgsl: format!("{}\n{wgsl}", include_str!("passes/film/base.wgsl")),
            constants: Vec::new(),
            format: Some(format),
            entries: ["vertex", "fragment"],
            depth: None,
            corners: None,
        };
        gpu.catch(|| {
            let layouts = [layout(gpu, true), layout(gpu, false)];
            let kept_in = mean_format(gpu);
            let mean = key(include_str!("passes/film/mean.wgsl"), kept_in);
            let show = key(&[shading::DITHER, include_str!("passes/film/show.wgsl")].join("\n"), target);
            let stage = wgpu::ShaderStages::FRAGMENT;
            Ok(Self {
                mean: gpu.screen_pipeline("surefoot film, mean", mean, &[Some(&layouts[0])])?,
                show: gpu.screen_pipeline("surefoot film, show", show, &[Some(&layouts[1])])?,
                share: UniformBlock::new(gpu, "surefoot film", &uniform_layout(gpu, "surefoot film", 16, stage), 16),
                layouts,
                sheets: Sheets::new(gpu, size, kept_in),
                gpu: gpu.clone(),
                drawn: size,
                count: 0,
            })
        })?
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        [self.sheets.picture.width(), self.sheets.picture.height()]
    }

    /// Takes film of another size, where the size is another.
    pub fn resize(&mut self, size: [u32; 2]) -> Result<(), String> {
        if self.size() != size {
            let kept_in = self.sheets.means[0].format();
            self.sheets = self.gpu.catch(|| Sheets::new(&self.gpu, size, kept_in))?;
            self.count = 0;
        }
        Ok(())
    }

    /// How many pictures fell on it.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Forgets what fell on it.
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// Orders some rows of a picture that has `size` pixels, in the film's upper left corner. The picture was updated for it.
    pub fn draw(&mut self, encoder: &mut wgpu::CommandEncoder, picture: &Picture, size: [u32; 2], rows: Range<u32>) {
        self.drawn = size;
        let target = &self.sheets.picture;
        let view = target.create_view(&Default::default());
        let depth = picture.depth(target.size());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("surefoot"),
            color_attachments: &[Some(attachment(&view))],
            depth_stencil_attachment: depth.as_ref().map(depth_attachment),
            ..Default::default()
        });
        pass.set_viewport(0.0, 0.0, size[0] as f32, size[1] as f32, 0.0, 1.0);
        picture.draw_rows(&mut pass, size[0], rows);
    }

    /// The picture that was drawn, developed.
    fn developed(&self, encoder: &mut wgpu::CommandEncoder, picture: &Picture) -> wgpu::Texture {
        picture.develop(encoder, &self.sheets.picture, self.drawn).unwrap_or_else(|| self.sheets.picture.clone())
    }

    /// Orders that what `picture` drew counts. What is ordered must be submitted before the next one counts.
    pub fn keep(&mut self, encoder: &mut wgpu::CommandEncoder, picture: &Picture) {
        let developed = self.developed(encoder, picture);
        let share = 1.0 / (self.count + 1) as f32;
        self.share.write(self.gpu.queue(), bytemuck::cast_slice(&[share, 0.0, 0.0, 0.0]));
        let before = &self.sheets.means[self.count as usize % 2];
        self.count += 1;
        let after = &self.sheets.means[self.count as usize % 2];
        let views = [&developed, before].map(|t| t.create_view(&Default::default()));
        let Some(share) = self.share.buffer() else { return };
        let group = self.gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("surefoot film, mean"),
            layout: &self.layouts[0],
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&views[0]) },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(&views[1]) },
                wgpu::BindGroupEntry { binding: 2, resource: share.as_entire_binding() },
            ],
        });
        self.cover(encoder, &self.mean, &group, after);
    }

    /// Orders that the mean is shown on a target of the film's size; where nothing counts yet, what `picture` drew.
    pub fn show(&self, encoder: &mut wgpu::CommandEncoder, picture: &Picture, target: &wgpu::Texture) {
        let newest = if self.count == 0 { self.developed(encoder, picture) } else { self.sheets.means[self.count as usize % 2].clone() };
        let mean = newest.create_view(&Default::default());
        let group = self.gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("surefoot film, show"),
            layout: &self.layouts[1],
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&mean) }],
        });
        self.cover(encoder, &self.show, &group, target);
    }

    fn cover(&self, encoder: &mut wgpu::CommandEncoder, pipeline: &wgpu::RenderPipeline, group: &wgpu::BindGroup, target: &wgpu::Texture) {
        let view = target.create_view(&Default::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("surefoot film"),
            color_attachments: &[Some(attachment(&view))],
            ..Default::default()
        });
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, group, &[]);
        pass.draw(0..3, 0..1);
    }
}

impl Sheets {
    fn new(gpu: &Gpu, size: [u32; 2], kept_in: wgpu::TextureFormat) -> Self {
        Self { picture: sheet(gpu, size, LINEAR), means: [sheet(gpu, size, kept_in), sheet(gpu, size, kept_in)] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_cover_their_pixels_evenly() {
        assert_eq!(offset(0), [0.0; 2]);
        for count in [16u32, 64, 256] {
            let side = count.isqrt();
            let mut cells = vec![0u32; count as usize];
            let mut sum = [0.0f64; 2];
            for [x, y] in (0..count).map(offset) {
                assert!(x.abs() <= 0.5 && y.abs() <= 0.5);
                sum = [sum[0] + f64::from(x), sum[1] + f64::from(y)];
                let cell = |c: f32| (((c + 0.5) * side as f32) as u32).min(side - 1);
                cells[(cell(y) * side + cell(x)) as usize] += 1;
            }
            assert!(cells.iter().all(|n| *n <= 3), "{cells:?}");
            assert!(cells.iter().filter(|n| **n > 0).count() as u32 * 10 >= count * 7, "{cells:?}");
            // All of them together look at the middle, but for a tenth of a pixel at worst.
            assert!(sum.iter().all(|s| s.abs() < 1.6), "{sum:?}");
        }
    }
}
