//! A scene that follows its files: watched, compiled and built on a thread of its own, handed over whole at a frame's boundary.
//!
//! - The newest finished scene wins; what nobody took before it is dropped.
//! - An error takes nothing away: the scene that was drawn last stays, and the diagnostics come.
//! - The last change is never lost: a change that comes while a compilation runs starts another after it, and once a second the files
//!   are looked at without having been told.
//! - A save is rarely one event. Events are gathered until they pause; an error in a file that changed just now is held back for a
//!   moment, because a file is often empty before it is full.

mod overhear;
mod record;
mod rehearsal;
mod watch;
mod worker;

use crate::frame::Picture;
use crate::gpu::Gpu;
use crate::passes::scene::ViewMode;
use crate::physics::{Contact, Passes};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use surefoot_compiler::compiled::{Compiled, Loader, Options, Outcome};
use surefoot_compiler::diagnostic::Diagnostic;
use surefoot_compiler::source::Sources;

/// From a file's name to a scene: the compiler.
pub type Compile = dyn Fn(&dyn Loader, &str, &Options) -> Outcome + Send + Sync;

/// Reads files, from any thread.
pub type SharedLoader = Arc<dyn Loader + Send + Sync>;

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
    fn of(outcome: Outcome, recorder: &record::Recorder) -> (Self, Option<Compiled>) {
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

/// A scene that follows its files. Ends its thread when it is dropped.
pub struct LiveScene {
    shared: Arc<Shared>,
    worker: Option<JoinHandle<()>>,
}

impl LiveScene {
    /// Starts to follow. Fails where no thread can be had.
    pub fn start(setup: Setup) -> Result<Self, String> {
        let shared = Arc::new(Shared {
            state: Mutex::new(State {
                path: setup.path.clone(),
                options: setup.options.clone(),
                mode: setup.mode,
                asked: Some(Instant::now()),
                ..State::default()
            }),
            changed: Condvar::new(),
        });
        let worker = worker::spawn(setup, shared.clone()).map_err(|e| e.to_string())?;
        Ok(Self { shared, worker: Some(worker) })
    }

    /// What came since the last call, if anything. Call it at a frame's boundary.
    pub fn poll(&self) -> Option<Update> {
        self.shared.lock().update.take()
    }

    /// What the compiler says of the newest text, once, while its picture, or that of an older text, is still being built: newer than what
    /// [`Self::poll`] has.
    pub fn poll_words(&self) -> Option<Arc<Words>> {
        self.shared.lock().words.take()
    }

    /// Gives a file a text that is not on the disk (an editor's), or takes it back. The name is the one that the compiler uses.
    pub fn set_text(&self, path: &str, text: Option<String>) {
        let name = record::plain(path);
        self.push(|state| {
            match text {
                Some(text) => state.texts.insert(name, text.into_bytes().into()),
                None => state.texts.remove(&name),
            };
        });
    }

    /// Follows another file.
    pub fn open(&self, path: &str) {
        self.push(|state| {
            state.anew |= state.path != path;
            path.clone_into(&mut state.path);
        });
    }

    /// Compiles with other options from now on.
    pub fn set_options(&self, options: Options) {
        self.push(|state| {
            state.anew |= state.options != options;
            state.options = options;
        });
    }

    /// Chooses for a parameter that chooses among names; this compiles again.
    pub fn choose(&self, parameter: &str, choice: &str) {
        self.push(|state| {
            let choices = &mut state.options.choose;
            let known = choices.iter().position(|(name, _)| name == parameter);
            let new = (parameter.to_owned(), choice.to_owned());
            match known.and_then(|at| choices.get_mut(at)) {
                Some(old) => {
                    state.anew |= *old != new;
                    *old = new;
                }
                None => {
                    choices.push(new);
                    state.anew = true;
                }
            }
        });
    }

    /// Shows something else of the scene. The pipeline for it is built like any other: the old picture stays until it is ready. The
    /// compiler does not run.
    pub fn set_mode(&self, mode: ViewMode) {
        self.push(|state| state.mode = mode);
    }

    /// Whether a change is being worked on.
    pub fn is_busy(&self) -> bool {
        let state = self.shared.lock();
        state.busy || state.asked.is_some()
    }

    /// What is being done just now, and for how long: until it is done the last picture is not that of the text.
    pub fn work(&self) -> Option<(Work, Duration)> {
        self.shared.lock().work.map(|(work, since)| (work, since.elapsed()))
    }

    /// Which mesh is being read just now, and how many there are, for people.
    pub fn loading(&self) -> Option<String> {
        self.shared.lock().loading.clone()
    }

    /// What happened so far.
    pub fn report(&self) -> Report {
        self.shared.lock().report
    }

    fn push(&self, change: impl FnOnce(&mut State)) {
        let mut state = self.shared.lock();
        change(&mut state);
        state.asked.get_or_insert_with(Instant::now);
        state.pushed = true;
        state.report.pushes += 1;
        self.shared.changed.notify_all();
    }
}

impl Drop for LiveScene {
    fn drop(&mut self) {
        self.shared.lock().stop = true;
        self.shared.changed.notify_all();
        if let Some(worker) = self.worker.take() {
            // A worker that panicked has said so already.
            let _ = worker.join();
        }
    }
}

/// What both threads and the watcher see.
struct Shared {
    state: Mutex<State>,
    changed: Condvar,
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[derive(Default)]
struct State {
    path: String,
    options: Options,
    mode: ViewMode,
    /// Texts that are not on the disk.
    texts: record::Texts,
    /// When the oldest change that is not yet worked on came.
    asked: Option<Instant>,
    /// Whether one of those changes was pushed.
    pushed: bool,
    /// Whether one of those changes was one of path or options: to be compiled even if every file is as it was.
    anew: bool,
    /// When the newest event of the file system came.
    last_event: Option<Instant>,
    busy: bool,
    /// What is being done, and since when.
    work: Option<(Work, Instant)>,
    /// The mesh that is being read.
    loading: Option<String>,
    stop: bool,
    update: Option<Update>,
    /// What the compiler says of the newest text while a picture is being built, until somebody takes it.
    words: Option<Arc<Words>>,
    /// Whether one is.
    building: bool,
    /// What the compiler says of a text that is newer than the picture that is being built.
    overheard: Option<Arc<Words>>,
    report: Report,
}
