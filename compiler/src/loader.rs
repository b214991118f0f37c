//! Where files come from: the compiler opens none itself.

/// The outside world, as far as the compiler needs it: files by their name.
pub trait Loader {
    /// The bytes of a file, or why they can't be had. `path` is relative to the working directory, or absolute.
    fn read(&self, path: &str) -> Result<Vec<u8>, String>;

    /// The same of a file that may be larger than a text, as meshes are: of at most so many bytes.
    fn read_up_to(&self, path: &str, most: u64) -> Result<Vec<u8>, String> {
        let bytes = self.read(path)?;
        if bytes.len() as u64 > most { Err(format!("the file is larger than {} MiB", most >> 20)) } else { Ok(bytes) }
    }
}

/// Files in memory, for tests and for editors that hold unsaved text.
#[derive(Clone, Debug, Default)]
pub struct MemoryLoader {
    files: std::collections::BTreeMap<String, Vec<u8>>,
}

impl MemoryLoader {
    /// No file.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds or replaces a file.
    pub fn with(mut self, path: &str, bytes: impl Into<Vec<u8>>) -> Self {
        self.files.insert(path.to_owned(), bytes.into());
        self
    }
}

impl Loader for MemoryLoader {
    fn read(&self, path: &str) -> Result<Vec<u8>, String> {
        self.files.get(path).cloned().ok_or_else(|| "there is no such file".to_owned())
    }
}
