//! Intervals with derivatives: all values and all gradients over a box, with a bound of the gradient's norm.
//!
//! The norm is kept beside the components, because `length` has a gradient of norm one though each of its components
//! can reach one, and because a turn by any angle, varying or not, is an isometry.

use super::branches::{self, Branches, Side};
use super::rules::claims::claimed;
use super::rules::jacobian_norm::{chain_norm, map_norm, point_norm};
use super::rules::rotated_distance::turned_norm;
use super::slopes::slopes;
use super::tape::{Step, Tape};
use super::{leaf_range, Box3, Domain, Facts, Pinned};
use crate::graph::algebra::Algebra;
use crate::graph::interval::Interval;
use crate::graph::kernel::{self, Op};
use crate::graph::{Claim, ClaimGroup, Graph, Leaf, ShapeId};
use crate::rules::Rule;
use smallvec::SmallVec;
use std::ops::Range;

/// Jumps in the formula itself.
pub const JUMPS_HERE: u8 = 1;
/// Jumps in the formula of a shape that it calls.
pub const JUMPS_INSIDE: u8 = 2;

/// All values and gradients over a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual {
    /// All values.
    pub value: Interval,
    /// All components of the gradient, on each piece.
    pub gradient: [Interval; 3],
    /// A bound of the gradient's norm.
    pub norm: f64,
    /// Where it may jump.
    pub jumps: u8,
}

impl Dual {
    /// A value that does not depend on the point.
    pub fn constant(value: Interval) -> Self {
        Self { value, gradient: [Interval::ZERO; 3], norm: 0.0, jumps: 0 }
    }

    /// A value of which nothing else is known.
    pub fn unknown(value: Interval) -> Self {
        Self { value, gradient: [Interval::ALL; 3], norm: f64::INFINITY, jumps: 0 }
    }

    /// A coordinate of the point.
    pub fn coordinate(i: usize, value: Interval) -> Self {
        let mut gradient = [Interval::ZERO; 3];
        if let Some(slot) = gradient.get_mut(i) {
            *slot = Interval::ONE;
        }
        Self { value, gradient, norm: 1.0, jumps: 0 }
    }

    /// With a gradient whose norm is known to be at most `limit`.
    pub fn limited(mut self, limit: f64) -> Self {
        self.norm = self.norm.min(limit);
        let side = Interval::new(-self.norm, self.norm);
        for g in &mut self.gradient {
            *g = g.intersect(side);
            if g.is_empty() {
                *g = side;
            }
        }
        self
    }

    /// The norm as far as the components tell it, rounded up.
    pub(super) fn components_norm(gradient: &[Interval; 3]) -> f64 {
        let sum = gradient.iter().fold(0.0, |s: f64, g| s + g.magnitude() * g.magnitude());
        // One exact component alone keeps its exact norm.
        let mut others = gradient.iter().filter(|g| g.magnitude() > 0.0);
        match (others.next(), others.next()) {
            (None, _) => 0.0,
            (Some(one), None) => one.magnitude(),
            _ => sum.sqrt().next_up(),
        }
    }

    /// With a gradient that is known to be within another one too.
    pub(super) fn within(mut self, gradient: [Interval; 3], norm: f64) -> Self {
        for (own, other) in self.gradient.iter_mut().zip(gradient) {
            let both = own.intersect(other);
            *own = if both.is_empty() { other } else { both };
        }
        self.limited(norm)
    }

    fn new(value: Interval, gradient: [Interval; 3], norm: f64, jumps: u8) -> Self {
        let norm = norm.min(Self::components_norm(&gradient));
        Self { value, gradient, norm: if norm.is_nan() { f64::INFINITY } else { norm }, jumps }
    }

    fn hull(self, other: Self) -> ([Interval; 3], f64) {
        let mut gradient = self.gradient;
        for (a, b) in gradient.iter_mut().zip(other.gradient) {
            *a = a.hull(b);
        }
        (gradient, self.norm.max(other.norm))
    }

    pub(super) fn scaled(&self, by: Interval) -> [Interval; 3] {
        self.gradient.map(|g| g.mul(by))
    }
}

