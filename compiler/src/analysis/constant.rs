//! Lipschitz constants: the largest norm of a gradient over a domain, the worst box split again and again.

use super::derivative::{self, each_piece};
use super::domain::{Box3, Domain, leaf_range};
use super::dual::{Constant, Dual, leaf_dual};
use super::facts::Facts;
use super::formula::Formula;
use super::region::shift_along;
use super::rules::isometry_chain::{chain, chain_norm};
use super::rules::jacobian_norm::map_norm;
use super::rules::period;
use super::rules::polar::Polar;
use super::tape::Step;
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::{Exactness, Function, Graph, Leaf, Node, NodeId, NodeList};
use crate::rules::Rule;
use std::collections::BinaryHeap;

/// How exactly a map keeps lengths that counts as one that does.
const RIGID: f64 = 1e-6;

impl Facts {
    /// A Lipschitz constant of a node over a domain, looked for with at most `budget` boxes.
    pub fn constant(
        &mut self,
        graph: &Graph,
        node: NodeId,
        domain: &Domain,
        budget: usize,
    ) -> Constant {
        let key = (node, domain.key(), budget);
        if let Some(known) = self.constants.get(&key) {
            return *known;
        }
        if budget > 1
            && self.rules.has(Rule::Parts)
            && let Some(constant) = self.by_terms(graph, node, domain, budget)
        {
            self.constants.insert(key, constant);
            return constant;
        }
        let constant = self.found(graph, node, domain, budget);
        self.constants.insert(key, constant);
        constant
    }

    /// The constant of a node as a whole.
    fn found(&mut self, graph: &Graph, node: NodeId, domain: &Domain, budget: usize) -> Constant {
        let tape = self.tape(graph, node);
        let asked = budget;
        let budget = match self.account.affordable(budget) {
            0 | 1 => 1,
            budget => budget.min((self.account.steps / self.weight(graph, node).max(1)).max(8)),
        };
        // A condition on the point says nothing of a distance alone.
        let free = domain.within.is_empty() && domain.tube.is_none();
        let search = |facts: &mut Self| match Polar::of(&tape, domain.point).filter(|polar| facts.rules.has(Rule::Polar) && budget > 1 && (free || polar.turns())) {
            Some(polar) => {
                if !polar.turns() && let Some(found) = facts.along_distance(graph, &tape, domain, Interval::ALL, budget) {
                    return found;
                }
                let whole = facts.dual_of(graph, &tape, domain).0.norm;
                let found = facts.supremum(graph, &polar.tape, &polar.domain(domain), Sought { polar: Some(&polar), ..Sought::within(budget) }, |facts, d, ()| {
                    let pinned = facts.pinned.clone();
                    let leaf = |leaf| polar.leaf(graph, &pinned, leaf, d);
                    let (dual, runs) = derivative::hull_of_pieces(facts, graph, &polar.tape, &leaf);
                    facts.account.boxes += runs as u64;
                    (Norm { norm: dual.norm, jumps: dual.jumps != 0, runs }, ())
                });
                Constant { lipschitz: found.constant.lipschitz.min(whole), ..found.constant }
            }
            None => {
                if budget > 1 && free && let Some(found) = facts.along_distance(graph, &tape, domain, Interval::ALL, budget) {
                    return found;
                }
                let found = facts.supremum(graph, &tape, domain, Sought::within(budget), |facts, d, ()| {
                    let (dual, runs) = facts.dual_of(graph, &tape, d);
                    (Norm { norm: dual.norm, jumps: dual.jumps != 0, runs }, ())
                });
                // Where a number may be anything in a range, the steepest place that was met is one for all of them.
                let is_met = found.is_close() && !facts.is_ranging(graph, node, domain);
                if budget <= 1 || is_met || !facts.rules.has(Rule::SumTerms) { found.constant } else { facts.term_by_term(graph, node, domain, asked, found.constant) }
            }
        };
        if budget > 1 { self.remembered_constant(graph, &[node], domain, budget, search) } else { search(self) }
    }

    /// Whether a formula reads a number that may be anything in a range.
    pub(super) fn is_ranging(&mut self, graph: &Graph, node: NodeId, domain: &Domain) -> bool {
        let tape = self.tape(graph, node);
        let ranges = |leaf: &Leaf| !matches!(leaf, Leaf::P(_)) && leaf_range(graph, &self.pinned, *leaf, domain).width() > 0.0;
        tape.steps.iter().any(|step| matches!(step, Step::Leaf(leaf) if ranges(leaf)))
    }

