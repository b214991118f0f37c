//! The text: coloured, with lines' numbers, and problems underlined.

use crate::window::command::Command;
use crate::window::document::Document;
use crate::window::panels::cursor::{id, selection};
use crate::window::panels::marks::character;
use crate::window::panels::{advice, assist, colors, history, icons, lines, marks, notes, numbers, problems, renaming, search, tabs};
use crate::window::session::{Place, Session};
use crate::window::theme::{self, TEXT_SIZE, code};
use egui::cache::{ComputerMut, FrameCache};
use egui::text::{CCursor, CCursorRange, LayoutJob, TextFormat};
use egui::text_edit::{TextEditOutput, TextEditState};
use egui::{
    Align, Align2, Color32, Event, Frame, Galley, Id, Key, Margin, Modifiers, Rect, Response, RichText, ScrollArea, Stroke, TextBuffer,
    TextEdit, Ui, vec2,
};
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;
use surefoot_compiler::diagnostic::Severity;
use surefoot_compiler::factors::Explained;
use surefoot_compiler::graph::Proof;
use surefoot_compiler::syntax::{TokenClass, tokens};

/// From a line of the text to the next, for its size.
const LINE_HEIGHT: f32 = 17.0 / TEXT_SIZE;
/// How long the cursor blinks after the last that a hand did, in seconds.
pub const BLINKS: f64 = 10.0;

/// Shows the text and what belongs to it.
pub fn show(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    tabs::show(ui, session, commands);
    let document = session.documents.current();
    notes::show(ui, session, document, commands);
    search::show(ui, session, document, commands);
    editor(ui, session, document, commands);
}

fn editor(ui: &mut Ui, session: &Session, document: &Document, commands: &mut Vec<Command>) {
    let marks = marks::of(session, document);
    let lines = document.text.bytes().filter(|b| *b == b'\n').count() + 1;
    let digits = lines.to_string().len().max(2);
    let digit = ui.fonts_mut(|f| f.glyph_width(&theme::code_font(session.open.text_size), '0'));
    let gutter = (digits as f32 + 2.0) * digit;
    let room = Margin { left: gutter as i8, right: 6, top: 4, bottom: 4 };
    let id = id(document);
    let mut text = document.text.clone();
    // egui asks several times a frame, and a long text takes milliseconds.
    let mut laid_out: Option<(String, f32, Arc<Galley>)> = None;
    let mut layouter = |ui: &Ui, buffer: &dyn TextBuffer, width: f32| {
        if let Some((_, _, galley)) = laid_out.as_ref().filter(|(text, at, _)| text == buffer.as_str() && *at == width) {
            return galley.clone();
        }
        let manner = Manner::of(session, width);
        let job = ui.memory_mut(|m| {
            let cache = m.caches.cache::<FrameCache<LayoutJob, Colours>>();
            cache.get((buffer.as_str(), &marks, manner)).clone()
        });
        let galley = ui.fonts_mut(|f| f.layout_job(job));
        laid_out = Some((buffer.as_str().to_owned(), width, galley.clone()));
        galley
    };
    assist::hear(ui);
    renaming::keys(ui, session, document);
    colors::keys(ui, document);
    let by_lines = assist::keys(ui, session, document, &mut text, commands)
        || history::follow(ui, id, document, &mut text)
        || numbers::keys(ui, document, &mut text)
        || document.is_editable() && change_lines(ui, document, &mut text);
    advice::keys(ui, session, document, commands);
    lay_out_while_typing(ui, id, &document.text);
    let before = TextEditState::load(ui.ctx(), id).and_then(|state| state.cursor.char_range());
    let paged = page(ui, id, &text, session.open.text_size * LINE_HEIGHT);
    ui.visuals_mut().text_cursor.blink = !session.meter.software && blinks(ui, id);
    let area = if session.open.wrap { ScrollArea::vertical() } else { ScrollArea::both() };
    let area = area.id_salt(&document.name).auto_shrink([false, false]);
    Frame::new().fill(*theme::WELL).show(ui, |ui| {
        area.show(ui, |ui| {
            let output = TextEdit::multiline(&mut text)
                .id(id)
                .code_editor()
                .font(theme::code_font(session.open.text_size))
                .interactive(document.is_editable())
                .frame(Frame::new().inner_margin(room))
                .desired_width(f32::INFINITY)
                .min_size(ui.available_size())
                .layouter(&mut layouter)
                .show(ui);
            icons::name(ui, id, "Source text");
            search::mark(ui, session, document, &output);
            if by_lines || paged || output.cursor_range != before {
                keep_in_view(ui, &output, gutter);
            }
            numbers(ui, &output, gutter, session, &marks::by_line(&marks, &document.text));
            numbers::show(ui, document, &output, commands);
            colors::show(ui, document, &output, commands);
            explain_term(ui, &output, session, document);
            assist::show(ui, session, document, &output, commands);
            renaming::show(ui, session, document, &output, commands);
            if let Some(place) = &session.documents.jump {
                jump(ui, id, &output, &document.text, place);
                commands.push(Command::Jumped);
            }
            if session.documents.focus {
                ui.memory_mut(|m| m.request_focus(id));
                commands.push(Command::Focused);
            }
            if by_lines || output.response.changed() {
                history::expect(ui, id, document, &text);
                commands.push(Command::Edit(text));
            }
        });
    });
}

