//! Help at the cursor: what may be written there, what a name is, and where it is declared.
//!
//! Ctrl+Space lists what may be written, and so does writing a name or a dot. F12, or a click with Ctrl, goes to where a name is declared.

use crate::texts::OpenTexts;
use crate::window::command::Command;
use crate::window::document::Document;
use crate::window::panels::cursor::{byte, caret, id};
use crate::window::session::{Place, Session};
use crate::window::theme;
use egui::text::{CCursor, CCursorRange};
use egui::text_edit::{TextEditOutput, TextEditState};
use egui::{Area, Event, Frame, Id, Key, Modifiers, Order, RichText, Ui, pos2};
use std::sync::{Arc, Mutex, PoisonError};
use surefoot_compiler::language_service::{Completion, CompletionKind, Hover, World, complete, definition, hover};

/// So many rows of a list are seen at once.
const ROWS: usize = 9;
/// And so many points wide it is at least.
const WIDTH: f32 = 300.0;

/// The texts that are open, with their names.
struct Known {
    path: String,
    texts: OpenTexts,
    world: World,
}

type Shared = Arc<Mutex<Option<Known>>>;

/// A list of what may be written.
#[derive(Clone, Debug, Default)]
struct List {
    /// Of which text and place it is, in bytes.
    of: (String, usize),
    items: Vec<Completion>,
    /// Which item a key would take.
    chosen: usize,
    /// The item that a click took.
    clicked: Option<usize>,
}

/// Looks at the texts as they are now, read again where one is another.
fn look<T>(ui: &Ui, session: &Session, document: &Document, see: impl FnOnce(&Known) -> T) -> T {
    let shared: Shared = ui.data_mut(|data| data.get_temp_mut_or_default::<Shared>(Id::unique("names")).clone());
    let mut known = shared.lock().unwrap_or_else(PoisonError::into_inner);
    let texts = OpenTexts::new(session.documents.all.iter().filter(|d| !d.read_only).map(|d| (d.name.clone(), d.text.as_str().into())));
    let is_same = known.as_ref().is_some_and(|known| known.path == document.name && known.texts == texts);
    let known = match known.take().filter(|_| is_same) {
        Some(same) => known.insert(same),
        None => known.insert(Known { path: document.name.clone(), world: World::read(&texts, &[&document.name]), texts }),
    };
    see(known)
}

fn list(ui: &Ui) -> Option<List> {
    ui.data(|data| data.get_temp::<Option<List>>(Id::unique("completions"))).flatten()
}

fn put(ui: &Ui, list: Option<List>) {
    ui.data_mut(|data| data.insert_temp(Id::unique("completions"), list));
}

/// What fits what is written of the word at a place, what begins with it first.
fn fitting(found: Vec<Completion>, text: &str, at: usize) -> Vec<Completion> {
    let written = |item: &Completion| text.get(item.span.start as usize..at).unwrap_or("").to_lowercase();
    let begins = |item: &Completion| item.label.to_lowercase().starts_with(&written(item));
    let holds = |item: &Completion| item.label.to_lowercase().contains(&written(item));
    let (first, rest): (Vec<_>, Vec<_>) = found.into_iter().partition(begins);
    first.into_iter().chain(rest.into_iter().filter(holds)).collect()
}

