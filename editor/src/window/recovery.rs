//! Unsaved texts on the disk, so that none is lost where the program ends without a word.
//!
//! Each text has a file of its own in a folder of the user: a line of JSON that says of what it is, and then the text. A window that lives
//! holds a lock; what lies there under a lock that nobody holds was left behind, and is offered to whoever opens that scene again.

use super::document::Document;
use crate::files::{self, LARGEST_FILE};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant, SystemTime};

/// A text is written no more often than this.
const EVERY: Duration = Duration::from_millis(500);
/// No more texts than this are left in the folder, nor more bytes; the oldest go first.
const MOST: (usize, u64) = (64, 64 << 20);
/// The first line of a file is no longer.
const HEAD: u64 = 1 << 16;

/// What keeps unsaved texts, for one window.
pub struct Recovery {
    /// Where; none where the user has no folder for it.
    folder: Option<PathBuf>,
    /// What this window's files are called.
    id: String,
    /// Held as long as the window lives.
    lock: Option<File>,
    /// The texts that lie there, by the documents' names.
    kept: BTreeMap<String, Kept>,
    writer: Option<Writer>,
    /// Why the last text can't be kept, until somebody asks.
    failure: Arc<Mutex<Option<String>>>,
}

/// A text that lies there.
struct Kept {
    text: String,
    at: Instant,
}

/// A text that another window left behind.
#[derive(Clone, Debug)]
pub struct Found {
    /// The file that holds it.
    pub file: PathBuf,
    /// Of which scene or part it is.
    path: PathBuf,
    /// When it was written.
    written: SystemTime,
    /// When what the disk holds was written, where it holds anything.
    saved: Option<SystemTime>,
    /// A hash of what the disk held then.
    base: u64,
    /// A hash of the text.
    hash: u64,
}

/// Writes and removes files, one after the other, where a slow disk stops nobody.
struct Writer {
    jobs: Sender<Job>,
    thread: JoinHandle<()>,
}

/// What a file shall hold; none: it shall be gone.
type Job = (PathBuf, Option<Vec<u8>>);

impl Recovery {
    /// In the user's own folder.
    pub fn of_user() -> Self {
        Self::within(folder())
    }

    /// In a folder.
    pub fn within(folder: Option<PathBuf>) -> Self {
        let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
        let id = format!("{}-{:x}", std::process::id(), now.as_nanos());
        Self { folder, id, lock: None, kept: BTreeMap::new(), writer: None, failure: Arc::default() }
    }

    /// A file beside the folder; none where there is no folder.
    pub fn beside(&self, name: &str) -> Option<PathBuf> {
        Some(self.folder.as_ref()?.with_file_name(name))
    }

    /// What other windows left behind, the newest first. What is too much of it is removed.
    pub fn found(&self) -> Vec<Found> {
        let Some(folder) = &self.folder else { return Vec::new() };
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
        let (locks, texts): (Vec<_>, Vec<_>) = entries.partition(|path| path.extension().is_some_and(|e| e == "lock"));
        let mut found: Vec<(Found, u64)> = Vec::new();
        for file in texts {
            // Also what was half written when its window ended, which is no text.
            let owner = file.file_name().and_then(|name| name.to_str()?.trim_start_matches('.').split('.').nth(1));
            if owner.is_some_and(|id| is_held(&folder.join(format!("{id}.lock")))) {
                continue;
            }
            match (Found::read(&file), std::fs::metadata(&file)) {
                (Some(text), Ok(known)) if file.extension().is_some_and(|e| e == "txt") => found.push((text, known.len())),
                _ => drop(std::fs::remove_file(&file)),
            }
        }
        for lock in locks.iter().filter(|lock| !is_held(lock)) {
            std::fs::remove_file(lock).ok();
        }
        found.sort_by_key(|(found, _)| std::cmp::Reverse(found.written));
        let (mut count, mut bytes) = (0, 0);
        found.retain(|(found, size)| {
            (count, bytes) = (count + 1, bytes + size);
            let stays = count <= MOST.0 && bytes <= MOST.1;
            if !stays {
                std::fs::remove_file(&found.file).ok();
            }
            stays
        });
        found.into_iter().map(|(found, _)| found).collect()
    }

