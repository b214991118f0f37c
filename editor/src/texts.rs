//! Texts that are open somewhere, before those on disk.

use crate::files::FileLoader;
use std::collections::BTreeMap;
use std::sync::Arc;
use surefoot_compiler::Loader;
use surefoot_compiler::sampled::{Grid, Settings};

/// Reads texts that are open as they are there, and all others from disk.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OpenTexts {
    open: Arc<BTreeMap<String, Arc<str>>>,
}

impl OpenTexts {
    /// Some texts by their paths.
    pub fn new(texts: impl IntoIterator<Item = (String, Arc<str>)>) -> Self {
        Self { open: Arc::new(texts.into_iter().collect()) }
    }
}

impl Loader for OpenTexts {
    fn read(&self, path: &str) -> Result<Vec<u8>, String> {
        match self.open.get(path) {
            Some(text) => Ok(text.as_bytes().to_vec()),
            None => FileLoader.read(path),
        }
    }

    fn read_up_to(&self, path: &str, most: u64) -> Result<Vec<u8>, String> {
        FileLoader.read_up_to(path, most)
    }

    fn grid(&self, path: &str, settings: Settings) -> Result<Arc<Grid>, String> {
        FileLoader.grid(path, settings)
    }
}
