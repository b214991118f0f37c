//! The emitted module beside the source: its lines that compute what stands on the line of the cursor stand out.

use crate::window::panels::cursor::selection;
use crate::window::session::Session;
use crate::window::theme::{self, code};
use egui::text::{LayoutJob, TextFormat};
use egui::{Button, Color32, Label, RichText, Role, ScrollArea, Ui, WidgetInfo};
use std::collections::BTreeSet;
use std::sync::Arc;
use surefoot_compiler::compiled::Compiled;
use surefoot_compiler::source::Span;

/// Words of WGSL.
const WORDS: [&str; 19] = [
    "fn", "let", "var", "const", "struct", "return", "if", "else", "for", "loop", "while", "break", "continue", "switch", "case", "default", "override", "true", "false",
];

/// What stands out, and for which scene, text and line that is.
#[derive(Clone, Default)]
struct Marked {
    of: (u64, String, u32),
    lines: Arc<BTreeSet<u32>>,
    ends: Arc<Vec<usize>>,
}

/// Shows the panel.
pub fn show(ui: &mut Ui, session: &Session) {
    ui.take_available_width();
    let Some(scene) = session.scene() else {
        ui.label(RichText::new("There is no module yet.").color(theme::WEAK));
        return;
    };
    let (text, id) = (&scene.module.wgsl, ui.scope_id().with("marked"));
    let document = session.documents.current();
    let caret = selection(ui, document).start;
    let line = document.text.chars().take(caret).filter(|c| *c == '\n').count() as u32 + 1;
    let of = (session.said.swaps, document.name.clone(), line);
    let before: Marked = ui.data(|data| data.get_temp(id)).unwrap_or_default();
    let is_new = before.of != of;
    let marked = if is_new {
        let ends = std::iter::once(0).chain(text.match_indices('\n').map(|(at, _)| at + 1)).chain([text.len() + 1]).collect();
        let marked = Marked { of, lines: Arc::new(lines_of(session, scene, &document.name, line)), ends: Arc::new(ends) };
        ui.data_mut(|data| data.insert_temp(id, marked.clone()));
        marked
    } else {
        before
    };
    ui.horizontal(|ui| {
        ui.label(RichText::new("WGSL").strong());
        let words = match marked.lines.len() {
            0 => format!("nothing of line {line} alone"),
            1 => format!("1 line computes line {line}"),
            count => format!("{count} lines compute line {line}"),
        };
        ui.label(RichText::new(words).small().color(theme::WEAK));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if ui.add(Button::new("Copy").small()).on_hover_text("copy the module").clicked() {
                ui.ctx().copy_text(text.clone());
            }
        });
    });
    let font = theme::code_font((session.open.text_size - 1.0).max(6.0));
    let high = ui.fonts_mut(|fonts| fonts.row_height(&font));
    let spacing = ui.spacing().item_spacing.y;
    let mut area = ScrollArea::both().auto_shrink([false, false]);
    if let Some(first) = marked.lines.first().filter(|_| is_new) {
        area = area.vertical_scroll_offset((high + spacing) * (first.saturating_sub(4)) as f32);
    }
    let count = marked.ends.len().saturating_sub(1);
    egui::Frame::new().fill(*theme::WELL).show(ui, |ui| {
        area.show_rows(ui, high, count, |ui, range| {
            for row in range {
                let (Some(start), Some(end)) = (marked.ends.get(row), marked.ends.get(row + 1)) else { continue };
                let is_marked = marked.lines.contains(&(row as u32 + 1));
                let line = text.get(*start..end.saturating_sub(1)).unwrap_or_default();
                let response = ui.add(Label::new(colored(line, &font, if is_marked { *theme::CHOSEN } else { Color32::TRANSPARENT })).extend());
                if is_marked {
                    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, format!("Computes it: {}", line.trim())));
                }
            }
        });
    });
}

/// The lines of the module that compute what stands on a line of a text: of all that does, what stands on the fewest lines.
fn lines_of(session: &Session, scene: &Compiled, name: &str, line: u32) -> BTreeSet<u32> {
    let sources = &session.said.drawn.sources;
    let covers = |span: Span| {
        let (file, first, _) = sources.position(span.file, span.start);
        let (_, last, _) = sources.position(span.file, span.end.saturating_sub(1).max(span.start));
        (file == name && (first..=last).contains(&line)).then_some(last - first)
    };
    let places = &scene.module.places;
    let Some(fewest) = places.iter().filter_map(|(_, span)| covers(*span)).min() else { return BTreeSet::new() };
    places.iter().filter(|(_, span)| covers(*span) == Some(fewest)).map(|(line, _)| *line).collect()
}

/// A line of WGSL in colours.
fn colored(line: &str, font: &egui::FontId, behind: Color32) -> LayoutJob {
    let mut job = LayoutJob::default();
    let mut add = |text: &str, color: Color32| job.append(text, 0.0, TextFormat { font_id: font.clone(), color, background: behind, ..TextFormat::default() });
    let (before, comment) = line.find("//").map_or((line, ""), |at| line.split_at(at));
    let mut rest = before;
    while let Some(first) = rest.chars().next() {
        let is_word = |c: char| c.is_alphanumeric() || c == '_';
        let end = match first {
            c if c.is_ascii_digit() => rest.find(|c: char| !(is_word(c) || c == '.')).unwrap_or(rest.len()),
            c if is_word(c) => rest.find(|c| !is_word(c)).unwrap_or(rest.len()),
            _ => rest.find(is_word).unwrap_or(rest.len()),
        };
        let (piece, after) = rest.split_at(end);
        let is_type = ["vec", "mat", "f32", "u32", "i32", "bool", "array", "texture", "sampler"].iter().any(|start| piece.starts_with(start));
        let color = match first {
            c if c.is_ascii_digit() => code::NUMBER,
            _ if WORDS.contains(&piece) => code::KEYWORD,
            _ if is_type => code::KIND,
            c if is_word(c) => code::NAME,
            _ => code::OPERATOR,
        };
        add(piece, *color);
        rest = after;
    }
    if !comment.is_empty() {
        add(comment, *code::COMMENT);
    }
    if line.is_empty() {
        add(" ", *code::NAME);
    }
    job
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_keeps_its_text() {
        for line in ["", "  let d = length(p.xy) - 1.5; // é", "fn sf_field(p: vec3f) -> f32 {", "é"] {
            let job = colored(line, &theme::code_font(12.0), Color32::TRANSPARENT);
            assert_eq!(job.text.trim_end(), line.trim_end());
        }
        let job = colored("let a = 1.5;", &theme::code_font(12.0), Color32::TRANSPARENT);
        let color = |at: usize| job.sections.iter().find(|section| section.byte_range.contains(&at.into())).map(|section| section.format.color);
        assert_eq!((color(0), color(8)), (Some(*code::KEYWORD), Some(*code::NUMBER)));
    }
}
