//! The picture as a texture: drawn only where something changed, shown as an image.
//!
//! - What is quick to draw is drawn at once, all its pixels.
//! - What is slow is drawn with fewer pixels first, so that a hand can be followed. Once it rests, all pixels are drawn beside it,
//!   band after band, and shown when they are there: no single piece of work holds the device so long that the window stops, or
//!   that a driver gives up.

use super::log::Log;
use super::meter::{Finished, Meter, Piece, Timing};
use super::world::FORMAT;
use eframe::egui_wgpu::RenderState;
use std::sync::Arc;
use std::time::{Duration, Instant};
use surefoot_compiler::compiled::Camera;
use surefoot_runtime::frame::depth_attachment;
use surefoot_runtime::{Gpu, Stage, View};

/// How long a picture may take while something moves, in seconds: at least the first, and as long as the window takes for all else, up
/// to the second.
const PATIENCE: (f64, f64) = (0.033, 0.1);
/// How long a picture of something that rests may take in one piece, in seconds.
const AT_ONCE: f64 = 0.06;
/// How long the first band of all pixels may take, in seconds, and the longest. Each is twice as long as the one before: with each the
/// whole window is drawn once more, and who has waited so long does not touch it.
const BANDS: (f64, f64) = (0.04, 0.25);
/// How long nothing must move before all pixels are drawn.
const REST: Duration = Duration::from_millis(150);
/// Parts of the sides' pixels that are drawn.
const DETAILS: [f32; 6] = [1.0, 0.75, 0.5, 0.35, 0.25, 0.18];
/// The part that is drawn where nothing is known yet.
const UNKNOWN: f32 = 0.25;

/// The textures that the picture is drawn on.
pub struct Canvas {
    gpu: Gpu,
    render: RenderState,
    /// What is shown.
    front: Option<Target>,
    /// All pixels of it, where they are being drawn.
    back: Option<Target>,
    /// How far the back is drawn; none where there is nothing to do there.
    progress: Option<Progress>,
    /// Which part of the front's sides is drawn.
    part: [f32; 2],
    detail: f32,
    moved: Option<Instant>,
    meter: Meter,
    frames: u64,
    error: Option<String>,
}

/// Rows and bands that are drawn.
#[derive(Clone, Copy, Debug, Default)]
struct Progress {
    rows: u32,
    bands: u32,
}

struct Target {
    texture: wgpu::Texture,
    id: egui::TextureId,
}

/// A picture to be shown.
#[derive(Clone, Copy, Debug)]
pub struct Shown {
    /// The texture.
    pub texture: egui::TextureId,
    /// The part of it that holds the picture.
    pub uv: egui::Rect,
    /// Look again after this time: fewer pixels than wanted were drawn.
    pub again: Option<Duration>,
}

/// What shall be drawn.
pub struct Order {
    /// From where.
    pub camera: Camera,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Whether something moves.
    pub moving: bool,
    /// From one frame of the window to the next, in seconds.
    pub interval: f64,
    /// How many scenes were put on so far, for the log.
    pub swaps: u64,
}

impl Canvas {
    /// A canvas on the window's device. `wake` is called when a picture is done.
    pub fn new(gpu: Gpu, render: RenderState, log: Log, wake: Arc<dyn Fn() + Send + Sync>) -> Self {
        Self {
            meter: Meter::start(gpu.clone(), log, wake),
            gpu,
            render,
            front: None,
            back: None,
            progress: None,
            part: [0.0; 2],
            detail: 1.0,
            moved: None,
            frames: 0,
            error: None,
        }
    }

    /// How long pictures took.
    pub fn timing(&self) -> Timing {
        self.meter.timing()
    }

    /// What went wrong when the newest picture was drawn.
    pub fn error(&self) -> Option<&str> {
        self.error.as_deref()
    }

    /// Whether all pixels of the newest picture are shown.
    pub fn is_sharp(&self) -> bool {
        self.detail == 1.0 && self.progress.is_none()
    }

