//! A scene that follows its files: watched, compiled and built on a thread of its own, handed over whole at a frame's boundary.
//!
//! - The newest finished scene wins; what nobody took before it is dropped.
//! - An error takes nothing away: the scene that was drawn last stays, and the diagnostics come.
//! - The last change is never lost: a change that comes while a compilation runs starts another after it, and once a second the files
//!   are looked at without having been told.
//! - A save is rarely one event. Events are gathered until they pause; an error in a file that changed just now is held back for a
//!   moment, because a file is often empty before it is full.

mod compilation;
mod overhear;
mod record;
mod rehearsal;
mod state;
mod watch;
mod worker;

pub use record::SharedLoader;
pub use state::{Compile, Ready, Report, Setup, Times, Update, Words, Work};
use state::{Shared, State};

use crate::view::Showing;
use std::sync::{Arc, Condvar, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use surefoot_compiler::compiled::Options;

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
                showing: setup.mode.into(),
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

    /// Compiles again although no file has changed: what the host gives to the compiler has.
    pub fn again(&self) {
        self.push(|state| state.anew = true);
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
    pub fn show(&self, showing: impl Into<Showing>) {
        let showing = showing.into();
        if self.shared.lock().showing != showing {
            self.push(|state| state.showing = showing);
        }
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

