//! All keys, on a page of their own: F1.

use crate::window::command::Command;
use crate::window::keys::KEYS;
use crate::window::session::Session;
use crate::window::theme;
use egui::{Grid, Id, Key, Modal, Modifiers, RichText, ScrollArea, Ui};

/// Shows the page, where it is open.
pub fn show(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    if !session.open.keys {
        return;
    }
    let modal = Modal::new(Id::unique("keys")).show(ui.ctx(), |ui| {
        ui.set_width(560.0);
        ui.heading("Keys");
        ScrollArea::vertical().max_height(ui.ctx().content_rect().height() - 140.0).auto_shrink([false, true]).show(ui, |ui| {
            for (part, keys) in KEYS {
                ui.add_space(8.0);
                ui.label(RichText::new(*part).color(theme::ACCENT));
                Grid::new(*part).num_columns(2).min_col_width(230.0).spacing([18.0, 3.0]).show(ui, |ui| {
                    for (key, what) in *keys {
                        ui.label(RichText::new(*key).strong());
                        ui.label(*what);
                        ui.end_row();
                    }
                });
            }
        });
        ui.add_space(8.0);
        ui.button("Close").clicked()
    });
    if modal.inner || modal.should_close() || ui.input_mut(|i| i.consume_key(Modifiers::NONE, Key::F1)) {
        commands.extend([Command::ShowKeys(false), Command::Focus]);
    }
}
