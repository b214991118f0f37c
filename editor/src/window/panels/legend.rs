//! What the colours of a view mean, and where the plane of a slice is: over the picture, in its upper left corner.

use crate::window::command::Command;
use crate::window::session::Session;
use crate::window::theme;
use egui::{Align2, Area, Color32, CornerRadius, Frame, Id, Margin, Order, Rect, RichText, Sense, Slider, Ui, pos2, vec2};
use surefoot_compiler::reference::shade::{OPERATIONS, depth_color, factor_color, gradient_color, operations_color, slice_spacing, steps_color};
use surefoot_compiler::vector::{length, sub};
use surefoot_runtime::ViewMode;

/// How wide and how high a bar of colours is.
const BAR: egui::Vec2 = vec2(190.0, 10.0);
/// How many colours it has.
const COLORS: u32 = 64;

/// Shows the legend of the view that is shown, where it has one.
pub fn show(ui: &mut Ui, rect: Rect, session: &Session, commands: &mut Vec<Command>) {
    if session.look.mode == ViewMode::Shaded || session.scene().is_none() {
        return;
    }
    let area = Area::new(Id::unique("legend")).pivot(Align2::LEFT_TOP).fixed_pos(rect.left_top() + vec2(10.0, 10.0)).constrain_to(rect).order(Order::Middle);
    area.show(ui.ctx(), |ui| {
        let frame = Frame::new().fill(theme::PANEL.gamma_multiply(0.9)).corner_radius(CornerRadius::same(5)).inner_margin(Margin::symmetric(9, 6));
        frame.show(ui, |ui| body(ui, session, session.look.mode, commands));
    });
}

/// The legend of a view.
pub fn body(ui: &mut Ui, session: &Session, mode: ViewMode, commands: &mut Vec<Command>) {
    ui.set_max_width(BAR.x);
    let far = session.scene().zip(session.stage.live()).map_or(100.0, |(scene, live)| scene.frame(live).max_distance);
    match mode {
        ViewMode::Steps => bar(ui, &["0", "32", "64 steps"], |share| steps_color((64.0 * share).round() as u32)),
        ViewMode::Operations => bar(ui, &["64", "operations", "1 million"], |share| operations_color(OPERATIONS.0 * (OPERATIONS.1 / OPERATIONS.0).powf(share))),
        ViewMode::Depth => bar(ui, &["0", &format!("{far:.0} away")], |share| depth_color(share * far, far)),
        ViewMode::Gradient => bar(ui, &["1/4", "slope 1", "4"], |share| gradient_color(16f64.powf(share - 0.5))),
        ViewMode::Factor => bar(ui, &["1/8", "of the distance", "all"], |share| factor_color(8f64.powf(share - 1.0))),
        ViewMode::Occlusion => bar(ui, &["closed", "open"], |share| [share; 3]),
        ViewMode::Shadow => bar(ui, &["dark", "lit"], |share| [share; 3]),
        ViewMode::Normals => words(ui, "red x, green y, blue z; grey is square to the axis"),
        ViewMode::Slice(axis) => slice(ui, session, axis, commands),
        ViewMode::Shaded => {}
    }
}

/// A few words of it.
pub fn words(ui: &mut Ui, words: &str) {
    ui.label(RichText::new(words).small().color(theme::TEXT));
}

/// A bar of colours, and what its ends and what lies between mean.
pub fn bar(ui: &mut Ui, names: &[&str], color: impl Fn(f64) -> [f64; 3]) {
    let (rect, _) = ui.allocate_exact_size(BAR, Sense::hover());
    for i in 0..COLORS {
        let side = |i: u32| rect.left() + rect.width() * i as f32 / COLORS as f32;
        let [r, g, b] = color(f64::from(i) / f64::from(COLORS - 1)).map(|c| (255.0 * c.clamp(0.0, 1.0)).round() as u8);
        let part = Rect::from_min_max(pos2(side(i), rect.top()), pos2(side(i + 1), rect.bottom()));
        ui.painter().rect_filled(part, 0.0, Color32::from_rgb(r, g, b));
    }
    ui.horizontal(|ui| {
        ui.set_width(BAR.x);
        let room = BAR.x / names.len() as f32;
        for (i, name) in names.iter().enumerate() {
            let align = match i {
                0 => egui::Layout::left_to_right(egui::Align::Min),
                _ if i + 1 == names.len() => egui::Layout::right_to_left(egui::Align::Min),
                _ => egui::Layout::top_down(egui::Align::Center),
            };
            ui.spacing_mut().item_spacing.x = 0.0;
            ui.allocate_ui_with_layout(vec2(room, 14.0), align, |ui| words(ui, name));
        }
    });
}

fn slice(ui: &mut Ui, session: &Session, axis: u8, commands: &mut Vec<Command>) {
    let Some(camera) = session.camera() else { return };
    let name = ["x", "y", "z"].get(usize::from(axis)).copied().unwrap_or("z");
    let middle = camera.target.get(usize::from(axis)).copied().unwrap_or(0.0);
    let reach = 0.5 * length(sub(camera.eye, camera.target));
    let mut at = session.stage.slice();
    // Where a hand typed something farther away it stays.
    let range = (middle - reach).min(at)..=(middle + reach).max(at);
    let slider = ui.add(Slider::new(&mut at, range).text(name).max_decimals(4));
    if slider.on_hover_text("where the plane is; drag, or click the number to type").changed() {
        commands.push(Command::Slice(at));
    }
    let unit = session.scene().and_then(|scene| scene.blocks.unit).map_or("", |unit| unit.name());
    words(ui, format!("blue outside, orange inside; lines every {} {unit}", slice_spacing(&camera)).trim_end());
}
