//! What the threads of a live scene hand to each other.

use super::record::{self, SharedLoader};
use crate::frame::Picture;
use crate::gpu::Gpu;
use crate::passes::scene::ViewMode;
use crate::physics::{Contact, Passes};
use crate::view::Showing;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use surefoot_compiler::compiled::{Compiled, Loader, Options, Outcome};
use surefoot_compiler::diagnostic::Diagnostic;
use surefoot_compiler::source::Sources;

/// From a file's name to a scene: the compiler.
pub type Compile = dyn Fn(&dyn Loader, &str, &Options) -> Outcome + Send + Sync;

/// What to follow, and with what.
#[derive(Clone)]
pub struct Setup {
    /// The scene's file.
    pub path: String,
    /// What the module shall hold.
    pub options: Options,
    /// Reads files. Files of these names on the disk are watched.
    pub loader: SharedLoader,
    /// The compiler.
    pub compile: Arc<Compile>,
    /// On what pipelines are built, and the format that they draw on. None: scenes are compiled and not built.
    pub target: Option<(Gpu, wgpu::TextureFormat)>,
    /// What the pictures show at first.
    pub mode: ViewMode,
    /// Called from the worker's thread when there is something to [`LiveScene::poll`], or other work is begun: wakes the window.
    pub wake: Arc<dyn Fn() + Send + Sync>,
}

/// A scene that compiled, and what draws it.
#[derive(Debug)]
pub struct Ready {
    /// The scene.
    pub compiled: Arc<Compiled>,
    /// What draws it, where there is a device.
    pub picture: Option<Picture>,
    /// What moves its balls, where there are some and a device.
    pub balls: Option<(Arc<Passes>, Contact)>,
}

/// How long things took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Times {
    /// The compiler.
    pub compile: Duration,
    /// naga and the driver, up to the first pixel.
    pub pipeline: Duration,
    /// From the first sign of a change until the scene was ready to be taken.
    pub total: Duration,
}

/// What is being done for a change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Work {
    /// The compiler runs.
    Compiling,
    /// naga and the driver make the picture.
    Building,
}

/// What the compiler says of a text.
#[derive(Clone, Debug, Default)]
pub struct Words {
    /// All texts, for the diagnostics.
    pub sources: Sources,
    /// Errors and warnings.
    pub diagnostics: Vec<Diagnostic>,
    /// Every file that is read or looked for, the scene's own first.
    pub files: Vec<String>,
}

impl Words {
    /// What an outcome says, and the scene where there is one.
    pub(super) fn of(outcome: Outcome, recorder: &record::Recorder) -> (Self, Option<Compiled>) {
        let Outcome { sources, diagnostics, mut files, compiled } = outcome;
        for file in recorder.files() {
            if !files.contains(&file) {
                files.push(file);
            }
        }
        (Self { sources, diagnostics, files }, compiled)
    }
}

/// What came of a change.
#[derive(Debug)]
pub struct Update {
    /// What the compiler says of the newest text.
    pub words: Arc<Words>,
    /// What went wrong behind the compiler: the device refused the module, or there is a mistake in Surefoot. For people.
    pub failure: Option<String>,
    /// The newest scene that could be built since the last update, if one could. Without one, keep the last.
    pub ready: Option<Ready>,
    /// How long the newest text took.
    pub times: Times,
}

/// What happened so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Report {
    /// Signs of change from the file system.
    pub events: u64,
    /// Texts and options that were pushed.
    pub pushes: u64,
    /// Runs of the compiler.
    pub compilations: u64,
    /// Outcomes handed over or replaced by a newer one.
    pub updates: u64,
    /// Outcomes that were replaced before anybody took them.
    pub replaced: u64,
}

/// What both threads and the watcher see.
pub(super) struct Shared {
    pub(super) state: Mutex<State>,
    pub(super) changed: Condvar,
}

impl Shared {
    pub(super) fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for a change, so long at most.
    pub(super) fn wait<'a>(&self, state: MutexGuard<'a, State>, time: Duration) -> MutexGuard<'a, State> {
        self.changed.wait_timeout(state, time).unwrap_or_else(PoisonError::into_inner).0
    }
}

#[derive(Default)]
pub(super) struct State {
    pub(super) path: String,
    pub(super) options: Options,
    pub(super) showing: Showing,
    /// Texts that are not on the disk.
    pub(super) texts: record::Texts,
    /// When the oldest change that is not yet worked on came.
    pub(super) asked: Option<Instant>,
    /// Whether one of those changes was pushed.
    pub(super) pushed: bool,
    /// Whether one of those changes was one of path or options: to be compiled even if every file is as it was.
    pub(super) anew: bool,
    /// When the newest event of the file system came.
    pub(super) last_event: Option<Instant>,
    pub(super) busy: bool,
    /// What is being done, and since when.
    pub(super) work: Option<(Work, Instant)>,
    /// The mesh that is being read.
    pub(super) loading: Option<String>,
    pub(super) stop: bool,
    pub(super) update: Option<Update>,
    /// What the compiler says of the newest text while a picture is being built, until somebody takes it.
    pub(super) words: Option<Arc<Words>>,
    /// Whether one is.
    pub(super) building: bool,
    /// What the compiler says of a text that is newer than the picture that is being built.
    pub(super) overheard: Option<Arc<Words>>,
    pub(super) report: Report,
}
