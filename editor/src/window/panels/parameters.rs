//! The scene's parameters: a slider for a number, a tick for a condition, a list for a choice. A double click gives back the text's value.

use crate::window::command::Command;
use crate::window::holding::is_held;
use crate::window::session::Session;
use crate::window::theme;
use egui::{ComboBox, Id, Response, RichText, ScrollArea, Sense, Slider, SliderClamping, Ui};
use surefoot_compiler::compiled::{Compiled, Parameter};
use surefoot_compiler::syntax::ast::Type;

/// Shows the panel.
pub fn show(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    // A panel is as wide as what is in it; this one shall not jump while there is nothing yet.
    ui.take_available_width();
    let Some(scene) = session.scene() else { return };
    ui.horizontal(|ui| {
        ui.label(RichText::new("Parameters").strong());
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let moved = scene.parameters.iter().any(|p| session.is_moved(p));
            let button = ui.add_enabled(moved, egui::Button::new("Reset").small());
            if button.on_hover_text("all values as the text gives them").clicked() {
                commands.push(Command::ResetAll);
            }
            let keep = ui.add_enabled(moved && !session.moved().is_empty(), egui::Button::new("Keep").small());
            if keep.on_hover_text("write these values into the text").clicked() {
                commands.push(Command::KeepValues);
            }
        });
    });
    ui.add_space(2.0);
    ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        let mut to_first = session.open.to_sliders;
        if scene.parameters.iter().all(is_held) {
            let words = "None. Write one:\n\nparam size = 1 in 0.1..2";
            ui.label(RichText::new(words).color(theme::WEAK));
        }
        for (group, parameters) in groups(scene) {
            if !group.is_empty() {
                ui.add_space(6.0);
                ui.label(RichText::new(group).color(theme::WEAK).small());
            }
            for parameter in parameters {
                ui.push_id(&parameter.name, |ui| row(ui, session, parameter, &mut to_first, commands));
            }
        }
    });
}

/// The file's own parameters, then those of each import under its name.
fn groups(scene: &Compiled) -> Vec<(&str, Vec<&Parameter>)> {
    let mut groups: Vec<(&str, Vec<&Parameter>)> = Vec::new();
    for parameter in scene.parameters.iter().filter(|p| !is_held(p)) {
        let group = parameter.name.rsplit_once('.').map_or("", |(group, _)| group);
        match groups.iter_mut().find(|(known, _)| *known == group) {
            Some((_, members)) => members.push(parameter),
            None => groups.push((group, vec![parameter])),
        }
    }
    groups
}

fn row(ui: &mut Ui, session: &Session, parameter: &Parameter, to_first: &mut bool, commands: &mut Vec<Command>) {
    let short = parameter.name.rsplit('.').next().unwrap_or(&parameter.name);
    let moved = session.is_moved(parameter);
    let label = ui.horizontal(|ui| {
        let color = if moved { *theme::ACCENT } else { *theme::TEXT };
        let label = egui::Label::new(RichText::new(short.replace('_', " ")).color(color))
            .selectable(false)
            .truncate()
            .sense(Sense::CLICK);
        let label = ui.add(label).on_hover_text(hover(parameter, moved));
        if label.double_clicked() {
            commands.push(Command::Reset(parameter.name.clone()));
        }
        // What takes little room stands in the label's line.
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            compact(ui, session, parameter, label.id, commands);
        });
        label.id
    });
    if let Some(value) = session.stage.value(parameter) {
        sliders(ui, parameter, label.inner, value.to_vec(), to_first, commands);
    }
    ui.add_space(6.0);
}

/// A slider for each component of a number or vector.
fn sliders(
    ui: &mut Ui,
    parameter: &Parameter,
    label: Id,
    mut value: Vec<f64>,
    to_first: &mut bool,
    commands: &mut Vec<Command>,
) {
    let names: &[&str] = match parameter.ty {
        Type::Int | Type::Float => &[""],
        Type::Vec(_) => &["x", "y", "z", "w"],
        _ => return,
    };
    let mut changed = false;
    for (i, (component, name)) in value.iter_mut().zip(names).enumerate() {
        let range = (parameter.min.get(i).copied(), parameter.max.get(i).copied());
        let (Some(min), Some(max)) = range else { continue };
        ui.horizontal(|ui| {
            if !name.is_empty() {
                ui.label(RichText::new(*name).color(theme::WEAK).small());
            }
            let response = slider(ui, parameter, i, component, (min, max)).labelled_by(label);
            if std::mem::take(to_first) {
                response.request_focus();
                commands.push(Command::ToSliders(false));
            }
            changed |= response.changed();
            if double_clicked(ui, &response, i)
                && let Some(&default) = parameter.default.get(i)
            {
                *component = default;
                changed = true;
            }
        });
    }
    if changed {
        commands.push(Command::Set(parameter.name.clone(), value));
    }
}