pub(super) fn add(a: [Interval; 3], b: [Interval; 3]) -> [Interval; 3] {
    let mut sum = a;
    for (x, y) in sum.iter_mut().zip(b) {
        // Zero stays exactly zero, so that independent axes stay so.
        *x = if *x == Interval::ZERO {
            y
        } else if y == Interval::ZERO {
            *x
        } else {
            x.add(y)
        };
    }
    sum
}

/// The algebra of duals. Calls and lengths, which need to see more than their arguments, are handled by [`run`].
pub struct Duals {
    /// Values of the parameters, where they stand at one.
    pub pinned: Pinned,
}

impl Algebra for Duals {
    type Value = Dual;

    fn constant(&mut self, value: f64) -> Dual {
        Dual::constant(Interval::point(value))
    }

    fn op(&mut self, op: Op, args: &[Dual]) -> Dual {
        let mut values = [Interval::ZERO; 4];
        for (slot, arg) in values.iter_mut().zip(args) {
            *slot = arg.value;
        }
        let values = values.get(..args.len()).unwrap_or(&values);
        let value = kernel::interval(op, values);
        let jumps = args.iter().fold(0, |j, a| j | a.jumps);
        let moving = args.iter().any(|a| a.norm > 0.0);
        if !moving && jumps == 0 {
            return Dual::constant(value);
        }
        match (op, args) {
            (Op::Min | Op::Max, [a, b]) => {
                let (low, high) = (a.value, b.value);
                let first = if op == Op::Min { low.hi < high.lo } else { low.lo > high.hi };
                let second = if op == Op::Min { high.hi < low.lo } else { high.lo > low.hi };
                if first {
                    return Dual { value, ..*a };
                }
                if second {
                    return Dual { value, ..*b };
                }
                let (gradient, norm) = a.hull(*b);
                Dual::new(value, gradient, norm, jumps)
            }
            (Op::Select, [c, a, b]) => {
                if c.value == Interval::ONE {
                    return Dual { value, ..*a };
                }
                if c.value == Interval::ZERO {
                    return Dual { value, ..*b };
                }
                let (gradient, norm) = a.hull(*b);
                Dual::new(value, gradient, norm, jumps)
            }
            (Op::Abs, [a]) => {
                if a.value.lo >= 0.0 {
                    return *a;
                }
                let flipped = Dual { gradient: a.gradient.map(Interval::neg), ..*a };
                if a.value.hi <= 0.0 {
                    return Dual { value, ..flipped };
                }
                let (gradient, norm) = a.hull(flipped);
                Dual::new(value, gradient, norm, jumps)
            }
            (Op::Neg, [a]) => Dual { value, gradient: a.gradient.map(Interval::neg), ..*a },
            (Op::Floor | Op::Ceil | Op::Trunc | Op::Round | Op::Sign, [a]) => {
                let jumped = !value.is_point() && a.norm > 0.0;
                Dual { jumps: jumps | u8::from(jumped), ..Dual::constant(value) }
            }
            (Op::Lt | Op::Le | Op::Eq | Op::Hash, _) => {
                let jumped = !value.is_point() && moving;
                Dual { jumps: jumps | u8::from(jumped), ..Dual::constant(value) }
            }
            (Op::And | Op::Or | Op::Not, _) => {
                let decided = value.is_point();
                Dual { jumps: if decided { 0 } else { jumps }, ..Dual::constant(value) }
            }
            (Op::TurnU | Op::TurnV, [u, v, t]) => {
                let general = by_partials(op, args, values, value, jumps);
                let reach = u.value.square().add(v.value.square()).sqrt().hi;
                let turned = if t.norm == 0.0 { 0.0 } else { reach * t.norm };
                let norm = u.norm.hypot(v.norm).next_up() + turned;
                Dual::new(value, general.gradient, general.norm.min(norm), jumps)
            }
            _ => {
                let mut dual = by_partials(op, args, values, value, jumps);
                if op == Op::Atan2 {
                    // Turns over where the second is negative and the first changes its sign.
                    let (y, x) = (
                        values.first().copied().unwrap_or(Interval::ALL),
                        values.get(1).copied().unwrap_or(Interval::ALL),
                    );
                    if x.lo <= 0.0 && y.contains(0.0) {
                        dual.jumps |= JUMPS_HERE;
                    }
                }
                dual
            }
        }
    }

