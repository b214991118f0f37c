//! Where a formula can be at or below a level: a box, found by carrying conditions back to the coordinates, and by cutting off slabs that
//! are proven empty.

use super::chain::{DEEP, DEEPEST};
use super::domain::{Box3, Domain, call_domain};
use super::dual::Constant;
use super::facts::Facts;
use super::formula::Formula;
use super::hc4_projections::Walk;
use super::rigid_transform::Placed;
use crate::graph::interval::Interval;
use crate::graph::joint::MANY;
use crate::graph::kernel::Op;
use crate::graph::{Claim, Exactness, Function, Graph, Leaf, Node, NodeId, ShapeId};
use crate::rules::Rule;
use std::collections::VecDeque;

/// How many boxes the cutting of one region may cost, those of the shapes inside counted in.
const SLABS: u64 = 160;
/// How many parts may be kept or split while a region is sifted.
const SIFTED: u32 = 600;
/// How many steps of formulas the sifting of one region may cost, those of the shapes inside counted in.
const SIFTED_STEPS: u64 = 1_000_000;
/// A formula without a constant over all space is sifted where it may be so steep.
const WILD: f64 = 100.0;
/// How many steps of formulas the sifting and the cutting of all regions of a scene may cost; then they are only found by carrying back.
const CLOSER_STEPS: u64 = 4_000_000;
/// How many shapes inside may be sifted for one region.
const SIFTS: u32 = 16;
/// How many unions inside may be looked at part by part for one region.
const UNIONS: u32 = 3;
/// How many that may be for all regions of a scene: within such a look there may be others.
const LOOKS: u32 = 1000;
/// How many regions may be found in those looks: of a chain of blends each look is as long as the chain.
const LOOKED: u32 = 20_000;
/// How many shapes one contraction may enter, shared ones counted each time.
const ENTRIES: u32 = 400;
/// How many steps one contraction may visit, shared steps counted each time.
const VISITS: usize = 4000;

/// As far as outlines are found.
pub const WORLD_SIDE: f64 = 1e5;
/// As far as shapes are looked at, in their own space: what lies within [`WORLD_SIDE`] lies within this after all moves.
pub(super) const FARTHEST: f64 = 1e6;
/// What is known no better than to lie within this is looked at more closely where that costs little.
pub(super) const FAR: f64 = 1e4;
/// Bytes of stack for [`DEEPEST`] steps: several times what they take in a build that is hardly optimised.
const WALK_STACK: usize = 4 << 20;
/// See [`FARTHEST`].
pub(super) const MOVES: usize = 70;

impl Facts {
    /// A box within the domain that holds every point at which the node is at most `level`.
    pub fn region(&mut self, graph: &Graph, node: NodeId, domain: &Domain, level: f64) -> Box3 {
        let key = (node, domain.key(), level.to_bits());
        if let Some(known) = self.regions.get(&key) {
            return *known;
        }
        self.looks.regions_looked += u32::from(self.looks.looking > 0);
        self.looks.regions_open += 1;
        let by_parts = self.region_by_parts(graph, node, domain, level);
        self.looks.regions_open -= 1;
        if let Some(region) = by_parts {
            self.regions.insert(key, region);
            return region;
        }
        let mut region = domain.point;
        let tape = self.tape(graph, node);
        self.looks.entries = ENTRIES;
        self.looks.sifts = SIFTS;
        self.looks.unions = UNIONS;
        // Far down in a chain each look at a box of its own would be as long as the chain.
        let is_deep = self.looks.regions_open >= DEEP;
        for _ in 0..if is_deep { 1 } else { 3 } {
            let before = region.size();
            region = self.contract(graph, &tape, &domain.at(region), Interval::new(f64::NEG_INFINITY, level));
            if region.is_empty() || region.size() > 0.9 * before {
                break;
            }
        }
        if is_deep {
            self.regions.insert(key, region);
            return region;
        }
        region = self.sift(graph, node, domain, region, level);
        if self.rules.has(Rule::Shave) && self.account.closer < CLOSER_STEPS && !self.account.is_spent() && !region.is_empty() && region.is_finite() {
            let first = self.account.ran;
            region = self.shave(graph, &tape, domain, region, level);
            self.account.closer += self.account.ran - first;
        }
        self.regions.insert(key, region);
        region
    }

