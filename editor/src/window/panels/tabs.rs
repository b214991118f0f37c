//! The texts that are open, one tab for each, and what can be done with the one that is shown.

use crate::window::command::Command;
use crate::window::document::Document;
use crate::window::panels::icons::{self, Icon};
use crate::window::session::Session;
use crate::window::theme;
use egui::scroll_area::ScrollBarVisibility;
use egui::{Align, Button, Layout, Role, ScrollArea, Ui, WidgetInfo};

/// No tab is wider, in points.
const WIDEST: f32 = 170.0;

/// Shows the tabs.
pub fn show(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let document = session.documents.current();
    ui.horizontal(|ui| {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let save = ui.add_enabled(document.can_save(), Button::new("Save"));
            if save.on_hover_text("Ctrl+S").clicked() {
                commands.extend([Command::Save, Command::Focus]);
            }
            let format = ui.add_enabled(document.is_editable(), Button::new("Lay out"));
            if format.on_hover_text("what `surefoot fmt` does (Ctrl+Shift+I)").clicked() {
                commands.extend([Command::Format, Command::Focus]);
            }
            others(ui, session, commands);
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                let most = WIDEST.min(ui.available_width() - 24.0).max(40.0);
                let tabs = ScrollArea::horizontal().id_salt("tabs").scroll_bar_visibility(ScrollBarVisibility::AlwaysHidden);
                tabs.show(ui, |ui| {
                    ui.horizontal_centered(|ui| {
                        ui.spacing_mut().item_spacing.x = 2.0;
                        for (index, document) in session.documents.all.iter().enumerate() {
                            ui.push_id(&document.name, |ui| tab(ui, session, index, document, most, commands));
                        }
                    });
                });
            });
        });
    });
}

fn tab(ui: &mut Ui, session: &Session, index: usize, document: &Document, most: f32, commands: &mut Vec<Command>) {
    let chosen = index == session.documents.shown;
    let name = document.short_name();
    let (mark, said) = match document {
        d if d.has_conflict() => (Some((Icon::Warning, *theme::WARNING)), ", changed by another program"),
        d if d.is_unsaved() => (Some((Icon::Dot, *theme::ACCENT)), ", not saved"),
        _ => (None, ""),
    };
    if let Some((icon, color)) = mark {
        icons::sign(ui, icon, color).on_hover_text(said.trim_start_matches(", "));
    }
    let tab = ui.scope(|ui| {
        ui.set_max_width(most);
        ui.add(Button::selectable(chosen, name).truncate())
    });
    let tab = tab.inner.on_hover_text(format!("{}\n(Ctrl+Tab shows the next)", document.name));
    tab.widget_info(|| WidgetInfo::selected(Role::Tab, true, chosen, format!("{name}{said}")));
    if chosen && session.documents.focus {
        tab.scroll_to_me(None);
    }
    if tab.clicked() {
        commands.extend([Command::Show(document.name.clone()), Command::Focus]);
    }
    // The scene's own text stays.
    if index == 0 {
        return;
    }
    let close = icons::small(ui, Icon::Close, &format!("Close {name}"));
    if close.on_hover_text("Ctrl+W, or the middle button").clicked() || tab.middle_clicked() {
        commands.push(Command::CloseText(document.name.clone()));
    }
}

/// The scene's other texts.
fn others(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let others: Vec<String> = session.names().into_iter().filter(|name| session.documents.find(name).is_none()).collect();
    if others.is_empty() {
        return;
    }
    let menu = ui.menu_button("Parts", |ui| {
        for name in others {
            if ui.button(&name).clicked() {
                commands.extend([Command::Show(name), Command::Focus]);
            }
        }
    });
    menu.response.on_hover_text("files that this scene is made of");
}
