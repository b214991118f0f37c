//! Bars above the text: what a person should know of the file, and decide.

use crate::window::command::Command;
use crate::window::document::{Document, Resolution};
use crate::window::session::Session;
use crate::window::theme;
use egui::{Frame, Margin, RichText, Ui};

/// Shows the bars.
pub fn show(ui: &mut Ui, session: &Session, document: &Document, commands: &mut Vec<Command>) {
    let bar = |ui: &mut Ui, add: &mut dyn FnMut(&mut Ui)| {
        let fill = *theme::ASKS;
        let margin = Margin::symmetric(8, 6);
        Frame::new().fill(fill).inner_margin(margin).corner_radius(4).show(ui, |ui| {
            ui.set_min_width(ui.available_width());
            add(ui);
        });
    };
    for other in session.documents.all.iter().filter(|other| other.has_conflict() && other.name != document.name) {
        bar(ui, &mut |ui| {
            ui.horizontal_wrapped(|ui| {
                ui.label(format!("Another program has changed {}, and there is something to decide.", other.short_name()));
                if ui.button("Show it").clicked() {
                    commands.push(Command::Show(other.name.clone()));
                }
            });
        });
    }
    for found in &session.found {
        if document.is_editable() && found.is_of(&document.name) {
            bar(ui, &mut |ui| {
                ui.label(found.words(document));
                ui.horizontal_wrapped(|ui| {
                    for (text, hover, keep) in [("Keep it", "undo (Ctrl+Z) brings back what is shown now", true), ("Drop it", "it is gone then", false)] {
                        if ui.button(text).on_hover_text(hover).clicked() {
                            commands.extend([Command::Recover { file: found.file.clone(), keep }, Command::Focus]);
                        }
                    }
                });
            });
        } else if let Some(name) = session.names().into_iter().find(|name| *name != document.name && found.is_of(name)) {
            bar(ui, &mut |ui| {
                ui.horizontal_wrapped(|ui| {
                    ui.label(format!("Unsaved text of {name} was found."));
                    if ui.button("Show it").clicked() {
                        commands.push(Command::Show(name.clone()));
                    }
                });
            });
        }
    }
    if document.has_conflict() {
        bar(ui, &mut |ui| {
            match document.unreadable() {
                Some(why) if !document.is_editable() => {
                    ui.label(format!("This file can't be shown: {why}."));
                    return;
                }
                Some(why) => ui.label(format!("The disk holds something in place of this text that can't be shown: {why}.")),
                None if document.is_missing() => ui.label("Another program has changed this file, and then taken it away; there are edits here that are not saved."),
                None => ui.label("Another program has changed this file, and there are edits here that are not saved."),
            };
            ui.horizontal_wrapped(|ui| {
                for (text, hover, command) in [
                    (
                        "Keep both",
                        "write the edits beside it, as .mine.sdf, and show the file",
                        Command::KeepBoth,
                    ),
                    (
                        "Show the file",
                        "undo (Ctrl+Z) brings the edits back",
                        Command::Resolve(Resolution::TakeFile),
                    ),
                    (
                        "Keep the edits",
                        "saving them will replace what the file holds now",
                        Command::Resolve(Resolution::KeepEdits),
                    ),
                ] {
                    // There is nothing to show.
                    if document.unreadable().is_some() && matches!(command, Command::Resolve(Resolution::TakeFile)) {
                        continue;
                    }
                    if ui.button(text).on_hover_text(hover).clicked() {
                        commands.extend([command, Command::Focus]);
                    }
                }
            });
        });
    } else if document.is_missing() {
        bar(ui, &mut |ui| {
            ui.label("The file is gone from the disk. Saving writes it again.");
        });
    } else if document.read_only {
        ui.label(RichText::new("comes with the compiler; it can't be edited").color(theme::WEAK));
    }
}