    /// The region of a union is around those of its parts, that of a shape moved along is moved along. None for anything else.
    fn region_by_parts(
        &mut self,
        graph: &Graph,
        node: NodeId,
        domain: &Domain,
        level: f64,
    ) -> Option<Box3> {
        if let (Some(solid), true) = (self.known_solid(node), level <= 0.0) {
            return Some(solid.intersect(&domain.point));
        }
        match graph.node(node) {
            Node::Op(Op::Min, _) => {
                let mut hull = Box3::EMPTY;
                for part in graph.least_of(node, |id| self.known_solid(id).is_some()) {
                    hull = hull.hull(&self.region(graph, part, domain, level));
                }
                Some(hull)
            }
            Node::Claim(args, Claim::Continuous) => {
                Some(self.region(graph, *args.first()?, domain, level))
            }
            Node::Call(shape, Function::Field, args) => {
                let s = graph.shape(*shape)?;
                let mut own = domain.point;
                let mut shifts = [0.0; 3];
                for (i, shift) in shifts.iter_mut().enumerate() {
                    *shift = shift_along(graph, *args.get(i)?, i)?;
                    own = own.with_axis(i, own.axis(i).add(Interval::point(*shift)));
                }
                let mut variables = Vec::new();
                for (&v, arg) in s.variables.iter().zip(args.iter().skip(3)) {
                    variables.push((v, self.range(graph, *arg, domain)));
                }
                let value = s.value;
                let own = Domain { variables, narrowed: domain.narrowed, ..Domain::of(own) };
                if self.looks.regions_open >= DEEP {
                    let of = |shape: ShapeId, own: Domain| Some((graph.shape(shape)?.value, Domain { narrowed: domain.narrowed, ..own }));
                    let known = |facts: &Self, shape, own: &Domain| {
                        of(shape, own.clone()).is_none_or(|(value, own)| facts.regions.contains_key(&(value, own.key(), level.to_bits())))
                    };
                    self.look_from_below(graph, value, &own, known, |facts, shape, own| {
                        if let Some((value, own)) = of(shape, own) {
                            facts.region(graph, value, &own, level);
                        }
                    });
                }
                let region = self.region(graph, value, &own, level);
                let mut back = region;
                for (i, shift) in shifts.iter().enumerate() {
                    back = back.with_axis(i, region.axis(i).sub(Interval::point(*shift)));
                }
                Some(if region.is_empty() { region } else { back.intersect(&domain.point) })
            }
            _ => None,
        }
    }

    /// The same of the solid, found at once and not as tight.
    pub fn rough_region(&mut self, graph: &Graph, node: NodeId, domain: &Domain) -> Box3 {
        self.rough_region_at(graph, node, domain, 0.0)
    }

    /// The same of all that is at most a level.
    pub fn rough_region_at(&mut self, graph: &Graph, node: NodeId, domain: &Domain, level: f64) -> Box3 {
        let tape = self.tape(graph, node);
        (self.looks.entries, self.looks.sifts, self.looks.unions) = (ENTRIES, 0, 0);
        self.contract(graph, &tape, domain, Interval::new(f64::NEG_INFINITY, level))
    }

    /// A box that holds every point within [`WORLD_SIDE`] of the origin at which a node is at most zero, found at once: what is put together of shapes is
    /// looked at shape by shape, each of them once. It reaches to that distance where nothing better is known.
    pub fn outline(&mut self, graph: &Graph, node: NodeId) -> Box3 {
        self.outline_within(graph, node, 0)
    }

    /// Remembers that a node is at most zero no farther than `reach` along its axes, where that is not seen at once; of what `is_fixed`, a closer box.
    pub fn know_reach(&mut self, graph: &Graph, node: NodeId, (reach, is_fixed): (f64, bool), dimensions: usize) {
        let side = Interval::new(-reach, reach);
        let seen = self.rough_region(graph, node, &Domain::of(Box3::ALL));
        let around = (0..dimensions).fold(Box3::ALL, |around, axis| around.with_axis(axis, side));
        if seen.intersect(&around) != seen {
            // A drawing has no third axis.
            let within = (dimensions..3).fold(around, |within, axis| within.with_axis(axis, Interval::ZERO));
            let closer = if is_fixed { self.on_top(|facts| facts.region(graph, node, &Domain::of(within), 0.0)) } else { within };
            self.know_solid(node, (0..dimensions).fold(Box3::ALL, |solid, axis| solid.with_axis(axis, closer.axis(axis))));
        }
    }

