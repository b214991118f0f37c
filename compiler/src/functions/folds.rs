//! Folds of many: a sum, a product, the least or the greatest of formulas that are alike but for their numbers, as a loop over a list makes them, becomes a
//! function of its own. What is folded becomes functions too, so that a table of their numbers stands for the text of all of them.

use super::Builder;
use super::outlines::Outline;
use super::unions::{FEWEST_ROWS, LONGEST, MANY, Union};
use crate::analysis::Box3;
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::{Function, Leaf, Node, NodeId, ShapeId};
use rustc_hash::{FxHashMap, FxHashSet, FxHasher};
use std::hash::{Hash, Hasher};

/// A point beside these numbers has so many coordinates.
const COORDINATES: usize = 3;
/// What is made of fewer nodes is as short written out.
const SHORTEST: u32 = 6;
/// What all operands share may be computed by each of them, if it is no more than so many operations.
const FEW: usize = 4;

/// The trees of one operation in a graph.
#[derive(Debug, Default)]
pub(super) struct Folds {
    /// For each node, as far as they were looked at: how many operands has the tree of one operation that ends in it.
    operands: Vec<u32>,
    /// Whether that is a part of a larger tree.
    inner: Vec<bool>,
    /// What the shapes that stand for folds do, and with which others.
    shapes: FxHashMap<ShapeId, Fold>,
}

/// A shape that is one operation over many others, all at its own point.
#[derive(Debug)]
struct Fold {
    /// The operation: one that is the same in any order.
    op: Op,
    /// The others.
    operands: Vec<ShapeId>,
}

/// Whether an operation over many may be a loop.
fn folds(op: Op) -> bool {
    matches!(op, Op::Min | Op::Max | Op::Add | Op::Mul)
}

