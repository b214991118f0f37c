//! Chains of shapes: what a fold over many operands makes, each of which is joined with all before it. They are looked at from below, so that the depth
//! of a look does not follow their number.

use super::domain::{Domain, call_domain};
use super::facts::Facts;
use crate::graph::{Function, Graph, Leaf, Node, NodeId, ShapeId};
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use rustc_hash::FxHashSet;

/// So many shapes are looked at within each other. What is farther in is looked at before.
pub const DEEP: u32 = 40;
/// So many steps of formulas are carried back through within each other, those of shapes in them counted in; beyond that nothing is said.
pub(super) const DEEPEST: u32 = 400;

impl Graph {
    /// The shapes that a formula calls, and those that they call, each once, older ones first; without those that are `known` and what is in them.
    pub fn called_below(&self, node: NodeId, known: impl Fn(ShapeId) -> bool) -> Vec<ShapeId> {
        self.below(node, |_, _| true, known)
    }

    /// The same of calls at the own point, with the own variables.
    pub(super) fn chained_below(&self, node: NodeId, known: impl Fn(ShapeId) -> bool) -> Vec<ShapeId> {
        let here = |shape: ShapeId, args: &[NodeId]| {
            let is = |i: usize, leaf: Leaf| args.get(i).is_some_and(|&a| *self.node(a) == Node::Leaf(leaf));
            let variables = self.shape(shape).map(|s| s.variables.clone()).unwrap_or_default();
            (0..3u8).all(|i| is(usize::from(i), Leaf::P(i))) && (3..).zip(variables.iter()).all(|(i, &v)| is(i, Leaf::Variable(v)))
        };
        self.below(node, here, known)
    }

    /// What a formula is the least of, minima of minima laid open, in their order; a minimum that is `whole` stays as it is.
    pub(super) fn least_of(&self, node: NodeId, whole: impl Fn(NodeId) -> bool) -> Vec<NodeId> {
        let (mut open, mut found) = (vec![node], Vec::new());
        while let Some(id) = open.pop() {
            match self.node(id) {
                Node::Op(Op::Min, args) if id == node || !whole(id) => open.extend(args.iter().rev()),
                _ => found.push(id),
            }
        }
        found
    }

    fn below(&self, node: NodeId, follows: impl Fn(ShapeId, &[NodeId]) -> bool, known: impl Fn(ShapeId) -> bool) -> Vec<ShapeId> {
        let mut seen: FxHashSet<ShapeId> = FxHashSet::default();
        let (mut open, mut calling, mut found) = (vec![node], Vec::new(), Vec::new());
        while let Some(node) = open.pop() {
            self.calling(&[node], &mut calling);
            for id in &calling {
                let Node::Call(shape, Function::Field, args) = self.node(*id) else { continue };
                if follows(*shape, args) && !known(*shape) && seen.insert(*shape) {
                    found.push(*shape);
                    open.extend(self.shape(*shape).map(|s| s.value));
                }
            }
        }
        // What a shape calls was made before it.
        found.sort_unstable();
        found
    }
}

impl Facts {
    /// Does something for the shapes that a formula calls at its own point, those within them first: each with its formula and where it is asked for.
    /// Without those that are `known` there.
    pub(super) fn look_from_below(
        &mut self,
        graph: &Graph,
        node: NodeId,
        domain: &Domain,
        known: impl Fn(&Self, ShapeId, &Domain) -> bool,
        mut look: impl FnMut(&mut Self, ShapeId, Domain),
    ) {
        let asked = |shape: ShapeId| {
            let variables = graph.shape(shape).map(|s| s.variables.clone()).unwrap_or_default();
            let args: Vec<Interval> = domain.point.0.into_iter().chain(variables.iter().map(|&v| domain.variable(v))).collect();
            call_domain(&variables, &args)
        };
        for shape in graph.chained_below(node, |shape| known(self, shape, &asked(shape))) {
            look(self, shape, asked(shape));
        }
    }
}
