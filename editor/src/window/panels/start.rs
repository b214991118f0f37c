//! The page that is shown where no scene is named: a new scene, recent ones, and examples as pictures.

use crate::window::command::Command;
use crate::window::examples::EXAMPLES;
use crate::window::session::{Purpose, Session};
use crate::window::theme;
use egui::{Align, Button, Image, ImageSource, Layout, Role, RichText, ScrollArea, Ui, WidgetInfo, vec2};
use std::path::Path;

/// How large an example's picture is shown, in points.
const PICTURE: egui::Vec2 = vec2(192.0, 108.0);

/// Shows the page.
pub fn show(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        ui.add_space(10.0);
        ui.label(RichText::new("Surefoot").size(24.0).color(theme::STRONG));
        ui.label(RichText::new("a language for signed distance fields").color(theme::WEAK));
        ui.add_space(10.0);
        ui.horizontal(|ui| {
            if ui.button("New scene").on_hover_text("Ctrl+N").clicked() {
                commands.push(Command::New);
            }
            if ui.button("Open…").on_hover_text("Ctrl+O").clicked() {
                commands.push(Command::AskPath(Some(Purpose::Open)));
            }
            ui.label(RichText::new("or drop a file on the window; F1 lists the keys").color(theme::WEAK));
        });
        recent(ui, session, commands);
        ui.add_space(14.0);
        ui.label(RichText::new("Examples").strong());
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = vec2(10.0, 10.0);
            for example in EXAMPLES {
                let source = ImageSource::Texture(egui::load::SizedTexture::new(texture(ui, example.name, example.picture), PICTURE));
                ui.allocate_ui_with_layout(PICTURE, Layout::top_down(Align::Min), |ui| {
                    let shown = ui.add(Button::image(Image::new(source).fit_to_exact_size(PICTURE).corner_radius(4)));
                    shown.widget_info(|| WidgetInfo::labeled(Role::Button, true, example.name));
                    if shown.on_hover_text(format!("{}: a copy of its text, to play with", example.name)).clicked() {
                        commands.push(Command::OpenExample(example));
                    }
                    ui.label(RichText::new(example.name.replace('_', " ")).small().color(theme::WEAK));
                });
            }
        });
        ui.add_space(20.0);
    });
}

fn recent(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let left: Vec<String> = session.found.iter().map(|found| found.path().to_string_lossy().into_owned()).collect();
    let rest = session.recent.iter().filter(|path| !left.contains(path));
    for (title, words, paths) in [("Unsaved", " (unsaved text was found)", left.iter().collect::<Vec<_>>()), ("Recent", "", rest.collect())] {
        if paths.is_empty() {
            continue;
        }
        ui.add_space(14.0);
        ui.label(RichText::new(title).strong());
        for path in paths.into_iter().take(10) {
            let file = Path::new(path);
            let name = file.file_name().unwrap_or_default().to_string_lossy();
            ui.horizontal(|ui| {
                if ui.button(format!("{name}{words}")).clicked() {
                    commands.push(Command::Open(path.clone()));
                }
                let folder = file.parent().map(|folder| folder.display().to_string()).unwrap_or_default();
                ui.label(RichText::new(folder).small().color(theme::WEAK));
            });
        }
    }
}

/// The picture of an example, read once.
fn texture(ui: &Ui, name: &str, picture: &[u8]) -> egui::TextureId {
    let id = egui::Id::unique(("example", name));
    if let Some(known) = ui.data(|data| data.get_temp::<egui::TextureHandle>(id)) {
        return known.id();
    }
    let image = image::load_from_memory(picture).map(|image| image.to_rgb8()).unwrap_or_default();
    let size = [image.width() as usize, image.height() as usize];
    let handle = ui.ctx().load_texture(name, egui::ColorImage::from_rgb(size, &image), egui::TextureOptions::LINEAR);
    let texture = handle.id();
    ui.data_mut(|data| data.insert_temp(id, handle));
    texture
}
