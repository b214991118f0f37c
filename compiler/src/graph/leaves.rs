//! What formulas read from outside, through the shapes that they call: parameters, variables, time, the point.

use super::{Claim, Graph, Leaf, Node, NodeId, ShapeId};
use rustc_hash::FxHashSet;

impl Graph {
    /// Components of parameters that nodes depend on, through the shapes that they call.
    pub fn parameters_under(&self, nodes: &[NodeId]) -> FxHashSet<u32> {
        let parameter = |leaf| if let Leaf::Parameter(i) = leaf { Some(i) } else { None };
        self.leaves_under(nodes).into_iter().filter_map(parameter).collect()
    }

    /// The leaves that nodes read, through the shapes that they call.
    pub fn leaves_under(&self, nodes: &[NodeId]) -> FxHashSet<Leaf> {
        let mut read = FxHashSet::default();
        let mut seen: FxHashSet<ShapeId> = FxHashSet::default();
        let mut roots: Vec<NodeId> = nodes.to_vec();
        while !roots.is_empty() {
            for id in self.reachable(&std::mem::take(&mut roots)) {
                match self.node(id) {
                    Node::Leaf(leaf) => {
                        read.insert(*leaf);
                    }
                    Node::Call(s, ..) if seen.insert(*s) => roots.extend(self.shape(*s).map(|s| s.value)),
                    Node::Claim(_, Claim::Lipschitz(formula, ..)) => roots.push(*formula),
                    _ => {}
                }
            }
        }
        read
    }

    /// Components of parameters that a shape and nodes read.
    pub fn parameters_read(&self, root: ShapeId, nodes: &[NodeId]) -> FxHashSet<u32> {
        let mut read = FxHashSet::default();
        let mut shapes = vec![root];
        let mut seen: FxHashSet<ShapeId> = FxHashSet::default();
        let mut roots: Vec<NodeId> = nodes.to_vec();
        while !shapes.is_empty() || !roots.is_empty() {
            while let Some(id) = shapes.pop() {
                if !seen.insert(id) {
                    continue;
                }
                let Some(shape) = self.shape(id) else { continue };
                roots.push(shape.value);
                let materials = shape.material.iter().chain(shape.paints.iter().map(|(_, m)| m));
                for m in materials.filter_map(|m| self.materials.get(m.0 as usize)) {
                    roots.extend(m.nodes());
                }
                shapes.extend(shape.paints.iter().map(|(s, _)| *s));
            }
            for id in self.reachable(&std::mem::take(&mut roots)) {
                match self.node(id) {
                    Node::Leaf(Leaf::Parameter(i)) => {
                        read.insert(*i);
                    }
                    Node::Call(s, _, _) if !seen.contains(s) => shapes.push(*s),
                    _ => {}
                }
            }
        }
        read
    }
}
