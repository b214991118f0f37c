//! All values and all gradients of a field over a box.
//!
//! Beside its natural interval, every step has its value at the middle of the box and its gradient over all of the box; so its
//! values also lie in the mean-value form `f(m) + F'(X) (X - m)`, and both are intersected, at every step and not only at the last.
//! That holds across kinks too, where the gradient is the hull of both sides, as a continuous function of pieces changes between two
//! points by its gradients on the way. It does not hold across a jump, and is left out there.

// A step names only steps before it, so every index is in range.
#![allow(clippy::indexing_slicing)]

use crate::certify::code::Code;
use crate::certify::form::Form;
use crate::certify::step::{Known, Step, known};
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;

/// Gradients are bounded by sums of products: what their rounding may lose, relative.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Part of the space of the arguments: a box, and where given only what of it lies in a ball.
#[derive(Clone, Copy, Debug)]
pub(super) struct Domain<const D: usize> {
    pub range: [Interval; D],
    pub middle: [f64; D],
    /// Greatest distance from the middle along each axis.
    half: [f64; D],
    /// The ball's centre as seen from the middle, and its radius; the middle lies in it.
    ball: Option<([f64; D], f64)>,
    /// The corners of a triangle as seen from the middle, which is a fourth: only what lies between them is looked at.
    corners: Option<[[f64; D]; 3]>,
    /// Greatest distance from the middle.
    reach: f64,
}

impl<const D: usize> Domain<D> {
    pub(super) fn new(range: [Interval; D], ball: Option<([f64; D], f64)>) -> Self {
        let mut middle = range.map(Interval::middle);
        if let Some((centre, radius)) = ball {
            if range.iter().zip(centre).all(|(side, c)| side.lo <= c - radius && c + radius <= side.hi) {
                // The middle of a cube about the ball is the ball's centre, but for rounding.
                middle = centre;
            } else {
                middle = drawn_in(middle, &range, centre, radius);
            }
        }
        let mut half = [0.0; D];
        for ((half, side), m) in half.iter_mut().zip(&range).zip(&middle) {
            *half = (side.hi - m).max(m - side.lo).next_up();
        }
        let ball = ball.map(|(centre, radius)| {
            let mut seen = centre;
            seen.iter_mut().zip(&middle).for_each(|(c, m)| *c -= m);
            let from = seen.iter().map(|x| x * x).sum::<f64>().sqrt() * (1.0 + ROUNDING);
            // Where rounding leaves the middle a hair outside, the ball is that much larger.
            (seen, radius.max(from))
        });
        let length = |v: &[f64; D]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let within = ball.map_or(f64::INFINITY, |(seen, radius)| length(&seen) + radius);
        let reach = length(&half).min(within) * (1.0 + ROUNDING);
        Self { range, middle, half, ball, corners: None, reach }
    }

    /// What lies between the corners of a triangle and the mean of these as it is computed.
    pub(super) fn triangle(corners: [[f64; D]; 3]) -> Self {
        let mut middle = [0.0; D];
        for (i, m) in middle.iter_mut().enumerate() {
            *m = corners.iter().map(|corner| corner[i]).sum::<f64>() / 3.0;
        }
        let mut range = middle.map(Interval::point);
        let mut seen = corners;
        for corner in &mut seen {
            for ((x, side), m) in corner.iter_mut().zip(&mut range).zip(&middle) {
                *side = side.hull(Interval::point(*x));
                *x -= m;
            }
        }
        let within = Self::new(range, None);
        let mut half = [0.0; D];
        for ((half, side), m) in half.iter_mut().zip(&range).zip(&middle) {
            *half = (side.hi - m).max(m - side.lo).next_up();
        }
        let far = |corner: &[f64; D]| corner.iter().map(|x| x * x).sum::<f64>().sqrt();
        let reach = seen.iter().map(far).fold(0.0, f64::max) * (1.0 + ROUNDING);
        Self { middle, half, corners: Some(seen), reach, ..within }
    }

    /// The radius of the ball, where all of it is in the box and the middle is its centre.
    pub(super) fn whole_ball(&self) -> Option<f64> {
        let (seen, radius) = self.ball?;
        let whole = seen.iter().all(|x| *x == 0.0) && self.half.iter().all(|half| *half >= radius);
        whole.then_some(radius)
    }

