//! A ray's march as a picture: a slice of the field through the ray, and each look as a circle as large as the distance there, with one in it as large as
//! the bound.

use surefoot_compiler::reference::Reference;
use surefoot_compiler::reference::march::{Ray, at_points};
use surefoot_compiler::reference::shade::{isolines_color, isolines_spacing};
use surefoot_compiler::reference::steps::{March, Step};
use surefoot_compiler::vector::{Vec3, add, cross, dot, scale, sub, unit};

/// What a circle of the distance, of the bound, the ray and the hit are drawn in.
pub const DISTANCE: [f64; 3] = [1.0, 1.0, 1.0];
/// Of the bound.
pub const BOUND: [f64; 3] = [1.0, 0.78, 0.25];
/// Of the ray and of the hit.
pub const RAY: [f64; 3] = [1.0, 0.33, 0.3];
/// Lines of the field that are drawn over the picture's height, about.
const LINES: f64 = 10.0;
/// What is left free beside the ray, in parts of the picture's width.
const MARGIN: f64 = 0.06;

/// A slice of space: the plane of a ray and of what is up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slice {
    /// The ray's origin.
    origin: Vec3,
    /// Its direction: to the right.
    along: Vec3,
    /// Square to it, upward.
    up: Vec3,
    /// How far along the ray the picture's left edge is.
    left: f64,
    /// The length that a pixel shows.
    pub pixel: f64,
    /// Width and height in pixels.
    pub size: (u32, u32),
}

impl Slice {
    /// The slice that shows a march from one of its steps on. `up`: of the camera.
    pub fn of(ray: &Ray, march: &March, up: Vec3, from: usize, size: (u32, u32)) -> Self {
        let aside = sub(up, scale(ray.direction, dot(up, ray.direction)));
        let other = if ray.direction[1].abs() < 0.9 { [0.0, 1.0, 0.0] } else { [1.0, 0.0, 0.0] };
        let up = unit(aside).or_else(|| unit(cross(cross(ray.direction, other), ray.direction))).unwrap_or([0.0, 1.0, 0.0]);
        let (first, last) = match (march.steps.get(from.min(march.steps.len().saturating_sub(1))), march.steps.last()) {
            (Some(first), Some(last)) => (first.t, last.next.max(last.t)),
            _ => (0.0, march.hit.t),
        };
        let long = (last - first).max(1e-6 * (1.0 + last.abs()));
        let wide = f64::from(size.0);
        let pixel = long / (wide * (1.0 - 2.0 * MARGIN));
        Self { origin: ray.origin, along: ray.direction, up, left: first - MARGIN * wide * pixel, pixel, size }
    }

    /// The point of space that a place of the picture shows, in pixels from its upper left corner.
    pub fn point(&self, x: f64, y: f64) -> Vec3 {
        let t = self.left + x * self.pixel;
        let high = (0.5 * f64::from(self.size.1) - y) * self.pixel;
        add(self.origin, add(scale(self.along, t), scale(self.up, high)))
    }

    /// Where a place along the ray is shown.
    pub fn place(&self, t: f64) -> [f64; 2] {
        [(t - self.left) / self.pixel, 0.5 * f64::from(self.size.1)]
    }

    /// The value from one line of the field to the next.
    pub fn spacing(&self) -> f64 {
        isolines_spacing(f64::from(self.size.1) * self.pixel / LINES)
    }

    /// The field in the plane, as colours of a screen from 0 to 1, row by row.
    fn colors(&self, reference: &Reference) -> Vec<Vec3> {
        let (width, height) = self.size;
        let spacing = self.spacing();
        let mut colors = Vec::with_capacity(width as usize * height as usize);
        for y in 0..height {
            let points: Vec<Vec3> = (0..=width).map(|x| self.point(f64::from(x) + 0.5, f64::from(y) + 0.5)).collect();
            let below: Vec<Vec3> = (0..width).map(|x| self.point(f64::from(x) + 0.5, f64::from(y) + 1.5)).collect();
            let values = |points: &[Vec3]| {
                let mut values = vec![0.0; points.len()];
                at_points(reference.field(), points, &[], |i, found| {
                    if let (Some(slot), Some(value)) = (values.get_mut(i), found.first()) {
                        *slot = *value;
                    }
                });
                values
            };
            let (row, next) = (values(&points), values(&below));
            for ((x, pair), under) in (0..).zip(row.windows(2)).zip(next) {
                let &[here, right] = pair else { continue };
                let across = f64::from(x + y) * self.pixel;
                colors.push(isolines_color(here, (right - here).hypot(under - here), spacing, across));
            }
        }
        colors
    }

