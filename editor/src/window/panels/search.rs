//! Finding words and lines in the text that is shown, and putting others in their place.

use crate::window::command::Command;
use crate::window::document::Document;
use crate::window::panels::cursor::selection;
use crate::window::panels::{history, icons};
use crate::window::session::{Place, Search, Session};
use crate::window::theme;
use egui::text::{CCursor, CCursorRange};
use egui::text_edit::{TextEditOutput, TextEditState};
use egui::{Button, Color32, Id, Key, KeyboardShortcut, Modifiers, Rect, RichText, Role, Stroke, StrokeKind, TextEdit, Ui, WidgetInfo};
use std::ops::Range;

/// How what is found is marked.
const FOUND: Color32 = Color32::from_rgba_unmultiplied_const(0xe0, 0x9f, 0x4a, 0x46);

fn field() -> Id {
    Id::unique("search")
}

/// Where it is written what comes instead.
fn other_field() -> Id {
    Id::unique("instead")
}

/// Whether what is typed goes to the search.
pub fn has_keyboard(ui: &Ui) -> bool {
    ui.memory(|m| m.has_focus(field()) || m.has_focus(other_field()))
}

/// Keys that open the search, or go on with it.
pub fn keys(ui: &Ui, session: &Session, commands: &mut Vec<Command>) {
    if session.question.is_some() || session.notice.is_some() {
        return;
    }
    let pressed = |modifiers, key| ui.input_mut(|i| i.consume_shortcut(&KeyboardShortcut::new(modifiers, key)));
    let document = session.documents.current();
    let before = session.search.clone().unwrap_or_default();
    let replaces = document.is_editable() && pressed(Modifiers::COMMAND, Key::H);
    let opened = if replaces || pressed(Modifiers::COMMAND, Key::F) {
        // What is selected is what is looked for.
        let at = cursor(ui, document, session.search.as_ref());
        let selected = document.text.get(at.clone()).unwrap_or_default();
        let before = Some(&*before.wanted).filter(|wanted| !wanted.starts_with(':'));
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
        let instead = if replaces { Some(before.instead.clone().unwrap_or_default()) } else { before.instead.clone().filter(|_| wanted != ":") };
        commands.push(Command::Search(Some(Search { wanted: wanted.to_owned(), at, instead, ..before })));
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
    let here = ui.memory(|m| m.has_focus(field()));
    let pressed = |modifiers, key| here && ui.input_mut(|i| i.consume_key(modifiers, key));
    let (forwards, backwards) = (pressed(Modifiers::NONE, Key::Enter), pressed(Modifiers::SHIFT, Key::Enter));
    // egui has taken the keyboard from the field by now.
    let asks = session.question.is_some() || session.notice.is_some();
    let closes = !asks && ui.input_mut(|i| i.consume_key(Modifiers::NONE, Key::Escape));
    ui.horizontal(|ui| {
        let width = width(ui);
        let mut wanted = search.wanted.clone();
        let edit = TextEdit::singleline(&mut wanted).id(field()).hint_text("find, or :line").desired_width(width);
        let response = edit.show(ui).response.response;
        icons::name(ui, field(), "Find");
        if response.changed() {
            let changed = Search { wanted, ..search.clone() };
            commands.push(Command::Search(Some(changed.clone())));
            go(ui, document, &changed, Way::Here, commands);
        }
        let left = response.lost_focus();
        let mut switches = search.clone();
        for (text, name, on) in [("Aa", "Capitals count", &mut switches.case), ("\"w\"", "Whole words only", &mut switches.whole)] {
            let switch = ui.add(Button::selectable(*on, text).small()).on_hover_text(name.to_lowercase());
            switch.widget_info(|| WidgetInfo::selected(Role::CheckBox, true, *on, name));
            if switch.clicked() {
                *on = !*on;
            }
        }
        if switches != *search {
            commands.push(Command::Search(Some(switches)));
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
        if arrives || closes && left {
            commands.push(Command::Jump(place(document, &search.at)));
        }
        if arrives || closes || close.on_hover_text("Escape").clicked() {
            commands.extend([Command::Search(None), Command::Focus]);
        }
        let words = match hits(&document.text, search) {
            _ if search.word().is_empty() => String::new(),
            hits if hits.is_empty() => "nothing".to_owned(),
            hits => match hits.iter().position(|hit| *hit == search.at) {
                Some(at) => format!("{} of {}", at + 1, hits.len()),
                None => format!("{}", hits.len()),
            },
        };
        ui.label(RichText::new(words).color(theme::WEAK));
    });
    if let Some(instead) = search.instead.as_ref().filter(|_| document.is_editable()) {
        replace(ui, document, search, instead, commands);
    }
}

/// How wide the fields are: the buttons behind them have room too.
fn width(ui: &Ui) -> f32 {
    (ui.available_width() - 325.0).clamp(70.0, 200.0)
}

/// The row that says what comes instead.
fn replace(ui: &mut Ui, document: &Document, search: &Search, instead: &str, commands: &mut Vec<Command>) {
    let here = ui.memory(|m| m.has_focus(other_field()));
    let pressed = |modifiers, key| here && ui.input_mut(|i| i.consume_key(modifiers, key));
    let (all, one) = (pressed(Modifiers::COMMAND, Key::Enter), pressed(Modifiers::NONE, Key::Enter));
    ui.horizontal(|ui| {
        let width = width(ui);
        let mut written = instead.to_owned();
        let edit = TextEdit::singleline(&mut written).id(other_field()).hint_text("replace by").desired_width(width);
        let response = edit.show(ui).response.response;
        icons::name(ui, other_field(), "Replace by");
        if response.changed() {
            commands.push(Command::Search(Some(Search { instead: Some(written), ..search.clone() })));
        }
        let hits = hits(&document.text, search);
        let button = |ui: &mut Ui, name| ui.add_enabled(!hits.is_empty(), Button::new(name).small());
        let (single, every) = (button(ui, "replace"), button(ui, "replace all"));
        if one || single.on_hover_text("this one, then the next is shown (Enter)").clicked() {
            replace_one(ui, document, search, instead, &hits, commands);
        }
        if (all || every.on_hover_text("all of them, as one step (Ctrl+Enter)").clicked()) && !hits.is_empty() {
            let mut text = String::with_capacity(document.text.len());
            let mut from = 0;
            for hit in &hits {
                text.push_str(document.text.get(from..hit.start).unwrap_or_default());
                text.push_str(instead);
                from = hit.end;
            }
            text.push_str(document.text.get(from..).unwrap_or_default());
            history::step(ui, document);
            commands.push(Command::Edit(text));
        }
    });
}

/// Puts what is wanted in the place that was found last, and goes to the next; where nothing was found yet it only goes there.
fn replace_one(ui: &Ui, document: &Document, search: &Search, instead: &str, hits: &[Range<usize>], commands: &mut Vec<Command>) {
    if !hits.contains(&search.at) {
        return go(ui, document, search, Way::Here, commands);
    }
    let mut text = document.text.clone();
    text.replace_range(search.at.clone(), instead);
    let end = search.at.start + instead.len();
    let next = self::hits(&text, search);
    let at = next.iter().find(|hit| hit.start >= end).or(next.first()).cloned().unwrap_or(search.at.start..end);
    history::step(ui, document);
    let file = document.name.clone();
    let place = Place { file, start: position(&text, at.start), end: position(&text, at.end) };
    commands.extend([Command::Edit(text), Command::Jump(place), Command::Search(Some(Search { at, ..search.clone() }))]);
}

/// Marks what is found, where it is in sight.
pub fn mark(ui: &Ui, session: &Session, document: &Document, output: &TextEditOutput) {
    let Some(search) = &session.search else { return };
    let visible = ui.clip_rect();
    let rows = || output.galley.rows.iter().map(|row| (row.rect().translate(output.galley_pos.to_vec2()), row));
    // The characters that are in sight.
    let (mut begin, mut seen) = (0, None);
    for (rect, row) in rows() {
        let end = begin + row.char_count_including_newline().0;
        if rect.max.y >= visible.min.y && rect.min.y <= visible.max.y {
            seen = Some((seen.map_or(begin, |(first, _): (usize, usize)| first), end));
        }
        begin = end;
    }
    let (mut byte, mut character) = (0, 0);
    for hit in hits(&document.text, search) {
        let mut count = |to: usize| {
            character += document.text.get(byte..to).unwrap_or_default().chars().count();
            byte = to;
            character
        };
        let (start, end) = (count(hit.start), count(hit.end));
        if seen.is_none_or(|(first, last)| end < first || start > last) {
            continue;
        }
        let place = |at: usize| output.galley.pos_from_cursor(CCursor::new(at)).translate(output.galley_pos.to_vec2());
        let around = Rect::from_min_max(place(start).min, place(end).max);
        ui.painter().rect_filled(around, 2.0, FOUND);
        if search.at == hit {
            ui.painter().rect_stroke(around, 2.0, Stroke::new(1.0, *theme::ACCENT), StrokeKind::Outside);
        }
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
            let hits = hits(text, search);
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
        commands.push(Command::Search(Some(Search { at, ..search.clone() })));
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

/// Where something stands in a text, in bytes.
fn hits(text: &str, search: &Search) -> Vec<Range<usize>> {
    let wanted = search.word();
    if wanted.is_empty() {
        return Vec::new();
    }
    // Letters of ASCII alone: others may change their length with their size.
    let fold = |text: &str| if search.case { text.to_owned() } else { text.to_ascii_lowercase() };
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    let is_whole = |hit: &Range<usize>| {
        let (before, after) = (text.get(..hit.start).unwrap_or_default(), text.get(hit.end..).unwrap_or_default());
        !before.ends_with(is_part) && !after.starts_with(is_part)
    };
    let (text, wanted) = (fold(text), fold(wanted));
    let found = text.match_indices(&wanted).map(|(at, found)| at..at + found.len());
    found.filter(|hit| !search.whole || is_whole(hit)).collect()
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
        let search = |wanted: &str, case, whole| Search { wanted: wanted.to_owned(), case, whole, ..Search::default() };
        assert_eq!(hits("Sphere | sphere", &search("Sphere", false, false)), [0..6, 9..15]);
        assert_eq!(hits("Sphere | sphere", &search("Sphere", true, false)), [0..6]);
        assert_eq!(hits("box | boxes | box_2 | box", &search("box", false, true)), [0..3, 22..25]);
        assert_eq!(hits("é box É box", &search("box", true, true)), [3..6, 10..13]);
        assert!(hits("box", &search("", false, false)).is_empty() && hits("", &search("box", false, false)).is_empty());
        assert_eq!(position("a\né b", 5), (2, 3));
        assert_eq!((line(":12"), line("12"), line(":x"), line(":")), (Some(12), None, None, None));
    }
}
