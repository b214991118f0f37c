//! The bar at the top: the file, what the picture shows, and time.

use crate::window::command::Command;
use crate::window::panels::icons::{self, Icon};
use crate::window::panels::menus;
use crate::window::panels::modes::{MODES, MORE};
use crate::window::session::Session;
use egui::scroll_area::ScrollBarVisibility;
use egui::{Align, Layout, ScrollArea, Ui};
use surefoot_runtime::ViewMode;

/// Narrower than this the views become a list.
const NARROW: f32 = 820.0;

/// Shows the bar. What has no room in a narrow window is scrolled to.
pub fn show(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let narrow = ui.available_width() < NARROW;
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        if !session.open.start && ui.selectable_label(session.open.parameters, "Parameters").on_hover_text("the scene's parameters").clicked() {
            commands.push(Command::ShowParameters(!session.open.parameters));
        }
        if !session.open.start && ui.selectable_label(session.open.measures, "Measures").on_hover_text("box, volume, area and pieces of the solid").clicked() {
            commands.push(Command::ShowMeasures(!session.open.measures));
        }
        if ui.selectable_label(session.open.keys, "Keys").on_hover_text("all keys (F1)").clicked() {
            commands.push(Command::ShowKeys(true));
        }
        menus::look(ui, session, commands);
        ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
            let hidden = ScrollBarVisibility::AlwaysHidden;
            ScrollArea::horizontal().scroll_bar_visibility(hidden).show(ui, |ui| ui.horizontal_centered(|ui| left(ui, session, narrow, commands)));
        });
    });
}

fn left(ui: &mut Ui, session: &Session, narrow: bool, commands: &mut Vec<Command>) {
    menus::files(ui, session, commands);
    if session.open.start {
        return;
    }
    if ui
        .selectable_label(session.open.source, "Source")
        .on_hover_text("the text and what the compiler says of it")
        .clicked()
    {
        commands.push(Command::ShowSource(!session.open.source));
    }
    ui.separator();
    modes(ui, session, narrow, commands);
    ui.separator();
    cameras(ui, session, commands);
    time(ui, session, commands);
    super::balls::show(ui, session, commands);
    ui.separator();
    looks(ui, session, commands);
}

fn modes(ui: &mut Ui, session: &Session, narrow: bool, commands: &mut Vec<Command>) {
    if narrow {
        let shown = MODES.iter().chain(&MORE).find(|(mode, ..)| *mode == session.look.mode).map_or("", |(_, name, _)| name);
        let list = egui::ComboBox::from_id_salt("view").selected_text(shown).width(80.0);
        let list = list.show_ui(ui, |ui| {
            choices(ui, session, &MODES, commands);
            choices(ui, session, &MORE, commands);
        });
        icons::name(ui, list.response.id, "View");
        return;
    }
    ui.spacing_mut().item_spacing.x = 2.0;
    choices(ui, session, &MODES, commands);
    let shown = MORE.iter().find(|(mode, ..)| *mode == session.look.mode).map_or("More", |(_, name, _)| name);
    let list = egui::ComboBox::from_id_salt("more views").selected_text(shown).width(72.0);
    let list = list.show_ui(ui, |ui| choices(ui, session, &MORE, commands));
    icons::name(ui, list.response.id, "More views");
    ui.spacing_mut().item_spacing.x = 8.0;
}

/// Ways of looking that go with any view. The menu has them too, where there is no room for them here.
fn looks(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    if ui.selectable_label(session.look.cuts, "Section").on_hover_text("cut the picture open by a plane (C)").clicked() {
        commands.push(Command::ShowSection(!session.look.cuts));
    }
    if ui.selectable_label(session.truth.open, "Difference").on_hover_text("how far the picture is from what is certain of it (D)").clicked() {
        commands.push(Command::ShowTruth(!session.truth.open));
    }
    if ui.selectable_label(session.look.beside.is_some(), "Two views").on_hover_text("another view beside this one, and a divider between them (W)").clicked() {
        commands.push(super::wipe::switch(session));
    }
}

fn choices(ui: &mut Ui, session: &Session, modes: &[(ViewMode, &str, &str)], commands: &mut Vec<Command>) {
    for (mode, name, hover) in modes {
        let chosen = session.look.mode == *mode;
        if ui.selectable_label(chosen, *name).on_hover_text(*hover).clicked() && !chosen {
            commands.push(Command::Mode(*mode));
        }
    }
}

fn cameras(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let moved = session.look.orbit.is_some();
    if icons::button(ui, Icon::Home, "Home", moved)
        .on_hover_text("back to the scene's camera (Home, or a double click on the picture)")
        .clicked()
    {
        commands.push(Command::Home);
    }
    let keep = ui.add_enabled(moved, egui::Button::new("Keep view").small());
    if keep.on_hover_text("write where the camera stands into the text").clicked() {
        commands.push(Command::KeepView);
    }
    let Some((scene, live)) = session.scene().zip(session.stage.live()) else { return };
    let cameras = scene.frame(live).cameras;
    if cameras.len() < 2 {
        return;
    }
    let first = cameras.first().map(|(name, _)| name.as_str()).unwrap_or_default();
    let chosen = session.look.camera.as_deref().filter(|name| cameras.iter().any(|(known, _)| known == name));
    let current = chosen.unwrap_or(first);
    let list = egui::ComboBox::from_id_salt("camera").selected_text(current).width(90.0);
    let list = list.show_ui(ui, |ui| {
        for (name, _) in &cameras {
            if ui.selectable_label(name == current, name).clicked() {
                commands.push(Command::Camera(name.clone()));
            }
        }
    });
    icons::name(ui, list.response.id, "Camera");
}

fn time(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let stage = &session.stage;
    if !session.moves() {
        return;
    }
    ui.separator();
    let rewind = icons::button(ui, Icon::Rewind, "Rewind", true);
    if rewind.on_hover_text("back to second 0").clicked() {
        commands.push(Command::Time(0.0));
    }
    let (icon, name, hover) = match stage.playing {
        true => (Icon::Pause, "Pause", "let time stand (space)"),
        false => (Icon::Play, "Play", "let time run (space)"),
    };
    if icons::button(ui, icon, name, true).on_hover_text(hover).clicked() {
        commands.push(Command::Play(!stage.playing));
    }
    let mut seconds = stage.time();
    let value = egui::DragValue::new(&mut seconds).speed(0.02).fixed_decimals(2).suffix(" s");
    if ui.add(value).on_hover_text("the scene's `time`: drag, or click to type").changed() {
        commands.push(Command::Time(seconds));
    }
}