    /// How fast a node changes with one of its variables at most, whatever the point and all else are within the domain; without end where it jumps.
    pub fn rate_by(&mut self, graph: &Graph, node: NodeId, variable: u32, domain: &Domain) -> f64 {
        let tape = self.tape(graph, node);
        let pinned = self.pinned.clone();
        let leaf = |leaf| match leaf {
            Leaf::Variable(v) if v == variable => Dual::coordinate(0, domain.variable(v)),
            other => Dual::constant(leaf_range(graph, &pinned, other, domain)),
        };
        let by = derivative::hull_of_pieces(self, graph, &tape, &leaf).0;
        if by.jumps != 0 { f64::INFINITY } else { by.norm }
    }

    /// Of what is a distance from another, a multiple or a sum, over all space: the constants of the terms, each found by itself.
    fn by_terms(&mut self, graph: &Graph, node: NodeId, domain: &Domain, budget: usize) -> Option<Constant> {
        if let Node::Call(shape, Function::Field, args) = graph.node(node) {
            // The same formula at the same point.
            let s = graph.shape(*shape)?;
            let same = args.iter().zip((0..3).map(Leaf::P).chain(s.variables.iter().map(|&v| Leaf::Variable(v))));
            let here = same.into_iter().all(|(&a, leaf)| *graph.node(a) == Node::Leaf(leaf));
            let value = s.value;
            return (here && s.exactness != Exactness::Exact).then(|| self.constant(graph, value, domain, budget));
        }
        let Node::Op(op, args) = graph.node(node) else { return None };
        let (&a, b) = (args.first()?, args.get(1).copied());
        let scaled = |c: Constant, k: f64| Constant { lipschitz: c.lipschitz * k, ..c };
        match (op, b) {
            (Op::Neg | Op::Abs, _) => Some(self.constant(graph, a, domain, budget)),
            (Op::Add | Op::Sub, Some(b)) if graph.as_constant(b).is_some() => Some(self.constant(graph, a, domain, budget)),
            (Op::Add | Op::Sub, Some(b)) if graph.as_constant(a).is_some() => Some(self.constant(graph, b, domain, budget)),
            (Op::Mul, Some(b)) => match (graph.as_constant(a), graph.as_constant(b)) {
                (Some(k), _) => Some(scaled(self.constant(graph, b, domain, budget), k.abs())),
                (_, Some(k)) => Some(scaled(self.constant(graph, a, domain, budget), k.abs())),
                _ => None,
            },
            (Op::Div, Some(b)) => {
                let k = graph.as_constant(b).filter(|k| *k != 0.0)?;
                Some(scaled(self.constant(graph, a, domain, budget), 1.0 / k.abs()))
            }
            (Op::Add | Op::Sub, Some(b)) if !domain.point.is_finite() => {
                let tape = self.tape(graph, node);
                if self.rules.has(Rule::Period) && period::one_period(&tape, domain.point).is_finite() {
                    return None;
                }
                let whole = self.found(graph, node, domain, budget);
                // Of a few terms the sums in between are looked at too; of many that would take the square of their number.
                let all = terms(graph, node);
                let parts = if all.len() > FEW_TERMS { all.into_iter().map(|(term, _)| term).collect() } else { vec![a, b] };
                let parts: Vec<Constant> = parts.into_iter().map(|part| self.constant(graph, part, domain, budget)).collect();
                let sum: f64 = parts.iter().map(|part| part.lipschitz).sum();
                Some(Constant { lipschitz: sum.min(whole.lipschitz), jumps: parts.iter().any(|part| part.jumps) })
            }
            _ => None,
        }
    }

