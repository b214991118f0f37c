//! Axes along which a formula's gradient repeats: one period stands for all of space.

use crate::analysis::tape::{Step, Tape};
use crate::analysis::Box3;
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::{Claim, Leaf};

/// How a step depends on one coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Course {
    /// Not at all.
    Still,
    /// So many times the coordinate, and what does not depend on it.
    Linear(f64),
    /// Repeating.
    Periodic,
    /// Repeating, and a multiple of the coordinate.
    Rising,
    /// In another way.
    Other,
}

/// What half a period farther becomes of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Half {
    /// The same.
    Same,
    /// The same with its sign changed.
    Turned,
    /// Something else.
    Other,
}

/// The box with one period in the place of every axis without end along which the gradient of the tape's roots repeats, or half of one where
/// that is enough: where each root half a period farther is the same but for its sign, it is as steep there.
pub fn one_period(tape: &Tape, region: Box3) -> Box3 {
    let mut reduced = region;
    for axis in 0..3 {
        if region.axis(axis) == Interval::ALL
            && tape.reads(axis)
            && let Some(period) = period(tape, axis)
        {
            reduced = reduced.with_axis(axis, Interval::new(0.0, period * (1.0 + 1e-9)));
        }
    }
    reduced
}

/// The period of the gradient of all of a tape's roots along an axis.
fn period(tape: &Tape, axis: usize) -> Option<f64> {
    let mut courses: Vec<Course> = Vec::with_capacity(tape.steps.len());
    let mut frequencies: Vec<f64> = Vec::new();
    // The steps that turn with the coordinate, and how fast.
    let mut turning: Vec<(usize, f64)> = Vec::new();
    let constant = |i: usize| tape.constant(i);
    for (i, step) in tape.steps.iter().enumerate() {
        let course = |i: usize| courses.get(i).copied().unwrap_or(Course::Other);
        let repeats = |args: &[usize]| {
            let kinds: Vec<Course> = args.iter().map(|&a| course(a)).collect();
            if kinds.iter().all(|c| *c == Course::Still) {
                Course::Still
            } else if kinds.iter().all(|c| matches!(c, Course::Still | Course::Periodic)) {
                Course::Periodic
            } else {
                Course::Other
            }
        };
        let next = match step {
            Step::Constant(_) => Course::Still,
            Step::Leaf(Leaf::P(i)) if usize::from(*i) == axis => Course::Linear(1.0),
            // The scene's point moves with this one in a way that is not known here.
            Step::Leaf(Leaf::Variable(v)) if *v < crate::graph::WORLD + 3 => Course::Other,
            Step::Leaf(_) => Course::Still,
            Step::Op(op @ (Op::Add | Op::Sub), args) => {
                let sign = if *op == Op::Add { 1.0 } else { -1.0 };
                match (args.first().map(|&a| course(a)), args.get(1).map(|&a| course(a))) {
                    (Some(Course::Linear(a)), Some(Course::Still)) => Course::Linear(a),
                    (Some(Course::Still), Some(Course::Linear(b))) => Course::Linear(sign * b),
                    (Some(Course::Linear(a)), Some(Course::Linear(b))) if a + sign * b != 0.0 => Course::Linear(a + sign * b),
                    (Some(Course::Linear(_) | Course::Rising | Course::Periodic), Some(Course::Periodic | Course::Rising))
                    | (Some(Course::Periodic | Course::Rising), Some(Course::Linear(_)))
                    | (Some(Course::Rising), Some(Course::Still))
                    | (Some(Course::Still), Some(Course::Rising))
                        if repeats(args) == Course::Other =>
                    {
                        Course::Rising
                    }
                    _ => repeats(args),
                }
            }
            Step::Op(Op::Neg, args) => match args.first().map(|&a| course(a)) {
                Some(Course::Linear(a)) => Course::Linear(-a),
                Some(known) => known,
                None => Course::Other,
            },
            Step::Op(op @ (Op::Mul | Op::Div), args) => match args.as_slice() {
                [a, b] => match (course(*a), constant(*b), course(*b), constant(*a)) {
                    (Course::Linear(l), Some(k), ..) => Course::Linear(if *op == Op::Mul { l * k } else { l / k }),
                    (.., Course::Linear(l), Some(k)) if *op == Op::Mul => Course::Linear(l * k),
                    (Course::Rising, Some(_), ..) => Course::Rising,
                    (.., Course::Rising, Some(_)) if *op == Op::Mul => Course::Rising,
                    _ => repeats(args),
                },
                _ => Course::Other,
            },
            Step::Op(Op::Sin | Op::Cos, args) => match args.first().map(|&a| course(a)) {
                Some(Course::Linear(k)) => {
                    frequencies.push(k.abs());
                    turning.push((i, k));
                    Course::Periodic
                }
                _ => repeats(args),
            },
            Step::Op(Op::TurnU | Op::TurnV, args) => match args.as_slice() {
                [u, v, t] => match (repeats(&[*u, *v]), course(*t)) {
                    (Course::Still | Course::Periodic, Course::Linear(k)) => {
                        frequencies.push(k.abs());
                        turning.push((i, k));
                        Course::Periodic
                    }
                    _ => repeats(args),
                },
                _ => Course::Other,
            },
            Step::Op(_, args) => repeats(args),
            Step::Claim(Claim::Continuous, args) => args.first().map_or(Course::Other, |&a| course(a)),
            Step::Claim(_, args) | Step::Call(_, args) => repeats(args),
        };
        courses.push(next);
    }
    if tape.roots().any(|r| courses.get(r) == Some(&Course::Other)) {
        return None;
    }
    let least = frequencies.iter().copied().fold(f64::INFINITY, f64::min);
    if !least.is_finite() || least <= 0.0 {
        return None;
    }
    // A common period, where the others are whole multiples of half, a third, … of the slowest.
    let base = (1..=4).map(|n| least / f64::from(n)).find(|base| {
        let whole = |f: &f64| (f / base - (f / base).round()).abs() < 1e-12;
        frequencies.iter().all(whole)
    })?;
    // A multiple of the coordinate itself stays as it is.
    let rises = tape.roots().any(|r| !matches!(courses.get(r), Some(Course::Still | Course::Periodic)));
    let halved = !rises && is_halved(tape, &courses, |step| {
        let speed = turning.iter().find(|(i, _)| *i == step).map(|(_, k)| (k / base).round());
        speed.map(|whole| if whole % 2.0 == 0.0 { Half::Same } else { Half::Turned })
    });
    Some(std::f64::consts::TAU / base * if halved { 0.5 } else { 1.0 })
}

