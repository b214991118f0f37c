//! Choices that come to the same where they change over: `if a < b { x } else { y }` with x - y a multiple of a - b, as in every fold that swaps
//! coordinates. They kink there and do not jump.

use crate::analysis::tape::{Step, Tape};
use crate::graph::kernel::Op;
use smallvec::SmallVec;

/// A sum of steps with factors; the constant is that of a step that there is not.
type Linear = SmallVec<[(usize, f64); 8]>;

/// No step.
const NONE: usize = usize::MAX;
/// A sum of more terms counts as none.
const MOST_TERMS: usize = 32;
/// Factors that are so much the same, for their size, are.
const SAME: f64 = 1e-12;

impl Tape {
    /// Of a choice between numbers that is the same on both sides of where it changes over, what is compared: where that jumps itself, the choice may
    /// too.
    pub fn meets(&self, step: usize) -> Option<[usize; 2]> {
        let Some(Step::Op(Op::Select, args)) = self.steps.get(step) else { return None };
        let &[condition, x, y] = args.as_slice() else { return None };
        let condition = match self.steps.get(condition) {
            Some(Step::Op(Op::Not, args)) => args.first().copied().unwrap_or(condition),
            _ => condition,
        };
        let Some(Step::Op(Op::Lt | Op::Le, args)) = self.steps.get(condition) else { return None };
        let &[a, b] = args.as_slice() else { return None };
        let (compared, chosen) = (self.linear(&[(a, 1.0), (b, -1.0)])?, self.linear(&[(x, 1.0), (y, -1.0)])?);
        let of = |form: &Linear, step: usize| form.iter().find(|(s, _)| *s == step).map_or(0.0, |(_, f)| *f);
        let &(first, factor) = compared.iter().find(|(step, factor)| *step != NONE && *factor != 0.0)?;
        let times = of(&chosen, first) / factor;
        let same = compared.iter().chain(&chosen).all(|&(step, _)| {
            let (is, should) = (of(&chosen, step), times * of(&compared, step));
            (is - should).abs() <= SAME * (is.abs() + should.abs())
        });
        same.then_some([a, b])
    }

    /// Whether multiples of steps add up to zero, by the way they are written.
    pub(in crate::analysis) fn cancels(&self, multiples: &[(usize, f64)]) -> bool {
        let largest = |of: &[(usize, f64)]| Some(self.linear(of)?.iter().map(|(_, factor)| factor.abs()).fold(0.0, f64::max));
        // The terms by themselves tell what rounding may leave of their sum.
        let terms = multiples.iter().map(|one| largest(std::slice::from_ref(one)));
        let size = terms.reduce(|a, b| Some(f64::max(a?, b?))).flatten();
        largest(multiples).zip(size).is_some_and(|(left, size)| left <= SAME * size)
    }

    /// Multiples of steps as a sum of multiples of steps that are none. None where it is long.
    fn linear(&self, multiples: &[(usize, f64)]) -> Option<Linear> {
        let mut sum = Linear::new();
        let mut open: SmallVec<[(usize, f64); 8]> = multiples.iter().copied().collect();
        let mut left = MOST_TERMS;
        while let Some((step, factor)) = open.pop() {
            left = left.checked_sub(1)?;
            let constant = |a: usize| self.constant(a);
            let known = self.steps.get(step)?;
            let (key, by) = match known {
                Step::Constant(c) => (NONE, factor * c),
                Step::Op(op, args) => match (op, args.as_slice()) {
                    (Op::Add | Op::Sub, &[a, b]) => {
                        open.extend([(a, factor), (b, if *op == Op::Add { factor } else { -factor })]);
                        continue;
                    }
                    (Op::Neg, &[a]) => {
                        open.push((a, -factor));
                        continue;
                    }
                    (Op::Mul, &[a, b]) => match (constant(a), constant(b)) {
                        (Some(c), _) => {
                            open.push((b, factor * c));
                            continue;
                        }
                        (_, Some(c)) => {
                            open.push((a, factor * c));
                            continue;
                        }
                        _ => (step, factor),
                    },
                    (Op::Div, &[a, b]) if let Some(c) = constant(b).filter(|c| *c != 0.0) => {
                        open.push((a, factor / c));
                        continue;
                    }
                    _ => (step, factor),
                },
                _ => (step, factor),
            };
            match sum.iter_mut().find(|(known, _)| *known == key) {
                Some((_, known)) => *known += by,
                None => sum.push((key, by)),
            }
        }
        Some(sum)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]
mod tests {
    use crate::diagnostic::Code;
    use crate::{MemoryLoader, Options, compile};

    /// Whether a formula is said to jump.
    fn jumps(formula: &str) -> bool {
        let text = format!("field f = {formula}\nscene = f.within(box(4))");
        let outcome = compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options { strict: true, ..Options::default() });
        assert!(outcome.compiled.is_some(), "{formula}");
        outcome.diagnostics.iter().any(|d| d.code == Code::Jump)
    }

    #[test]
    fn choices_that_meet_do_not_jump() {
        for meets in [
            "if p.x < 0 { length(p + (p.x, 0, 0)) } else { length(p + (p.x, 0, 0)) } - 1",
            "length(if p.x + p.y < 0 { (-p.y, -p.x, p.z) } else { p }) - 1",
            "length(if !(p.x < 0.3 * p.y) { p } else { p - 2 * (p.x - 0.3 * p.y, 0, 0) }) - 1",
            "p.y + (if 2 * p.x <= 1 { 3 * p.x } else { p.x + 1 })",
            "p.y + (if p.x > 0 { p.x / 2 } else { 0 })",
            // What is compared jumps itself, but the whole does not.
            "p.y - { let t = fract(0.4 * p.x); let s = if t < 0.7 { t / 0.7 } else { (1 - t) / 0.3 }; s * s * (3 - 2 * s) }",
        ] {
            assert!(!jumps(meets), "{meets}");
        }
        for jumping in [
            "length(if p.x + p.y < 0 { (-p.y, p.x, p.z) } else { p }) - 1",
            "p.y + (if 2 * p.x <= 1 { 3 * p.x } else { p.x + 1.01 })",
            "p.y + (if p.x < p.z { p.x } else { -p.z })",
            // What is compared jumps itself.
            "p.y + (if floor(p.x) < 0.5 { floor(p.x) } else { 0.5 })",
        ] {
            assert!(jumps(jumping), "{jumping}");
        }
    }
}
