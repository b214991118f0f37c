//! Boxes about solids that are worth a closer look: where what is seen at once is far too wide.

use super::region::{FAR, FARTHEST, MOVES, placed};
use super::{Box3, Domain, Facts};
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::{Claim, Function, Graph, Node, NodeId};

/// So many places tell whether a solid ends.
const PLACES: usize = 24;

impl Facts {
    /// [`Facts::outline`], with a closer look where that reaches beyond so far from the origin: a box that hardly holds anything may be wide.
    pub fn close_outline(&mut self, graph: &Graph, node: NodeId, far: f64) -> Box3 {
        self.close_outline_within(graph, node, far, 0)
    }

    fn close_outline_within(&mut self, graph: &Graph, node: NodeId, far: f64, moves: usize) -> Box3 {
        let outline = self.outline_within(graph, node, moves);
        if outline.is_empty() || outline.0.iter().all(|side| side.magnitude() < far) {
            return outline;
        }
        if let Some(known) = self.close_outlines.get(&node) {
            return *known;
        }
        let found = match graph.node(node) {
            Node::Op(Op::Min, args) => args.iter().fold(Box3::EMPTY, |hull, &a| hull.hull(&self.close_outline_within(graph, a, far, moves))),
            Node::Claim(args, Claim::Continuous) => args.first().map_or(outline, |&a| self.close_outline_within(graph, a, far, moves)),
            Node::Call(shape, Function::Field, args) if moves < MOVES && let Some((value, placed)) = placed(graph, *shape, args) => {
                // Of many copies one is looked at.
                placed.back(self.close_outline_within(graph, value, far, moves + 1))
            }
            _ => {
                let region = outline.intersect(&Box3::cube(FARTHEST));
                let cost = self.weight(graph, node);
                if cost > self.account.outlining {
                    return outline;
                }
                self.account.outlining -= cost;
                match self.is_found_in(graph, node, &region) {
                    true => region,
                    false => self.closer_and_closer(|facts, within| facts.region(graph, node, &Domain::of(within), 0.0), region),
                }
            }
        };
        self.close_outlines.insert(node, found);
        found
    }

    /// The same where a region cuts off what ends nowhere as far as is seen at once: the solid may be far smaller than the region, which is looked at.
    pub fn outline_in_regions(&mut self, graph: &Graph, node: NodeId, moves: usize) -> Box3 {
        let outline = self.outline_within(graph, node, moves);
        if outline.is_empty() {
            return outline;
        }
        if let Some(known) = self.region_outlines.get(&node) {
            return *known;
        }
        let found = match graph.node(node) {
            Node::Op(Op::Min, args) => args.iter().fold(Box3::EMPTY, |hull, &a| hull.hull(&self.outline_in_regions(graph, a, moves))),
            Node::Claim(args, Claim::Continuous) => args.first().map_or(outline, |&a| self.outline_in_regions(graph, a, moves)),
            Node::Call(shape, Function::Field, args) if moves < MOVES && let Some((value, placed)) = placed(graph, *shape, args) => {
                placed.back(self.outline_in_regions(graph, value, moves + 1))
            }
            Node::Op(Op::Max, args) if args.iter().any(|&a| self.outline_within(graph, a, moves).size() > FAR) && !self.is_found_in(graph, node, &outline) => {
                self.closer_and_closer(|facts, within| facts.region(graph, node, &Domain::of(within), 0.0), outline)
            }
            _ => outline,
        };
        let found = found.intersect(&outline);
        self.region_outlines.insert(node, found);
        found
    }

    /// Whether some places of a large box can't be told from the solid: a closer look would leave the box as it is.
    fn is_found_in(&mut self, graph: &Graph, node: NodeId, region: &Box3) -> bool {
        let tape = self.tape(graph, node);
        (1..=PLACES).any(|i| {
            let place = Box3(region.place(i).map(Interval::point));
            self.ranges_of(graph, &tape, &Domain::of(place)).last().is_none_or(|value| value.lo <= 0.0)
        })
    }

    /// What a look at a box leaves of it, again and again: within a large box a small solid is only seen to be somewhere about.
    pub fn closer_and_closer(&mut self, mut look: impl FnMut(&mut Self, Box3) -> Box3, mut region: Box3) -> Box3 {
        loop {
            let before = region.size();
            region = look(self, region);
            let gained = region.size() < 0.9 * before;
            if region.is_empty() || !region.is_finite() || !gained {
                return region;
            }
        }
    }
}
