//! Intervals with derivatives: all values and all gradients over a box, with a bound of the gradient's norm.
//!
//! The norm is kept beside the components, because `length` has a gradient of norm one though each of its components
//! can reach one, and because a turn by any angle, varying or not, is an isometry.

use super::domain::{Domain, leaf_range};
use crate::graph::interval::Interval;
use crate::graph::kernel::{self, Op};
use crate::graph::{Graph, Leaf, WORLD};

/// Jumps in the formula itself.
pub const JUMPS_HERE: u8 = 1;
/// Jumps in the formula of a shape that it calls.
pub const JUMPS_INSIDE: u8 = 2;

/// All values and gradients over a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual {
    /// All values.
    pub value: Interval,
    /// All components of the gradient, on each piece.
    pub gradient: [Interval; 3],
    /// A bound of the gradient's norm.
    pub norm: f64,
    /// Where it may jump.
    pub jumps: u8,
}

impl Dual {
    /// A value that does not depend on the point.
    pub fn constant(value: Interval) -> Self {
        Self { value, gradient: [Interval::ZERO; 3], norm: 0.0, jumps: 0 }
    }

    /// A value of which nothing else is known.
    pub fn unknown(value: Interval) -> Self {
        Self { value, gradient: [Interval::ALL; 3], norm: f64::INFINITY, jumps: 0 }
    }

    /// A coordinate of the point.
    pub fn coordinate(i: usize, value: Interval) -> Self {
        let mut gradient = [Interval::ZERO; 3];
        if let Some(slot) = gradient.get_mut(i) {
            *slot = Interval::ONE;
        }
        Self { value, gradient, norm: 1.0, jumps: 0 }
    }

    /// With a gradient whose norm is known to be at most `limit`.
    pub fn limited(mut self, limit: f64) -> Self {
        self.norm = self.norm.min(limit);
        let side = Interval::new(-self.norm, self.norm);
        for g in &mut self.gradient {
            *g = g.intersect(side);
            if g.is_empty() {
                *g = side;
            }
        }
        self
    }

    /// The norm as far as the components tell it, rounded up.
    pub(super) fn components_norm(gradient: &[Interval; 3]) -> f64 {
        let sum = gradient.iter().fold(0.0, |s: f64, g| s + g.magnitude() * g.magnitude());
        // One exact component alone keeps its exact norm.
        let mut others = gradient.iter().filter(|g| g.magnitude() > 0.0);
        match (others.next(), others.next()) {
            (None, _) => 0.0,
            (Some(one), None) => one.magnitude(),
            _ => sum.sqrt().next_up(),
        }
    }

    /// With a gradient that is known to be within another one too.
    pub(super) fn within(mut self, gradient: [Interval; 3], norm: f64) -> Self {
        for (own, other) in self.gradient.iter_mut().zip(gradient) {
            let both = own.intersect(other);
            *own = if both.is_empty() { other } else { both };
        }
        self.limited(norm)
    }

    pub(super) fn new(value: Interval, gradient: [Interval; 3], norm: f64, jumps: u8) -> Self {
        let norm = norm.min(Self::components_norm(&gradient));
        Self { value, gradient, norm: if norm.is_nan() { f64::INFINITY } else { norm }, jumps }
    }

    pub(super) fn hull(self, other: Self) -> ([Interval; 3], f64) {
        let mut gradient = self.gradient;
        for (a, b) in gradient.iter_mut().zip(other.gradient) {
            *a = a.hull(b);
        }
        (gradient, self.norm.max(other.norm))
    }

    pub(super) fn scaled(&self, by: Interval) -> [Interval; 3] {
        self.gradient.map(|g| g.mul(by))
    }
}

pub(super) fn add(a: [Interval; 3], b: [Interval; 3]) -> [Interval; 3] {
    let mut sum = a;
    for (x, y) in sum.iter_mut().zip(b) {
        // Zero stays exactly zero, so that independent axes stay so.
        *x = if *x == Interval::ZERO {
            y
        } else if y == Interval::ZERO {
            *x
        } else {
            x.add(y)
        };
    }
    sum
}

/// A leaf as a function of the point of its space.
pub fn leaf_dual(graph: &Graph, pinned: &[f64], leaf: Leaf, domain: &Domain) -> Dual {
    match leaf {
        Leaf::P(i) => Dual::coordinate(usize::from(i), domain.point.axis(usize::from(i))),
        // The scene's point moves with the point of every space, nobody here knows how.
        Leaf::Variable(v) if v < WORLD + 3 => Dual::unknown(domain.variable(v)),
        other => Dual::constant(leaf_range(graph, pinned, other, domain)),
    }
}

/// The side of a kink that is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The first argument of `min` and `max`, the second of `select`, `abs` of what is not negative, an angle above zero.
    First,
    /// The other.
    Second,
}

/// The side of a kink that the values alone decide.
pub(super) fn side_of(op: Op, args: &[Dual]) -> Option<Side> {
    let value = |i: usize| args.get(i).map_or(Interval::ALL, |d| d.value);
    let (a, b) = (value(0), value(1));
    let (first, second) = match op {
        Op::Min => (a.hi <= b.lo, b.hi <= a.lo),
        Op::Max => (a.lo >= b.hi, b.lo >= a.hi),
        Op::Abs => (a.lo >= 0.0, a.hi <= 0.0),
        _ => (a == Interval::ONE, a == Interval::ZERO),
    };
    match (first, second) {
        (true, _) => Some(Side::First),
        (_, true) => Some(Side::Second),
        _ => None,
    }
}

/// The value and gradient on one side of a kink.
pub(super) fn on_side(op: Op, args: &[Dual], side: Side) -> Dual {
    let dual = |i: usize| args.get(i).copied().unwrap_or(Dual::constant(Interval::ALL));
    let first = side == Side::First;
    let jumps = args.iter().fold(0, |j, d| j | d.jumps);
    match op {
        Op::Min | Op::Max => {
            let taken = dual(usize::from(!first));
            let hull = kernel::interval(op, &[dual(0).value, dual(1).value]);
            Dual { value: taken.value.intersect(hull), jumps, ..taken }
        }
        Op::Abs if first => Dual { value: dual(0).value.abs(), ..dual(0) },
        Op::Abs => Dual { value: dual(0).value.abs(), gradient: dual(0).gradient.map(Interval::neg), ..dual(0) },
        _ => Dual { jumps, ..dual(if first { 1 } else { 2 }) },
    }
}

/// A constant of a formula over a domain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constant {
    /// No two values differ by more than this times the distance of their points, on each piece.
    pub lipschitz: f64,
    /// Whether the formula may jump in the domain.
    pub jumps: bool,
}

impl Constant {
    /// Whether it is without jumps and no larger than this.
    pub fn is_within(&self, limit: f64) -> bool {
        self.lipschitz <= limit && !self.jumps
    }
}
