//! Undo and redo of a text, and where its cursor stays when the text becomes another one by itself.
//!
//! egui's own history holds the cursor as a part of the text's state: whoever moves it loses what was undone. Here only text counts, and each line
//! is a step of its own.

use crate::window::document::Document;
use crate::window::panels::cursor::id;
use egui::text::{CCursor, CCursorRange};
use egui::text_edit::TextEditState;
use egui::util::undoer::{Settings, Undoer};
use egui::{Id, Key, Modifiers, Ui};
use std::sync::{Arc, Mutex, PoisonError};

/// A text, with the cursor as it was then.
#[derive(Clone, Default)]
struct Moment {
    text: String,
    cursor: CCursorRange,
}

impl PartialEq for Moment {
    fn eq(&self, other: &Self) -> bool {
        self.text == other.text
    }
}

/// What became of a text.
struct History {
    undoer: Undoer<Moment>,
    /// The newest.
    last: Moment,
    /// What the window itself made of it, so that what else comes is from outside.
    expected: String,
    /// Whether a hand goes on with an edit: what it makes on its way is no step.
    held: bool,
    /// For how many more frames the next text ends a step.
    ends: u8,
}

type Shared = Arc<Mutex<History>>;

fn shared(ui: &Ui, id: Id, document: &Document) -> Shared {
    let begin = || {
        // An undo takes back some seconds of typing, not all of it.
        let settings = Settings { max_undos: 1000, stable_time: 0.5, auto_save_interval: 2.0 };
        let history = History { undoer: Undoer::with_settings(settings), last: Moment::default(), expected: document.text.clone(), held: false, ends: 0 };
        Arc::new(Mutex::new(history))
    };
    ui.data_mut(|data| data.get_temp_mut_or_insert_with(id.with("history"), begin).clone())
}

fn cursor(ui: &Ui, id: Id) -> Option<CCursorRange> {
    TextEditState::load(ui.ctx(), id)?.cursor.char_range()
}

fn put_cursor(ui: &Ui, id: Id, range: CCursorRange) {
    let mut state = TextEditState::load(ui.ctx(), id).unwrap_or_default();
    state.cursor.set_char_range(Some(range));
    state.store(ui.ctx(), id);
}

/// Follows a text, and takes it back or forth where the keyboard says so; answers whether it did. Before egui sees the keys.
pub fn follow(ui: &Ui, id: Id, document: &Document, text: &mut String) -> bool {
    let shared = shared(ui, id, document);
    let mut history = shared.lock().unwrap_or_else(PoisonError::into_inner);
    if history.expected != document.text {
        if let Some(range) = cursor(ui, id) {
            let carried = |at: CCursor| CCursor::new(carried(&history.expected, &document.text, at.index.0));
            put_cursor(ui, id, CCursorRange::two(carried(range.secondary), carried(range.primary)));
        }
        history.expected.clone_from(&document.text);
    }
    let now = Moment { text: document.text.clone(), cursor: cursor(ui, id).unwrap_or_default() };
    if history.held {
        history.last = now;
        return false;
    }
    let is_last = history.ends == 1;
    history.ends = history.ends.saturating_sub(1);
    if is_last || history.ends > 0 && now != history.last {
        history.ends = 0;
        // Which forgets what was undone before, too.
        history.undoer.feed_state(ui.input(|i| i.time), &now);
        history.undoer.add_undo(&now);
        history.last = now.clone();
    }
    let lines = |moment: &Moment| moment.text.bytes().filter(|b| *b == b'\n').count();
    if now != history.last {
        if lines(&now) != lines(&history.last) && !history.last.text.is_empty() {
            let before = history.last.clone();
            history.undoer.add_undo(&before);
        }
        history.last = now.clone();
    }
    let time = ui.input(|i| i.time);
    history.undoer.feed_state(time, &now);
    if !document.is_editable() || !ui.memory(|m| m.has_focus(id)) {
        return false;
    }
    let forth = Modifiers::COMMAND | Modifiers::SHIFT;
    // With Shift first, which the one without it would take as well.
    let found = if ui.input_mut(|i| i.consume_key(forth, Key::Z) || i.consume_key(Modifiers::COMMAND, Key::Y)) {
        history.undoer.redo(&now).cloned()
    } else if ui.input_mut(|i| i.consume_key(Modifiers::COMMAND, Key::Z)) {
        history.undoer.undo(&now).cloned()
    } else {
        return false;
    };
    let Some(moment) = found else { return false };
    put_cursor(ui, id, place(&document.text, &moment));
    text.clone_from(&moment.text);
    // What is taken back is no edit.
    history.last = moment;
    true
}

