//! The picture as a file, or a film or a sequence of pictures along the timeline, drawn on another thread while the window goes on.

use crate::animation::{Animation, Format, numbered};
use crate::picture::{Device, NoPainter, Painter, Shot, write_png};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use surefoot_compiler::compiled::{Camera, Compiled, Live};
use surefoot_runtime::ViewMode;

/// Pictures a second of a film or a sequence.
const RATE: f64 = 30.0;
/// The part that is done is told in so many parts.
const PARTS: f64 = 1000.0;

/// What is to be written, and how large.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// Whether each picture of the timeline gets a file of its own.
    pub each: bool,
}

/// What is drawn.
pub struct Scene {
    /// The scene.
    pub compiled: Arc<Compiled>,
    /// Its values now.
    pub live: Live,
    /// Where a hand has put the camera.
    pub moved: Option<Camera>,
    /// The scene's camera that is used elsewhere; its first where there is none.
    pub camera: Option<String>,
    /// What the picture shows.
    pub view: ViewMode,
    /// How long the timeline is, in seconds.
    pub length: f64,
}

/// Work on another thread.
struct Work {
    /// What was written, or why it was not; nothing where it was cancelled.
    answer: Receiver<Result<Option<String>, String>>,
    part: Arc<AtomicU32>,
    cancelled: Arc<AtomicBool>,
}

/// A file that is being drawn.
#[derive(Default)]
pub struct Export {
    work: Option<Work>,
}

/// Says why a file can't hold what is asked for.
pub fn refuses(path: &Path, wanted: Wanted) -> Option<String> {
    Format::of(path)?.refuses(wanted.size, RATE).map(|words| words.split(": write").next().unwrap_or_default().to_owned())
}

impl Export {
    /// Draws a scene, where nothing is being drawn for a file yet.
    pub fn begin(&mut self, scene: Scene, wanted: Wanted, path: PathBuf, wake: impl FnOnce() + Send + 'static) {
        if self.work.is_some() {
            return;
        }
        let (part, cancelled) = (Arc::new(AtomicU32::new(0)), Arc::new(AtomicBool::new(false)));
        let (sender, answer) = channel();
        let (told, given_up) = (part.clone(), cancelled.clone());
        let draw = move || {
            let tell = |done: f64| told.store((done * PARTS) as u32, Ordering::Relaxed);
            // The window may be closed by now.
            let _ = sender.send(draw(scene, wanted, &path, &tell, &given_up));
            wake();
        };
        // Where there can be no thread the sender is gone, and that is said.
        let _ = std::thread::Builder::new().name("surefoot export".to_owned()).spawn(draw);
        self.work = Some(Work { answer, part, cancelled });
    }

    /// Ends it after the picture that is being drawn.
    pub fn cancel(&self) {
        if let Some(work) = &self.work {
            work.cancelled.store(true, Ordering::Relaxed);
        }
    }

    /// How much of it is done, 0 to 1, where something is drawn.
    pub fn part(&self) -> Option<f32> {
        self.work.as_ref().map(|work| (f64::from(work.part.load(Ordering::Relaxed)) / PARTS) as f32)
    }

    /// What became of it, once.
    pub fn hear(&mut self) -> Option<String> {
        let words = match self.work.as_ref()?.answer.try_recv() {
            Err(TryRecvError::Empty) => return None,
            Ok(Ok(written)) => written,
            Ok(Err(why)) => Some(format!("The picture can't be written: {why}.")),
            Err(TryRecvError::Disconnected) => Some("The picture can't be drawn.".to_owned()),
        };
        self.work = None;
        words
    }
}

/// Draws one picture after the other, and answers what is to be said; nothing where it was cancelled.
fn draw(scene: Scene, wanted: Wanted, path: &Path, tell: &(dyn Fn(f64) + Sync), cancelled: &AtomicBool) -> Result<Option<String>, String> {
    let Scene { compiled, mut live, moved, camera, view, length } = scene;
    compiled.settle(&mut live);
    let (width, height) = wanted.size;
    let format = Format::of(path);
    let count = if format.is_some() || wanted.each { (length * RATE).round().max(1.0) as u32 } else { 1 };
    let painter = Painter::new(Device::Auto, &compiled, view, live.section.map(|section| section.cut), None);
    let (mut painter, _) = painter.map_err(|why| match why {
        NoPainter::NoGraphics(words) | NoPainter::Refused(words) => words,
    })?;
    let mut film = format.map(|format| Animation::begin(path, format, wanted.size, RATE, count)).transpose()?;
    for n in 0..count {
        if cancelled.load(Ordering::Relaxed) {
            if film.take().is_some() {
                // Half a film is none.
                let _ = std::fs::remove_file(path);
            }
            return Ok(None);
        }
        if count > 1 {
            live.time = f64::from(n) / RATE;
        }
        let cameras = compiled.frame(&live).cameras;
        let own = cameras.iter().find(|(name, _)| Some(name) == camera.as_ref()).or(cameras.first());
        let wide = f64::from(width) / f64::from(height);
        let camera = moved.or(own.map(|(_, camera)| compiled.camera_in(*camera, wide))).ok_or("the scene has no camera")?;
        let part = |part: f64| tell((f64::from(n) + part) / f64::from(count));
        let rgba = painter.paint(&compiled, &live, &Shot::new((width, height), camera), &part)?;
        match &mut film {
            Some(film) => film.push(&rgba)?,
            None if wanted.each => write_png(&numbered(path, n), width, height, &rgba)?,
            None => write_png(path, width, height, &rgba)?,
        }
    }
    if let Some(film) = film {
        film.finish()?;
    }
    Ok(Some(match (format, wanted.each) {
        (Some(_), _) => format!("The film is in {}.", path.display()),
        (None, true) => format!("The pictures are in {} and after it.", numbered(path, 0).display()),
        (None, false) => format!("The picture is in {}.", path.display()),
    }))
}
