//! Finding words and lines in the text that is shown.

use crate::window::command::Command;
use crate::window::document::Document;
use crate::window::panels::cursor::selection;
use crate::window::panels::icons;
use crate::window::session::{Place, Search, Session};
use crate::window::theme;
use egui::text::{CCursor, CCursorRange, CharIndex};
use egui::text_edit::{TextEditOutput, TextEditState};
use egui::{Color32, Id, Key, KeyboardShortcut, Modifiers, Rect, RichText, Stroke, StrokeKind, TextEdit, Ui};
use std::ops::Range;

/// How what is found is marked.
const FOUND: Color32 = Color32::from_rgba_unmultiplied_const(0xe0, 0x9f, 0x4a, 0x46);

fn field() -> Id {
    Id::unique("search")
}

/// Whether what is typed goes to the search.
pub fn has_keyboard(ui: &Ui) -> bool {
    ui.memory(|m| m.has_focus(field()))
}

/// Keys that open the search, or go on with it.
pub fn keys(ui: &Ui, session: &Session, commands: &mut Vec<Command>) {
    if session.question.is_some() || session.notice.is_some() {
        return;
    }
    let pressed = |modifiers, key| ui.input_mut(|i| i.consume_shortcut(&KeyboardShortcut::new(modifiers, key)));
    let document = session.documents.current();
    let opened = if pressed(Modifiers::COMMAND, Key::F) {
        // What is selected is what is looked for.
        let at = cursor(ui, document, session.search.as_ref());
        let selected = document.text.get(at.clone()).unwrap_or_default();
        let before = session.search.as_ref().map(|search| &*search.wanted).filter(|wanted| !wanted.starts_with(':'));
        let is_word = !selected.is_empty() && !selected.contains('\n');
        Some(if is_word { selected } else { before.unwrap_or_default() })
    } else if pressed(Modifiers::COMMAND, Key::G) {
        Some(":")
    } else {
        None
    };
    if let Some(wanted) = opened {
        let at = cursor(ui, document, session.search.as_ref());
        // All of it is selected, but for the sign of a line.
        let signs = usize::from(wanted == ":");
        let mut state = TextEditState::load(ui.ctx(), field()).unwrap_or_default();
        let all = CCursorRange::two(CCursor::new(signs), CCursor::new(wanted.chars().count()));
        state.cursor.set_char_range(Some(all));
        state.store(ui.ctx(), field());
        ui.memory_mut(|m| m.request_focus(field()));
        commands.push(Command::Search(Some(Search { wanted: wanted.to_owned(), at })));
    } else if let Some(search) = &session.search {
        let backwards = pressed(Modifiers::SHIFT, Key::F3);
        if backwards || pressed(Modifiers::NONE, Key::F3) {
            go(ui, document, search, if backwards { Way::Before } else { Way::After }, commands);
        }
    }
}

/// The bar over the text, where something is looked for.
pub fn show(ui: &mut Ui, session: &Session, document: &Document, commands: &mut Vec<Command>) {
    let Some(search) = &session.search else { return };
    let here = has_keyboard(ui);
    let pressed = |modifiers, key| here && ui.input_mut(|i| i.consume_key(modifiers, key));
    let (forwards, backwards) = (pressed(Modifiers::NONE, Key::Enter), pressed(Modifiers::SHIFT, Key::Enter));
    // egui has taken the keyboard from the field by now.
    let asks = session.question.is_some() || session.notice.is_some();
    let closes = !asks && ui.input_mut(|i| i.consume_key(Modifiers::NONE, Key::Escape));
    ui.horizontal(|ui| {
        let mut wanted = search.wanted.clone();
        let edit = TextEdit::singleline(&mut wanted).id(field()).hint_text("find, or :line").desired_width(200.0);
        let response = edit.show(ui).response.response;
        icons::name(ui, field(), "Find");
        if response.changed() {
            let changed = Search { wanted, at: search.at.clone() };
            commands.push(Command::Search(Some(changed.clone())));
            go(ui, document, &changed, Way::Here, commands);
        }
        let (after, earlier, close) = (ui.small_button("next"), ui.small_button("previous"), ui.small_button("close"));
        let is_line = line(&search.wanted).is_some();
        if forwards && !is_line || after.on_hover_text("Enter, or F3").clicked() {
            go(ui, document, search, Way::After, commands);
        }
        if backwards || earlier.on_hover_text("Shift+Enter, or Shift+F3").clicked() {
            go(ui, document, search, Way::Before, commands);
        }
        // Whoever has named a line is there.
        let arrives = forwards && is_line;
        if arrives || closes && response.lost_focus() {
            commands.push(Command::Jump(place(document, &search.at)));
        }
        if arrives || closes || close.on_hover_text("Escape").clicked() {
            commands.extend([Command::Search(None), Command::Focus]);
        }
        let words = match hits(&document.text, search.word()) {
            _ if search.word().is_empty() => String::new(),
            hits if hits.is_empty() => "nothing".to_owned(),
            hits => match hits.iter().position(|hit| *hit == search.at) {
                Some(at) => format!("{} of {}", at + 1, hits.len()),
                None => format!("{}", hits.len()),
            },
        };
        ui.label(RichText::new(words).color(theme::WEAK));
    });
}

