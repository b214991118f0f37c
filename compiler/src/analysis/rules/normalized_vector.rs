//! Coordinates over their length, as `normalize` makes them, and over its square, as an inversion in a sphere does.
//!
//! With a a vector whose coordinates change by no more than J for each unit of the way, and m at least |a|, each coordinate of a / m lies between -1 and 1;
//! where m is at least |a|², between -1/√m and 1/√m. The map a / |a| changes by J / |a| at most (its derivative is a projection over |a|), and so does
//! a / |a|² by J / |a|² (a mirror over |a|²: an inversion keeps all angles). Where m is kept at some least number, a / m changes by J / m. So in all of these
//! cases the slope is no more than J / m, where a look at the quotient alone adds up two terms of that size that cancel.

use crate::analysis::dual::Dual;
use crate::analysis::tape::{Step, Tape};
use crate::graph::Leaf;
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use smallvec::{SmallVec, smallvec};

/// Sums of more squares are not looked at.
const MOST: usize = 4;
/// What rounding may lead beyond.
const SLACK: f64 = 1e-12;

/// A coordinate of a vector, divided by the vector's length or its square, or by what is kept from falling below some number.
#[derive(Clone, Debug)]
pub(in crate::analysis) struct Direction {
    /// What the coordinate is multiplied by.
    times: f64,
    /// The vector's coordinates.
    among: SmallVec<[usize; MOST]>,
    /// Whether they are coordinates of the point, each another one.
    is_plain: bool,
    /// What it is divided by.
    divisor: usize,
    /// What that is kept from falling below.
    least: Option<usize>,
    /// Whether it is the square of the length.
    is_square: bool,
}

impl Direction {
    /// What a quotient is, if it is such a one.
    pub(in crate::analysis) fn of(tape: &Tape, args: &[usize]) -> Option<Self> {
        let &[x, divisor] = args else { return None };
        let (times, x) = match tape.operation(x) {
            Some((Op::Mul, &[a, b])) if let Some(c) = tape.constant(a) => (c.abs(), b),
            Some((Op::Mul, &[a, b])) if let Some(c) = tape.constant(b) => (c.abs(), a),
            _ => (1.0, x),
        };
        let (of, least) = match tape.operation(divisor) {
            Some((Op::Max, &[a, b])) if vector(tape, a).is_some() => (a, Some(b)),
            Some((Op::Max, &[a, b])) => (b, Some(a)),
            _ => (divisor, None),
        };
        let (among, is_square) = vector(tape, of)?;
        let leaf = |step: &usize| match tape.steps.get(*step) {
            Some(Step::Leaf(Leaf::P(i))) => Some(*i),
            _ => None,
        };
        let leaves: Option<SmallVec<[u8; MOST]>> = among.iter().map(leaf).collect();
        let apart = |leaves: SmallVec<[u8; MOST]>| (1..leaves.len()).all(|i| leaves.iter().take(i).all(|other| leaves.get(i) != Some(other)));
        among.contains(&x).then(|| Self { times, is_plain: leaves.is_some_and(apart), among, divisor, least, is_square })
    }

    /// Its values, of those of all steps before it.
    pub(in crate::analysis) fn values(&self, value: impl Fn(usize) -> Interval) -> Interval {
        let m = value(self.divisor).lo;
        let most = match self.is_square {
            true if m > 0.0 => self.times / m.sqrt(),
            true => return Interval::ALL,
            false => self.times,
        };
        Interval::new(-most, most).grow(SLACK * most)
    }

    /// The quotient with what more is known of it.
    pub(in crate::analysis) fn bound(&self, dual: Dual, of: impl Fn(usize) -> Dual) -> Dual {
        let m = of(self.divisor).value.lo;
        let steady = self.least.is_none_or(|least| of(least).norm == 0.0);
        if m <= 0.0 || !steady {
            return dual;
        }
        let norms = self.among.iter().map(|&a| of(a).norm);
        // Coordinates of the point change across each other.
        let fastest = if self.is_plain { norms.fold(0.0, f64::max) } else { norms.fold(0.0, f64::hypot) };
        let norm = self.times * fastest / m * (1.0 + SLACK);
        if !norm.is_finite() {
            return dual;
        }
        dual.within([Interval::new(-norm, norm); 3], norm)
    }
}

/// The coordinates of which a step is the length, or the square of that.
fn vector(tape: &Tape, step: usize) -> Option<(SmallVec<[usize; MOST]>, bool)> {
    match tape.operation(step)? {
        (Op::Length2 | Op::Length3 | Op::Length4, of) => Some((of.into(), false)),
        (Op::Add, _) => {
            let (mut open, mut found): (SmallVec<[usize; MOST]>, SmallVec<[usize; MOST]>) = (smallvec![step], smallvec![]);
            while let Some(step) = open.pop() {
                match tape.operation(step)? {
                    (Op::Add, of) => open.extend(of.iter().copied()),
                    (Op::Square, &[a]) => found.push(a),
                    (Op::Mul, &[a, b]) if a == b => found.push(a),
                    _ => return None,
                }
                if open.len() + found.len() > MOST {
                    return None;
                }
            }
            Some((found, true))
        }
        _ => None,
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]
mod tests {
    use crate::{MemoryLoader, Options, compile};

    fn factor(text: &str) -> f64 {
        let compiled = compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default()).compiled.unwrap();
        compiled.summary.factor
    }

    #[test]
    fn a_coordinate_over_a_length_is_no_steeper_than_one_over_it() {
        // At most 1 / 0.05 at the sphere where the divisor is kept, in three rows.
        let inverted = factor("warp invert = p / max(dot(p, p), 0.05)\nscene = box(0.3).repeat(0.8).invert.within(sphere(2.5))");
        assert!(inverted >= 20.0 && inverted <= 20.0 * 3f64.sqrt() * 1.001, "{inverted}");
        // The steepest place: 1 + 0.2 / 0.1.
        let bent = factor("field f = length(p) - 1 + 0.2 * p.x / max(0.1, length(p))\nscene = f");
        assert!((2.9..3.01).contains(&bent), "{bent}");
        // What is kept moves, so that it says nothing of the slope alone.
        let moved = factor("field f = length(p) - 1 + 0.2 * p.x / max(0.1 + 0.09 * sin(200 * p.y), length(p))\nscene = f.within(box(3))");
        assert!(moved > 1.0 + 0.2 / 0.01, "{moved}");
        // Nor does the length of another vector.
        let other = factor("field f = length(p) - 1 + 0.2 * p.x / max(0.1, length(p.yz))\nscene = f.within(box(3))");
        assert!(other > 20.0, "{other}");
    }
}
