//! The grids that a program names, as whoever loads files brings them.

use crate::loader::Loader;
use crate::kept::Kept;
use crate::sampled::{Grid, Settings};
use std::cell::RefCell;
use std::collections::BTreeMap;

/// A file, a resolution and the bits of a padding.
type Key = (String, u32, u64);

/// The grids of one compilation, each asked for once.
pub struct Grids<'a> {
    loader: &'a dyn Loader,
    known: RefCell<BTreeMap<Key, Result<Kept<Grid>, String>>>,
}

impl<'a> Grids<'a> {
    /// None yet.
    pub fn new(loader: &'a dyn Loader) -> Self {
        Self { loader, known: RefCell::default() }
    }

    /// The bytes of a file, or why they can't be had.
    pub fn bytes(&self, path: &str, most: u64) -> Result<Vec<u8>, String> {
        self.loader.read_up_to(path, most)
    }

    /// That of a file of triangles, or why there is none.
    pub fn of_mesh(&self, path: &str, settings: Settings) -> Result<Kept<Grid>, String> {
        let key = (path.to_owned(), settings.resolution, settings.padding.to_bits());
        let known = self.known.borrow().get(&key).cloned();
        known.unwrap_or_else(|| {
            let read = self.loader.grid(path, settings).map(Kept::new);
            self.known.borrow_mut().insert(key, read.clone());
            read
        })
    }
}