    /// Does something that is not counted in what closer looks at regions may cost: once for a scene, before all others.
    pub fn on_top<T>(&mut self, work: impl FnOnce(&mut Self) -> T) -> T {
        let before = (self.account.closer, self.looks.looked);
        let done = work(self);
        (self.account.closer, self.looks.looked) = before;
        done
    }

    pub(super) fn outline_within(&mut self, graph: &Graph, node: NodeId, moves: usize) -> Box3 {
        if let Some(known) = self.known_solid(node).or_else(|| self.outlines.get(&node).copied()) {
            return known;
        }
        let outline = match graph.node(node) {
            Node::Op(Op::Min, _) => {
                let parts = graph.least_of(node, |id| self.known_solid(id).is_some());
                parts.into_iter().fold(Box3::EMPTY, |hull, a| hull.hull(&self.outline_within(graph, a, moves)))
            }
            Node::Op(Op::Max, args) => args.iter().fold(Box3::ALL, |common, &a| common.intersect(&self.outline_within(graph, a, moves))),
            Node::Claim(args, Claim::Continuous) => args.first().map_or(Box3::ALL, |&a| self.outline_within(graph, a, moves)),
            Node::Call(shape, Function::Field, args) if moves < MOVES && let Some((value, placed)) = placed(graph, *shape, args) => {
                let moved = placed.back(self.outline_within(graph, value, moves + 1));
                // A box about a turned box is wider than one about what is in it.
                if placed.turns() { moved.intersect(&self.rough_region(graph, node, &Domain::of(Box3::cube(FARTHEST)))) } else { moved }
            }
            _ => self.outline_of_blends(graph, node),
        };
        self.outlines.insert(node, outline);
        outline
    }

    /// The outline of what may be a blend of many. Each operand is looked at by itself: a look through all of them at once finds nothing.
    fn outline_of_blends(&mut self, graph: &Graph, node: NodeId) -> Box3 {
        let joined = graph.joined(node);
        if joined.operands.len() < MANY {
            return self.rough_region(graph, node, &Domain::of(Box3::cube(FARTHEST)));
        }
        let mut hull = Box3::EMPTY;
        for operand in joined.operands {
            hull = hull.hull(&self.rough_region_at(graph, operand, &Domain::of(Box3::cube(FARTHEST)), joined.level));
        }
        hull
    }

    /// Whether a node is above zero all over a domain, as far as that is seen at once. Of a union one operand that is not is enough.
    pub fn is_nowhere(&mut self, graph: &Graph, node: NodeId, domain: &Domain) -> bool {
        match graph.node(node) {
            // What was added last is mostly the least: a floor, a frame.
            Node::Op(Op::Min, _) => graph.least_of(node, |_| false).into_iter().rev().all(|a| self.is_nowhere(graph, a, domain)),
            _ => self.rough_region(graph, node, domain).is_empty(),
        }
    }

    /// Drops parts of which a constant of the formula proves that they are empty: the value at the middle is more than the constant times
    /// the distance to the corners. Only of a box that is hardly smaller than the domain. Domains of all sizes lead to the same box, which is
    /// sifted once.
    fn sift(&mut self, graph: &Graph, node: NodeId, domain: &Domain, region: Box3, level: f64) -> Box3 {
        if !self.rules.has(Rule::Sift) || self.account.closer >= CLOSER_STEPS || self.account.is_spent() || !region.is_finite() || region.size() <= 0.5 * domain.point.size() {
            return region;
        }
        let key = (node, domain.at(region).key(), level.to_bits());
        if let Some(known) = self.sifted.get(&key) {
            return *known;
        }
        let first = self.account.ran;
        let sifted = self.sift_anew(graph, node, domain, region, level);
        self.account.closer += self.account.ran - first;
        self.sifted.insert(key, sifted);
        sifted
    }