    fn claim(&mut self, graph: &Graph, value: Dual, claim: &Claim, of: &[Dual]) -> Dual {
        match claim {
            Claim::Continuous => Dual { jumps: value.jumps & !JUMPS_HERE, ..value },
            Claim::Lipschitz(..) => claimed(graph, &self.pinned, (value, claim), of, |_, norm| norm),
        }
    }
}

fn by_partials(op: Op, args: &[Dual], values: &[Interval], value: Interval, jumps: u8) -> Dual {
    let partials = slopes(op, values, value);
    let mut gradient = [Interval::ZERO; 3];
    let (mut sum, mut squares) = (0.0, 0.0);
    let mut touched = [false; 3];
    let mut apart = true;
    for (arg, partial) in args.iter().zip(partials) {
        let slope = partial.magnitude();
        if arg.norm == 0.0 || slope == 0.0 {
            continue;
        }
        gradient = add(gradient, arg.scaled(partial));
        for (known, g) in touched.iter_mut().zip(&arg.gradient) {
            let here = *g != Interval::ZERO;
            apart &= !(*known && here);
            *known |= here;
        }
        sum += slope * arg.norm;
        squares += (slope * arg.norm).powi(2);
    }
    // Terms that move along different axes are at right angles.
    let norm = if apart { sum.min(squares.sqrt().next_up()) } else { sum };
    Dual::new(value, gradient, norm, jumps)
}

