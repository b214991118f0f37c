//! What each pass of a frame takes: measured on another thread, with a picture of its own, when a person asks for it.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use surefoot_compiler::compiled::{Compiled, Live};
use surefoot_runtime::explain::{Explained, explain};
use surefoot_runtime::headless::{Shot, format};
use surefoot_runtime::{Gpu, Picture, Showing};

/// What was found, or why nothing was.
type Found = Result<Explained, String>;

/// What is being measured, and what was.
#[derive(Default)]
pub struct Passes {
    work: Option<(Arc<Compiled>, Receiver<Found>)>,
    /// Of which scene, and what.
    pub found: Option<(Arc<Compiled>, Found)>,
}

impl Passes {
    /// Begins, where nothing is being measured. `done` is called at the end.
    pub fn begin(&mut self, gpu: &Gpu, scene: &Arc<Compiled>, live: &Live, showing: Showing, (width, height): (u32, u32), done: impl FnOnce() + Send + 'static) {
        if self.work.is_some() {
            return;
        }
        let (sender, answer) = channel();
        let (gpu, compiled, live) = (gpu.clone(), scene.clone(), live.clone());
        let find = move || {
            let mode = showing.view;
            let shot = Shot { mode, ..Shot::new(width.max(1), height.max(1)) };
            let found = Picture::prepare(&gpu, &compiled, format(&compiled, mode, 1), showing).and_then(|mut picture| explain(&gpu, &mut picture, &compiled, &live, &shot));
            // The window may be closed by now.
            let _ = sender.send(found);
            done();
        };
        // Where there can be no thread the sender is gone, and that is said.
        let _ = std::thread::Builder::new().name("surefoot passes".to_owned()).spawn(find);
        self.work = Some((scene.clone(), answer));
    }

    /// Whether they are being measured.
    pub fn is_busy(&self) -> bool {
        self.work.is_some()
    }

    /// Takes what is found.
    pub fn hear(&mut self) {
        let Some((scene, answer)) = self.work.take() else { return };
        match answer.try_recv() {
            Err(TryRecvError::Empty) => self.work = Some((scene, answer)),
            Ok(found) => self.found = Some((scene, found)),
            Err(TryRecvError::Disconnected) => self.found = Some((scene, Err("they could not be measured".to_owned()))),
        }
    }
}
