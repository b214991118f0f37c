//! The bar at the bottom: what the scene costs.

use crate::window::command::Command;
use crate::window::session::Session;
use crate::window::theme;
use egui::{Label, RichText, Ui};
use std::time::Duration;
use surefoot_compiler::compiled::Compiled;
use surefoot_compiler::functions::Kind;
use surefoot_runtime::live::{Times, Work};

/// Work that is done sooner is not spoken of.
const SHORT: Duration = Duration::from_millis(400);

/// Shows the bar.
pub fn show(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    ui.horizontal_centered(|ui| {
        ui.spacing_mut().item_spacing.x = 14.0;
        ui.style_mut().override_text_style = Some(egui::TextStyle::Small);
        let meter = &session.meter;
        if meter.frame > Duration::ZERO {
            let (width, height) = meter.size;
            entry(
                ui,
                "frame",
                &milliseconds(meter.frame),
                "from the order to draw to the picture's end",
            );
            let part = match meter.sharp {
                false => "fewer pixels than the panel has, while something moves",
                true => "the picture's size in pixels",
            };
            entry(ui, "", &format!("{width} × {height}"), part);
            if meter.samples > 1 {
                entry(ui, "", &format!("× {}", meter.samples), "pictures that became this one while nothing moved");
            }
        }
        if let Some(part) = session.export.part() {
            entry(ui, "the picture for its file", &format!("{:.0} %", 100.0 * part), "drawn on another thread");
            if ui.small_button("Cancel").on_hover_text("end it after the picture that is being drawn").clicked() {
                commands.push(Command::CancelPicture);
            }
        }
        if let Some(loading) = &session.said.loading {
            entry(ui, "reading", loading, "on another thread; the last picture stays until it is there");
        }
        let times = &session.said.times;
        if let Some((work, time)) = working(session, SHORT) {
            entry(ui, work, &time, "on another thread; the last picture stays until it is done");
        } else {
            took(ui, times);
        }
        if let Some(scene) = session.scene() {
            let (field, bound) = scene.module.operations;
            let hover = format!(
                "kernel operations in one evaluation of the field; its bound takes {bound}"
            );
            entry(ui, "operations", &field.to_string(), &hover);
            factor(ui, session);
            unproven(ui, scene);
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let hover = match meter.software {
                true => "this adapter is a program: its times say nothing about graphics cards",
                false => "the graphics adapter",
            };
            ui.add(Label::new(RichText::new(&meter.adapter).color(theme::WEAK)).truncate()).on_hover_text(hover);
        });
    });
}

fn entry(ui: &mut Ui, name: &str, value: &str, hover: &str) {
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        if !name.is_empty() {
            ui.label(RichText::new(name).color(theme::WEAK)).on_hover_text(hover);
        }
        ui.label(value).on_hover_text(hover);
    });
}

/// What the text that is drawn took.
fn took(ui: &mut Ui, times: &Times) {
    if times.compile > Duration::ZERO {
        entry(ui, "compiled in", &milliseconds(times.compile), "the compiler alone");
    }
    if times.pipeline > Duration::ZERO {
        let hover = "naga, the driver and the first pixel, on another thread";
        entry(ui, "pipeline", &milliseconds(times.pipeline), hover);
    }
}

/// What is being done for the newest text, where it is for so long already, and how long it is.
pub fn working(session: &Session, least: Duration) -> Option<(&'static str, String)> {
    let (work, time) = session.said.work.filter(|(_, time)| *time >= least)?;
    let words = match work {
        Work::Compiling => "compiling …",
        Work::Building => "building the picture …",
    };
    Some((words, format!("{} s", time.as_secs())))
}

/// The largest factor for the values at hand; all of them and what they come from when the pointer rests on it.
fn factor(ui: &mut Ui, session: &Session) {
    let factors: Vec<_> = session.factors().map(|(_, factor)| factor).collect();
    let largest = factors.iter().map(|f| f.live).fold(1.0, f64::max);
    let mut hover =
        "by how much the field is divided, so that a ray never steps too far".to_owned();
    for factor in factors.iter().take(12) {
        hover.push_str(&format!("\n{}{}", "    ".repeat(factor.depth), factor.headline()));
    }
    if factors.len() > 12 {
        hover.push_str(&format!("\nand {} more", factors.len() - 12));
    }
    entry(ui, "factor", &format!("{largest:.2}"), &hover);
}

/// A mark where something in the scene is only measured.
fn unproven(ui: &mut Ui, scene: &Compiled) {
    if scene.summary.kind != Kind::Unproven {
        return;
    }
    let hover = "a factor of this scene is measured and not proven: rays may step through; the problems say which";
    ui.label(RichText::new("unproven").color(theme::ERROR)).on_hover_text(hover);
}

fn milliseconds(time: Duration) -> String {
    let ms = time.as_secs_f64() * 1e3;
    match ms {
        ms if ms < 10.0 => format!("{ms:.1} ms"),
        ms if ms < 1e4 => format!("{ms:.0} ms"),
        ms => format!("{:.1} s", ms / 1e3),
    }
}