/// Keys that a list takes before the text sees them, and those that ask for help. Answers whether the text was changed.
pub fn keys(ui: &Ui, session: &Session, document: &Document, text: &mut String, commands: &mut Vec<Command>) -> bool {
    if !document.is_editable() && !document.read_only || !ui.memory(|m| m.has_focus(id(document))) && list(ui).is_none_or(|list| list.clicked.is_none()) {
        // Escape takes the keyboard from the text, too. It was meant for the list.
        if list(ui).is_some() && ui.input(|input| input.key_pressed(Key::Escape)) {
            commands.push(Command::Focus);
        }
        put(ui, None);
        return false;
    }
    let pressed = |modifiers, key| ui.input_mut(|input| input.consume_key(modifiers, key));
    if pressed(Modifiers::NONE, Key::F12)
        && let Some(at) = caret(ui, document)
    {
        go(ui, session, document, byte(&document.text, at), commands);
    }
    if pressed(Modifiers::COMMAND, Key::Space)
        && let Some(at) = caret(ui, document)
        && document.is_editable()
    {
        // The space is a letter to the text, too.
        ui.input_mut(|input| input.events.retain(|event| !matches!(event, Event::Text(typed) if typed == " ")));
        open(ui, session, document, at);
    }
    let Some(mut shown) = list(ui) else { return false };
    if pressed(Modifiers::NONE, Key::Escape) {
        put(ui, None);
        return false;
    }
    let last = shown.items.len().saturating_sub(1);
    if pressed(Modifiers::NONE, Key::ArrowDown) {
        shown.chosen = if shown.chosen == last { 0 } else { shown.chosen + 1 };
    }
    if pressed(Modifiers::NONE, Key::ArrowUp) {
        shown.chosen = if shown.chosen == 0 { last } else { shown.chosen - 1 };
    }
    let taken = shown.clicked.or_else(|| (pressed(Modifiers::NONE, Key::Enter) || pressed(Modifiers::NONE, Key::Tab)).then_some(shown.chosen));
    let Some(item) = taken.and_then(|taken| shown.items.get(taken)) else {
        put(ui, Some(shown));
        return false;
    };
    let range = item.span.range();
    let is_same = shown.of.0 == document.text && document.text.get(range.clone()).is_some();
    if is_same {
        text.replace_range(range.clone(), &item.insert);
        let end = CCursor::new(text[..range.start + item.insert.len()].chars().count());
        let mut state = TextEditState::load(ui.ctx(), id(document)).unwrap_or_default();
        state.cursor.set_char_range(Some(CCursorRange::one(end)));
        state.store(ui.ctx(), id(document));
        commands.push(Command::Focus);
    }
    put(ui, None);
    is_same
}

/// Opens the list for a character of the text, or brings it up to date.
fn open(ui: &Ui, session: &Session, document: &Document, at: usize) {
    let at = byte(&document.text, at);
    let found = look(ui, session, document, |known| {
        let Some(file) = known.world.file(&document.name) else { return Vec::new() };
        let texts: Vec<&str> = session.open.beside.iter().map(String::as_str).collect();
        complete(&known.world, &known.texts, file, at, &texts)
    });
    let items = fitting(found, &document.text, at);
    let is_written = |item: &Completion| document.text.get(item.span.range()) == Some(&item.label) && items.len() == 1;
    let is_done = items.is_empty() || items.iter().any(is_written);
    put(ui, (!is_done).then(|| List { of: (document.text.clone(), at), items, chosen: 0, clicked: None }));
}

/// Shows the list, opens it while a name is written, and goes where a click with Ctrl asks. After the text was shown.
pub fn show(ui: &mut Ui, session: &Session, document: &Document, output: &TextEditOutput, commands: &mut Vec<Command>) {
    if output.response.clicked()
        && ui.input(|input| input.modifiers.command)
        && let Some(at) = caret(ui, document)
    {
        go(ui, session, document, byte(&document.text, at), commands);
    }
    let Some(at) = caret(ui, document) else { return put(ui, None) };
    let place = byte(&document.text, at);
    let before = document.text[..place].chars().next_back();
    let typing = ui.data(|data| data.get_temp::<String>(Id::unique("typed"))).is_some_and(|text| text != document.text);
    ui.data_mut(|data| data.insert_temp(Id::unique("typed"), document.text.clone()));
    // In a comment there is nothing to complete, and a long text takes its time to be read.
    let is_comment = document.text[..place].rsplit('\n').next().is_some_and(|line| line.contains("//"));
    let in_word = !is_comment && before.is_some_and(|c| c.is_ascii_alphanumeric() || c == '_' || c == '.');
    match list(ui) {
        // It follows what is written, and goes with what it was of.
        Some(shown) if shown.of != (document.text.clone(), place) => match in_word && shown.of.0 != document.text {
            true => open(ui, session, document, at),
            false => put(ui, None),
        },
        None if typing && is_typed(ui) && in_word && !before.is_some_and(|c| c.is_ascii_digit()) => open(ui, session, document, at),
        _ => {}
    }
    let Some(mut shown) = list(ui) else { return };
    let corner = output.galley.pos_from_cursor(CCursor::new(at)).translate(output.galley_pos.to_vec2());
    let area = Area::new(Id::unique("completion list")).order(Order::Foreground).fixed_pos(pos2(corner.min.x, corner.max.y + 2.0)).constrain(true);
    area.show(ui.ctx(), |ui| {
        Frame::popup(ui.style()).show(ui, |ui| {
            ui.set_min_width(WIDTH);
            ui.set_max_width(2.0 * WIDTH);
            let first = shown.chosen.saturating_sub(ROWS - 1).min(shown.items.len().saturating_sub(ROWS));
            for (index, item) in shown.items.iter().enumerate().skip(first).take(ROWS) {
                let response = ui.selectable_label(index == shown.chosen, row(item));
                if response.clicked() {
                    shown.clicked = Some(index);
                }
            }
            if let Some(item) = shown.items.get(shown.chosen) {
                let words = first_words(&item.text);
                if !words.is_empty() {
                    ui.separator();
                    ui.label(RichText::new(words).color(theme::WEAK).small());
                }
            }
        });
    });
    put(ui, Some(shown));
}