    /// The whole picture: red, green, blue and opacity of each pixel, row by row.
    pub fn draw(&self, reference: &Reference, march: &March) -> Vec<u8> {
        let mut colors = self.colors(reference);
        for color in &mut colors {
            *color = scale(*color, 0.72);
        }
        let mut sheet = Sheet { colors: &mut colors, size: self.size };
        for step in &march.steps {
            self.circles(&mut sheet, step);
        }
        let ends = march.steps.first().map_or(0.0, |step| step.t)..march.steps.last().map_or(march.hit.t, |step| step.next.max(step.t));
        let [(x0, y), (x1, _)] = [self.place(ends.start), self.place(ends.end)].map(|[x, y]| (x, y));
        sheet.stroke(RAY, 0.9, [(x0, y - 2.0), (x1, y + 2.0)], |x, at| if x < x0 || x > x1 { 9.0 } else { (at - y).abs() - 0.6 });
        for step in &march.steps {
            let [x, y] = self.place(step.t);
            sheet.dot(RAY, [x, y], 1.8);
        }
        if march.hit.hit {
            sheet.dot(RAY, self.place(march.hit.t), 4.5);
        }
        let level = |c: f64| (255.0 * c.clamp(0.0, 1.0)).round() as u8;
        colors.iter().flat_map(|c| [level(c[0]), level(c[1]), level(c[2]), 255]).collect()
    }

    fn circles(&self, sheet: &mut Sheet<'_>, step: &Step) {
        let [x, y] = self.place(step.t);
        // The distance is the wider line: where the bound is as large both are seen.
        for (color, radius, thick) in [(DISTANCE, step.distance.abs(), 1.5), (BOUND, step.bound.abs(), 0.5)] {
            let radius = radius / self.pixel;
            if radius > 1.5 {
                sheet.circle(color, [x, y], radius, thick);
            }
        }
    }
}

/// Colours that are drawn on.
struct Sheet<'a> {
    colors: &'a mut [Vec3],
    size: (u32, u32),
}

impl Sheet<'_> {
    /// Lays a colour on where a distance, in pixels, is below zero; `within` is a box around that.
    fn stroke(&mut self, color: Vec3, share: f64, within: [(f64, f64); 2], far: impl Fn(f64, f64) -> f64) {
        let side = |at: f64, most: u32| at.clamp(0.0, f64::from(most)) as u32;
        let [(x0, y0), (x1, y1)] = within;
        for y in side(y0.floor() - 1.0, self.size.1)..side(y1.ceil() + 1.0, self.size.1) {
            for x in side(x0.floor() - 1.0, self.size.0)..side(x1.ceil() + 1.0, self.size.0) {
                let covered = share * (0.5 - far(f64::from(x) + 0.5, f64::from(y) + 0.5)).clamp(0.0, 1.0);
                let at = y as usize * self.size.0 as usize + x as usize;
                if let (true, Some(slot)) = (covered > 0.0, self.colors.get_mut(at)) {
                    *slot = add(scale(*slot, 1.0 - covered), scale(color, covered));
                }
            }
        }
    }

    fn circle(&mut self, color: Vec3, [x, y]: [f64; 2], radius: f64, thick: f64) {
        let share = if thick > 1.0 { 0.4 } else { 0.75 };
        let within = [(x - radius - 2.0, y - radius - 2.0), (x + radius + 2.0, y + radius + 2.0)];
        self.stroke(color, share, within, |px, py| ((px - x).hypot(py - y) - radius).abs() - thick);
    }

    fn dot(&mut self, color: Vec3, [x, y]: [f64; 2], radius: f64) {
        let within = [(x - radius - 1.0, y - radius - 1.0), (x + radius + 1.0, y + radius + 1.0)];
        self.stroke(color, 1.0, within, |px, py| (px - x).hypot(py - y) - radius);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use surefoot_compiler::{MemoryLoader, Options, compile};

    #[test]
    fn a_march_is_drawn_with_its_circles_and_its_hit() {
        let loader = MemoryLoader::new().with("main.sdf", "scene = sphere(1)\n");
        let compiled = compile(&loader, "main.sdf", &Options::default()).compiled.unwrap();
        let reference = Reference::new(&compiled, &compiled.live()).unwrap();
        let ray = Ray { origin: [0.0, 0.0, 5.0], direction: [0.0, 0.0, -1.0], t_min: 0.0, t_max: 100.0 };
        let march = reference.march_of(&ray, 1e-3, 100.0);
        let slice = Slice::of(&ray, &march, [0.0, 1.0, 0.0], 0, (320, 200));
        let pixels = slice.draw(&reference, &march);
        assert_eq!(pixels.len(), 320 * 200 * 4);
        // The hit is a red dot.
        let [x, y] = slice.place(march.hit.t);
        let at = 4 * (y as usize * 320 + x as usize);
        assert!(pixels[at] > 200 && pixels[at + 1] < 120, "{:?}", &pixels[at..at + 4]);
        // A place of the ray is where it is shown, and up is up.
        let there = slice.point(x, y);
        assert!((there[2] - 1.0).abs() < 1e-3 && there[1].abs() < 1e-9, "{there:?}");
        assert!(slice.point(x, y - 10.0)[1] > 0.0);
        // A closer look shows less of it.
        let closer = Slice::of(&ray, &march, [0.0, 1.0, 0.0], march.steps.len() - 1, (320, 200));
        assert!(closer.pixel < 0.2 * slice.pixel);
    }
}
