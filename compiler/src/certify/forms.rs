//! Forms of which more is known than their operations tell one by one: a mix of two values, and a polynomial of one value, as noise and
//! smooth steps are made of, and what rounding leaves. `t t (3 - 2 t)` lies between 0 and 1 with t, but the product of its factors' intervals does not.

// A step names only steps before it, so every index is in range.
#![allow(clippy::indexing_slicing)]

use super::code::Step;
use super::forward::Slot;
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use std::sync::Arc;

/// What the value of a step also is. The arguments of [`Step::Form`] are that step, then those of the form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Form {
    /// `a (1 - t) + b t`.
    Mix,
    /// A polynomial of one argument: this one of the code's.
    Polynomial(u16),
    /// What is left of a value when a whole number is taken off: between these two.
    Rest(f64, f64),
}

/// Coefficients, those of the lowest power first; each holds the true one.
pub(super) type Polynomial = Vec<Interval>;

/// Polynomials of one code.
const MOST: usize = u16::MAX as usize;
/// The highest power that is looked at.
const DEGREE: usize = 8;
/// Binomial coefficients up to that power.
const BINOMIAL: [[f64; DEGREE + 1]; DEGREE + 1] = {
    let mut all = [[0.0; DEGREE + 1]; DEGREE + 1];
    let mut n = 0;
    while n <= DEGREE {
        all[n][0] = 1.0;
        let mut k = 1;
        while k <= n {
            all[n][k] = all[n - 1][k - 1] + all[n - 1][k];
            k += 1;
        }
        n += 1;
    }
    all
};
/// Of a degree, an index of the basis of Bernstein and a power: how much of the power's coefficient is in that of the basis, at most 1.
const SHARES: [[[f64; DEGREE + 1]; DEGREE + 1]; DEGREE + 1] = {
    let mut all = [[[0.0; DEGREE + 1]; DEGREE + 1]; DEGREE + 1];
    let mut n = 0;
    while n <= DEGREE {
        let mut i = 0;
        while i <= n {
            let mut k = 0;
            while k <= i {
                all[n][i][k] = BINOMIAL[i][k] / BINOMIAL[n][k];
                k += 1;
            }
            i += 1;
        }
        n += 1;
    }
    all
};
/// What rounding loses in [`image`], of the sum of the sizes of all terms: no term goes through as many as 64 roundings.
const LOST: f64 = 64.0 * f64::EPSILON;

impl Form {
    /// How many arguments it has.
    pub(super) fn arity(self) -> usize {
        match self {
            Self::Mix => 3,
            Self::Polynomial(_) => 1,
            Self::Rest(..) => 0,
        }
    }

    /// All values. `arguments`: those of the form.
    pub(super) fn range(self, polynomials: &[Polynomial], arguments: [Interval; 3]) -> Interval {
        let [a, b, t] = arguments;
        match self {
            Self::Mix => mixed(a, b, t),
            Self::Polynomial(i) => polynomials.get(usize::from(i)).map_or(Interval::ALL, |p| image(p, a)),
            Self::Rest(lo, hi) => Interval { lo, hi },
        }
    }

    /// All gradients that the form tells of.
    pub(super) fn gradient<const D: usize>(self, polynomials: &[Polynomial], arguments: [&Slot<D>; 3]) -> [Interval; D] {
        let [a, b, t] = arguments;
        let mut gradient = a.gradient;
        match self {
            Self::Mix => {
                let apart = b.range.sub(a.range);
                for ((x, y), by_t) in gradient.iter_mut().zip(b.gradient).zip(t.gradient) {
                    *x = mixed(*x, y, t.range).add(apart.mul(by_t));
                }
            }
            Self::Polynomial(i) => {
                let slope = polynomials.get(usize::from(i)).map_or(Interval::ALL, |p| slope(p, a.range));
                gradient.iter_mut().for_each(|x| *x = x.mul(slope));
            }
            Self::Rest(..) => gradient = [Interval::ALL; D],
        }
        gradient
    }
}

