//! A straight piece or a part of a circle, in space.

use crate::vector::{Vec3, add, along, cross, dot, length, scale, sub, unit};
use std::f64::consts::PI;

/// Numbers of a bow on a device.
pub const BOW: usize = 14;

/// The most by which half of a part turns.
const WIDEST: f64 = 1.2;

/// A part of a circle, or of a line. It is given by its middle, so that nothing is lost where it is nearly straight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bow {
    /// The place halfway along it.
    pub middle: Vec3,
    /// The direction there away from the circle's centre, of length one.
    pub out: Vec3,
    /// The direction of the curve there, of length one and at a right angle to `out`.
    pub forth: Vec3,
    /// One over the circle's radius; 0 of a line.
    pub bend: f64,
    /// Half of its length. It turns by no more than a whole turn.
    pub half: f64,
}

impl Bow {
    /// A straight piece; none where it has no length.
    pub fn straight(from: Vec3, to: Vec3) -> Option<Self> {
        let way = sub(to, from);
        let forth = unit(way)?;
        Some(Self { middle: along(from, way, 0.5), out: aside(forth), forth, bend: 0.0, half: 0.5 * length(way) })
    }

    /// The arc that leaves a place in a direction of length one and ends at another place; none where it has no length, or turns back.
    pub fn leaving(from: Vec3, start: Vec3, to: Vec3) -> Option<Self> {
        let way = sub(to, from);
        let chord = unit(way)?;
        // Half of the angle by which it turns, and the direction from the chord to the centre.
        let (sine, cosine) = (length(cross(start, chord)), dot(start, chord));
        let angle = sine.atan2(cosine);
        if angle > PI - 1e-6 {
            return None;
        }
        let Some(inward) = unit(sub(scale(chord, cosine), start)).filter(|_| angle > 1e-9) else { return Self::straight(from, to) };
        // At a right angle to the chord, exactly.
        let inward = unit(sub(inward, scale(chord, dot(inward, chord))))?;
        let wide = length(way);
        let bend = 2.0 * angle.sin() / wide;
        let out = scale(inward, -1.0);
        Some(Self { middle: along(along(from, way, 0.5), out, 0.5 * wide * (0.5 * angle).tan()), out, forth: chord, bend, half: 0.5 * wide * angle / angle.sin() })
    }

    /// The arc from a place through another to a third; a straight piece where they lie in a line in this order.
    pub fn through(from: Vec3, by: Vec3, to: Vec3) -> Option<Self> {
        let inverse = |v: Vec3| scale(v, 1.0 / dot(v, v).max(f64::MIN_POSITIVE));
        // Seen from the first place, inverted at it, the circle is a line along its own direction there.
        let start = unit(sub(inverse(sub(by, from)), inverse(sub(to, from))))?;
        Self::leaving(from, start, to)
    }

    /// Half of the angle by which it turns.
    pub fn angle(&self) -> f64 {
        self.bend * self.half
    }

    /// The place at a way from the middle, and the direction there.
    pub fn at(&self, way: f64) -> (Vec3, Vec3) {
        let angle = self.bend * way;
        // (1 - cos a) / k and sin a / k, without a difference that loses digits.
        let (rise, run) = if self.bend == 0.0 { (0.0, way) } else { (2.0 * (0.5 * angle).sin().powi(2) / self.bend, angle.sin() / self.bend) };
        let place = add(self.middle, sub(scale(self.forth, run), scale(self.out, rise)));
        (place, sub(scale(self.forth, angle.cos()), scale(self.out, angle.sin())))
    }

    /// Its ends.
    pub fn ends(&self) -> [Vec3; 2] {
        [self.at(-self.half).0, self.at(self.half).0]
    }

    /// The same in parts that turn by no more than a right angle and a half each.
    pub fn parts(&self) -> Vec<Self> {
        let count = (self.angle() / WIDEST).ceil().max(1.0);
        let half = self.half / count;
        let part = |i: f64| {
            let (middle, forth) = self.at(self.half * ((2.0 * i + 1.0) / count - 1.0));
            let turn = self.bend * self.half * ((2.0 * i + 1.0) / count - 1.0);
            Self { middle, out: turned(self.out, cross(self.forth, self.out), -turn), forth, bend: self.bend, half }
        };
        (0..count as u32).map(|i| part(f64::from(i))).collect()
    }

    /// A vector carried from its start to its end: turned with it.
    pub fn carried(&self, v: Vec3) -> Vec3 {
        turned(v, cross(self.forth, self.out), -2.0 * self.angle())
    }