/// Runs a tape over duals, on the sides that `branches` chooses. None where no point is on all of them. `undecided` becomes the first
/// kink that is worth a look at each side and has no side yet.
pub fn run(
    facts: &mut Facts,
    graph: &Graph,
    tape: &Tape,
    branches: Option<&Branches>,
    undecided: &mut Option<usize>,
    leaf: &dyn Fn(Leaf) -> Dual,
) -> Option<Vec<Dual>> {
    let algebra = &mut Duals { pinned: facts.pinned.clone() };
    facts.ran += tape.steps.len() as u64;
    facts.spend_on(tape, true);
    let mut values: Vec<Dual> = Vec::with_capacity(tape.steps.len());
    let mut tight = tape.tight().iter().peekable();
    for (i, step) in tape.steps.iter().enumerate() {
        let gather = |args: &[usize]| -> SmallVec<[Dual; 4]> {
            args.iter().filter_map(|&a| values.get(a).copied()).collect()
        };
        // An operation has at most four arguments.
        let few = |args: &[usize]| -> ([Dual; 4], usize) {
            let mut of = [Dual::constant(Interval::ZERO); 4];
            for (slot, value) in of.iter_mut().zip(args.iter().filter_map(|&a| values.get(a))) {
                *slot = *value;
            }
            (of, args.len().min(4))
        };
        let value = match step {
            Step::Constant(c) => algebra.constant(*c),
            Step::Leaf(l) => leaf(*l),
            Step::Op(op @ (Op::Length2 | Op::Length3 | Op::Length4), args) => {
                let norm = point_norm(tape, graph, &values, args);
                let (of, n) = few(args);
                let plain = algebra.op(*op, of.get(..n).unwrap_or(&of));
                Dual::new(plain.value, plain.limited(norm).gradient, norm.min(plain.norm), plain.jumps)
            }
            // A norm of a higher power is no steeper than the length.
            Step::Op(Op::Sqrt, args) if tape.rules.has(Rule::HigherNorm) && tape.raised(i).is_some() => {
                let norm = map_norm(tape, &values, &tape.raised(i).unwrap_or_default());
                let (of, n) = few(args);
                let plain = algebra.op(Op::Sqrt, of.get(..n).unwrap_or(&of));
                Dual::new(plain.value, plain.limited(norm).gradient, norm.min(plain.norm), plain.jumps)
            }
            Step::Op(Op::Abs, args) if args.first().is_some_and(|&a| is_mirrored(tape, &values, a)) => {
                let ([a, ..], _) = few(args);
                Dual { value: a.value.abs(), ..a }
            }
            Step::Op(op @ (Op::Min | Op::Max | Op::Abs | Op::Select), args) => {
                let (of, n) = few(args);
                let of = of.get(..n).unwrap_or(&of);
                let dual = match side_of(*op, of).or(branches.and_then(|b| b.side(i))) {
                    Some(side) => on_side(*op, of, side),
                    None => {
                        if undecided.is_none() && tape.is_kink(i) && of.iter().any(|d| d.norm > 0.0) {
                            *undecided = Some(i);
                        }
                        algebra.op(*op, of)
                    }
                };
                match of {
                    [_] if dual.jumps != 0 && tape.rules.has(Rule::AnglePeriodicity) && super::rules::angle_periodicity::is_same_after_turns(graph, *op, args, tape, &values) => Dual { jumps: 0, ..dual },
                    [_, a, b] if dual.jumps != 0 && tape.rules.has(Rule::ContinuousSelect) && let Some(compared) = tape.meets(i) => {
                        let jumps = compared.iter().fold(a.jumps | b.jumps, |jumps, &side| jumps | values.get(side).map_or(JUMPS_HERE, |d| d.jumps));
                        Dual { jumps, ..dual }
                    }
                    _ => dual,
                }
            }
            Step::Op(op, args) => {
                let (of, n) = few(args);
                let mut dual = algebra.op(*op, of.get(..n).unwrap_or(&of));
                if *op == Op::Div && graph.is_spread && args.get(1).is_some_and(|&b| tape.vanishes_rarely(b)) {
                    dual.value = dual.value.intersect(super::slopes::quotient_of_positive(of[0].value, of[1].value));
                }
                if dual.jumps != 0 && tape.rules.has(Rule::AnglePeriodicity) && super::rules::angle_periodicity::is_same_after_turns(graph, *op, args, tape, &values) {
                    dual.jumps = 0;
                }
                // What is never below zero, and zero on planes alone, does not cross the line on which the angle turns over.
                if *op == Op::Atan2 && tape.rules.has(Rule::UnsignedAngle) && args.iter().all(|&a| values.get(a).is_some_and(|d| d.jumps == 0)) && args.first().is_some_and(|&y| tape.touches_zero(y)) {
                    dual.jumps &= !JUMPS_HERE;
                }
                // The angle has two sides where it turns over.
                let over = *op == Op::Atan2 && dual.jumps & JUMPS_HERE != 0 && of.first().is_some_and(|y| y.value.contains(0.0));
                if over && undecided.is_none() && tape.is_kink(i) && branches.is_none_or(|b| b.side(i).is_none()) {
                    *undecided = Some(i);
                }
                dual
            }
            Step::Claim(Claim::Lipschitz(..), args) if !tape.rules.has(Rule::Claims) => few(args).0[0],
            Step::Claim(claim, args) => {
                let mut of = gather(args);
                if let Claim::Lipschitz(_, groups, _) = claim {
                    // For a shape its own constant counts, whatever moves the point at which it is asked for.
                    let mut at = 1;
                    for group in groups.iter() {
                        match group {
                            ClaimGroup::Vector(n) => at += usize::from(*n),
                            ClaimGroup::Values(n) | ClaimGroup::Bounds(n) => {
                                for k in at..at + *n as usize {
                                    let own = own_constant(facts, graph, tape, &values, args.get(k));
                                    if let (Some(slot), Some(norm)) = (of.get_mut(k), own) {
                                        slot.norm = norm;
                                        slot.jumps &= !JUMPS_HERE;
                                    }
                                }
                                at += *n as usize;
                            }
                        }
                    }
                }
                // A point that was folded and turned again and again keeps lengths, though its rows don't say so.
                let of_vector = |at: Range<usize>, norm: f64| match args.get(at.start + 1..at.end + 1) {
                    Some(rows) if norm > 1.0 && rows.len() > 1 => norm.min(chain_norm(tape, graph, &values, rows)),
                    _ => norm,
                };
                match (of.split_first(), claim) {
                    (Some((value, of)), Claim::Lipschitz(..)) => claimed(graph, &algebra.pinned, (*value, claim), of, of_vector),
                    (Some((value, of)), Claim::Continuous) => algebra.claim(graph, *value, claim, of),
                    (None, _) => algebra.constant(0.0),
                }
            }
            Step::Call(shape, args) => {
                let of = gather(args);
                let point = args.get(..3).unwrap_or(args);
                let norm = point_norm(tape, graph, &values, point);
                let dual = call(facts, graph, *shape, &of, norm);
                let turned = tape.rules.has(Rule::RotatedDistance).then(|| turned_norm(facts, graph, tape, *shape, args, &values)).flatten();
                match turned {
                    Some(most) if most < dual.norm => dual.limited(most),
                    _ => dual,
                }
            }
        };
        let value = match tight.next_if(|(step, _)| *step == i) {
            Some((_, tight)) => tight.bound(value, &values),
            None => value,
        };
        let value = match tape.soft(i).and_then(|soft| soft.bound(tape, graph, &values)) {
            Some((gradient, norm)) => value.within(gradient, norm),
            None => value,
        };
        values.push(match branches {
            Some(branches) => confined(value, branches.within(i))?,
            None => value,
        });
    }
    Some(values)
}

