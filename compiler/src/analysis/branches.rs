//! Kinks, branch by branch.
//!
//! The constant of a continuous piecewise formula is the largest of its pieces', not of their hull. Where a box straddles a kink of `min`,
//! `max`, `abs` or `select`, each side is taken by itself, and what that says is carried back to the steps before: `min(m, 0) = m` says
//! `m <= 0`, so every term of m's `max` is at most 0 there. Sides that exclude each other vanish.

use super::dual::{Dual, Side};
use super::tape::{Step, Tape};
use crate::graph::interval::Interval;
use crate::graph::kernel::{self, Op};

/// The sides chosen so far, and what they say of each step's value.
#[derive(Clone, Debug)]
pub struct Branches {
    sides: Vec<Option<Side>>,
    within: Vec<Interval>,
}

impl Branches {
    pub(super) fn none(steps: usize) -> Self {
        Self { sides: vec![None; steps], within: vec![Interval::ALL; steps] }
    }

    /// The side chosen at a step.
    pub fn side(&self, step: usize) -> Option<Side> {
        self.sides.get(step).copied().flatten()
    }

    /// What the choices say of a step's value.
    pub fn within(&self, step: usize) -> Interval {
        self.within.get(step).copied().unwrap_or(Interval::ALL)
    }

    fn choose(&mut self, step: usize, side: Side) {
        if let Some(slot) = self.sides.get_mut(step) {
            slot.get_or_insert(side);
        }
    }

    fn limit(&mut self, step: usize, to: Interval) {
        if let Some(slot) = self.within.get_mut(step) {
            *slot = slot.intersect(to);
        }
    }

    /// The same with one more choice, and what follows from it for the steps that it depends on.
    pub(super) fn take(&self, tape: &Tape, values: &[Dual], step: usize, side: Side) -> Self {
        let mut next = self.clone();
        next.choose(step, side);
        let first = side == Side::First;
        match tape.steps.get(step) {
            Some(Step::Op(Op::Min, args)) => next.order(tape, values, args, first),
            Some(Step::Op(Op::Max, args)) => next.order(tape, values, args, !first),
            Some(Step::Op(Op::Abs, args)) => {
                if let Some(&a) = args.first() {
                    next.limit(a, if first { Interval::new(0.0, f64::INFINITY) } else { Interval::new(f64::NEG_INFINITY, 0.0) });
                    next.sign(tape, values, a, !first);
                }
            }
            // The line itself, on which the angle turns over, belongs to neither.
            Some(Step::Op(Op::Atan2, args)) => {
                if let Some(&y) = args.first() {
                    let least = f64::from_bits(1);
                    next.limit(y, if first { Interval::new(least, f64::INFINITY) } else { Interval::new(f64::NEG_INFINITY, -least) });
                }
            }
            Some(Step::Op(Op::Select, args)) => {
                if let Some(&c) = args.first() {
                    next.limit(c, if first { Interval::ONE } else { Interval::ZERO });
                    next.condition(tape, values, c, first);
                }
            }
            _ => {}
        }
        next.carry_back(tape, values);
        next
    }

    /// A condition holds, or it does not.
    fn condition(&mut self, tape: &Tape, values: &[Dual], step: usize, holds: bool) {
        match tape.steps.get(step) {
            Some(Step::Op(Op::Lt | Op::Le, args)) => self.order(tape, values, args, holds),
            Some(Step::Op(Op::Not, args)) => {
                if let Some(&a) = args.first() {
                    self.condition(tape, values, a, !holds);
                }
            }
            Some(Step::Op(op @ (Op::And | Op::Or), args)) if holds == (*op == Op::And) => {
                for &a in args {
                    self.condition(tape, values, a, holds);
                }
            }
            _ => {}
        }
    }

    /// A step is at most zero, or at least: if it is a difference, that says which of the two is the smaller.
    fn sign(&mut self, tape: &Tape, values: &[Dual], step: usize, negative: bool) {
        if let Some(Step::Op(Op::Sub, args)) = tape.steps.get(step) {
            self.order(tape, values, args, negative);
        }
    }

    /// Of a pair of steps the first is at most the second, or at least.
    fn order(&mut self, tape: &Tape, values: &[Dual], pair: &[usize], ascending: bool) {
        let &[a, b] = pair else { return };
        let (low, high) = if ascending { (a, b) } else { (b, a) };
        let range = |s: usize| values.get(s).map_or(Interval::ALL, |d| d.value);
        self.limit(low, Interval::new(f64::NEG_INFINITY, range(high).hi));
        self.limit(high, Interval::new(range(low).lo, f64::INFINITY));
        if range(high) == Interval::ZERO {
            self.sign(tape, values, low, true);
        } else if range(low) == Interval::ZERO {
            self.sign(tape, values, high, false);
        }
        // Whatever else is asked of the same two is known now.
        for (i, other) in tape.steps.iter().enumerate() {
            let Step::Op(op, args) = other else { continue };
            let &[x, y] = args.as_slice() else { continue };
            let same = (x, y) == (low, high);
            if !same && (x, y) != (high, low) {
                continue;
            }
            match op {
                Op::Sub if same => self.limit(i, Interval::new(f64::NEG_INFINITY, 0.0)),
                Op::Sub => self.limit(i, Interval::new(0.0, f64::INFINITY)),
                Op::Min => self.choose(i, if same { Side::First } else { Side::Second }),
                Op::Max => self.choose(i, if same { Side::Second } else { Side::First }),
                _ => {}
            }
        }
    }

