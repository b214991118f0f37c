//! The picture as a texture: drawn only where something changed, shown as an image.
//!
//! - What is quick to draw is drawn at once, all its pixels.
//! - What is slow is drawn with fewer pixels first, so that a hand can be followed. Once it rests, all pixels are drawn beside it,
//!   band after band, and shown when they are there: no single piece of work holds the device so long that the window stops, or
//!   that a driver gives up.
//! - While nothing changes, more pictures are drawn in the same way, each through other places of its pixels, and their mean is shown,
//!   until more would not be seen. Any change begins anew.

use super::log::Log;
use super::meter::{Finished, Meter, Piece, Timing};
use eframe::egui_wgpu::RenderState;
use std::sync::Arc;
use std::time::{Duration, Instant};
use surefoot_compiler::compiled::Camera;
use surefoot_runtime::film::{self, Film};
use surefoot_runtime::{Gpu, Picture, Stage, View};

/// What the window shows: egui takes textures whose colours are encoded.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

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
/// So many pictures become a still; fewer where they take longer than so many seconds, but not fewer than the second number.
const STILL: (u32, u32) = (256, 16);
const STILL_TAKES: f64 = 60.0;
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
    /// What is drawn on, of the same size.
    film: Option<Film>,
    /// How many rows of all pixels are drawn on the film; none where no such picture is begun.
    rows: Option<u32>,
    /// Bands since the last change.
    bands: u32,
    /// Where in its pixels the newest picture looks.
    sample: u32,
    /// The most pictures of a still.
    still: u32,
    /// Which part of the front's sides is drawn.
    part: [f32; 2],
    detail: f32,
    moved: Option<Instant>,
    meter: Meter,
    frames: u64,
    error: Option<String>,
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
            film: None,
            rows: None,
            bands: 0,
            sample: 0,
            still: STILL.0,
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
        self.detail == 1.0
    }

    /// How many pictures are in what is shown.
    pub fn samples(&self) -> u32 {
        self.film.as_ref().map_or(0, Film::count).max(u32::from(self.front.is_some()))
    }

    /// Lets a still be made of so many pictures.
    #[cfg(test)]
    pub fn set_still(&mut self, most: u32) {
        self.still = most;
    }

    /// How many pictures the still of this size is made of.
    fn wanted(&self, size: [u32; 2]) -> u32 {
        let takes = self.timing().per_pixel * f64::from(size[0]) * f64::from(size[1]);
        let in_time = if takes > 0.0 { (STILL_TAKES / takes) as u32 } else { u32::MAX };
        self.still.min(in_time.max(STILL.1))
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
                self.rows = None;
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
            match &mut self.film {
                Some(film) => film.resize(size)?,
                film => *film = Some(Film::new(&self.gpu, size, FORMAT)?),
            }
        }
        // With all pixels as they were drawn last, to learn whether anything changed; fewer are asked for below.
        let changed = stage.update(self.gpu.queue(), &view(order, size, self.sample)) || resized;
        if changed {
            self.begin_anew();
            self.choose_detail(order, size, rests);
            self.draw_whole(stage, order, size)?;
        }
        if self.is_sharp() && self.samples() >= self.wanted(size) {
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

    fn begin_anew(&mut self) {
        (self.rows, self.bands, self.sample, self.error) = (None, 0, 0, None);
        if let Some(film) = &mut self.film {
            film.clear();
        }
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
    fn draw_whole(&mut self, stage: &mut Stage, order: &Order, size: [u32; 2]) -> Result<(), String> {
        let fewer = size.map(|side| ((side as f32 * self.detail).round() as u32).max(1));
        stage.update(self.gpu.queue(), &view(order, fewer, self.sample));
        let piece = self.submit(stage, fewer, 0..fewer[1], true)?;
        if fewer != size {
            stage.update(self.gpu.queue(), &view(order, size, self.sample));
        }
        self.part = [0, 1].map(|i| fewer[i] as f32 / size[i] as f32);
        self.frames += 1;
        let finishes = Some(self.finished(order, fewer));
        self.meter.add(Piece { finishes, ..piece });
        Ok(())
    }

    /// Draws the next rows of all pixels; with the last of them the picture is shown, and counts where it is not the first.
    fn draw_band(&mut self, stage: &mut Stage, order: &Order, size: [u32; 2]) -> Result<(), String> {
        let Some(film) = &mut self.film else { return Ok(()) };
        let next = self.detail == 1.0;
        let first = self.rows.unwrap_or(0);
        if next && first == 0 {
            if let (0, Some(picture)) = (film.count(), stage.picture()) {
                // The first is still there.
                count(&self.gpu, film, picture)?;
            }
            self.sample = film.count();
            stage.update(self.gpu.queue(), &view(order, size, self.sample));
        }
        let row = self.timing().per_pixel * f64::from(size[0]);
        let band = (BANDS.0 * f64::from(1 << self.bands.min(10))).min(BANDS.1);
        let rows = if row > 0.0 { (band / row) as u32 } else { size[1] / 16 };
        let end = (first + rows.max(4)).min(size[1]);
        self.bands += 1;
        if end < size[1] {
            let piece = self.submit(stage, size, first..end, false)?;
            self.rows = Some(end);
            self.meter.add(piece);
            return Ok(());
        }
        let piece = self.submit(stage, size, first..end, true)?;
        self.rows = None;
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

    /// Orders some rows of a picture that has `size` pixels. The last of them show it; where others count already, it counts too.
    fn submit(&mut self, stage: &Stage, size: [u32; 2], rows: std::ops::Range<u32>, last: bool) -> Result<Piece, String> {
        let (Some(film), Some(front), Some(picture)) = (&mut self.film, &self.front, stage.picture()) else {
            return Err("there is nothing to draw on".to_owned());
        };
        let ordered = Instant::now();
        let pixels = u64::from(size[0]) * u64::from(rows.end.saturating_sub(rows.start));
        let gpu = &self.gpu;
        let submission = gpu.catch(|| {
            let mut encoder = gpu.device().create_command_encoder(&Default::default());
            film.draw(&mut encoder, picture, size, rows);
            if last && film.count() > 0 {
                film.keep(&mut encoder, picture);
            }
            if last {
                film.show(&mut encoder, picture, &front.texture);
            }
            gpu.queue().submit([encoder.finish()])
        })?;
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

/// Lets what is on the film count.
fn count(gpu: &Gpu, film: &mut Film, picture: &Picture) -> Result<(), String> {
    gpu.catch(|| {
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        film.keep(&mut encoder, picture);
        gpu.queue().submit([encoder.finish()]);
    })
}

/// The view of the sample of a number, of a picture of `size` pixels.
fn view(order: &Order, size: [u32; 2], sample: u32) -> View {
    View { camera: order.camera.sampled(sample), size: size.map(|side| side as f32), corner: film::offset(sample).map(|c| -c), sample }
}
