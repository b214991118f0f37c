//! Angles that jump by whole turns: what is made of their sine or cosine does not jump, and of half turns not the magnitude of one.

use crate::analysis::dual::Dual;
use crate::analysis::tape::{Step, Tape};
use super::algebraic_enclosures::is_whole;
use crate::graph::kernel::Op;
use crate::graph::{Graph, Leaf};

/// An angle that is put together by more steps, one in the other, counts as one that jumps otherwise.
const DEEPEST: usize = 12;

/// Whether an operation does not jump although its angle does, as that only jumps by whole turns.
pub(in crate::analysis) fn is_same_after_turns(graph: &Graph, op: Op, args: &[usize], tape: &Tape, values: &[Dual]) -> bool {
    let jumps = Jumps { graph, tape, values };
    match (op, args) {
        (Op::Sin | Op::Cos | Op::TurnU | Op::TurnV, [rest @ .., angle]) => rest.iter().all(|&a| jumps.is_smooth(a)) && jumps.are_whole(*angle, 1.0),
        // After half a turn a sine has another sign.
        (Op::Abs | Op::Square, &[wave]) => matches!(tape.operation(wave), Some((Op::Sin | Op::Cos, &[angle])) if jumps.are_whole(angle, 0.5)),
        _ => false,
    }
}

/// How steps jump.
struct Jumps<'a> {
    graph: &'a Graph,
    tape: &'a Tape,
    values: &'a [Dual],
}

impl Jumps<'_> {
    fn is_smooth(&self, step: usize) -> bool {
        self.values.get(step).is_some_and(|d| d.jumps == 0)
    }

    /// Whether a step does not jump but by so many turns, and multiples of that.
    fn are_whole(&self, step: usize, turns: f64) -> bool {
        self.turns(step, DEEPEST).is_some_and(|by| by == 0.0 || (by / turns).fract() == 0.0)
    }

    /// By how many turns, and multiples of that, a step jumps: zero where it does not. None where that is not known.
    fn turns(&self, step: usize, deep: usize) -> Option<f64> {
        if self.is_smooth(step) {
            return Some(0.0);
        }
        let deeper = deep.checked_sub(1)?;
        let of = |step: usize| self.turns(step, deeper);
        match self.tape.steps.get(step)? {
            // Of the coordinates only an angle jumps, in the place of one.
            Step::Leaf(Leaf::P(_)) => Some(1.0),
            Step::Op(Op::Atan2, args) if args.iter().all(|&a| self.is_smooth(a)) => {
                // What stays at zero has the angle of zero ahead, and of half a turn behind.
                Some(if self.crosses_zero(*args.first()?) { 1.0 } else { 0.5 })
            }
            Step::Op(Op::Neg, args) => of(*args.first()?),
            Step::Op(Op::Add | Op::Sub, args) => {
                let &[a, b] = args.as_slice() else { return None };
                let (a, b) = (of(a)?, of(b)?);
                let (less, more) = (a.min(b), a.max(b));
                // Of both, where the one is a multiple of the other.
                if less == 0.0 { Some(more) } else { Some(less).filter(|less| (more / less).fract() == 0.0) }
            }
            Step::Op(Op::Mul, args) => {
                let &[a, b] = args.as_slice() else { return None };
                let times = |number: usize, step: usize| match self.tape.constant(number) {
                    Some(c) => Some(c.abs() * of(step)?),
                    None if self.is_whole(number) => of(step),
                    None => None,
                };
                times(a, b).or_else(|| times(b, a))
            }
            Step::Op(Op::Div, args) => {
                let &[a, b] = args.as_slice() else { return None };
                Some(of(a)? / self.tape.constant(b)?.abs())
            }
            _ => None,
        }
    }

    /// Whether a step is zero on surfaces alone, as far as that is seen: in planes, where it rises all over the box, or as a turned coordinate.
    fn crosses_zero(&self, step: usize) -> bool {
        let rises = |d: &Dual| d.gradient.iter().any(|slope| slope.lo > 0.0 || slope.hi < 0.0);
        let turned = || match self.tape.operation(step) {
            Some((Op::TurnU | Op::TurnV, &[u, v, angle])) => {
                let of = [u, v].map(|a| self.coordinate(a));
                of[0].is_some() && of[1].is_some() && of[0] != of[1] && self.is_still(angle)
            }
            _ => false,
        };
        self.tape.is_zero_in_planes(step) || self.values.get(step).is_some_and(rises) || turned()
    }

    /// Which coordinate of the point a step is, moved or not.
    fn coordinate(&self, step: usize) -> Option<u8> {
        match self.tape.steps.get(step)? {
            Step::Leaf(Leaf::P(i)) => Some(*i),
            Step::Op(Op::Add | Op::Sub, args) => match *args.as_slice() {
                [a, b] if self.is_still(b) => self.coordinate(a),
                [a, b] if self.is_still(a) => self.coordinate(b),
                _ => None,
            },
            _ => None,
        }
    }

    /// Whether a step is the same at all points.
    fn is_still(&self, step: usize) -> bool {
        self.values.get(step).is_some_and(|d| d.norm == 0.0 && d.jumps == 0)
    }

    /// Whether a step is a whole number, the same at all points: a parameter, or what is made of such.
    fn is_whole(&self, step: usize) -> bool {
        let is_parameter = |step: usize| match self.tape.steps.get(step) {
            Some(Step::Leaf(Leaf::Parameter(i))) => self.graph.parameters.get(*i as usize).is_some_and(|p| p.whole),
            _ => false,
        };
        self.is_still(step) && is_whole(self.tape, step, &is_parameter, DEEPEST)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]