    /// What of the box can hold values of `target`, of a function that does not jump, by its value at the middle and its gradient (a step of
    /// the interval Newton method, Moore, Kearfott and Cloud, § 8.1). None where nothing can.
    pub(super) fn holding(&self, centre: Interval, gradient: &[Interval; D], target: Interval) -> Option<[Interval; D]> {
        let mut range = self.range;
        let mut terms = [Interval::ZERO; D];
        for (((term, g), side), m) in terms.iter_mut().zip(gradient).zip(&range).zip(&self.middle) {
            *term = g.mul(side.sub(Interval::point(*m)));
        }
        for i in 0..D {
            if gradient[i].contains(0.0) || !gradient[i].is_finite() {
                continue;
            }
            let others = terms.iter().enumerate().filter(|(j, _)| *j != i).fold(centre, |sum, (_, term)| sum.add(*term));
            let middle = Interval::point(self.middle[i]);
            range[i] = range[i].intersect(target.sub(others).div(gradient[i]).add(middle));
            if range[i].is_empty() {
                return None;
            }
            terms[i] = gradient[i].mul(range[i].sub(middle));
        }
        Some(range)
    }

    /// A function's values, from its value at the middle, its gradient and a bound of that's norm.
    fn mean_value(&self, centre: Interval, gradient: &[Interval; D], norm: f64) -> Interval {
        let mut side = 0.0;
        let mut slopes = 0.0;
        for (g, half) in gradient.iter().zip(&self.half) {
            side += g.magnitude() * half;
            slopes += g.magnitude();
        }
        side = side.min(norm * self.reach) * (1.0 + ROUNDING);
        let mut lo = centre.lo - side;
        let mut hi = centre.hi + side;
        if let (Some((ball, radius)), true) = (self.ball, slopes.is_finite()) {
            // With g the middle of the gradients: g (p - m) = g (b - m) + g (p - b), and |p - b| is at most the radius.
            let (mut along, mut square, mut spread, mut size) = (0.0, 0.0, 0.0, 0.0);
            for ((g, half), b) in gradient.iter().zip(&self.half).zip(&ball) {
                let middle = g.middle();
                along += middle * b;
                square += middle * middle;
                spread += (g.hi - middle).max(middle - g.lo) * half;
                size += middle.abs() * b.abs();
            }
            let far = square.sqrt() * radius + spread;
            let far = far + ROUNDING * (far + size);
            lo = lo.max(centre.lo + along - far);
            hi = hi.min(centre.hi + along + far);
        }
        if let (Some(corners), true) = (&self.corners, slopes.is_finite()) {
            // For each gradient the extremes are at corners; the middle is one of them.
            let (mut below, mut above, mut size) = (0.0_f64, 0.0_f64, 0.0_f64);
            for corner in corners {
                let (mut low, mut high, mut all) = (0.0, 0.0, 0.0);
                for (g, x) in gradient.iter().zip(corner) {
                    let (a, b) = (g.lo * x, g.hi * x);
                    (low, high, all) = (low + a.min(b), high + a.max(b), all + a.abs().max(b.abs()));
                }
                (below, above, size) = (below.min(low), above.max(high), size.max(all));
            }
            lo = lo.max(centre.lo + below - ROUNDING * size);
            hi = hi.min(centre.hi + above + ROUNDING * size);
        }
        let slack = ROUNDING * (centre.magnitude() + side.min(1e300));
        Interval::new(lo - slack, hi + slack)
    }
}

/// The point nearest to a box's middle, on the way from there to the box's point nearest to a ball's centre, that lies in the ball. Ranges and
/// gradients hold for what of the box is in the ball, so a mean value must begin there too: the way from a point outside of the ball to
/// one inside leads through what they know nothing of.
fn drawn_in<const D: usize>(middle: [f64; D], range: &[Interval; D], centre: [f64; D], radius: f64) -> [f64; D] {
    let mut nearest = centre;
    nearest.iter_mut().zip(range).for_each(|(x, side)| *x = x.clamp(side.lo, side.hi));
    let between = |part: f64| {
        let mut at = middle;
        at.iter_mut().zip(&nearest).zip(range).for_each(|((x, end), side)| *x = (*x + part * (end - *x)).clamp(side.lo, side.hi));
        at
    };
    let within = |at: &[f64; D]| at.iter().zip(&centre).map(|(x, c)| (x - c) * (x - c)).sum::<f64>() <= radius * radius * (1.0 - 1e-9);
    if within(&middle) {
        return middle;
    }
    let (mut outside, mut inside) = (0.0, 1.0);
    for _ in 0..6 {
        let part = 0.5 * (outside + inside);
        if within(&between(part)) { inside = part } else { outside = part }
    }
    between(inside)
}

