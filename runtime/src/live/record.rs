//! Which files a compilation read, and what they held.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::Arc;
use crate::mesh::field;
use surefoot_compiler::compiled::Loader;
use surefoot_compiler::sampled::{Grid, Settings};

/// Reads files, from any thread.
pub type SharedLoader = Arc<dyn Loader + Send + Sync>;

/// What a file held: a hash of its bytes, or none where it could not be read.
type Content = Option<(u64, usize)>;

/// Unsaved texts by their plain names.
pub(super) type Texts = BTreeMap<String, Arc<[u8]>>;

/// A loader that answers with unsaved texts first and remembers what it answered.
pub(super) struct Recorder {
    loader: SharedLoader,
    texts: Texts,
    /// With the limit that the reader set to the file's size, if any.
    seen: RefCell<BTreeMap<String, (Option<u64>, Content)>>,
}

impl Recorder {
    pub fn new(loader: SharedLoader, texts: Texts) -> Self {
        Self { loader, texts, seen: RefCell::default() }
    }

    /// The names of the files that were asked for.
    pub fn files(&self) -> Vec<String> {
        self.seen.borrow().keys().cloned().collect()
    }

    /// Whether a file holds something else by now. `texts` are the unsaved ones of now.
    pub fn is_stale(&self, texts: &Texts) -> bool {
        self.seen.borrow().iter().any(|(path, (most, then))| content(&self.get(texts, path, *most)) != *then)
    }

    /// Whether a file was not there, or empty: most likely it is about to be written.
    pub fn is_hollow(&self) -> bool {
        self.seen.borrow().values().any(|(_, content)| content.is_none_or(|(_, length)| length == 0))
    }

    fn get(&self, texts: &Texts, path: &str, most: Option<u64>) -> Result<Vec<u8>, String> {
        match (texts.get(&plain(path)), most) {
            (Some(text), _) => Ok(text.to_vec()),
            (None, Some(most)) => self.loader.read_up_to(path, most),
            (None, None) => self.loader.read(path),
        }
    }

    fn noted(&self, path: &str, most: Option<u64>) -> Result<Vec<u8>, String> {
        let bytes = self.get(&self.texts, path, most);
        // Where a file is read twice, the first answer counts: if the second differs, the file is stale.
        self.seen.borrow_mut().entry(path.to_owned()).or_insert_with(|| (most, content(&bytes)));
        bytes
    }
}

impl Loader for Recorder {
    fn read(&self, path: &str) -> Result<Vec<u8>, String> {
        self.noted(path, None)
    }

    fn read_up_to(&self, path: &str, most: u64) -> Result<Vec<u8>, String> {
        self.noted(path, Some(most))
    }

    fn grid(&self, path: &str, settings: Settings) -> Result<Arc<Grid>, String> {
        // By way of this, so that the files that it reads are followed.
        field::grid(self, path, settings, &|_| {})
    }
}

fn content(bytes: &Result<Vec<u8>, String>) -> Content {
    let bytes = bytes.as_ref().ok()?;
    let mut hasher = DefaultHasher::new();
    bytes.hash(&mut hasher);
    Some((hasher.finish(), bytes.len()))
}

/// A name without `.` and, where something stands before it, without `..`: two spellings of a file become one.
pub(super) fn plain(path: &str) -> String {
    let path = path.replace('\\', "/");
    let mut parts: Vec<&str> = Vec::new();
    for part in path.split('/') {
        match part {
            "" | "." => {}
            ".." if parts.last().is_some_and(|last| *last != "..") => {
                parts.pop();
            }
            part => parts.push(part),
        }
    }
    let root = if path.starts_with('/') { "/" } else { "" };
    format!("{root}{}", parts.join("/"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use surefoot_compiler::MemoryLoader;

    #[test]
    fn two_spellings_become_one() {
        for (path, want) in [
            ("a.sdf", "a.sdf"),
            ("./a.sdf", "a.sdf"),
            ("parts/../a.sdf", "a.sdf"),
            ("../a.sdf", "../a.sdf"),
            ("../../b/./c//d", "../../b/c/d"),
            ("/x/../y", "/y"),
            ("x\\y", "x/y"),
        ] {
            assert_eq!(plain(path), want, "{path}");
        }
    }

    #[test]
    fn what_is_empty_or_missing_is_hollow() {
        let loader = Arc::new(MemoryLoader::new().with("empty.sdf", "").with("full.sdf", "scene = sphere(1)"));
        for (path, hollow) in [("empty.sdf", true), ("full.sdf", false), ("missing.sdf", true)] {
            let record = Recorder::new(loader.clone(), Texts::new());
            assert!(!record.is_hollow());
            let _ = record.read("full.sdf");
            let _ = record.read(path);
            assert_eq!(record.is_hollow(), hollow, "{path}");
        }
    }

    #[test]
    fn a_record_goes_stale_with_its_files_only() {
        let files = MemoryLoader::new().with("a", "1").with("b", "2");
        let texts = Texts::from([("b".to_owned(), Arc::from(&b"3"[..]))]);
        let recorder = Recorder::new(Arc::new(files), texts);
        assert_eq!(recorder.read("a"), Ok(b"1".to_vec()));
        assert_eq!(recorder.read("./b"), Ok(b"3".to_vec()), "unsaved text comes first");
        assert!(recorder.read("c").is_err());
        assert_eq!(recorder.files(), ["./b", "a", "c"]);
        let texts = recorder.texts.clone();
        assert!(!recorder.is_stale(&texts));
        assert!(recorder.is_stale(&Texts::new()), "unsaved text that was taken back");
        let mut later = recorder;
        later.loader = Arc::new(MemoryLoader::new().with("a", "1").with("b", "other"));
        assert!(!later.is_stale(&texts), "what is hidden by unsaved text does not matter");
        later.loader = Arc::new(MemoryLoader::new().with("a", "1").with("c", ""));
        assert!(later.is_stale(&texts), "a file that was missing and came");
    }
}
