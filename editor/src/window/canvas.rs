//! The picture as a texture: drawn only where something changed, shown as an image.
//!
//! - While something moves that is slow to draw, fewer pixels are drawn, so that it can be followed; once it rests, all of them.
//! - How long a picture takes is known only when it is done, and waiting for it would stop the window; a thread waits.

use super::log::Log;
use super::world::FORMAT;
use eframe::egui_wgpu::RenderState;
use serde_json::json;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use surefoot_compiler::compiled::Camera;
use surefoot_runtime::{Gpu, Stage, View};

/// How long a picture may take while something moves: at least the first, and as long as the window takes for all else, up to the second.
const PATIENCE: (f64, f64) = (0.033, 0.1);
/// How long nothing must move before all pixels are drawn.
const REST: Duration = Duration::from_millis(150);
/// Parts of the sides' pixels that are drawn.
const DETAILS: [f32; 6] = [1.0, 0.75, 0.5, 0.35, 0.25, 0.18];

/// The texture that the picture is drawn on.
pub struct Canvas {
    gpu: Gpu,
    render: RenderState,
    target: Option<Target>,
    detail: f32,
    moved: Option<Instant>,
    meter: Arc<Mutex<Timing>>,
    probes: Sender<Probe>,
    frames: u64,
}

struct Target {
    texture: wgpu::Texture,
    id: egui::TextureId,
}

/// How long pictures took.
#[derive(Clone, Copy, Debug, Default)]
pub struct Timing {
    /// The last one.
    pub frame: Duration,
    /// Its width and height in pixels.
    pub size: (u32, u32),
    /// A pixel of the last ones, in seconds.
    per_pixel: f64,
}

/// A picture that is being drawn.
struct Probe {
    submission: wgpu::SubmissionIndex,
    ordered: Instant,
    size: (u32, u32),
    frame: u64,
    swaps: u64,
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
        let meter = Arc::<Mutex<Timing>>::default();
        let (probes, received) = channel();
        let (device, timing, stats) = (gpu.clone(), meter.clone(), gpu.clone());
        let waiter = move || {
            measure(&device, &received, &timing, &|probe, took| {
                let built = stats.stats();
                log.event(
                    "frame",
                    json!({
                        "frame": probe.frame,
                        "swaps": probe.swaps,
                        "ms": took.as_secs_f64() * 1e3,
                        "width": probe.size.0,
                        "height": probe.size.1,
                        "pipelines": built.pipelines,
                        "modules": built.modules,
                    }),
                );
                wake();
            })
        };
        // Without the thread nothing is measured; the pictures come all the same.
        std::thread::Builder::new().name("surefoot meter".to_owned()).spawn(waiter).ok();
        Self { gpu, render, target: None, detail: 1.0, moved: None, meter, probes, frames: 0 }
    }

    /// How long pictures took.
    pub fn timing(&self) -> Timing {
        *lock(&self.meter)
    }

    /// Which part of the sides' pixels was drawn last.
    pub fn detail(&self) -> f32 {
        self.detail
    }

    /// How many pictures were drawn.
    #[cfg(test)]
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// Draws if anything changed, and answers what to show.
    pub fn draw(&mut self, stage: &mut Stage, order: &Order) -> Result<Option<Shown>, String> {
        if stage.picture().is_none() {
            return Ok(None);
        }
        let limit = self.gpu.device().limits().max_texture_dimension_2d;
        let full = order.size.map(|side| side.clamp(1, limit));
        let again = self.choose_detail(order, full);
        let size = full.map(|side| ((side as f32 * self.detail).round() as u32).max(1));
        let fresh = self.fit(full)?;
        let Some(target) = &self.target else { return Ok(None) };
        let view =
            View { camera: order.camera, size: size.map(|side| side as f32), corner: [0.0; 2] };
        if stage.update(self.gpu.queue(), &view) || fresh {
            let ordered = Instant::now();
            let submission = self.gpu.catch(|| submit(&self.gpu, stage, &target.texture, size))?;
            self.frames += 1;
            let probe = Probe {
                submission,
                ordered,
                size: (size[0], size[1]),
                frame: self.frames,
                swaps: order.swaps,
            };
            // Where the thread is gone, nothing is measured.
            self.probes.send(probe).ok();
        }
        let part = egui::vec2(size[0] as f32 / full[0] as f32, size[1] as f32 / full[1] as f32);
        let uv = egui::Rect::from_min_size(egui::Pos2::ZERO, part);
        Ok(Some(Shown { texture: target.id, uv, again }))
    }

    /// Decides how many pixels are drawn; answers when to decide again, where it is not all of them.
    fn choose_detail(&mut self, order: &Order, full: [u32; 2]) -> Option<Duration> {
        let now = Instant::now();
        if order.moving {
            self.moved = Some(now);
        }
        let rest = self.moved.map_or(REST, |moved| now.duration_since(moved));
        if rest >= REST {
            self.detail = 1.0;
            return None;
        }
        let whole = self.timing().per_pixel * f64::from(full[0]) * f64::from(full[1]);
        let expected = |detail: f32| whole * f64::from(detail * detail);
        let patience = (0.5 * order.interval).clamp(PATIENCE.0, PATIENCE.1);
        // What is not far off stays, so that the picture does not flicker between two.
        let (now_takes, largest) = (expected(self.detail), self.detail == 1.0);
        if now_takes > 1.4 * patience || (now_takes < 0.5 * patience && !largest) {
            let fits = |detail: &&f32| expected(**detail) <= patience;
            self.detail = *DETAILS.iter().find(fits).unwrap_or(&0.18);
        }
        (self.detail < 1.0).then(|| REST - rest)
    }

    /// Makes the texture as large as the panel; answers whether it is a new one.
    fn fit(&mut self, size: [u32; 2]) -> Result<bool, String> {
        let known = self.target.as_ref().map(|t| [t.texture.width(), t.texture.height()]);
        if known == Some(size) {
            return Ok(false);
        }
        let texture = self.gpu.catch(|| {
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
        })?;
        let view = texture.create_view(&Default::default());
        let device = self.gpu.device();
        let mut renderer = self.render.renderer.write();
        let filter = wgpu::FilterMode::Linear;
        let id = match &self.target {
            Some(old) => {
                renderer.update_egui_texture_from_wgpu_texture(device, &view, filter, old.id);
                old.id
            }
            None => renderer.register_native_texture(device, &view, filter),
        };
        drop(renderer);
        self.target = Some(Target { texture, id });
        Ok(true)
    }
}