/// A mix goes straight with each of its arguments, so its extremes are at the ends of `t`.
fn mixed(a: Interval, b: Interval, t: Interval) -> Interval {
    let at = |t: f64| {
        let t = Interval::point(t);
        a.mul(Interval::ONE.sub(t)).add(b.mul(t))
    };
    if t.is_empty() { t } else if t.is_finite() { at(t.lo).hull(at(t.hi)) } else { Interval::ALL }
}

/// The values of a polynomial's derivative.
fn slope(polynomial: &[Interval], over: Interval) -> Interval {
    let mut derivative = [Interval::ZERO; DEGREE];
    for (i, (into, c)) in derivative.iter_mut().zip(polynomial.iter().skip(1)).enumerate() {
        *into = c.mul(Interval::point((i + 1) as f64));
    }
    image(&derivative[..polynomial.len().saturating_sub(1)], over)
}

/// The values of a polynomial: within the least and the largest of its coefficients in the basis of Bernstein (Moore, Kearfott and Cloud, § 7.2;
/// Cargo and Shisha, "The Bernstein form of a polynomial", 1966). In plain numbers, with what rounding may have lost added at the end.
fn image(polynomial: &[Interval], over: Interval) -> Interval {
    if !over.is_finite() || over.is_empty() || polynomial.is_empty() {
        return if polynomial.is_empty() { Interval::ZERO } else { Interval::ALL };
    }
    // As a polynomial of s in 0..1 with x = lo + width s.
    let (lo, width) = (over.lo, if over.is_point() { 0.0 } else { (over.hi - over.lo).next_up() });
    let reach = lo.abs() + width;
    let mut shifted = [0.0; DEGREE + 1];
    let degree = polynomial.len() - 1;
    let (mut size, mut unknown) = (0.0, 0.0);
    for (i, c) in polynomial.iter().enumerate().rev() {
        size = size * reach + c.magnitude();
        unknown = unknown * reach + c.width();
        // Times (lo + width s), plus the next coefficient.
        for k in (0..=degree - i).rev() {
            let below = if k > 0 { shifted[k - 1] * width } else { c.middle() };
            shifted[k] = shifted[k] * lo + below;
        }
    }
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for (i, shares) in SHARES[degree].iter().enumerate().take(degree + 1) {
        let sum = shifted.iter().zip(shares).take(i + 1).fold(0.0, |sum, (coefficient, share)| sum + coefficient * share);
        (least, most) = (least.min(sum), most.max(sum));
    }
    let lost = LOST * size + 2.0 * unknown;
    if lost.is_finite() { Interval::outward(least - lost, most + lost) } else { Interval::ALL }
}

/// The steps with a further one after each that has a form; what read the step reads that instead. The first `given` steps may change.
pub(super) fn formed(steps: Vec<Step>, given: usize) -> (Vec<Step>, Arc<[Polynomial]>) {
    let (polynomials, last) = polynomials(&steps, given);
    let mut kept = Vec::new();
    let mut place: Vec<u32> = Vec::with_capacity(steps.len());
    let mut formed = Vec::with_capacity(steps.len());
    for (i, step) in steps.iter().enumerate() {
        formed.push(match *step {
            Step::Op(op, from) => Step::Op(op, from.map(|a| place.get(a as usize).copied().unwrap_or(0))),
            other => other,
        });
        let at = formed.len() as u32 - 1;
        place.push(at);
        if let Some([a, b, t]) = mix(&steps, *step) {
            formed.push(Step::Form(Form::Mix, [at, place[a as usize], place[b as usize], place[t as usize]]));
        } else if let Some((lo, hi)) = rest(&steps, *step) {
            formed.push(Step::Form(Form::Rest(lo, hi), [at, 0, 0, 0]));
        } else if let (true, Some((base, polynomial))) = (last[i] && kept.len() < MOST, &polynomials[i]) {
            formed.push(Step::Form(Form::Polynomial(kept.len() as u16), [at, place[*base as usize], 0, 0]));
            kept.push(polynomial.clone());
        }
        place[i] = formed.len() as u32 - 1;
    }
    (formed, kept.into())
}