    /// A bound of the norm of the Jacobian of a point's three coordinates over a domain.
    pub fn map_constant(
        &mut self,
        graph: &Graph,
        point: &[NodeId],
        domain: &Domain,
        budget: usize,
    ) -> Constant {
        // A point that is moved along is no farther from another than before.
        if point.iter().enumerate().all(|(i, &p)| shift_along(graph, p, i).is_some() || graph.as_constant(p).is_some()) {
            let moves = point.iter().any(|&p| graph.as_constant(p).is_none());
            return Constant { lipschitz: f64::from(u8::from(moves)), jumps: false };
        }
        let key = (NodeList::from(point), domain.key(), budget);
        if let Some(known) = self.maps.get(&key) {
            return *known;
        }
        let tape = Formula::new(graph, point, self.rules);
        let rows: Vec<usize> = tape.roots().collect();
        let budget = match self.account.affordable(budget) {
            0 | 1 => 1,
            budget => budget.min((self.account.steps / tape.steps.len().max(1)).max(8)),
        };
        let search = |facts: &mut Self| {
            let found = facts.supremum(graph, &tape, domain, Sought::within(budget), |facts, d, ()| {
                let mut norm = Norm { norm: 0.0, jumps: false, runs: 0 };
                let pinned = facts.pinned.clone();
                let leaf = |leaf| leaf_dual(graph, &pinned, leaf, d);
                let mut most = f64::INFINITY;
                if facts.looks_closely() && chain(&tape, graph, &rows).is_some() {
                    let values = derivative::run(facts, graph, &tape, None, &mut None, &leaf).unwrap_or_default();
                    most = chain_norm(&tape, graph, &values, &rows);
                    if most <= 1.0 {
                        let jumps = rows.iter().any(|&r| values.get(r).is_some_and(|d| d.jumps != 0));
                        return (Norm { norm: most, jumps, runs: 1 }, ());
                    }
                }
                let runs = each_piece(facts, graph, &tape, &leaf, &mut |duals| {
                    norm.jumps |= rows.iter().any(|&r| duals.get(r).is_some_and(|d| d.jumps != 0));
                    norm.norm = norm.norm.max(map_norm(&tape, duals, &rows));
                });
                facts.account.boxes += runs as u64;
                (Norm { runs, norm: norm.norm.min(most), ..norm }, ())
            });
            found.constant
        };
        let constant = if budget > 1 {
            self.remembered_constant(graph, point, domain, budget, search)
        } else {
            search(self)
        };
        let constant = match self.turn_constant(graph, point, domain) {
            Some(closed) => Constant { lipschitz: constant.lipschitz.min(closed), ..constant },
            None => constant,
        };
        self.maps.insert(key, constant);
        constant
    }

    /// Whether a map of points keeps all distances, wherever they are, with the values of the parameters that the text gives: moves, turns and
    /// mirrors do, folds do not.
    pub fn is_rigid(&mut self, graph: &Graph, point: &[NodeId]) -> bool {
        if point.iter().enumerate().all(|(i, &p)| shift_along(graph, p, i).is_some() || graph.as_constant(p).is_some()) {
            return true;
        }
        let tape = Formula::new(graph, point, self.rules);
        let leaf = |leaf| match leaf {
            Leaf::P(i) => Dual::coordinate(usize::from(i), Interval::ALL),
            Leaf::Parameter(i) => Dual::constant(Interval::point(graph.parameters.get(i as usize).map_or(0.0, |p| p.default))),
            Leaf::Time => Dual::constant(Interval::ZERO),
            _ => Dual::constant(Interval::ALL),
        };
        let duals = derivative::run(self, graph, &tape, None, &mut None, &leaf).unwrap_or_default();
        let moving = |p: &usize| duals.get(*p).filter(|d| d.norm > 0.0).map(|d| d.gradient);
        let rows: Vec<[Interval; 3]> = tape.roots().filter_map(|root| moving(&root)).collect();
        let along = |a: &[Interval; 3], b: &[Interval; 3]| -> f64 { a.iter().zip(b).map(|(a, b)| a.middle() * b.middle()).sum() };
        let steady = rows.iter().flatten().all(|slope| slope.width() < RIGID);
        let square = |i: usize, a, j: usize, b| (along(a, b) - f64::from(u8::from(i == j))).abs() < RIGID;
        steady && rows.iter().enumerate().all(|(i, a)| rows.iter().enumerate().all(|(j, b)| square(i, a, j, b)))
    }

    /// The constant of a turn about an axis by an angle that only goes along with that axis, in a tube about it: with a the steepest change
    /// of the angle times the tube's radius, the map is an isometry times the identity and a rank-one term of size a across it, of which
    /// the largest singular value is a/2 + √(1 + a²/4).
    fn turn_constant(&mut self, graph: &Graph, point: &[NodeId], domain: &Domain) -> Option<f64> {
        let (axis, radius) = domain.tube.filter(|_| self.rules.has(Rule::Twist))?;
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        let is = |node: &NodeId, k: usize| *graph.node(*node) == Node::Leaf(Leaf::P(k as u8));
        let Node::Op(Op::TurnU | Op::TurnV, args) = graph.node(*point.get(i)?) else { return None };
        let [u, v, angle] = args.as_ref() else { return None };
        let across = is(u, i) && is(v, j) || is(u, j) && is(v, i);
        let along = graph.reachable(&[*angle]).iter().all(|id| match graph.node(*id) {
            Node::Leaf(Leaf::P(k)) => usize::from(*k) == axis,
            Node::Leaf(Leaf::Variable(_)) | Node::Call(..) => false,
            _ => true,
        });
        if !across || !along || !is(point.get(axis)?, axis) {
            return None;
        }
        let change = self.constant(graph, *angle, &Domain { tube: None, ..domain.clone() }, 32);
        let a = change.lipschitz * radius * (1.0 + 1e-12);
        (a.is_finite() && !change.jumps).then(|| a / 2.0 + (1.0 + a * a / 4.0).sqrt())
    }

