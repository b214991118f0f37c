//! Groups of shapes' values that may as well be made of the shapes' bounds.

use crate::analysis::rules::claims::claim_constant;
use crate::analysis::{Box3, Domain};
use crate::functions::bound_strategy::Known;
use crate::functions::builder::Builder;
use crate::functions::limits::UNIT;
use crate::functions::made::Kind;
use crate::graph::{ClaimGroup, Function, Node, NodeId, Proof, ShapeId};

impl Builder<'_> {
    /// A group of the values of shapes, made of their bounds instead, over its constant for shapes that are no steeper than distances: none of them needs
    /// a factor all over the group, which asks for it in many more places than near its solid. None where bounds would not do, or gain nothing.
    ///
    /// Nothing is lost: for the distances D to the shapes' surfaces the group is as steep as is claimed, and zero where it is; bounds B are of the same
    /// signs, and |B| <= |D|; the group grows with them. So it is of the sign it has for D, and no larger.
    pub(super) fn by_bounds(
        &mut self,
        shape: ShapeId,
        node: NodeId,
        args: &[NodeId],
        (formula, groups): (NodeId, &[ClaimGroup]),
        domain: &Domain,
    ) -> Option<NodeId> {
        let (&value, mut rest) = args.split_first()?;
        let (mut calls, mut constants) = (Vec::new(), Vec::new());
        for group in groups {
            let n = match group {
                ClaimGroup::Bounds(n) => *n as usize,
                ClaimGroup::Vector(n) => usize::from(*n),
                ClaimGroup::Values(0) => 0,
                ClaimGroup::Values(_) => return None,
            };
            let (these, after) = rest.split_at_checked(n)?;
            rest = after;
            let is_shape = matches!(group, ClaimGroup::Bounds(_));
            if is_shape {
                calls.extend_from_slice(these);
            } else if !these.iter().all(|&number| self.is_uniform(number)) {
                return None;
            }
            constants.push(if is_shape { 1.0 } else { 0.0 });
        }
        let still = |call: &NodeId| match self.graph.node(*call) {
            Node::Call(_, Function::Field, args) => args.iter().skip(3).all(|&v| self.is_uniform(v)),
            _ => false,
        };
        if calls.is_empty() || !calls.iter().all(still) {
            return None;
        }
        let pinned = self.facts.pinned.clone();
        let lipschitz = claim_constant(self.graph, &pinned, formula, &constants);
        let whole = self.facts.constant(self.graph, node, &domain.at(Box3::ALL), 1).lipschitz;
        if whole <= UNIT.max(lipschitz) {
            return None;
        }
        let made = self.rebuilt(value, &mut |builder, id, args| {
            let bound = match builder.graph.node(id) {
                Node::Call(inner, Function::Field, _) if calls.contains(&id) => Some(*inner),
                _ => None,
            };
            Some(bound.map(|inner| builder.graph.call(inner, Function::Bound, args)))
        })?;
        self.kind = self.kind.max(Kind::Bound);
        let known = Known { lipschitz, proof: Proof::Claimed, search: None };
        Some(if lipschitz <= UNIT { made } else { self.scaled(made, known, node, shape) })
    }
}
