//! The bound of a smooth union of which an operand is steep, by its parts.
//!
//! Let S = min(a, b) - r(|a - b|) with r from k/4 down to 0 at k, no steeper than 1/2: it does not fall as a or b grows. Where b ≥ k and a > 0, S is
//! at least what it is of a and k, which is over what it is of 0 and k, and that is 0. So the solid of S is that of a, that of b, and what of S lies
//! where both are less than k. The least of the three bounds is a bound; the last of them is needed in a box, and only there must S be as gentle as
//! its factor says. Of a point inside it says no more than the way out of the box, beyond which S may be steeper.

use crate::analysis::{Box3, Domain};
use crate::functions::bound_strategy::{BoundStrategy, Over};
use crate::functions::builder::Builder;
use crate::functions::limits::{BUDGET, UNIT};
use crate::graph::kernel::Op;
use crate::graph::{Function, Node, NodeId, Proof, ShapeId};
use crate::rules::Rule;

/// A constant up to here is not worth a look at the parts.
const GENTLE: f64 = 4.0;
/// The box where both are near is worth it if the whole is this much gentler there, or steep and the box this much of the whole's region: what is
/// in it is asked for twice.
const GENTLER: f64 = 0.6;
const VERY_STEEP: f64 = 16.0;
const SMALLER: f64 = 0.5;
/// A blend that is steeper is looked at with its operands cut off at so many times its width.
const STEEP: f64 = 4.0;
const LEVELS: [f64; 4] = [1.0, 2.0, 4.0, 16.0];
/// Of a blend is asked what it is where its gentle operands are less than so many times its width.
const NEAR: f64 = 2.0;
/// So many shapes within each other are asked whether their bounds can be proven.
const MOST_CALLS: u32 = 32;
/// Smooth unions within each other are taken apart so deep: each asks for the field of all that is below it.
const DEEPEST: u32 = 4;

