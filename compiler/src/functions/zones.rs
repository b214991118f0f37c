//! Bounds of what is moved by a map that stretches space less near the origin than all over the extent.

use crate::analysis::search::Target;
use crate::analysis::{Box3, Domain};
use crate::functions::bound_strategy::Known;
use crate::functions::builder::Builder;
use crate::functions::limits::BUDGET;
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::{NodeId, Proof, ShapeId};
use crate::rules::Rule;

/// Zones about the origin of which each is so large a part of the one before, at most so many; each has to be gentler by this than the one before.
const ZONE: f64 = 1.0 / 3.0;
const MOST_ZONES: usize = 4;
const GENTLER: f64 = 0.8;

impl Builder<'_> {
    /// The bound of a shape that is moved all over the extent by a map that stretches less near the origin, as a bend does. Within a zone about it the least
    /// of two numbers is a bound: what the shape says, over how far the map stretches there, and the way out of the zone, beyond which anything may be. The
    /// largest of the bounds of all zones and of `whole` is one; a value below zero is over what the map stretches all over.
    pub(super) fn in_zones(&mut self, whole: NodeId, call: NodeId, point: &[NodeId], all: &Domain, node: NodeId, shape: ShapeId) -> NodeId {
        if !self.facts.rules.has(Rule::Zones) {
            return whole;
        }
        let stretch = |builder: &mut Self, region: Box3| builder.facts.map_constant(builder.graph, point, &all.at(region), BUDGET).lipschitz;
        let narrowed = |share: f64, axes: [bool; 3]| {
            let sides = all.point.0.into_iter().zip(axes).map(|(side, narrow)| if narrow { Interval::new(share * side.lo, share * side.hi) } else { side });
            let mut region = all.point;
            region.0.iter_mut().zip(sides).for_each(|(slot, side)| *slot = side);
            region
        };
        let mut last = stretch(self, all.point);
        // What an axis has no part in goes on without an end.
        let axes = [0, 1, 2].map(|axis| stretch(self, narrowed(ZONE, [0, 1, 2].map(|i| i == axis))) < GENTLER * last);
        if !axes.contains(&true) || !all.point.0.iter().all(|side| side.lo < 0.0 && side.hi > 0.0) {
            return whole;
        }
        let mut bound = whole;
        let mut share = 1.0;
        for _ in 0..MOST_ZONES {
            share *= ZONE;
            let zone = narrowed(share, axes);
            let known = stretch(self, zone);
            if known.is_nan() || known >= GENTLER * last {
                break;
            }
            last = known;
            let constant = Known { lipschitz: known, proof: Proof::Derived, search: Some((Target::Map(point.to_vec()), all.at(zone))) };
            let mut within = self.scaled(call, constant, node, shape);
            for (axis, side) in zone.0.iter().enumerate().filter(|(axis, _)| axes.get(*axis) == Some(&true)) {
                let place = self.graph.point().get(axis).copied().unwrap_or(call);
                let (low, high) = (self.graph.constant(side.lo), self.graph.constant(side.hi));
                let from_low = self.graph.op(Op::Sub, &[place, low]);
                let from_high = self.graph.op(Op::Sub, &[high, place]);
                let out = self.graph.op(Op::Min, &[from_low, from_high]);
                within = self.graph.op(Op::Min, &[within, out]);
            }
            bound = self.graph.op(Op::Max, &[bound, within]);
        }
        bound
    }
}
