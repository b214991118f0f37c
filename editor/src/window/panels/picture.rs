//! The picture, the camera that a hand moves, and the band that says why the picture is an older one.

use crate::window::canvas::Shown;
use crate::window::command::Command;
use crate::window::orbit::Side;
use crate::window::panels::icons::{self, Icon};
use crate::window::panels::status::working;
use crate::window::session::{Session, Timeline};
use crate::window::theme;
use egui::{
    Align, Color32, CornerRadius, Frame, Key, Layout, Margin, PointerButton, Rect, Response, RichText, Sense, Ui,
    UiBuilder,
};
use std::time::Duration;

/// Work that is done sooner is not spoken of over the picture.
const LONG: Duration = Duration::from_secs(1);

/// How much a step of the wheel changes the distance.
const WHEEL: f64 = 0.0022;

/// Takes the room of the picture, and what a hand does there.
pub fn sense(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) -> Response {
    let response = ui.allocate_response(ui.available_size(), Sense::click_and_drag());
    icons::name(ui, response.id, "Picture");
    let height = f64::from(response.rect.height().max(1.0));
    let throws = super::balls::sense(ui, session, &response, commands);
    let drag = response.drag_delta();
    if drag != egui::Vec2::ZERO && !throws {
        let (right, down) = (f64::from(drag.x) / height, f64::from(drag.y) / height);
        let aside = response.dragged_by(PointerButton::Secondary)
            || response.dragged_by(PointerButton::Middle)
            || ui.input(|i| i.modifiers.shift);
        commands.push(if aside { Command::Pan(right, down) } else { Command::Turn(right, down) });
    }
    if response.hovered() {
        let (wheel, pinch) = ui.input(|i| (i.smooth_scroll_delta.y, i.zoom_delta()));
        if wheel != 0.0 {
            commands.push(Command::Dolly((-f64::from(wheel) * WHEEL).exp()));
        } else if pinch != 1.0 {
            commands.push(Command::Dolly(1.0 / f64::from(pinch)));
        }
    }
    let picks = ui.input(|i| i.modifiers.alt) && response.clicked_by(PointerButton::Primary);
    if let (true, Some(at)) = (picks, response.interact_pointer_pos()) {
        let size = [response.rect.width(), height as f32].map(|side| side.max(1.0) as u32);
        commands.push(Command::Pick { at: [f64::from(at.x - response.rect.min.x), f64::from(at.y - response.rect.min.y)], size });
    }
    if response.double_clicked() && !picks {
        commands.push(Command::Home);
    }
    if response.clicked() || response.drag_started() {
        // Keys go to the picture again and not to the text.
        ui.memory_mut(|m| {
            if let Some(focused) = m.focused() {
                m.surrender_focus(focused);
            }
        });
    }
    response
}

/// Keys that work wherever no text is written.
pub fn keys(ui: &Ui, session: &Session, commands: &mut Vec<Command>) {
    if ui.ctx().egui_wants_keyboard_input() || session.question.is_some() {
        return;
    }
    if ui.input(|i| i.key_pressed(Key::Home)) {
        commands.push(Command::Home);
    }
    // A key with Control or Alt is another.
    let plain = |key| ui.input(|i| i.modifiers.is_none() && i.key_pressed(key));
    for (key, side) in [(Key::Num1, Side::Front), (Key::Num3, Side::Right), (Key::Num7, Side::Top), (Key::Num9, Side::Corner)] {
        if plain(key) {
            commands.push(Command::LookFrom(side));
        }
    }
    if plain(Key::G) {
        commands.push(Command::ShowGrid(!session.open.grid));
    }
    if plain(Key::Num5) {
        commands.push(Command::Parallel(!session.look.orbit.is_some_and(|orbit| orbit.parallel)));
    }
    if plain(Key::C) {
        commands.push(Command::ShowSection(!session.look.cuts));
    }
    if ui.input(|i| i.modifiers.shift_only() && i.key_pressed(Key::C)) && let Some(section) = session.look.section {
        commands.push(Command::Section(section.flipped()));
    }
    if plain(Key::D) {
        commands.push(Command::ShowTruth(!session.truth.open));
    }
    if plain(Key::W) {
        commands.push(super::wipe::switch(session));
    }
    if plain(Key::F) {
        commands.push(Command::FrameSelection);
    }
    if plain(Key::L) && session.moves() {
        commands.push(Command::Timeline(Timeline { loops: !session.timeline.loops, ..session.timeline }));
    }
    if ui.input(|i| i.key_pressed(Key::Space)) {
        commands.push(Command::Play(!session.stage.playing));
    }
}

