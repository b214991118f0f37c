//! Angles that jump by whole turns: what is made of their sine or cosine does not jump.

use super::dual::Dual;
use super::tape::{Step, Tape};
use crate::graph::Leaf;
use crate::graph::kernel::Op;
use smallvec::{SmallVec, smallvec};

/// An angle that is put together of more steps counts as one that jumps.
const MOST_STEPS: usize = 32;

/// Whether an operation does not jump although its angle does, as that only jumps by whole turns.
pub(super) fn is_same_after_turns(op: Op, args: &[usize], tape: &Tape, values: &[Dual]) -> bool {
    let Some((&angle, rest)) = args.split_last().filter(|_| matches!(op, Op::Sin | Op::Cos | Op::TurnU | Op::TurnV)) else { return false };
    rest.iter().all(|&a| values.get(a).is_some_and(|d| d.jumps == 0)) && jumps_by_turns(angle, tape, values)
}

/// Whether a step does not jump but by whole turns.
fn jumps_by_turns(step: usize, tape: &Tape, values: &[Dual]) -> bool {
    let is_smooth = |a: usize| values.get(a).is_some_and(|d| d.jumps == 0);
    let mut open: SmallVec<[usize; 8]> = smallvec![step];
    for _ in 0..MOST_STEPS {
        let Some(step) = open.pop() else { return true };
        if is_smooth(step) {
            continue;
        }
        let whole = |a: usize| matches!(tape.steps.get(a), Some(Step::Constant(c)) if c.fract() == 0.0);
        match tape.steps.get(step) {
            // Of the coordinates only an angle jumps, in the place of one.
            Some(Step::Leaf(Leaf::P(_))) => {}
            Some(Step::Op(Op::Atan2, args)) if args.iter().all(|&a| is_smooth(a)) => {}
            Some(Step::Op(Op::Add | Op::Sub | Op::Neg, args)) => open.extend(args.iter().copied()),
            Some(Step::Op(Op::Mul, args)) => match *args.as_slice() {
                [a, b] if whole(b) => open.push(a),
                [a, b] if whole(a) => open.push(b),
                _ => return false,
            },
            _ => return false,
        }
    }
    false
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]
mod tests {
    use crate::diagnostic::Code;
    use crate::{MemoryLoader, Options, compile};

    /// Whether a scene of a formula is said to jump.
    fn jumps(formula: &str) -> bool {
        let text = format!("field f = length(p) - 1 + {formula}\nscene = f.within(box((0.5, 1, 0.5)).translate(-1, 0, 0))");
        let outcome = compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default());
        assert!(outcome.compiled.is_some());
        outcome.diagnostics.iter().any(|d| d.code == Code::Jump)
    }

    #[test]
    fn waves_about_an_axis_do_not_jump() {
        assert!(!jumps("0.02 * sin(6 * atan(p.z, p.x) + 5 * p.y)"));
        assert!(!jumps("0.02 * cos(-atan(p.z, p.x) * 3)"));
        assert!(!jumps("{ let q = rotate((p.x, p.y), 2 * atan(p.z, p.x)); 0.1 * q.x }"));
        // Not a whole number of waves, and not a whole turn.
        assert!(jumps("0.02 * sin(6.5 * atan(p.z, p.x))"));
        assert!(jumps("0.02 * sin(tau * sign(atan(p.z, p.x)) + 0.2 * atan(p.z, p.x))"));
        assert!(jumps("0.02 * sin(6 * atan(p.z - floor(p.y), p.x))"));
        assert!(jumps("0.02 * abs(atan(p.z, p.x) - 1)"));
    }
}
