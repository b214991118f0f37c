//! Numbers that are dragged in the text: with Ctrl (or Alt) a number is a slider, and Alt with an arrow changes the one at the cursor.

use crate::window::command::Command;
use crate::window::document::Document;
use crate::window::holding::Number;
use crate::window::panels::cursor::{byte, caret, id};
use crate::window::panels::history;
use egui::text::{CCursor, CCursorRange};
use egui::text_edit::{TextEditOutput, TextEditState};
use egui::{CursorIcon, Id, Key, Modifiers, Rect, Sense, Ui};
use std::ops::Range;
use surefoot_compiler::syntax::{TokenClass, tokens};

/// So many points of a drag are a step.
const POINTS: f32 = 6.0;

/// A number as a text writes it.
#[derive(Clone, Debug, PartialEq)]
struct Literal {
    /// Its bytes, with a sign that is its own.
    range: Range<usize>,
    /// The number before its exponent and unit.
    value: f64,
    /// How many digits stand behind its point.
    decimals: usize,
    /// Exponent and unit.
    tail: String,
    /// Whether an operator stands before it, behind which no second sign may stand bare.
    follows_operator: bool,
}

/// A number that a hand drags.
#[derive(Clone, Debug)]
struct Drag {
    literal: Literal,
    /// What stands in its place by now.
    written: String,
    /// Where the hand was last.
    x: f32,
    /// How far it was dragged, in points, and how far with Shift.
    coarse: f32,
    fine: f32,
}

