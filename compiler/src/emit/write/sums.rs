//! How large the numbers are that are added: what rounding grows with beside coordinates.

use crate::analysis::Box3;
use crate::emit::body::LARGE;
use crate::emit::code::{Code, ExprId, Outside};
use crate::emit::write::writer::Writer;
use crate::graph::NodeId;
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::simplify::Terms;

/// So large a part of large numbers counts.
const PART: f64 = 0.125;

/// The length of [`crate::interface::Rounding`]: what is added is no larger than `sums`, and what is solid lies in a box.
pub fn unit(sums: f64, solid: Option<Box3>) -> f64 {
    if sums > LARGE {
        return PART * sums;
    }
    let reach = solid.map_or(1.0, |solid| solid.0.map(Interval::magnitude).into_iter().fold(0.0, f64::hypot));
    // A power of two, so that not every edit of a number is another one.
    reach.max(sums).clamp(SMALLEST, 1.0).log2().ceil().exp2()
}

/// No length of [`crate::interface::Rounding`] is smaller.
const SMALLEST: f64 = 1e-12;

impl Writer<'_, '_> {
    /// The largest number that is added to another, as it counts in the result: what makes a formula smaller afterwards makes its rounding smaller. Numbers
    /// that move the point of the scene are none: what moves is as large. Nor is a large one in a sum that is as large at the scene's middle: where
    /// it is zero, coordinates are large. `order`: all expressions, arguments first. With the place of the sum in the graph, where that is known.
    pub(super) fn largest_sum(&self, order: &[ExprId], root: ExprId) -> (f64, Option<NodeId>) {
        let middle = self.at_middle(order);
        let at = |id: ExprId| middle.get(id as usize).copied().unwrap_or([f64::NAN; 4]);
        let mut place = None;
        let mut weights = vec![0.0f64; self.body.len()];
        let mut largest = 0.0f64;
        if let Some(weight) = weights.get_mut(root as usize) {
            *weight = 1.0;
        }
        for &id in order.iter().rev() {
            let weight = weights.get(id as usize).copied().unwrap_or(0.0);
            let args = self.body.arguments(id);
            let op = match self.body.code(id) {
                Code::Op(op) | Code::VectorOp(op, _) => Some(op),
                Code::Call(target) | Code::Batch(target, ..) => {
                    if let Some((sum, of)) = self.context.called.get(&target).filter(|(sum, _)| weight * sum > largest) {
                        (largest, place) = (weight * sum, *of);
                    }
                    None
                }
                _ => None,
            };
            for (i, &arg) in args.iter().enumerate() {
                let other = args.get(1 - i.min(1)).copied().unwrap_or(arg);
                let times = match op {
                    Some(Op::Mul) => self.magnitude(other).unwrap_or(1.0),
                    Some(Op::Div) if i == 0 => self.magnitude(other).filter(|by| *by > 0.0).map_or(1.0, f64::recip),
                    // A divisor is as exact as it is large.
                    Some(Op::Div) if i == 1 => 0.0,
                    Some(Op::Add | Op::Sub) if self.of_scene(other).is_none() => {
                        let size = self.magnitude(arg).map_or(0.0, |size| match size > LARGE {
                            true => cancelled(at(id), at(arg), self.body.components(id), |c| self.is_size(other) && (op == Some(Op::Sub)) == (c > 0.0)),
                            false => size,
                        });
                        if weight * size > largest {
                            largest = weight * size;
                            place = self.body.named(id).or(self.body.named(other));
                        }
                        1.0
                    }
                    _ => 1.0,
                };
                if let Some(known) = weights.get_mut(arg as usize) {
                    *known = known.max(weight * times.min(1.0));
                }
            }
        }
        (largest, place)
    }

    /// Whether something is a length or a size, which is large where its parts are, wherever they are zero.
    fn is_size(&self, id: ExprId) -> bool {
        matches!(self.body.code(id), Code::Op(Op::Length2 | Op::Length3 | Op::Length4 | Op::Sqrt | Op::Abs) | Code::VectorOp(Op::Abs, _))
    }

    /// What each expression is at the scene's middle, by its components; no number where that is not known.
    fn at_middle(&self, order: &[ExprId]) -> Vec<[f64; 4]> {
        let mut values = vec![[f64::NAN; 4]; self.body.len()];
        for &id in order {
            let args = self.body.arguments(id);
            let value = |i: usize| args.get(i).and_then(|arg| values.get(*arg as usize)).copied().unwrap_or([f64::NAN; 4]);
            let component = |of: [f64; 4], i: usize| of.get(i).copied().unwrap_or(f64::NAN);
            let found = match self.body.code(id) {
                Code::Constant(bits) => [f64::from_bits(bits); 4],
                Code::Scene => [0.0; 4],
                Code::Component(i) => [component(value(0), i.into()); 4],
                Code::Swizzle(_, order) => std::array::from_fn(|i| component(value(0), (order >> (4 * i) & 3).into())),
                Code::Vector(_) => std::array::from_fn(|i| component(value(i), 0)),
                Code::Splat(_) => value(0),
                Code::Op(Op::Length2 | Op::Length3 | Op::Length4) => {
                    let count = args.first().map_or(0, |arg| self.body.components(*arg));
                    [value(0).iter().take(count.into()).fold(0.0, |length, c| f64::hypot(length, *c)); 4]
                }
                Code::Op(op) => [(op.row().value)(std::array::from_fn(|i| component(value(i), 0))); 4],
                Code::VectorOp(op, _) => std::array::from_fn(|c| (op.row().value)(std::array::from_fn(|i| component(value(i), c)))),
                _ => [f64::NAN; 4],
            };
            if let Some(slot) = values.get_mut(id as usize) {
                *slot = found;
            }
        }
        values
    }

    /// How large a number is that is the same at all points, as far as its range is known.
    fn magnitude(&self, id: ExprId) -> Option<f64> {
        let args = self.body.arguments(id);
        match self.body.code(id) {
            Code::Constant(_) => self.body.as_constant(id).map(f64::abs),
            Code::Vector(_) | Code::Splat(_) => args.iter().map(|arg| self.magnitude(*arg)).try_fold(0.0, |most, size| Some(f64::max(most, size?))),
            Code::Component(i) => match self.body.code(*args.first()?) {
                Code::Uniform(field, _) => self.within(field, i),
                _ => None,
            },
            Code::Uniform(field, 1) => self.within(field, 0),
            _ => None,
        }
    }

    fn within(&self, field: u32, component: u8) -> Option<f64> {
        let range = self.context.uniforms.range(field, component);
        Some(range.magnitude()).filter(|size| size.is_finite()).map(|size| size.min(LARGE))
    }
}

/// The largest of some numbers that are added, without those of which the sum is as large. `unknown`: whether a number counts of which
/// the sum is not known.
fn cancelled(sum: [f64; 4], added: [f64; 4], components: u8, unknown: impl Fn(f64) -> bool) -> f64 {
    let cancels = |(sum, c): &(f64, f64)| if sum.is_nan() { unknown(*c) } else { sum.abs() < PART * c.abs() };
    sum.into_iter().zip(added).take(components.into()).filter(cancels).fold(0.0, |most, (_, c)| most.max(c.abs()))
}
