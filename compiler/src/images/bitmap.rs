//! A picture of floats.

use crate::vector::Vec3;

/// An image in linear light.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bitmap {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Row by row from the top: red, green, blue; never below zero, never NaN.
    pub texels: Vec<[f32; 3]>,
}

impl Bitmap {
    /// The pixel of a column and a row; black outside.
    pub fn get(&self, x: usize, y: usize) -> [f32; 3] {
        if x >= self.width {
            return [0.0; 3];
        }
        self.texels.get(y * self.width + x).copied().unwrap_or_default()
    }

    /// The colour at a place, 0 to 1 across and down, between the four pixels around it. `wraps` says that its left edge follows its right.
    pub(super) fn bilinear(&self, u: f64, v: f64, wraps: bool) -> Vec3 {
        let (x, y) = (u * self.width as f64 - 0.5, v * self.height as f64 - 0.5);
        let clamp = |at: f64, side: usize| (at.max(0.0) as usize).min(side.saturating_sub(1));
        let column = |at: f64| if wraps { clamp(at.rem_euclid(self.width as f64), self.width) } else { clamp(at, self.width) };
        let (left, top) = (x.floor(), y.floor());
        let at = |dx: f64, dy: f64| self.get(column(left + dx), clamp(top + dy, self.height)).map(f64::from);
        let row = |dy: f64| blend(at(0.0, dy), at(1.0, dy), x - left);
        blend(row(0.0), row(1.0), y - top)
    }

    /// The colour at a place, 0 to 1 across and down, of the image repeated without end.
    pub(super) fn repeated(&self, u: f64, v: f64) -> Vec3 {
        let (x, y) = (u.rem_euclid(1.0) * self.width as f64 - 0.5, v.rem_euclid(1.0) * self.height as f64 - 0.5);
        let around = |at: f64, side: usize| (at.rem_euclid(side as f64) as usize).min(side.saturating_sub(1));
        let (left, top) = (x.floor(), y.floor());
        let at = |dx: f64, dy: f64| self.get(around(left + dx, self.width), around(top + dy, self.height)).map(f64::from);
        let row = |dy: f64| blend(at(0.0, dy), at(1.0, dy), x - left);
        blend(row(0.0), row(1.0), y - top)
    }

    /// Half as wide and half as high: each pixel the mean of four.
    pub(super) fn half(&self) -> Self {
        let (width, height) = ((self.width / 2).max(1), (self.height / 2).max(1));
        let mean = |x: usize, y: usize| {
            let right = (2 * x + 1).min(self.width.saturating_sub(1));
            let below = (2 * y + 1).min(self.height.saturating_sub(1));
            mean4([(2 * x, 2 * y), (right, 2 * y), (2 * x, below), (right, below)].map(|(x, y)| self.get(x, y)))
        };
        let texels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| mean(x, y)).collect();
        Self { width, height, texels }
    }
}

/// The mean of four colours.
pub(super) fn mean4(four: [[f32; 3]; 4]) -> [f32; 3] {
    let [a, b, c, d] = four;
    let mean = |((a, b), (c, d)): ((f32, f32), (f32, f32))| 0.25 * (a + b + (c + d));
    let pairs = |a: [f32; 3], b: [f32; 3]| [(a[0], b[0]), (a[1], b[1]), (a[2], b[2])];
    let ([p, q, r], [s, t, u]) = (pairs(a, b), pairs(c, d));
    [mean((p, s)), mean((q, t)), mean((r, u))]
}

/// From one colour to another.
pub(super) fn blend(a: Vec3, b: Vec3, part: f64) -> Vec3 {
    crate::vector::mix(a, b, part)
}
