//! The march of the ray of what was picked: a slice of the field through it, and a table of its steps.

use crate::marched;
use crate::window::command::Command;
use crate::window::looking::{Found, SLICE};
use crate::window::session::Session;
use crate::window::theme;
use egui::{Color32, Grid, Link, Pos2, Rect, RichText, ScrollArea, Sense, Stroke, Ui, pos2, vec2};
use surefoot_compiler::reference::Kind;

/// How high the table is at most.
const TABLE: f32 = 110.0;

/// Shows it below what was picked.
pub fn show(ui: &mut Ui, session: &Session, found: &Found, commands: &mut Vec<Command>) {
    let march = &found.march;
    let end = match (march.hit.hit, march.plane.is_some(), march.steps.last().map(|step| step.kind)) {
        (true, true, _) => "hit a plane",
        (true, false, _) => "hit",
        (false, _, Some(Kind::Spent)) => "all steps used up",
        _ => "nothing met",
    };
    ui.horizontal(|ui| {
        let name = if session.open.ray { "Hide the ray" } else { "Follow the ray" };
        if ui.small_button(name).clicked() {
            commands.push(Command::ShowRay(!session.open.ray));
        }
        ui.label(RichText::new(format!("{} steps, {end}", march.hit.steps)).small().color(theme::WEAK));
        if found.asked.from > 0 && ui.small_button("Whole ray").clicked() {
            commands.push(Command::Closer(0));
        }
        if let Some(chosen) = session.looking.chosen.filter(|chosen| *chosen != found.asked.from && session.open.ray)
            && ui.small_button("From here").on_hover_text("show the slice from this step on").clicked()
        {
            commands.push(Command::Closer(chosen));
        }
    });
    if session.open.ray && !march.steps.is_empty() {
        slice(ui, session, found, commands);
        table(ui, session, found, commands);
    }
}

fn slice(ui: &mut Ui, session: &Session, found: &Found, commands: &mut Vec<Command>) {
    let wide = ui.available_width();
    let (response, painter) = ui.allocate_painter(vec2(wide, wide * SLICE.1 as f32 / SLICE.0 as f32), Sense::click());
    let rect = response.rect;
    painter.image(found.texture(ui.ctx()), rect, Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0)), Color32::WHITE);
    let scale = rect.width() / SLICE.0 as f32;
    let place = |t: f64| {
        let [x, y] = found.slice.place(t);
        rect.min + vec2(x as f32, y as f32) * scale
    };
    if let Some(step) = session.looking.chosen.and_then(|chosen| found.march.steps.get(chosen)) {
        for (color, radius) in [(marched::DISTANCE, step.distance), (marched::BOUND, step.bound)] {
            let [r, g, b] = color.map(|c| (255.0 * c) as u8);
            let radius = (radius.abs() / found.slice.pixel) as f32 * scale;
            painter.with_clip_rect(rect).circle_stroke(place(step.t), radius.max(2.0), Stroke::new(2.0, Color32::from_rgb(r, g, b)));
        }
    }
    if let (true, Some(at)) = (response.clicked(), response.interact_pointer_pos()) {
        let far = |step: &surefoot_compiler::reference::steps::Step| (place(step.t).x - at.x).abs();
        let nearest = found.march.steps.iter().enumerate().min_by(|a, b| far(a.1).total_cmp(&far(b.1)));
        commands.extend(nearest.map(|(step, _)| Command::ChooseStep(step)));
    }
    let unit = session.scene().and_then(|scene| scene.blocks.unit).map_or("", |unit| unit.name());
    let words = format!("white: distance, yellow: bound; lines every {} {unit}", found.slice.spacing());
    ui.label(RichText::new(words.trim_end()).small().color(theme::WEAK));
}

fn table(ui: &mut Ui, session: &Session, found: &Found, commands: &mut Vec<Command>) {
    ScrollArea::vertical().max_height(TABLE).auto_shrink([false, true]).id_salt("steps").show(ui, |ui| {
        Grid::new("steps").num_columns(6).spacing(vec2(8.0, 2.0)).show(ui, |ui| {
            for head in ["", "t", "distance", "bound", "how", "held by"] {
                ui.label(RichText::new(head).small().color(theme::WEAK));
            }
            ui.end_row();
            for (at, (step, held)) in found.march.steps.iter().zip(&found.held).enumerate() {
                let color = if session.looking.chosen == Some(at) { theme::ACCENT } else { theme::TEXT };
                let words = |words: String| RichText::new(words).small().color(color);
                if ui.add(Link::new(words((at + 1).to_string()))).on_hover_text("let this step stand out").clicked() {
                    commands.push(Command::ChooseStep(at));
                }
                for number in [step.t, step.distance, step.bound] {
                    ui.label(words(format!("{number:.4}")));
                }
                ui.label(words(step.kind.name().to_owned()));
                match held {
                    Some((by, place)) => {
                        if ui.add(Link::new(words(by.clone()))).clicked() {
                            commands.push(Command::Jump(place.clone()));
                        }
                    }
                    None => drop(ui.label("")),
                }
                ui.end_row();
            }
        });
    });
}
