//! The thread that compiles and builds.

use crate::frame::Picture;
use crate::headless;
use crate::live::compilation::{Compilation, DOUBT, LONGER_DOUBT, STACK, broken};
use crate::live::overhear;
use crate::live::record::Recorder;
use crate::live::rehearsal::Rehearsal;
use crate::live::state::{Ready, Setup, Shared, Times, Update, Words, Work};
use crate::live::watch::Watch;
use crate::mesh::Assets;
use crate::physics::{Contact, Passes};
use crate::view::Showing;
use std::mem::take;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use surefoot_compiler::compiled::Compiled;
use surefoot_compiler::diagnostic::Diagnostic;

/// Events that follow each other faster than this belong to one save…
const PAUSE: Duration = Duration::from_millis(5);
/// …but nobody waits longer than this for them to end.
const LONGEST_PAUSE: Duration = Duration::from_millis(40);
/// Nobody waits longer than this for files that change again and again, and are wrong each time.
const LONGEST_DOUBT: Duration = Duration::from_secs(1);
/// How often the files are read again meanwhile.
const DOUBT_STEP: Duration = Duration::from_millis(5);

pub(super) fn spawn(setup: Setup, shared: Arc<Shared>) -> std::io::Result<JoinHandle<()>> {
    std::thread::Builder::new().name("surefoot live".to_owned()).stack_size(STACK).spawn(
        move || {
            let ears = shared.clone();
            let watch = Watch::new(move || {
                let mut state = ears.lock();
                state.report.events += 1;
                let now = Instant::now();
                state.last_event = Some(now);
                state.asked.get_or_insert(now);
                ears.changed.notify_all();
            });
            let rehearsal = Rehearsal::new(setup.target.as_ref().map(|(gpu, _)| gpu));
            let (record, newest) = (None, Newest::default());
            let assets = Assets::new();
            Worker { setup, shared, watch, rehearsal, record, read: None, assets, newest, passes: None }.run();
        },
    )
}

struct Worker {
    setup: Setup,
    shared: Arc<Shared>,
    watch: Watch,
    rehearsal: Rehearsal,
    /// What the newest compilation read.
    record: Option<Recorder>,
    /// What was read for the newest scene that was good: its meshes.
    read: Option<Recorder>,
    assets: Assets,
    newest: Newest,
    /// What moves balls, once a scene had some.
    passes: Option<Arc<Passes>>,
}

/// What draws a scene, and what moves its balls.
type Parts = (Option<Picture>, Option<(Arc<Passes>, Contact)>);

/// What is known of the newest text, and the newest scene that was good.
#[derive(Default)]
struct Newest {
    words: Arc<Words>,
    /// What is wrong with the meshes of the newest good scene.
    broken: Vec<Diagnostic>,
    failure: Option<String>,
    good: Option<Arc<Compiled>>,
    /// What the newest picture shows.
    showing: Showing,
    times: Times,
}

/// What is to be worked on.
struct Job {
    since: Instant,
    /// An editor pushed a whole text: what is wrong in it is wrong.
    pushed: bool,
    /// The files may be as they were: the options are not, or the path.
    anew: bool,
}

impl Worker {
    fn run(mut self) {
        while let Some(job) = self.next() {
            // Before anything is read, so that nothing falls between.
            self.watch.refresh();
            self.watch.look();
            let showing = self.shared.lock().showing;
            let shows_other = showing != self.newest.showing;
            let since = job.since;
            let mut scene = None;
            if job.anew || self.is_stale() {
                scene = self.work(job);
                if scene.is_some() {
                    // A picture takes its time.
                    self.shared.lock().words = Some(self.words());
                    (self.setup.wake)();
                }
            } else if self.are_meshes_stale() {
                scene = self.newest.good.clone();
                if let Some(compiled) = &scene {
                    self.load(compiled);
                }
            } else if !shows_other {
                continue;
            }
            if shows_other && scene.is_none() {
                scene = self.newest.good.clone();
            }
            std::thread::scope(|scope| {
                let shared = self.shared.clone();
                let listens = scene.is_some() && self.setup.target.is_some();
                let _ears = listens.then(|| overhear::start(scope, self.setup.clone(), &shared, self.words()));
                let update = self.build(scene, showing, since);
                self.deliver(update);
            });
        }
    }

