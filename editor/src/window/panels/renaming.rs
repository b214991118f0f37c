//! Another name for what the cursor is on: F2 asks for it, and it is written wherever the name stands, in other files too.

use crate::texts::OpenTexts;
use crate::window::command::Command;
use crate::window::document::Document;
use crate::window::panels::cursor::{byte, caret, id};
use crate::window::panels::icons;
use crate::window::session::Session;
use crate::window::theme;
use egui::text::CCursor;
use egui::text_edit::TextEditOutput;
use egui::{Area, Frame, Id, Key, Modifiers, Order, RichText, TextEdit, Ui, pos2};
use std::collections::BTreeMap;
use surefoot_compiler::language_service::{World, prepare_rename, rename};

/// A name while it is written.
#[derive(Clone, Debug)]
struct Asked {
    /// Of which text and byte.
    of: (String, usize),
    /// The name.
    name: String,
    /// Why it can't be.
    why: Option<String>,
    /// Whether the keyboard is in it.
    has_keyboard: bool,
}

fn asked(ui: &Ui) -> Option<Asked> {
    ui.data(|data| data.get_temp::<Option<Asked>>(Id::unique("renaming"))).flatten()
}

fn put(ui: &Ui, asked: Option<Asked>) {
    ui.data_mut(|data| data.insert_temp(Id::unique("renaming"), asked));
}

/// The texts of the scene, and those beside it that may name the same.
fn read(session: &Session, document: &Document) -> (World, OpenTexts) {
    let texts = OpenTexts::new(session.documents.all.iter().filter(|d| !d.read_only).map(|d| (d.name.clone(), d.text.as_str().into())));
    let mut paths = vec![document.name.as_str()];
    let others = session.documents.all.iter().filter(|d| !d.read_only).map(|d| d.name.as_str()).chain(session.open.beside.iter().map(String::as_str));
    paths.extend(others.filter(|path| *path != document.name));
    (World::read(&texts, &paths), texts)
}

/// Asks for a name where F2 is pressed.
pub fn keys(ui: &Ui, session: &Session, document: &Document) {
    if !document.is_editable() || !ui.memory(|m| m.has_focus(id(document))) || !ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::F2)) {
        return;
    }
    let Some(at) = caret(ui, document).map(|at| byte(&document.text, at)) else { return };
    let (world, _) = read(session, document);
    let span = world.file(&document.name).ok_or_else(String::new).and_then(|file| prepare_rename(&world, file, at));
    let name = span.as_ref().ok().and_then(|span| document.text.get(span.range())).unwrap_or("").to_owned();
    put(ui, Some(Asked { of: (document.text.clone(), at), name, why: span.err(), has_keyboard: false }));
}

/// Shows what is asked. After the text was shown.
pub fn show(ui: &mut Ui, session: &Session, document: &Document, output: &TextEditOutput, commands: &mut Vec<Command>) {
    let Some(mut open) = asked(ui) else { return };
    if open.of.0 != document.text || ui.input(|input| input.key_pressed(Key::Escape)) {
        put(ui, None);
        commands.push(Command::Focus);
        return;
    }
    let at = document.text[..open.of.1].chars().count();
    let corner = output.galley.pos_from_cursor(CCursor::new(at)).translate(output.galley_pos.to_vec2());
    let area = Area::new(Id::unique("name")).order(Order::Foreground).fixed_pos(pos2(corner.min.x, corner.max.y + 2.0)).constrain(true);
    let mut is_done = false;
    area.show(ui.ctx(), |ui| {
        Frame::popup(ui.style()).show(ui, |ui| {
            if !open.name.is_empty() || open.why.is_none() {
                let field = ui.add(TextEdit::singleline(&mut open.name).font(theme::code_font(13.0)).desired_width(180.0));
                icons::name(ui, field.id, "New name");
                if !open.has_keyboard {
                    open.has_keyboard = true;
                    field.request_focus();
                }
                if field.changed() {
                    open.why = None;
                }
                is_done = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
            }
            if let Some(why) = &open.why {
                ui.label(RichText::new(why).color(theme::ERROR).small());
            }
        });
    });
    if is_done {
        let (world, texts) = read(session, document);
        let edits = world.file(&document.name).ok_or_else(String::new).and_then(|file| rename(&world, &texts, file, open.of.1, &open.name));
        match edits {
            Ok(edits) => {
                let mut changed: BTreeMap<String, String> = BTreeMap::new();
                for edit in edits.iter().rev() {
                    let text = changed.entry(world.path(edit.span.file).to_owned()).or_insert_with(|| world.text(edit.span.file).to_owned());
                    text.replace_range(edit.span.range(), &edit.text);
                }
                commands.push(Command::Rewrite(changed.into_iter().collect()));
                commands.push(Command::Focus);
                put(ui, None);
                return;
            }
            Err(why) => {
                open.why = Some(why);
                open.has_keyboard = false;
            }
        }
    }
    put(ui, Some(open));
}