/// Whether the cursor of a window on a graphics card blinks: each blink draws the window anew, so it stands still where nobody has done anything
/// for a while. Where the adapter is a program, which takes a share of a core for that, it always stands still.
fn blinks(ui: &Ui, id: Id) -> bool {
    let (now, is_touched) = ui.input(|i| (i.time, !i.events.is_empty()));
    let last = ui.data_mut(|data| {
        let last = data.get_temp_mut_or(id.with("touched"), now);
        if is_touched {
            *last = now;
        }
        *last
    });
    now - last < BLINKS
}

/// Page Up and Page Down move the cursor, and with Shift what is selected, by as many lines as are seen; answers whether they did.
fn page(ui: &Ui, id: Id, text: &str, line_height: f32) -> bool {
    let Some(range) = TextEditState::load(ui.ctx(), id).and_then(|state| state.cursor.char_range()) else { return false };
    if !ui.memory(|m| m.has_focus(id)) {
        return false;
    }
    let asked = ui.input_mut(|input| {
        let mut pressed = |modifiers, key| input.consume_key(modifiers, key);
        [(Key::PageUp, false), (Key::PageDown, true)].into_iter().find_map(|(key, down)| {
            let extends = pressed(Modifiers::SHIFT, key);
            (extends || pressed(Modifiers::NONE, key)).then_some((down, extends))
        })
    });
    let Some((down, extends)) = asked else { return false };
    let seen = (ui.available_height() / line_height) as usize;
    let at = range.primary.index.0;
    let before: String = text.chars().take(at).collect();
    let line = before.matches('\n').count();
    let column = before.chars().rev().take_while(|c| *c != '\n').count();
    let last = text.matches('\n').count();
    let wanted = if down { (line + seen.max(2) - 1).min(last) } else { line.saturating_sub(seen.max(2) - 1) };
    let start = text.split('\n').take(wanted).map(|line| line.chars().count() + 1).sum::<usize>();
    let length = text.split('\n').nth(wanted).map_or(0, |line| line.chars().count());
    let new = CCursor::new(start + column.min(length));
    let mut state = TextEditState::load(ui.ctx(), id).unwrap_or_default();
    state.cursor.set_char_range(Some(CCursorRange::two(if extends { range.secondary } else { new }, new)));
    state.store(ui.ctx(), id);
    true
}

