//! Steps whose values are known better than interval by interval, because they read one number more than once.
//!
//! A fractional part x - ⌊x⌋ lies between zero and one. A mean a(1 - t) + bt lies between a and b. A polynomial of one number, as t²(3 - 2t) is, lies
//! between the least and the greatest of its Bernstein coefficients over that number's range (Bernstein form: Lane and Riesenfeld 1981), and so does its
//! slope. What is known of a coordinate over the length of its vector stands in `normalized_vector`, of products of sums in `multilinear`.

use super::polar_rotation::Around;
use super::normalized_vector::Direction;
use crate::analysis::dual::Dual;
use super::multilinear::Multilinear;
use crate::analysis::tape::{Step, Tape};
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::rules::Rule;
use smallvec::{SmallVec, smallvec};

/// Coefficients by ascending powers.
type Coefficients = SmallVec<[f64; 8]>;

/// What more is known of a step.
#[derive(Clone, Debug)]
pub(in crate::analysis) enum Tight {
    /// It is a fractional part, or what is left of a division.
    Part(Interval),
    /// It is a mean of two steps, by the share of the second.
    Mean { of: [usize; 2], share: usize },
    /// It is a polynomial of an earlier step.
    Polynomial { of: usize, coefficients: Coefficients },
    /// It is a coordinate over a length.
    Direction(Direction),
    /// It is a length times the cosine or the sine of an angle.
    Around(Around),
    /// It is a sum of products in which no number is multiplied by itself.
    Multilinear(Multilinear),
}

/// Polynomials of a higher degree are not looked at.
const HIGHEST: usize = 7;
/// Into how many parts a range is cut for the slope.
const PARTS: usize = 4;
/// So many operations are looked through for whole numbers.
const DEEPEST: usize = 6;
/// What rounding may lead beyond.
const SLACK: f64 = 1e-12;
/// The rounding of all the steps to a Bernstein coefficient, against the size of what is added up.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// A step as a polynomial of an earlier one, and whether that is read more than once.
#[derive(Clone)]
struct Written {
    of: usize,
    coefficients: Coefficients,
    again: bool,
}

impl Tight {
    /// All that is known of a tape's steps, in order.
    pub(in crate::analysis) fn of(tape: &Tape) -> Vec<(usize, Tight)> {
        let mut written: Vec<Written> = Vec::with_capacity(tape.steps.len());
        let mut tight = Vec::new();
        for (i, step) in tape.steps.iter().enumerate() {
            let found = match step {
                Step::Op(op, args) => polynomial(tape, *op, args, &written),
                _ => None,
            };
            let known = match (&found, step) {
                (Some(found), _) if found.again && found.coefficients.len() > 2 => {
                    Some(Tight::Polynomial { of: found.of, coefficients: found.coefficients.clone() })
                }
                (_, Step::Op(Op::Sub, args)) => part(tape, args),
                (_, Step::Op(Op::Add, args)) => mean(tape, args),
                (_, Step::Op(Op::Mul, args)) => Around::of(tape, args).map(Tight::Around),
                (_, Step::Op(Op::Div, args)) => Direction::of(tape, args).map(Tight::Direction),
                _ => None,
            };
            tight.extend(known.filter(|known| tape.rules.has(known.rule())).map(|known| (i, known)));
            written.push(found.unwrap_or_else(|| Written { of: i, coefficients: smallvec![0.0, 1.0], again: false }));
        }
        if tape.rules.has(Rule::Multilinear) && has_products_of_sums(tape) {
            let known = |step: usize| tight.binary_search_by_key(&step, |(step, _)| *step).ok().and_then(|i| tight.get(i));
            let mut sums = Multilinear::of(tape, |step| known(step).is_some_and(|(_, known)| !matches!(known, Tight::Mean { .. })));
            // A mean says as much of itself.
            sums.retain(|(step, _)| known(*step).is_none());
            tight.extend(sums.into_iter().map(|(step, sum)| (step, Tight::Multilinear(sum))));
            tight.sort_by_key(|(step, _)| *step);
        }
        tight
    }

    /// The rule by which it is known.
    fn rule(&self) -> Rule {
        match self {
            Tight::Part(_) => Rule::FractionalPart,
            Tight::Mean { .. } => Rule::Mean,
            Tight::Polynomial { .. } => Rule::Bernstein,
            Tight::Direction(_) => Rule::NormalizedVector,
            Tight::Around(_) => Rule::PolarRotation,
            Tight::Multilinear(_) => Rule::Multilinear,
        }
    }