fn submit(
    gpu: &Gpu,
    stage: &Stage,
    texture: &wgpu::Texture,
    size: [u32; 2],
) -> wgpu::SubmissionIndex {
    let mut encoder = gpu.device().create_command_encoder(&Default::default());
    let view = texture.create_view(&Default::default());
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("surefoot"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                store: wgpu::StoreOp::Store,
            },
        })],
        ..Default::default()
    });
    pass.set_viewport(0.0, 0.0, size[0] as f32, size[1] as f32, 0.0, 1.0);
    if let Some(picture) = stage.picture() {
        picture.draw(&mut pass);
    }
    drop(pass);
    gpu.queue().submit([encoder.finish()])
}

/// Waits for one picture after another until there is no canvas any more.
fn measure(
    gpu: &Gpu,
    probes: &Receiver<Probe>,
    timing: &Mutex<Timing>,
    done: &dyn Fn(&Probe, Duration),
) {
    let mut before: Option<Instant> = None;
    while let Ok(probe) = probes.recv() {
        let wait = wgpu::PollType::Wait {
            submission_index: Some(probe.submission.clone()),
            timeout: None,
        };
        if gpu.device().poll(wait).is_err() {
            continue;
        }
        let now = Instant::now();
        // A picture that had to wait for the one before it began when that one was done.
        let began = before.map_or(probe.ordered, |before| before.max(probe.ordered));
        let took = now.duration_since(began);
        before = Some(now);
        let mut timing_now = lock(timing);
        let pixels = f64::from(probe.size.0) * f64::from(probe.size.1);
        let per_pixel = took.as_secs_f64() / pixels.max(1.0);
        let old = timing_now.per_pixel;
        timing_now.per_pixel = if old == 0.0 { per_pixel } else { 0.5 * (old + per_pixel) };
        timing_now.frame = took;
        timing_now.size = probe.size;
        drop(timing_now);
        done(&probe, took);
    }
}

fn lock(timing: &Mutex<Timing>) -> MutexGuard<'_, Timing> {
    timing.lock().unwrap_or_else(PoisonError::into_inner)
}