/// What is known of a step's value over a domain.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot<const D: usize> {
    /// All values.
    pub range: Interval,
    /// The value at the middle.
    pub centre: Interval,
    /// All gradients of its pieces.
    pub gradient: [Interval; D],
    /// A bound of their norm.
    pub norm: f64,
    /// Whether it may jump inside.
    pub jump: bool,
}

impl<const D: usize> Slot<D> {
    pub(super) const ZERO: Self =
        Self { range: Interval::ZERO, centre: Interval::ZERO, gradient: [Interval::ZERO; D], norm: 0.0, jump: false };

    pub(super) fn constant(value: f64) -> Self {
        let point = Interval::point(value);
        Self { range: point, centre: point, ..Self::ZERO }
    }

    pub(super) fn input(i: usize, range: Interval, middle: f64) -> Self {
        let mut gradient = [Interval::ZERO; D];
        gradient[i] = Interval::ONE;
        Self { range, centre: Interval::point(middle), gradient, norm: 1.0, jump: false }
    }
}

/// Natural intervals of every step over a box.
pub(super) fn natural<const D: usize>(code: &Code, range: &[Interval; D], values: &mut Vec<Interval>) -> Interval {
    values.clear();
    for step in &code.steps {
        values.push(match *step {
            Step::Input(i) => range[usize::from(i)],
            Step::Constant(value) => Interval::point(value),
            Step::Op(op, from) => interval(op, from.map(|a| values[a as usize])),
            Step::Form(form, [value, of @ ..]) => {
                values[value as usize].intersect(form.range(&code.polynomials, of.map(|a| values[a as usize])))
            }
        });
    }
    values.last().copied().unwrap_or(Interval::ZERO)
}

/// All values of an operation; the commonest without a call.
fn interval(op: Op, arguments: [Interval; 4]) -> Interval {
    let [a, b, ..] = arguments;
    match op {
        Op::Add => a.add(b),
        Op::Sub => a.sub(b),
        Op::Mul => a.mul(b),
        Op::Min => a.min(b),
        Op::Max => a.max(b),
        Op::Abs => a.abs(),
        Op::Square => a.square(),
        other => (other.row().interval)(arguments),
    }
}

/// Values and gradients of every step over a domain.
pub(super) fn full<const D: usize>(code: &Code, domain: &Domain<D>, slots: &mut Vec<Slot<D>>) -> Slot<D> {
    slots.clear();
    for step in &code.steps {
        let slot = match *step {
            Step::Input(i) => {
                let i = usize::from(i);
                Slot::input(i, domain.range[i], domain.middle[i])
            }
            Step::Constant(value) => Slot::constant(value),
            Step::Op(op, from) => {
                let arguments = from.map(|a| &slots[a as usize]);
                let range = interval(op, arguments.map(|a| a.range));
                let centre = interval(op, arguments.map(|a| a.centre));
                let (gradient, norm, jump) = derive(op, arguments, range, Known::Open);
                let range = if jump { range } else { range.intersect(domain.mean_value(centre, &gradient, norm)) };
                Slot { range, centre, gradient, norm, jump }
            }
            Step::Form(form, [value, of @ ..]) => {
                let told = formed(code, slots, form, [value, of[0], of[1], of[2]]);
                let range = told.range.intersect(form.range(&code.polynomials, of.map(|a| slots[a as usize].range)));
                let range = if told.jump { range } else { range.intersect(domain.mean_value(told.centre, &told.gradient, told.norm)) };
                Slot { range, ..told }
            }
        };
        slots.push(slot);
    }
    slots.last().copied().unwrap_or(Slot::ZERO)
}

