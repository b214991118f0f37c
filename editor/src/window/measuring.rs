//! What the scene measures: found on another thread, for the values and the moment at which it was asked.

use crate::measures::lines;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use surefoot_compiler::compiled::{Compiled, Live};
use surefoot_compiler::measure::{Settings, measure};

/// The part that is done is told in so many parts.
const PARTS: f64 = 1000.0;

/// The scene, its values and its moment.
#[derive(Clone)]
pub struct Taken {
    scene: Arc<Compiled>,
    live: Live,
}

impl Taken {
    /// Of which moment it is, in seconds.
    pub fn time(&self) -> f64 {
        self.live.time
    }

    /// Whether that is what is drawn now, but for the time.
    pub fn is_of(&self, scene: Option<&Arc<Compiled>>, live: Option<&Live>) -> bool {
        scene.is_some_and(|scene| Arc::ptr_eq(scene, &self.scene)) && live.is_some_and(|live| live.components == self.live.components)
    }
}

/// What was measured, line by line, or why nothing was.
pub type Found = Result<Vec<(String, String)>, String>;

/// Work on another thread.
struct Work {
    taken: Taken,
    part: Arc<AtomicU32>,
    answer: Receiver<Found>,
}

/// What is being measured, and what was.
#[derive(Default)]
pub struct Measuring {
    work: Option<Work>,
    /// What was measured last, and of what.
    pub found: Option<(Taken, Found)>,
}

impl Measuring {
    /// Begins, where nothing is being measured.
    pub fn begin(&mut self, scene: &Arc<Compiled>, live: &Live, walls: bool) {
        if self.work.is_some() {
            return;
        }
        let mut live = live.clone();
        scene.settle(&mut live);
        let taken = Taken { scene: scene.clone(), live };
        let part = Arc::new(AtomicU32::new(0));
        let (sender, answer) = channel();
        let (asked, heard) = (taken.clone(), part.clone());
        let find = move || {
            let settings = Settings { walls, ..Settings::default() };
            let found = measure(&asked.scene, &asked.live, &settings, &|part| heard.store((PARTS * part) as u32, Ordering::Relaxed));
            // The window may be closed by now.
            let _ = sender.send(found.map(|found| lines(&found, asked.scene.blocks.unit)).map_err(|why| why.to_string()));
        };
        // Where there can be no thread the sender is gone, and that is said.
        let _ = std::thread::Builder::new().name("surefoot measure".to_owned()).spawn(find);
        self.work = Some(Work { taken, part, answer });
    }

    /// Takes what is found.
    pub fn hear(&mut self) {
        let Some(work) = self.work.take() else { return };
        match work.answer.try_recv() {
            Err(TryRecvError::Empty) => self.work = Some(work),
            Ok(found) => self.found = Some((work.taken, found)),
            Err(TryRecvError::Disconnected) => self.found = Some((work.taken, Err("it could not be measured".to_owned()))),
        }
    }

    /// The part that is done of what is being measured.
    pub fn part(&self) -> Option<f32> {
        Some((f64::from(self.work.as_ref()?.part.load(Ordering::Relaxed)) / PARTS) as f32)
    }
}