/// Whether a letter came that a person typed, and not what was pasted or taken back.
fn is_typed(ui: &Ui) -> bool {
    ui.data_mut(|data| data.get_temp::<bool>(Id::unique("letter"))).unwrap_or(false)
}

/// Notes whether a letter comes with this frame. Before the text sees it.
pub fn hear(ui: &Ui) {
    let letter = ui.input(|input| input.events.iter().any(|event| matches!(event, Event::Text(typed) if typed.chars().count() == 1)));
    ui.data_mut(|data| {
        let heard = data.get_temp::<[bool; 2]>(Id::unique("letters")).unwrap_or_default();
        // The text is another one frame after the letter.
        data.insert_temp(Id::unique("letters"), [letter, heard[0]]);
        data.insert_temp(Id::unique("letter"), letter || heard[0] || heard[1]);
    });
}

fn row(item: &Completion) -> RichText {
    let shown = match item.kind {
        CompletionKind::Name(_) | CompletionKind::Argument if !item.signature.is_empty() => {
            if item.signature.contains(&item.label) { item.signature.clone() } else { format!("{}  {}", item.label, item.signature) }
        }
        _ => item.label.clone(),
    };
    RichText::new(shown.chars().take(90).collect::<String>()).monospace().small()
}

/// The first paragraph of some Markdown, without its marks.
fn first_words(text: &str) -> String {
    text.split("\n\n").find(|part| !part.starts_with("```")).unwrap_or("").replace(['`', '*'], "")
}

/// Goes to where the name at a byte is declared.
fn go(ui: &Ui, session: &Session, document: &Document, at: usize, commands: &mut Vec<Command>) {
    let place = look(ui, session, document, |known| {
        let world = &known.world;
        let found = definition(world, world.file(&document.name)?, at).into_iter().next()?;
        let text = world.text(found.name.file);
        let position = |byte: u32| {
            let before = text.get(..byte as usize).unwrap_or("");
            let column = before.rsplit('\n').next().unwrap_or("").chars().count();
            (before.matches('\n').count() as u32 + 1, column as u32 + 1)
        };
        Some(Place { file: world.path(found.name.file).to_owned(), start: position(found.name.start), end: position(found.name.end) })
    });
    commands.extend(place.map(Command::Jump));
}

/// What a name is, at a character of the text.
pub fn said(ui: &Ui, session: &Session, document: &Document, at: usize) -> Option<Hover> {
    let at = byte(&document.text, at);
    look(ui, session, document, |known| hover(&known.world, &[], known.world.file(&document.name)?, at))
}

/// Shows what a name is.
pub fn explain(ui: &mut Ui, said: &Hover) {
    ui.set_max_width(440.0);
    for line in &said.code {
        ui.label(RichText::new(line).monospace());
    }
    let words = first_words(&said.text);
    if !words.is_empty() {
        ui.label(words);
    }
}