    /// Writes what is not saved and removes what is; answers after what time there is more to write.
    pub fn follow(&mut self, documents: &[Document], now: Instant) -> Option<Duration> {
        let is_kept = |d: &Document| d.is_unsaved() && d.is_editable() && !(d.is_missing() && d.text.is_empty());
        let mut wait = None;
        for document in documents.iter().filter(|d| is_kept(d)) {
            let due = match self.kept.get(&document.name) {
                Some(kept) if kept.text == document.text => continue,
                Some(kept) => (kept.at + EVERY).saturating_duration_since(now),
                None => Duration::ZERO,
            };
            if due.is_zero() {
                self.keep(document, now);
            } else {
                wait = Some(wait.map_or(due, |wait: Duration| wait.min(due)));
            }
        }
        let done = |name: &String| !documents.iter().any(|d| d.name == *name && is_kept(d));
        let names: Vec<String> = self.kept.keys().filter(|name| done(name)).cloned().collect();
        for name in names {
            self.forget(&name);
        }
        wait
    }

    /// Removes all that this window keeps: a person has thrown it away.
    pub fn forget_all(&mut self) {
        let names: Vec<String> = self.kept.keys().cloned().collect();
        for name in names {
            self.forget(&name);
        }
    }

    /// The text that was left behind.
    pub fn read(found: &Found) -> Result<String, String> {
        let text = String::from_utf8(files::read(&found.file)?).map_err(|_| "the text is not UTF-8".to_owned())?;
        Ok(text.split_once('\n').map(|(_, text)| text.to_owned()).unwrap_or_default())
    }

    /// Removes it, after all that was to be written before.
    pub fn remove(&mut self, found: &Found) {
        self.order((found.file.clone(), None));
    }

    /// Why the last text can't be kept, once.
    pub fn failure(&self) -> Option<String> {
        self.failure.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    fn keep(&mut self, document: &Document, now: Instant) {
        self.kept.insert(document.name.clone(), Kept { text: document.text.clone(), at: now });
        let Some(file) = self.file(&document.name) else { return };
        // What is larger could not be read again.
        if document.text.len() as u64 > LARGEST_FILE - HEAD {
            return;
        }
        let written = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
        let head = json!({
            "path": absolute(&document.name),
            "written": written.as_secs_f64(),
            "base": format!("{:016x}", hash(document.saved())),
            "hash": format!("{:016x}", hash(&document.text)),
        });
        self.order((file, Some(format!("{head}\n{}", document.text).into_bytes())));
    }

    fn forget(&mut self, name: &str) {
        self.kept.remove(name);
        if let Some(file) = self.file(name) {
            self.order((file, None));
        }
    }

    /// The file of a document.
    fn file(&self, name: &str) -> Option<PathBuf> {
        let path = absolute(name);
        Some(self.folder.as_ref()?.join(format!("{:016x}.{}.txt", hash(&path.to_string_lossy()), self.id)))
    }

    fn order(&mut self, job: Job) {
        let Some(folder) = &self.folder else { return };
        if self.writer.is_none() {
            // Before the first file: nobody must take it for one that was left.
            self.lock = lock(folder, &self.id);
            self.writer = Writer::start(folder.clone(), self.failure.clone());
        }
        if let Some(writer) = &self.writer {
            // A writer that panicked has said so already.
            let _ = writer.jobs.send(job);
        }
    }
}

impl Drop for Recovery {
    fn drop(&mut self) {
        if let Some(Writer { jobs, thread }) = self.writer.take() {
            drop(jobs);
            let _ = thread.join();
        }
        if let (Some(_), Some(folder)) = (self.lock.take(), &self.folder) {
            std::fs::remove_file(folder.join(format!("{}.lock", self.id))).ok();
        }
    }
}

impl Writer {
    fn start(folder: PathBuf, failure: Arc<Mutex<Option<String>>>) -> Option<Self> {
        let (jobs, received) = channel();
        let write = move || work(&folder, &received, &failure);
        let thread = std::thread::Builder::new().name("surefoot recovery".to_owned()).spawn(write).ok()?;
        Some(Self { jobs, thread })
    }
}

fn work(folder: &Path, jobs: &Receiver<Job>, failure: &Mutex<Option<String>>) {
    let mut has_failed = false;
    while let Ok((file, bytes)) = jobs.recv() {
        let done = match bytes {
            Some(bytes) => make(folder).and_then(|()| files::write(&file, &bytes)),
            None => {
                // What is gone already is gone.
                std::fs::remove_file(&file).ok();
                Ok(())
            }
        };
        // It is said once, and not with each key.
        if let Err(why) = done
            && !std::mem::replace(&mut has_failed, true)
        {
            let words = format!("What is not saved can't be kept for recovery: {} can't be written: {why}.", folder.display());
            *failure.lock().unwrap_or_else(PoisonError::into_inner) = Some(words);
        }
    }
}

impl Found {
    fn read(file: &Path) -> Option<Self> {
        use std::io::{BufRead, BufReader, Read};
        let mut line = String::new();
        BufReader::new(File::open(file).ok()?.take(HEAD)).read_line(&mut line).ok()?;
        let head: Value = serde_json::from_str(&line).ok()?;
        let number = |key: &str| u64::from_str_radix(head.get(key)?.as_str()?, 16).ok();
        let path = PathBuf::from(head.get("path")?.as_str()?);
        let written = Duration::try_from_secs_f64(head.get("written")?.as_f64()?).ok()?;
        let mut found = Self {
            file: file.to_owned(),
            path,
            written: SystemTime::UNIX_EPOCH.checked_add(written)?,
            saved: None,
            base: number("base")?,
            hash: number("hash")?,
        };
        found.look();
        Some(found)
    }

