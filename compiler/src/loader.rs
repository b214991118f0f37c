//! Where files come from: the compiler opens none itself.

use crate::sampled::{Grid, MOST_BYTES, Settings};
use std::sync::Arc;

/// The outside world, as far as the compiler needs it: files by their name.
pub trait Loader {
    /// The bytes of a file, or why they can't be had. `path` is relative to the working directory, or absolute.
    fn read(&self, path: &str) -> Result<Vec<u8>, String>;

    /// The same of a file that may be larger than a text, as meshes are: of at most so many bytes.
    fn read_up_to(&self, path: &str, most: u64) -> Result<Vec<u8>, String> {
        let bytes = self.read(path)?;
        if bytes.len() as u64 > most { Err(format!("the file is larger than {} MiB", most >> 20)) } else { Ok(bytes) }
    }

    /// A file of triangles, sampled as the settings say; or why that can't be had. Who reads no meshes has only what is a grid already, an `.sfgrid` file,
    /// of which the settings are its own.
    fn grid(&self, path: &str, settings: Settings) -> Result<Arc<Grid>, String> {
        let _ = settings;
        if !path.to_ascii_lowercase().ends_with(".sfgrid") {
            return Err("meshes are not read here; `surefoot bake` makes an .sfgrid file of it, which is".to_owned());
        }
        Grid::from_bytes(&self.read_up_to(path, MOST_BYTES as u64)?).map(Arc::new)
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
