//! The tokens of a text with what they are to their reader: the classes of the window's colours, and for names their meaning.

use super::walk::Meaning;
use super::world::World;
use crate::source::FileId;
use crate::syntax::{TokenClass, tokens};
use std::ops::Range;

/// A token.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Painted {
    /// Where it stands.
    pub range: Range<usize>,
    /// Its class, as the window colours it.
    pub class: TokenClass,
    /// Of a name that is known: what it is.
    pub meaning: Option<Meaning>,
    /// Whether it declares what it names.
    pub declares: bool,
    /// Whether it stands after a dot.
    pub after_dot: bool,
    /// Whether it comes with the language.
    pub is_built_in: bool,
}

/// The tokens of a text in their order, comments too.
pub fn paint(world: &World, file: FileId) -> Vec<Painted> {
    let uses = world.uses(file);
    let mut next = 0;
    let painted = tokens(world.text(file)).into_iter().map(|(range, class)| {
        while uses.get(next).is_some_and(|found| (found.span.start as usize) < range.start) {
            next += 1;
        }
        let found = uses.get(next).filter(|found| found.span.range() == range && matches!(class, TokenClass::Name | TokenClass::Text));
        let is_built_in = found.is_some_and(|found| {
            use super::walk::Symbol::{BuiltIn, Key, Prelude};
            matches!(found.symbol, BuiltIn(_) | Prelude(_) | Key(..))
        });
        Painted { range, class, meaning: found.map(|found| found.meaning), declares: found.is_some_and(|found| found.declares), after_dot: found.is_some_and(|found| found.after_dot), is_built_in }
    });
    painted.collect()
}
