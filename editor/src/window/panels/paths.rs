//! Where a path is asked for: a scene to open, or a name to save under.

use crate::window::command::Command;
use crate::window::export::refuses;
use crate::window::panels::icons;
use crate::window::session::{PathAsked, Purpose, Session};
use crate::window::theme;
use egui::text::{CCursor, CCursorRange};
use egui::text_edit::TextEditState;
use egui::{Button, DragValue, Id, Key, Modal, RichText, ScrollArea, TextEdit, Ui};
use std::path::{Path, PathBuf};

/// Shows what is asked, if anything is.
pub fn show(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let Some(asked) = session.asked.as_ref().filter(|_| session.question.is_none() && session.notice.is_none()) else { return };
    let modal = Modal::new(Id::unique("path")).show(ui.ctx(), |ui| {
        ui.set_width(460.0);
        ui.heading(match asked.purpose {
            Purpose::Open => "Open a scene",
            Purpose::SaveAs => "Save as",
            Purpose::Picture => "Save the picture",
        });
        ui.add_space(4.0);
        ui.horizontal(|ui| {
            let up = asked.folder.parent().filter(|up| up.is_dir());
            let button = ui.add_enabled(up.is_some(), Button::new("Up"));
            if let Some(up) = up.filter(|_| button.on_hover_text("the folder above").clicked()) {
                commands.push(Command::LookInto(up.to_owned()));
            }
            ui.add(egui::Label::new(RichText::new(asked.folder.display().to_string()).color(theme::WEAK)).truncate());
        });
        list(ui, asked, commands);
        ui.add_space(6.0);
        let entered = name(ui, asked, commands);
        if asked.purpose == Purpose::Picture {
            picture(ui, session, asked, commands);
        }
        ui.add_space(6.0);
        bottom(ui, asked, entered, commands);
    });
    if modal.should_close() {
        commands.extend([Command::AskPath(None), Command::Focus]);
    }
}

fn list(ui: &mut Ui, asked: &PathAsked, commands: &mut Vec<Command>) {
    ScrollArea::vertical().max_height(260.0).min_scrolled_height(260.0).auto_shrink([false, false]).show(ui, |ui| {
        for (name, is_folder) in &asked.entries {
            let shown = if *is_folder { format!("{name}/") } else { name.clone() };
            let row = ui.selectable_label(asked.typed == *name, shown);
            if !row.clicked() && !row.double_clicked() {
                continue;
            }
            match (is_folder, asked.purpose) {
                (true, _) => commands.push(Command::LookInto(asked.folder.join(name))),
                (false, Purpose::Open) => commands.push(Command::Open(asked.folder.join(name).to_string_lossy().into_owned())),
                (false, Purpose::SaveAs) => commands.push(Command::TypePath(name.clone())),
                (false, Purpose::Picture) => commands.push(Command::TypePath(Path::new(name).with_extension("png").to_string_lossy().into_owned())),
            }
        }
        if asked.entries.is_empty() {
            ui.label(RichText::new("there are no scenes here").color(theme::WEAK));
        }
    });
}

/// The name that is typed; answers whether Enter was pressed in it.
fn name(ui: &mut Ui, asked: &PathAsked, commands: &mut Vec<Command>) -> bool {
    let field = Id::unique("path name");
    let mut typed = asked.typed.clone();
    let response = ui.add(TextEdit::singleline(&mut typed).id(field).hint_text("a name, or a path").desired_width(f32::INFINITY));
    icons::name(ui, field, "Name");
    if response.changed() {
        commands.push(Command::TypePath(typed));
    }
    let before = ui.data_mut(|data| data.get_temp_mut_or_default::<Option<PathBuf>>(field).replace(asked.folder.clone()));
    let is_new = before.is_none_or(|folder| folder != asked.folder);
    if is_new || !ui.memory(|m| m.focused().is_some()) && !response.lost_focus() {
        let stem = asked.typed.rsplit_once('.').map_or(asked.typed.as_str(), |(stem, _)| stem).chars().count();
        let mut state = TextEditState::load(ui.ctx(), field).unwrap_or_default();
        state.cursor.set_char_range(Some(CCursorRange::two(CCursor::new(0), CCursor::new(stem))));
        state.store(ui.ctx(), field);
        response.request_focus();
    }
    response.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter))
}

/// How large a picture is, and whether it is one of many.
fn picture(ui: &mut Ui, session: &Session, asked: &PathAsked, commands: &mut Vec<Command>) {
    let mut wanted = asked.wanted;
    ui.add_space(6.0);
    ui.horizontal(|ui| {
        for (name, side) in [("Width", &mut wanted.size.0), ("Height", &mut wanted.size.1)] {
            let response = ui.add(DragValue::new(side).range(1..=16384).suffix(" px"));
            icons::name(ui, response.id, name);
        }
        if session.moves() {
            let words = format!("one for each 1/30 s of {} s", session.timeline.length);
            ui.checkbox(&mut wanted.each, "Sequence").on_hover_text(words);
        }
    });
    if session.moves() {
        ui.label(RichText::new("A name that ends with .gif, .apng, .mp4 or .webm makes a film of the timeline.").color(theme::WEAK).small());
    }
    if let Some(why) = refuses(&asked.path(), wanted) {
        ui.label(RichText::new(why).color(theme::WARNING));
    }
    if wanted != asked.wanted {
        commands.push(Command::Picture(wanted));
    }
}

fn bottom(ui: &mut Ui, asked: &PathAsked, entered: bool, commands: &mut Vec<Command>) {
    let path = asked.path();
    let is_there = path.is_file() && asked.purpose != Purpose::Open;
    if is_there {
        ui.label(RichText::new("There is such a file already: it is written over.").color(theme::WARNING));
    }
    ui.horizontal(|ui| {
        let words = match (asked.purpose, is_there) {
            (Purpose::Open, _) => "Open it",
            (_, true) => "Write over it",
            (_, false) => "Save it",
        };
        let take = ui.add_enabled(!asked.typed.trim().is_empty(), Button::new(words)).clicked();
        // Enter alone writes over nothing.
        if take || entered && !is_there && !asked.typed.trim().is_empty() {
            commands.push(taken(asked, &path));
        }
        if ui.button("Cancel").clicked() {
            commands.extend([Command::AskPath(None), Command::Focus]);
        }
    });
}

fn taken(asked: &PathAsked, path: &Path) -> Command {
    match asked.purpose {
        _ if path.is_dir() => Command::LookInto(path.to_owned()),
        Purpose::Open => Command::Open(path.to_string_lossy().into_owned()),
        Purpose::SaveAs => Command::SaveAs(path.to_string_lossy().into_owned()),
        Purpose::Picture => Command::SavePicture(path.to_owned()),
    }
}