/// Marks what is found, where it is in sight.
pub fn mark(ui: &Ui, session: &Session, output: &TextEditOutput) {
    let Some(search) = &session.search else { return };
    let visible = ui.clip_rect();
    let mut begin = 0;
    for placed in &output.galley.rows {
        let rect = placed.rect().translate(output.galley_pos.to_vec2());
        let text = placed.row.text();
        if rect.max.y >= visible.min.y && rect.min.y <= visible.max.y {
            for hit in hits(&text, search.word()) {
                let column = |byte: usize| text.get(..byte).unwrap_or_default().chars().count();
                let x = |byte: usize| rect.min.x + placed.row.x_offset(CharIndex(column(byte)));
                let around = Rect::from_x_y_ranges(x(hit.start)..=x(hit.end), rect.y_range());
                ui.painter().rect_filled(around, 2.0, FOUND);
                if search.at == (begin + hit.start..begin + hit.end) {
                    ui.painter().rect_stroke(around, 2.0, Stroke::new(1.0, theme::ACCENT), StrokeKind::Outside);
                }
            }
        }
        begin += text.len() + usize::from(placed.ends_with_newline);
    }
}

/// Which way to look for the next place.
#[derive(Clone, Copy, PartialEq)]
enum Way {
    /// Where the cursor is, or after it.
    Here,
    /// After it.
    After,
    /// Before it.
    Before,
}

/// Goes to the next place of what is wanted, from the end on from the beginning.
fn go(ui: &Ui, document: &Document, search: &Search, way: Way, commands: &mut Vec<Command>) {
    let text = &document.text;
    let found = match line(&search.wanted) {
        Some(line) => {
            let at = text.match_indices('\n').nth(line.max(2) as usize - 2).map_or(text.len(), |(at, _)| at + 1);
            let at = if line < 2 { 0 } else { at };
            Some(at..at)
        }
        None => {
            let hits = hits(text, search.word());
            let at = cursor(ui, document, Some(search)).start;
            let found = match way {
                Way::Here => hits.iter().find(|hit| hit.start >= at).or(hits.first()),
                Way::After => hits.iter().find(|hit| hit.start > at).or(hits.first()),
                Way::Before => hits.iter().rev().find(|hit| hit.start < at).or(hits.last()),
            };
            found.cloned()
        }
    };
    if let Some(at) = found {
        commands.push(Command::Jump(place(document, &at)));
        commands.push(Command::Search(Some(Search { wanted: search.wanted.clone(), at })));
    }
}

/// What is selected, in bytes: in the text while its cursor moves, else what was found last.
fn cursor(ui: &Ui, document: &Document, search: Option<&Search>) -> Range<usize> {
    match search {
        Some(search) if has_keyboard(ui) => search.at.clone(),
        _ => {
            let selection = selection(ui, document);
            let byte = |character: usize| document.text.char_indices().nth(character).map_or(document.text.len(), |(at, _)| at);
            byte(selection.start)..byte(selection.end)
        }
    }
}

/// The place of some bytes.
fn place(document: &Document, at: &Range<usize>) -> Place {
    let (start, end) = (position(&document.text, at.start), position(&document.text, at.end));
    Place { file: document.name.clone(), start, end }
}

/// The line that is meant by `:12`.
fn line(wanted: &str) -> Option<u32> {
    wanted.strip_prefix(':')?.trim().parse().ok()
}

/// Where something stands in a text, in bytes. Capitals count where some are wanted.
fn hits(text: &str, wanted: &str) -> Vec<Range<usize>> {
    if wanted.is_empty() {
        return Vec::new();
    }
    // Letters of ASCII alone: others may change their length with their size.
    let folds = !wanted.contains(|c: char| c.is_ascii_uppercase());
    let text = if folds { text.to_ascii_lowercase().into() } else { std::borrow::Cow::Borrowed(text) };
    text.match_indices(wanted).map(|(at, found)| at..at + found.len()).collect()
}

/// The line and column of a byte.
fn position(text: &str, byte: usize) -> (u32, u32) {
    let before = text.get(..byte).unwrap_or_default();
    let line = before.matches('\n').count() as u32 + 1;
    let column = before.rsplit('\n').next().unwrap_or_default().chars().count() as u32 + 1;
    (line, column)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_found() {
        assert_eq!(hits("Sphere | sphere", "sphere"), [0..6, 9..15]);
        assert_eq!(hits("Sphere | sphere", "Sphere").first(), Some(&(0..6)));
        assert_eq!(hits("é box É box", "box"), [3..6, 10..13]);
        assert!(hits("box", "").is_empty() && hits("", "box").is_empty());
        assert_eq!(position("a\né b", 5), (2, 3));
        assert_eq!((line(":12"), line("12"), line(":x"), line(":")), (Some(12), None, None, None));
    }
}
