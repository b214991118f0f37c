//! Curves of the second degree (Bézier): points of them, the nearest one, and their parts.

/// A place of a drawing.
pub type Vec2 = [f64; 2];

pub(super) fn add(a: Vec2, b: Vec2) -> Vec2 {
    [a[0] + b[0], a[1] + b[1]]
}

pub(super) fn sub(a: Vec2, b: Vec2) -> Vec2 {
    [a[0] - b[0], a[1] - b[1]]
}

pub(super) fn scale(a: Vec2, k: f64) -> Vec2 {
    [a[0] * k, a[1] * k]
}

pub(super) fn dot(a: Vec2, b: Vec2) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// Above zero where `b` points to the left of `a`.
pub(super) fn cross(a: Vec2, b: Vec2) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

pub(super) fn mix(a: Vec2, b: Vec2, t: f64) -> Vec2 {
    add(a, scale(sub(b, a), t))
}

pub(super) fn length(a: Vec2) -> f64 {
    a[0].hypot(a[1])
}

/// The same direction with length one; none where there is no length.
pub(super) fn unit(a: Vec2) -> Option<Vec2> {
    let length = length(a);
    (length > 0.0).then(|| scale(a, 1.0 / length))
}

/// A curve that starts at `a` toward `b` and ends at `c` coming from `b`. A straight line has `b` in its middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curve {
    /// Its start.
    pub a: Vec2,
    /// Where its tangents at both ends meet.
    pub b: Vec2,
    /// Its end.
    pub c: Vec2,
}

/// Rounds of Newton's method for the nearest point. The first guess is the place along the chord.
const ROUNDS: usize = 3;

impl Curve {
    /// A straight line.
    pub fn line(a: Vec2, c: Vec2) -> Self {
        Self { a, b: mix(a, c, 0.5), c }
    }

    /// The point at `t`, from 0 to 1.
    pub fn at(&self, t: f64) -> Vec2 {
        let (b, c) = self.powers();
        add(self.a, scale(add(scale(b, 2.0), scale(c, t)), t))
    }

    /// With a start at `a` it is `a + 2 b t + c t²`.
    fn powers(&self) -> (Vec2, Vec2) {
        let (first, second) = (sub(self.b, self.a), sub(self.c, self.b));
        (first, sub(second, first))
    }

    /// Where it goes at `t`: half its derivative.
    pub fn tangent(&self, t: f64) -> Vec2 {
        let (b, c) = self.powers();
        add(b, scale(c, t))
    }

    /// Where it goes at its start and its end, with length one; along the chord where two of its points are one.
    pub fn ends(&self) -> [Vec2; 2] {
        let chord = unit(sub(self.c, self.a)).unwrap_or([1.0, 0.0]);
        [unit(sub(self.b, self.a)).unwrap_or(chord), unit(sub(self.c, self.b)).unwrap_or(chord)]
    }

    /// The other way around.
    pub fn reversed(&self) -> Self {
        Self { a: self.c, b: self.b, c: self.a }
    }

    /// Its parts before and after `t` (de Casteljau).
    pub fn split(&self, t: f64) -> [Self; 2] {
        let (left, right) = (mix(self.a, self.b, t), mix(self.b, self.c, t));
        let middle = mix(left, right, t);
        [Self { a: self.a, b: left, c: middle }, Self { a: middle, b: right, c: self.c }]
    }

    /// Least and greatest corner of a rectangle that holds it.
    pub fn bounds(&self) -> [Vec2; 2] {
        let of = |pick: fn(f64, f64) -> f64| [0, 1].map(|i| pick(pick(axis(self.a, i), axis(self.c, i)), axis(self.b, i)));
        [of(f64::min), of(f64::max)]
    }