/// Of `a (1 - t) + b t` or `a + (b - a) t`: a, b and t.
fn mix(steps: &[Step], step: Step) -> Option<[u32; 3]> {
    let operands = |i: u32, op: Op| match steps[i as usize] {
        Step::Op(found, [a, b, ..]) if found == op => Some([a, b]),
        _ => None,
    };
    let Step::Op(Op::Add, [x, y, ..]) = step else { return None };
    for (first, second) in [(x, y), (y, x)] {
        let Some([p, q]) = operands(second, Op::Mul) else { continue };
        for (factor, t) in [(p, q), (q, p)] {
            // a + (b - a) t
            if let Some([b, a]) = operands(factor, Op::Sub).filter(|[_, a]| *a == first) {
                return Some([a, b, t]);
            }
            // b t after a (1 - t)
            let Some([p, q]) = operands(first, Op::Mul) else { continue };
            for (a, rest) in [(p, q), (q, p)] {
                let one = |i: u32| steps[i as usize] == Step::Constant(1.0);
                if operands(rest, Op::Sub).is_some_and(|[l, r]| one(l) && r == t) {
                    return Some([a, factor, t]);
                }
            }
        }
    }
    None
}

/// Of `x - floor(x)` and its kin, and of `x - c floor(x / c)`: between which numbers it lies.
fn rest(steps: &[Step], step: Step) -> Option<(f64, f64)> {
    let Step::Op(Op::Sub, [x, whole, ..]) = step else { return None };
    let constant = |i: u32| match steps[i as usize] {
        Step::Constant(c) if c > 0.0 => Some(c),
        _ => None,
    };
    let Step::Op(op, [a, b, ..]) = steps[whole as usize] else { return None };
    let (size, op, of) = match op {
        Op::Mul => {
            let (c, floor) = constant(a).map(|c| (c, b)).or(constant(b).map(|c| (c, a)))?;
            let Step::Op(op, [of, ..]) = steps[floor as usize] else { return None };
            match steps[of as usize] {
                Step::Op(Op::Div, [y, d, ..]) if y == x && constant(d) == Some(c) => (c, op, x),
                // Dividing by a power of two is multiplying, exactly.
                Step::Op(Op::Mul, [y, z, ..]) if c.to_bits().trailing_zeros() >= 52 => {
                    let by = if y == x { z } else { y };
                    ((y == x || z == x) && constant(by) == Some(1.0 / c)).then_some((c, op, x))?
                }
                _ => return None,
            }
        }
        _ => (1.0, op, a),
    };
    let (lo, hi) = match op {
        Op::Floor => (0.0, 1.0),
        Op::Ceil => (-1.0, 0.0),
        Op::Round => (-0.5, 0.5),
        Op::Trunc => (-1.0, 1.0),
        _ => return None,
    };
    (of == x).then_some(((size * lo).next_down(), (size * hi).next_up()))
}

