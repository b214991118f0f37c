//! The steps that compute nodes, in order, ready to be run over any algebra again and again.

use crate::graph::algebra::Algebra;
use crate::graph::kernel::Op;
use crate::graph::{Claim, Graph, Leaf, Node, NodeId, ShapeId};

/// One step.
#[derive(Clone, Debug)]
pub enum Step {
    /// A constant.
    Constant(f64),
    /// A value from outside.
    Leaf(Leaf),
    /// An operation on earlier steps.
    Op(Op, Vec<usize>),
    /// A field of a shape at earlier steps.
    Call(ShapeId, Vec<usize>),
    /// A value and what it is known by: earlier steps.
    Claim(Claim, Vec<usize>),
}

/// Steps in order; each needs only those before it.
#[derive(Clone, Debug)]
pub struct Tape {
    /// The steps.
    pub steps: Vec<Step>,
    /// The node that each step computes.
    pub nodes: Vec<NodeId>,
    roots: Vec<usize>,
}

impl Tape {
    /// The steps of some nodes; with one root it is the last step.
    pub fn new(graph: &Graph, roots: &[NodeId]) -> Self {
        let nodes = graph.reachable(roots);
        let at = |id: &NodeId| nodes.binary_search(id).unwrap_or(0);
        let steps = nodes
            .iter()
            .map(|&id| match graph.node(id) {
                Node::Constant(bits) => Step::Constant(f64::from_bits(*bits)),
                Node::Leaf(leaf) => Step::Leaf(*leaf),
                Node::Op(op, args) => Step::Op(*op, args.iter().map(at).collect()),
                Node::Call(shape, _, args) => Step::Call(*shape, args.iter().map(at).collect()),
                Node::Claim(args, claim) => Step::Claim(claim.clone(), args.iter().map(at).collect()),
                Node::Factor(i) => {
                    Step::Constant(graph.factors.get(*i as usize).map_or(1.0, |f| 1.0 / f.lipschitz))
                }
            })
            .collect();
        let roots = roots.iter().map(at).collect();
        Self { steps, nodes, roots }
    }

    /// The step of each root.
    pub fn roots(&self) -> impl Iterator<Item = usize> + use<'_> {
        self.roots.iter().copied()
    }

    /// Runs the steps; the answer has a value for each.
    pub fn run<A: Algebra>(
        &self,
        graph: &Graph,
        algebra: &mut A,
        mut leaf: impl FnMut(&mut A, Leaf) -> A::Value,
        mut call: impl FnMut(&mut A, ShapeId, &[A::Value]) -> A::Value,
    ) -> Vec<A::Value> {
        let mut values: Vec<A::Value> = Vec::with_capacity(self.steps.len());
        let mut buffer: Vec<A::Value> = Vec::new();
        for step in &self.steps {
            let mut gather = |args: &[usize], values: &[A::Value]| {
                buffer.clear();
                buffer.extend(args.iter().filter_map(|&a| values.get(a).cloned()));
            };
            let value = match step {
                Step::Constant(c) => algebra.constant(*c),
                Step::Leaf(l) => leaf(algebra, *l),
                Step::Op(op, args) => {
                    gather(args, &values);
                    algebra.op(*op, &buffer)
                }
                Step::Call(shape, args) => {
                    gather(args, &values);
                    call(algebra, *shape, &buffer)
                }
                Step::Claim(claim, args) => {
                    gather(args, &values);
                    match buffer.split_first() {
                        Some((value, of)) => algebra.claim(graph, value.clone(), claim, of),
                        None => algebra.constant(0.0),
                    }
                }
            };
            values.push(value);
        }
        values
    }
}
