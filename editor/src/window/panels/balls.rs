//! The balls: how many there are and what a step of them takes; one step, back to the start, and more of them where the pointer is.

use crate::window::command::Command;
use crate::window::panels::icons::{self, Icon};
use crate::window::session::Session;
use crate::window::theme;
use egui::{Key, Modifiers, PointerButton, Response, RichText, Ui};

/// Balls of one drop.
pub const DROP: u32 = 64;

/// Shows what the toolbar has of them.
pub fn show(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let Some(balls) = session.stage.balls() else { return };
    ui.separator();
    let step = icons::button(ui, Icon::Step, "Step", !session.stage.playing);
    if step.on_hover_text("one step of the balls, a 60th of a second, while time stands").clicked() {
        commands.push(Command::StepBalls);
    }
    if ui.button("Pour again").on_hover_text("the balls back to where they begin").clicked() {
        commands.push(Command::ResetBalls);
    }
    let words = match balls.count() {
        1 => "1 ball".to_owned(),
        count => format!("{count} balls"),
    };
    let cost = balls.cost().as_secs_f64() * 1e3;
    let hover = format!(
        "{cost:.1} ms a step, from the order to its end; {} steps so far.\nControl and a click on the picture, or B, drops {DROP} more there.",
        balls.steps()
    );
    ui.label(RichText::new(words).color(theme::WEAK)).on_hover_text(hover);
}

/// Drops balls where a hand points in the picture.
pub fn sense(ui: &Ui, response: &Response, commands: &mut Vec<Command>) {
    let command = ui.input(|i| i.modifiers.command);
    let clicked = command && response.clicked_by(PointerButton::Primary);
    let writes = ui.ctx().egui_wants_keyboard_input();
    let key = !writes && response.hovered() && ui.input_mut(|i| i.consume_key(Modifiers::NONE, Key::B));
    if !(clicked || key) {
        return;
    }
    if let Some(at) = response.hover_pos() {
        let at = at - response.rect.min;
        let size = response.rect.size();
        commands.push(Command::DropBalls { at: [f64::from(at.x), f64::from(at.y)], size: [size.x, size.y].map(|s| s.max(1.0) as u32) });
    }
}
