//! Which material a shape has, whatever its point: a tower of shared shapes is asked once a shape, not once a path.

use crate::analysis::chain::DEEP;
use crate::diagnostic::{Code, Diagnostic};
use crate::functions::builder::Builder;
use crate::functions::found::Dress;
use crate::graph::kernel::Op;
use crate::graph::{Function, Graph, MaterialId, Node, NodeId, ShapeId};

/// A surface of more shapes than these, each with a material of its own place, would be a formula too long for any shader.
const MOST_LOOKS: usize = 100_000;

impl Builder<'_> {
    /// Which material a shape has.
    pub(super) fn dress_of_shape(&mut self, shape: ShapeId) -> Dress {
        let Some(s) = self.graph.shape(shape) else { return Dress::Bare };
        match s.material {
            _ if !s.paints.is_empty() => Dress::Many,
            Some(material) if self.is_plain(material) => Dress::One(material),
            Some(_) => Dress::Many,
            None => self.dress(s.value),
        }
    }

    /// Whether a material says the same everywhere.
    fn is_plain(&self, material: MaterialId) -> bool {
        let material = self.graph.materials.get(material.0 as usize);
        material.is_some_and(|m| m.relief.is_none() && m.images.is_empty() && m.look().iter().all(|n| self.is_uniform(*n)))
    }

    /// The same of a formula, in the words of [`Builder::find_look`].
    fn dress(&mut self, node: NodeId) -> Dress {
        if !self.graph.reads(node).shapes {
            return Dress::Bare;
        }
        if let Some(known) = self.materials.dresses.get(&node) {
            return *known;
        }
        self.found.deep += 1;
        if self.found.deep > DEEP {
            let value = |graph: &Graph, shape| graph.shape(shape).map(|s| s.value);
            let known = |shape| value(self.graph, shape).is_none_or(|value| self.materials.dresses.contains_key(&value));
            for value in self.graph.called_below(node, known).into_iter().filter_map(|shape| value(self.graph, shape)).collect::<Vec<_>>() {
                self.dress(value);
            }
        }
        let dress = match self.graph.node(node).clone() {
            Node::Call(shape, Function::Field, args) if args.iter().all(|a| !self.graph.reads(*a).shapes) => self.dress_of_shape(shape),
            Node::Op(Op::Neg, args) => args.first().map_or(Dress::Bare, |a| self.dress(*a)),
            Node::Claim(args, _) => args.first().map_or(Dress::Bare, |a| self.dress(*a)),
            Node::Op(op, args) => {
                let parts: Vec<Dress> = args.iter().map(|a| self.dress(*a)).collect();
                match parts.as_slice() {
                    parts if parts.iter().all(|p| *p == Dress::Bare) => Dress::Bare,
                    [Dress::One(a), Dress::One(b)] if a == b && matches!(op, Op::Min | Op::Max) => Dress::One(*a),
                    [Dress::One(m), Dress::Bare] if op == Op::Max && !args.first().is_some_and(|a| self.cuts(*a)) => Dress::One(*m),
                    [Dress::Bare, Dress::One(m)] if op == Op::Max && !args.get(1).is_some_and(|a| self.cuts(*a)) => Dress::One(*m),
                    _ => Dress::Many,
                }
            }
            _ => Dress::Many,
        };
        self.found.deep -= 1;
        self.materials.dresses.insert(node, dress);
        dress
    }

    /// Counts a look; says so where there are too many.
    pub(super) fn may_look(&mut self, shape: ShapeId) -> bool {
        self.materials.looked += 1;
        if self.materials.looked == MOST_LOOKS {
            let at = self.graph.shape(shape).map(|s| s.span);
            self.diagnostics.extend(at.map(|at| {
                Diagnostic::new(
                    Code::TooLarge,
                    at,
                    "the scene has too many places where materials meet: a shape of several materials is in it more than a hundred thousand times",
                    "give the whole one material with `.material(…)`, or repeat the shape with `grid` or `.repeat(…)`",
                )
            }));
        }
        self.materials.looked < MOST_LOOKS
    }
}
