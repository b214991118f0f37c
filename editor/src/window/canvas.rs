//! The picture as a texture: drawn only where something changed, shown as an image.
//!
//! - What is quick to draw is drawn at once, all its pixels.
//! - What is slow is drawn with fewer pixels first, so that a hand can be followed. Once it rests, all pixels are drawn beside it, band after
//!   band, on another thread, and shown when they are there: no single piece of work holds the device so long that the window stops, or that a
//!   driver gives up.
//! - While nothing changes, more pictures are drawn in the same way, until more would not be seen ([`super::refine`]). Any change begins anew.

use super::log::Log;
use super::meter::{Finished, Piece, Timing, lock, watch};
use super::refine::{self, Job, Refiner, Sheet, view};
use eframe::egui_wgpu::RenderState;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use surefoot_compiler::compiled::Camera;
use surefoot_runtime::film::Film;
use surefoot_runtime::{Gpu, Stage};

/// What the window shows: egui takes textures whose colours are encoded.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// How long a picture may take while something moves, in seconds: at least the first, and as long as the window takes for all else, up
/// to the second.
const PATIENCE: (f64, f64) = (0.033, 0.1);
/// The same while keys arrive, which are to be seen at once.
const TYPING: f64 = 0.012;
/// How long a picture of something that rests may take in one piece, in seconds.
const AT_ONCE: f64 = 0.033;
/// How long nothing must move before all pixels are drawn.
const REST: Duration = Duration::from_millis(150);
/// So many pictures become a still, where they are soon drawn.
const STILL: u32 = 256;
/// Parts of the sides' pixels that are drawn.
const DETAILS: [f32; 6] = [1.0, 0.75, 0.5, 0.35, 0.25, 0.18];
/// The part that is drawn where nothing is known yet.
const UNKNOWN: f32 = 0.25;

/// The textures that the picture is drawn on.
pub struct Canvas {
    gpu: Gpu,
    render: RenderState,
    /// What is drawn at once, perhaps with fewer pixels, and the still, with all.
    targets: Option<[Target; 2]>,
    /// What is drawn on. None until there is a picture.
    sheet: Option<Arc<Mutex<Sheet>>>,
    refiner: Option<Refiner>,
    /// What the thread that makes stills begins with.
    log: Log,
    wake: Arc<dyn Fn() + Send + Sync>,
    /// The most pictures of a still.
    still: u32,
    /// Which part of the sides of what is drawn at once is drawn.
    part: [f32; 2],
    detail: f32,
    moved: Option<Instant>,
    /// When the last key came.
    key: Option<Instant>,
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
    /// A canvas on the window's device. `wake` is called when there is something new to show.
    pub fn new(gpu: Gpu, render: RenderState, log: Log, wake: Arc<dyn Fn() + Send + Sync>) -> Self {
        Self {
            gpu,
            render,
            targets: None,
            sheet: None,
            refiner: None,
            log,
            wake,
            still: STILL,
            part: [0.0; 2],
            detail: 1.0,
            moved: None,
            key: None,
            error: None,
        }
    }

    /// The device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// How long pictures took.
    pub fn timing(&self) -> Timing {
        self.refiner.as_ref().map(Refiner::timing).unwrap_or_default()
    }

    /// What went wrong when the newest picture was drawn.
    pub fn error(&self) -> Option<String> {
        self.error.clone().or_else(|| self.on_sheet(|sheet| sheet.error.clone())?)
    }

    /// Whether all pixels of the newest picture are shown.
    pub fn is_sharp(&self) -> bool {
        self.detail == 1.0 || self.on_sheet(|sheet| sheet.shown > 0) == Some(true)
    }

    /// How many pictures are in what is shown.
    pub fn samples(&self) -> u32 {
        self.on_sheet(|sheet| sheet.shown.max(1)).unwrap_or_default()
    }