/// The cursor that was moved is seen, beside the numbers of the lines and not below them.
fn keep_in_view(ui: &Ui, output: &TextEditOutput, gutter: f32) {
    let Some(range) = output.cursor_range else { return };
    let mut rect = output.galley.pos_from_cursor(range.primary).translate(output.galley_pos.to_vec2());
    rect.min.x -= gutter;
    // What is far from what was seen comes with what stands around it.
    let seen = ui.clip_rect().y_range();
    let far = rect.max.y < seen.min - seen.span() || rect.min.y > seen.max + seen.span();
    ui.scroll_to_rect(rect, far.then_some(Align::Center));
}

/// Keys that change whole lines: Ctrl+/ makes comments of them; with several selected the tabulator moves them in, and Shift with it any out.
fn change_lines(ui: &Ui, document: &Document, text: &mut String) -> bool {
    let id = id(document);
    if !ui.memory(|m| m.has_focus(id)) {
        return false;
    }
    let selection = selection(ui, document);
    let is_several = text.chars().skip(selection.start).take(selection.len()).any(|c| c == '\n');
    let asked = ui.input_mut(|input| {
        let change = |event: &Event| match event {
            // On many keyboards the slash itself takes Shift.
            Event::Key { key: Key::Slash, pressed: true, modifiers, .. } if modifiers.command => Some(Change::Comment),
            Event::Key { key: Key::Tab, pressed: true, modifiers: Modifiers::SHIFT, .. } => Some(Change::Out),
            Event::Key { key: Key::Tab, pressed: true, modifiers: Modifiers::NONE, .. } if is_several => Some(Change::In),
            _ => None,
        };
        let at = input.events.iter().position(|event| change(event).is_some())?;
        change(&input.events.remove(at))
    });
    let Some(asked) = asked else { return false };
    let (new, selection) = match asked {
        Change::Comment => lines::comment(text, selection),
        Change::In => lines::shift(text, selection, true),
        Change::Out => lines::shift(text, selection, false),
    };
    *text = new;
    let mut state = TextEditState::load(ui.ctx(), id).unwrap_or_default();
    state.cursor.set_char_range(Some(CCursorRange::two(CCursor::new(selection.start), CCursor::new(selection.end))));
    state.store(ui.ctx(), id);
    true
}

/// What is done to whole lines.
enum Change {
    /// Comments, or code again.
    Comment,
    /// Farther in.
    In,
    /// Farther out.
    Out,
}

/// A new line begins where the one before did, and within a bracket that was just opened two spaces farther. A tabulator is two spaces.
fn lay_out_while_typing(ui: &Ui, id: Id, text: &str) {
    let Some(cursor) = TextEditState::load(ui.ctx(), id).and_then(|state| state.cursor.char_range()) else { return };
    let asked = ui.input(|i| i.key_pressed(Key::Enter) || i.key_pressed(Key::Tab));
    if !asked || !ui.memory(|m| m.has_focus(id)) {
        return;
    }
    let mut line: String = {
        let before: String = text.chars().take(cursor.sorted_cursors()[0].index.0).collect();
        before.rsplit('\n').next().unwrap_or_default().to_owned()
    };
    ui.input_mut(|input| {
        for event in &mut input.events {
            match event {
                // Several may come with one frame.
                Event::Text(typed) => line.push_str(typed),
                Event::Key { key: Key::Backspace, pressed: true, .. } => drop(line.pop()),
                Event::Key { key: Key::Tab, pressed: true, modifiers: Modifiers::NONE, .. } => {
                    line.push_str("  ");
                    *event = Event::Text("  ".to_owned());
                }
                Event::Key { key: Key::Enter, pressed: true, modifiers: Modifiers::NONE, .. } => {
                    let opens = line.trim_end().ends_with(['{', '(', '[']);
                    line = line.chars().take_while(|c| c.is_whitespace()).chain(if opens { "  " } else { "" }.chars()).collect();
                    // A new line alone is egui's own.
                    if !line.is_empty() {
                        *event = Event::Text(format!("\n{line}"));
                    }
                }
                _ => {}
            }
        }
    });
}

