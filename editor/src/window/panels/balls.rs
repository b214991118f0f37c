//! The balls: how many there are and what a step of them takes; one step, back to the start, more of them where the pointer is, and one
//! that is thrown.

use crate::window::command::{Command, DROP};
use crate::window::panels::icons::{self, Icon};
use crate::window::session::Session;
use crate::window::theme;
use egui::{CursorIcon, Key, Modifiers, PointerButton, Response, RichText, Ui};

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
        "{cost:.1} ms a step, from the order to its end; {} steps so far.\nControl and a click on the picture, or B, drops {DROP} more there; Control and a drag takes a ball and throws it.",
        balls.steps()
    );
    ui.label(RichText::new(words).color(theme::WEAK)).on_hover_text(hover);
}

/// Drops balls where a hand points in the picture, and takes, pulls and throws one. Answers whether the drag is that and not the camera's.
pub fn sense(ui: &Ui, session: &Session, response: &Response, commands: &mut Vec<Command>) -> bool {
    if session.stage.balls().is_none() {
        return false;
    }
    let size = response.rect.size();
    let size = [size.x, size.y].map(|s| s.max(1.0) as u32);
    let place = |at: egui::Pos2| [f64::from(at.x - response.rect.min.x), f64::from(at.y - response.rect.min.y)];
    let command = ui.input(|i| i.modifiers.command);
    let clicked = command && response.clicked_by(PointerButton::Primary);
    let writes = ui.ctx().egui_wants_keyboard_input();
    let key = !writes && response.hovered() && ui.input_mut(|i| i.consume_key(Modifiers::NONE, Key::B));
    if (clicked || key) && let Some(at) = response.hover_pos() {
        commands.push(Command::DropBalls { at: place(at), size });
    }
    if command && response.drag_started_by(PointerButton::Primary) {
        // Where the button went down: by the time that it is a drag the pointer has gone on.
        if let Some(at) = ui.input(|i| i.pointer.press_origin()) {
            commands.push(Command::TakeBall { at: place(at), size });
        }
        return true;
    }
    if session.held.is_none() {
        return false;
    }
    if !response.dragged_by(PointerButton::Primary) {
        let speed = ui.input(|i| i.pointer.velocity()) / response.rect.height().max(1.0);
        commands.push(Command::ThrowBall { speed: [f64::from(speed.x), f64::from(speed.y)] });
    } else if let Some(at) = response.interact_pointer_pos() {
        ui.ctx().set_cursor_icon(CursorIcon::Grabbing);
        commands.push(Command::PullBall { at: place(at), size });
    }
    true
}