    /// The same, and nothing is remembered. Without a constant over all space each part is looked at for itself.
    fn sift_anew(&mut self, graph: &Graph, node: NodeId, domain: &Domain, region: Box3, level: f64) -> Box3 {
        let exact =
            graph.shapes().any(|(_, s)| s.value == node && s.exactness == Exactness::Exact);
        let constant = if exact {
            Constant { lipschitz: 1.0, jumps: false }
        } else {
            self.constant(graph, node, &domain.at(Box3::ALL), 1)
        };
        let everywhere = constant.lipschitz.is_finite() && !constant.jumps;
        let most = if everywhere { SIFTED_STEPS } else { SIFTED_STEPS / 10 };
        // What is gentle all over the box needs no tighter one.
        if !everywhere && self.constant(graph, node, &domain.at(region), 1).lipschitz < WILD {
            return region;
        }
        self.looks.sifts = self.looks.sifts.saturating_sub(1);
        let tape = self.tape(graph, node);
        let smallest = region.size() / 128.0;
        let mut left = SIFTED;
        let first = self.account.ran;
        let least_left = self.account.left_by_one();
        // Large parts first: where the budget ends, what is left is around the solid already.
        let mut open = VecDeque::from([region]);
        let mut kept = Box3::EMPTY;
        // Values at points are of use for the shapes that share them within one look, and never again.
        let known = std::mem::take(&mut self.ranges);
        while let Some(part) = open.pop_front() {
            // What is known to be kept already needs no closer look.
            if kept.hull(&part) == kept {
                continue;
            }
            let middle = part.0.map(|i| i.middle());
            let half = part.0.map(|i| i.width() / 2.0);
            let corner = half.iter().map(|h| h * h).sum::<f64>().sqrt();
            let middle = Box3(middle.map(Interval::point));
            self.ranges.clear();
            let value = self.ranges_of(graph, &tape, &domain.at(middle)).last().copied().unwrap_or(Interval::ALL);
            let is_empty = |lipschitz: f64| value.lo > level + lipschitz * corner * (1.0 + 1e-9);
            if everywhere && is_empty(constant.lipschitz) {
                continue;
            }
            if !everywhere && value.lo > level {
                let before = self.account.ran;
                let here = self.all_duals(graph, &tape, &domain.at(part)).last().copied();
                // A step with its derivatives costs as much as nine without.
                self.account.closer += 8 * (self.account.ran - before);
                if here.is_some_and(|here| here.value.lo > level || here.jumps == 0 && is_empty(here.norm)) {
                    continue;
                }
            }
            if left == 0 || self.account.ran - first > most || self.account.left <= least_left {
                self.account.cut_short |= self.account.left <= least_left;
                kept = open.iter().fold(kept.hull(&part), |kept, part| kept.hull(part));
                break;
            }
            left -= 1;
            if part.size() <= smallest {
                kept = kept.hull(&part);
                continue;
            }
            if value.hi <= level {
                kept = kept.hull(&middle);
            }
            let mut parts = vec![part];
            for axis in 0..3 {
                let side = part.axis(axis);
                if side.width() > part.size() / 1.5 {
                    let (low, high) = (Interval::new(side.lo, side.middle()), Interval::new(side.middle(), side.hi));
                    parts = parts
                        .into_iter()
                        .flat_map(|p| [p.with_axis(axis, low), p.with_axis(axis, high)])
                        .collect();
                }
            }
            open.extend(parts);
        }
        self.ranges = known;
        kept
    }

    /// Cuts off slabs at the faces in which the formula is above the level everywhere.
    fn shave(
        &mut self,
        graph: &Graph,
        tape: &Formula,
        domain: &Domain,
        mut region: Box3,
        level: f64,
    ) -> Box3 {
        let first = self.account.boxes;
        for _ in 0..2 {
            let before = region;
            for axis in 0..3 {
                for upper in [false, true] {
                    let mut part = 0.5;
                    while part > 0.02 && self.account.boxes - first < SLABS {
                        let side = region.axis(axis);
                        let cut = side.width() * part;
                        if cut <= 0.0 {
                            break;
                        }
                        let (slab, rest) = if upper {
                            (Interval::new(side.hi - cut, side.hi), Interval::new(side.lo, side.hi - cut))
                        } else {
                            (Interval::new(side.lo, side.lo + cut), Interval::new(side.lo + cut, side.hi))
                        };
                        let slab = domain.at(region.with_axis(axis, slab));
                        let values = self.ranges_of(graph, tape, &slab);
                        if values.last().is_some_and(|v| v.lo > level) {
                            region = region.with_axis(axis, rest);
                        } else {
                            part /= 2.0;
                        }
                    }
                }
            }
            if region == before {
                break;
            }
        }
        region
    }