    /// The largest of `norm` over a domain, the worst box split again and again. `norm` is told what is known of a box around its own, and says
    /// what is known of that one.
    pub(super) fn supremum<Known: Clone>(
        &mut self,
        graph: &Graph,
        tape: &Formula,
        domain: &Domain,
        sought: Sought<'_, Known>,
        norm: impl Fn(&mut Self, &Domain, &Known) -> (Norm, Known),
    ) -> Found {
        let Sought { polar, budget, known, reached } = sought;
        let (first, known) = norm(self, domain, &known);
        let as_a_whole = Found { constant: Constant { lipschitz: first.norm, jumps: first.jumps }, least: 0.0 };
        if budget <= 1 {
            return as_a_whole;
        }
        // What the formula does not read needs no splitting.
        let conditions: Vec<_> = domain.within.iter().map(|(node, level)| (self.tape(graph, *node), *level)).collect();
        let axes: Vec<usize> = (0..3).filter(|&i| tape.reads(i) || conditions.iter().any(|(c, _)| c.reads(i))).collect();
        let beyond = |facts: &mut Self, part: &Box3| {
            let Some(place) = polar.map_or(Some(*part), |polar| polar.place(part)) else { return true };
            let here = domain.at(place);
            let above = |range: Option<&Interval>, level: f64| range.is_some_and(|r| r.lo > level);
            domain.leaves_out(&place) || conditions.iter().any(|(tape, level)| above(facts.ranges_of(graph, tape, &here).last(), *level))
        };
        let mut point = if self.rules.has(Rule::Period) { period::one_period(tape, domain.point) } else { domain.point };
        // What a condition tells of one period it does not tell of the others.
        for i in (0..3).filter(|&i| conditions.iter().any(|(c, _)| c.reads(i))) {
            point = point.with_axis(i, domain.point.axis(i));
        }
        let domain = &domain.at(point);
        // Without end a formula is worth a search where it is not wild already: what is far away is one box.
        let endless = axes.iter().any(|&i| !domain.point.axis(i).is_finite());
        if axes.is_empty() || endless && !first.norm.is_finite() {
            return as_a_whole;
        }
        let mut used = first.runs;
        // An axis that does not matter for the whole box, or for a condition alone, is split later than the others.
        let mut weights = [1.0; 3];
        for &i in &axes {
            let side = domain.point.axis(i);
            if !side.is_finite() {
                continue;
            }
            let flat = domain.point.with_axis(i, Interval::point(side.lo + 0.4837 * side.width()));
            let idle = !tape.reads(i) || first.norm.is_finite() && {
                let (without, _) = norm(self, &domain.at(flat), &known);
                used += without.runs;
                without.norm >= 0.999 * first.norm
            };
            if let (Some(weight), true) = (weights.get_mut(i), idle) {
                *weight = IDLE;
            }
        }
        let mut least = reached.unwrap_or(0.0);
        let before = self.account.ran;
        let mut open = BinaryHeap::from([Part { norm: first.norm, jumps: first.jumps, region: domain.point, known }]);
        // No search alone may cost much more than what is left for all of them.
        let left = self.account.most_searched.saturating_sub(self.account.searched).max(self.account.steps as u64);
        let end = self.account.ran.saturating_add(left.min(STEPS_MORE * self.account.steps as u64));
        let least_left = self.account.left_by_one();
        while used < budget && self.account.ran < end && self.account.left > least_left {
            let Some(worst) = open.pop() else { break };
            // What does not get less steep far away is not searched any longer.
            if endless && used > budget / 2 && worst.norm > 0.99 * first.norm {
                open.push(worst);
                break;
            }
            let bent = |i: usize| polar.map_or(1.0, |polar| polar.weight(&worst.region, i));
            let width = |i: &usize| breadth(worst.region.axis(*i)) * bent(*i) * weights.get(*i).copied().unwrap_or(1.0);
            let Some(&widest) = axes.iter().max_by(|a, b| width(a).total_cmp(&width(b))) else { break };
            if reached.is_none() {
                // Not the middle itself, where what is symmetric has its kinks.
                let inside = Box3(worst.region.0.map(|i| Interval::point(if i.is_finite() { i.lo + 0.4837 * i.width() } else { i.middle() })));
                let (at, _) = norm(self, &domain.at(inside), &worst.known);
                if at.norm.is_finite() && !beyond(self, &inside) {
                    least = least.max(at.norm);
                }
            }
            if worst.norm <= least * 1.02 || width(&widest) < 1e-9 {
                open.push(worst);
                break;
            }
            let side = worst.region.axis(widest);
            let half = if side == Interval::ALL { 0.0 } else { side.middle() };
            for part in [Interval::new(side.lo, half), Interval::new(half, side.hi)] {
                let region = worst.region.with_axis(widest, part);
                if beyond(self, &region) {
                    continue;
                }
                let (found, known) = norm(self, &domain.at(region), &worst.known);
                used += found.runs;
                open.push(Part { norm: found.norm, jumps: found.jumps, region, known });
            }
        }
        self.account.searched += self.account.ran - before;
        self.account.cut_short |= self.account.left <= least_left;
        let largest = open.peek().map_or(0.0, |p| p.norm);
        let jumps = first.jumps && open.iter().any(|p| p.jumps);
        Found { constant: Constant { lipschitz: largest.min(first.norm), jumps }, least }
    }
}

