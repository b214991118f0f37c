//! Texts with their trees, before their names are found.

use crate::diagnostic::Diagnostic;
use crate::loader::Loader;
use crate::program::load::{ItemRef, Modules, load_all};
use crate::source::Sources;
use crate::syntax::ast::Type;
use rustc_hash::FxHashMap;
use std::cell::RefCell;

/// Some texts and what they import, and the prelude.
pub(super) struct Texts {
    pub(super) sources: Sources,
    pub(super) modules: Modules,
    /// What the parser and the reader of imports say.
    pub(super) diagnostics: Vec<Diagnostic>,
    /// Types of declarations that were asked for; none while one is being found, and of what has none.
    pub(super) types: RefCell<FxHashMap<ItemRef, Option<Type>>>,
}

impl Texts {
    /// Reads texts and what they import. What can't be read is left out.
    pub(super) fn read(loader: &dyn Loader, paths: &[&str]) -> Self {
        let loaded = load_all(loader, paths);
        Self { sources: loaded.sources, modules: loaded.modules, diagnostics: loaded.diagnostics, types: RefCell::default() }
    }
}