    /// The part of a domain in which a tape's last step can be within a target.
    pub fn contract(
        &mut self,
        graph: &Graph,
        tape: &Formula,
        domain: &Domain,
        target: Interval,
    ) -> Box3 {
        let ranges = self.ranges_of(graph, tape, domain);
        let Some(last) = tape.steps.len().checked_sub(1) else { return domain.point };
        let mut visits = VISITS;
        let is_first = self.looks.walking == 0;
        let mut walk = Walk::new(self, (graph, tape, &ranges), &mut visits);
        match is_first {
            // The deepest way back needs more stack than a caller's thread may have left.
            true => stacker::maybe_grow(WALK_STACK, 2 * WALK_STACK, || walk.step(last, target, domain.point)),
            false => walk.step(last, target, domain.point),
        }
    }

    pub(super) fn shape_region(
        &mut self,
        graph: &Graph,
        shape: ShapeId,
        args: &[Interval],
        target: Interval,
    ) -> Box3 {
        let Some(s) = graph.shape(shape) else { return Box3::ALL };
        let domain = call_domain(&s.variables, args);
        // What is a distance is no farther from its solid than it says.
        let is_distance = s.exactness == Exactness::Exact && target.hi.is_finite();
        if let (Some(solid), true) = (self.known_solid(s.value), target.hi <= 0.0 || is_distance) {
            return solid.grow(target.hi.max(0.0)).intersect(&domain.point);
        }
        if self.looks.entries == 0 || self.looks.walking >= DEEPEST {
            return domain.point;
        }
        self.looks.entries -= 1;
        if target.lo == f64::NEG_INFINITY {
            let key = (s.value, domain.key(), target.hi.to_bits());
            if let Some(known) = self.regions.get(&key) {
                return *known;
            }
            let (node, level) = (s.value, target.hi);
            // A union inside is looked at part by part, where that is not done too often.
            let is_union = matches!(graph.node(node), Node::Op(Op::Min, _) | Node::Call(..));
            if self.looks.unions > 0 && self.looks.looked < LOOKS && self.looks.regions_looked < LOOKED && is_union {
                self.looks.unions -= 1;
                self.looks.looked += 1;
                let (entries, sifts) = (self.looks.entries, self.looks.sifts);
                self.looks.looking += 1;
                let region = self.region(graph, node, &domain, level);
                self.looks.looking -= 1;
                (self.looks.entries, self.looks.sifts) = (entries, sifts);
                return region;
            }
            let tape = self.tape(graph, node);
            let mut region = self.contract(graph, &tape, &domain, target);
            if self.looks.sifts > 0 {
                region = self.sift(graph, node, &domain, region, level);
            }
            self.regions.insert(key, region);
            return region;
        }
        let tape = self.tape(graph, s.value);
        self.contract(graph, &tape, &domain, target)
    }
}

/// The value of a shape that reads nothing but its point, and where a call puts it, if it only moves and turns it.
pub(super) fn placed(graph: &Graph, shape: ShapeId, args: &[NodeId]) -> Option<(NodeId, Placed)> {
    let s = graph.shape(shape).filter(|s| s.variables.is_empty() && s.dimensions == 3)?;
    let placed = Placed::of(graph, args).filter(|placed| placed.farthest() < 0.01 * FARTHEST)?;
    Some((s.value, placed))
}

/// By how much a coordinate is moved, where it is only moved.
pub(super) fn shift_along(graph: &Graph, coordinate: NodeId, axis: usize) -> Option<f64> {
    let is_coordinate = |id: NodeId| {
        matches!(graph.node(id), Node::Leaf(Leaf::P(i)) if usize::from(*i) == axis)
    };
    if is_coordinate(coordinate) {
        return Some(0.0);
    }
    match graph.node(coordinate) {
        Node::Op(op @ (Op::Add | Op::Sub), args) if is_coordinate(*args.first()?) => {
            let c = graph.as_constant(*args.get(1)?)?;
            Some(if *op == Op::Add { c } else { -c })
        }
        _ => None,
    }
}
