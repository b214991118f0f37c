//! Values with derivatives over a domain, the whole of a formula at once or piece by piece of its kinks.

use super::branches::Branches;
use super::chain::DEEP;
use super::domain::{Box3, Domain, call_domain, leaf_range};
use super::dual::{Dual, JUMPS_HERE, JUMPS_INSIDE, Side, add, leaf_dual, on_side, side_of};
use super::duals::Duals;
use super::facts::{Facts, MOST_KEPT};
use super::formula::Formula;
use super::rules::angle_periodicity::is_same_after_turns;
use super::rules::claims::claimed;
use super::rules::isometry_chain::{chain, chain_norm, point_norm};
use super::rules::jacobian_norm::map_norm;
use super::rules::rotated_distance::turned_norm;
use super::slopes::quotient_of_positive;
use super::tape::Step;
use crate::graph::algebra::Algebra;
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::{Claim, ClaimGroup, Exactness, Graph, Leaf, ShapeId};
use crate::rules::Rule;
use smallvec::SmallVec;
use std::ops::Range;

/// How many times a formula may be run over one box; beyond that the hull of what is left is taken.
const RUNS: usize = 128;
/// How many steps that may take, those of the shapes that it calls counted in, and their kinks.
const STEPS: u64 = 16_384;
/// How many times the steps of one constant all of it may cost.
const MOST_SHARES: u64 = 100;

impl Facts {
    /// Value, gradient and its norm of a shape's field over intervals of its arguments.
    pub fn shape_dual(&mut self, graph: &Graph, shape: ShapeId, args: &[Interval]) -> Dual {
        let Some(s) = graph.shape(shape) else { return Dual::constant(Interval::ALL) };
        self.dual_in(graph, shape, &call_domain(&s.variables, args))
    }

    /// The same over a domain of its own.
    fn dual_in(&mut self, graph: &Graph, shape: ShapeId, domain: &Domain) -> Dual {
        let Some(s) = graph.shape(shape) else { return Dual::constant(Interval::ALL) };
        let key = (shape, domain.key());
        if let Some(known) = self.duals.get(&key) {
            return *known;
        }
        if !self.enter() {
            return Dual { jumps: u8::MAX, ..Dual::unknown(Interval::ALL) };
        }
        let value = s.value;
        if self.looks.nested.0 >= DEEP {
            let known = |facts: &Self, shape, domain: &Domain| facts.duals.contains_key(&(shape, domain.key()));
            self.look_from_below(graph, value, domain, known, |facts, shape, domain| {
                facts.dual_in(graph, shape, &domain);
            });
        }
        let exact = s.exactness == Exactness::Exact;
        let tape = self.tape(graph, value);
        let dual = if exact {
            // Known without a look at its kinks.
            let plain = self.all_duals(graph, &tape, domain).last().copied().unwrap_or(Dual::constant(Interval::ALL));
            let pinned = self.pinned.clone();
            let whole = both_sides(&tape, plain, &|leaf| leaf_dual(graph, &pinned, leaf, domain));
            Dual { jumps: 0, ..whole.limited(1.0) }
        } else {
            self.dual_of(graph, &tape, domain).0
        };
        self.looks.nested.0 -= 1;
        if self.duals.len() >= MOST_KEPT {
            self.duals.clear();
        }
        self.duals.insert(key, dual);
        dual
    }

    /// Value, gradient and its norm of a tape's last step over a domain, each of its pieces by itself; and how often it was run.
    pub fn dual_of(&mut self, graph: &Graph, tape: &Formula, domain: &Domain) -> (Dual, usize) {
        let pinned = self.pinned.clone();
        let (dual, runs) = hull_of_pieces(self, graph, tape, &|leaf| leaf_dual(graph, &pinned, leaf, domain));
        self.account.boxes += runs as u64;
        (dual, runs)
    }

    /// The same for every step, kinks as their hull.
    pub fn all_duals(&mut self, graph: &Graph, tape: &Formula, domain: &Domain) -> Vec<Dual> {
        self.account.boxes += 1;
        let pinned = self.pinned.clone();
        run(self, graph, tape, None, &mut None, &|leaf| leaf_dual(graph, &pinned, leaf, domain)).unwrap_or_default()
    }

