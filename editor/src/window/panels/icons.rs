//! Small signs, painted here, so that no font has to have them.

use egui::{Button, Color32, Painter, Pos2, Rect, Response, Sense, Shape, Stroke, Ui, pos2, vec2};
use surefoot_compiler::diagnostic::Severity;

/// A sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Icon {
    /// Let time run.
    Play,
    /// Let time stand.
    Pause,
    /// One step.
    Step,
    /// Back to the start.
    Rewind,
    /// Back to the scene's camera.
    Home,
    /// No longer shown.
    Close,
    /// An error.
    Error,
    /// A warning.
    Warning,
    /// Not saved.
    Dot,
}

/// The sign of a severity, told apart without its colour.
pub fn of(severity: Severity) -> Icon {
    match severity {
        Severity::Error => Icon::Error,
        Severity::Warning => Icon::Warning,
    }
}

/// A button with a sign. `name` is what a screen reader says.
pub fn button(ui: &mut Ui, icon: Icon, name: &str, enabled: bool) -> Response {
    let side = ui.spacing().interact_size.y + 2.0;
    signed(ui, Button::new("").min_size(vec2(side + 6.0, side)), icon, name, enabled)
}

/// A button among text.
pub fn small(ui: &mut Ui, icon: Icon, name: &str) -> Response {
    signed(ui, Button::new("").small().frame(false).min_size(vec2(18.0, 16.0)), icon, name, true)
}

fn signed(ui: &mut Ui, button: Button<'_>, icon: Icon, name: &str, enabled: bool) -> Response {
    let response = ui.add_enabled(enabled, button);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, enabled, name));
    if ui.is_rect_visible(response.rect) {
        let color = ui.style().interact(&response).fg_stroke.color;
        let color = if enabled { color } else { color.gamma_multiply(0.4) };
        paint(
            ui.painter(),
            Rect::from_center_size(response.rect.center(), vec2(10.0, 10.0)),
            icon,
            color,
        );
    }
    response
}

/// What a screen reader says of a widget that has no text of its own.
pub fn name(ui: &Ui, id: egui::Id, name: &str) {
    ui.ctx().accesskit_node_builder(id, |node| node.set_label(name));
}

/// A sign among text.
pub fn sign(ui: &mut Ui, icon: Icon, color: Color32) -> Response {
    let (rect, response) = ui.allocate_exact_size(vec2(12.0, 14.0), Sense::hover());
    paint(ui.painter(), Rect::from_center_size(rect.center(), vec2(10.0, 10.0)), icon, color);
    response
}

/// Paints a sign into a square.
fn paint(painter: &Painter, square: Rect, icon: Icon, color: Color32) {
    let at = |x: f32, y: f32| -> Pos2 { square.lerp_inside(vec2(x, y)) };
    let fill = |points: &[(f32, f32)]| {
        let points = points.iter().map(|(x, y)| at(*x, *y)).collect();
        painter.add(Shape::convex_polygon(points, color, Stroke::NONE));
    };
    let bar = |left: f32, right: f32| {
        painter.rect_filled(Rect::from_min_max(at(left, 0.0), at(right, 1.0)), 1.0, color);
    };
    let dark = Color32::from_black_alpha(200);
    match icon {
        Icon::Play => fill(&[(0.12, 0.0), (1.0, 0.5), (0.12, 1.0)]),
        Icon::Pause => {
            bar(0.1, 0.38);
            bar(0.62, 0.9);
        }
        Icon::Step => {
            bar(0.0, 0.2);
            fill(&[(0.35, 0.0), (1.07, 0.5), (0.35, 1.0)]);
        }
        Icon::Rewind => {
            bar(0.0, 0.2);
            fill(&[(1.0, 0.0), (0.28, 0.5), (1.0, 1.0)]);
        }
        Icon::Home => {
            fill(&[(0.5, 0.0), (1.05, 0.52), (-0.05, 0.52)]);
            fill(&[(0.15, 0.52), (0.85, 0.52), (0.85, 1.0), (0.15, 1.0)]);
        }
        Icon::Close => {
            let stroke = Stroke::new(1.6, color);
            painter.line_segment([at(0.1, 0.1), at(0.9, 0.9)], stroke);
            painter.line_segment([at(0.9, 0.1), at(0.1, 0.9)], stroke);
        }
        Icon::Error => {
            painter.circle_filled(square.center(), 5.5, color);
            let stroke = Stroke::new(1.6, dark);
            painter.line_segment([at(0.3, 0.3), at(0.7, 0.7)], stroke);
            painter.line_segment([at(0.7, 0.3), at(0.3, 0.7)], stroke);
        }
        Icon::Warning => {
            fill(&[(0.5, -0.05), (1.1, 1.0), (-0.1, 1.0)]);
            painter.line_segment([at(0.5, 0.32), at(0.5, 0.65)], Stroke::new(1.4, dark));
            painter.circle_filled(pos2(square.center().x, at(0.5, 0.83).y), 0.8, dark);
        }
        Icon::Dot => {
            painter.circle_filled(square.center(), 3.5, color);
        }
    }
}
