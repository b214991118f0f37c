//! Kinks, branch by branch.
//!
//! Where a box straddles a kink (`min`, `max`, `abs`, `select`) each branch is taken by itself, and its condition is carried through the
//! code, forward and backward, until nothing changes: `min(m, 0) = m` says `m <= 0`, so each term of m's maximum is `<= 0`. Branches
//! that contradict each other vanish. Carrying ranges backward is hull consistency (HC4; Benhamou, Goualard, Granvilliers and Puget,
//! "Revising Hull and Box Consistency", ICLP 1999).

// A step names only steps before it, so every index is in range.
#![allow(clippy::indexing_slicing)]

use crate::certify::code::Code;
use crate::certify::forward::{Slot, derive, formed};
use crate::certify::step::{Known, Step, known};
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use rustc_hash::FxHashMap;

/// How often ranges are carried forward and back for one branch.
const ROUNDS: usize = 3;

/// A part of the box on which every choice is settled, or the hull where the budget of branches is used up.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece<const D: usize> {
    pub gradient: [Interval; D],
    pub norm: f64,
    pub jump: bool,
}

/// What is settled on the way down: a range and a choice for each step.
#[derive(Clone, Debug, Default)]
struct Level {
    ranges: Vec<Interval>,
    chosen: Vec<Known>,
}

/// Room for the enumeration.
#[derive(Clone, Debug, Default)]
pub(super) struct Branches<const D: usize> {
    levels: Vec<Level>,
    /// By the arguments of a choice or a comparison: the step that is their difference.
    differences: FxHashMap<(u32, u32), u32>,
    live: Vec<bool>,
    slots: Vec<Slot<D>>,
}

impl<const D: usize> Branches<D> {
    /// Hands over each piece of the code's last step, until `piece` wants no more. `slots`: what is known of the steps over the box. At most
    /// about `limit` branches are looked at; beyond that the hull of what is left. The answer: how many steps were looked at.
    pub(super) fn each(&mut self, code: &Code, slots: &[Slot<D>], limit: usize, mut piece: impl FnMut(Piece<D>) -> bool) -> u64 {
        if self.levels.is_empty() {
            self.levels.push(Level::default());
        }
        self.differences.clear();
        for (i, step) in code.steps.iter().enumerate() {
            if let Step::Op(Op::Sub, [a, b, ..]) = *step {
                self.differences.insert((a, b), i as u32);
            }
        }
        let first = &mut self.levels[0];
        first.ranges.clear();
        first.ranges.extend(slots.iter().map(|s| s.range));
        first.chosen.clear();
        first.chosen.resize(slots.len(), Known::Open);
        let mut left = limit;
        self.descend(code, 0, &mut left, &mut piece);
        ((limit - left) * code.steps.len()) as u64
    }

    /// False where `piece` wants no more.
    fn descend(&mut self, code: &Code, depth: usize, left: &mut usize, piece: &mut impl FnMut(Piece<D>) -> bool) -> bool {
        *left = left.saturating_sub(1);
        if !self.settle(code, depth) {
            return true;
        }
        let open = if *left == 0 { None } else { self.kink(code, depth) };
        let Some((at, sides)) = open else {
            let found = self.gradient(code, depth);
            return piece(found);
        };
        if self.levels.len() < depth + 2 {
            self.levels.push(Level::default());
        }
        for side in sides {
            let [.., here, next] = &mut self.levels[..depth + 2] else { return true };
            next.ranges.clone_from(&here.ranges);
            next.chosen.clone_from(&here.chosen);
            next.chosen[at] = side;
            if !self.descend(code, depth + 1, left, piece) {
                return false;
            }
        }
        true
    }

    /// The last choice that the result depends on and that is open.
    fn kink(&mut self, code: &Code, depth: usize) -> Option<(usize, [Known; 2])> {
        let level = &self.levels[depth];
        self.live.clear();
        self.live.resize(code.steps.len(), false);
        *self.live.last_mut()? = true;
        for (i, step) in code.steps.iter().enumerate().rev() {
            if let (true, Step::Form(_, from)) = (self.live[i], *step) {
                self.live[from[0] as usize] = true;
            }
            let (true, Step::Op(op, from)) = (self.live[i], *step) else { continue };
            let settled = match level.chosen[i] {
                Known::Open => known(op, from.map(|a| level.ranges[a as usize]), level.ranges[i]),
                settled => settled,
            };
            match settled {
                Known::Argument(k) => self.live[from[k] as usize] = true,
                Known::Negated => self.live[from[0] as usize] = true,
                Known::Constant(_) => {}
                Known::Open => match op {
                    Op::Min | Op::Max => return Some((i, [Known::Argument(0), Known::Argument(1)])),
                    Op::Abs => return Some((i, [Known::Argument(0), Known::Negated])),
                    Op::Select => return Some((i, [Known::Argument(1), Known::Argument(2)])),
                    _ => from[..usize::from(op.row().arity)].iter().for_each(|&a| self.live[a as usize] = true),
                },
            }
        }
        None
    }