    /// Where on it the nearest point to `q` is, from 0 to 1, and the square of the way. It is gentle, so that the place along the chord is near enough for
    /// Newton's method, or an end is nearest; `compiler/tests/outlines.rs` compares it with many points. The twin of `sf_outlined` in `emit/library.rs`.
    pub fn nearest(&self, q: Vec2) -> (f64, f64) {
        let (b, c) = self.powers();
        let start = sub(self.a, q);
        let from = |t: f64| add(start, scale(add(scale(b, 2.0), scale(c, t)), t));
        let chord = sub(self.c, self.a);
        let mut t = (-dot(start, chord) / dot(chord, chord).max(1e-30)).clamp(0.0, 1.0);
        for _ in 0..ROUNDS {
            let (r, d) = (from(t), add(b, scale(c, t)));
            let speed = dot(d, d);
            // Near the centre of curvature the way hardly changes.
            let slope = (2.0 * speed + dot(r, c)).max(0.25 * speed).max(1e-30);
            t = (t - dot(r, d) / slope).clamp(0.0, 1.0);
        }
        let squared = |t: f64| dot(from(t), from(t));
        [0.0, 1.0].into_iter().fold((t, squared(t)), |best, end| {
            let way = squared(end);
            if way < best.1 { (end, way) } else { best }
        })
    }

    /// Parts that each turn by less than half a right angle, whose curvature grows or falls all along, and whose ends pass at speeds of which none is twice the
    /// other: so that places along the chord are nearly places along the curve.
    pub fn gentle(&self) -> Vec<Self> {
        let (b, c) = self.powers();
        let vertex = -dot(b, c) / dot(c, c).max(1e-300);
        let parts = if vertex > 1e-3 && vertex < 1.0 - 1e-3 { self.split(vertex).to_vec() } else { vec![*self] };
        let mut found = Vec::new();
        for part in parts {
            part.halve(&mut found, 8);
        }
        found
    }

    fn halve(&self, found: &mut Vec<Self>, depth: usize) {
        let ([first, last], [from, to]) = (self.ends(), [sub(self.b, self.a), sub(self.c, self.b)].map(length));
        if depth == 0 || (dot(first, last) > 0.75 && from < 2.0 * to && to < 2.0 * from) {
            found.push(*self);
        } else {
            self.split(0.5).iter().for_each(|part| part.halve(found, depth - 1));
        }
    }

    /// How often it winds around a point as a ray to the right counts it: one for each crossing upward, less one for each downward.
    pub fn winding(&self, [x, y]: Vec2) -> i32 {
        // What lies on the ray counts as above it, for both curves of a joint alike.
        let (starts_below, ends_below) = (axis(self.a, 1) < y, axis(self.c, 1) < y);
        let [low, high] = self.bounds();
        if low[1] > y || high[1] < y || high[0] < x {
            return 0;
        }
        let (b, c) = self.powers();
        let start = axis(self.a, 1) - y;
        let right = |t: f64| axis(self.at(t), 0) > x;
        // start + 2 b t + c t² = 0, without loss where c is small (Numerical Recipes, § 5.6).
        let root = (b[1] * b[1] - c[1] * start).max(0.0).sqrt();
        let q = -(b[1] + if b[1] < 0.0 { -root } else { root });
        let roots = [if c[1] == 0.0 { f64::NAN } else { q / c[1] }, if q == 0.0 { f64::NAN } else { start / q }];
        // Upward the derivative 2 (b + c t) is above zero.
        let up = |t: &f64| b[1] + c[1] * t > 0.0;
        let inside = |t: &f64| (0.0..=1.0).contains(t);
        if starts_below == ends_below {
            // In and out again, or not at all.
            let both = roots.iter().all(inside) && b[1] * b[1] - c[1] * start > 0.0;
            return if both { roots.iter().map(|t| i32::from(right(*t)) * if up(t) { 1 } else { -1 }).sum() } else { 0 };
        }
        // Once across: the root whose direction is that of the ends.
        let upward = starts_below;
        let near = |t: &f64| (t - t.clamp(0.0, 1.0)).abs();
        let across = roots.iter().filter(|t| t.is_finite() && up(t) == upward).min_by(|s, t| near(s).total_cmp(&near(t)));
        let at = across.map_or(0.5, |t| t.clamp(0.0, 1.0));
        i32::from(right(at)) * if upward { 1 } else { -1 }
    }
}

/// A coordinate by its number.
fn axis(p: Vec2, i: usize) -> f64 {
    if i == 0 { p[0] } else { p[1] }
}
