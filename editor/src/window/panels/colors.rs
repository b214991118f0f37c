//! Colours of the text: a small square before each, and a click on it (or Ctrl+K at the cursor) opens a picker.

use crate::window::command::Command;
use crate::window::document::Document;
use crate::window::panels::cursor::{byte, caret, id};
use crate::window::panels::{history, icons};
use crate::window::theme;
use egui::cache::{ComputerMut, FrameCache};
use egui::ecolor::Hsva;
use egui::text::{CCursor, CCursorRange};
use egui::text_edit::{TextEditOutput, TextEditState};
use egui::{Area, Color32, CursorIcon, Frame, Id, Key, Mesh, Modifiers, Order, Rect, Role, Sense, Slider, SliderClamping, Stroke, StrokeKind, TextEdit, Ui, WidgetInfo, pos2, vec2};
use std::ops::Range;
use surefoot_compiler::language_service::{colors, written_color};
use surefoot_compiler::source::FileId;

/// The room that a text leaves before a colour, in points.
pub const ROOM: f32 = 13.0;

/// The colours of a text. egui keeps them as long as it is the same.
#[derive(Default)]
struct Found;

impl ComputerMut<&str, Vec<(Range<usize>, Color32)>> for Found {
    fn compute(&mut self, text: &str) -> Vec<(Range<usize>, Color32)> {
        colors(text, FileId(0)).iter().map(|color| (color.span.range(), shown(color.rgb))).collect()
    }
}

fn shown(rgb: [f64; 3]) -> Color32 {
    let [r, g, b] = rgb.map(|c| (c * 255.0).round() as u8);
    Color32::from_rgb(r, g, b)
}

/// A colour that is being picked.
#[derive(Clone, Debug)]
struct Picked {
    /// The byte where it stands.
    start: usize,
    /// What stands there by now.
    written: String,
    /// What a person types.
    typed: String,
    /// Hue, saturation and brightness: grey has no hue of its own.
    hsv: [f32; 3],
    /// For how many frames.
    age: u32,
}

/// Opens the picker for the colour at the cursor, where the key says so. Before the text sees the keys.
pub fn keys(ui: &Ui, document: &Document) {
    let is_asked = document.is_editable() && ui.memory(|m| m.has_focus(id(document))) && ui.input_mut(|i| i.consume_key(Modifiers::COMMAND, Key::K));
    let Some(at) = caret(ui, document).filter(|_| is_asked).map(|at| byte(&document.text, at)) else { return };
    if let Some(color) = colors(&document.text, FileId(0)).iter().find(|color| color.span.range().start <= at && at <= color.span.range().end) {
        open(ui, document, color.span.range());
    }
}

/// Hue, saturation and brightness of a colour as it is written.
fn hsv(written: &str) -> Option<[f32; 3]> {
    let found = colors(written, FileId(0));
    let color = found.first().filter(|color| color.span.range() == (0..written.len()))?;
    let Hsva { h, s, v, .. } = Hsva::from_srgb(shown(color.rgb).to_array().first_chunk().copied()?);
    Some([h, s, v])
}

fn color([h, s, v]: [f32; 3]) -> [u8; 3] {
    Hsva::new(h, s, v, 1.0).to_srgb()
}

fn slot(document: &Document) -> Id {
    Id::unique(("picked colour", &document.name))
}

fn open(ui: &Ui, document: &Document, range: Range<usize>) {
    let written = document.text.get(range.clone()).unwrap_or_default().to_owned();
    history::hold(ui, document);
    ui.data_mut(|data| data.insert_temp(slot(document), Picked { start: range.start, hsv: hsv(&written).unwrap_or_default(), typed: written.clone(), written, age: 0 }));
}

/// Shows the squares, and the picker where it is open. After the text was shown.
pub fn show(ui: &mut Ui, document: &Document, output: &TextEditOutput, commands: &mut Vec<Command>) {
    let found = ui.memory_mut(|m| m.caches.cache::<FrameCache<Vec<(Range<usize>, Color32)>, Found>>().get(document.text.as_str()).clone());
    let place = |byte: usize| {
        let character = document.text.get(..byte).unwrap_or_default().chars().count();
        output.galley.pos_from_cursor(CCursor::new(character)).translate(output.galley_pos.to_vec2())
    };
    for (index, (range, color)) in found.into_iter().enumerate() {
        let at = place(range.start);
        let square = Rect::from_min_size(pos2(at.min.x - ROOM + 1.0, at.center().y - 5.0), vec2(10.0, 10.0));
        if !ui.is_rect_visible(square) {
            continue;
        }
        ui.painter().rect(square, 2.0, color, Stroke::new(1.0, *theme::WEAK), StrokeKind::Inside);
        if document.is_editable() {
            let response = ui.interact(square.intersect(ui.clip_rect()), slot(document).with(index), Sense::click()).on_hover_cursor(CursorIcon::PointingHand);
            response.widget_info(|| WidgetInfo::labeled(Role::ColorWell, true, format!("Colour {}", document.text.get(range.clone()).unwrap_or_default())));
            if response.clicked() {
                open(ui, document, range);
            }
        }
    }
    pick(ui, document, place, commands);
}