    /// A step's values, of those of all steps before it.
    pub(in crate::analysis) fn values(&self, value: impl Fn(usize) -> Interval) -> Interval {
        match self {
            Tight::Part(values) => *values,
            Tight::Mean { of: [a, b], share } if is_share(value(*share)) => widened(value(*a).hull(value(*b))),
            Tight::Mean { .. } => Interval::ALL,
            Tight::Polynomial { of, coefficients } => bernstein(coefficients, value(*of)),
            Tight::Direction(direction) => direction.values(value),
            Tight::Around(_) => Interval::ALL,
            Tight::Multilinear(sum) => sum.values(value),
        }
    }

    /// A step with what more is known of it.
    pub(in crate::analysis) fn bound(&self, dual: Dual, values: &[Dual]) -> Dual {
        let of = |step: usize| values.get(step).copied().unwrap_or(Dual::unknown(Interval::ALL));
        if let Tight::Multilinear(sum) = self {
            return sum.bound(dual, of);
        }
        let known = self.values(|step| of(step).value);
        let both = dual.value.intersect(known);
        let dual = if both.is_empty() { dual } else { Dual { value: both, ..dual } };
        match self {
            Tight::Part(_) => dual,
            Tight::Direction(direction) => direction.bound(dual, of),
            Tight::Around(around) => around.bound(dual, of),
            Tight::Mean { of: [a, b], share } if is_share(of(*share).value) => {
                // (1 - t) ∇a + t ∇b + (b - a) ∇t
                let (a, b, share) = (of(*a), of(*b), of(*share));
                let apart = b.value.sub(a.value);
                let mut gradient = share.scaled(apart);
                for (slot, (a, b)) in gradient.iter_mut().zip(a.gradient.iter().zip(&b.gradient)) {
                    let hull = a.hull(*b);
                    *slot = if *slot == Interval::ZERO { hull } else { slot.add(hull) };
                }
                let across = if share.norm == 0.0 { 0.0 } else { apart.magnitude() * share.norm };
                let norm = (a.norm.max(b.norm) + across) * (1.0 + SLACK);
                dual.within(gradient, norm.min(Dual::components_norm(&gradient)))
            }
            Tight::Mean { .. } | Tight::Multilinear(_) => dual,
            Tight::Polynomial { of: base, coefficients } => {
                let base = of(*base);
                if base.norm == 0.0 || !base.value.is_finite() {
                    return dual;
                }
                let slopes: Coefficients = coefficients.iter().enumerate().skip(1).map(|(n, c)| n as f64 * c).collect();
                let end = |i: usize| base.value.lo + base.value.width() * i as f64 / PARTS as f64;
                let parts = (0..PARTS).map(|i| bernstein(&slopes, Interval::new(end(i), if i + 1 == PARTS { base.value.hi } else { end(i + 1) })));
                let slope = parts.fold(Interval::EMPTY, Interval::hull);
                dual.within(base.scaled(slope), slope.magnitude() * base.norm)
            }
        }
    }
}

/// Whether there is a product with a sum in it, both of which change.
fn has_products_of_sums(tape: &Tape) -> bool {
    let sum = |&step: &usize| matches!(tape.operation(step), Some((Op::Add | Op::Sub, _)));
    tape.steps.iter().any(|step| match step {
        Step::Op(Op::Mul, args) => args.iter().any(sum) && args.iter().all(|&arg| tape.constant(arg).is_none()),
        _ => false,
    })
}

/// Whether all of it is between zero and one, but for rounding.
fn is_share(value: Interval) -> bool {
    value.lo >= -SLACK && value.hi <= 1.0 + SLACK
}

fn widened(value: Interval) -> Interval {
    value.grow(SLACK * value.magnitude().min(1e30))
}

