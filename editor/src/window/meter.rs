//! How long pictures take. That is known only when they are done, and waiting for it would stop the window; so a thread waits.

use super::log::Log;
use serde_json::json;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use surefoot_runtime::Gpu;

/// How long pictures took.
#[derive(Clone, Copy, Debug, Default)]
pub struct Timing {
    /// The last one, from the order to its end.
    pub frame: Duration,
    /// Its width and height in pixels.
    pub size: (u32, u32),
    /// A pixel of the last ones, in seconds; 0 while nothing is known.
    pub per_pixel: f64,
    /// Pieces that are being drawn.
    pub in_flight: u32,
    /// What the pieces of a picture took that is not finished.
    so_far: Duration,
}

/// A picture, or a piece of one, that is being drawn.
#[derive(Debug)]
pub struct Piece {
    /// The work on the device.
    pub submission: wgpu::SubmissionIndex,
    /// When it was ordered.
    pub ordered: Instant,
    /// How many pixels it has.
    pub pixels: u64,
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

/// Measures on a thread of its own, which ends with it: a driver that is a program must not be asked while the process ends.
#[derive(Debug)]
pub struct Meter {
    timing: Arc<Mutex<Timing>>,
    /// None once it ends.
    pieces: Option<Sender<Piece>>,
    /// None where there could be no thread: then nothing is measured, and the pictures come all the same.
    thread: Option<JoinHandle<()>>,
}

impl Meter {
    /// Starts. `wake` is called when a piece is done.
    pub fn start(gpu: Gpu, log: Log, wake: Arc<dyn Fn() + Send + Sync>) -> Self {
        let timing = Arc::<Mutex<Timing>>::default();
        let (pieces, received) = channel();
        let shared = timing.clone();
        let wait = move || measure(&gpu, &received, &shared, &log, &*wake);
        let thread = std::thread::Builder::new().name("surefoot meter".to_owned()).spawn(wait).ok();
        Self { timing, pieces: Some(pieces), thread }
    }

    /// What is known so far.
    pub fn timing(&self) -> Timing {
        *lock(&self.timing)
    }

    /// Hears of a piece that is being drawn.
    pub fn add(&self, piece: Piece) {
        lock(&self.timing).in_flight += 1;
        if self.pieces.as_ref().is_none_or(|pieces| pieces.send(piece).is_err()) {
            // Nobody measures.
            lock(&self.timing).in_flight = 0;
        }
    }
}

impl Drop for Meter {
    fn drop(&mut self) {
        self.pieces = None;
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has said so already.
            let _ = thread.join();
        }
    }
}

/// Waits for one piece after another until there is no meter any more.
fn measure(
    gpu: &Gpu,
    pieces: &Receiver<Piece>,
    timing: &Mutex<Timing>,
    log: &Log,
    wake: &(dyn Fn() + Send + Sync),
) {
    let mut before: Option<Instant> = None;
    while let Ok(piece) = pieces.recv() {
        let submission_index = Some(piece.submission.clone());
        let wait = wgpu::PollType::Wait { submission_index, timeout: None };
        let waited = gpu.device().poll(wait);
        let now = Instant::now();
        // What had to wait for the piece before it began when that one was done.
        let began = before.map_or(piece.ordered, |before| before.max(piece.ordered));
        let took = now.duration_since(began);
        before = Some(now);
        let mut timing = lock(timing);
        timing.in_flight = timing.in_flight.saturating_sub(1);
        if waited.is_ok() {
            note(&mut timing, &piece, took);
        }
        let frame = timing.frame;
        drop(timing);
        if let Some(finished) = piece.finishes {
            let built = gpu.stats();
            log.event(
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
        wake();
    }
}

fn note(timing: &mut Timing, piece: &Piece, took: Duration) {
    let per_pixel = took.as_secs_f64() / piece.pixels.max(1) as f64;
    let old = timing.per_pixel;
    timing.per_pixel = if old == 0.0 { per_pixel } else { 0.5 * (old + per_pixel) };
    timing.so_far += took;
    if let Some(finished) = piece.finishes {
        timing.frame = std::mem::take(&mut timing.so_far);
        timing.size = finished.size;
    }
}

fn lock(timing: &Mutex<Timing>) -> MutexGuard<'_, Timing> {
    timing.lock().unwrap_or_else(PoisonError::into_inner)
}
