//! Heights above what is very large, without a loss of digits.

use crate::emit::body::Body;
use crate::emit::code::ExprId;
use crate::graph::kernel::Op;
use crate::graph::simplify::Terms;
use smallvec::SmallVec;

/// Numbers whose squares differ by no more than this part cancel each other where coordinates are small.
const NEAR: f64 = 0.5;

impl Body {
    /// A number that is moved by a constant, up to its sign, and by how much.
    pub(super) fn moved(&self, id: ExprId) -> (ExprId, f64) {
        let constant = |id: ExprId| self.as_constant(id);
        match self.operation(id) {
            Some((Op::Add, &[x, c])) if let Some(c) = constant(c) => (x, c),
            Some((Op::Add, &[c, x])) if let Some(c) = constant(c) => (x, c),
            Some((Op::Sub, &[x, c])) if let Some(c) = constant(c) => (x, -c),
            Some((Op::Sub, &[c, x])) if let Some(c) = constant(c) => (x, -c),
            _ => (id, 0.0),
        }
    }

    /// `a - r` for a large r and what is about as large where coordinates are small, so that 32 bits lose the difference: as a formula in which nothing
    /// cancels, and all that is constant is computed in 64 bits. Of a length `|x + c| - r = (|x|² + 2 x·c + |c|² - r²) / (|x + c| + r)`, above and below over
    /// 2 r; of a size `|x + c| - r = max(x + (c - r), -(x + (c + r)))`. None of anything else.
    pub(super) fn height(&mut self, a: ExprId, r: f64) -> Option<ExprId> {
        let is_near = |square: f64| (square - r * r).abs() < NEAR * r * r;
        if let Some((Op::Abs, &[x])) = self.operation(a) {
            let (x, c) = self.moved(x);
            let [near, far] = Some([c - r, c + r]).filter(|_| is_near(c * c))?.map(|c| self.constant(c));
            let above = self.op(Op::Add, &[x, near]);
            let below = self.op(Op::Add, &[x, far]);
            let below = self.op(Op::Neg, &[below]);
            return Some(self.op(Op::Max, &[above, below]));
        }
        let args = self.far_lengths.iter().find(|(length, _)| *length == a)?.1.clone();
        let moved: SmallVec<[(ExprId, f64); 4]> = args.iter().map(|arg| self.moved(*arg)).collect();
        let square: f64 = moved.iter().map(|(_, c)| c * c).sum();
        if !is_near(square) {
            return None;
        }
        let part = self.constant(0.5 / r);
        let mut sum = self.constant(0.0);
        for &(x, _) in &moved {
            let square = self.op(Op::Square, &[x]);
            sum = self.op(Op::Add, &[sum, square]);
        }
        sum = self.op(Op::Mul, &[sum, part]);
        for &(x, c) in &moved {
            let along = self.constant(c / r);
            let along = self.op(Op::Mul, &[along, x]);
            sum = self.op(Op::Add, &[sum, along]);
        }
        let rest = moved.iter().fold(-r * r, |rest, (_, c)| rest + c * c);
        let rest = self.constant(rest * (0.5 / r));
        let above = self.op(Op::Add, &[sum, rest]);
        let below = self.op(Op::Mul, &[a, part]);
        let half = self.constant(0.5);
        let below = self.op(Op::Add, &[below, half]);
        Some(self.op(Op::Div, &[above, below]))
    }
}
