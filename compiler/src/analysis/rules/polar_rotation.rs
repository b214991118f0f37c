//! Points that are turned about an axis by way of their angle.
//!
//! With r the length of two numbers, θ their angle and b = ±θ + ρ, the pair (r cos b, r sin b) is those two turned by ρ (and mirrored), though by the
//! chain rule the angle turns infinitely fast at the axis. A turn is an isometry: the pair is no steeper than the two are together, and r |∇ρ| more.
//! Of what folds an angle into a sector (`mod(θ + s/2, s) - s/2`, the magnitude of an angle) ρ only jumps.

use crate::analysis::dual::Dual;
use crate::analysis::matrix::{Row, matrix_norm};
use crate::analysis::tape::Tape;
use crate::graph::kernel::Op;
use smallvec::SmallVec;

/// An angle that is put together by more steps, one in the other, is not looked at.
const DEEPEST: usize = 12;
/// What rounding may lead beyond.
const SLACK: f64 = 1e-12;

/// One of the two numbers.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::analysis) struct Around {
    /// The two that are turned.
    of: [usize; 2],
    /// Their length.
    radius: usize,
    /// The angle of which this is the cosine or the sine.
    angle: usize,
    is_sine: bool,
    /// What is in the angle beside that of the two, each so many times.
    beside: SmallVec<[(usize, f64); 4]>,
}

impl Around {
    /// Of a product of a length and a cosine or a sine.
    pub(in crate::analysis) fn of(tape: &Tape, args: &[usize]) -> Option<Self> {
        let &[a, b] = args else { return None };
        [(a, b), (b, a)].into_iter().find_map(|(radius, wave)| {
            let Some((Op::Length2, &[x, y])) = tape.operation(radius) else { return None };
            let Some((op @ (Op::Cos | Op::Sin), &[angle])) = tape.operation(wave) else { return None };
            let mut beside = SmallVec::new();
            let times = multiple(tape, angle, [x, y], 1.0, &mut beside, DEEPEST)?;
            let whole = (times.abs() - 1.0).abs() < SLACK;
            whole.then_some(Self { of: [x, y], radius, angle, is_sine: op == Op::Sin, beside })
        })
    }

    /// Whether this is the first coordinate of a turned pair and the other its second.
    pub(in crate::analysis) fn is_pair(&self, other: &Self) -> bool {
        !self.is_sine && other.is_sine && self.angle == other.angle && self.radius == other.radius && self.of == other.of
    }

    /// The rows of the pair that is turned.
    pub(in crate::analysis) fn rows(&self, of: impl Fn(usize) -> Dual) -> [Row; 2] {
        self.of.map(|a| (of(a).gradient, of(a).norm))
    }

    /// How fast the pair moves because the angle by which it is turned does.
    pub(in crate::analysis) fn turning(&self, of: impl Fn(usize) -> Dual) -> f64 {
        let slope: f64 = self.beside.iter().map(|(step, times)| times * of(*step).norm).sum();
        if slope == 0.0 { 0.0 } else { of(self.radius).value.magnitude() * slope * (1.0 + SLACK) }
    }

    /// The product with what more is known of it.
    pub(in crate::analysis) fn bound(&self, dual: Dual, of: impl Fn(usize) -> Dual) -> Dual {
        let turning = self.turning(&of);
        let norm = matrix_norm(&self.rows(of)) + turning;
        if norm.is_finite() { dual.limited(norm) } else { dual }
    }
}

/// How many times the angle of two numbers is in a step, and with it what else is, each so many times. None where it is not found, or in no sum.
fn multiple(tape: &Tape, step: usize, of: [usize; 2], times: f64, beside: &mut SmallVec<[(usize, f64); 4]>, deep: usize) -> Option<f64> {
    let deeper = deep.checked_sub(1)?;
    match tape.operation(step)? {
        (Op::Atan2, &[y, x]) => ([x, y] == of || [y, x] == of).then_some(times),
        // The magnitude of an angle mirrors.
        (Op::Neg | Op::Abs, &[a]) => multiple(tape, a, of, times, beside, deeper),
        (Op::Add | Op::Sub, &[a, b]) => {
            let known = beside.len();
            for (one, other) in [(a, b), (b, a)] {
                if let Some(found) = multiple(tape, one, of, times, beside, deeper) {
                    beside.push((other, times.abs()));
                    return Some(found);
                }
                beside.truncate(known);
            }
            None
        }
        (Op::Mul, &[a, b]) => match (tape.constant(a), tape.constant(b)) {
            (Some(c), _) => multiple(tape, b, of, c * times, beside, deeper),
            (_, Some(c)) => multiple(tape, a, of, c * times, beside, deeper),
            _ => None,
        },
        (Op::Div, &[a, b]) => multiple(tape, a, of, times / tape.constant(b)?, beside, deeper),
        _ => None,
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]
mod tests {
    use crate::{MemoryLoader, Options, compile};

    fn factor(angle: &str) -> f64 {
        let text = format!(
            "param turn = 1 in 0..2\nfield f = {{ let a = atan(p.z, p.x); let r = length(p.xz); let b = {angle}; \
             length((r * cos(b), p.y, r * sin(b)) - (1, 0, 0)) - 0.35 }}\nscene = f.within(box(4))"
        );
        let compiled = compile(&MemoryLoader::new().with("main.sdf", &*text), "main.sdf", &Options::default()).compiled.expect(&text);
        compiled.summary.factor
    }

    #[test]
    fn what_is_turned_by_its_angle_keeps_lengths() {
        for angle in [
            "a + 0.3",
            "0.3 - a",
            "a + turn",
            "abs(a)",
            "mod(a + 0.4, 0.8) - 0.4",
            "a - 0.8 * round(a / 0.8)",
            "abs(mod(a + 0.4, 0.8) - 0.4)",
            "0.8 * (fract(a / 0.8 + 0.5) - 0.5)",
            "mod(a, turn + 0.5)",
        ] {
            let found = factor(angle);
            assert!((1.0..1.001).contains(&found), "{angle}: {found}");
        }
        // Turned along y by half as much as it rises: within the box at most 2 √2 from the axis.
        let twisted = factor("a + 0.5 * p.y");
        assert!((1.5..=1.0 + 0.5 * 8f64.sqrt()).contains(&twisted), "{twisted}");
    }

    #[test]
    fn what_is_no_turn_is_none() {
        for angle in ["2 * a", "a * a", "0.5 * a", "turn * a"] {
            let found = factor(angle);
            assert!(found > 1.2, "{angle}: {found}");
        }
    }
}