impl Builder<'_> {
    /// The bound of a smooth union by those of its operands; none where it is no such union, or gains nothing.
    pub(super) fn by_operands(&mut self, shape: ShapeId, node: NodeId, domain: &Domain, continuous: bool, whole: &BoundStrategy) -> Option<NodeId> {
        if !self.facts.rules.has(Rule::SmoothUnionOperands) {
            return None;
        }
        if whole.constant <= GENTLE || whole.proof == Proof::Measured || whole.jumps || whole.over == Over::Cell || self.parting >= DEEPEST {
            return None;
        }
        let (a, b, radius) = self.graph.smooth_union(node)?;
        if ![a, b].into_iter().all(|part| self.is_provable(shape, part, domain, continuous, MOST_CALLS)) {
            return None;
        }
        let mut near = Some((whole.region.map_or(domain.point, |(region, _)| region), 0.0));
        for part in [a, b] {
            let level = self.graph.op(Op::Sub, &[part, radius]);
            near = match (near, self.region_of(level, domain)) {
                (Some((known, reach)), Some((region, more))) => Some((known.intersect(&region), more.max(reach))),
                _ => None,
            };
        }
        let near = near.filter(|(region, _)| !region.is_empty());
        let widest = self.facts.live_range(self.graph, radius).hi;
        let tame = self.tame([a, b], domain);
        let blend = match near {
            None => None,
            Some((region, reach)) => {
                let mut at = domain.at(region.grow(reach));
                at.within.extend(tame.iter().map(|&operand| (operand, NEAR * widest)));
                let constant = self.facts.constant(self.graph, node, &at, BUDGET);
                let capped = self.capped_blend(node, [a, b], widest, &at, constant.lipschitz);
                let (value, lipschitz) = capped.unwrap_or((node, constant.lipschitz));
                let gentler = lipschitz <= GENTLER * whole.constant;
                let of_all = |all: &Box3| volume(&region.grow(reach)) <= SMALLER * volume(all);
                let smaller = whole.constant > VERY_STEEP && whole.region.is_none_or(|(all, _)| of_all(&all));
                if constant.jumps || lipschitz > whole.constant || !(gentler || smaller) {
                    return None;
                }
                let of_it = BoundStrategy { constant: lipschitz.max(1e-6), jumps: false, region: None, proof: Proof::Derived, over: Over::Region };
                Some((value, of_it, at, region, reach))
            }
        };
        self.parting += 1;
        let mut bounds: Vec<NodeId> = [a, b].map(|part| self.bound(shape, part, domain, continuous)).into();
        if let Some((value, strategy, at, region, reach)) = blend {
            let way = self.over_its_constant(shape, value, &at, continuous, strategy);
            let way = self.beside_tame(&tame, widest, way);
            // Inside it is no more than the way out of where that holds.
            let way = match self.outside(region, None) {
                Some(outside) => {
                    let reach = self.graph.constant(reach);
                    let out = self.graph.op(Op::Sub, &[outside, reach]);
                    self.graph.op(Op::Max, &[way, out])
                }
                None => way,
            };
            bounds.push(self.behind(region, None, reach, way));
        }
        self.parting -= 1;
        bounds.into_iter().reduce(|one, other| self.graph.op(Op::Min, &[one, other]))
    }

    /// A blend of operands that are cut off where they are so large that the blend is another one's surface or none, where that is much gentler
    /// than the blend itself: it is zero at the same places.
    fn capped_blend(&mut self, node: NodeId, operands: [NodeId; 2], widest: f64, at: &Domain, whole: f64) -> Option<(NodeId, f64)> {
        if whole <= STEEP {
            return None;
        }
        let now = self.as_parameters_stand(node, at, whole);
        let mut best: Option<(NodeId, f64)> = None;
        let mut farthest = 0.0;
        for level in LEVELS.map(|times| times * widest) {
            let limit = self.graph.constant(level);
            let cut = operands.map(|operand| self.graph.op(Op::Min, &[operand, limit]));
            let capped = self.graph.blend_of(node, operands, cut)?;
            let constant = self.facts.constant(self.graph, capped, at, BUDGET);
            let gentler = self.as_parameters_stand(capped, at, constant.lipschitz);
            let way = (level - 0.25 * widest) / gentler.max(1e-6);
            if !constant.jumps && gentler <= GENTLER * now && way > farthest {
                farthest = way;
                best = Some((capped, constant.lipschitz));
            }
        }
        best
    }

    /// Whether the bound of a formula, and of the shapes that it is put together of, can be proven by itself.
    fn is_provable(&mut self, shape: ShapeId, node: NodeId, domain: &Domain, continuous: bool, calls: u32) -> bool {
        if self.is_exact(shape, node) {
            return true;
        }
        match self.graph.node(node).clone() {
            Node::Constant(_) => true,
            Node::Op(Op::Min | Op::Max | Op::Neg, args) => args.iter().all(|&arg| self.is_provable(shape, arg, domain, continuous, calls)),
            Node::Call(inner, Function::Field, _) => {
                let Some(value) = self.graph.shape(inner).map(|inner| inner.value).filter(|_| calls > 0) else { return false };
                let own = self.domain(inner);
                self.strategy(shape, node, domain, continuous).is_some() && self.is_provable(inner, value, &own, continuous, calls - 1)
            }
            _ => self.treated(shape, node, domain, continuous).is_some_and(|(_, strategy)| strategy.proof != Proof::Measured),
        }
    }

    /// Those of two operands that are no steeper than one wherever they are.
    fn tame(&mut self, operands: [NodeId; 2], domain: &Domain) -> Vec<NodeId> {
        let everywhere = Domain { within: Vec::new(), ..domain.at(Box3::ALL) };
        let is_tame = |operand: &NodeId| {
            let constant = self.facts.constant(self.graph, *operand, &everywhere, 1);
            constant.lipschitz <= UNIT && !constant.jumps && self.graph.reads(*operand).variables == 0
        };
        operands.into_iter().filter(is_tame).collect()
    }

    /// The way to a blend of such a width. No part of it lies where an operand is over that width, so a tame one says how far away it is at least; and
    /// what is said of the blend near that operand holds as far as from there.
    fn beside_tame(&mut self, tame: &[NodeId], widest: f64, way: NodeId) -> NodeId {
        let [near, widest] = [NEAR * widest, widest].map(|level| self.graph.constant(level));
        let mut way = way;
        for &operand in tame {
            let room = self.graph.op(Op::Sub, &[near, operand]);
            way = self.graph.op(Op::Min, &[way, room]);
        }
        for &operand in tame {
            let beyond = self.graph.op(Op::Sub, &[operand, widest]);
            way = self.graph.op(Op::Max, &[way, beyond]);
        }
        way
    }
}

fn volume(of: &Box3) -> f64 {
    of.0.iter().map(|side| side.width()).product()
}
