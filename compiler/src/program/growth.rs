//! How far the body of a repetition reaches, and how its field grows away from it.
//!
//! Copies that a repetition does not look at are farther away than its cap. The cap is compared with the fields of those that are looked at, so it
//! may be no more than what a copy's field is at that distance: else the value jumps where a copy comes to be looked at.

use super::Elaborator;
use crate::analysis::region::WORLD_SIDE;
use crate::analysis::{Box3, Domain, cell_ranges};
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::{Claim, Exactness, FAR, Function, Node, NodeId, ShapeId};
use std::ops::Range;

/// Each level is so much of the one above it.
const FINER: f64 = 0.8;
/// At most so many levels are looked at.
const LEVELS: usize = 12;
/// What is less than a distance by so little is taken for one: regions are not found to the last digit.
const DISTANCE: f64 = 1.02;
/// At so many distances, and so many places along each side of a box, a field is compared with the distance.
const FAR_PLACES: u32 = 4;
const ACROSS: u32 = 5;
/// What calls one another so deep is not asked whether it is a distance.
const DEEPEST: usize = 64;

impl Elaborator<'_> {
    /// A box that holds a body over all of its cells. What is not seen to end within the extent, or does not begin there, is looked for far beyond
    /// it: the scene may be given a larger one.
    pub(super) fn body_box(&mut self, body: ShapeId, cells: &dyn Fn(u32) -> Option<(f64, f64)>) -> Box3 {
        let graph = &mut self.graph;
        let extent = self.extent;
        let near = self.facts.body_region(graph, body, cells, Box3::cube(extent));
        if !near.is_empty() && near.0.iter().all(|side| side.magnitude() < extent) {
            return near;
        }
        let far = Box3::cube(extent.max(WORLD_SIDE));
        self.facts.closer_and_closer(|facts, within| facts.body_region(graph, body, cells, within), far)
    }

    /// The least share that a body's field is of the distance from its box `region`, over all of its cells, along some axes and over a range of
    /// distances: 1 where it is that distance or more, and where nothing is known.
    pub(super) fn share_of_distance(
        &mut self,
        body: ShapeId,
        cells: &dyn Fn(u32) -> Option<(f64, f64)>,
        region: &Box3,
        distances: Range<f64>,
        axes: &[usize],
    ) -> f64 {
        let Some(value) = self.graph.shape(body).map(|s| s.value) else { return 1.0 };
        if region.is_empty() || !distances.end.is_finite() || self.is_distance(value, DEEPEST) {
            return 1.0;
        }
        let variables = cell_ranges(&self.graph, body, cells);
        let side = region.0.iter().fold(0.0, |far: f64, side| far.max(side.magnitude())) + 64.0 * distances.end;
        let domain = Domain { variables, ..Domain::of(Box3::cube(side)) };
        if axes.iter().all(|&axis| self.grows_as_a_distance(value, &domain, region, &distances, axis)) {
            return 1.0;
        }
        let (mut share, mut level, mut above) = (1.0f64, distances.end, f64::INFINITY);
        for _ in 0..LEVELS {
            let at_most = self.facts.rough_region_at(&self.graph, value, &domain, level);
            let grown = axes.iter().map(|&i| {
                let (inner, outer) = (region.axis(i), at_most.axis(i));
                (inner.lo - outer.lo).max(outer.hi - inner.hi).max(0.0)
            });
            let here = grown.fold(0.0, f64::hypot);
            if here >= 63.0 * distances.end {
                return 1.0;
            }
            // Up to where the level above is reached the field is at least this one.
            share = share.min(level / above.min(distances.end));
            if here <= distances.start {
                break;
            }
            above = here;
            level *= FINER;
        }
        share
    }

    /// Whether the field is no less than the distance from a box along an axis, at places beyond it.
    fn grows_as_a_distance(&mut self, value: NodeId, domain: &Domain, region: &Box3, distances: &Range<f64>, axis: usize) -> bool {
        let tape = self.facts.tape(&self.graph, value);
        let parts = |i: usize| {
            let side = region.axis(i);
            let (low, high) = (side.lo.max(-distances.end), side.hi.min(distances.end));
            (0..ACROSS).map(move |k| low + (high - low) * (f64::from(k) + 0.5) / f64::from(ACROSS))
        };
        let side = region.axis(axis);
        for k in 1..=FAR_PLACES {
            let distance = distances.start + (distances.end - distances.start) * f64::from(k) / f64::from(FAR_PLACES);
            for at in [side.lo - distance, side.hi + distance] {
                for (a, b) in parts((axis + 1) % 3).flat_map(|a| parts((axis + 2) % 3).map(move |b| (a, b))) {
                    let mut place = Box3::cube(0.0);
                    for (i, coordinate) in [(axis, at), ((axis + 1) % 3, a), ((axis + 2) % 3, b)] {
                        place = place.with_axis(i, Interval::point(coordinate));
                    }
                    let found = self.facts.ranges_of(&self.graph, &tape, &domain.at(place)).last().map_or(f64::NEG_INFINITY, |r| r.lo);
                    if DISTANCE * found < distance {
                        return false;
                    }
                }
            }
        }
        true
    }

    /// Whether a value is seen to be the distance to its solid, or the least of such.
    fn is_distance(&mut self, node: NodeId, deep: usize) -> bool {
        match self.graph.node(node).clone() {
            Node::Op(Op::Min, args) => deep > 0 && args.iter().all(|&a| self.is_distance(a, deep - 1)),
            Node::Op(Op::Select, args) if args.len() == 3 => deep > 0 && args.iter().skip(1).all(|&a| self.is_distance(a, deep - 1)),
            Node::Constant(bits) => f64::from_bits(bits) >= FAR,
            Node::Claim(args, Claim::Continuous) => deep > 0 && args.first().is_some_and(|&a| self.is_distance(a, deep - 1)),
            Node::Call(shape, Function::Field, args) => {
                let Some((value, exact)) = self.graph.shape(shape).map(|s| (s.value, s.exactness == Exactness::Exact)) else { return false };
                let rigid = args.get(..3).is_some_and(|point| self.facts.is_rigid(&self.graph, point));
                rigid && (exact || deep > 0 && self.is_distance(value, deep - 1))
            }
            _ => false,
        }
    }
}

/// The largest angle between the positive `u` axis and a point of the box, in the plane of `u` and `v`; none where it reaches the axis.
pub(super) fn angle_about_zero(region: &Box3, u: usize, v: usize) -> Option<f64> {
    let (a, b) = (region.axis(u), region.axis(v));
    if a.is_empty() || b.is_empty() {
        return Some(0.0);
    }
    if a.lo <= 0.0 && a.hi >= 0.0 && b.lo <= 0.0 && b.hi >= 0.0 {
        return None;
    }
    let corners = [(a.lo, b.lo), (a.lo, b.hi), (a.hi, b.lo), (a.hi, b.hi)];
    if a.lo <= 0.0 && b.contains(0.0) {
        return Some(std::f64::consts::PI);
    }
    Some(corners.iter().map(|&(x, y)| y.atan2(x).abs()).fold(0.0, f64::max))
}