/// Whether each root is the same half a period farther, but for its sign. `turned`: what becomes of a sine, a cosine or a turn by a multiple of
/// the coordinate.
fn is_halved(tape: &Tape, courses: &[Course], turned: impl Fn(usize) -> Option<Half>) -> bool {
    let mut halves: Vec<Half> = Vec::with_capacity(tape.steps.len());
    for (i, step) in tape.steps.iter().enumerate() {
        let of = |args: &[usize], k: usize| args.get(k).and_then(|&a| halves.get(a)).copied().unwrap_or(Half::Other);
        let all = |args: &[usize], wanted: Half| args.iter().all(|&a| halves.get(a) == Some(&wanted));
        let product = |a: Half, b: Half| match (a, b) {
            (Half::Other, _) | (_, Half::Other) => Half::Other,
            _ if a == b => Half::Same,
            _ => Half::Turned,
        };
        let next = match step {
            _ if courses.get(i) == Some(&Course::Still) => Half::Same,
            Step::Constant(_) | Step::Leaf(_) => Half::Other,
            Step::Op(Op::Sin | Op::Cos, _) if turned(i).is_some() => turned(i).unwrap_or(Half::Other),
            Step::Op(Op::TurnU | Op::TurnV, args) if turned(i).is_some() && of(args, 0) == of(args, 1) => {
                product(of(args, 0), turned(i).unwrap_or(Half::Other))
            }
            Step::Op(_, args) if all(args, Half::Same) => Half::Same,
            Step::Op(Op::Mul | Op::Div, args) => product(of(args, 0), of(args, 1)),
            Step::Op(Op::Add | Op::Sub | Op::Neg | Op::Sin | Op::Tanh | Op::Atan, args) if all(args, Half::Turned) => Half::Turned,
            Step::Op(Op::Square | Op::Abs | Op::Cos | Op::Length2 | Op::Length3 | Op::Length4, args) => {
                match (0..args.len()).any(|k| of(args, k) == Half::Other) {
                    true => Half::Other,
                    false => Half::Same,
                }
            }
            Step::Claim(_, args) => of(args, 0),
            Step::Call(_, args) if all(args, Half::Same) => Half::Same,
            Step::Op(..) | Step::Call(..) => Half::Other,
        };
        halves.push(next);
    }
    tape.roots().all(|r| matches!(halves.get(r), Some(Half::Same | Half::Turned)))
}

#[cfg(test)]
mod tests {
    use crate::analysis::rules::tried::factors;
    use crate::rules::Rule;

    #[test]
    fn one_period_stands_for_all_where_there_is_one() {
        let web = |wave: &str| format!("field web(f: float) = {wave} / f\nscene = web(3).shell(0.1) & sphere(1.2)");
        let [with, without] = factors(Rule::Period, &web("dot(sin(f * p), cos(f * p.zxy))"));
        assert!(with < without, "{with} {without}");
        let [with, without] = factors(Rule::Period, &web("dot(sin(f * p * abs(p)), cos(f * p.zxy))"));
        assert_eq!(with, without, "this has no period");
        // Two waves of which one is twice as long have the longer one's.
        let [with, without] = factors(Rule::Period, &web("(sin(f * p.x) * cos(f * p.y / 2) + sin(f * p.z))"));
        assert!(with <= without);
    }
}