/// What is known of a step, with what its form tells of the gradient.
pub(super) fn formed<const D: usize>(code: &Code, slots: &[Slot<D>], form: Form, [value, of @ ..]: [u32; 4]) -> Slot<D> {
    let known = slots[value as usize];
    let of = of.map(|a| &slots[a as usize]);
    let mut gradient = form.gradient(&code.polynomials, of.map(|a| a.range), of.map(|a| a.gradient));
    gradient.iter_mut().zip(known.gradient).for_each(|(g, other)| *g = g.intersect(other));
    let (gradient, norm, _) = with_norm(gradient, known.norm, known.jump);
    Slot { gradient, norm, ..known }
}

fn hull<const D: usize>(a: &Slot<D>, b: &Slot<D>) -> ([Interval; D], f64, bool) {
    let mut gradient = a.gradient;
    gradient.iter_mut().zip(&b.gradient).for_each(|(x, y)| *x = x.hull(*y));
    (gradient, a.norm.max(b.norm), a.jump | b.jump)
}

fn negated<const D: usize>(a: &Slot<D>) -> ([Interval; D], f64, bool) {
    (a.gradient.map(Interval::neg), a.norm, a.jump)
}

fn kept<const D: usize>(a: &Slot<D>) -> ([Interval; D], f64, bool) {
    (a.gradient, a.norm, a.jump)
}

/// Gradient, its norm, and whether there may be a jump: of an operation on arguments whose own are known. `out`: its values. `chosen`:
/// which branch is looked at, where that is settled though the ranges leave it open.
pub(super) fn derive<const D: usize>(
    op: Op,
    arguments: [&Slot<D>; 4],
    out: Interval,
    chosen: Known,
) -> ([Interval; D], f64, bool) {
    let [a, b, c, _] = arguments;
    let ranges = arguments.map(|x| x.range);
    let decided = if chosen == Known::Open { known(op, ranges, out) } else { chosen };
    match decided {
        Known::Argument(k) => return kept(arguments[k]),
        Known::Negated => return negated(a),
        Known::Constant(_) => return kept(&Slot::ZERO),
        Known::Open => {}
    }
    match op {
        Op::Neg => negated(a),
        Op::Add | Op::Sub => {
            let mut gradient = a.gradient;
            for (x, y) in gradient.iter_mut().zip(&b.gradient) {
                // An exact zero keeps what it is added to exact.
                let y = if op == Op::Add { *y } else { y.neg() };
                *x = if *x == Interval::ZERO {
                    y
                } else if y == Interval::ZERO {
                    *x
                } else {
                    x.add(y)
                };
            }
            with_norm(gradient, a.norm + b.norm, a.jump | b.jump)
        }
        Op::Min | Op::Max => hull(a, b),
        Op::Abs => {
            let (gradient, norm, jump) = kept(a);
            (gradient.map(|g| g.hull(g.neg())), norm, jump)
        }
        Op::Select => {
            let (gradient, norm, _) = hull(b, c);
            (gradient, norm, true)
        }
        // Constant on each of their pieces.
        Op::Sign | Op::Floor | Op::Ceil | Op::Trunc | Op::Round | Op::Lt | Op::Le | Op::Eq | Op::And | Op::Or | Op::Not | Op::Hash => {
            ([Interval::ZERO; D], 0.0, true)
        }
        _ => {
            let (slopes, own) = slopes(op, ranges, out);
            let mut gradient = [Interval::ZERO; D];
            let (mut norm, mut jump) = (0.0, own);
            for (slope, x) in slopes.iter().zip(arguments).take(usize::from(op.row().arity)) {
                // What does not move adds nothing, however steep.
                if x.norm == 0.0 && !x.jump {
                    continue;
                }
                jump |= x.jump;
                norm += slope.magnitude() * x.norm;
                for (sum, g) in gradient.iter_mut().zip(&x.gradient) {
                    let term = g.mul(*slope);
                    *sum = if *sum == Interval::ZERO { term } else { sum.add(term) };
                }
            }
            if matches!(op, Op::Length2 | Op::Length3 | Op::Length4) {
                // The gradient is a unit vector times the arguments' Jacobian.
                let rows = &arguments[..usize::from(op.row().arity)];
                norm = norm.min(stretch_by_rows(rows));
                if out.lo <= 0.5 * out.hi {
                    norm = norm.min(largest_stretch(rows));
                }
            }
            with_norm(gradient, norm, jump)
        }
    }
}