/// A tick, a colour or a list, at the end of the label's line.
fn compact(
    ui: &mut Ui,
    session: &Session,
    parameter: &Parameter,
    label: Id,
    commands: &mut Vec<Command>,
) {
    if !parameter.choices.is_empty() {
        let chosen = session.choice(parameter).unwrap_or_default();
        let list = ComboBox::from_id_salt("choice").selected_text(chosen).width(110.0);
        let list = list.show_ui(ui, |ui| {
            for choice in &parameter.choices {
                if ui.selectable_label(choice == chosen, choice).clicked() && choice != chosen {
                    commands.push(Command::Choose(parameter.name.clone(), choice.clone()));
                }
            }
        });
        list.response.labelled_by(label);
        return;
    }
    let Some(value) = session.stage.value(parameter) else { return };
    match (&parameter.ty, value) {
        (Type::Bool, [on]) => {
            let mut on = *on != 0.0;
            if ui.checkbox(&mut on, "").labelled_by(label).changed() {
                let value = vec![f64::from(u8::from(on))];
                commands.push(Command::Set(parameter.name.clone(), value));
            }
        }
        (Type::Color, [r, g, b]) => {
            // egui's colours of numbers are linear, as the scene's are.
            let mut color = [*r as f32, *g as f32, *b as f32];
            let before = [*r, *g, *b];
            let changed = ui.color_edit_button_rgb(&mut color).labelled_by(label).changed();
            let value = color.map(f64::from);
            // egui turns it into another form and back, which loses digits.
            if changed && value.iter().zip(before).any(|(new, old)| (new - old).abs() > 1e-3) {
                let value = value.to_vec();
                commands.push(Command::Set(parameter.name.clone(), value));
            }
        }
        _ => {}
    }
}

fn slider(
    ui: &mut Ui,
    parameter: &Parameter,
    index: usize,
    component: &mut f64,
    (min, max): (f64, f64),
) -> Response {
    // Angles are radians inside and degrees outside; lengths have the unit that the text writes.
    let scale = parameter.unit();
    let mut shown = *component / scale;
    let decimals = parameter.decimals(index);
    let text = |value: f64| parameter.digits(index, value);
    // As wide as the longest number, so that nothing moves.
    let longest = [min / scale, max / scale, shown].map(|value| text(value).len()).into_iter().fold(decimals + 3, usize::max);
    let digit = ui.fonts_mut(|f| f.glyph_width(&egui::TextStyle::Button.resolve(ui.style()), '0'));
    let value_width = ((longest + suffix(parameter).len()) as f32 + 2.0).mul_add(digit, 2.0 * ui.spacing().button_padding.x).max(62.0);
    ui.spacing_mut().slider_width = (ui.available_width() - value_width - 10.0).max(40.0);
    ui.spacing_mut().interact_size.x = value_width;
    let mut slider = Slider::new(&mut shown, min / scale..=max / scale)
        // What the text says is not rounded by being shown.
        .clamping(SliderClamping::Edits)
        .smart_aim(true)
        .custom_formatter(|value, _| text(value))
        .custom_parser(|text| parameter.read(text))
        .suffix(suffix(parameter));
    if parameter.ty == Type::Int {
        slider = slider.integer();
    }
    let response = ui.add(slider);
    if response.changed() {
        *component = (shown * scale).clamp(min, max);
    }
    response
}

/// Whether the rail was clicked twice. The slider itself only hears of dragging.
fn double_clicked(ui: &Ui, response: &Response, component: usize) -> bool {
    let mut rail = response.rect;
    rail.set_width(ui.spacing().slider_width);
    let id: Id = ui.scope_id().with(("twice", component));
    ui.interact(rail, id, Sense::CLICK).double_clicked()
}

/// What stands after a number: a sign for degrees, and a unit of length.
fn suffix(parameter: &Parameter) -> &'static str {
    if parameter.degrees { "°" } else { parameter.suffix() }
}

fn hover(parameter: &Parameter, moved: bool) -> String {
    let mut lines: Vec<String> = Vec::new();
    lines.extend(parameter.description.clone());
    let number = |value: f64| {
        let value = value / parameter.unit();
        format!("{}{}", (value * 1e4).round() / 1e4, suffix(parameter))
    };
    let vector = |values: &[f64]| match values {
        [one] => number(*one),
        many => format!("({})", many.iter().map(|v| number(*v)).collect::<Vec<_>>().join(", ")),
    };
    match parameter.ty {
        Type::Int | Type::Float | Type::Vec(_) => {
            let (min, max) = (vector(&parameter.min), vector(&parameter.max));
            lines.push(format!("{min} to {max}, in the text {}", vector(&parameter.default)));
        }
        _ => {}
    }
    if !parameter.choices.is_empty() {
        lines.push("another choice compiles the scene again".to_owned());
    }
    if moved {
        lines.push("double click: back to the text's value".to_owned());
    }
    lines.join("\n")
}