impl Builder<'_> {
    /// Whether a tree of one operation with many operands ends in a node.
    pub(super) fn ends_fold(&mut self, id: NodeId) -> bool {
        if !matches!(self.graph.node(id), Node::Op(op, _) if folds(*op)) {
            return false;
        }
        let Folds { operands, inner, .. } = &mut self.folds;
        for at in operands.len()..self.graph.len() {
            let mut count = 1;
            if let Node::Op(op, args) = self.graph.node(NodeId(at as u32))
                && folds(*op)
            {
                let same = |a: &NodeId| matches!(self.graph.node(*a), Node::Op(other, _) if other == op);
                let of = |a: &NodeId| if same(a) { operands.get(a.0 as usize).copied().unwrap_or(1) } else { 1 };
                count = args.iter().map(of).fold(0, u32::saturating_add);
                for arg in args.iter().filter(|a| count as usize >= MANY && same(a)) {
                    inner.get_mut(arg.0 as usize).into_iter().for_each(|slot| *slot = true);
                }
            }
            operands.push(count);
            inner.push(false);
        }
        let at = id.0 as usize;
        operands.get(at).is_some_and(|&count| count as usize >= MANY) && inner.get(at) == Some(&false)
    }

    /// What stands for a tree of one operation. None where too few of its operands are alike, or those read more than three numbers that move.
    pub(super) fn find_fold(&mut self, id: NodeId) -> Option<Outline> {
        let Node::Op(op, _) = *self.graph.node(id) else { return None };
        let mut parts = Vec::new();
        let mut open = vec![id];
        let mut seen = FxHashSet::default();
        while let Some(id) = open.pop() {
            match self.graph.node(id) {
                // What is asked for twice is computed once: that is no list.
                Node::Op(other, args) if *other == op && seen.insert(id) => open.extend(args.iter().rev()),
                Node::Op(other, _) if *other == op => return None,
                _ => parts.push(id),
            }
        }
        let (parts, beside) = self.alike(&parts);
        if parts.len() < MANY {
            return None;
        }
        let mut coordinates = self.coordinates(&parts)?;
        let places: Vec<(NodeId, Leaf)> = coordinates.iter().copied().zip((0..).map(Leaf::P)).collect();
        let orders = parts.iter().map(|&part| self.graph.within_places(part, &places)).collect::<Option<Vec<_>>>()?;
        let values: Vec<NodeId> = parts.iter().zip(&orders).map(|(&part, order)| self.graph.abstracted(part, order, &places)).collect();
        if values.iter().any(|&value| self.graph.reads(value).variables != 0) {
            return None;
        }
        let dimensions = if coordinates.len() == COORDINATES { 3 } else { 2 };
        let operands: Vec<ShapeId> = values.iter().map(|&value| self.outlined_as(None, value, dimensions, id)).collect();
        let point = self.graph.point();
        let calls: Vec<NodeId> = operands.iter().map(|&shape| self.graph.field(shape, point)).collect();
        let value = self.graph.balanced(op, &calls, 0.0);
        let name = self.graph.node_name(id).map(Into::into);
        let shape = self.outlined_as(name, value, dimensions, id);
        let read = (coordinates.len(), values.iter().any(|&value| self.moves(value)));
        coordinates.resize(COORDINATES, *coordinates.last()?);
        self.folds.shapes.insert(shape, Fold { op, operands });
        let beside = Some((op, beside)).filter(|(_, beside)| !beside.is_empty());
        Some(Outline::new(shape, coordinates, read, beside))
    }

    /// Makes unions of the shapes that stand for folds: what a table is made from.
    pub(super) fn unite_folds(&mut self) {
        if self.folds.shapes.is_empty() {
            return;
        }
        let mut near = self.where_folds_are();
        let mut shapes: Vec<(&ShapeId, &Fold)> = self.folds.shapes.iter().collect();
        shapes.sort_unstable_by_key(|(shape, _)| **shape);
        for (&shape, Fold { op, operands }) in shapes {
            let near = near.remove(&shape).unwrap_or(Box3::ALL);
            let union = Union::of(self.graph, self.facts, &self.built, operands, *op, &near);
            self.built.unions.insert((shape, Function::Field), union);
        }
    }

    /// Boxes that hold the coordinates at which the shapes that stand for folds are asked for in the solids of other shapes, and near them.
    fn where_folds_are(&mut self) -> FxHashMap<ShapeId, Box3> {
        let mut asking: Vec<ShapeId> = self.built.formulas.keys().filter(|of| of.1 == Function::Field).map(|of| of.0).collect();
        asking.sort_unstable();
        let mut near: FxHashMap<ShapeId, Box3> = FxHashMap::default();
        for shape in asking {
            let Some(value) = self.graph.shape(shape).map(|s| s.value) else { continue };
            let known = |id: &NodeId| self.built.outlines.get(id).filter(|outline| self.folds.shapes.contains_key(&outline.shape));
            let asked: Vec<Outline> = self.graph.reachable(&[value]).iter().filter_map(known).cloned().collect();
            if asked.is_empty() {
                continue;
            }
            let mut domain = self.domain(shape);
            domain.point = domain.point.intersect(&self.facts.solid_region(self.graph, value, &domain));
            for outline in asked {
                let mut place = Box3([Interval::ZERO; 3]);
                for (i, &coordinate) in outline.arguments().iter().take(outline.read).enumerate() {
                    place = place.with_axis(i, self.facts.range(self.graph, coordinate, &domain));
                }
                let hull = near.get(&outline.shape).map_or(place, |known| known.hull(&place));
                near.insert(outline.shape, hull);
            }
        }
        near
    }

    /// Of the operands of a fold those that a table is worth it for: each is there once, has a few that are alike but for their numbers, is neither short nor long, and calls
    /// nothing. Then the others.
    fn alike(&self, parts: &[NodeId]) -> (Vec<NodeId>, Vec<NodeId>) {
        let mut known: FxHashMap<NodeId, (u64, u32)> = FxHashMap::default();
        for id in self.graph.reachable(parts) {
            let mut hasher = FxHasher::default();
            let node = self.graph.node(id);
            std::mem::discriminant(node).hash(&mut hasher);
            match node {
                // What a frame computes once is no number of a table.
                Node::Op(..) if self.is_uniform(id) => id.hash(&mut hasher),
                Node::Op(op, _) => op.hash(&mut hasher),
                Node::Leaf(leaf) => leaf.hash(&mut hasher),
                Node::Constant(_) | Node::Factor(_) | Node::Claim(..) | Node::Call(..) => {}
            }
            let mut length: u32 = 1;
            for argument in self.graph.operands(id) {
                let (form, inside) = known.get(argument).copied().unwrap_or_default();
                form.hash(&mut hasher);
                length = length.saturating_add(inside);
            }
            known.insert(id, (hasher.finish(), length));
        }
        let form = |part: &NodeId| known.get(part).map_or(0, |form| form.0);
        let (mut counts, mut times): (FxHashMap<u64, usize>, FxHashMap<NodeId, usize>) = Default::default();
        for &part in parts {
            *counts.entry(form(&part)).or_default() += 1;
            *times.entry(part).or_default() += 1;
        }
        let fits = |part: &NodeId| {
            let many = counts.get(&form(part)).is_some_and(|&count| count >= FEWEST_ROWS);
            let length = known.get(part).map_or(0, |form| form.1);
            many && times.get(part) == Some(&1) && (SHORTEST..=LONGEST).contains(&length) && !self.graph.reads(*part).shapes
        };
        parts.iter().partition(|part| fits(part))
    }

    /// One to three numbers of which all of the formulas are made: what they share and what moves.
    fn coordinates(&self, parts: &[NodeId]) -> Option<Vec<NodeId>> {
        let graph = &*self.graph;
        let moves = |id: NodeId| graph.reads_point(id) || graph.reads(id).variables != 0;
        let mut counts: FxHashMap<NodeId, usize> = FxHashMap::default();
        for &part in parts {
            for id in graph.reachable(&[part]) {
                *counts.entry(id).or_default() += 1;
            }
        }
        let shared = |id: &NodeId| counts.get(id) == Some(&parts.len()) && moves(*id);
        let own = counts.keys().filter(|id| !shared(id));
        let mut numbers: Vec<NodeId> = own.flat_map(|&id| graph.operands(id)).copied().filter(shared).collect();
        numbers.sort_unstable();
        numbers.dedup();
        if numbers.len() > COORDINATES {
            let is_work = |id: &NodeId| shared(id) && matches!(graph.node(*id), Node::Op(..));
            if counts.keys().filter(|id| is_work(id)).count() > FEW {
                return None;
            }
            numbers = counts.keys().copied().filter(|&id| moves(id) && matches!(graph.node(id), Node::Leaf(_))).collect();
            numbers.sort_unstable();
        }
        (1..=COORDINATES).contains(&numbers.len()).then_some(numbers)
    }
}
