//! What is known of the values of expressions: their signs, and their ranges where a division needs them.

use crate::emit::code::{Code, ExprId};
use crate::emit::library::LEAST_DIVISOR;
use crate::emit::write::writer::Writer;
use crate::graph::interval::Interval;
use crate::graph::kernel::{self, Op};

impl Writer<'_, '_> {
    /// Marks what is below a division, and what that is made of. `order` has arguments first.
    pub(super) fn want_ranges(&mut self, order: &[ExprId]) {
        for &id in order.iter().rev() {
            let args = self.body.arguments(id);
            let wanted = match self.body.code(id) {
                _ if self.state(id).ranged => args,
                Code::Op(Op::Div) | Code::VectorOp(Op::Div, _) => args.get(1..).unwrap_or(&[]),
                _ => &[],
            };
            for &arg in wanted {
                if let Some(state) = self.states.get_mut(arg as usize) {
                    state.ranged = true;
                }
            }
        }
    }

    /// Notes what is known of an expression's value.
    pub(super) fn learn(&mut self, id: ExprId, code: Code, args: &[ExprId]) {
        let known = |a: ExprId| self.state(a).not_negative;
        let not_negative = match code {
            Code::Constant(bits) => f64::from_bits(bits) >= 0.0,
            Code::Uniform(index, 1) => {
                let field = self.context.uniforms.get(index);
                field.and_then(|f| f.ranges.first()).is_some_and(|r| r.lo >= 0.0)
            }
            Code::Computed(field, 1) => self.computed_range(field, 0).lo >= 0.0,
            Code::Op(op) => match op {
                Op::Square | Op::Abs | Op::Sqrt | Op::Exp | Op::Pow | Op::Hash => true,
                Op::Length2 | Op::Length3 | Op::Length4 => true,
                Op::Max => args.iter().any(|&a| known(a)),
                Op::Min | Op::Add | Op::Mul | Op::Div => args.iter().all(|&a| known(a)),
                Op::Select => args.iter().skip(1).all(|&a| known(a)),
                _ => false,
            },
            _ => false,
        };
        if let Some(state) = self.states.get_mut(id as usize) {
            state.not_negative = not_negative;
        }
        if self.state(id).ranged {
            let range = self.range(id);
            if let Some(slot) = self.ranges.get_mut(id as usize) {
                *slot = range;
            }
        }
    }

    fn computed_range(&self, field: u32, i: u8) -> Interval {
        self.body.formulas.as_ref().map_or(Interval::ALL, |f| f.range(field, i))
    }

    fn known_range(&self, id: ExprId) -> Interval {
        self.ranges.get(id as usize).copied().unwrap_or(Interval::ALL)
    }

    fn range(&self, id: ExprId) -> Interval {
        let args = self.body.arguments(id);
        let of = |args: &[ExprId], op: Op| {
            let mut all = [Interval::ALL; 4];
            for (slot, &arg) in all.iter_mut().zip(args) {
                *slot = self.known_range(arg);
            }
            kernel::interval(op, all.get(..args.len().min(4)).unwrap_or(&[]))
        };
        let field = |id: ExprId, i: usize| match self.body.code(id) {
            Code::Uniform(index, _) => {
                let field = self.context.uniforms.get(index);
                field.and_then(|f| f.ranges.get(i)).copied().unwrap_or(Interval::ALL)
            }
            Code::Computed(field, _) => self.computed_range(field, i as u8),
            _ => Interval::ALL,
        };
        match self.body.code(id) {
            Code::Constant(bits) => Interval::point(f64::from_bits(bits)),
            Code::Uniform(_, 1) | Code::Computed(_, 1) => field(id, 0),
            Code::Component(i) => field(self.argument(id, 0), usize::from(i)),
            Code::Op(op @ (Op::Length2 | Op::Length3 | Op::Length4)) => {
                let vector = self.argument(id, 0);
                match self.body.code(vector) {
                    Code::Vector(_) => of(self.body.arguments(vector), op),
                    _ => Interval::new(0.0, f64::INFINITY),
                }
            }
            Code::Op(op) => of(args, op),
            _ => Interval::ALL,
        }
    }

    /// Whether a value is so far from zero, rounding counted, that one may divide by it. `max(d, 1e-30)` is.
    pub(super) fn is_safe_below(&self, id: ExprId) -> bool {
        if let Some(c) = self.as_number(id) {
            return c.abs() >= LEAST_DIVISOR;
        }
        let range = self.known_range(id);
        let least = range.mignitude();
        let of_sum = matches!(self.body.code(id), Code::Op(Op::Add | Op::Sub));
        let cancels = of_sum
            && self.body.arguments(id).iter().any(|&a| {
                // Numbers of one sign can't cancel.
                let arg = self.known_range(a);
                arg.lo < 0.0 && least < 1e-4 * arg.magnitude()
            });
        least >= LEAST_DIVISOR && !cancels && !range.is_empty()
    }
}