fn pick(ui: &mut Ui, document: &Document, place: impl Fn(usize) -> Rect, commands: &mut Vec<Command>) {
    let Some(mut picked) = ui.data(|data| data.get_temp::<Picked>(slot(document))) else { return };
    let range = picked.start..picked.start + picked.written.len();
    if document.text.get(range.clone()) != Some(picked.written.as_str()) {
        history::release(ui, document);
        ui.data_mut(|data| data.remove::<Picked>(slot(document)));
        return;
    }
    let corner = place(picked.start);
    let area = Area::new(slot(document).with("picker")).order(Order::Foreground).fixed_pos(pos2(corner.min.x, corner.max.y + 3.0)).constrain(true);
    let field = slot(document).with("typed");
    let mut new = None;
    let response = area.show(ui.ctx(), |ui| {
        Frame::popup(ui.style()).show(ui, |ui| {
            ui.set_max_width(260.0);
            let typed = ui.add(TextEdit::singleline(&mut picked.typed).id(field).font(theme::code_font(13.0)).desired_width(90.0));
            icons::name(ui, field, "Colour");
            if picked.age == 0 {
                typed.request_focus();
                let mut state = TextEditState::load(ui.ctx(), field).unwrap_or_default();
                state.cursor.set_char_range(Some(CCursorRange::two(CCursor::new(0), CCursor::new(picked.typed.chars().count()))));
                state.store(ui.ctx(), field);
            }
            if typed.changed()
                && let Some(read) = hsv(&picked.typed)
            {
                picked.hsv = read;
                new = Some(picked.typed.clone());
            }
            let before = picked.hsv;
            square(ui, &mut picked.hsv);
            for (part, name) in picked.hsv.iter_mut().zip(["Hue", "Saturation", "Brightness"]) {
                // A slider rounds what it shows.
                let mut shown = *part;
                if ui.add(Slider::new(&mut shown, 0.0..=1.0).text(name).fixed_decimals(2).clamping(SliderClamping::Edits)).changed() {
                    *part = shown;
                }
            }
            if picked.hsv != before {
                picked.typed = written_color(color(picked.hsv).map(|c| f64::from(c) / 255.0));
                new = Some(picked.typed.clone());
            }
        });
    });
    if let Some(new) = new.filter(|new| *new != picked.written) {
        let mut text = document.text.clone();
        text.replace_range(range, &new);
        picked.written = new;
        commands.push(Command::EditOn(text));
    }
    let is_left = picked.age > 1 && response.response.clicked_elsewhere();
    if is_left || ui.input(|i| i.key_pressed(Key::Escape) || i.key_pressed(Key::Enter)) {
        history::release(ui, document);
        ui.data_mut(|data| data.remove::<Picked>(slot(document)));
        commands.push(Command::Focus);
        return;
    }
    picked.age += 1;
    ui.data_mut(|data| data.insert_temp(slot(document), picked));
}

/// The colours of one hue, more saturated to the right and brighter to the top; a hand goes to the one that is meant.
fn square(ui: &mut Ui, hsv: &mut [f32; 3]) {
    const CELLS: u32 = 12;
    let (rect, _) = ui.allocate_exact_size(vec2(220.0, 120.0), Sense::hover());
    let response = ui.interact(rect, ui.scope_id().with("square"), Sense::DRAG | Sense::CLICK);
    let mut mesh = Mesh::default();
    for (row, column) in (0..=CELLS).flat_map(|row| (0..=CELLS).map(move |column| (row, column))) {
        let at = vec2(column as f32, row as f32) / CELLS as f32;
        let [r, g, b] = color([hsv[0], at.x, 1.0 - at.y]);
        mesh.colored_vertex(rect.lerp_inside(at), Color32::from_rgb(r, g, b));
        if row < CELLS && column < CELLS {
            let corner = row * (CELLS + 1) + column;
            mesh.add_triangle(corner, corner + 1, corner + CELLS + 1);
            mesh.add_triangle(corner + 1, corner + CELLS + 1, corner + CELLS + 2);
        }
    }
    ui.painter().add(mesh);
    let at = rect.lerp_inside(vec2(hsv[1], 1.0 - hsv[2]));
    ui.painter().circle_stroke(at, 5.0, Stroke::new(2.0, Color32::WHITE));
    ui.painter().circle_stroke(at, 6.5, Stroke::new(1.0, Color32::BLACK));
    if let Some(at) = response.interact_pointer_pos() {
        let part = ((at - rect.min) / rect.size()).clamp(egui::Vec2::ZERO, egui::Vec2::splat(1.0));
        (hsv[1], hsv[2]) = (part.x, 1.0 - part.y);
    }
}
