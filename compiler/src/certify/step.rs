//! One step of a code, and what becomes of it where its arguments are known.

// The arguments of an operation are as many as its row says.
#![allow(clippy::indexing_slicing)]

use crate::certify::form::Form;
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;

/// One step. Its value is known by its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Step {
    /// A component of the argument: of the point, or the ray's parameter.
    Input(u8),
    /// A number.
    Constant(f64),
    /// An operation on the values of earlier steps.
    Op(Op, [u32; 4]),
    /// The value of its first argument, of which more is known by the others.
    Form(Form, [u32; 4]),
}

/// What becomes of an operation whose arguments are known to lie in some intervals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Known {
    /// One of its arguments, as it is.
    Argument(usize),
    /// Its first argument, negated.
    Negated,
    /// A number.
    Constant(f64),
    /// Nothing simpler.
    Open,
}

/// What becomes of an operation. `out`: its own values.
pub(super) fn known(op: Op, arguments: [Interval; 4], out: Interval) -> Known {
    let [a, b, c, d] = arguments;
    match op {
        Op::Min if a.hi <= b.lo => Known::Argument(0),
        Op::Min if b.hi <= a.lo => Known::Argument(1),
        Op::Max if a.lo >= b.hi => Known::Argument(0),
        Op::Max if b.lo >= a.hi => Known::Argument(1),
        Op::Abs if a.lo >= 0.0 => Known::Argument(0),
        Op::Abs if a.hi <= 0.0 => Known::Negated,
        Op::Select if a == Interval::ONE => Known::Argument(1),
        Op::Select if a == Interval::ZERO => Known::Argument(2),
        Op::Length2 | Op::Length3 | Op::Length4 => {
            let all = [a, b, c, d];
            let arity = usize::from(op.row().arity);
            let mut open = (0..arity).filter(|&i| all[i] != Interval::ZERO);
            match (open.next(), open.next()) {
                // The only component that is not zero.
                (Some(i), None) if all[i].lo >= 0.0 => Known::Argument(i),
                (Some(0), None) if all[0].hi <= 0.0 => Known::Negated,
                _ => Known::Open,
            }
        }
        // What takes only certain values is known where it takes one.
        Op::Lt | Op::Le | Op::Eq | Op::And | Op::Or | Op::Not | Op::Sign | Op::Floor | Op::Ceil | Op::Trunc | Op::Round | Op::Hash
            if out.is_point() =>
        {
            Known::Constant(out.lo)
        }
        _ => Known::Open,
    }
}
