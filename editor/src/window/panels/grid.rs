//! A grid with a scale over the picture: through the origin, level, or square to the view where rays go side by side. It hides nothing and is not hidden.

use crate::window::panels::icons;
use crate::window::session::Session;
use crate::window::theme;
use egui::{Align2, Color32, FontId, Pos2, Rect, Sense, Stroke, Ui, pos2, vec2};
use surefoot_compiler::camera::Basis;
use surefoot_compiler::compiled::Camera;
use surefoot_compiler::reference::shade::slice_spacing;
use surefoot_compiler::vector::{Vec3, dot, sub};

/// Lines to each side of the middle one.
const LINES: i32 = 12;
/// What is nearer to the eye is not drawn, in parts of the spacing.
const NEAR: f64 = 0.2;

/// Where points of the scene are in the picture.
struct Seen {
    camera: Camera,
    basis: Basis,
    rect: Rect,
}

impl Seen {
    /// How far ahead a point is, and how far to the right and up.
    fn of(&self, point: Vec3) -> [f64; 3] {
        let way = sub(point, self.camera.eye);
        let ahead = dot(way, self.basis.forward);
        [ahead, dot(way, self.basis.right) - ahead * self.basis.lean[0], dot(way, self.basis.up) - ahead * self.basis.lean[1]]
    }

    fn at(&self, [ahead, right, up]: [f64; 3]) -> Pos2 {
        let half = self.basis.tan_half_fov * self.basis.parallel.unwrap_or(ahead);
        let scale = 0.5 * f64::from(self.rect.height()) / half;
        self.rect.center() + vec2((right * scale) as f32, (-up * scale) as f32)
    }

    /// A line between two points, as far as it lies before the eye.
    fn line(&self, from: Vec3, to: Vec3, near: f64) -> Option<[Pos2; 2]> {
        let (mut a, mut b) = (self.of(from), self.of(to));
        if self.basis.parallel.is_none() {
            if a[0] < near && b[0] < near {
                return None;
            }
            let cut = |inner: [f64; 3], outer: [f64; 3]| {
                let part = (near - inner[0]) / (outer[0] - inner[0]);
                [0, 1, 2].map(|i| inner[i] + part * (outer[i] - inner[i]))
            };
            if a[0] < near {
                a = cut(b, a);
            } else if b[0] < near {
                b = cut(a, b);
            }
        }
        Some([self.at(a), self.at(b)])
    }
}

/// Shows it, where a person wants it.
pub fn show(ui: &mut Ui, rect: Rect, session: &Session) {
    let Some(camera) = session.camera().filter(|_| session.open.grid) else { return };
    let seen = Seen { camera, basis: Basis::of(&camera), rect };
    let spacing = slice_spacing(&camera);
    // Of rays that go side by side the plane that is seen from the front; else the ground.
    let normal = match seen.basis.parallel {
        Some(_) => (0..3).max_by(|a, b| seen.basis.forward[*a].abs().total_cmp(&seen.basis.forward[*b].abs())).unwrap_or(1),
        None => 1,
    };
    let (first, second) = ((normal + 1) % 3, (normal + 2) % 3);
    let painter = ui.painter().with_clip_rect(rect);
    let middle = |axis: usize| (camera.target[axis] / spacing).round() as i32;
    let reach = f64::from(LINES) * spacing;
    for (across, along) in [(first, second), (second, first)] {
        for i in -LINES..=LINES {
            let at = f64::from(middle(across).saturating_add(i)) * spacing;
            let end = |far: f64| {
                let mut point = [0.0; 3];
                point[across] = at;
                point[along] = f64::from(middle(along)) * spacing + far;
                point
            };
            let axis = Color32::from_rgb(if along == 0 { 230 } else { 90 }, if along == 1 { 200 } else { 90 }, if along == 2 { 240 } else { 90 });
            let stroke = if at == 0.0 { Stroke::new(1.5, axis) } else { Stroke::new(1.0, Color32::from_white_alpha(46)) };
            if let Some(line) = seen.line(end(-reach), end(reach), NEAR * spacing) {
                painter.line_segment(line, stroke);
            }
        }
    }
    let unit = session.scene().and_then(|scene| scene.blocks.unit).map_or("", |unit| unit.name());
    let words = format!("a square is {spacing} {unit}").trim_end().to_owned();
    let place = Rect::from_min_size(pos2(rect.right() - 150.0, rect.bottom() - 22.0), vec2(140.0, 16.0));
    let response = ui.interact(place, ui.scope_id().with("scale"), Sense::hover());
    icons::name(ui, response.id, &words);
    painter.text(place.right_center(), Align2::RIGHT_CENTER, words, FontId::proportional(11.0), *theme::STRONG);
}
