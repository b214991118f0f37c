//! What the scene measures: box, volume, area, centre, pieces, and where it is asked its walls and gaps.

use crate::window::command::Command;
use crate::window::session::Session;
use crate::window::theme;
use egui::{Button, ProgressBar, RichText, ScrollArea, Ui};

/// Shows the panel.
pub fn show(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    ui.take_available_width();
    let measuring = &session.measuring;
    let part = measuring.part();
    let found = measuring.found.as_ref();
    ui.horizontal(|ui| {
        ui.label(RichText::new("Measures").strong());
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let lines = found.and_then(|(_, found)| found.as_ref().ok());
            if ui.add_enabled(lines.is_some(), Button::new("Copy").small()).on_hover_text("copy what was measured").clicked() {
                let text = lines.into_iter().flatten().map(|(name, words)| format!("{}: {words}\n", name.trim())).collect();
                ui.ctx().copy_text(text);
            }
            let ready = part.is_none() && session.scene().is_some();
            let walls = ui.add_enabled(ready, Button::new("Walls").small());
            if walls.on_hover_text("measure the solid, its thinnest wall and its narrowest gap").clicked() {
                commands.push(Command::Measure { walls: true });
            }
            let measure = ui.add_enabled(ready, Button::new("Measure").small());
            if measure.on_hover_text("measure the solid as it is now; the window goes on meanwhile").clicked() {
                commands.push(Command::Measure { walls: false });
            }
        });
    });
    ui.add_space(2.0);
    if let Some(part) = part {
        ui.add(ProgressBar::new(part).show_percentage());
    }
    ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| match found {
        None if part.is_none() => {
            ui.label(RichText::new("Box, volume, area, centre of mass and pieces of the solid, each with its error.").color(theme::WEAK));
        }
        None => {}
        Some((taken, found)) => {
            if !taken.is_of(session.scene(), session.stage.live()) {
                ui.label(RichText::new("The scene has changed since.").color(theme::WARNING));
            } else if session.said.reads_time {
                ui.label(RichText::new(format!("At {:.2} s.", taken.time())).color(theme::WEAK));
            }
            match found {
                Err(why) => {
                    ui.label(RichText::new(why).color(theme::ERROR));
                }
                Ok(lines) => {
                    for (name, words) in lines {
                        ui.label(RichText::new(name).color(theme::WEAK).small());
                        ui.label(words);
                    }
                }
            }
        }
    });
}
