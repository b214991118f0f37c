//! The scene's parts as a tree: what each is, its factor, what it costs and how large it is; and which are hidden.

use crate::window::command::Command;
use crate::window::panels::icons::{self, Icon};
use crate::window::parts::Found;
use crate::window::session::{Place, Session};
use crate::window::theme;
use egui::{Align, Align2, Area, Button, CornerRadius, Frame, Id, Layout, Link, Margin, Order, Rect, RichText, ScrollArea, Ui, vec2};
use std::collections::BTreeSet;
use surefoot_compiler::language_service::{Part, Shown};

/// How high a row is.
const HIGH: f32 = 19.0;
/// Parts so deep are open at first.
const OPEN: usize = 3;

/// Shows the panel.
pub fn show(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    ui.take_available_width();
    ui.set_min_height(ui.available_height());
    let (found, shown) = (session.parts.found(), session.parts.shown());
    ui.horizontal(|ui| {
        ui.label(RichText::new("Outline").strong());
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if ui.add_enabled(!shown.is_all(), Button::new("Show all").small()).on_hover_text("all parts of the scene again").clicked() {
                commands.push(Command::ShowAllParts);
            }
        });
    });
    if let Some(why) = &found.refused {
        ui.label(RichText::new(format!("All is shown: {why}.")).small().color(theme::WARNING));
    }
    let Some(root) = &found.root else {
        ui.label(RichText::new("There is no scene without errors yet.").color(theme::WEAK));
        return;
    };
    let id = ui.scope_id().with("turned over");
    // Those that a hand has opened or closed, against what they are at first.
    let mut turned: BTreeSet<String> = ui.data(|data| data.get_temp(id)).unwrap_or_default();
    let rows = rows(root, &turned);
    ScrollArea::both().auto_shrink([false, false]).show_rows(ui, HIGH, rows.len(), |ui, range| {
        for (depth, part, is_open) in rows.get(range).unwrap_or_default() {
            ui.horizontal(|ui| row(ui, (*depth, part, *is_open), &shown, &mut turned, commands));
        }
    });
    ui.data_mut(|data| data.insert_temp(id, turned));
}

/// What is seen of the tree: each row with its depth, and whether it is open.
fn rows<'a>(root: &'a Part, turned: &BTreeSet<String>) -> Vec<(usize, &'a Part, bool)> {
    let mut rows = Vec::new();
    let mut stack = vec![(0, root)];
    while let Some((depth, part)) = stack.pop() {
        let is_open = (depth < OPEN) != turned.contains(&part.id);
        rows.push((depth, part, is_open));
        if is_open {
            stack.extend(part.within.iter().rev().map(|inner| (depth + 1, inner)));
        }
    }
    rows
}

fn row(ui: &mut Ui, (depth, part, is_open): (usize, &Part, bool), shown: &Shown, turned: &mut BTreeSet<String>, commands: &mut Vec<Command>) {
    ui.spacing_mut().item_spacing.x = 4.0;
    ui.set_height(HIGH - 3.0);
    ui.add_space(12.0 * depth as f32);
    if part.within.is_empty() {
        ui.add_space(20.0);
    } else {
        let (sign, word) = if is_open { ("−", "Close") } else { ("+", "Open") };
        let button = ui.add(Button::new(sign).small().frame(false).min_size(vec2(16.0, 14.0)));
        icons::name(ui, button.id, &format!("{word} {}", part.name));
        if button.clicked() && !turned.remove(&part.id) {
            turned.insert(part.id.clone());
        }
    }
    let is_hidden = shown.hidden.contains(&part.id);
    let is_solo = shown.solo.as_ref() == Some(&part.id);
    if depth > 0 {
        let mut is_shown = !is_hidden;
        let response = ui.checkbox(&mut is_shown, "");
        icons::name(ui, response.id, &format!("Show {}", part.name));
        if response.on_hover_text("whether the picture has it; the file stays as it is").changed() {
            commands.push(Command::Hide(part.id.clone(), !is_shown));
        }
        let response = ui.selectable_label(is_solo, RichText::new("solo").small());
        icons::name(ui, response.id, &format!("Solo {}", part.name));
        if response.on_hover_text("show it alone, or all again").clicked() {
            commands.push(Command::Solo((!is_solo).then(|| part.id.clone())));
        }
    }
    let name = if part.cuts { format!("− {}", part.name) } else { part.name.clone() };
    let color = if is_hidden { theme::WEAK } else { theme::TEXT };
    if ui.add(Link::new(RichText::new(name).color(color))).on_hover_text(format!("line {} of {}", part.at.0, part.file)).clicked() {
        commands.push(Command::Jump(Place { file: part.file.clone(), start: part.at, end: part.at }));
    }
    let weak = |ui: &mut Ui, words: String, hover: &str| drop(ui.label(RichText::new(words).small().color(theme::WEAK)).on_hover_text(hover));
    if let Some(factor) = part.factor {
        let words = RichText::new(format!("×{factor:.2}")).small().color(theme::ACCENT);
        ui.label(words).on_hover_text("its largest factor: by how much rays step shorter there");
    }
    if let Some(operations) = part.operations {
        weak(ui, format!("{operations} op"), "operations of its formula");
    }
    if let Some([low, high]) = part.region {
        let sides = [0, 1, 2].map(|i| format!("{:.2}", high[i] - low[i])).join(" × ");
        let corner = |at: [f64; 3]| at.map(|c| format!("{c:.3}")).join(", ");
        weak(ui, sides, &format!("a box that holds it, in its own space: from ({}) to ({})", corner(low), corner(high)));
    }
    if !part.kind.is_empty() {
        weak(ui, part.kind.trim().to_owned(), "what it is, and what is done to it");
    }
}

/// Says over the picture that it is without some parts.
pub fn badge(ui: &Ui, rect: Rect, session: &Session, commands: &mut Vec<Command>) {
    let (shown, Found { left_out, .. }) = (session.parts.shown(), session.parts.found());
    if left_out == 0 {
        return;
    }
    let area = Area::new(Id::unique("hidden parts")).pivot(Align2::RIGHT_TOP).fixed_pos(rect.right_top() + vec2(-10.0, 10.0)).constrain_to(rect).order(Order::Middle);
    area.show(ui.ctx(), |ui| {
        let frame = Frame::new().fill(theme::ASKS.gamma_multiply(0.94)).corner_radius(CornerRadius::same(5)).inner_margin(Margin::symmetric(9, 5));
        frame.show(ui, |ui| {
            ui.horizontal(|ui| {
                icons::sign(ui, Icon::Warning, *theme::WARNING);
                let words = match &shown.solo {
                    Some(solo) => format!("only {}", solo.rsplit('/').next().unwrap_or(solo)),
                    None if left_out == 1 => "1 part is hidden".to_owned(),
                    None => format!("{left_out} parts are hidden"),
                };
                ui.label(RichText::new(words).small().color(theme::STRONG));
                let button = ui.add(Button::new("Show").small());
                icons::name(ui, button.id, "Show the hidden parts");
                if button.clicked() {
                    commands.push(Command::ShowAllParts);
                }
            });
        });
    });
}
