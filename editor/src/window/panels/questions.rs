//! What must be answered before anything else, and notices.

use crate::window::command::{Answer, Command};
use crate::window::session::{Question, Session};
use egui::{Id, Modal, Ui};

/// Shows what is to be answered, if anything.
pub fn show(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    if let Some(question) = &session.question {
        let modal = Modal::new(Id::unique("question")).show(ui.ctx(), |ui| {
            ui.set_width(360.0);
            ui.heading("Unsaved edits");
            ui.add_space(4.0);
            let names: Vec<_> = session
                .documents
                .all
                .iter()
                .filter(|d| session.documents.is_at_stake(question, d))
                .map(|d| d.short_name())
                .collect();
            let before = match question {
                Question::Close => "Save them before the window closes?".to_owned(),
                Question::New(..) => "Save them before the new scene begins?".to_owned(),
                Question::CloseText(_) => "Save them before it is closed?".to_owned(),
                Question::Open(path) => format!("Save them before {path} is opened?"),
            };
            // They may have been saved meanwhile.
            if names.is_empty() {
                commands.push(Command::Answer(Answer::Stay));
            }
            ui.label(format!("{}. {before}", names.join(", ")));
            ui.add_space(8.0);
            ui.horizontal(|ui| {
                for (text, answer) in [
                    ("Save", Answer::Save),
                    ("Throw away", Answer::Discard),
                    ("Cancel", Answer::Stay),
                ] {
                    if ui.button(text).clicked() {
                        commands.push(Command::Answer(answer));
                    }
                }
            });
        });
        if ui.input_mut(|i| i.consume_key(egui::Modifiers::NONE, egui::Key::Enter)) {
            commands.push(Command::Answer(Answer::Save));
        } else if modal.should_close() {
            commands.push(Command::Answer(Answer::Stay));
        }
    } else if let Some(notice) = &session.notice {
        let modal = Modal::new(Id::unique("notice")).show(ui.ctx(), |ui| {
            ui.set_width(360.0);
            ui.label(notice);
            ui.add_space(8.0);
            ui.button("OK").clicked()
        });
        if modal.inner || modal.should_close() {
            commands.push(Command::Dismiss);
        }
    }
}