/// A hand begins with an edit that is one step, however many frames it takes.
pub fn hold(ui: &Ui, document: &Document) {
    let shared = shared(ui, id(document), document);
    let mut history = shared.lock().unwrap_or_else(PoisonError::into_inner);
    let now = Moment { text: document.text.clone(), cursor: cursor(ui, id(document)).unwrap_or_default() };
    history.undoer.add_undo(&now);
    history.held = true;
}

/// The hand has let go.
pub fn release(ui: &Ui, document: &Document) {
    let shared = shared(ui, id(document), document);
    let mut history = shared.lock().unwrap_or_else(PoisonError::into_inner);
    if std::mem::take(&mut history.held) {
        history.ends = 2;
    }
}

/// The next edit is a step of its own.
pub fn step(ui: &Ui, document: &Document) {
    hold(ui, document);
    release(ui, document);
}

/// Hears what the window made of a text.
pub fn expect(ui: &Ui, id: Id, document: &Document, text: &str) {
    let shared = shared(ui, id, document);
    let mut history = shared.lock().unwrap_or_else(PoisonError::into_inner);
    text.clone_into(&mut history.expected);
}

/// How many characters two texts share at their beginnings, and how many more at their ends.
fn shared_ends(old: &str, new: &str) -> [usize; 2] {
    let before = old.chars().zip(new.chars()).take_while(|(a, b)| a == b).count();
    let [of_old, of_new] = [old, new].map(|text| text.chars().count());
    let most = of_old.min(of_new) - before;
    let after = old.chars().rev().zip(new.chars().rev()).take(most).take_while(|(a, b)| a == b).count();
    [before, after]
}

/// Where the cursor goes when a text becomes that of a moment: as it was then where that is at what changes, else behind what changes.
fn place(old: &str, moment: &Moment) -> CCursorRange {
    let [before, after] = shared_ends(old, &moment.text);
    let changed = before..=moment.text.chars().count() - after;
    let CCursorRange { primary, secondary, .. } = moment.cursor;
    match [primary, secondary].iter().all(|end| changed.contains(&end.index.0)) {
        true => moment.cursor,
        false => CCursorRange::one(CCursor::new(*changed.end())),
    }
}

/// Where a character of a text is in another one, which differs from it in one piece.
fn carried(old: &str, new: &str, at: usize) -> usize {
    let [before, after] = shared_ends(old, new);
    let [of_old, of_new] = [old, new].map(|text| text.chars().count());
    match at {
        at if at >= of_old - after && at > before => of_new - of_old.saturating_sub(at),
        at => at.min(of_new - after).min(at.max(before)),
    }
}

#[cfg(test)]
mod tests {
    use super::{CCursor, CCursorRange, Moment, carried, place};

    #[test]
    fn a_cursor_goes_to_what_changes() {
        let cursor = |at| CCursorRange::one(CCursor::new(at));
        let moment = |text: &str, cursor| Moment { text: text.to_owned(), cursor };
        assert_eq!(place("one\ntwo\nx", &moment("one\ntwo\n", cursor(3))), cursor(8), "what was typed is gone");
        assert_eq!(place("one\nthree", &moment("one\nzwo\nthree", cursor(0))), cursor(8), "what was deleted is there again");
        let selected = CCursorRange::two(CCursor::new(4), CCursor::new(7));
        assert_eq!(place("one\n\nthree", &moment("one\ntwo\nthree", selected)), selected, "as it was selected");
    }

    #[test]
    fn a_cursor_stays_at_its_place() {
        let old = "one\ntwo\nthree";
        assert_eq!(carried(old, "zero\none\ntwo\nthree", 8), 13, "lines before it");
        assert_eq!(carried(old, "one\ntwo\nthree\nfour", 8), 8, "lines after it");
        assert_eq!(carried(old, "one\ntwo, and a half\nthree", 8), 20);
        assert_eq!(carried(old, "one\nthree", 6), 5, "where it was is gone");
        assert_eq!(carried(old, "", 6), 0);
        assert_eq!(carried("", old, 0), 0);
        assert_eq!(carried(old, old, 13), 13);
    }
}
