//! Hears of changes to files. Directories are watched and not files, because a save often puts a new file in the old one's place.
//!
//! Nothing here is relied on to be complete: network drives send no events, a queue of events overflows, a directory's ancestor is
//! renamed. So [`Watch::look`] compares what the file system says of each file with what it said before, every now and then.

use notify::event::{AccessKind, AccessMode, EventKind, ModifyKind};
use notify::{RecommendedWatcher, RecursiveMode, Watcher};
use std::collections::{BTreeMap, BTreeSet};
use std::fs::Metadata;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, SystemTime};

/// How often to look where events come.
const HEARTBEAT: Duration = Duration::from_secs(1);
/// How often to look where they don't.
const POLL: Duration = Duration::from_millis(200);

/// What tells one state of a file, or one directory, from another without reading it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Print {
    modified: Option<SystemTime>,
    length: u64,
    id: (u64, u64),
}

/// Paths that events are compared with.
#[derive(Default)]
struct Interest {
    /// Files, and the first missing directory on the way to one.
    paths: BTreeSet<PathBuf>,
    /// Directories that are watched.
    directories: BTreeSet<PathBuf>,
    /// Directories of those that went away: their watch is gone, even if another of the name comes.
    lost: BTreeSet<PathBuf>,
}

/// The files that are followed and what is watched for them.
pub(super) struct Watch {
    watcher: Option<RecommendedWatcher>,
    interest: Arc<Mutex<Interest>>,
    /// Watched directories, and which of that name.
    watched: BTreeMap<PathBuf, (u64, u64)>,
    /// Followed files as the compiler calls them.
    names: Vec<String>,
    /// The same as paths. None until they were looked at.
    files: BTreeMap<PathBuf, Option<Option<Print>>>,
    /// Whether a directory can't be watched.
    deaf: bool,
}

impl Watch {
    /// `heard` is called from another thread for every event that may matter.
    pub fn new(heard: impl Fn() + Send + 'static) -> Self {
        let interest: Arc<Mutex<Interest>> = Arc::default();
        let theirs = interest.clone();
        let watcher = notify::recommended_watcher(move |event: notify::Result<notify::Event>| {
            let matters = match event {
                Ok(event) => lock(&theirs).matters(&event),
                Err(_) => true,
            };
            if matters {
                heard();
            }
        });
        let watcher = watcher.inspect_err(|e| log::warn!("files can't be watched: {e}")).ok();
        Self {
            deaf: watcher.is_none(),
            watcher,
            interest,
            watched: BTreeMap::new(),
            names: Vec::new(),
            files: BTreeMap::new(),
        }
    }

    /// Follows these files and no others. Answers whether a directory is watched now that was not before: what happened in it until
    /// now was not heard.
    pub fn follow(&mut self, files: &[String]) -> bool {
        let mut interest = Interest::default();
        let mut followed = BTreeMap::new();
        // The prelude's files have names in angle brackets, and are nowhere.
        for file in files.iter().filter(|f| !f.starts_with('<')) {
            let Ok(path) = std::path::absolute(file) else { continue };
            interest.add(&path);
            // Behind a link, the file that it leads to is the one that changes.
            if let Ok(target) = path.canonicalize() {
                interest.add(&target);
            }
            let print = self.files.remove(&path).flatten();
            followed.insert(path, print);
        }
        self.files = followed;
        self.names = files.to_vec();
        let lost = {
            let mut ours = lock(&self.interest);
            let lost = std::mem::take(&mut ours.lost);
            *ours = interest;
            lost
        };
        self.watch(&lost)
    }

    /// Follows the same files again, after directories may have come or gone.
    pub fn refresh(&mut self) -> bool {
        let names = std::mem::take(&mut self.names);
        self.follow(&names)
    }

    /// Whether the file system says something else of a file than when it was looked at last.
    pub fn look(&mut self) -> bool {
        let mut changed = false;
        for (path, known) in &mut self.files {
            let now = path.metadata().ok().map(|m| Print::new(&m));
            changed |= *known != Some(now);
            *known = Some(now);
        }
        changed
    }

    /// After how long to look, unless an event comes first.
    pub fn patience(&self) -> Duration {
        if self.deaf { POLL } else { HEARTBEAT }
    }

    /// Makes what is watched what should be. The lock is not held meanwhile: the watcher's thread may be waiting for it.
    fn watch(&mut self, lost: &BTreeSet<PathBuf>) -> bool {
        let wanted = lock(&self.interest).directories.clone();
        let Some(watcher) = &mut self.watcher else { return false };
        let identity = |path: &Path| path.metadata().map(|m| Print::new(&m).id).unwrap_or_default();
        self.watched.retain(|path, id| {
            let keep = wanted.contains(path) && !lost.contains(path) && identity(path) == *id;
            if !keep {
                // It may be gone, and its watch with it.
                let _ = watcher.unwatch(path);
            }
            keep
        });
        let mut new = false;
        self.deaf = false;
        for path in wanted {
            if self.watched.contains_key(&path) {
                continue;
            }
            let id = identity(&path);
            match watcher.watch(&path, RecursiveMode::NonRecursive) {
                Ok(()) => {
                    self.watched.insert(path, id);
                    new = true;
                }
                Err(error) => {
                    log::warn!("{} can't be watched: {error}", path.display());
                    self.deaf = true;
                }
            }
        }
        new
    }
}

impl Interest {
    /// Watches the directory of a file, or the nearest one above that exists.
    fn add(&mut self, path: &Path) {
        let mut below = path;
        for directory in path.ancestors().skip(1) {
            if directory.is_dir() {
                // One spelling for each directory: an event names only one.
                let directory = directory.canonicalize().unwrap_or_else(|_| directory.to_owned());
                if let Some(name) = below.file_name() {
                    self.paths.insert(directory.join(name));
                }
                self.directories.insert(directory);
                return;
            }
            below = directory;
        }
    }

    fn matters(&mut self, event: &notify::Event) -> bool {
        match event.kind {
            // To read a file is an event too, and we do read.
            EventKind::Access(AccessKind::Close(AccessMode::Write)) => {}
            EventKind::Access(_) => return false,
            EventKind::Remove(_) | EventKind::Modify(ModifyKind::Name(_)) => {
                let gone = event.paths.iter().filter(|p| self.directories.contains(*p));
                self.lost.extend(gone.cloned());
            }
            _ => {}
        }
        event.need_rescan()
            || event.paths.iter().any(|p| self.paths.contains(p) || self.directories.contains(p))
    }
}

impl Print {
    fn new(metadata: &Metadata) -> Self {
        #[cfg(unix)]
        let id = {
            use std::os::unix::fs::MetadataExt;
            (metadata.dev(), metadata.ino())
        };
        #[cfg(not(unix))]
        let id = (0, 0);
        Self { modified: metadata.modified().ok(), length: metadata.len(), id }
    }
}

fn lock(interest: &Mutex<Interest>) -> MutexGuard<'_, Interest> {
    interest.lock().unwrap_or_else(PoisonError::into_inner)
}