/// Of each step the value of which it is a polynomial, and which; and whether it is worth looking at as one: of degree two or more, and
/// used by something else than a polynomial of the same.
fn polynomials(steps: &[Step], given: usize) -> (Vec<Option<(u32, Polynomial)>>, Vec<bool>) {
    let mut found: Vec<Option<(u32, Polynomial)>> = Vec::with_capacity(steps.len());
    let mut last = vec![false; steps.len()];
    for (i, step) in steps.iter().enumerate() {
        let own = (i as u32, vec![Interval::ZERO, Interval::ONE]);
        let (Step::Op(op, [a, b, ..]), true) = (*step, i >= given) else {
            found.push((i < given).then_some(own));
            continue;
        };
        // A constant is a polynomial of anything.
        let of = |k: u32| match steps[k as usize] {
            Step::Constant(value) if k as usize >= given => Some((None, vec![Interval::point(value)])),
            _ => found[k as usize].clone().map(|(base, p)| (Some(base), p)),
        };
        let combined = match op {
            Op::Add | Op::Sub | Op::Mul => of(a).zip(of(b)).and_then(|((base, p), (other, q))| {
                let same = base.is_none() || other.is_none() || base == other;
                let base = base.or(other).filter(|_| same)?;
                let polynomial = match op {
                    Op::Mul => product(&p, &q),
                    Op::Add => Some(sum(&p, &q)),
                    _ => Some(sum(&p, &q.iter().map(|c| c.neg()).collect::<Vec<_>>())),
                };
                Some((base, polynomial?))
            }),
            Op::Square => of(a).and_then(|(base, p)| Some((base?, product(&p, &p)?))),
            Op::Neg => of(a).and_then(|(base, p)| Some((base?, p.iter().map(|c| c.neg()).collect()))),
            _ => None,
        };
        let base = combined.as_ref().map(|(base, _)| *base);
        for k in [a, b, 0, 0].into_iter().take(usize::from(op.row().arity)) {
            let argument = found[k as usize].as_ref();
            last[k as usize] |= argument.is_some_and(|(of, p)| p.len() > 2 && base != Some(*of) && told(p));
        }
        found.push(combined.or(Some(own)));
    }
    (found, last)
}

/// Whether there is more than one power in it: of one alone the operations tell all.
fn told(polynomial: &[Interval]) -> bool {
    polynomial.iter().filter(|c| c.magnitude() > 0.0).count() > 1
}

fn sum(p: &[Interval], q: &[Interval]) -> Polynomial {
    let zero = Interval::ZERO;
    let term = |i: usize| match (p.get(i), q.get(i)) {
        (Some(x), Some(y)) if *x == zero => *y,
        (Some(x), Some(y)) if *y == zero => *x,
        (Some(x), Some(y)) => x.add(*y),
        (Some(x), None) | (None, Some(x)) => *x,
        (None, None) => zero,
    };
    (0..p.len().max(q.len())).map(term).collect()
}

fn product(p: &[Interval], q: &[Interval]) -> Option<Polynomial> {
    if p.len() + q.len() > DEGREE + 2 {
        return None;
    }
    let mut all = vec![Interval::ZERO; p.len() + q.len() - 1];
    for (i, x) in p.iter().enumerate() {
        for (j, y) in q.iter().enumerate() {
            let term = x.mul(*y);
            all[i + j] = if all[i + j] == Interval::ZERO { term } else { all[i + j].add(term) };
        }
    }
    Some(all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    /// Of a polynomial over an interval: every value is in the image, and of a step that only rises the image is hardly more than them.
    #[test]
    fn an_image_holds_the_values_and_little_else() {
        let mut random = Random(7);
        let value = |p: &[Interval], x: f64| p.iter().rev().fold(0.0, |sum, c| sum * x + c.lo);
        for i in 0..2000 {
            let scale = 10f64.powf(4.0 * random.next() - 2.0);
            let polynomial: Polynomial = (0..2 + i % 7).map(|_| Interval::point(scale * (2.0 * random.next() - 1.0))).collect();
            let lo = 4.0 * random.next() - 2.0;
            let over = Interval { lo, hi: lo + 2.0 * random.next().powi(4) };
            let image = image(&polynomial, over);
            for k in 0..=50 {
                let x = (lo + over.width() * f64::from(k) / 50.0).min(over.hi);
                assert!(image.contains(value(&polynomial, x)), "{polynomial:?} at {x} is not in {image:?}");
            }
        }
        let smooth: Polynomial = [0.0, 0.0, 3.0, -2.0].map(Interval::point).to_vec();
        for (lo, hi) in [(0.0, 1.0), (0.2, 0.4), (0.7, 0.7)] {
            let image = image(&smooth, Interval { lo, hi });
            assert!((image.lo - value(&smooth, lo)).abs() < 1e-12 && (image.hi - value(&smooth, hi)).abs() < 1e-12, "{image:?} over {lo} to {hi}");
        }
    }
}
