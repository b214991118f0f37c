//! What the session reaches outside of itself: the compiler on its thread, the disk, the log.

use super::command::Command;
use super::document::Disk;
use super::kept::Keeper;
use super::log::Log;
use super::parts::Parts;
use super::recovery::Recovery;
use super::session::Session;
use serde_json::json;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use surefoot_compiler::compiled::{Loader, Options, Outcome};
use surefoot_compiler::source::Sources;
use surefoot_compiler::Memory;
use surefoot_runtime::film::LINEAR;
use surefoot_runtime::live::{LiveScene, Setup, SharedLoader, Work};
use surefoot_runtime::{Gpu, Stats, ViewMode};

/// What the session reaches outside of itself.
pub struct World {
    /// The compiler, which follows the scene's files.
    pub live: LiveScene,
    /// The scene's parts, as the compiler's thread finds and hides them.
    pub parts: Parts,
    /// What keeps unsaved texts.
    pub recovery: Recovery,
    /// What keeps the rest that comes back.
    pub keeper: Keeper,
    /// What happens, for whoever measures from outside.
    pub log: Log,
    /// Whether the window shall close without another question.
    pub close: bool,
    /// Files that are shown, each followed on its own: the compiler can't tell what the disk holds where it was lent another text.
    followed: Vec<(String, LiveScene)>,
    loader: SharedLoader,
    gpu: Option<Gpu>,
    wake: Arc<dyn Fn() + Send + Sync>,
}

impl World {
    /// Follows a scene. `wake` is called from other threads when there is something to hear.
    pub fn new(
        scene: &str,
        options: &Options,
        loader: SharedLoader,
        gpu: Option<Gpu>,
        recovery: Recovery,
        log: Log,
        wake: Arc<dyn Fn() + Send + Sync>,
    ) -> Result<Self, String> {
        let parts = Parts::default();
        let live = LiveScene::start(Setup {
            path: scene.to_owned(),
            options: options.clone(),
            loader: loader.clone(),
            compile: Arc::new(remembering(parts.clone())),
            target: gpu.clone().map(|gpu| (gpu, LINEAR)),
            mode: ViewMode::default(),
            wake: wake.clone(),
        })?;
        let keeper = Keeper::of(recovery.beside("window.json"));
        let mut world = Self { live, parts, recovery, keeper, log, close: false, followed: Vec::new(), loader, gpu, wake };
        world.follow(scene);
        Ok(world)
    }

    /// What the disk holds of a file.
    pub fn read(&self, path: &str) -> Disk {
        read(&*self.loader, path)
    }

    /// Tells of changes of a file from now on. A file that can't be followed is only looked at when it is saved.
    pub fn follow(&mut self, path: &str) {
        if self.followed.iter().any(|(known, _)| known == path) {
            return;
        }
        // The same thread, events and patience as for scenes, with a compiler that only reads.
        let started = LiveScene::start(Setup {
            path: path.to_owned(),
            options: Options::default(),
            loader: self.loader.clone(),
            compile: Arc::new(|loader: &dyn Loader, path: &str, _: &Options| {
                only_read(loader, path)
            }),
            target: None,
            mode: ViewMode::default(),
            wake: self.wake.clone(),
        });
        if let Ok(follower) = started {
            self.followed.push((path.to_owned(), follower));
        }
    }

    /// Tells no longer of changes of a file.
    pub fn unfollow(&mut self, path: &str) {
        self.followed.retain(|(known, _)| known != path);
    }

    /// Follows another scene, with what the text says instead of what a person chose.
    pub fn open(&mut self, path: &str, options: &mut Options) {
        self.followed.clear();
        self.follow(path);
        options.choose.clear();
        self.live.set_options(options.clone());
        self.live.open(path);
    }

    /// What came since the last call.
    pub fn hear(&self) -> Vec<Command> {
        let words = self.live.poll_words().map(Command::Said);
        let updates = self.live.poll().map(|update| Command::Arrived(Box::new(update)));
        let texts = self.followed.iter().filter_map(|(path, follower)| {
            let update = follower.poll()?;
            let read = update.words.sources.iter().next().map(|(_, file)| file.text.to_string());
            Some(Command::OnDisk(path.clone(), read.map_or_else(|| self.read(path), Disk::Text)))
        });
        // Words are of a newer text than what is shown.
        texts.chain(updates).chain(words).collect()
    }

    /// What is being done for the newest text, and for how long.
    pub fn work(&self) -> Option<(Work, Duration)> {
        self.live.work()
    }

    /// Which mesh is being read just now.
    pub fn loading(&self) -> Option<String> {
        self.live.loading()
    }

    /// Gives the compiler what was edited, after a pause.
    pub fn lend_edits(&self, session: &mut Session) {
        for document in &mut session.documents.all {
            if document.take_edits(Instant::now()) {
                document.lent = document.is_off_disk();
                self.live.set_text(&document.name, document.lent.then(|| document.text.clone()));
                self.log.event("edited", json!({ "file": document.name }));
            }
        }
    }

    /// Keeps what is not saved for the case that the program ends without a word; answers after what time it must be asked again.
    pub fn keep_unsaved(&mut self, session: &mut Session) -> Option<Duration> {
        // What a person has thrown away is not kept.
        if self.close {
            return None;
        }
        session.found.retain(|found| {
            let known = session.documents.all.iter().any(|d| found.is_of(&d.name) && !d.is_missing() && found.is_known(d));
            if known {
                self.recovery.remove(found);
            }
            !known
        });
        if let Some(why) = self.recovery.failure() {
            session.notice = Some(why);
        }
        self.recovery.follow(&session.documents.all, Instant::now())
    }

    /// What another thread calls where there is something to hear.
    pub fn waker(&self) -> impl Fn() + Send + 'static {
        let wake = self.wake.clone();
        move || wake()
    }

    /// The device.
    pub fn gpu(&self) -> Option<&Gpu> {
        self.gpu.as_ref()
    }

    /// What was built on the device so far.
    pub fn stats(&self) -> Stats {
        self.gpu.as_ref().map(Gpu::stats).unwrap_or_default()
    }
}

/// What the disk holds of a file.
pub fn read(loader: &dyn Loader, path: &str) -> Disk {
    match loader.read(path) {
        Ok(bytes) => String::from_utf8(bytes).map_or_else(|_| Disk::Unreadable("the text is not UTF-8".to_owned()), Disk::Text),
        Err(_) if !Path::new(path).exists() => Disk::Gone,
        Err(why) => Disk::Unreadable(why),
    }
}

/// The compiler, with what it found before: an edit costs what it changed.
fn remembering(parts: Parts) -> impl Fn(&dyn Loader, &str, &Options) -> Outcome {
    let memory = Mutex::new(Memory::default());
    move |loader, path, options| {
        let mut memory = memory.lock().unwrap_or_else(PoisonError::into_inner);
        parts.compile(loader, path, options, &mut memory)
    }
}

/// An outcome that holds a file's text, or none where it can't be read as text.
fn only_read(loader: &dyn Loader, path: &str) -> Outcome {
    let mut sources = Sources::default();
    if let Some(text) = loader.read(path).ok().and_then(|bytes| String::from_utf8(bytes).ok()) {
        sources.add(path, text);
    }
    Outcome { sources, diagnostics: Vec::new(), files: vec![path.to_owned()], compiled: None }
}
