//! Jumps, piece by piece.
//!
//! Where a box holds the border between two cells of a repetition, of noise, or of a condition, an operation jumps there, and little can
//! be said of the field over the whole box. But the border parts it in pieces, and on each the operation is a number (or an angle that
//! does not turn over), so the field is that of a formula without the jump. The formula goes on beyond its piece, so it is looked at over
//! the whole box: what holds there holds on the piece. A [`Guard`] tells which parts of the box hold nothing of the piece.

// A step names only steps before it, so every index is in range.
#![allow(clippy::indexing_slicing)]

use crate::certify::code::{Code, Room};
use crate::certify::form::Form;
use crate::certify::forward::{self, Domain, Slot};
use crate::certify::prover::side;
use crate::certify::step::{Known, Step, known};
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

/// Jumps that may be open in a box that is parted: each can double the pieces.
const OPEN: usize = 4;
/// Borders of one operation that are told at most.
const BORDERS: u32 = 16;
/// Pieces of one jump.
const PIECES: f64 = 3.0;

/// Where a piece lies: where a code's value is within an interval.
#[derive(Clone, Debug)]
pub(super) struct Guard {
    code: Code,
    within: Interval,
}

/// How a box lies to a guard's piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// All of it is in the piece.
    Inside,
    /// None of it is.
    Outside,
    /// Neither is certain.
    Both,
}

impl Guard {
    /// How many steps it takes to look at it.
    pub fn steps(&self) -> usize {
        self.code.steps.len()
    }

    /// What is known of the number by which the piece is told, and what it is within the piece. `slots` is room.
    pub(super) fn value<const D: usize>(&self, domain: &Domain<D>, slots: &mut Vec<Slot<D>>) -> (Slot<D>, Interval) {
        (forward::full(&self.code, domain, slots), self.within)
    }

    /// How a part of space lies to the piece. `slots` is room.
    pub(super) fn side<const D: usize>(&self, domain: &Domain<D>, slots: &mut Vec<Slot<D>>) -> Side {
        let value = forward::full(&self.code, domain, slots).range;
        if value.intersect(self.within).is_empty() {
            Side::Outside
        } else if value.intersect(self.within) == value {
            Side::Inside
        } else {
            Side::Both
        }
    }
}

/// The pieces of a box: of each its code and where it is. None where nothing jumps, or too much. `slots`: what is known of each step over
/// the box; `live` is room.
pub(super) fn parted<const D: usize>(code: &Code, slots: &[Slot<D>], live: &mut Vec<bool>) -> Option<Vec<(Code, Guard)>> {
    let (first, open) = open(code, slots, live, |op, arguments| {
        let [a, b, ..] = arguments;
        // What is made of something that jumps has to wait.
        let turns = op != Op::Atan2 || b.range.lo <= 0.0 && a.range.contains(0.0);
        op.row().jumps && turns && arguments.iter().all(|a| !a.jump)
    });
    if open > OPEN {
        return None;
    }
    let at = first?;
    let Step::Op(op, from) = code.steps[at] else { return None };
    match op {
        Op::Lt | Op::Le | Op::Eq => return Some(orders(code, at, from)),
        Op::Atan2 => return (slots[from[1] as usize].range.hi < 0.0).then(|| half_planes(code, at, from)),
        _ => {}
    }
    let out = slots[at].range;
    if !(out.is_finite() && out.width() < PIECES) {
        return None;
    }
    let argument = tidied(code, code.steps[..=from[0] as usize].to_vec());
    let mut pieces = Vec::new();
    let mut value = out.lo;
    while value <= out.hi {
        let within = preimage(op, value)?;
        pieces.push((replaced(code, at, &[Step::Constant(value)]), Guard { code: argument.clone(), within }));
        value += 1.0;
    }
    Some(pieces)
}

/// The sign that a code surely keeps all over a domain across its jumps, or 0. Looks at `left` pieces at most. What is known of each step over the
/// domain stands in `slots`, and is not there afterwards; the others are room.
pub(super) fn kept<const D: usize>(
    code: &Code,
    domain: &Domain<D>,
    slots: &mut Vec<Slot<D>>,
    ranges: &mut Vec<Interval>,
    live: &mut Vec<bool>,
    left: &mut usize,
) -> i8 {
    let mut sign = 0;
    for (piece, guard) in parted(code, slots, live).unwrap_or_default() {
        if guard.side(domain, slots) == Side::Outside {
            continue;
        }
        *left = left.saturating_sub(1);
        if *left == 0 {
            return 0;
        }
        let mut here = side(forward::natural(&piece, &domain.range, ranges));
        if here == 0 {
            let whole = forward::full(&piece, domain, slots);
            here = side(whole.range);
            if here == 0 && whole.jump {
                here = kept(&piece, domain, slots, ranges, live, left);
            }
        }
        if here == 0 || here == -sign {
            return 0;
        }
        sign = here;
    }
    sign
}

