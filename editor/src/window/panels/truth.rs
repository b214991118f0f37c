//! The picture beside what is certain of it: over the picture the difference of each pixel, and what the colours mean.

use crate::window::command::Command;
use crate::window::panels::icons::{self, Icon};
use crate::window::panels::legend::{bar, words};
use crate::window::session::Session;
use crate::window::theme;
use crate::window::truth::{CELL, Count, LEAST, difference_color};
use egui::{Align2, Area, Color32, CornerRadius, Frame, Id, Margin, Order, ProgressBar, Rect, TextureOptions, Ui, pos2, vec2};

/// Shows it where a person wants to see it.
pub fn show(ui: &mut Ui, rect: Rect, session: &Session, commands: &mut Vec<Command>) {
    if !session.truth.open {
        return;
    }
    if let Some(Ok(found)) = &session.truth.found {
        // It is uploaded where it is another one.
        let id = Id::unique("truth");
        let known = ui.data(|data| data.get_temp::<(usize, egui::TextureHandle)>(id));
        let key = std::sync::Arc::as_ptr(&found.image) as usize;
        let texture = match known.filter(|(known, _)| *known == key) {
            Some((_, texture)) => texture,
            None => {
                let texture = ui.ctx().load_texture("truth", found.image.clone(), TextureOptions::NEAREST);
                ui.data_mut(|data| data.insert_temp(id, (key, texture.clone())));
                texture
            }
        };
        let [columns, rows] = found.image.size.map(|side| (side * CELL as usize) as f32);
        let [width, height] = found.seen.size.map(|side| side as f32);
        let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(width / columns, height / rows));
        ui.painter().image(texture.id(), rect, uv, Color32::WHITE);
    }
    let corner = rect.right_bottom() + vec2(-10.0, -10.0);
    let area = Area::new(Id::unique("truth")).pivot(Align2::RIGHT_BOTTOM).fixed_pos(corner).constrain_to(rect).order(Order::Middle);
    area.show(ui.ctx(), |ui| {
        let frame = Frame::new().fill(theme::PANEL.gamma_multiply(0.94)).corner_radius(CornerRadius::same(5)).inner_margin(Margin::symmetric(9, 6));
        frame.show(ui, |ui| {
            ui.set_max_width(240.0);
            ui.horizontal(|ui| {
                ui.label("Difference from the truth");
                if icons::small(ui, Icon::Close, "Close the difference").clicked() {
                    commands.push(Command::ShowTruth(false));
                }
            });
            bar(ui, &["0.001", "in depth", "1 pixel"], |share| difference_color(LEAST.powf(1.0 - share)));
            match &session.truth.found {
                None => words(ui, if session.stage.animates() { "let time stand" } else { "looking…" }),
                Some(Err(why)) => words(ui, why),
                Some(Ok(found)) => {
                    if found.part < 1.0 {
                        ui.add(ProgressBar::new(found.part).desired_height(6.0));
                    }
                    words(ui, &told(&found.count));
                }
            }
        });
    });
}

fn told(count: &Count) -> String {
    let Count { all, missed, extra, edges, unknown, most } = *count;
    format!("of {all} pixels {missed} missed (red), {extra} that are nothing (pink), {edges} at edges (grey), {unknown} unknown (blue); the others at most {most:.3} pixels off")
}