/// What the name under the pointer is, and what its term costs if that has a factor, when the pointer rests on it.
fn explain_term(ui: &Ui, output: &TextEditOutput, session: &Session, document: &Document) {
    let Some(at) = output.response.hover_pos() else { return };
    let at = at - output.galley_pos;
    // Beside the text is no term.
    if !output.galley.rows.iter().any(|row| row.rect().contains(at.to_pos2())) {
        return;
    }
    let at = output.galley.cursor_from_pos(at).index.0;
    let text = &document.text;
    let holds = |place: &Place| {
        place.file == document.name && (character(text, place.start)..character(text, place.end)).contains(&at)
    };
    // Of terms within terms the innermost.
    let size = |place: &Place| character(text, place.end) - character(text, place.start);
    let under = session.factors().filter(|(place, _)| holds(place)).min_by_key(|(place, _)| size(place));
    let said = assist::said(ui, session, document, at);
    if under.is_some() || said.is_some() {
        Response::clone(&output.response).on_hover_ui_at_pointer(|ui| {
            if let Some(said) = &said {
                assist::explain(ui, said);
            }
            if let Some((_, factor)) = &under {
                if said.is_some() {
                    ui.separator();
                }
                explain(ui, factor);
            }
        });
    }
}

/// All that is known of a factor.
fn explain(ui: &mut Ui, factor: &Explained) {
    let unproven = factor.proof == Proof::Measured;
    ui.set_max_width(440.0);
    ui.label(RichText::new(factor.headline()).strong());
    let known = RichText::new(format!("{}: {}", factor.knowledge(), factor.reason));
    ui.label(if unproven { known.color(theme::ERROR) } else { known });
    let following = factor.following("now");
    if !following.is_empty() {
        ui.label(following);
    }
    ui.label(factor.cost());
    ui.label(RichText::new(format!("lower it with {}", factor.advice)).color(theme::WEAK));
}

/// Puts the cursor on a place and brings it into view.
fn jump(ui: &Ui, id: Id, output: &TextEditOutput, text: &str, place: &Place) {
    let (start, end) = (character(text, place.start), character(text, place.end));
    let range = CCursorRange::two(CCursor::new(start), CCursor::new(end));
    let mut state = TextEditState::load(ui.ctx(), id).unwrap_or_default();
    state.cursor.set_char_range(Some(range));
    state.store(ui.ctx(), id);
    // Whoever looks for something goes on looking.
    if !search::has_keyboard(ui) {
        ui.memory_mut(|m| m.request_focus(id));
    }
    let at = output.galley.pos_from_cursor(CCursor::new(start));
    let rect = at.translate(output.galley_pos.to_vec2());
    ui.scroll_to_rect(rect.expand2(vec2(40.0, 60.0)), None);
}

/// The numbers of the lines, and signs at those with problems.
fn numbers(ui: &Ui, output: &TextEditOutput, gutter: f32, session: &Session, worst: &BTreeMap<u32, Severity>) {
    let cursor =
        output.cursor_range.map(|range| output.galley.pos_from_cursor(range.primary).min.y);
    let visible = ui.clip_rect();
    // They stay where they are when the text goes sideways.
    let left = if session.open.wrap { output.galley_pos.x - gutter } else { visible.min.x };
    let strip = Rect::from_x_y_ranges(left..=left + gutter - 4.0, visible.y_range());
    if output.galley_pos.x < left + gutter - 1.0 {
        ui.painter().rect_filled(strip, 0.0, *theme::WELL);
    }
    let x = left + gutter - 10.0;
    let mut line = 1;
    let mut starts = true;
    for row in &output.galley.rows {
        let rect = row.rect().translate(output.galley_pos.to_vec2());
        if starts && rect.max.y >= visible.min.y && rect.min.y <= visible.max.y {
            let here = cursor.is_some_and(|y| (y - row.pos.y).abs() < 1.0);
            let color = match worst.get(&line) {
                Some(severity) => problems::color(*severity),
                None if here => *theme::TEXT,
                None => theme::LINE.gamma_multiply(1.9),
            };
            let at = egui::pos2(x, rect.center().y);
            let painter = ui.painter();
            painter.text(at, Align2::RIGHT_CENTER, line.to_string(), theme::code_font(session.open.text_size), color);
        }
        starts = row.ends_with_newline;
        line += u32::from(starts);
    }
}