/// The first step of some kind of those that matter and are not settled, and how many there are.
fn open<const D: usize>(
    code: &Code,
    slots: &[Slot<D>],
    live: &mut Vec<bool>,
    kind: impl Fn(Op, &[Slot<D>; 4]) -> bool,
) -> (Option<usize>, usize) {
    live.clear();
    live.resize(code.steps.len(), false);
    live.iter_mut().rev().take(1).for_each(|last| *last = true);
    let (mut first, mut count) = (None, 0);
    for (i, step) in code.steps.iter().enumerate().rev() {
        if let (true, Step::Form(_, from)) = (live[i], *step) {
            live[from[0] as usize] = true;
        }
        let (true, Step::Op(op, from)) = (live[i], *step) else { continue };
        let arguments = from.map(|a| slots[a as usize]);
        match known(op, arguments.map(|a| a.range), slots[i].range) {
            Known::Argument(k) => live[from[k] as usize] = true,
            Known::Negated => live[from[0] as usize] = true,
            Known::Constant(_) => {}
            Known::Open => {
                from[..usize::from(op.row().arity)].iter().for_each(|&a| live[a as usize] = true);
                if kind(op, &arguments) {
                    (first, count) = (Some(i), count + 1);
                }
            }
        }
    }
    (first, count)
}

/// Both sides of a kink, where there is one in a box: of each its code and where it is. `slots`: what is known of each step over the box, in which
/// nothing jumps; `live` is room.
pub(super) fn at_kink<const D: usize>(code: &Code, slots: &[Slot<D>], live: &mut Vec<bool>) -> Option<[(Code, Guard); 2]> {
    let at = open(code, slots, live, |op, _| matches!(op, Op::Min | Op::Max | Op::Abs)).0?;
    let Step::Op(op, from) = code.steps[at] else { return None };
    let below = Interval { lo: f64::NEG_INFINITY, hi: 0.0 };
    // The same value under a name of its own.
    let same = |a: u32| Step::Form(Form::Rest(f64::NEG_INFINITY, f64::INFINITY), [a, 0, 0, 0]);
    let [a, b, ..] = from;
    let (compared, less, more) = match op {
        Op::Abs => (code.steps[..=a as usize].to_vec(), Step::Op(Op::Neg, [a, 0, 0, 0]), same(a)),
        _ => {
            let mut steps = code.steps[..at].to_vec();
            steps.push(Step::Op(Op::Sub, from));
            if op == Op::Min { (steps, same(a), same(b)) } else { (steps, same(b), same(a)) }
        }
    };
    let compared = tidied(code, compared);
    let side = |by: Step, within: Interval| (replaced(code, at, &[by]), Guard { code: compared.clone(), within });
    Some([side(less, below), side(more, below.neg())])
}

/// About where in a part of a ray operations jump, in the order of the code, as far as it can be told. `slots`: what is known of each step over the segment
/// about `middle`.
pub(super) fn borders(code: &Code, slots: &[Slot<1>], middle: f64, part: Interval) -> Vec<f64> {
    let mut found = Vec::new();
    for step in &code.steps {
        let Step::Op(op, [a, b, ..]) = *step else { continue };
        let (a, b) = (&slots[a as usize], &slots[b as usize]);
        let (value, range, [slope]) = match op {
            Op::Floor | Op::Ceil | Op::Trunc | Op::Round | Op::Sign => (a.centre, a.range, a.gradient),
            Op::Lt | Op::Le if !b.jump => (a.centre.sub(b.centre), a.range.sub(b.range), [a.gradient[0].sub(b.gradient[0])]),
            _ => continue,
        };
        if a.jump || slope.contains(0.0) || !range.is_finite() {
            continue;
        }
        let mut add = |border: f64| {
            let at = middle + (border - value.middle()) / slope.middle();
            if part.contains(at) {
                found.push(at);
            }
        };
        match op {
            Op::Sign | Op::Lt | Op::Le => add(0.0),
            _ => {
                let aside = if op == Op::Round { 0.5 } else { 0.0 };
                let first = (range.lo - aside).ceil() + aside;
                (0..BORDERS).map(|n| first + f64::from(n)).take_while(|border| *border <= range.hi).for_each(add);
            }
        }
    }
    found
}