/// `x - ⌊x⌋`, and `x - m ⌊x / m⌋`, which is a whole number where both are.
fn part(tape: &Tape, args: &[usize]) -> Option<Tight> {
    let &[x, taken] = args else { return None };
    let (mut size, mut step) = (1.0, taken);
    if let (Op::Mul, &[a, b]) = tape.operation(taken)? {
        (size, step) = tape.constant(a).map(|m| (m, b)).or(tape.constant(b).map(|m| (m, a)))?;
    }
    let (rounds, &[of]) = tape.operation(step)? else { return None };
    let part = rounds.part()?;
    let share = match tape.operation(of) {
        _ if of == x => 1.0,
        Some((Op::Mul, &[a, b])) if b == x => tape.constant(a)?,
        Some((Op::Mul, &[a, b])) if a == x => tape.constant(b)?,
        Some((Op::Div, &[a, b])) if a == x => 1.0 / tape.constant(b)?,
        _ => return None,
    };
    if size <= 0.0 || (size * share - 1.0).abs() > SLACK {
        return None;
    }
    // Only by powers of two is a device sure to divide exactly.
    let least = if size.log2().fract() == 0.0 && size >= 1.0 && is_whole(tape, x, &|_| false, DEEPEST) { 1.0 } else { 0.0 };
    let whole = part.mul(Interval::point(size));
    let values = Interval::new(if part.lo == -1.0 { whole.lo + least } else { whole.lo }, if part.hi == 1.0 { whole.hi - least } else { whole.hi });
    Some(Tight::Part(if size == 1.0 { values } else { widened(values) }))
}

/// Whether a step is always a whole number. `known`: of those that are no operation, which are.
pub(in crate::analysis) fn is_whole(tape: &Tape, step: usize, known: &dyn Fn(usize) -> bool, deep: usize) -> bool {
    if let Some(c) = tape.constant(step) {
        return c.fract() == 0.0;
    }
    match tape.operation(step) {
        Some((Op::Floor | Op::Ceil | Op::Round | Op::Trunc | Op::Sign, _)) => true,
        Some((Op::Add | Op::Sub | Op::Mul | Op::Neg | Op::Abs | Op::Min | Op::Max, args)) if deep > 0 => {
            args.iter().all(|&arg| is_whole(tape, arg, known, deep - 1))
        }
        Some(_) => false,
        None => known(step),
    }
}

/// `a (1 - t) + b t`, or `a + (b - a) t`.
fn mean(tape: &Tape, args: &[usize]) -> Option<Tight> {
    let of = |step: usize, op: Op| tape.operation(step).filter(|(found, _)| *found == op).and_then(|(_, args)| <[usize; 2]>::try_from(args).ok());
    let &[first, second] = args else { return None };
    let rest = |step: usize, t: usize| {
        of(step, Op::Sub).is_some_and(|[one, taken]| taken == t && tape.constant(one) == Some(1.0))
    };
    for (a, b) in [(first, second), (second, first)] {
        if let (Some(a), Some(b)) = (of(a, Op::Mul), of(b, Op::Mul)) {
            for ([a, less], [b, t]) in [(a, b), ([a[1], a[0]], b), (a, [b[1], b[0]]), ([a[1], a[0]], [b[1], b[0]])] {
                if rest(less, t) {
                    return Some(Tight::Mean { of: [a, b], share: t });
                }
            }
        }
        if let Some([x, y]) = of(b, Op::Mul) {
            for (apart, t) in [(x, y), (y, x)] {
                if let Some([b, from]) = of(apart, Op::Sub)
                    && from == a
                {
                    return Some(Tight::Mean { of: [a, b], share: t });
                }
            }
        }
    }
    None
}

fn polynomial(tape: &Tape, op: Op, args: &[usize], written: &[Written]) -> Option<Written> {
    let constant = |step: usize| tape.constant(step);
    let a = *args.first()?;
    let b = args.get(1).copied().unwrap_or(a);
    let plain = |step: usize| written.get(step);
    match op {
        Op::Neg => plain(a).map(|w| Written { coefficients: w.coefficients.iter().map(|c| -c).collect(), ..w.clone() }),
        Op::Square => product(plain(a)?, plain(a)?).map(|w| Written { again: plain(a).is_some_and(|a| a.again || a.coefficients.len() > 2), ..w }),
        Op::Add | Op::Sub => {
            let sign = if op == Op::Sub { -1.0 } else { 1.0 };
            match (constant(a), constant(b)) {
                (None, None) => {
                    let (a, b) = (plain(a)?, plain(b)?);
                    if a.of != b.of {
                        return None;
                    }
                    let n = a.coefficients.len().max(b.coefficients.len());
                    let at = |w: &Written, i: usize| w.coefficients.get(i).copied().unwrap_or(0.0);
                    Some(Written { of: a.of, coefficients: (0..n).map(|i| at(a, i) + sign * at(b, i)).collect(), again: true })
                }
                (Some(c), None) => {
                    let mut sum = plain(b)?.clone();
                    sum.coefficients.iter_mut().for_each(|x| *x *= sign);
                    sum.coefficients.first_mut().into_iter().for_each(|x| *x += c);
                    Some(sum)
                }
                (None, Some(c)) => {
                    let mut sum = plain(a)?.clone();
                    sum.coefficients.first_mut().into_iter().for_each(|x| *x += sign * c);
                    Some(sum)
                }
                _ => None,
            }
        }
        Op::Mul => match (constant(a), constant(b)) {
            (None, None) => product(plain(a)?, plain(b)?),
            (Some(c), None) | (None, Some(c)) => {
                let w = plain(if constant(a).is_some() { b } else { a })?;
                Some(Written { coefficients: w.coefficients.iter().map(|x| x * c).collect(), ..w.clone() })
            }
            _ => None,
        },
        _ => None,
    }
}

