//! The cursor of the text that is shown.

use crate::window::document::Document;
use egui::text_edit::TextEditState;
use egui::{Id, Ui};
use std::ops::Range;

/// What the text's cursor is called.
pub fn id(document: &Document) -> Id {
    Id::unique(("source", &document.name))
}

/// What is selected in a text, in characters; where the cursor is, where nothing is.
pub fn selection(ui: &Ui, document: &Document) -> Range<usize> {
    let range = TextEditState::load(ui.ctx(), id(document)).and_then(|state| state.cursor.char_range());
    let [start, end] = range.map_or([0, 0], |range| range.sorted_cursors().map(|cursor| cursor.index.0));
    let count = document.text.chars().count();
    start.min(count)..end.min(count)
}
