//! Finds the forms among the steps of a code.

// A step names only steps before it, so every index is in range.
#![allow(clippy::indexing_slicing)]

use crate::certify::form::{DEGREE, Form, Polynomial};
use crate::certify::step::Step;
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use std::sync::Arc;

/// Polynomials of one code.
const MOST: usize = u16::MAX as usize;

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