/// A gradient with the smaller of two bounds of its norm: the one given, and what its components tell.
fn with_norm<const D: usize>(gradient: [Interval; D], norm: f64, jump: bool) -> ([Interval; D], f64, bool) {
    let mut moving = gradient.iter().filter(|g| **g != Interval::ZERO);
    let told = match (moving.next(), moving.next()) {
        (None, _) => 0.0,
        // One component alone keeps its exact size.
        (Some(one), None) => one.magnitude(),
        _ => gradient.iter().map(|g| g.magnitude() * g.magnitude()).sum::<f64>().sqrt() * (1.0 + ROUNDING),
    };
    let norm = if norm.is_nan() { f64::INFINITY } else { norm * (1.0 + ROUNDING) };
    (gradient, norm.min(told), jump)
}

/// Partial derivatives of an operation that is neither a choice nor a step, and whether it may jump itself. `out`: its values.
fn slopes(op: Op, [a, b, c, d]: [Interval; 4], out: Interval) -> ([Interval; 4], bool) {
    const ZERO: Interval = Interval::ZERO;
    const ONE: Interval = Interval::ONE;
    const UNIT: Interval = Interval { lo: -1.0, hi: 1.0 };
    let two = Interval::point(2.0);
    let one = |slope: Interval| ([slope, ZERO, ZERO, ZERO], false);
    // Where the argument is held at a limit the slope is 0.
    let held = |slope: Interval, free: bool| one(if free { slope } else { slope.hull(ZERO) });
    match op {
        Op::Mul => ([b, a, ZERO, ZERO], false),
        Op::Square => one(two.mul(a)),
        Op::Div => ([ONE.div(b), out.div(b).neg(), ZERO, ZERO], b.contains(0.0)),
        Op::Sqrt => held(ONE.div(two.mul(out)), a.lo >= 0.0),
        Op::Exp => held(out, a.hi <= 88.0),
        Op::Log => held(ONE.div(a.max(Interval::point(1e-37))), a.lo >= 1e-37),
        Op::Pow => {
            let power = (Op::Pow.row().interval)([a, b.sub(ONE), ZERO, ZERO]);
            let log = (Op::Log.row().interval)([a, ZERO, ZERO, ZERO]);
            let free = a.lo > 0.0 && out.hi < 1e30;
            let (by_a, by_b) = (b.mul(power), out.mul(log));
            let limit = |slope: Interval| if free { slope } else { slope.hull(ZERO) };
            ([limit(by_a), limit(by_b), ZERO, ZERO], a.lo <= 0.0 && b.lo <= 0.0)
        }
        Op::Sin => one(a.cos()),
        Op::Cos => one(a.sin().neg()),
        Op::Asin | Op::Acos => {
            let slope = ONE.div(ONE.sub(a.square()).sqrt());
            held(if op == Op::Asin { slope } else { slope.neg() }, a.magnitude() <= 1.0)
        }
        Op::Atan => one(ONE.div(ONE.add(a.square()))),
        Op::Atan2 => {
            let square = a.square().add(b.square());
            ([b.div(square), a.div(square).neg(), ZERO, ZERO], b.lo <= 0.0 && a.contains(0.0))
        }
        Op::Tanh => held(ONE.sub(out.square()), a.magnitude() <= 10.0),
        Op::Length2 | Op::Length3 | Op::Length4 => {
            let part = |x: Interval| if out == ZERO { UNIT } else { x.div(out).intersect(UNIT) };
            ([part(a), part(b), part(c), part(d)], false)
        }
        Op::TurnU | Op::TurnV => {
            let (cosine, sine) = (c.cos(), c.sin());
            let by = |op: Op| (op.row().interval)([a, b, c, ZERO]);
            if op == Op::TurnU {
                ([cosine, sine.neg(), by(Op::TurnV).neg(), ZERO], false)
            } else {
                ([sine, cosine, by(Op::TurnU), ZERO], false)
            }
        }
        Op::Sampled => {
            let by = |op: Op| (op.row().interval)([a, b, c, d]);
            ([ZERO, by(Op::SampledX), by(Op::SampledY), by(Op::SampledZ)], false)
        }
        Op::Outlined => {
            let by = |op: Op| (op.row().interval)([a, b, c, d]);
            ([ZERO, by(Op::OutlinedX), by(Op::OutlinedY), ZERO], false)
        }
        Op::Figured => {
            let by = |op: Op| (op.row().interval)([a, b, c, d]);
            ([ZERO, by(Op::FiguredX), by(Op::FiguredY), by(Op::FiguredZ)], false)
        }
        // The others are told apart before.
        _ => ([Interval::ALL; 4], true),
    }
}