    /// Whether the picture becomes no better as long as nothing changes.
    pub fn is_done(&self) -> bool {
        let size = self.targets.as_ref().map(|[target, _]| [target.texture.width(), target.texture.height()]);
        self.is_sharp() && size.is_some_and(|size| self.samples() >= self.wanted(size))
    }

    /// Hears that a key arrives: what is drawn for it comes first.
    pub fn yields(&mut self) {
        self.key = Some(Instant::now());
        if let Some(sheet) = &self.sheet {
            lock(sheet).key = self.key;
        }
    }

    fn on_sheet<T>(&self, read: impl FnOnce(&Sheet) -> T) -> Option<T> {
        self.sheet.as_ref().map(|sheet| read(&lock(sheet)))
    }

    /// Lets a still be made of so many pictures.
    pub fn set_still(&mut self, most: u32) {
        self.still = most;
        if let Some(sheet) = &self.sheet {
            // One that is being made is given up.
            lock(sheet).turn += 1;
        }
    }

    /// How many pictures the still of this size is made of.
    fn wanted(&self, size: [u32; 2]) -> u32 {
        refine::wanted(&self.timing(), size, self.still)
    }

    /// How many pictures were drawn.
    pub fn frames(&self) -> u64 {
        self.on_sheet(|sheet| sheet.frames).unwrap_or_default()
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
                self.shown(None)
            }
        }
    }

    fn shown(&self, again: Option<Duration>) -> Option<Shown> {
        let [whole, still] = self.targets.as_ref()?;
        let is_still = self.on_sheet(|sheet| sheet.shown > 0) == Some(true);
        let (target, part) = if is_still { (still, [1.0; 2]) } else { (whole, self.part) };
        let uv = egui::Rect::from_min_size(egui::Pos2::ZERO, part.into());
        // A part of nothing was never drawn.
        (part != [0.0; 2]).then_some(Shown { texture: target.id, uv, again })
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
        let shared = self.sheet()?;
        let mut sheet = lock(&shared);
        let fits = |[t, _]: &[Target; 2]| [t.texture.width(), t.texture.height()] == size;
        let resized = !self.targets.as_ref().is_some_and(fits);
        if resized {
            sheet.begin_anew();
            sheet.film.resize(size)?;
            let [whole, still] = self.targets.take().map_or([None, None], |targets| targets.map(Some));
            self.targets = Some([self.register(size, whole, wgpu::FilterMode::Linear)?, self.register(size, still, wgpu::FilterMode::Nearest)?]);
        }
        // With all pixels as they were drawn last, to learn whether anything changed; fewer are asked for below.
        let changed = stage.update(self.gpu.queue(), &view(order.camera, size, sheet.aim)) || resized;
        if changed {
            sheet.begin_anew();
            self.error = None;
            self.choose_detail(order, size, rests);
            self.draw_whole(&mut sheet, stage, order, size)?;
        }
        let is_done = (sheet.shown > 0 || self.detail == 1.0) && sheet.shown.max(1) >= self.wanted(size);
        if is_done || self.error.is_some() {
            return Ok(None);
        }
        if !rests {
            return Ok(Some(REST - moved));
        }
        let is_ordered = sheet.ordered == Some(sheet.turn);
        if let (false, Some(refiner), Some([_, still])) = (is_ordered, &self.refiner, &self.targets)
            && let (Some(picture), Some(compiled), Some(live)) = (stage.picture(), stage.scene(), stage.live())
        {
            sheet.ordered = Some(sheet.turn);
            refiner.refine(Job {
                turn: sheet.turn,
                picture: picture.clone(),
                compiled: compiled.clone(),
                live: live.clone(),
                camera: order.camera,
                size,
                target: still.texture.clone(),
                most: self.still,
                swaps: order.swaps,
            });
        }
        Ok(None)
    }

    /// What is drawn on, and the thread that makes stills of it; both begin with the first picture.
    fn sheet(&mut self) -> Result<Arc<Mutex<Sheet>>, String> {
        if let Some(sheet) = &self.sheet {
            return Ok(sheet.clone());
        }
        let mut sheet = Sheet::new(Film::new(&self.gpu, [1, 1], FORMAT)?);
        sheet.key = self.key;
        let sheet = Arc::new(Mutex::new(sheet));
        self.refiner = Some(Refiner::start(self.gpu.clone(), sheet.clone(), self.log.clone(), self.wake.clone()));
        self.sheet = Some(sheet.clone());
        Ok(sheet)
    }

    /// Decides how many pixels are drawn at once.
    fn choose_detail(&mut self, order: &Order, size: [u32; 2], rests: bool) {
        let per_pixel = self.timing().per_pixel;
        if per_pixel == 0.0 {
            self.detail = UNKNOWN;
            return;
        }
        let whole = per_pixel * f64::from(size[0]) * f64::from(size[1]);
        let types = self.key.is_some_and(|key| key.elapsed() < REST);
        if rests && whole <= if types { TYPING } else { AT_ONCE } {
            self.detail = 1.0;
            return;
        }
        let expected = |detail: f32| whole * f64::from(detail * detail);
        let patience = if types { TYPING } else { (0.5 * order.interval).clamp(PATIENCE.0, PATIENCE.1) };
        // What is not far off stays, so that the picture does not flicker between two.
        let (takes, largest) = (expected(self.detail), self.detail == 1.0);
        if takes > 1.4 * patience || (takes < 0.5 * patience && !largest) {
            let fits = |detail: &&f32| expected(**detail) <= patience;
            self.detail = *DETAILS.iter().find(fits).unwrap_or(&0.18);
        }
    }

    /// Draws the picture as far as the detail goes, and shows it.
    fn draw_whole(&mut self, sheet: &mut Sheet, stage: &mut Stage, order: &Order, size: [u32; 2]) -> Result<(), String> {
        let fewer = size.map(|side| ((side as f32 * self.detail).round() as u32).max(1));
        stage.update(self.gpu.queue(), &view(order.camera, fewer, sheet.aim));
        let (Some([whole, _]), Some(picture)) = (&self.targets, stage.picture().cloned()) else {
            return Err("there is nothing to draw on".to_owned());
        };
        let ordered = Instant::now();
        let gpu = &self.gpu;
        let done = gpu.catch(|| {
            let mut encoder = gpu.device().create_command_encoder(&Default::default());
            let picture = lock(&picture);
            sheet.film.draw(&mut encoder, &picture, fewer, 0..fewer[1]);
            sheet.film.show(&mut encoder, &picture, &whole.texture);
            gpu.queue().submit([encoder.finish()]);
            watch(gpu)
        })?;
        if fewer != size {
            stage.update(self.gpu.queue(), &view(order.camera, size, sheet.aim));
        }
        sheet.first = fewer == size;
        sheet.frames += 1;
        self.part = [0, 1].map(|i| fewer[i] as f32 / size[i] as f32);
        if let Some(refiner) = &self.refiner {
            let finishes = Some(Finished { frame: sheet.frames, size: fewer.into(), swaps: order.swaps });
            let pixels = u64::from(fewer[0]) * u64::from(fewer[1]);
            refiner.measure(Piece { done, ordered, pixels, begins: true, finishes });
        }
        Ok(())
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

    /// Makes a texture of this size that egui knows, under the name of an old one where there is one.
    fn register(&self, size: [u32; 2], old: Option<Target>, filter: wgpu::FilterMode) -> Result<Target, String> {
        let texture = self.texture(size)?;
        let view = texture.create_view(&Default::default());
        let device = self.gpu.device();
        let mut renderer = self.render.renderer.write();
        let id = match old {
            Some(old) => {
                renderer.update_egui_texture_from_wgpu_texture(device, &view, filter, old.id);
                old.id
            }
            None => renderer.register_native_texture(device, &view, filter),
        };
        Ok(Target { texture, id })
    }
}
