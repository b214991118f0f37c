//! How long pictures take. That is known only when they are done.

use super::log::Log;
use serde_json::json;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use surefoot_runtime::Gpu;

/// How long pictures took.
#[derive(Clone, Copy, Debug, Default)]
pub struct Timing {
    /// The last one, without what it had to wait for.
    pub frame: Duration,
    /// Its width and height in pixels.
    pub size: (u32, u32),
    /// A pixel of the last ones, in seconds; 0 while nothing is known.
    pub per_pixel: f64,
    /// What the pieces of a picture took that is not finished.
    so_far: Duration,
}

/// A picture, or a piece of one, that is being drawn.
#[derive(Debug)]
pub struct Piece {
    /// Whether the device is done with it.
    pub done: Arc<AtomicBool>,
    /// When it was ordered.
    pub ordered: Instant,
    /// How many pixels it has.
    pub pixels: u64,
    /// Whether a picture begins with it: of one that was given up nothing counts.
    pub begins: bool,
    /// The picture that is whole with it.
    pub finishes: Option<Finished>,
}

/// A picture that is whole.
#[derive(Clone, Copy, Debug)]
pub struct Finished {
    /// Its number.
    pub frame: u64,
    /// Its width and height in pixels.
    pub size: (u32, u32),
    /// How many scenes were put on before it.
    pub swaps: u64,
}

/// What measures, piece after piece.
pub struct Meter {
    gpu: Gpu,
    log: Log,
    timing: Arc<Mutex<Timing>>,
    before: Option<Instant>,
}

/// How long it sleeps while a piece is drawn.
const NAP: Duration = Duration::from_micros(500);

impl Meter {
    /// Measures what a device draws.
    pub fn new(gpu: Gpu, log: Log, timing: Arc<Mutex<Timing>>) -> Self {
        Self { gpu, log, timing, before: None }
    }

    /// Waits for a piece, and answers how long it took.
    pub fn measure(&mut self, piece: &Piece) -> Duration {
        let is_done = self.wait(&piece.done);
        let now = Instant::now();
        // What had to wait for the piece before it began when that one was done.
        let began = self.before.map_or(piece.ordered, |before| before.max(piece.ordered));
        let took = now.duration_since(began);
        self.before = Some(now);
        let mut timing = lock(&self.timing);
        if is_done {
            note(&mut timing, piece, took);
        }
        let frame = timing.frame;
        drop(timing);
        if let Some(finished) = piece.finishes {
            let built = self.gpu.stats();
            self.log.event(
                "frame",
                json!({
                    "frame": finished.frame,
                    "swaps": finished.swaps,
                    "ms": frame.as_secs_f64() * 1e3,
                    "width": finished.size.0,
                    "height": finished.size.1,
                    "pipelines": built.pipelines,
                    "modules": built.modules,
                }),
            );
        }
        took
    }

    /// Asks again and again: while one thread waits within the device, no other can present the window.
    fn wait(&self, done: &AtomicBool) -> bool {
        while !done.load(Ordering::Acquire) {
            if self.gpu.device().poll(wgpu::PollType::Poll).is_err() {
                return false;
            }
            std::thread::sleep(NAP);
        }
        true
    }
}

/// What becomes true once the device is done with all that was submitted so far.
pub fn watch(gpu: &Gpu) -> Arc<AtomicBool> {
    let done = Arc::<AtomicBool>::default();
    let heard = done.clone();
    gpu.queue().on_submitted_work_done(move || heard.store(true, Ordering::Release));
    done
}

fn note(timing: &mut Timing, piece: &Piece, took: Duration) {
    let per_pixel = took.as_secs_f64() / piece.pixels.max(1) as f64;
    let old = timing.per_pixel;
    timing.per_pixel = if old == 0.0 { per_pixel } else { 0.5 * (old + per_pixel) };
    timing.so_far = if piece.begins { took } else { timing.so_far + took };
    if let Some(finished) = piece.finishes {
        timing.frame = std::mem::take(&mut timing.so_far);
        timing.size = finished.size;
    }
}

/// What several threads share, also where one of them panicked.
pub fn lock<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}
