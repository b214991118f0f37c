//! What made the pixel that a person pointed at: over the picture, in its lower right corner.

use crate::window::command::Command;
use crate::window::looking::Found;
use crate::window::panels::icons::{self, Icon};
use crate::window::session::Session;
use crate::window::theme;
use surefoot_compiler::reference::shade::Seen;
use surefoot_compiler::vector::{length, sub};
use egui::{Align, Align2, Area, CornerRadius, Frame, Id, Layout, Link, Margin, Order, Rect, RichText, Ui};

/// How wide it is at most.
const WIDE: f32 = 380.0;
/// Words that are written of a part at most, in characters.
const LONGEST: usize = 34;
/// Parts that are listed at most: the innermost ones.
const MOST: usize = 8;

/// Shows the panel, where there is something to show.
pub fn show(ui: &mut Ui, rect: Rect, session: &Session, commands: &mut Vec<Command>) {
    let Some(found) = session.looking.found.as_ref() else { return };
    let room = rect.shrink(10.0);
    let area = Area::new(Id::unique("picked")).pivot(Align2::RIGHT_BOTTOM).fixed_pos(room.right_bottom()).constrain_to(room).order(Order::Middle);
    area.show(ui.ctx(), |ui| {
        let frame = Frame::new().fill(theme::PANEL.gamma_multiply(0.94)).corner_radius(CornerRadius::same(5)).inner_margin(Margin::symmetric(10, 7));
        frame.show(ui, |ui| {
            let wide = WIDE.min(room.width() - 20.0).max(60.0);
            ui.set_min_width(wide);
            ui.set_max_width(wide);
            ui.horizontal(|ui| {
                ui.label(RichText::new("Picked").strong());
                ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                    if icons::button(ui, Icon::Close, "Close what was picked", true).clicked() {
                        commands.push(Command::Unpick);
                    }
                });
            });
            match found {
                Err(why) => drop(ui.label(RichText::new(why).color(theme::ERROR))),
                Ok(found) => words(ui, session, found, commands),
            }
        });
    });
}

fn words(ui: &mut Ui, session: &Session, found: &Found, commands: &mut Vec<Command>) {
    if !found.is_of(session.scene(), session.stage.live()) {
        ui.label(RichText::new("The scene has changed since.").small().color(theme::WARNING));
    }
    match found.seen {
        Some(seen) => {
            parts(ui, found, &seen, commands);
            if let Some(before) = session.looking.before {
                let unit = session.scene().and_then(|scene| scene.blocks.unit).map_or("", |unit| unit.name());
                let words = format!("{:.4} {unit} from the point that was picked before", length(sub(seen.point, before)));
                ui.label(RichText::new(words.replace("  ", " ")).small().color(theme::TEXT));
            }
        }
        None => drop(ui.label("nothing is seen there")),
    }
    super::ray::show(ui, session, found, commands);
}

fn parts(ui: &mut Ui, found: &Found, seen: &Seen, commands: &mut Vec<Command>) {
    let skipped = found.parts.len().saturating_sub(MOST);
    for (depth, part) in found.parts.iter().skip(skipped).enumerate() {
        let is_last = skipped + depth + 1 == found.parts.len();
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 6.0;
            ui.add_space(6.0 * depth as f32);
            let name = if part.cuts { format!("{} (taken away)", part.name) } else { part.name.clone() };
            let color = if is_last { theme::ACCENT } else { theme::TEXT };
            if ui.add(Link::new(RichText::new(name).color(color))).on_hover_text(&part.text).clicked() {
                commands.push(Command::Jump(part.place.clone()));
            }
            ui.label(RichText::new(format!("line {}", part.place.start.0)).small().color(theme::WEAK));
        });
        if is_last && part.text != part.name {
            let short: String = part.text.chars().take(LONGEST).collect();
            let dots = if short.len() < part.text.len() { "…" } else { "" };
            ui.label(RichText::new(format!("{short}{dots}")).monospace().small().color(theme::WEAK));
        }
    }
    let three = |v: [f64; 3]| v.map(|c| format!("{:.3}", c + 0.0)).join(", ");
    ui.label(RichText::new(format!("point {}", three(seen.point))).small().color(theme::WEAK));
    ui.label(RichText::new(format!("normal {}; {:.3} away", three(seen.normal), seen.t)).small().color(theme::WEAK));
}
