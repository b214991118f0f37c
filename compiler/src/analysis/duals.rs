//! The algebra of duals.

use super::domain::Pinned;
use super::dual::{Dual, JUMPS_HERE, add};
use super::rules::claims::claimed;
use super::slopes::slopes;
use crate::graph::algebra::Algebra;
use crate::graph::interval::Interval;
use crate::graph::kernel::{self, Op};
use crate::graph::{Claim, Graph};

/// Duals as an algebra. Calls and lengths need to see more than their arguments: see [`super::derivative::run`].
pub struct Duals {
    /// Values of the parameters, where they stand at one.
    pub pinned: Pinned,
}

impl Algebra for Duals {
    type Value = Dual;

    fn constant(&mut self, value: f64) -> Dual {
        Dual::constant(Interval::point(value))
    }

    fn op(&mut self, op: Op, args: &[Dual]) -> Dual {
        let mut values = [Interval::ZERO; 4];
        for (slot, arg) in values.iter_mut().zip(args) {
            *slot = arg.value;
        }
        let values = values.get(..args.len()).unwrap_or(&values);
        let value = kernel::interval(op, values);
        let jumps = args.iter().fold(0, |j, a| j | a.jumps);
        let moving = args.iter().any(|a| a.norm > 0.0);
        if !moving && jumps == 0 {
            return Dual::constant(value);
        }
        match (op, args) {
            (Op::Min | Op::Max, [a, b]) => {
                let (low, high) = (a.value, b.value);
                let first = if op == Op::Min { low.hi < high.lo } else { low.lo > high.hi };
                let second = if op == Op::Min { high.hi < low.lo } else { high.lo > low.hi };
                if first {
                    return Dual { value, ..*a };
                }
                if second {
                    return Dual { value, ..*b };
                }
                let (gradient, norm) = a.hull(*b);
                Dual::new(value, gradient, norm, jumps)
            }
            (Op::Select, [c, a, b]) => {
                if c.value == Interval::ONE {
                    return Dual { value, ..*a };
                }
                if c.value == Interval::ZERO {
                    return Dual { value, ..*b };
                }
                let (gradient, norm) = a.hull(*b);
                Dual::new(value, gradient, norm, jumps)
            }
            (Op::Abs, [a]) => {
                if a.value.lo >= 0.0 {
                    return *a;
                }
                let flipped = Dual { gradient: a.gradient.map(Interval::neg), ..*a };
                if a.value.hi <= 0.0 {
                    return Dual { value, ..flipped };
                }
                let (gradient, norm) = a.hull(flipped);
                Dual::new(value, gradient, norm, jumps)
            }
            (Op::Neg, [a]) => Dual { value, gradient: a.gradient.map(Interval::neg), ..*a },
            (Op::Floor | Op::Ceil | Op::Trunc | Op::Round | Op::Sign, [a]) => {
                let jumped = !value.is_point() && a.norm > 0.0;
                Dual { jumps: jumps | u8::from(jumped), ..Dual::constant(value) }
            }
            (Op::Lt | Op::Le | Op::Eq | Op::Hash | Op::SampledX | Op::SampledY | Op::SampledZ | Op::OutlinedX | Op::OutlinedY | Op::FiguredX | Op::FiguredY | Op::FiguredZ, _) => {
                let jumped = !value.is_point() && moving;
                Dual { jumps: jumps | u8::from(jumped), ..Dual::constant(value) }
            }
            (Op::And | Op::Or | Op::Not, _) => {
                let decided = value.is_point();
                Dual { jumps: if decided { 0 } else { jumps }, ..Dual::constant(value) }
            }
            (Op::TurnU | Op::TurnV, [u, v, t]) => {
                let general = by_partials(op, args, values, value, jumps);
                let reach = u.value.square().add(v.value.square()).sqrt().hi;
                let turned = if t.norm == 0.0 { 0.0 } else { reach * t.norm };
                let norm = u.norm.hypot(v.norm).next_up() + turned;
                Dual::new(value, general.gradient, general.norm.min(norm), jumps)
            }
            _ => {
                let mut dual = by_partials(op, args, values, value, jumps);
                if op == Op::Atan2 {
                    // Turns over where the second is negative and the first changes its sign.
                    let (y, x) = (
                        values.first().copied().unwrap_or(Interval::ALL),
                        values.get(1).copied().unwrap_or(Interval::ALL),
                    );
                    if x.lo <= 0.0 && y.contains(0.0) {
                        dual.jumps |= JUMPS_HERE;
                    }
                }
                dual
            }
        }
    }

    fn claim(&mut self, graph: &Graph, value: Dual, claim: &Claim, of: &[Dual]) -> Dual {
        match claim {
            Claim::Continuous => Dual { jumps: value.jumps & !JUMPS_HERE, ..value },
            Claim::Lipschitz(..) => claimed(graph, &self.pinned, (value, claim), of, |_, norm| norm),
        }
    }
}

fn by_partials(op: Op, args: &[Dual], values: &[Interval], value: Interval, jumps: u8) -> Dual {
    let partials = slopes(op, values, value);
    let mut gradient = [Interval::ZERO; 3];
    let (mut sum, mut squares) = (0.0, 0.0);
    let mut touched = [false; 3];
    let mut apart = true;
    for (arg, partial) in args.iter().zip(partials) {
        let slope = partial.magnitude();
        if arg.norm == 0.0 || slope == 0.0 {
            continue;
        }
        gradient = add(gradient, arg.scaled(partial));
        for (known, g) in touched.iter_mut().zip(&arg.gradient) {
            let here = *g != Interval::ZERO;
            apart &= !(*known && here);
            *known |= here;
        }
        sum += slope * arg.norm;
        squares += (slope * arg.norm).powi(2);
    }
    // Terms that move along different axes are at right angles.
    let norm = if apart { sum.min(squares.sqrt().next_up()) } else { sum };
    Dual::new(value, gradient, norm, jumps)
}