    /// What is known of a step says something of the steps that it is made of.
    fn carry_back(&mut self, tape: &Tape, values: &[Dual]) {
        for (i, step) in tape.steps.iter().enumerate().rev() {
            let Step::Op(op, args) = step else { continue };
            let known = self.within(i);
            let Some(before) = values.get(i) else { continue };
            if known == Interval::ALL || known.intersect(before.value) == before.value {
                continue;
            }
            let range = |b: &Self, k: usize| {
                args.get(k).map_or(Interval::ALL, |&a| {
                    values.get(a).map_or(Interval::ALL, |d| d.value).intersect(b.within(a))
                })
            };
            let target = known.intersect(before.value);
            for (k, &arg) in args.iter().enumerate() {
                let narrowed = backward(*op, k, range(self, 0), range(self, 1), target, self.side(i));
                self.limit(arg, narrowed);
            }
        }
    }
}

/// Where an exponential, a logarithm, or a power with an exponent within `b` is within `target`. They grow, and are flat at their ends.
fn grown_from(op: Op, b: Interval, target: Interval) -> Interval {
    let inverse = |y: f64| match op {
        Op::Exp => y.ln(),
        Op::Log => y.exp(),
        _ => y.powf(1.0 / b.lo).max(y.powf(1.0 / b.hi)),
    };
    let flat = |far: f64| kernel::value(op, &[far, b.lo]);
    let (low, high) = if op == Op::Log { (flat(0.0), f64::INFINITY) } else { (0.0, flat(f64::MAX)) };
    if !(low < target.hi && target.hi < high) || op == Op::Pow && b.lo <= 0.0 {
        return Interval::ALL;
    }
    Interval::new(f64::NEG_INFINITY, Interval::point(target.hi).monotone(inverse).hi)
}

/// What an operation's result within `target` says of its `k`-th argument, the first two being within `a` and `b`.
pub(super) fn backward(op: Op, k: usize, a: Interval, b: Interval, target: Interval, side: Option<Side>) -> Interval {
    let all = Interval::ALL;
    // What is not zero is no product with zero, and no quotient by it.
    let is_some = !target.contains(0.0);
    match (op, k) {
        (Op::Add, 0) => target.sub(b),
        (Op::Add, 1) => target.sub(a),
        (Op::Sub, 0) => target.add(b),
        (Op::Sub, 1) => a.sub(target),
        (Op::Neg, _) => target.neg(),
        (Op::Mul, 0) if is_some || !b.contains(0.0) => target.div(b),
        (Op::Mul, 1) if is_some || !a.contains(0.0) => target.div(a),
        (Op::Div, 0) if is_some || !b.contains(0.0) => target.mul(b),
        (Op::Div, 1) if is_some => a.div(target),
        (Op::Min, 0) if side == Some(Side::First) => target,
        (Op::Min, 1) if side == Some(Side::Second) => target,
        (Op::Max, 0) if side == Some(Side::First) => target,
        (Op::Max, 1) if side == Some(Side::Second) => target,
        (Op::Min, _) => Interval::new(target.lo, f64::INFINITY),
        (Op::Max, _) => Interval::new(f64::NEG_INFINITY, target.hi),
        (Op::Abs, _) => match side {
            Some(Side::First) => target,
            Some(Side::Second) => target.neg(),
            None => Interval::new(-target.hi, target.hi),
        },
        (Op::Square, _) => {
            let side = target.sqrt().hi;
            Interval::new(-side, side)
        }
        (Op::Sqrt, _) => Interval::new(f64::NEG_INFINITY, Interval::point(target.hi.max(0.0)).square().hi),
        (Op::Exp | Op::Log, _) | (Op::Pow, 0) => grown_from(op, b, target),
        (Op::Floor | Op::Ceil | Op::Round | Op::Trunc, _) => Interval::new(target.lo - 1.0, target.hi + 1.0),
        (Op::Length2 | Op::Length3 | Op::Length4, _) => Interval::new(-target.hi, target.hi),
        (Op::Select, 1) if side == Some(Side::First) => target,
        (Op::Select, 2) if side == Some(Side::Second) => target,
        _ => all,
    }
}
