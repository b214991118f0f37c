//! The texts that an editor asks about: read, with their names found.

use super::texts::Texts;
use super::walk::{self, Use};
use crate::diagnostic::Diagnostic;
use crate::loader::Loader;
use crate::prelude::in_prelude;
use crate::source::{FileId, Span};
use crate::syntax::ast;

/// Room for the deepest tree that is read, in a build without optimisation.
const STACK: usize = 32 << 20;

/// Some texts and what they import, as they are at one moment.
pub struct World {
    pub(super) texts: Texts,
    /// The paths that were asked for.
    roots: Vec<String>,
    /// The names in each module but the prelude, in the order of their places.
    uses: Vec<Vec<Use>>,
}

impl World {
    /// Reads texts and what they import. What can't be read is left out.
    pub fn read(loader: &dyn Loader, paths: &[&str]) -> Self {
        Self::with_room(|| {
            let texts = Texts::read(loader, paths);
            let own = 1..texts.modules.count();
            let uses = std::iter::once(Vec::new()).chain(own.map(|module| walk::uses(&texts, module))).collect();
            Self { texts, roots: paths.iter().map(|path| (*path).to_owned()).collect(), uses }
        })
    }

    /// The paths that were asked for.
    pub(super) fn roots(&self) -> Vec<&str> {
        self.roots.iter().map(String::as_str).collect()
    }

    /// Runs something that walks trees, with room on the stack for the deepest one.
    pub(super) fn with_room<T>(run: impl FnOnce() -> T) -> T {
        stacker::maybe_grow(STACK / 2, STACK, run)
    }

    /// The text that was read from a path.
    pub fn file(&self, path: &str) -> Option<FileId> {
        self.texts.modules.of_path(path).map(|module| self.texts.modules.file(module))
    }

    /// A text; empty where there is none.
    pub fn text(&self, file: FileId) -> &str {
        self.texts.sources.get(file).map_or("", |source| &source.text)
    }

    /// The path of a text, or `<prelude>/NAME.sdf`.
    pub fn path(&self, file: FileId) -> &str {
        self.texts.sources.get(file).map_or("", |source| &source.name)
    }

    /// What the parser and the reader of imports say, of all texts.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.texts.diagnostics
    }

    /// The paths of all texts but those that come with the language.
    pub fn paths(&self) -> impl Iterator<Item = &str> {
        (1..self.texts.modules.count()).filter(|&module| !self.texts.modules.comes_along(module)).map(|module| self.texts.modules.path(module))
    }

    /// The tree of a text. None for a text of the prelude, whose trees are one.
    pub(super) fn tree(&self, file: FileId) -> Option<&ast::File> {
        if in_prelude(Span::new(file, 0, 0)) {
            return None;
        }
        self.texts.modules.of_file(file).and_then(|module| self.texts.modules.tree(module))
    }

    /// The names in a text, in the order of their places.
    pub(super) fn uses(&self, file: FileId) -> &[Use] {
        if in_prelude(Span::new(file, 0, 0)) {
            return &[];
        }
        self.texts.modules.of_file(file).and_then(|module| self.uses.get(module)).map_or(&[], |uses| uses)
    }

    /// The names in all texts but the prelude.
    pub(super) fn all_uses(&self) -> impl Iterator<Item = &Use> {
        self.uses.iter().flatten()
    }

    /// The name at a place, or that ends there.
    pub(super) fn use_at(&self, file: FileId, offset: usize) -> Option<&Use> {
        let uses = self.uses(file);
        let after = uses.partition_point(|found| found.span.start as usize <= offset);
        // Places of names do not overlap, but for the path of an import none holds another.
        uses.get(..after)?.iter().rev().take(2).find(|found| offset <= found.span.end as usize)
    }
}