/// How a text is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Manner {
    /// How large, in hundredths of a point.
    size: u32,
    /// Where its lines are wrapped, in points.
    width: Option<u32>,
    /// Whether on a light ground.
    light: bool,
}

impl Manner {
    fn of(session: &Session, width: f32) -> Self {
        Self {
            size: (session.open.text_size * 100.0) as u32,
            width: session.open.wrap.then_some(width as u32),
            light: theme::is_light(),
        }
    }
}

/// Turns a text and its marks into a layout. egui keeps the result as long as neither changes.
#[derive(Default)]
struct Colours;

impl ComputerMut<(&str, &Vec<(Range<usize>, Severity)>, Manner), LayoutJob> for Colours {
    fn compute(&mut self, (text, marks, manner): (&str, &Vec<(Range<usize>, Severity)>, Manner)) -> LayoutJob {
        let mut job = LayoutJob::default();
        job.wrap.max_width = manner.width.map_or(f32::INFINITY, |width| width as f32);
        let size = manner.size as f32 / 100.0;
        let mut at = 0;
        for (range, class) in tokens(text) {
            add(&mut job, text, at..range.start, (size, 0.0, *code::NAME), marks);
            let room = if class == TokenClass::Color { colors::ROOM } else { 0.0 };
            add(&mut job, text, range.clone(), (size, room, color(class)), marks);
            at = range.end;
        }
        add(&mut job, text, at..text.len(), (size, 0.0, *code::NAME), marks);
        job
    }
}

/// Adds a piece in one size and colour, behind some room, cut where marks begin and end.
fn add(
    job: &mut LayoutJob,
    text: &str,
    range: Range<usize>,
    (size, room, color): (f32, f32, Color32),
    marks: &[(Range<usize>, Severity)],
) {
    let mut cuts = vec![range.start, range.end];
    for (mark, _) in marks {
        cuts.extend([mark.start, mark.end].iter().filter(|c| range.contains(c)));
    }
    cuts.sort_unstable();
    cuts.dedup();
    for (index, pair) in cuts.windows(2).enumerate() {
        let piece = pair[0]..pair[1];
        let marked = marks.iter().rev().find(|(m, _)| m.start <= piece.start && piece.end <= m.end);
        let mut format = TextFormat::simple(theme::code_font(size), color);
        format.line_height = Some(size * LINE_HEIGHT);
        if let Some((_, severity)) = marked {
            format.underline = Stroke::new(1.5, problems::color(*severity));
        }
        job.append(text.get(piece).unwrap_or_default(), if index == 0 { room } else { 0.0 }, format);
    }
}

fn color(class: TokenClass) -> Color32 {
    *match class {
        TokenClass::Keyword => code::KEYWORD,
        TokenClass::Kind => code::KIND,
        TokenClass::Name => code::NAME,
        TokenClass::Number | TokenClass::Color => code::NUMBER,
        TokenClass::Text => code::TEXT,
        TokenClass::Comment => code::COMMENT,
        TokenClass::Doc => code::DOC,
        TokenClass::Operator => code::OPERATOR,
        TokenClass::Error => theme::ERROR,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_layout_holds_the_whole_text() {
        let text = "shape a = sphere(1) // é\n$";
        let marks = vec![(10..16, Severity::Error), (0..40, Severity::Warning)];
        let job = Colours.compute((text, &marks, Manner { size: 1300, width: None, light: false }));
        assert_eq!(job.text, text);
        assert!(job.sections.iter().any(|s| s.format.underline != Stroke::NONE));
    }
}
