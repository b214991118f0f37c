//! Places of the texts.

use surefoot_compiler::source::Span;
use surefoot_runtime::live::Words;

/// A piece of a text, lines and columns from 1, columns in characters.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file's name, as the compiler calls it.
    pub file: String,
    /// Line and column of the first character.
    pub start: (u32, u32),
    /// Line and column one past the last character.
    pub end: (u32, u32),
}

/// A piece of the texts that the compiler speaks of.
pub fn place(words: &Words, span: Span) -> Place {
    let (file, line, column) = words.sources.position(span.file, span.start);
    let (_, end_line, end_column) = words.sources.position(span.file, span.end);
    Place { file: file.to_owned(), start: (line, column), end: (end_line, end_column) }
}