    /// How many pictures were drawn.
    #[cfg(test)]
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// Draws if anything changed, and answers what to show.
    pub fn draw(&mut self, stage: &mut Stage, order: &Order) -> Option<Shown> {
        stage.picture()?;
        let limit = self.gpu.device().limits().max_texture_dimension_2d;
        let size = order.size.map(|side| side.clamp(1, limit));
        match self.draw_or_fail(stage, order, size) {
            Ok(again) => self.shown(again),
            Err(error) => {
                self.error = Some(error);
                self.progress = None;
                self.shown(None)
            }
        }
    }

    fn shown(&self, again: Option<Duration>) -> Option<Shown> {
        let front = self.front.as_ref()?;
        let uv = egui::Rect::from_min_size(egui::Pos2::ZERO, self.part.into());
        // A part of nothing was never drawn.
        (self.part != [0.0; 2]).then_some(Shown { texture: front.id, uv, again })
    }

    fn draw_or_fail(
        &mut self,
        stage: &mut Stage,
        order: &Order,
        size: [u32; 2],
    ) -> Result<Option<Duration>, String> {
        let now = Instant::now();
        if order.moving {
            self.moved = Some(now);
        }
        let moved = self.moved.map_or(REST, |moved| now.duration_since(moved));
        let rests = moved >= REST;
        let fits = |t: &Target| [t.texture.width(), t.texture.height()] == size;
        let resized = !self.front.as_ref().is_some_and(fits);
        if resized {
            let texture = self.texture(size)?;
            self.front = Some(self.register(texture, self.front.as_ref()));
        }
        // With all pixels, to learn whether anything changed; fewer are asked for below.
        let changed = stage.update(self.gpu.queue(), &view(order, size)) || resized;
        if changed {
            self.progress = None;
            self.error = None;
            self.choose_detail(order, size, rests);
            self.draw_whole(stage, order, size)?;
        }
        if self.is_sharp() {
            return Ok(None);
        }
        if !rests {
            return Ok(Some(REST - moved));
        }
        // The device is given a band when it is done with the one before; the meter wakes the window then.
        if self.timing().in_flight == 0 {
            self.draw_band(stage, order, size)?;
        }
        Ok(None)
    }

    /// Decides how many pixels are drawn at once.
    fn choose_detail(&mut self, order: &Order, size: [u32; 2], rests: bool) {
        let per_pixel = self.timing().per_pixel;
        if per_pixel == 0.0 {
            self.detail = UNKNOWN;
            return;
        }
        let whole = per_pixel * f64::from(size[0]) * f64::from(size[1]);
        if rests && whole <= AT_ONCE {
            self.detail = 1.0;
            return;
        }
        let expected = |detail: f32| whole * f64::from(detail * detail);
        let patience = (0.5 * order.interval).clamp(PATIENCE.0, PATIENCE.1);
        // What is not far off stays, so that the picture does not flicker between two.
        let (takes, largest) = (expected(self.detail), self.detail == 1.0);
        if takes > 1.4 * patience || (takes < 0.5 * patience && !largest) {
            let fits = |detail: &&f32| expected(**detail) <= patience;
            self.detail = *DETAILS.iter().find(fits).unwrap_or(&0.18);
        }
    }

    /// Draws the picture as far as the detail goes, and shows it.
    fn draw_whole(
        &mut self,
        stage: &mut Stage,
        order: &Order,
        size: [u32; 2],
    ) -> Result<(), String> {
        let Some(front) = &self.front else { return Ok(()) };
        let fewer = size.map(|side| ((side as f32 * self.detail).round() as u32).max(1));
        let queue = self.gpu.queue();
        if fewer != size {
            stage.update(queue, &view(order, fewer));
        }
        let piece = self.submit(stage, &front.texture, fewer, 0..fewer[1])?;
        if fewer != size {
            stage.update(queue, &view(order, size));
        }
        self.part = [0, 1].map(|i| fewer[i] as f32 / size[i] as f32);
        self.frames += 1;
        let finishes = Some(self.finished(order, fewer));
        self.meter.add(Piece { finishes, ..piece });
        Ok(())
    }

