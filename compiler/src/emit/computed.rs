//! Finds what of a function depends on parameters and time alone.

use crate::emit::body::Body;
use crate::emit::code::{Code, ExprId, Outside, Read};
use crate::emit::error::EmitError;
use crate::emit::formulas::Formulas;
use crate::emit::library::LEAST_DIVISOR;
use crate::graph::kernel::Op;
use crate::graph::narrow;
use crate::graph::simplify::Terms;

/// No more values than this: what a module could read of them fits into the smallest uniform block that a device may offer, 64 KiB
/// (WebGPU § 3.6.2), beside the parameters. Further ones are computed in the shader.
const MOST: usize = 3000;

impl Body {
    /// What is read from outside: a number.
    pub fn outside(&mut self, outside: &dyn Outside, read: Read) -> Result<ExprId, EmitError> {
        let (field, components, i) = outside.uniform(read)?;
        if let Some(formulas) = &mut self.formulas {
            formulas.note(read, field, i, outside.range(field, i));
        }
        let whole = self.add(Code::Uniform(field, components), &[]);
        Ok(if components == 1 { whole } else { self.component(whole, i) })
    }

    /// The field of the uniform block that an operation is, where its arguments depend on parameters and time alone. A sign costs a
    /// shader nothing, and a comparison of two numbers no more than reading what came of it.
    pub(super) fn computed(&mut self, op: Op, args: &[ExprId]) -> Option<ExprId> {
        // Where nothing was read that is live, nothing can be computed from it.
        if self.formulas.as_ref().is_none_or(|f| f.leaves.is_empty()) {
            return None;
        }
        // Random numbers are made as the shader makes them, or a host would have to do the same.
        if matches!(op, Op::Neg | Op::Lt | Op::Le | Op::Eq | Op::Hash) || !args.iter().all(|&a| self.is_live(a)) {
            return None;
        }
        if args.iter().all(|&a| self.as_constant(a).is_some()) {
            return None;
        }
        let mut terms = [0; 4];
        for (slot, &arg) in terms.iter_mut().zip(args) {
            *slot = self.term(arg)?;
        }
        let term = self.formulas.as_mut()?.op(op, terms);
        self.computed_field(&[term])
    }

    /// The same for the vector of some numbers, at least one of which is such an operation.
    pub(super) fn computed_vector(&mut self, parts: &[ExprId]) -> Option<ExprId> {
        if !parts.iter().any(|&p| matches!(self.code(p), Code::Computed(..))) {
            return None;
        }
        let mut terms = [0; 4];
        for (slot, &part) in terms.iter_mut().zip(parts) {
            *slot = self.term(part)?;
        }
        self.computed_field(terms.get(..parts.len())?)
    }

    /// Of a division by a number or by what is live: what is divided, and one over the other, which is computed once. That is at least as
    /// accurate as a shader's division, which may err by 2.5 units in the last place (WGSL § 15.7.4).
    pub(super) fn reciprocal(&mut self, args: &[ExprId]) -> Option<(ExprId, ExprId)> {
        let &[above, below] = args else { return None };
        if let Some(c) = self.as_constant(below) {
            let once = narrow(1.0 / f64::from(narrow(c)));
            return (narrow(c) != 0.0 && once != 0.0).then(|| (above, self.constant(once.into())));
        }
        let term = self.term(below)?;
        let range = *self.formulas.as_ref()?.ranges.get(term as usize)?;
        // Nearer to zero it might leave what 32 bits hold.
        if range.mignitude() < LEAST_DIVISOR {
            return None;
        }
        let one = self.constant(1.0);
        Some((above, self.computed(Op::Div, &[one, below])?))
    }

    fn computed_field(&mut self, terms: &[u32]) -> Option<ExprId> {
        let formulas = self.formulas.as_mut().filter(|f| f.fields.len() < MOST)?;
        let field = formulas.field(terms);
        Some(self.add(Code::Computed(field, terms.len() as u8), &[]))
    }

    /// Whether a number depends on nothing but parameters, time and factors.
    fn is_live(&self, id: ExprId) -> bool {
        let args = self.arguments(id);
        match self.code(id) {
            Code::Constant(_) | Code::Uniform(..) | Code::Computed(..) => true,
            Code::Component(_) | Code::Op(Op::Neg | Op::Lt | Op::Le | Op::Eq) => args.iter().all(|&a| self.is_live(a)),
            _ => false,
        }
    }

    /// The term that a number is, where it depends on parameters and time alone.
    fn term(&mut self, id: ExprId) -> Option<u32> {
        let (code, args) = (self.code(id), self.arguments(id));
        let leaf = |formulas: &Option<Formulas>, field, i| formulas.as_ref()?.leaves.get(&(field, i)).copied();
        match code {
            Code::Constant(bits) => Some(self.formulas.as_mut()?.constant(bits)),
            Code::Uniform(field, 1) => leaf(&self.formulas, field, 0),
            Code::Computed(field, 1) => self.formulas.as_ref()?.term_of(field, 0),
            Code::Component(i) => match self.code(*args.first()?) {
                Code::Uniform(field, _) => leaf(&self.formulas, field, i),
                Code::Computed(field, _) => self.formulas.as_ref()?.term_of(field, i),
                _ => None,
            },
            Code::Op(op @ (Op::Neg | Op::Lt | Op::Le | Op::Eq)) => {
                let mut terms = [0; 4];
                let of = [0, 1].map(|i| args.get(i).copied());
                for (slot, arg) in terms.iter_mut().zip(of.into_iter().flatten()) {
                    *slot = self.term(arg)?;
                }
                Some(self.formulas.as_mut()?.op(op, terms))
            }
            _ => None,
        }
    }
}