/// Of a comparison: less, equal and greater. What else compares the same two numbers is settled with it.
fn orders(code: &Code, at: usize, from: [u32; 4]) -> Vec<(Code, Guard)> {
    let mut difference = code.steps[..at].to_vec();
    difference.push(Step::Op(Op::Sub, from));
    let difference = tidied(code, difference);
    let [a, b, ..] = from;
    let settled = |order: f64| {
        let mut code = code.clone();
        for step in &mut code.steps {
            if let Step::Op(op @ (Op::Lt | Op::Le | Op::Eq), [x, y, ..]) = *step
                && ((x, y) == (a, b) || (x, y) == (b, a))
            {
                let (x, y) = if x == a { (order, 0.0) } else { (0.0, order) };
                *step = Step::Constant((op.row().value)([x, y, 0.0, 0.0]));
            }
        }
        code
    };
    let mut pieces: Vec<(Code, Guard)> = Vec::new();
    let below = Interval { lo: f64::NEG_INFINITY, hi: 0.0 };
    for (order, within) in [(-1.0, below), (1.0, below.neg()), (0.0, Interval::ZERO)] {
        let code = settled(order);
        // Where equality makes no difference it belongs to one of the others.
        if !pieces.iter().any(|(other, _)| other.steps == code.steps) {
            pieces.push((code, Guard { code: difference.clone(), within }));
        }
    }
    pieces
}

/// Of an angle left of the origin: above and below, where it does not turn over.
fn half_planes(code: &Code, at: usize, from: [u32; 4]) -> Vec<(Code, Guard)> {
    let next = at as u32;
    let argument = tidied(code, code.steps[..=from[0] as usize].to_vec());
    let half = |sign: f64, y: Step, x: [u32; 2], within: Interval| {
        // atan2(y, x) is pi/2 + atan2(-x, y) above, and -pi/2 + atan2(x, -y) below.
        let angle = [Step::Constant(sign * FRAC_PI_2), y, Step::Op(Op::Atan2, [x[0], x[1], 0, 0]), Step::Op(Op::Add, [next, next + 2, 0, 0])];
        (replaced(code, at, &angle), Guard { code: argument.clone(), within })
    };
    let [y, x, ..] = from;
    let above = Interval { lo: 0.0, hi: f64::INFINITY };
    vec![
        half(1.0, Step::Op(Op::Neg, [x, 0, 0, 0]), [next + 1, y], above),
        half(-1.0, Step::Op(Op::Neg, [y, 0, 0, 0]), [x, next + 1], above.neg()),
    ]
}

/// For which arguments a step function has a value, or touches it.
fn preimage(op: Op, value: f64) -> Option<Interval> {
    let below = Interval { lo: f64::NEG_INFINITY, hi: 0.0 };
    let (lo, hi) = match op {
        Op::Floor => (0.0, 1.0),
        Op::Ceil => (-1.0, 0.0),
        Op::Round => (-0.5, 0.5),
        Op::Trunc => (if value > 0.0 { 0.0 } else { -1.0 }, if value < 0.0 { 0.0 } else { 1.0 }),
        Op::Sign if value == 0.0 => return Some(Interval::ZERO),
        Op::Sign => return Some(if value > 0.0 { below.neg() } else { below }),
        _ => return None,
    };
    Some(Interval { lo: value + lo, hi: value + hi })
}

/// A code in which other steps stand for one of its steps.
fn replaced(code: &Code, at: usize, by: &[Step]) -> Code {
    let more = by.len() as u32 - 1;
    let moved = |a: u32| if a as usize >= at { a + more } else { a };
    let mut steps = code.steps[..at].to_vec();
    steps.extend(by);
    steps.extend(code.steps[at + 1..].iter().map(|step| match *step {
        Step::Op(op, from) => Step::Op(op, from.map(moved)),
        Step::Form(form, from) => Step::Form(form, from.map(moved)),
        other => other,
    }));
    Code { steps, polynomials: code.polynomials.clone() }
}

/// Steps of a code, only those that the last one needs.
fn tidied(code: &Code, steps: Vec<Step>) -> Code {
    let code = Code { steps, polynomials: code.polynomials.clone() };
    code.shorter(|_| Interval::ALL, &mut Room::default()).unwrap_or(code)
}

/// What of a part of space can lie in all of the guards' pieces, none where nothing can; guards that hold all of it are dropped.
pub(super) fn within<const D: usize>(guards: &mut Vec<Arc<Guard>>, domain: &Domain<D>, slots: &mut Vec<Slot<D>>) -> Option<[Interval; D]> {
    let mut left = Some(domain.range);
    guards.retain(|guard| {
        let Some(range) = &mut left else { return true };
        let value = forward::full(&guard.code, domain, slots);
        if value.range.intersect(guard.within) == value.range {
            return false;
        }
        let held = match value {
            _ if value.range.intersect(guard.within).is_empty() => None,
            Slot { jump: true, .. } => Some(domain.range),
            Slot { centre, gradient, .. } => domain.holding(centre, &gradient, guard.within),
        };
        left = held.and_then(|held| meet(range, &held));
        true
    });
    left
}

/// What two boxes have in common, if anything.
fn meet<const D: usize>(a: &[Interval; D], b: &[Interval; D]) -> Option<[Interval; D]> {
    let mut both = *a;
    both.iter_mut().zip(b).for_each(|(x, y)| *x = x.intersect(*y));
    both.iter().all(|x| !x.is_empty()).then_some(both)
}