    /// Waits for the next change. None: it is time to end.
    fn next(&mut self) -> Option<Job> {
        let shared = self.shared.clone();
        let mut state = shared.lock();
        state.busy = false;
        let mut looked = Instant::now();
        loop {
            if state.stop {
                return None;
            }
            if state.asked.is_some() {
                break;
            }
            let patience = self.watch.patience().saturating_sub(looked.elapsed());
            state = shared.wait(state, patience);
            if state.asked.is_none() && looked.elapsed() >= self.watch.patience() {
                drop(state);
                // Without the lock: the watcher's thread may be waiting for it.
                let changed = self.watch.refresh() | self.watch.look();
                looked = Instant::now();
                state = shared.lock();
                if changed {
                    state.asked.get_or_insert(looked);
                }
            }
        }
        // What was pushed is whole. What was saved may be halfway.
        let begun = Instant::now();
        while !state.pushed && !state.stop {
            let quiet = state.last_event.map_or(PAUSE, |at| at.elapsed());
            if quiet >= PAUSE || begun.elapsed() >= LONGEST_PAUSE {
                break;
            }
            state = shared.wait(state, PAUSE - quiet);
        }
        state.busy = true;
        let since = state.asked.take().unwrap_or(begun);
        Some(Job { since, pushed: take(&mut state.pushed), anew: take(&mut state.anew) })
    }

    /// Whether a file, or the text that an editor holds in its stead, is not what was compiled.
    fn is_stale(&self) -> bool {
        let texts = self.shared.lock().texts.clone();
        self.record.as_ref().is_none_or(|record| record.is_stale(&texts))
    }

    /// Whether a file that was read for the meshes is not what it was.
    fn are_meshes_stale(&self) -> bool {
        let texts = self.shared.lock().texts.clone();
        self.read.as_ref().is_some_and(|record| record.is_stale(&texts))
    }

    /// Reads the meshes of a scene, and doubts an error for a moment: a large file is often seen before it is whole.
    fn load(&mut self, compiled: &Compiled) {
        let deadline = Instant::now() + DOUBT;
        loop {
            let texts = self.shared.lock().texts.clone();
            let recorder = Recorder::new(self.setup.loader.clone(), texts);
            let (shared, wake) = (&self.shared, &self.setup.wake);
            let broken = self.assets.load(&recorder, compiled, &|file, i, of| {
                shared.lock().loading = Some(format!("{file}, mesh {} of {of}", i + 1));
                wake();
            });
            self.shared.lock().loading = None;
            self.read = Some(recorder);
            self.newest.broken = broken;
            if self.newest.broken.is_empty() || !self.waits_for(deadline, || self.are_meshes_stale()) {
                break;
            }
        }
        self.follow();
    }

    /// Watches all that was read.
    fn follow(&mut self) {
        let mut files = self.newest.words.files.clone();
        for file in self.read.iter().flat_map(Recorder::files) {
            if !files.contains(&file) {
                files.push(file);
            }
        }
        let unheard = self.watch.follow(&files);
        if unheard && (self.is_stale() || self.are_meshes_stale()) {
            self.shared.lock().asked.get_or_insert_with(Instant::now);
        }
    }

    /// Compiles, and doubts an error for a moment.
    fn work(&mut self, mut job: Job) -> Option<Arc<Compiled>> {
        let mut doubted: Option<Instant> = None;
        loop {
            let scene = self.compile(&mut job);
            if scene.is_some() || job.pushed {
                return scene;
            }
            let now = Instant::now();
            let last = *doubted.get_or_insert(now) + LONGEST_DOUBT;
            let hollow = self.record.as_ref().is_some_and(Recorder::is_hollow);
            let doubt = if hollow { LONGER_DOUBT } else { DOUBT };
            if !self.changes_before(last.min(now + doubt)) {
                return None;
            }
        }
    }

