//! The one canonical form of a text.

mod build;
mod comments;
mod declarations;
mod doc;

use super::parser::parse;
use crate::diagnostic::Diagnostic;
use crate::source::FileId;

/// Writes a text in its canonical form: two columns of indentation, lines of at most 100 characters where they can be broken, every
/// comment kept, at most one empty line where there were some; lines end as most of the text's do. A text with errors is not touched: the
/// answer is what is wrong.
pub fn format(text: &str) -> Result<String, Vec<Diagnostic>> {
    let (file, diagnostics) = parse(FileId(0), text);
    if !diagnostics.is_empty() {
        return Err(diagnostics);
    }
    let laid_out = doc::print(&build::Builder::new(text).file(&file));
    Ok(if has_carriage_returns(text) { laid_out.replace('\n', "\r\n") } else { laid_out })
}

/// Whether most lines of a text end with `\r\n`.
pub fn has_carriage_returns(text: &str) -> bool {
    2 * text.matches("\r\n").count() > text.matches('\n').count()
}
