//! The picture as a file, drawn on another thread while the window goes on.

use crate::picture::{Device, NoPainter, Painter, Shot, write_png};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use surefoot_compiler::compiled::{Camera, Compiled, Live};
use surefoot_runtime::ViewMode;

/// Width and height of the picture, in pixels.
const SIZE: (u32, u32) = (1920, 1080);
/// The part that is done is told in so many parts.
const PARTS: f64 = 1000.0;

/// Work on another thread: where the picture was written, or why it was not; and the part that is done.
type Work = (Receiver<Result<PathBuf, String>>, Arc<AtomicU32>);

/// A picture that is being drawn.
#[derive(Default)]
pub struct Export {
    work: Option<Work>,
}

impl Export {
    /// Draws a scene as it is now, where nothing is being drawn for a file yet.
    pub fn begin(&mut self, scene: &Arc<Compiled>, live: &Live, camera: Camera, view: ViewMode, path: PathBuf, wake: impl FnOnce() + Send + 'static) {
        if self.work.is_some() {
            return;
        }
        let (scene, mut live) = (scene.clone(), live.clone());
        scene.settle(&mut live);
        let part = Arc::new(AtomicU32::new(0));
        let (sender, answer) = channel();
        let told = part.clone();
        let draw = move || {
            let tell = |done: f64| told.store((done * PARTS) as u32, Ordering::Relaxed);
            // The window may be closed by now.
            let _ = sender.send(draw(&scene, &live, camera, view, &tell).and_then(|rgba| write_png(&path, SIZE.0, SIZE.1, &rgba).map(|()| path)));
            wake();
        };
        // Where there can be no thread the sender is gone, and that is said.
        let _ = std::thread::Builder::new().name("surefoot export".to_owned()).spawn(draw);
        self.work = Some((answer, part));
    }

    /// How much of it is done, 0 to 1, where one is drawn.
    pub fn part(&self) -> Option<f32> {
        self.work.as_ref().map(|(_, part)| (f64::from(part.load(Ordering::Relaxed)) / PARTS) as f32)
    }

    /// What became of it, once.
    pub fn hear(&mut self) -> Option<String> {
        let (answer, _) = self.work.as_ref()?;
        let words = match answer.try_recv() {
            Err(TryRecvError::Empty) => return None,
            Ok(Ok(path)) => format!("The picture is in {}.", path.display()),
            Ok(Err(why)) => format!("The picture can't be written: {why}."),
            Err(TryRecvError::Disconnected) => "The picture can't be drawn.".to_owned(),
        };
        self.work = None;
        Some(words)
    }
}

fn draw(scene: &Compiled, live: &Live, camera: Camera, view: ViewMode, tell: &(dyn Fn(f64) + Sync)) -> Result<Vec<u8>, String> {
    let painter = Painter::new(Device::Auto, scene, view, None);
    let (mut painter, _) = painter.map_err(|why| match why {
        NoPainter::NoGraphics(words) | NoPainter::Refused(words) => words,
    })?;
    painter.paint(scene, live, &Shot { width: SIZE.0, height: SIZE.1, camera }, tell)
}
