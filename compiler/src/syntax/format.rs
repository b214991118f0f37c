//! The one canonical form of a text.

mod build;
mod comments;
mod declarations;
mod doc;

use super::parser::parse;
use crate::diagnostic::Diagnostic;
use crate::source::FileId;

/// Writes a text in its canonical form: two columns of indentation, lines of at most 100 characters where they can be broken, every
/// comment kept, at most one empty line where there were some. A text with errors is not touched: the answer is what is wrong.
pub fn format(text: &str) -> Result<String, Vec<Diagnostic>> {
    let (file, diagnostics) = parse(FileId(0), text);
    if !diagnostics.is_empty() {
        return Err(diagnostics);
    }
    Ok(doc::print(&build::Builder::new(text).file(&file)))
}
