//! What the compiler says of the text. A click shows the place.

use crate::window::command::Command;
use crate::window::panels::icons;
use crate::window::session::{Problem, Session};
use crate::window::theme;
use egui::{Align, Color32, Layout, RichText, ScrollArea, Sense, Ui, UiBuilder};
use surefoot_compiler::diagnostic::Severity;

/// The colour of a severity.
pub fn color(severity: Severity) -> Color32 {
    match severity {
        Severity::Error => *theme::ERROR,
        Severity::Warning => *theme::WARNING,
    }
}

/// Shows the list.
pub fn show(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let problems = &session.said.problems;
    ui.horizontal(|ui| {
        ui.label(RichText::new("Problems").strong());
        for severity in [Severity::Error, Severity::Warning] {
            let count = problems.iter().filter(|p| p.severity == severity).count();
            if count > 0 {
                icons::sign(ui, icons::of(severity), color(severity));
                ui.label(RichText::new(count.to_string()).color(color(severity)));
            }
        }
    });
    ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        if let Some(failure) = &session.said.failure {
            ui.label(RichText::new(failure).color(theme::ERROR));
        }
        if problems.is_empty() && session.said.failure.is_none() {
            let words = if session.scene().is_some() { "none" } else { "…" };
            ui.label(RichText::new(words).color(theme::WEAK));
        }
        let scene = session.documents.all.first().map(|d| d.name.as_str()).unwrap_or_default();
        for problem in problems {
            row(ui, scene, problem, commands);
        }
    });
}

/// Words that leave the click to their row.
fn words(ui: &mut Ui, text: RichText) {
    ui.add(egui::Label::new(text).selectable(false));
}

fn row(ui: &mut Ui, scene: &str, problem: &Problem, commands: &mut Vec<Command>) {
    let builder = UiBuilder::new().sense(Sense::click()).layout(Layout::top_down(Align::Min));
    let inner = ui.scope_builder(builder, |ui| {
        let place = &problem.place;
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing.x = 6.0;
            icons::sign(ui, icons::of(problem.severity), color(problem.severity));
            let file = if place.file == scene { "" } else { place.file.as_str() };
            let colon = if file.is_empty() { "" } else { ":" };
            let (line, column) = place.start;
            let at = format!("{file}{colon}{line}:{column}");
            words(ui, RichText::new(at).color(theme::WEAK).monospace().small());
            words(ui, RichText::new(&problem.message));
        });
        if !problem.help.is_empty() {
            ui.horizontal_wrapped(|ui| {
                ui.add_space(20.0);
                words(ui, RichText::new(&problem.help).color(theme::WEAK).small());
            });
        }
        if !problem.mends.is_empty() {
            ui.horizontal_wrapped(|ui| {
                ui.add_space(20.0);
                for mend in &problem.mends {
                    let title: String = mend.title.replace('`', "").chars().take(60).collect();
                    if ui.small_button(title).on_hover_text("changes the text so").clicked() {
                        commands.push(Command::Mend(mend.clone()));
                    }
                }
            });
        }
        ui.add_space(2.0);
        ui.set_min_width(ui.available_width());
    });
    let response = inner.response.on_hover_text(format!(
        "[{}] click to go there; `surefoot explain {}` says more",
        problem.code, problem.code
    ));
    if response.hovered() {
        ui.ctx().set_cursor_icon(egui::CursorIcon::PointingHand);
    }
    if response.clicked() {
        commands.push(Command::Jump(problem.place.clone()));
    }
}
