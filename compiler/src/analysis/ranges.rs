//! Ranges: all values of a formula over a domain.

use super::chain::DEEP;
use super::domain::{Box3, Domain, call_domain, leaf_range};
use super::facts::{Facts, MOST_KEPT};
use super::formula::Formula;
use crate::graph::interval::Interval;
use crate::graph::kernel;
use crate::graph::{Graph, Node, NodeId, ShapeId};
use smallvec::SmallVec;

impl Facts {
    /// All values of a node that reads nothing but parameters and time. Each node is looked at once: loops ask for chains that grow with
    /// every turn.
    pub fn live_range(&mut self, graph: &Graph, node: NodeId) -> Interval {
        let everywhere = Domain::of(Box3::ALL);
        let pinned = self.pinned.clone();
        let mut open = vec![node];
        while let Some(&id) = open.last() {
            if self.live_ranges.contains_key(&id) {
                open.pop();
                continue;
            }
            let args = graph.arguments(id);
            let before = open.len();
            open.extend(args.iter().copied().filter(|a| !self.live_ranges.contains_key(a)));
            if open.len() > before {
                continue;
            }
            let known: Vec<Interval> =
                args.iter().map(|a| self.live_ranges.get(a).copied().unwrap_or(Interval::ALL)).collect();
            let range = match graph.node(id) {
                Node::Constant(bits) => Interval::point(f64::from_bits(*bits)),
                Node::Leaf(leaf) => leaf_range(graph, &pinned, *leaf, &everywhere),
                Node::Op(op, _) => kernel::interval(*op, &known),
                Node::Call(shape, _, _) => self.shape_range(graph, *shape, &known),
                Node::Claim(..) => known.first().copied().unwrap_or(Interval::ALL),
                Node::Factor(i) => Interval::point(graph.factors.get(*i as usize).map_or(1.0, |f| 1.0 / f.lipschitz)),
            };
            self.live_ranges.insert(id, range);
            open.pop();
        }
        self.live_ranges.get(&node).copied().unwrap_or(Interval::ALL)
    }

    /// All values of a node over a domain.
    pub fn range(&mut self, graph: &Graph, node: NodeId, domain: &Domain) -> Interval {
        let tape = self.tape(graph, node);
        self.ranges_of(graph, &tape, domain).last().copied().unwrap_or(Interval::ALL)
    }

    /// The same, at once where the node is made of few others.
    pub fn near_range(&mut self, graph: &Graph, node: NodeId, domain: &Domain, depth: u32) -> Interval {
        match graph.node(node) {
            Node::Constant(bits) => Interval::point(f64::from_bits(*bits)),
            Node::Leaf(leaf) => leaf_range(graph, &self.pinned, *leaf, domain),
            Node::Op(op, args) if depth > 0 => {
                let args: SmallVec<[Interval; 4]> = args.iter().map(|&a| self.near_range(graph, a, domain, depth - 1)).collect();
                kernel::interval(*op, &args)
            }
            _ => self.range(graph, node, domain),
        }
    }

    /// The range of every step of a tape over a domain.
    pub fn ranges_of(&mut self, graph: &Graph, tape: &Formula, domain: &Domain) -> Vec<Interval> {
        self.account.boxes += 1;
        self.account.run(tape.steps.len(), (false, !tape.is_seen()));
        let pinned = self.pinned.clone();
        tape.ranges(
            graph,
            |_, leaf| leaf_range(graph, &pinned, leaf, domain),
            |_, shape, args| self.shape_range(graph, shape, args),
        )
    }

    /// All values of a shape's field over intervals of its arguments.
    pub fn shape_range(&mut self, graph: &Graph, shape: ShapeId, args: &[Interval]) -> Interval {
        let Some(s) = graph.shape(shape) else { return Interval::ALL };
        self.range_in(graph, shape, &call_domain(&s.variables, args))
    }

    /// The same over a domain of its own.
    fn range_in(&mut self, graph: &Graph, shape: ShapeId, domain: &Domain) -> Interval {
        let Some(s) = graph.shape(shape) else { return Interval::ALL };
        let key = (shape, domain.key());
        if let Some(known) = self.ranges.get(&key) {
            return *known;
        }
        if !self.enter() {
            return Interval::ALL;
        }
        if self.looks.nested.0 >= DEEP {
            let known = |facts: &Self, shape, domain: &Domain| facts.ranges.contains_key(&(shape, domain.key()));
            self.look_from_below(graph, s.value, domain, known, |facts, shape, domain| {
                facts.range_in(graph, shape, &domain);
            });
        }
        let range = self.range(graph, s.value, domain);
        self.looks.nested.0 -= 1;
        if self.ranges.len() >= MOST_KEPT {
            self.ranges.clear();
        }
        self.ranges.insert(key, range);
        range
    }
}
