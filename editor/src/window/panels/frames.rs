//! What frames take: a graph of the last pictures' times, and the passes of a frame with theirs.

use crate::window::command::Command;
use crate::window::panels::icons;
use crate::window::session::{Meter, Session};
use crate::window::theme;
use egui::{Align, Button, Layout, Rect, RichText, ScrollArea, Sense, Stroke, Ui, pos2, vec2};
use std::sync::Arc;

/// How high the graph is.
const HIGH: f32 = 74.0;
/// What it shows at least, in seconds.
const LEAST: f32 = 0.02;

/// Shows the panel.
pub fn show(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    ui.take_available_width();
    ui.set_min_height(ui.available_height());
    let passes = &session.passes;
    ui.horizontal(|ui| {
        ui.label(RichText::new("Frames").strong());
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let ready = !passes.is_busy() && session.scene().is_some();
            let measure = ui.add_enabled(ready, Button::new("Measure passes").small());
            if measure.on_hover_text("draw the picture several times, pass after pass, and see what takes how long").clicked() {
                commands.push(Command::MeasurePasses);
            }
        });
    });
    graph(ui, &session.meter);
    ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        if passes.is_busy() {
            ui.label(RichText::new("Measuring …").color(theme::WEAK));
        }
        let Some((scene, found)) = &passes.found else { return };
        if !session.scene().is_some_and(|now| Arc::ptr_eq(now, scene)) {
            ui.label(RichText::new("The scene has changed since.").small().color(theme::WARNING));
        }
        match found {
            Err(why) => drop(ui.label(RichText::new(why).color(theme::ERROR))),
            Ok(explained) => {
                for pass in &explained.passes {
                    ui.horizontal(|ui| {
                        ui.label(pass.name).on_hover_text(&pass.reason);
                        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                            ui.label(format!("{:.1} ms", pass.time.as_secs_f64() * 1e3));
                            ui.label(RichText::new(&pass.size).small().color(theme::WEAK));
                        });
                    });
                }
                for (what, why) in &explained.left_out {
                    ui.label(RichText::new(format!("without {what}")).small().color(theme::WEAK)).on_hover_text(*why);
                }
            }
        }
    });
}

/// The times of the last pictures, the newest at the right.
fn graph(ui: &mut Ui, meter: &Meter) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), HIGH), Sense::hover());
    let longest = meter.frames.iter().copied().fold(LEAST, f32::max);
    let last = meter.frames.back().copied().unwrap_or(0.0);
    let words = format!("The last pictures took up to {:.1} ms, the newest {:.1} ms", longest_of(meter) * 1e3, last * 1e3);
    icons::name(ui, response.id, &words);
    response.on_hover_text(&words);
    let painter = ui.painter();
    painter.rect_filled(rect, 2.0, *theme::WELL);
    let high = |seconds: f32| rect.bottom() - 1.0 - (rect.height() - 14.0) * (seconds / longest).min(1.0);
    // A sixtieth of a second, where the graph has room for it.
    for seconds in [1.0 / 60.0, 1.0 / 10.0].into_iter().filter(|seconds| *seconds < longest) {
        painter.hline(rect.x_range(), high(seconds), Stroke::new(1.0, *theme::LINE));
    }
    let wide = rect.width() / Meter::KEPT as f32;
    for (i, seconds) in meter.frames.iter().rev().enumerate() {
        let right = rect.right() - wide * i as f32;
        let bar = Rect::from_min_max(pos2(right - (wide - 0.5).max(1.0), high(*seconds)), pos2(right, rect.bottom()));
        painter.rect_filled(bar, 0.0, *theme::ACCENT);
    }
    let label = format!("{:.0} ms", longest * 1e3);
    painter.text(rect.left_top() + vec2(4.0, 1.0), egui::Align2::LEFT_TOP, label, egui::FontId::proportional(10.0), *theme::WEAK);
}

fn longest_of(meter: &Meter) -> f32 {
    meter.frames.iter().copied().fold(0.0, f32::max)
}
