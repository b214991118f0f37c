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

/// The character before which the cursor stands, where nothing is selected.
pub fn caret(ui: &Ui, document: &Document) -> Option<usize> {
    let range = TextEditState::load(ui.ctx(), id(document))?.cursor.char_range()?;
    (range.primary.index == range.secondary.index).then_some(range.primary.index.0)
}

/// The byte of a character of a text.
pub fn byte(text: &str, character: usize) -> usize {
    text.char_indices().nth(character).map_or(text.len(), |(at, _)| at)
}