    /// Value, gradient and norm of a tape's last step over all of its pieces, and how many runs that took, side by side of all kinks.
    pub(super) fn pieces(&mut self, graph: &Graph, tape: &Formula, leaf: &dyn Fn(Leaf) -> Dual) -> (Dual, usize) {
        let mut all: Option<Dual> = None;
        let runs = each_piece(self, graph, tape, leaf, &mut |values| {
            let Some(last) = values.last().copied() else { return };
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

    /// Whether kinks are looked at side by side at all.
    pub(super) fn looks_closely(&self) -> bool {
        self.looks.forks != Some(0)
    }

    /// Does something without a close look: at points there is no kink to be looked at.
    pub(super) fn without_a_close_look<T>(&mut self, work: impl FnOnce(&mut Self) -> T) -> T {
        let before = self.looks.forks.replace(0);
        let done = work(self);
        self.looks.forks = before;
        done
    }
}

/// Runs a tape over duals, on the sides that `branches` chooses. None where no point is on all of them. `undecided` becomes the first
/// kink that is worth a look at each side and has no side yet.
pub fn run(
    facts: &mut Facts,
    graph: &Graph,
    tape: &Formula,
    branches: Option<&Branches>,
    undecided: &mut Option<usize>,
    leaf: &dyn Fn(Leaf) -> Dual,
) -> Option<Vec<Dual>> {
    let algebra = &mut Duals { pinned: facts.pinned.clone() };
    facts.account.run(tape.steps.len(), (true, !tape.is_seen()));
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
                    [_] if dual.jumps != 0 && tape.rules.has(Rule::AnglePeriodicity) && is_same_after_turns(graph, *op, args, tape, &values) => Dual { jumps: 0, ..dual },
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
                    dual.value = dual.value.intersect(quotient_of_positive(of[0].value, of[1].value));
                }
                if dual.jumps != 0 && tape.rules.has(Rule::AnglePeriodicity) && is_same_after_turns(graph, *op, args, tape, &values) {
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
        let value = match tape.soft(i).and_then(|soft| soft.bound(tape, graph, &values, &|rows| point_norm(tape, graph, &values, rows))) {
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
fn is_mirrored(tape: &Formula, values: &[Dual], step: usize) -> bool {
    let Some(Step::Leaf(Leaf::P(i))) = tape.steps.get(step) else { return false };
    let Some(dual) = values.get(step) else { return false };
    tape.is_mirrored(*i)
        && dual.value.lo < 0.0
        && dual.value.hi > 0.0
        && *dual == Dual::coordinate(usize::from(*i), dual.value)
}

/// Value, gradient and norm of a tape's last step over all of its pieces, and how many runs that took. The gradient of mirrored axes has
/// both signs.
pub fn hull_of_pieces(facts: &mut Facts, graph: &Graph, tape: &Formula, leaf: &dyn Fn(Leaf) -> Dual) -> (Dual, usize) {
    let Some(last) = tape.steps.len().checked_sub(1).filter(|last| facts.looks_closely() && chain(tape, graph, &[*last]).is_some()) else {
        return facts.pieces(graph, tape, leaf);
    };
    let values = run(facts, graph, tape, None, &mut None, leaf).unwrap_or_default();
    let whole = values.get(last).copied().unwrap_or(Dual::constant(Interval::ALL));
    let most = if whole.norm > 1.0 { chain_norm(tape, graph, &values, &[last]) } else { whole.norm };
    if most <= 1.0 {
        return (both_sides(tape, whole.limited(most), leaf), 1);
    }
    let (dual, runs) = facts.pieces(graph, tape, leaf);
    (dual.limited(most), runs + 1)
}

/// What a run says of a tape, with both signs for the gradient of mirrored axes.
pub fn both_sides(tape: &Formula, mut dual: Dual, leaf: &dyn Fn(Leaf) -> Dual) -> Dual {
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
    tape: &Formula,
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

/// Runs a tape over a box, each feasible choice at the kinks that straddle it by itself. `visit` sees the steps' values for each, and
/// the gradients of axes in which the tape is mirrored stand for both signs. Answers how many runs that took.
pub fn each_piece(
    facts: &mut Facts,
    graph: &Graph,
    tape: &Formula,
    leaf: &dyn Fn(Leaf) -> Dual,
    visit: &mut dyn FnMut(&[Dual]),
) -> usize {
    // What is called shares the budget of what calls it.
    let outermost = facts.looks.forks.is_none();
    let before = facts.account.ran;
    let left = if facts.account.forked > MOST_SHARES * facts.account.steps as u64 { 0 } else { STEPS };
    let end = *facts.looks.forks.get_or_insert(before + left);
    let runs = each_piece_until(facts, graph, tape, leaf, visit, end);
    if outermost {
        facts.looks.forks = None;
        facts.account.forked += if runs > 1 { facts.account.ran - before } else { 0 };
    }
    runs
}

fn each_piece_until(
    facts: &mut Facts,
    graph: &Graph,
    tape: &Formula,
    leaf: &dyn Fn(Leaf) -> Dual,
    visit: &mut dyn FnMut(&[Dual]),
    end: u64,
) -> usize {
    let mut kink = None;
    let Some(whole) = run(facts, graph, tape, None, &mut kink, leaf) else { return 1 };
    let Some(kink) = kink.filter(|_| tape.rules.has(Rule::Branches)) else {
        visit(&whole);
        return 1;
    };
    // A jump stays one, whichever side is looked at.
    let jumps: Vec<u8> = whole.iter().map(|d| d.jumps).collect();
    let mut runs = 1;
    let mut visited = false;
    let mut open = vec![(Branches::none(tape.steps.len()), whole.clone(), kink)];
    while let Some((branches, values, kink)) = open.pop() {
        if runs + 2 > RUNS || facts.account.ran > end {
            visit(&values);
            visited = true;
            continue;
        }
        for side in [Side::First, Side::Second] {
            let next = branches.take(tape, &values, kink, side);
            let mut undecided = None;
            runs += 1;
            let Some(mut piece) = run(facts, graph, tape, Some(&next), &mut undecided, leaf) else { continue };
            for (dual, jumps) in piece.iter_mut().zip(&jumps) {
                dual.jumps |= jumps;
            }
            match undecided {
                Some(kink) => open.push((next, piece, kink)),
                None => {
                    visit(&piece);
                    visited = true;
                }
            }
        }
    }
    if !visited {
        visit(&whole);
    }
    runs
}