/// What is left of a value that is known to be within an interval; none where nothing is. A level set of a formula whose gradient is
/// never zero has no inside, so it does not count.
fn confined(mut dual: Dual, within: Interval) -> Option<Dual> {
    let value = dual.value.intersect(within);
    if value.is_empty() {
        return None;
    }
    if value.is_point() && !dual.value.is_point() && dual.gradient.iter().any(|g| !g.contains(0.0)) {
        return None;
    }
    dual.value = value;
    Some(dual)
}

/// Whether a step is a coordinate of the box, across whose middle plane the tape is its own mirror image.
fn is_mirrored(tape: &Tape, values: &[Dual], step: usize) -> bool {
    let Some(Step::Leaf(Leaf::P(i))) = tape.steps.get(step) else { return false };
    let Some(dual) = values.get(step) else { return false };
    tape.is_mirrored(*i)
        && dual.value.lo < 0.0
        && dual.value.hi > 0.0
        && *dual == Dual::coordinate(usize::from(*i), dual.value)
}

/// The side of a kink that the values alone decide.
pub(super) fn side_of(op: Op, args: &[Dual]) -> Option<Side> {
    let value = |i: usize| args.get(i).map_or(Interval::ALL, |d| d.value);
    let (a, b) = (value(0), value(1));
    let (first, second) = match op {
        Op::Min => (a.hi <= b.lo, b.hi <= a.lo),
        Op::Max => (a.lo >= b.hi, b.lo >= a.hi),
        Op::Abs => (a.lo >= 0.0, a.hi <= 0.0),
        _ => (a == Interval::ONE, a == Interval::ZERO),
    };
    match (first, second) {
        (true, _) => Some(Side::First),
        (_, true) => Some(Side::Second),
        _ => None,
    }
}

/// The value and gradient on one side of a kink.
pub(super) fn on_side(op: Op, args: &[Dual], side: Side) -> Dual {
    let dual = |i: usize| args.get(i).copied().unwrap_or(Dual::constant(Interval::ALL));
    let first = side == Side::First;
    let jumps = args.iter().fold(0, |j, d| j | d.jumps);
    match op {
        Op::Min | Op::Max => {
            let taken = dual(usize::from(!first));
            let hull = kernel::interval(op, &[dual(0).value, dual(1).value]);
            Dual { value: taken.value.intersect(hull), jumps, ..taken }
        }
        Op::Abs if first => Dual { value: dual(0).value.abs(), ..dual(0) },
        Op::Abs => Dual { value: dual(0).value.abs(), gradient: dual(0).gradient.map(Interval::neg), ..dual(0) },
        _ => Dual { jumps, ..dual(if first { 1 } else { 2 }) },
    }
}

/// Longer formulas are not looked at as functions of their distances.
const MOST_STEPS: usize = 400;

/// Value, gradient and norm of a tape's last step over all of its pieces, and how many runs that took. The gradient of mirrored axes has
/// both signs.
pub fn hull_of_pieces(facts: &mut Facts, graph: &Graph, tape: &Tape, leaf: &dyn Fn(Leaf) -> Dual) -> (Dual, usize) {
    let Some(last) = tape.steps.len().checked_sub(1).filter(|last| facts.looks_closely() && tape.chain(graph, &[*last]).is_some()) else {
        return pieces(facts, graph, tape, leaf);
    };
    let values = run(facts, graph, tape, None, &mut None, leaf).unwrap_or_default();
    let whole = values.get(last).copied().unwrap_or(Dual::constant(Interval::ALL));
    let most = if whole.norm > 1.0 { chain_norm(tape, graph, &values, &[last]) } else { whole.norm };
    if most <= 1.0 {
        return (both_sides(tape, whole.limited(most), leaf), 1);
    }
    let (dual, runs) = pieces(facts, graph, tape, leaf);
    (dual.limited(most), runs + 1)
}