impl Literal {
    /// The number that a byte of a text belongs to.
    fn at(text: &str, at: usize) -> Option<Self> {
        let found = tokens(text).into_iter().find(|(range, class)| *class == TokenClass::Number && range.start <= at && at <= range.end);
        let (mut range, _) = found?;
        let written = text.get(range.clone())?;
        let digits = written.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(written.len());
        let (number, tail) = written.split_at(digits);
        let decimals = number.split_once('.').map_or(0, |(_, after)| after.len());
        let mut value: f64 = number.parse().ok()?;
        let before = text.get(..range.start)?;
        let is_operator = |text: &str| text.trim_end().ends_with(['-', '+', '*', '/', '^', '%', '<', '>']);
        // Behind a value a minus takes away.
        let is_prefix = |text: &str| {
            let text = text.trim_end();
            let word = text.rsplit(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or_default();
            matches!(word, "in" | "return" | "else" | "then") || word.is_empty() && !text.ends_with([')', ']', '}'])
        };
        let mut follows_operator = is_operator(before);
        if let Some(rest) = before.strip_suffix('-')
            && is_prefix(rest)
        {
            range.start -= 1;
            value = -value;
            follows_operator = is_operator(rest);
        }
        Some(Self { range, value, decimals, tail: tail.to_owned(), follows_operator })
    }

    /// The number that stands in its place as it is written by now.
    fn number(&self, written: &str) -> Number {
        let bare = written.trim_matches(['(', ')']);
        let bare = bare.strip_suffix(self.tail.as_str()).unwrap_or(bare);
        let decimals = bare.split_once('.').map_or(0, |(_, after)| after.len());
        let range = self.range.start..self.range.start + written.len();
        Number { range, value: bare.parse().unwrap_or(self.value), decimals, tail: self.tail.clone() }
    }

    /// What stands in its place after so many steps of its last digit, and so many of a tenth of them.
    fn stepped(&self, steps: f64, tenths: f64) -> String {
        let decimals = if tenths == 0.0 { self.decimals } else { self.decimals + 1 };
        let unit = 10f64.powi(-(self.decimals.min(300) as i32));
        let value = self.value + unit * (steps + 0.1 * tenths);
        let number = format!("{value:.decimals$}");
        let is_zero = !number.contains(|c: char| c.is_ascii_digit() && c != '0');
        let number = if is_zero { number.trim_start_matches('-') } else { &number };
        let tail = &self.tail;
        match number.starts_with('-') && self.follows_operator {
            true => format!("({number}{tail})"),
            false => format!("{number}{tail}"),
        }
    }
}

/// Changes the number at the cursor where a key says so; answers whether the text was changed. Before the text sees the keys.
pub fn keys(ui: &Ui, document: &Document, text: &mut String) -> bool {
    if !document.is_editable() || !ui.memory(|m| m.has_focus(id(document))) {
        return false;
    }
    let steps = [(Key::ArrowUp, 1.0), (Key::ArrowDown, -1.0)].into_iter().find_map(|(key, step)| {
        let pressed = |modifiers| ui.input_mut(|input| input.consume_key(modifiers, key));
        if pressed(Modifiers::ALT | Modifiers::SHIFT) { Some((0.0, step)) } else { pressed(Modifiers::ALT).then_some((step, 0.0)) }
    });
    let (Some((steps, tenths)), Some(at)) = (steps, caret(ui, document)) else { return false };
    let Some(literal) = Literal::at(text, byte(text, at)) else { return false };
    let written = literal.stepped(steps, tenths);
    text.replace_range(literal.range.clone(), &written);
    // Before its unit, so that the next key finds it again.
    let end = CCursor::new(text[..literal.range.start + written.len()].chars().count());
    let mut state = TextEditState::load(ui.ctx(), id(document)).unwrap_or_default();
    state.cursor.set_char_range(Some(CCursorRange::one(end)));
    state.store(ui.ctx(), id(document));
    true
}

/// Lets a hand drag the number under the pointer. After the text was shown.
pub fn show(ui: &Ui, document: &Document, output: &TextEditOutput, commands: &mut Vec<Command>) {
    let slot = Id::unique(("dragged number", &document.name));
    let Some(mut drag) = ui.data(|data| data.get_temp::<Drag>(slot)).or_else(|| begin(ui, document, output, slot, commands)) else { return };
    let (is_down, at, is_fine) = ui.input(|i| (i.pointer.primary_down(), i.pointer.latest_pos(), i.modifiers.shift));
    let range = drag.literal.range.start..drag.literal.range.start + drag.written.len();
    let is_there = document.text.get(range.clone()) == Some(drag.written.as_str());
    // Kept in sight of egui, so that nothing else takes the drag.
    ui.interact(place(document, output, &range).intersect(ui.clip_rect()), slot, Sense::CLICK | Sense::DRAG);
    ui.ctx().set_cursor_icon(CursorIcon::ResizeHorizontal);
    if let Some(at) = at.filter(|at| is_there && at.x != drag.x) {
        let part = if is_fine { &mut drag.fine } else { &mut drag.coarse };
        *part += at.x - drag.x;
        drag.x = at.x;
        let [coarse, fine] = [drag.coarse, drag.fine].map(|points| f64::from((points / POINTS).round()));
        let written = drag.literal.stepped(coarse, fine);
        if written != drag.written {
            let mut text = document.text.clone();
            text.replace_range(range, &written);
            let number = drag.literal.number(&written);
            drag.written = written;
            commands.push(Command::DragNumber { text, number });
        }
    }
    if is_down && is_there {
        ui.data_mut(|data| data.insert_temp(slot, drag));
    } else {
        history::release(ui, document);
        ui.data_mut(|data| data.remove::<Drag>(slot));
    }
}

/// Takes the number that a hand presses on. The pointer says over which one it may.
fn begin(ui: &Ui, document: &Document, output: &TextEditOutput, slot: Id, commands: &mut Vec<Command>) -> Option<Drag> {
    let (is_asked, is_pressed) = ui.input(|i| (i.modifiers.command || i.modifiers.alt, i.pointer.primary_pressed()));
    // Where the hand pressed: on a busy machine it may be farther by now.
    let at = ui.input(|i| if is_pressed { i.pointer.press_origin() } else { i.pointer.hover_pos() });
    let at = at.filter(|at| is_asked && document.is_editable() && ui.clip_rect().contains(*at) && ui.rect_contains_pointer(output.response.rect))?;
    let within = at - output.galley_pos;
    if !output.galley.rows.iter().any(|row| row.rect().contains(within.to_pos2())) {
        return None;
    }
    let literal = Literal::at(&document.text, byte(&document.text, output.galley.cursor_from_pos(within).index.0))?;
    ui.interact(place(document, output, &literal.range).intersect(ui.clip_rect()), slot, Sense::CLICK | Sense::DRAG).on_hover_cursor(CursorIcon::ResizeHorizontal);
    if !is_pressed {
        return None;
    }
    ui.ctx().set_dragged_id(slot);
    history::hold(ui, document);
    let written = document.text.get(literal.range.clone())?.to_owned();
    commands.push(Command::HoldNumber(literal.number(&written)));
    Some(Drag { literal, written, x: at.x, coarse: 0.0, fine: 0.0 })
}

/// Where a piece of the text is on the screen.
fn place(document: &Document, output: &TextEditOutput, range: &Range<usize>) -> Rect {
    let at = |byte: usize| {
        let character = document.text.get(..byte).unwrap_or_default().chars().count();
        output.galley.pos_from_cursor(CCursor::new(character)).translate(output.galley_pos.to_vec2())
    };
    Rect::from_min_max(at(range.start).min, at(range.end).max)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stepped(text: &str, at: usize, steps: f64, tenths: f64) -> String {
        let literal = Literal::at(text, at).unwrap();
        let mut text = text.to_owned();
        text.replace_range(literal.range.clone(), &literal.stepped(steps, tenths));
        text
    }

    #[test]
    fn a_step_fits_the_digits() {
        assert_eq!(stepped("sphere(0.25)", 9, 3.0, 0.0), "sphere(0.28)");
        assert_eq!(stepped("sphere(0.25)", 9, 0.0, -3.0), "sphere(0.247)");
        assert_eq!(stepped("box(1)", 4, -2.0, 0.0), "box(-1)");
        assert_eq!(stepped("box(1)", 4, 0.0, 5.0), "box(1.5)");
        assert_eq!(stepped("a.rotate(y, 30deg)", 13, 15.0, 0.0), "a.rotate(y, 45deg)");
        assert_eq!(stepped("1.5e-3", 0, 1.0, 0.0), "1.6e-3");
    }

    #[test]
    fn signs_stay_right() {
        assert_eq!(stepped("box(-1)", 5, 1.0, 0.0), "box(0)");
        assert_eq!(stepped("box(-1)", 5, 3.0, 0.0), "box(2)");
        assert_eq!(stepped("p.x - 1", 6, -3.0, 0.0), "p.x - (-2)");
        assert_eq!(stepped("p.x * -1", 7, -1.0, 0.0), "p.x * (-2)");
        assert_eq!(stepped("in -1..1", 4, -1.0, 0.0), "in -2..1");
    }

    #[test]
    fn what_is_no_number_is_none() {
        assert!(Literal::at("box(a1)", 5).is_none());
        assert!(Literal::at("// 12", 4).is_none());
        assert!(Literal::at("#d02010", 2).is_none());
    }
}