    fn compile(&mut self, job: &mut Job) -> Option<Arc<Compiled>> {
        self.begin(Work::Compiling);
        {
            let mut state = self.shared.lock();
            // What was pushed since the job began is compiled with it.
            job.pushed |= take(&mut state.pushed);
            state.anew = false;
        }
        let Compilation { recorder, outcome, failure, took } = Compilation::run(&self.setup, &self.shared);
        let (words, compiled) = Words::of(outcome, &recorder);
        self.record = Some(recorder);
        self.newest.words = Arc::new(words);
        self.newest.failure = failure;
        self.newest.times = Times { compile: took, ..Times::default() };
        match compiled.map(Arc::new) {
            Some(compiled) => {
                self.load(&compiled);
                Some(compiled)
            }
            None => {
                self.follow();
                None
            }
        }
    }

    /// Builds a scene's picture, where there is a scene.
    fn build(&mut self, scene: Option<Arc<Compiled>>, showing: Showing, since: Instant) -> Update {
        let start = Instant::now();
        if scene.is_some() {
            self.begin(Work::Building);
        }
        let ready = scene.and_then(|compiled| {
            let prepare = || self.prepare(&compiled, showing);
            let prepared = catch_unwind(AssertUnwindSafe(prepare))
                .unwrap_or_else(|panic| Err(broken("the translation", panic.as_ref())));
            match prepared {
                Ok((picture, balls)) => Some(Ready { compiled, picture, balls }),
                Err(error) => {
                    self.newest.failure = Some(error);
                    None
                }
            }
        });
        let newest = &mut self.newest;
        newest.showing = showing;
        if let Some(ready) = &ready {
            newest.good = Some(ready.compiled.clone());
            newest.times.pipeline = start.elapsed();
        }
        newest.times.total = since.elapsed();
        Update { failure: newest.failure.clone(), ready, times: newest.times, words: self.words() }
    }

    /// What there is to say of the newest text, its meshes too.
    fn words(&self) -> Arc<Words> {
        let Newest { words, broken, .. } = &self.newest;
        if broken.is_empty() {
            return words.clone();
        }
        let mut words = Words::clone(words);
        words.diagnostics.extend(broken.iter().cloned());
        Arc::new(words)
    }

    fn begin(&self, work: Work) {
        self.shared.lock().work = Some((work, Instant::now()));
        (self.setup.wake)();
    }

    fn prepare(&mut self, compiled: &Compiled, showing: Showing) -> Result<Parts, String> {
        let Some((gpu, format)) = &self.setup.target else { return Ok((None, None)) };
        let meshes = self.assets.meshes(compiled);
        let picture = self.rehearsal.prepare(gpu, |gpu| {
            let mut picture = Picture::prepare(gpu, compiled, *format, showing)?;
            picture.show_meshes(&meshes)?;
            picture.show_images(self.assets.images());
            headless::warm_up(gpu, &mut picture, compiled, *format)?;
            Ok(picture)
        })?;
        if !compiled.has_balls() {
            return Ok((Some(picture), None));
        }
        let passes = match self.passes.take() {
            Some(passes) => passes,
            None => Arc::new(Passes::new(gpu)?),
        };
        self.passes = Some(passes.clone());
        Ok((Some(picture), Some((passes, Contact::prepare(gpu, compiled)?))))
    }

    fn deliver(&mut self, mut update: Update) {
        let mut state = self.shared.lock();
        state.report.updates += 1;
        if let Some(older) = state.update.take() {
            state.report.replaced += 1;
            // What is drawn must not fall behind the newest good scene, even if nobody saw it yet.
            if update.ready.is_none() {
                update.ready = older.ready;
            }
        }
        // What was heard of a newer text is said after what is delivered, and looked at again in any case.
        state.words = state.overheard.take();
        if state.words.is_some() {
            self.record = None;
        }
        state.update = Some(update);
        state.building = false;
        state.work = None;
        state.busy = state.asked.is_some();
        drop(state);
        (self.setup.wake)();
    }

    /// Waits until a file holds something else than what was compiled. False if none does until the deadline.
    fn changes_before(&self, deadline: Instant) -> bool {
        self.waits_for(deadline, || self.is_stale())
    }

    /// Waits until something is so. False if it is not until the deadline.
    fn waits_for(&self, deadline: Instant, so: impl Fn() -> bool) -> bool {
        loop {
            if so() {
                return true;
            }
            let left = deadline.saturating_duration_since(Instant::now());
            let state = self.shared.lock();
            if left.is_zero() || state.stop || state.pushed {
                return false;
            }
            drop(self.shared.wait(state, left.min(DOUBT_STEP)));
        }
    }
}