    fn gradient(&mut self, code: &Code, depth: usize) -> Piece<D> {
        let level = &self.levels[depth];
        self.slots.clear();
        for (i, step) in code.steps.iter().enumerate() {
            let range = level.ranges[i];
            self.slots.push(match *step {
                Step::Input(k) => Slot::input(usize::from(k), range, range.lo),
                Step::Constant(value) => Slot::constant(value),
                Step::Op(op, from) => {
                    let arguments = from.map(|a| &self.slots[a as usize]);
                    let (gradient, norm, mut jump) = derive(op, arguments, range, level.chosen[i]);
                    // What stands still on each piece may still jump from one to the next: only over the whole box can be told that not.
                    if op == Op::Select || op.row().jumps {
                        let whole = &self.levels[0].ranges;
                        jump |= known(op, from.map(|a| whole[a as usize]), whole[i]) == Known::Open;
                    }
                    Slot { range, centre: range, gradient, norm, jump }
                }
                Step::Form(form, from) => Slot { range, ..formed(code, &self.slots, form, from) },
            });
        }
        let last = self.slots.last().copied().unwrap_or(Slot::ZERO);
        Piece { gradient: last.gradient, norm: last.norm, jump: last.jump }
    }

    /// Carries ranges through the code. False where they contradict each other: no point of the box takes these branches.
    fn settle(&mut self, code: &Code, depth: usize) -> bool {
        let level = &mut self.levels[depth];
        for _ in 0..ROUNDS {
            let mut changed = false;
            for (i, step) in code.steps.iter().enumerate() {
                if let Step::Form(form, [value, of @ ..]) = *step {
                    let told = form.range(&code.polynomials, of.map(|a| level.ranges[a as usize]));
                    let told = told.intersect(level.ranges[value as usize]);
                    if !narrow(&mut level.ranges[i], told, &mut changed) {
                        return false;
                    }
                }
                let Step::Op(op, from) = *step else { continue };
                let arguments = from.map(|a| level.ranges[a as usize]);
                if let (Op::Min | Op::Max, Known::Open) = (op, level.chosen[i]) {
                    level.chosen[i] = told(&level.ranges, &self.differences, op, from);
                }
                let image = match level.chosen[i] {
                    Known::Argument(k) => arguments[k],
                    Known::Negated => arguments[0].neg(),
                    Known::Constant(value) => Interval::point(value),
                    Known::Open => (op.row().interval)(arguments),
                };
                if !narrow(&mut level.ranges[i], image, &mut changed) {
                    return false;
                }
            }
            for (i, step) in code.steps.iter().enumerate().rev() {
                if let Step::Form(_, [value, ..]) = *step {
                    let out = level.ranges[i];
                    if !narrow(&mut level.ranges[value as usize], out, &mut changed) {
                        return false;
                    }
                }
                let Step::Op(op, from) = *step else { continue };
                if !back(level, &self.differences, op, from, i, &mut changed) {
                    return false;
                }
            }
            if !changed {
                break;
            }
        }
        true
    }
}

/// Which argument a `min` or `max` takes, where the difference of the two, which a step computes, has a known sign. So the sides of an
/// `abs` of the difference settle it too; without that the pairs that exclude each other would meet where the difference is zero.
fn told(ranges: &[Interval], differences: &FxHashMap<(u32, u32), u32>, op: Op, [a, b, ..]: [u32; 4]) -> Known {
    let difference = |x: u32, y: u32| differences.get(&(x, y)).map_or(Interval::ALL, |&i| ranges[i as usize]);
    let (one, other) = (difference(a, b), difference(b, a));
    let smaller = if one.hi <= 0.0 || other.lo >= 0.0 {
        0
    } else if one.lo >= 0.0 || other.hi <= 0.0 {
        1
    } else {
        return Known::Open;
    };
    Known::Argument(if op == Op::Min { smaller } else { 1 - smaller })
}

/// Narrows a range; false where nothing is left.
fn narrow(range: &mut Interval, to: Interval, changed: &mut bool) -> bool {
    let less = range.intersect(to);
    if less != *range {
        // A range that has become only a little shorter is not worth another round.
        *changed |= less.width() < 0.9 * range.width();
        *range = less;
    }
    !less.is_empty()
}

