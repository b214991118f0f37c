//! Two views beside each other: the divider that a hand drags, and the view right of it.

use crate::window::command::Command;
use crate::window::panels::icons;
use crate::window::panels::modes::{MODES, MORE};
use crate::window::session::Session;
use crate::window::theme;
use egui::accesskit::{Action, Role};
use egui::{Align2, Area, Color32, ComboBox, CornerRadius, CursorIcon, EventFilter, Frame, Id, Key, Margin, Order, Rect, Sense, Stroke, StrokeKind, Ui, pos2, vec2};
use surefoot_runtime::ViewMode;

/// How wide what a hand can hit is, in points.
const REACH: f32 = 12.0;
/// Width and height of the grip.
const GRIP: egui::Vec2 = vec2(8.0, 40.0);
/// How far a key moves it, in parts of the picture's width.
const STEP: f32 = 0.02;

/// What shows two views, or one again: at first that of the steps is on the right.
pub fn switch(session: &Session) -> Command {
    let other = if session.look.mode == ViewMode::Steps { ViewMode::Shaded } else { ViewMode::Steps };
    Command::Beside(session.look.beside.is_none().then_some(other))
}

/// Shows it where there are two views.
pub fn show(ui: &mut Ui, rect: Rect, session: &Session, commands: &mut Vec<Command>) {
    let Some(beside) = session.look.beside else { return };
    divider(ui, rect, session.look.divider, commands);
    let corner = rect.right_top() + vec2(-10.0, 10.0);
    let area = Area::new(Id::unique("view beside")).pivot(Align2::RIGHT_TOP).fixed_pos(corner).constrain_to(rect).order(Order::Middle);
    area.show(ui.ctx(), |ui| {
        let frame = Frame::new().fill(theme::PANEL.gamma_multiply(0.9)).corner_radius(CornerRadius::same(5)).inner_margin(Margin::symmetric(9, 6));
        frame.show(ui, |ui| {
            let all = || MODES.iter().chain(&MORE);
            let shown = all().find(|(mode, ..)| *mode == beside).map_or("", |(_, name, _)| name);
            let list = ComboBox::from_id_salt("view beside").selected_text(shown).width(90.0);
            let list = list.show_ui(ui, |ui| {
                for (mode, name, hover) in all() {
                    if ui.selectable_label(*mode == beside, *name).on_hover_text(*hover).clicked() {
                        commands.push(Command::Beside(Some(*mode)));
                    }
                }
            });
            icons::name(ui, list.response.id, "View at the right");
            super::legend::body(ui, session, beside, commands);
        });
    });
}

/// The line between the views, and what a hand or a key does to it.
fn divider(ui: &mut Ui, rect: Rect, share: f32, commands: &mut Vec<Command>) {
    let x = rect.left() + share * rect.width();
    let id = ui.scope_id().with("divider");
    let hit = Rect::from_center_size(pos2(x, rect.center().y), vec2(REACH, rect.height())).intersect(rect);
    let response = ui.interact(hit, id, Sense::click_and_drag()).on_hover_cursor(CursorIcon::ResizeHorizontal);
    ui.ctx().accesskit_node_builder(id, |node| {
        node.set_role(Role::Splitter);
        node.set_label("Divider of the two views");
        node.set_numeric_value(f64::from(share));
        node.set_min_numeric_value(0.0);
        node.set_max_numeric_value(1.0);
        node.add_action(Action::Increment);
        node.add_action(Action::Decrement);
    });
    let mut wanted = share;
    if let Some(at) = response.interact_pointer_pos().filter(|_| response.dragged()) {
        wanted = (at.x - rect.left()) / rect.width().max(1.0);
    }
    if response.drag_started() || response.clicked() {
        response.request_focus();
    }
    if response.has_focus() {
        ui.memory_mut(|m| m.set_focus_lock_filter(id, EventFilter { horizontal_arrows: true, ..Default::default() }));
        for (key, step) in [(Key::ArrowLeft, -STEP), (Key::ArrowRight, STEP)] {
            wanted += ui.input(|i| i.num_presses(key)) as f32 * step;
        }
    }
    for (action, step) in [(Action::Decrement, -STEP), (Action::Increment, STEP)] {
        wanted += ui.input(|i| i.num_accesskit_action_requests(id, action)) as f32 * step;
    }
    if wanted != share {
        commands.push(Command::Divide(wanted));
    }
    let is_hot = response.hovered() || response.dragged() || response.has_focus();
    let painter = ui.painter_at(rect);
    painter.vline(x, rect.y_range(), Stroke::new(1.0, Color32::from_white_alpha(if is_hot { 255 } else { 190 })));
    let grip = Rect::from_center_size(pos2(x, rect.center().y), GRIP);
    painter.rect(grip, CornerRadius::same(4), *theme::PANEL, Stroke::new(if is_hot { 2.0 } else { 1.0 }, Color32::WHITE), StrokeKind::Middle);
}