/// Shows the picture, or that there is none yet.
pub fn paint(ui: &mut Ui, rect: Rect, session: &Session, shown: Option<Shown>) {
    match shown {
        Some(shown) => {
            ui.painter().image(shown.texture, rect, shown.uv, Color32::WHITE);
            let unseen = session.look.left.as_ref().is_some_and(|left| left.blind);
            if let Some((work, time)) = working(session, LONG) {
                label(ui, rect, &format!("{work} {time}"));
            } else if unseen {
                label(ui, rect, "nothing is in sight from here; Home goes back to the scene's camera");
            }
        }
        None => {
            ui.painter().rect_filled(rect, 0.0, *theme::GROUND);
            let words = match (wrong(session), working(session, LONG)) {
                (Some(_), _) => "no picture yet".to_owned(),
                (None, Some((work, time))) => format!("{work} {time}"),
                (None, None) => "compiling…".to_owned(),
            };
            ui.put(rect, egui::Label::new(RichText::new(words).heading().color(theme::WEAK)));
        }
    }
}

/// Why the picture is not that of the text, where something is wrong.
fn wrong(session: &Session) -> Option<&str> {
    let (said, error) = (&session.said, session.error().map(|problem| problem.message.as_str()));
    error.or(said.failure.as_deref()).or(said.drawing.as_deref()).or(session.stage.trouble())
}

/// A few words in the picture's lower left corner.
fn label(ui: &mut Ui, rect: Rect, words: &str) {
    let builder = UiBuilder::new().max_rect(rect.shrink(10.0)).layout(Layout::bottom_up(Align::Min));
    ui.scope_builder(builder, |ui| {
        let frame = Frame::new().fill(theme::PANEL.gamma_multiply(0.85)).corner_radius(CornerRadius::same(5)).inner_margin(Margin::symmetric(8, 4));
        frame.show(ui, |ui| ui.label(RichText::new(words).small().color(theme::TEXT)));
    });
}

/// Says over the picture why it is not that of the text.
pub fn band(ui: &mut Ui, rect: Rect, session: &Session, commands: &mut Vec<Command>) {
    let error = session.error();
    let Some(words) = wrong(session) else { return };
    let builder = UiBuilder::new().max_rect(rect.shrink(10.0)).sense(Sense::hover());
    ui.scope_builder(builder, |ui| {
        let frame = Frame::new()
            .fill(theme::WRONG.gamma_multiply(0.91))
            .stroke(egui::Stroke::new(1.0, theme::ERROR.gamma_multiply(0.6)))
            .corner_radius(CornerRadius::same(5))
            .inner_margin(Margin::symmetric(10, 7));
        let inner = frame.show(ui, |ui| {
            ui.set_min_width(ui.available_width());
            ui.horizontal_wrapped(|ui| {
                ui.spacing_mut().item_spacing.x = 6.0;
                icons::sign(ui, Icon::Error, *theme::ERROR);
                if let Some(problem) = error {
                    let (line, column) = problem.place.start;
                    let at = format!("{}:{line}:{column}", problem.place.file);
                    ui.label(RichText::new(at).monospace().small().color(theme::WEAK));
                }
                // What a device says can be a page long; the list of problems has all of it.
                let first: String = words.lines().take(3).collect::<Vec<_>>().join("\n");
                ui.label(RichText::new(first).color(theme::STRONG));
            });
            if let Some(help) = error.map(|e| &e.help).filter(|help| !help.is_empty()) {
                ui.label(RichText::new(help).small().color(theme::TEXT));
            }
            if session.stage.picture().is_some() {
                let words = "the picture is that of the last text without errors";
                ui.label(RichText::new(words).small().color(theme::WEAK));
            }
        });
        if let Some(problem) = error {
            let response = inner.response.interact(Sense::click());
            icons::name(ui, response.id, "Go to the error");
            if response.on_hover_cursor(egui::CursorIcon::PointingHand).clicked() {
                commands.push(Command::Jump(problem.place.clone()));
            }
        }
    });
}
