//! Edits that mend what diagnostics speak of.

use crate::diagnostic::{Diagnostic, Edit, Fix};
use crate::prelude::in_prelude;
use crate::source::Span;

/// An edit that mends something.
#[derive(Clone, Debug, PartialEq)]
pub struct Action {
    /// What it does, in a few words.
    pub title: String,
    /// The edits, none over another.
    pub edits: Vec<Edit>,
    /// The diagnostic that it mends: its index.
    pub mends: usize,
    /// Whether it is the only way that its diagnostic names.
    pub is_only: bool,
}

/// The edits that some diagnostics name, of those that touch a place.
pub fn actions(diagnostics: &[Diagnostic], at: Span) -> Vec<Action> {
    let touches = |span: Span| span.file == at.file && span.start <= at.end && at.start <= span.end;
    let mut found = Vec::new();
    for (mends, diagnostic) in diagnostics.iter().enumerate().filter(|(_, d)| touches(d.span)) {
        let is_only = diagnostic.fixes.len() == 1;
        for Fix { title, edits } in &diagnostic.fixes {
            if !edits.iter().any(|edit| in_prelude(edit.span)) {
                found.push(Action { title: title.clone(), edits: edits.clone(), mends, is_only });
            }
        }
    }
    found
}