fn product(a: &Written, b: &Written) -> Option<Written> {
    let degree = a.coefficients.len() + b.coefficients.len() - 2;
    if a.of != b.of || degree > HIGHEST {
        return None;
    }
    let mut coefficients: Coefficients = smallvec![0.0; degree + 1];
    for (i, x) in a.coefficients.iter().enumerate() {
        for (slot, y) in coefficients.iter_mut().skip(i).zip(&b.coefficients) {
            *slot += x * y;
        }
    }
    Some(Written { of: a.of, coefficients, again: true })
}

/// The hull of a polynomial's Bernstein coefficients over a range.
fn bernstein(coefficients: &[f64], range: Interval) -> Interval {
    let n = coefficients.len();
    let farthest = range.magnitude();
    // What cancels leaves its rounding.
    let slack = ROUNDING * coefficients.iter().rev().fold(0.0, |sum, c| sum * farthest + c.abs());
    if !range.is_finite() || !slack.is_finite() {
        return Interval::ALL;
    }
    // In t, which goes from zero to one over the range: by Horner's rule at lo + width t.
    let mut moved: Coefficients = smallvec![0.0; n];
    for c in coefficients.iter().rev() {
        for i in (0..n).rev() {
            let below = if i > 0 { moved.get(i - 1).copied().unwrap_or(0.0) } else { 0.0 };
            if let Some(slot) = moved.get_mut(i) {
                *slot = *slot * range.lo + below * range.width();
            }
        }
        moved.first_mut().into_iter().for_each(|slot| *slot += c);
    }
    // The i-th is the sum over j of the power coefficients, each times (i choose j) / (degree choose j).
    let degree = n.saturating_sub(1);
    let mut hull = Interval::EMPTY;
    for i in 0..n {
        let (mut sum, mut share) = (0.0, 1.0);
        for (j, c) in moved.iter().enumerate().take(i + 1) {
            sum += share * c;
            share *= (i - j) as f64 / (degree - j).max(1) as f64;
        }
        hull = hull.hull(Interval::point(sum));
    }
    hull.grow(slack)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_lie_between_their_bernstein_coefficients() {
        let near = |found: Interval, [lo, hi]: [f64; 2]| assert!((found.lo - lo).abs() < 1e-12 && (found.hi - hi).abs() < 1e-12, "{found:?}");
        near(bernstein(&[0.0, 0.0, 3.0, -2.0], Interval::new(0.0, 1.0)), [0.0, 1.0]);
        near(bernstein(&[0.0, 0.0, 0.0, 10.0, -15.0, 6.0], Interval::new(0.0, 1.0)), [0.0, 1.0]);
        near(bernstein(&[1.0, 2.0], Interval::new(-1.0, 3.0)), [-1.0, 7.0]);
        near(bernstein(&[5.0], Interval::new(-1.0, 3.0)), [5.0, 5.0]);
        let (cubic, range) = ([0.3, -1.2, 0.7, 2.1], Interval::new(-0.8, 1.7));
        let hull = bernstein(&cubic, range);
        for i in 0..=100 {
            let x = range.lo + range.width() * f64::from(i) / 100.0;
            let value = cubic.iter().rev().fold(0.0, |sum, c| sum * x + c);
            assert!(hull.grow(1e-12).contains(value), "{value} of {hull:?}");
        }
    }
}
