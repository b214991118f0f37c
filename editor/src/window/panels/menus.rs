//! The menus: files, and how the window looks.

use crate::window::command::Command;
use crate::window::orbit::Side;
use crate::window::session::{Purpose, Session};
use crate::window::theme::{Choice, TEXT_SIZE};
use egui::{Button, RichText, Ui};
use std::path::Path;

/// Shows the menu of files.
pub fn files(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    ui.menu_button("File", |ui| {
        ui.set_min_width(210.0);
        let document = session.documents.current();
        let entries = [
            ("New", "Ctrl+N", true, Command::New),
            ("Open…", "Ctrl+O", true, Command::AskPath(Some(Purpose::Open))),
            ("Save", "Ctrl+S", document.can_save(), Command::Save),
            ("Save as…", "Ctrl+Shift+S", document.is_editable(), Command::AskPath(Some(Purpose::SaveAs))),
            ("Save the picture…", "Ctrl+Shift+E", session.scene().is_some(), Command::AskPath(Some(Purpose::Picture))),
            ("Start page", "", true, Command::ShowStart(true)),
        ];
        for (name, key, enabled, command) in entries {
            if entry(ui, name, key, enabled) {
                commands.push(command);
            }
        }
        if session.recent.is_empty() {
            return;
        }
        ui.separator();
        ui.label(RichText::new("Recent").small().weak());
        for path in session.recent.iter().take(10) {
            let name = Path::new(path).file_name().unwrap_or_default().to_string_lossy();
            if ui.button(name).on_hover_text(path).clicked() {
                commands.push(Command::Open(path.clone()));
            }
        }
    });
}

/// Shows the menu of looks.
pub fn look(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    ui.menu_button("View", |ui| {
        ui.set_min_width(210.0);
        let (open, size) = (&session.open, session.open.text_size);
        for (name, key, size) in [("Larger text", "Ctrl++", size + 1.0), ("Smaller text", "Ctrl+-", size - 1.0), ("Text as at first", "Ctrl+0", TEXT_SIZE)] {
            if entry(ui, name, key, true) {
                commands.push(Command::TextSize(size));
            }
        }
        let mut wrap = open.wrap;
        if ui.checkbox(&mut wrap, "Wrap long lines (Alt+Z)").changed() {
            commands.push(Command::Wrap(wrap));
        }
        ui.separator();
        let panels = [
            ("Outline", "Ctrl+Shift+O", open.outline, Command::ShowOutline(!open.outline)),
            ("WGSL", "Ctrl+Shift+G", open.shader, Command::ShowShader(!open.shader)),
            ("Frames", "Ctrl+Shift+P", open.frames, Command::ShowFrames(!open.frames)),
        ];
        for (name, key, is_open, command) in panels {
            if ui.add(Button::selectable(is_open, name).shortcut_text(key)).clicked() {
                commands.push(command);
            }
        }
        ui.separator();
        for (name, key, side) in Side::ALL {
            if entry(ui, name, key, session.scene().is_some()) {
                commands.push(Command::LookFrom(side));
            }
        }
        let parallel = session.look.orbit.is_some_and(|orbit| orbit.parallel);
        if ui.add(Button::selectable(parallel, "Parallel rays").shortcut_text("5")).clicked() {
            commands.push(Command::Parallel(!parallel));
        }
        let (look, truth) = (&session.look, session.truth.open);
        let looks = [
            ("Section", "C", look.cuts, Command::ShowSection(!look.cuts)),
            ("Two views", "W", look.beside.is_some(), super::wipe::switch(session)),
            ("Difference", "D", truth, Command::ShowTruth(!truth)),
        ];
        for (name, key, is_on, command) in looks {
            if ui.add(Button::selectable(is_on, name).shortcut_text(key)).clicked() {
                commands.push(command);
            }
        }
        if ui.add(Button::selectable(open.grid, "Grid").shortcut_text("G")).clicked() {
            commands.push(Command::ShowGrid(!open.grid));
        }
        ui.separator();
        for (name, zoom) in [("Larger window", open.zoom + 0.1), ("Smaller window", open.zoom - 0.1), ("Window as at first", 1.0)] {
            if ui.button(name).on_hover_text("text, buttons and panels alike").clicked() {
                commands.push(Command::Zoom(zoom));
            }
        }
        ui.separator();
        for (choice, name) in Choice::ALL {
            if ui.radio(open.theme == choice, name).clicked() {
                commands.push(Command::Theme(choice));
            }
        }
    });
}

fn entry(ui: &mut Ui, name: &str, key: &str, enabled: bool) -> bool {
    ui.add_enabled(enabled, Button::new(name).shortcut_text(key)).clicked()
}