/// How a search is made.
pub(super) struct Sought<'a, Known> {
    /// Where two of the domain's coordinates are distance and angle.
    pub polar: Option<&'a Polar>,
    /// How often the formula may be run.
    pub budget: usize,
    /// What is known of the formula all over the domain.
    pub known: Known,
    /// How steep it is somewhere, if that need not be found.
    pub reached: Option<f64>,
}

impl Sought<'_, ()> {
    /// With nothing known of boxes but how steep the formula is there.
    pub fn within(budget: usize) -> Self {
        Self { polar: None, budget, known: (), reached: None }
    }
}

/// What a search found.
pub(super) struct Found {
    /// The constant.
    pub constant: Constant,
    /// How steep it is at the steepest place that was met: no constant is smaller.
    pub least: f64,
}

impl Found {
    /// Whether a longer search would hardly find a smaller one.
    pub fn is_close(&self) -> bool {
        self.constant.lipschitz <= CLOSE * self.least
    }
}

/// What is known to this multiple is found well enough.
const CLOSE: f64 = 1.5;

/// What a node adds and what it takes away (true), in any order.
pub(crate) fn terms(graph: &Graph, node: NodeId) -> Vec<(NodeId, bool)> {
    let (mut open, mut terms) = (vec![(node, false)], Vec::new());
    while let Some((node, taken)) = open.pop() {
        match graph.node(node) {
            Node::Op(op @ (Op::Add | Op::Sub), args) if terms.len() + open.len() < MOST_TERMS => {
                open.extend(args.iter().enumerate().map(|(i, &arg)| (arg, taken != (*op == Op::Sub && i == 1))));
            }
            _ => terms.push((node, taken)),
        }
    }
    terms
}

/// More terms of a sum are many.
const FEW_TERMS: usize = 16;
/// A sum that shares its parts may have endlessly many terms; more than these are not taken apart.
const MOST_TERMS: usize = 100_000;

/// How much the width of an axis counts that does not matter for the whole box: one that only chooses between parts is hardly ever worth a cut.
const IDLE: f64 = 0.004;

/// How many times as many steps the kinks and the calls in it may cost.
const STEPS_MORE: u64 = 8;

/// The width of a side; what has no end counts the less, the farther away it begins.
fn breadth(side: Interval) -> f64 {
    if side.is_finite() { side.width() } else { 4.0 / (1.0 + side.mignitude()) }
}

/// What one box tells.
pub(super) struct Norm {
    /// A bound of the gradient's norm.
    pub norm: f64,
    /// Whether the formula may jump in it.
    pub jumps: bool,
    /// How often the formula was run.
    pub runs: usize,
}

/// A box that waits to be split; the one with the largest norm comes first.
struct Part<Known> {
    norm: f64,
    jumps: bool,
    region: Box3,
    known: Known,
}

impl<Known> PartialEq for Part<Known> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl<Known> Eq for Part<Known> {}

impl<Known> PartialOrd for Part<Known> {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl<Known> Ord for Part<Known> {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        let corner = |p: &Self| p.region.0.map(|i| i.lo);
        // Ties by place, so that the order depends on nothing else.
        self.norm.total_cmp(&other.norm).then_with(|| {
            let pairs = corner(self).into_iter().zip(corner(other));
            pairs.map(|(a, b)| a.total_cmp(&b)).find(|o| o.is_ne()).unwrap_or(std::cmp::Ordering::Equal)
        })
    }
}
