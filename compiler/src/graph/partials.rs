//! The partial derivatives of the kernel's operations, once for every algebra.

use crate::graph::algebra::Algebra;
use crate::graph::kernel::Op;

/// The partial derivatives of an operation by each of its arguments and zeros beyond, in any algebra. `out` is the operation's own value. Of an
/// operation that jumps: of its pieces. Of `min`, `max`, `abs` and `select`: of the branch taken.
pub fn partials<A: Algebra>(
    algebra: &mut A,
    op: Op,
    args: &[A::Value],
    out: A::Value,
) -> [A::Value; 4] {
    let zero = algebra.constant(0.0);
    let one = algebra.constant(1.0);
    let arg = |i: usize| args.get(i).cloned().unwrap_or_else(|| zero.clone());
    let (a, b, c) = (arg(0), arg(1), arg(2));
    let pad = zero.clone();
    match op {
        Op::Add => few([one.clone(), one], &pad),
        Op::Sub => {
            let minus = algebra.constant(-1.0);
            few([one, minus], &pad)
        }
        Op::Mul => few([b, a], &pad),
        Op::Square => {
            let twice = algebra.constant(2.0);
            few([algebra.op(Op::Mul, &[twice, a])], &pad)
        }
        Op::Div => {
            let by_a = algebra.op(Op::Div, &[one, b.clone()]);
            let slope = algebra.op(Op::Div, &[out, b]);
            let by_b = algebra.op(Op::Neg, &[slope]);
            few([by_a, by_b], &pad)
        }
        Op::Neg => few([algebra.constant(-1.0)], &pad),
        Op::Min => {
            let first = algebra.op(Op::Le, &[a, b]);
            let by_a = algebra.op(Op::Select, &[first.clone(), one.clone(), zero.clone()]);
            let by_b = algebra.op(Op::Select, &[first, zero, one]);
            few([by_a, by_b], &pad)
        }
        Op::Max => {
            let first = algebra.op(Op::Lt, &[a, b]);
            let by_a = algebra.op(Op::Select, &[first.clone(), zero.clone(), one.clone()]);
            let by_b = algebra.op(Op::Select, &[first, one, zero]);
            few([by_a, by_b], &pad)
        }
        Op::Abs => {
            let below = algebra.op(Op::Lt, &[a, zero]);
            let minus = algebra.constant(-1.0);
            few([algebra.op(Op::Select, &[below, minus, one])], &pad)
        }
        Op::Sqrt => {
            let twice = algebra.constant(2.0);
            let below = algebra.op(Op::Mul, &[twice, out]);
            few([algebra.op(Op::Div, &[one, below])], &pad)
        }
        Op::Exp => few([out], &pad),
        Op::Log => few([algebra.op(Op::Div, &[one, a])], &pad),
        Op::Pow => {
            let less = algebra.op(Op::Sub, &[b.clone(), one]);
            let power = algebra.op(Op::Pow, &[a.clone(), less]);
            let by_a = algebra.op(Op::Mul, &[b, power]);
            let log = algebra.op(Op::Log, &[a]);
            let by_b = algebra.op(Op::Mul, &[out, log]);
            few([by_a, by_b], &pad)
        }
        Op::Sin => few([algebra.op(Op::Cos, &[a])], &pad),
        Op::Cos => {
            let sine = algebra.op(Op::Sin, &[a]);
            few([algebra.op(Op::Neg, &[sine])], &pad)
        }
        Op::Asin | Op::Acos => {
            let square = algebra.op(Op::Square, &[a]);
            let rest = algebra.op(Op::Sub, &[one.clone(), square]);
            let root = algebra.op(Op::Sqrt, &[rest]);
            let slope = algebra.op(Op::Div, &[one, root]);
            few([if op == Op::Asin { slope } else { algebra.op(Op::Neg, &[slope]) }], &pad)
        }
        Op::Atan => {
            let square = algebra.op(Op::Square, &[a]);
            let below = algebra.op(Op::Add, &[one.clone(), square]);
            few([algebra.op(Op::Div, &[one, below])], &pad)
        }
        Op::Atan2 => {
            let aa = algebra.op(Op::Square, std::slice::from_ref(&a));
            let bb = algebra.op(Op::Square, std::slice::from_ref(&b));
            let square = algebra.op(Op::Add, &[aa, bb]);
            let by_a = algebra.op(Op::Div, &[b, square.clone()]);
            let slope = algebra.op(Op::Div, &[a, square]);
            let by_b = algebra.op(Op::Neg, &[slope]);
            few([by_a, by_b], &pad)
        }
        Op::Tanh => {
            let square = algebra.op(Op::Square, &[out]);
            few([algebra.op(Op::Sub, &[one, square])], &pad)
        }
        Op::Length2 | Op::Length3 | Op::Length4 => {
            let mut slopes = few([], &pad);
            for (slope, x) in slopes.iter_mut().zip(args) {
                *slope = algebra.op(Op::Div, &[x.clone(), out.clone()]);
            }
            slopes
        }
        Op::TurnU => {
            let by_u = algebra.op(Op::Cos, std::slice::from_ref(&c));
            let sine = algebra.op(Op::Sin, std::slice::from_ref(&c));
            let by_v = algebra.op(Op::Neg, &[sine]);
            let other = algebra.op(Op::TurnV, &[a, b, c]);
            let by_t = algebra.op(Op::Neg, &[other]);
            few([by_u, by_v, by_t], &pad)
        }
        Op::TurnV => {
            let by_u = algebra.op(Op::Sin, std::slice::from_ref(&c));
            let by_v = algebra.op(Op::Cos, std::slice::from_ref(&c));
            let by_t = algebra.op(Op::TurnU, &[a, b, c]);
            few([by_u, by_v, by_t], &pad)
        }
        Op::Select => {
            let by_b = algebra.op(Op::Select, &[a.clone(), one.clone(), zero.clone()]);
            let by_c = algebra.op(Op::Select, &[a, zero.clone(), one]);
            few([zero, by_b, by_c], &pad)
        }
        Op::Sampled => {
            let [x, y, z] = [Op::SampledX, Op::SampledY, Op::SampledZ].map(|op| algebra.op(op, args));
            few([zero, x, y, z], &pad)
        }
        Op::Outlined => {
            let [x, y] = [Op::OutlinedX, Op::OutlinedY].map(|op| algebra.op(op, args));
            few([zero, x, y], &pad)
        }
        Op::Figured => {
            let [x, y, z] = [Op::FiguredX, Op::FiguredY, Op::FiguredZ].map(|op| algebra.op(op, args));
            few([zero, x, y, z], &pad)
        }
        // What jumps from cell to cell, or where another piece is nearest, is no curvature: who asks for one is told of the jumps.
        Op::SampledX | Op::SampledY | Op::SampledZ | Op::OutlinedX | Op::OutlinedY | Op::FiguredX | Op::FiguredY | Op::FiguredZ => few([], &pad),
        // Constant on each of their pieces.
        Op::Sign | Op::Floor | Op::Ceil | Op::Trunc | Op::Round | Op::Lt | Op::Le | Op::Eq | Op::And
        | Op::Or | Op::Not | Op::Hash => few([], &pad),
    }
}

/// Up to four values, and `pad` for those that are not there.
fn few<V: Clone, const N: usize>(values: [V; N], pad: &V) -> [V; 4] {
    let mut values = values.into_iter();
    std::array::from_fn(|_| values.next().unwrap_or_else(|| pad.clone()))
}