/// The same, side by side of all kinks.
pub(super) fn pieces(facts: &mut Facts, graph: &Graph, tape: &Tape, leaf: &dyn Fn(Leaf) -> Dual) -> (Dual, usize) {
    let mut all: Option<Dual> = None;
    let closely = facts.looks_closely();
    let runs = branches::each_piece(facts, graph, tape, leaf, &mut |values, branches| {
        let Some(mut last) = values.last().copied() else { return };
        if closely && last.norm > 1.0 && values.len() <= MOST_STEPS {
            last = last.limited(super::rules::lipschitz_atoms::norm_by_atoms(tape, values, branches));
        }
        all = Some(match all {
            None => last,
            Some(known) => {
                let (gradient, norm) = known.hull(last);
                Dual { value: known.value.hull(last.value), gradient, norm, jumps: known.jumps | last.jumps }
            }
        });
    });
    (both_sides(tape, all.unwrap_or(Dual::constant(Interval::ALL)), leaf), runs)
}

/// What a run says of a tape, with both signs for the gradient of mirrored axes.
pub fn both_sides(tape: &Tape, mut dual: Dual, leaf: &dyn Fn(Leaf) -> Dual) -> Dual {
    for (i, g) in (0..3u8).zip(&mut dual.gradient) {
        let side = leaf(Leaf::P(i)).value;
        if tape.is_mirrored(i) && side.lo < 0.0 && side.hi > 0.0 {
            *g = g.hull(g.neg());
        }
    }
    dual
}

/// The constant of the shape that a step calls, in the shape's own space; none where it sees more that moves than its own point.
fn own_constant(
    facts: &mut Facts,
    graph: &Graph,
    tape: &Tape,
    values: &[Dual],
    step: Option<&usize>,
) -> Option<f64> {
    let Some(Step::Call(shape, args)) = tape.steps.get(*step?) else { return None };
    if args.iter().skip(3).any(|&a| values.get(a).is_none_or(|d| d.norm > 0.0)) {
        return None;
    }
    let ranges: Vec<Interval> =
        args.iter().map(|&a| values.get(a).map_or(Interval::ALL, |d| d.value)).collect();
    Some(facts.shape_dual(graph, *shape, &ranges).norm)
}

/// The field of a shape at a point whose coordinates are duals; `norm` bounds the norm of the point's Jacobian.
fn call(facts: &mut Facts, graph: &Graph, shape: ShapeId, args: &[Dual], norm: f64) -> Dual {
    let here = args.iter().fold(0, |j, a| j | a.jumps);
    let moving_variables = args.iter().skip(3).any(|a| a.norm > 0.0);
    if moving_variables && let Some(s) = graph.shape(shape) {
        // A variable moves with the point: the shape's formula is followed with the arguments' own derivatives.
        let variables = s.variables.clone();
        // Other arguments may move along with a coordinate, so that its two sides are no mirror images.
        let tape = facts.tape(graph, s.value).unmirrored();
        let pinned = facts.pinned.clone();
        let leaf = |leaf: Leaf| match leaf {
            Leaf::P(i) => args.get(usize::from(i)).copied().unwrap_or(Dual::constant(Interval::ALL)),
            Leaf::Variable(v) => variables
                .binary_search(&v)
                .ok()
                .and_then(|i| args.get(3 + i).copied())
                .unwrap_or(Dual::constant(Interval::ALL)),
            other => Dual::constant(leaf_range(graph, &pinned, other, &Domain::of(Box3::ALL))),
        };
        let mut dual = hull_of_pieces(facts, graph, &tape, &leaf).0;
        dual.jumps |= here;
        return dual;
    }
    let values: SmallVec<[Interval; 4]> = args.iter().map(|a| a.value).collect();
    let inner = facts.shape_dual(graph, shape, &values);
    let mut gradient = [Interval::ZERO; 3];
    for (arg, slope) in args.iter().zip(inner.gradient) {
        if arg.norm > 0.0 {
            gradient = add(gradient, arg.scaled(slope));
        }
    }
    let bound = if norm == 0.0 { 0.0 } else { norm * inner.norm };
    let inside = if inner.jumps != 0 { JUMPS_INSIDE } else { 0 };
    let jumps = inside | u8::from(here != 0);
    Dual::new(inner.value, gradient, bound, jumps).limited(bound)
}
