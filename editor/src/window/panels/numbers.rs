//! Numbers that are dragged in the text: with Ctrl (or Alt) a number is a slider, and Alt with an arrow changes the one at the cursor.

use crate::window::command::Command;
use crate::window::document::Document;
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
    /// How far it was dragged, in points, and the part of it with Shift.
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
    let held = ui.data(|data| data.get_temp::<Drag>(slot));
    let under = || {
        let is_asked = ui.input(|i| i.modifiers.command || i.modifiers.alt);
        let at = ui.input(|i| i.pointer.hover_pos()).filter(|_| is_asked && document.is_editable() && ui.rect_contains_pointer(output.response.rect))?;
        let at = at - output.galley_pos;
        let is_text = output.galley.rows.iter().any(|row| row.rect().contains(at.to_pos2()));
        Literal::at(&document.text, byte(&document.text, output.galley.cursor_from_pos(at).index.0)).filter(|_| is_text)
    };
    let Some(range) = held.as_ref().map(|drag| drag.literal.range.start..drag.literal.range.start + drag.written.len()).or_else(|| Some(under()?.range)) else { return };
    let end_it = || {
        history::release(ui, document);
        ui.data_mut(|data| data.remove::<Drag>(slot));
    };
    if held.as_ref().is_some_and(|drag| document.text.get(range.clone()) != Some(drag.written.as_str())) {
        return end_it();
    }
    let place = |byte: usize| {
        let character = document.text.get(..byte).unwrap_or_default().chars().count();
        output.galley.pos_from_cursor(CCursor::new(character)).translate(output.galley_pos.to_vec2())
    };
    let rect = Rect::from_min_max(place(range.start).min, place(range.end).max);
    let response = ui.interact(rect.intersect(ui.clip_rect()), slot, Sense::click_and_drag()).on_hover_and_drag_cursor(CursorIcon::ResizeHorizontal);
    let drag = match held {
        None if response.drag_started() => Literal::at(&document.text, range.start).map(|literal| {
            history::hold(ui, document);
            Drag { written: document.text.get(literal.range.clone()).unwrap_or_default().to_owned(), literal, coarse: 0.0, fine: 0.0 }
        }),
        held => held,
    };
    let Some(mut drag) = drag else { return };
    // A drag begins some points beside where the hand took it.
    let began = ui.input(|i| Some(i.pointer.latest_pos()?.x - i.pointer.press_origin()?.x)).filter(|_| response.drag_started());
    let moved = began.unwrap_or(response.drag_delta().x);
    let part = if ui.input(|i| i.modifiers.shift) { &mut drag.fine } else { &mut drag.coarse };
    *part += moved;
    let [coarse, fine] = [drag.coarse, drag.fine].map(|points| f64::from((points / POINTS).round()));
    let written = drag.literal.stepped(coarse, fine);
    if moved != 0.0 && written != drag.written {
        let mut text = document.text.clone();
        text.replace_range(range, &written);
        drag.written = written;
        commands.push(Command::EditOn(text));
    }
    if response.drag_stopped() || !response.dragged() && !response.drag_started() {
        return end_it();
    }
    ui.data_mut(|data| data.insert_temp(slot, drag));
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