/// A bound of the largest singular value of the matrix whose rows are gradients: exact where they are surely at right angles, however
/// little is known of their directions. None of the eigenvalues of the rows' products is larger than the largest sum of a row's
/// absolute values.
fn stretch_by_rows<const D: usize>(rows: &[&Slot<D>]) -> f64 {
    let product = |a: &Slot<D>, b: &Slot<D>| {
        let sum = a.gradient.iter().zip(&b.gradient).fold(Interval::ZERO, |s, (x, y)| s.add(x.mul(*y)));
        sum.magnitude().min(a.norm * b.norm)
    };
    let mut most = 0.0_f64;
    for (i, a) in rows.iter().enumerate() {
        let others = rows.iter().enumerate().filter(|(j, _)| *j != i);
        most = most.max(a.norm * a.norm + others.map(|(_, b)| product(a, b)).sum::<f64>());
    }
    // Nothing finite is known where a norm is not.
    if most.is_finite() { most.sqrt() * (1.0 + ROUNDING) } else { f64::INFINITY }
}

/// A bound of the largest singular value of the matrix whose rows are gradients.
fn largest_stretch<const D: usize>(rows: &[&Slot<D>]) -> f64 {
    // The largest eigenvalue of the D x D matrix of the products of columns.
    let mut middle = [[0.0; 3]; 3];
    let (mut spread, mut rounding, mut rows_sum) = (0.0, 0.0, 0.0_f64);
    for (i, into) in middle.iter_mut().enumerate().take(D) {
        let mut row = 0.0;
        for (j, into) in into.iter_mut().enumerate().take(D) {
            let sum = rows.iter().fold(Interval::ZERO, |s, x| s.add(x.gradient[i].mul(x.gradient[j])));
            if !sum.is_finite() {
                return f64::INFINITY;
            }
            *into = sum.middle();
            let half = sum.width() / 2.0;
            spread += half * half;
            rounding += sum.magnitude();
            row += sum.magnitude();
        }
        rows_sum = rows_sum.max(row);
    }
    let eigenvalue = largest_eigenvalue(&middle) + spread.sqrt() + 1e-7 * rounding;
    // No eigenvalue is larger than the largest sum of a row's absolute values: exact where the columns are orthogonal.
    eigenvalue.min(rows_sum).max(0.0).sqrt() * (1.0 + ROUNDING)
}

/// The largest eigenvalue of a symmetric matrix, to about 1e-8 of its size where two are nearly equal (O. K. Smith, "Eigenvalues of a symmetric 3 × 3 matrix",
/// Communications of the ACM 4(4), 1961).
fn largest_eigenvalue(m: &[[f64; 3]; 3]) -> f64 {
    let mean = (m[0][0] + m[1][1] + m[2][2]) / 3.0;
    let off = m[0][1] * m[0][1] + m[0][2] * m[0][2] + m[1][2] * m[1][2];
    let diagonal = (0..3).map(|i| (m[i][i] - mean) * (m[i][i] - mean)).sum::<f64>();
    let p = ((diagonal + 2.0 * off) / 6.0).sqrt();
    if p <= 1e-300 {
        return mean;
    }
    let b = |i: usize, j: usize| (m[i][j] - if i == j { mean } else { 0.0 }) / p;
    let determinant = b(0, 0) * (b(1, 1) * b(2, 2) - b(1, 2) * b(2, 1)) - b(0, 1) * (b(1, 0) * b(2, 2) - b(1, 2) * b(2, 0))
        + b(0, 2) * (b(1, 0) * b(2, 1) - b(1, 1) * b(2, 0));
    mean + 2.0 * p * ((determinant / 2.0).clamp(-1.0, 1.0).acos() / 3.0).cos()
}
