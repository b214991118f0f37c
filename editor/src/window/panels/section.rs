//! The plane that cuts the picture open: what it is square to, which side stays, and where it is. Over the picture, in its upper left corner.

use crate::window::command::Command;
use crate::window::panels::icons::{self, Icon};
use crate::window::session::Session;
use crate::window::theme;
use egui::{Align2, Area, CornerRadius, Frame, Id, Margin, Order, Rect, Slider, Ui, vec2};
use surefoot_compiler::section::{Across, Section};
use surefoot_compiler::vector::{length, sub};
use surefoot_runtime::ViewMode;

/// Shows it where the picture is cut open.
pub fn show(ui: &mut Ui, rect: Rect, session: &Session, commands: &mut Vec<Command>) {
    let Some(section) = session.look.section.filter(|_| session.look.cuts) else { return };
    let Some(camera) = session.camera() else { return };
    // Below the legends.
    let has_none = session.look.mode == ViewMode::Shaded && session.look.beside.is_none();
    let corner = rect.left_top() + vec2(10.0, if has_none { 10.0 } else { 92.0 });
    let area = Area::new(Id::unique("section")).pivot(Align2::LEFT_TOP).fixed_pos(corner).constrain_to(rect).order(Order::Middle);
    area.show(ui.ctx(), |ui| {
        let frame = Frame::new().fill(theme::PANEL.gamma_multiply(0.9)).corner_radius(CornerRadius::same(5)).inner_margin(Margin::symmetric(9, 6));
        frame.show(ui, |ui| {
            ui.horizontal(|ui| {
                ui.label("Section");
                for across in Across::ALL {
                    let button = ui.selectable_label(section.cut.across == across, across.name());
                    icons::name(ui, button.id, &format!("Section across {}", across.name()));
                    if button.on_hover_text(hover(across)).clicked() && across != section.cut.across {
                        commands.push(Command::Section(Section::through(across, &camera)));
                    }
                }
                if ui.small_button("Flip").on_hover_text("show the other side (Shift+C)").clicked() {
                    commands.push(Command::Section(section.flipped()));
                }
                if icons::small(ui, Icon::Close, "No section").clicked() {
                    commands.push(Command::ShowSection(false));
                }
            });
            let middle = Section::through(section.cut.across, &camera).at;
            let reach = 0.5 * length(sub(camera.eye, camera.target));
            let mut at = section.at;
            // Where a hand typed something farther away it stays.
            let range = (middle - reach).min(at)..=(middle + reach).max(at);
            let slider = ui.add(Slider::new(&mut at, range).max_decimals(4));
            icons::name(ui, slider.id, "Place of the section");
            if slider.on_hover_text("where the plane is; drag, or click the number to type").changed() {
                commands.push(Command::Section(Section { at, ..section }));
            }
        });
    });
}

fn hover(across: Across) -> &'static str {
    match across {
        Across::View => "a plane across the camera's direction, which turns with it; its place is how far it is beyond what the camera looks at",
        _ => "a plane square to this axis",
    }
}
