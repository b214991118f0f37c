//! The advice of a problem, taken by a key.

use crate::window::command::Command;
use crate::window::document::Document;
use crate::window::panels::cursor::{byte, caret, id};
use crate::window::panels::history;
use crate::window::session::Session;
use egui::{Key, Modifiers, Ui};

/// Ctrl+. takes the first advice of the problem that is nearest to the cursor.
pub fn keys(ui: &Ui, session: &Session, document: &Document, commands: &mut Vec<Command>) {
    if !document.is_editable() || !ui.memory(|m| m.has_focus(id(document))) || !ui.input_mut(|i| i.consume_key(Modifiers::COMMAND, Key::Period)) {
        return;
    }
    let at = caret(ui, document).map_or(0, |at| byte(&document.text, at));
    let line = document.text.get(..at).unwrap_or_default().matches('\n').count() as u32 + 1;
    let here = session.said.problems.iter().filter(|problem| problem.place.file == document.name);
    let nearest = here.filter(|problem| !problem.mends.is_empty()).min_by_key(|problem| problem.place.start.0.abs_diff(line));
    if let Some(mend) = nearest.and_then(|problem| problem.mends.first()) {
        history::step(ui, document);
        commands.push(Command::Mend(mend.clone()));
    }
}