    /// Draws the next rows of all pixels; with the last of them the back comes to the front.
    fn draw_band(&mut self, stage: &Stage, order: &Order, size: [u32; 2]) -> Result<(), String> {
        let Progress { rows: first, bands } = match self.progress {
            Some(progress) => progress,
            None => {
                let texture = self.texture(size)?;
                self.back = Some(self.register(texture, self.back.as_ref()));
                Progress::default()
            }
        };
        let Some(back) = &self.back else { return Ok(()) };
        let row = self.timing().per_pixel * f64::from(size[0]);
        let band = (BANDS.0 * f64::from(1 << bands.min(10))).min(BANDS.1);
        let rows = if row > 0.0 { (band / row) as u32 } else { size[1] / 16 };
        let end = (first + rows.max(4)).min(size[1]);
        let piece = self.submit(stage, &back.texture, size, first..end)?;
        if end < size[1] {
            self.progress = Some(Progress { rows: end, bands: bands + 1 });
            self.meter.add(piece);
            return Ok(());
        }
        std::mem::swap(&mut self.front, &mut self.back);
        self.progress = None;
        self.part = [1.0; 2];
        self.detail = 1.0;
        self.frames += 1;
        let finishes = Some(self.finished(order, size));
        self.meter.add(Piece { finishes, ..piece });
        Ok(())
    }

    fn finished(&self, order: &Order, size: [u32; 2]) -> Finished {
        Finished { frame: self.frames, size: size.into(), swaps: order.swaps }
    }

    /// Orders some rows of a picture that has `size` pixels.
    fn submit(
        &self,
        stage: &Stage,
        texture: &wgpu::Texture,
        size: [u32; 2],
        rows: std::ops::Range<u32>,
    ) -> Result<Piece, String> {
        let ordered = Instant::now();
        let height = rows.end.saturating_sub(rows.start);
        let submission = self.gpu.catch(|| {
            let mut encoder = self.gpu.device().create_command_encoder(&Default::default());
            let view = texture.create_view(&Default::default());
            let depth = stage.picture().and_then(|picture| picture.depth(texture.size()));
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("surefoot"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store },
                })],
                depth_stencil_attachment: depth.as_ref().map(depth_attachment),
                ..Default::default()
            });
            pass.set_viewport(0.0, 0.0, size[0] as f32, size[1] as f32, 0.0, 1.0);
            pass.set_scissor_rect(0, rows.start, size[0], height);
            if let Some(picture) = stage.picture() {
                picture.draw(&mut pass);
            }
            drop(pass);
            self.gpu.queue().submit([encoder.finish()])
        })?;
        let pixels = u64::from(size[0]) * u64::from(height);
        Ok(Piece { submission, ordered, pixels, finishes: None })
    }

    fn texture(&self, size: [u32; 2]) -> Result<wgpu::Texture, String> {
        self.gpu.catch(|| {
            self.gpu.device().create_texture(&wgpu::TextureDescriptor {
                label: Some("surefoot picture"),
                size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: FORMAT,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                    | wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            })
        })
    }

    /// Makes a texture known to egui, under the name of an old one where there is one.
    fn register(&self, texture: wgpu::Texture, old: Option<&Target>) -> Target {
        let view = texture.create_view(&Default::default());
        let device = self.gpu.device();
        let filter = wgpu::FilterMode::Linear;
        let mut renderer = self.render.renderer.write();
        let id = match old {
            Some(old) => {
                renderer.update_egui_texture_from_wgpu_texture(device, &view, filter, old.id);
                old.id
            }
            None => renderer.register_native_texture(device, &view, filter),
        };
        Target { texture, id }
    }
}

fn view(order: &Order, size: [u32; 2]) -> View {
    View { camera: order.camera, size: size.map(|side| side as f32), corner: [0.0; 2] }
}