    /// Of which file it is the text.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Looks when what the disk holds now was written.
    pub fn look(&mut self) {
        self.saved = std::fs::metadata(&self.path).and_then(|known| known.modified()).ok();
    }

    /// Whether it is the text of a file that goes by this name.
    pub fn is_of(&self, name: &str) -> bool {
        self.path == absolute(name)
    }

    /// Whether the document holds the same text.
    pub fn is_known(&self, document: &Document) -> bool {
        self.hash == hash(&document.text)
    }

    /// What there is to say of it, for people, above the text of its document.
    pub fn words(&self, document: &Document) -> String {
        let mut words = format!("Unsaved text of {} was found, written {}.", document.short_name(), ago(self.written));
        if document.is_missing() {
            words += " The file itself is gone.";
        } else if self.base != hash(document.saved()) {
            words += &match self.saved {
                Some(saved) if saved > self.written => format!(" The file was changed after it, {}: the file is newer.", ago(saved)),
                Some(saved) => format!(" The file has another text than it began from, written {}: the unsaved text is newer.", ago(saved)),
                None => " The file has another text than it began from.".to_owned(),
            };
        }
        words
    }
}

/// How long ago something was, for people.
fn ago(then: SystemTime) -> String {
    let seconds = then.elapsed().unwrap_or_default().as_secs();
    let (count, unit) = match seconds {
        0..60 => return "just now".to_owned(),
        60..3600 => (seconds / 60, "minute"),
        3600..86_400 => (seconds / 3600, "hour"),
        _ => (seconds / 86_400, "day"),
    };
    format!("{count} {unit}{} ago", if count == 1 { "" } else { "s" })
}

/// Where the system keeps such files of a user.
fn folder() -> Option<PathBuf> {
    let set = |name| std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let base = if cfg!(windows) {
        set("LOCALAPPDATA")
    } else if cfg!(target_os = "macos") {
        set("HOME").map(|home| home.join("Library/Application Support"))
    } else {
        // <https://specifications.freedesktop.org/basedir-spec/latest/>
        set("XDG_STATE_HOME").or_else(|| set("HOME").map(|home| home.join(".local/state")))
    };
    base.map(|base| base.join("surefoot").join("recovery"))
}

/// Makes the folder, for the user alone.
fn make(folder: &Path) -> Result<(), String> {
    let mut builder = std::fs::DirBuilder::new();
    builder.recursive(true);
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.create(folder).map_err(|error| error.to_string())
}

/// The lock of a window; none where there can be none.
fn lock(folder: &Path, id: &str) -> Option<File> {
    make(folder).ok()?;
    let file = File::create(folder.join(format!("{id}.lock"))).ok()?;
    file.try_lock().ok()?;
    Some(file)
}

/// Whether a window that lives holds a lock.
fn is_held(lock: &Path) -> bool {
    File::open(lock).is_ok_and(|file| matches!(file.try_lock(), Err(TryLockError::WouldBlock)))
}

/// A path that does not depend on where the program was started.
fn absolute(name: &str) -> PathBuf {
    std::path::absolute(name).unwrap_or_else(|_| PathBuf::from(name))
}

/// FNV-1a of 64 bits (<http://www.isthe.com/chongo/tech/comp/fnv/>): the same in each version of the program.
fn hash(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Folder(PathBuf);

    impl Folder {
        fn new(test: &str) -> Self {
            let folder = std::env::temp_dir().join(format!("surefoot-recovery-{}-{test}", std::process::id()));
            std::fs::remove_dir_all(&folder).ok();
            Self(folder)
        }

        fn recovery(&self) -> Recovery {
            Recovery::within(Some(self.0.clone()))
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            std::fs::remove_dir_all(&self.0).ok();
        }
    }

    fn edited(name: &str, saved: &str, text: &str) -> Document {
        let mut document = Document::new(name, saved);
        document.edit(text.to_owned(), Instant::now());
        document
    }

    #[test]
    fn the_hash_is_the_published_one() {
        assert_eq!(hash(""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(hash("a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(hash("foobar"), 0x8594_4171_f739_67e8);
    }

    #[test]
    fn what_a_window_leaves_is_found_and_no_text_of_one_that_lives() {
        let folder = Folder::new("left");
        let document = edited("/no/such/a.sdf", "one", "one\ntwo, not saved");
        let mut first = folder.recovery();
        assert_eq!(first.follow(std::slice::from_ref(&document), Instant::now()), None);
        // It lives, and what it has ordered is written when it ends.
        while std::fs::read_dir(&folder.0).unwrap().count() < 2 {
            std::thread::sleep(Duration::from_millis(2));
        }
        assert!(folder.recovery().found().is_empty());
        drop(first);
        let mut second = folder.recovery();
        let found = second.found();
        let [found] = &found[..] else { panic!("{found:?}") };
        assert!(found.is_of("/no/such/a.sdf") && !found.is_of("/no/such/b.sdf"));
        assert_eq!(Recovery::read(found).unwrap(), "one\ntwo, not saved");
        assert!(found.is_known(&document) && !found.is_known(&Document::new("a", "one")));
        assert_eq!(found.words(&document), "Unsaved text of a.sdf was found, written just now.");
        assert!(found.words(&edited("/no/such/a.sdf", "another", "x")).contains("another text than it began from"));
        second.remove(found);
        drop(second);
        assert_eq!(std::fs::read_dir(&folder.0).unwrap().count(), 0);
    }

    #[test]
    fn the_newer_of_text_and_file_is_named() {
        let at = |seconds| SystemTime::now() - Duration::from_secs(seconds);
        let found = |written, saved| Found { file: PathBuf::new(), path: PathBuf::new(), written: at(written), saved: Some(at(saved)), base: 0, hash: 0 };
        let document = Document::new("a.sdf", "one");
        assert!(found(7300, 130).words(&document).ends_with("2 hours ago. The file was changed after it, 2 minutes ago: the file is newer."));
        assert!(found(70, 90_000).words(&document).contains("written 1 minute ago. The file has another text than it began from, written 1 day ago"));
    }

    #[test]
    fn what_is_saved_or_thrown_away_leaves_nothing() {
        let folder = Folder::new("saved");
        let mut recovery = folder.recovery();
        let mut documents = [edited("a.sdf", "one", "two"), edited("b.sdf", "one", "two")];
        let now = Instant::now();
        assert_eq!(recovery.follow(&documents, now), None);
        documents[0].edit("three".to_owned(), now);
        assert_eq!(recovery.follow(&documents, now), Some(EVERY), "not with each key");
        assert_eq!(recovery.follow(&documents, now + EVERY), None);
        documents[0].was_saved();
        recovery.follow(&documents, now + 2 * EVERY);
        recovery.forget_all();
        drop(recovery);
        assert_eq!(std::fs::read_dir(&folder.0).unwrap().count(), 0);
    }

    #[test]
    fn not_more_is_left_than_there_is_room_for() {
        let folder = Folder::new("many");
        let mut recovery = folder.recovery();
        let documents: Vec<_> = (0..MOST.0 + 5).map(|i| edited(&format!("{i}.sdf"), "", "x")).collect();
        recovery.follow(&documents, Instant::now());
        drop(recovery);
        std::fs::write(folder.0.join("0.1-2.txt"), "no head\n").unwrap();
        assert_eq!(folder.recovery().found().len(), MOST.0);
        assert_eq!(std::fs::read_dir(&folder.0).unwrap().count(), MOST.0);
    }

    #[test]
    fn what_cannot_be_kept_is_said_once() {
        let folder = Folder::new("full");
        std::fs::write(&folder.0, "no folder").unwrap();
        let mut recovery = folder.recovery();
        let now = Instant::now();
        recovery.follow(&[edited("a.sdf", "one", "two")], now);
        recovery.follow(&[edited("a.sdf", "one", "three")], now + EVERY);
        let failure = recovery.failure.clone();
        drop(recovery);
        assert!(failure.lock().unwrap().take().unwrap().contains("can't be kept"));
        std::fs::remove_file(&folder.0).unwrap();
    }
}