mod tests {
    use crate::diagnostic::Code;
    use crate::{MemoryLoader, Options, compile};

    /// Whether a scene of a formula is said to jump.
    fn jumps(formula: &str) -> bool {
        let parameters = "param n: int = 6 in 3..12\nparam x = 6 in 3..12";
        let text = format!("{parameters}\nfield f = length(p) - 1 + {formula}\nscene = f.within(box((0.5, 1, 0.5)).translate(-1, 0, 0))");
        let outcome = compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default());
        assert!(outcome.compiled.is_some());
        outcome.diagnostics.iter().any(|d| d.code == Code::Jump)
    }

    #[test]
    fn waves_about_an_axis_do_not_jump() {
        assert!(!jumps("0.02 * sin(6 * atan(p.z, p.x) + 5 * p.y)"));
        assert!(!jumps("0.02 * cos(-atan(p.z, p.x) * 3)"));
        assert!(!jumps("{ let q = rotate((p.x, p.y), 2 * atan(p.z, p.x)); 0.1 * q.x }"));
        assert!(!jumps("0.02 * cos(n * atan(p.z, p.x))"));
        assert!(!jumps("0.02 * cos(2 * n * atan(p.z, p.x))"));
        assert!(!jumps("0.02 * cos((n + 1) * atan(p.z, p.x) + time)"));
        assert!(jumps("0.02 * cos((n + 0.5) * atan(p.z, p.x) + 1)"));
        assert!(!jumps("0.02 * abs(sin(n * atan(p.z, p.x) / 2 + p.y))"));
        assert!(!jumps("0.02 * sq(cos(2.5 * atan(p.z, p.x)))"));
        assert!(!jumps("0.02 * sin(3 * (2 * atan(p.z, p.x) - n * atan(p.z, p.x)))"));
        assert!(jumps("0.02 * cos(x * atan(p.z, p.x) + 1)"));
        assert!(jumps("0.02 * abs(sin(n * atan(p.z, p.x) / 4 + 1))"));
        // What is the same for an angle and its opposite, as far as one looks.
        assert!(!jumps("0.02 * cos(x * atan(p.z, p.x))"));
        assert!(jumps("0.02 * sin(n * atan(p.z, p.x) / 2)"));
        assert!(!jumps("0.02 * sin(3 * atan(rotate(p, y, time).z, rotate(p, y, time).x))"));
        assert!(!jumps("0.02 * sin(3 * atan(rotate(p, y, 20deg).z, rotate(p, y, 20deg).x))"));
        // What stays at zero jumps by half a turn.
        for stays in ["max(p.z, 0)", "abs(max(p.z, 0))", "floor(0.1 * abs(p.z))", "0"] {
            assert!(jumps(&format!("0.02 * cos(atan({stays}, p.x + 1))")), "{stays}");
            assert!(jumps(&format!("0.02 * abs(sin(atan({stays}, p.x + 1) / 2))")), "{stays}");
        }
        assert!(jumps("0.02 * cos(n * atan(max(p.z, 0), p.x + 1))"));
        assert!(!jumps("0.02 * cos(2 * atan(max(p.z, 0), p.x + 1))"));
        // Not a whole number of waves, and not a whole turn.
        assert!(jumps("0.02 * sin(6.5 * atan(p.z, p.x))"));
        assert!(jumps("0.02 * sin(tau * sign(atan(p.z, p.x)) + 0.2 * atan(p.z, p.x))"));
        assert!(jumps("0.02 * sin(6 * atan(p.z - floor(p.y), p.x))"));
        assert!(jumps("0.02 * abs(atan(p.z, p.x) - 1)"));
    }

    #[test]
    fn who_multiplies_an_angle_by_part_of_a_number_is_told() {
        let of = |parameter: &str| {
            let text = format!("param {parameter} in 3..12\nfield2 f = length(p) - 0.8 - 0.08 * cos(n * atan(p.y, p.x))\nscene = (f.within(circle(1) - circle(0.4)) | circle(0.5)).extrude(1)");
            let found = compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default()).diagnostics;
            found.into_iter().map(|d| (d.code, d.help)).collect::<Vec<_>>()
        };
        assert_eq!(of("n: int = 6"), []);
        let told = of("n = 6");
        assert!(matches!(told.as_slice(), [(Code::Unproven, help)] if help.contains("`param n: int = 6`")), "{told:?}");
    }
}
