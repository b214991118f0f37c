//! What an editor asks of a text, as plain data: completion, documentation, definitions, renaming and the like. It knows no protocol.
//!
//! Answers are of two kinds. *Cheap* ones need texts, trees and names: all functions that take a [`World`]. They take milliseconds, and work on texts with
//! errors. *Dear* ones need a compilation: [`examine`] gives diagnostics and factors, and an editor asks for it on another thread.
//!
//! Places are byte offsets in a text; [`Lines`] converts them to lines and columns in UTF-16 and back.

mod actions;
mod callable;
mod colors;
mod complete;
mod examine;
mod hints;
mod hover;
mod lines;
mod manual;
mod navigate;
mod outline;
mod paint;
mod parts;
mod place;
mod rename;
mod signature;
mod texts;
mod types;
mod walk;
mod world;

pub use actions::{Action, actions};
pub use colors::{ColorAt, colors, written_color};
pub use complete::{Completion, CompletionKind, complete};
pub use examine::{FactorAt, Report, examine};
pub use hints::{Hint, hints};
pub use hover::{Hover, hover};
pub use lines::{Lines, Position};
pub use navigate::{Definition, Reference, definition, references};
pub use outline::{Fold, Outline, OutlineKind, folds, outline, workspace_outline};
pub use paint::{Painted, paint};
pub use parts::{Part, Shown, parts, tell, without};
pub use rename::{prepare_rename, rename};
pub use signature::{Signature, SignatureHelp, signature_help};
pub use walk::{Meaning, Symbol};
pub use world::World;

pub use crate::diagnostic::{Edit, Fix};

#[cfg(test)]
mod tests;