fn at_least(x: Interval) -> Interval {
    Interval { lo: x.lo, hi: f64::INFINITY }
}

fn at_most(x: Interval) -> Interval {
    Interval { lo: f64::NEG_INFINITY, hi: x.hi }
}

/// What an operation's values say of its arguments. False where that is a contradiction.
fn back(level: &mut Level, differences: &FxHashMap<(u32, u32), u32>, op: Op, from: [u32; 4], at: usize, changed: &mut bool) -> bool {
    let out = level.ranges[at];
    let chosen = level.chosen[at];
    let [a, b, ..] = from.map(|i| level.ranges[i as usize]);
    let ranges = &mut level.ranges;
    let mut set = |k: usize, to: Interval| narrow(&mut ranges[from[k] as usize], to, changed);
    match (op, chosen) {
        (Op::Add, _) => set(0, out.sub(b)) && set(1, out.sub(a)),
        (Op::Sub, _) => set(0, out.add(b)) && set(1, a.sub(out)),
        (Op::Neg, _) => set(0, out.neg()),
        (Op::Mul, _) => (b.contains(0.0) || set(0, out.div(b))) && (a.contains(0.0) || set(1, out.div(a))),
        (Op::Div, _) if !b.contains(0.0) => set(0, out.mul(b)),
        (Op::Square, _) => {
            let root = out.sqrt();
            set(0, if a.lo >= 0.0 { root } else { Interval { lo: -root.hi, hi: root.hi } })
        }
        (Op::Sqrt, _) => {
            let square = out.square();
            set(0, if out.lo > 0.0 { square } else { at_most(square) })
        }
        (Op::Length2 | Op::Length3 | Op::Length4, _) => {
            (0..usize::from(op.row().arity)).all(|k| set(k, Interval { lo: -out.hi, hi: out.hi }))
        }
        (Op::Abs, Known::Argument(_)) => set(0, Interval { lo: out.lo.max(0.0), hi: out.hi }),
        (Op::Abs, Known::Negated) => set(0, Interval { lo: -out.hi, hi: -out.lo.max(0.0) }),
        (Op::Abs, _) => set(0, Interval { lo: -out.hi, hi: out.hi }),
        (Op::Min, Known::Argument(k)) => {
            let (this, other) = if k == 0 { (a, b) } else { (b, a) };
            set(k, out) && set(k, at_most(other)) && set(1 - k, at_least(this)) && ordered(ranges, differences, from, k, changed)
        }
        (Op::Max, Known::Argument(k)) => {
            let (this, other) = if k == 0 { (a, b) } else { (b, a) };
            set(k, out) && set(k, at_least(other)) && set(1 - k, at_most(this)) && ordered(ranges, differences, from, 1 - k, changed)
        }
        (Op::Min, _) => set(0, at_least(out)) && set(1, at_least(out)),
        (Op::Max, _) => set(0, at_most(out)) && set(1, at_most(out)),
        (Op::Select, Known::Argument(k)) => set(k, out) && set(0, if k == 1 { Interval::ONE } else { Interval::ZERO }),
        (Op::Lt | Op::Le, _) if out == Interval::ONE => {
            set(0, at_most(b)) && set(1, at_least(a)) && ordered(ranges, differences, from, 0, changed)
        }
        (Op::Lt | Op::Le, _) if out == Interval::ZERO => {
            set(0, at_least(b)) && set(1, at_most(a)) && ordered(ranges, differences, from, 1, changed)
        }
        (Op::And, _) if out == Interval::ONE => set(0, Interval::ONE) && set(1, Interval::ONE),
        (Op::Or, _) if out == Interval::ZERO => set(0, Interval::ZERO) && set(1, Interval::ZERO),
        (Op::Not, _) if out.is_point() => set(0, if out == Interval::ONE { Interval::ZERO } else { Interval::ONE }),
        _ => true,
    }
}

/// Carries `smaller <= the other of the two arguments` into their difference, where a step computes it.
fn ordered(
    ranges: &mut [Interval],
    differences: &FxHashMap<(u32, u32), u32>,
    [a, b, ..]: [u32; 4],
    smaller: usize,
    changed: &mut bool,
) -> bool {
    let (small, large) = if smaller == 0 { (a, b) } else { (b, a) };
    let below = Interval { lo: f64::NEG_INFINITY, hi: 0.0 };
    let found = |x: u32, y: u32| differences.get(&(x, y)).map(|&i| i as usize);
    found(small, large).is_none_or(|i| narrow(&mut ranges[i], below, changed))
        && found(large, small).is_none_or(|i| narrow(&mut ranges[i], below.neg(), changed))
}
