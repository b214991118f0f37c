//! What the kernel's derivatives and quotients are over intervals, where more is known than their formulas say.

use crate::graph::algebra::Intervals;
use crate::graph::interval::Interval;
use crate::graph::kernel::{EXP_LIMIT, LOG_LEAST, Op};
use crate::graph::partials::partials;

/// The partial derivatives of an operation. What is cut off, a power of e at its greatest and a logarithm at its least, does not change there.
pub(super) fn slopes(op: Op, values: &[Interval], value: Interval) -> [Interval; 4] {
    let mut slopes = partials(&mut Intervals, op, values, value);
    let a = values.first().copied().unwrap_or(Interval::ALL);
    let is_cut = match op {
        Op::Exp => a.hi >= EXP_LIMIT,
        Op::Log => a.lo <= LOG_LEAST,
        _ => false,
    };
    if let (Some(slope), true) = (slopes.first_mut(), is_cut) {
        let a = a.intersect(Interval::new(LOG_LEAST, f64::INFINITY));
        *slope = match op {
            Op::Log if a.is_empty() => Interval::ZERO,
            Op::Log => Interval::ONE.div(a).hull(Interval::ZERO),
            _ => slope.hull(Interval::ZERO),
        };
    }
    slopes
}

/// All quotients of numbers of one sign by what is hardly ever zero: that one over zero counts as zero is met by chance alone.
pub(super) fn quotient_of_positive(a: Interval, b: Interval) -> Interval {
    let one_sign = a.lo > 0.0 || a.hi < 0.0;
    if b.lo < 0.0 || !b.contains(0.0) || !one_sign {
        return Interval::ALL;
    }
    a.div(Interval::new(f64::from_bits(1), b.hi))
}