    /// From the nearest place of it to a point. The twin of `sf_bow` in `emit/library.rs`.
    pub fn away(&self, p: Vec3) -> Vec3 {
        let Self { middle, out, forth, bend, .. } = *self;
        let across = cross(out, forth);
        let off = sub(p, middle);
        let (x, y, z) = (dot(off, out), dot(off, forth), dot(off, across));
        let [end_x, end_y, sine, cosine] = self.end();
        let past = [x - end_x, y.abs() - end_y];
        if past[1] * cosine - past[0] * sine > 0.0 {
            return add(add(scale(out, past[0]), scale(forth, past[1] * if y < 0.0 { -1.0 } else { 1.0 })), scale(across, z));
        }
        // How much farther from the centre than the circle.
        let rise = bend * (x * x + y * y) + 2.0 * x;
        let from_centre = (1.0 + bend * rise).max(0.0).sqrt();
        let beyond = rise / (1.0 + from_centre);
        let (to_x, to_y) = if from_centre > 1e-12 { ((1.0 + bend * x) / from_centre, bend * y / from_centre) } else { (1.0, 0.0) };
        add(add(scale(out, beyond * to_x), scale(forth, beyond * to_y)), scale(across, z))
    }

    /// Its end in the plane of `out` and `forth` about the middle, and sine and cosine of half of its angle.
    fn end(&self) -> [f64; 4] {
        let angle = self.angle().min(PI);
        let (sine, cosine) = angle.sin_cos();
        let run = if self.bend == 0.0 { self.half } else { sine / self.bend };
        let rise = if self.bend == 0.0 { 0.0 } else { 2.0 * (0.5 * angle).sin().powi(2) / self.bend };
        [-rise, run, sine, cosine]
    }

    /// Least and greatest corner of a box about it.
    pub fn bounds(&self) -> [Vec3; 2] {
        let [from, to] = self.ends();
        let [mut low, mut high] = [[0, 1, 2].map(|i: usize| pick(from, i).min(pick(to, i))), [0, 1, 2].map(|i: usize| pick(from, i).max(pick(to, i)))];
        // Along an axis it turns where its direction is at a right angle to that.
        for (i, (low, high)) in low.iter_mut().zip(&mut high).enumerate() {
            if self.bend > 0.0 {
                let turn = pick(self.forth, i).atan2(pick(self.out, i));
                for angle in [turn, turn + PI, turn - PI] {
                    if angle.abs() < self.angle() {
                        let c = pick(self.at(angle / self.bend).0, i);
                        (*low, *high) = (low.min(c), high.max(c));
                    }
                }
            }
        }
        [low, high]
    }

    /// As a device reads it.
    pub(super) fn numbers(&self) -> [f64; BOW] {
        let Self { middle: [a, b, c], out: [d, e, f], forth: [g, h, i], bend, .. } = *self;
        let [x, y, sine, cosine] = self.end();
        [a, b, c, d, e, f, g, h, i, bend, x, y, sine, cosine]
    }
}

fn pick(v: Vec3, i: usize) -> f64 {
    v.get(i).copied().unwrap_or(0.0)
}

/// A vector turned about an axis of length one (Rodrigues).
pub fn turned(v: Vec3, axis: Vec3, angle: f64) -> Vec3 {
    let (sine, cosine) = angle.sin_cos();
    add(add(scale(v, cosine), scale(cross(axis, v), sine)), scale(axis, dot(axis, v) * (1.0 - cosine)))
}

/// Some direction at a right angle to another: as far up as it can be, or toward z where that one is up.
pub fn aside(forth: Vec3) -> Vec3 {
    let off = |axis: Vec3| unit(sub(axis, scale(forth, dot(axis, forth)))).filter(|_| dot(axis, forth).abs() < 0.999_999);
    off([0.0, 1.0, 0.0]).or_else(|| off([0.0, 0.0, 1.0])).unwrap_or([1.0, 0.0, 0.0])
}

/// The axis, of length one, and the angle of the turn that carries the axes to these, which have length one and are at right angles, right-handed: by its quaternion (Shepperd, "Quaternion from rotation
/// matrix", 1978).
pub fn turn([[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]]: [Vec3; 3]) -> (Vec3, f64) {
    // Each is four times a product of two parts of the quaternion; the largest square says by which to divide.
    let (a, b, c) = (yz - zy, zx - xz, xy - yx);
    let parts = [
        (1.0 + xx + yy + zz, [a, b, c], 1.0 + xx + yy + zz),
        (1.0 + xx - yy - zz, [1.0 + xx - yy - zz, yx + xy, zx + xz], a),
        (1.0 - xx + yy - zz, [yx + xy, 1.0 - xx + yy - zz, zy + yz], b),
        (1.0 - xx - yy + zz, [zx + xz, zy + yz, 1.0 - xx - yy + zz], c),
    ];
    let (_, axis, real) = parts.into_iter().max_by(|(one, ..), (other, ..)| one.total_cmp(other)).unwrap_or((0.0, [0.0; 3], 1.0));
    match unit(axis) {
        Some(direction) => (direction, 2.0 * length(axis).atan2(real)),
        None => ([0.0, 1.0, 0.0], 0.0),
    }
}
