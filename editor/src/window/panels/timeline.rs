//! The timeline below the picture of a scene that moves: where time is, how long it runs, and whether it begins anew at its end.

use crate::window::command::Command;
use crate::window::panels::icons;
use crate::window::session::{Session, Timeline};
use egui::{DragValue, Slider, SliderClamping, Ui};

/// Shows it.
pub fn show(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let Timeline { length, mut loops } = session.timeline;
    ui.horizontal_centered(|ui| {
        let mut seconds = session.stage.time();
        // What stands behind it has its room.
        ui.spacing_mut().slider_width = (ui.available_width() - 150.0).max(40.0);
        let slider = Slider::new(&mut seconds, 0.0..=length).show_value(false).clamping(SliderClamping::Never);
        let response = ui.add(slider).on_hover_text("the scene's `time`");
        icons::name(ui, response.id, "Timeline");
        if response.changed() {
            commands.push(Command::Time(seconds));
        }
        let mut wanted = length;
        let response = ui.add(DragValue::new(&mut wanted).range(Timeline::LENGTHS).speed(0.05).max_decimals(2).suffix(" s"));
        icons::name(ui, response.id, "Length");
        if response.on_hover_text("how long the timeline is: drag, or click to type").changed() {
            commands.push(Command::Timeline(Timeline { length: wanted, loops }));
        }
        if ui.checkbox(&mut loops, "Loop").on_hover_text("at its end time begins anew (L)").changed() {
            commands.push(Command::Timeline(Timeline { length, loops }));
        }
    });
}
