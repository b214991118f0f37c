//! Folds of many: a sum, a product, the least or the greatest of formulas that are alike but for their numbers, as a loop over a list makes them, becomes a
//! function of its own. What is folded becomes functions too, so that a table of their numbers stands for the text of all of them.

use crate::analysis::Box3;
use crate::functions::builder::Builder;
use crate::functions::found::{Fold, Trees};
use crate::functions::loop_counters::Turns;
use crate::functions::outline::Outline;
use crate::functions::outlines::MOST_STILL;
use crate::functions::template::Template;
use crate::functions::unions::{FEWEST_ROWS, LONGEST, MANY, fold_of};
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::{Function, Leaf, Node, NodeId, ShapeId};
use rustc_hash::{FxHashMap, FxHashSet, FxHasher};
use std::hash::{Hash, Hasher};

/// A point beside these numbers has so many coordinates.
const COORDINATES: usize = 3;
/// What is made of fewer nodes is as short written out.
const SHORTEST: u32 = 6;
/// So many operands that are as long as this are many, where loops count what they differ in, as three by three cells: drivers write them out several times. Corners of a cell are fewer, and share more than they differ in.
const SEVERAL: usize = 9;
/// See [`SEVERAL`].
const LONG: u32 = 24;
/// What all operands share may be computed by each of them, if it is no more than so many operations.
const FEW: usize = 4;

/// Operands of a fold that a table stands for.
struct Rows {
    /// Their formulas, of the coordinates as a point.
    values: Vec<NodeId>,
    /// The other operands.
    beside: Vec<NodeId>,
    /// The numbers of which they are made.
    places: Places,
}

/// The numbers of which formulas are made, and what stands for them.
struct Places {
    /// Those that are the coordinates of a point.
    coordinates: Vec<NodeId>,
    /// Those and the ones beside them, which between jumps do not move: each with the leaf that stands for it.
    all: Vec<(NodeId, Leaf)>,
}

impl Places {
    /// Whether there are numbers beside the point.
    fn goes_by_cells(&self) -> bool {
        self.all.len() > self.coordinates.len()
    }

    /// Of how many dimensions the point is.
    fn dimensions(&self) -> u8 {
        if self.coordinates.len() == COORDINATES { 3 } else { 2 }
    }
}

/// What is not among others.
fn without(parts: &[NodeId], others: &[NodeId]) -> Vec<NodeId> {
    let others: FxHashSet<NodeId> = others.iter().copied().collect();
    parts.iter().copied().filter(|part| !others.contains(part)).collect()
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
        let Trees { operands, inner, .. } = &mut self.folds.trees;
        for at in operands.len()..self.graph.len() {
            let mut count = 1;
            if let Node::Op(op, args) = self.graph.node(NodeId(at as u32))
                && folds(*op)
            {
                let same = |a: &NodeId| matches!(self.graph.node(*a), Node::Op(other, _) if other == op);
                let of = |a: &NodeId| if same(a) { operands.get(a.0 as usize).copied().unwrap_or(1) } else { 1 };
                count = args.iter().map(of).fold(0, u32::saturating_add);
                for arg in args.iter().filter(|a| count as usize >= SEVERAL && same(a)) {
                    inner.get_mut(arg.0 as usize).into_iter().for_each(|slot| *slot = true);
                }
            }
            operands.push(count);
            inner.push(false);
        }
        let at = id.0 as usize;
        operands.get(at).is_some_and(|&count| count as usize >= SEVERAL) && inner.get(at) == Some(&false)
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
        let Rows { values, beside, places } = self.rows(&parts, id)?;
        let dimensions = places.dimensions();
        let operands: Vec<ShapeId> = values.iter().map(|&value| self.outlined_as(None, value, dimensions, id)).collect();
        let point = self.graph.point();
        let calls: Vec<NodeId> = operands.iter().map(|&shape| self.graph.field(shape, point)).collect();
        let value = self.graph.balanced(op, &calls, 0.0);
        let name = self.graph.node_name(id).map(Into::into);
        let shape = self.outlined_as(name, value, dimensions, id);
        // What is given beside the point; another variable is none of the formula's numbers.
        let variables = self.graph.shape(shape).map(|s| s.variables.clone()).unwrap_or_default();
        let given = |v: &u32| places.all.iter().find(|(_, leaf)| *leaf == Leaf::Variable(*v)).map(|(number, _)| *number);
        let still = variables.iter().map(given).collect::<Option<Vec<NodeId>>>()?;
        let Places { mut coordinates, .. } = places;
        let read = (coordinates.len(), values.iter().any(|&value| self.moves(value)));
        coordinates.resize(COORDINATES, *coordinates.last()?);
        self.folds.trees.shapes.insert(shape, Fold { op, operands });
        let beside = Some((op, beside)).filter(|(_, beside)| !beside.is_empty());
        Some(Outline::new(shape, coordinates.into_iter().chain(still).collect(), read, beside))
    }

    /// Makes unions of the shapes that stand for folds, as far as they are `asked` for: what a table is made from.
    pub(super) fn unite_folds(&mut self, asked: &FxHashSet<ShapeId>) {
        self.folds.trees.shapes.retain(|shape, _| asked.contains(shape));
        if self.folds.trees.shapes.is_empty() {
            return;
        }
        let mut near = self.where_folds_are();
        let mut shapes: Vec<(&ShapeId, &Fold)> = self.folds.trees.shapes.iter().collect();
        shapes.sort_unstable_by_key(|(shape, _)| **shape);
        for (&shape, Fold { op, operands }) in shapes {
            let near = near.remove(&shape).unwrap_or(Box3::ALL);
            let union = fold_of(self.graph, self.facts, &self.built, operands, *op, &near);
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
            let known = |id: &NodeId| self.built.outlines.get(id)?.iter().find(|outline| self.folds.trees.shapes.contains_key(&outline.shape));
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

    /// What of the operands of a fold is worth a table: each is there once, is neither short nor long, and calls nothing; and they are alike but for their numbers. `fold` is where they
    /// are folded.
    fn rows(&mut self, parts: &[NodeId], fold: NodeId) -> Option<Rows> {
        let forms = self.forms(parts);
        let of = |part: &NodeId| forms.get(part).copied().unwrap_or_default();
        let (mut counts, mut times): (FxHashMap<u64, usize>, FxHashMap<NodeId, usize>) = Default::default();
        for &part in parts {
            *counts.entry(of(&part).0).or_default() += 1;
            *times.entry(part).or_default() += 1;
        }
        let fits = |part: &NodeId| times.get(part) == Some(&1) && (SHORTEST..=LONGEST).contains(&of(part).1) && !self.graph.reads(*part).shapes;
        let fit: Vec<NodeId> = parts.iter().copied().filter(fits).collect();
        // Those of which a few have the very same form are rows as they are.
        let same: Vec<NodeId> = fit.iter().copied().filter(|part| counts.get(&of(part).0).is_some_and(|&count| count >= FEWEST_ROWS)).collect();
        let is_one = same.iter().all(|part| of(part).0 == of(same.first().unwrap_or(part)).0);
        let longest = fit.iter().copied().rev().max_by_key(|part| of(part).1)?;
        let is_long = of(&longest).1 >= LONG;
        let least = if is_one { same.len() + 1 } else { same.len() };
        if let Some(rows) = (fit.len() >= least).then(|| self.by_template(longest, &fit, parts, (least, is_long), fold)).flatten() {
            return Some(rows);
        }
        if same.len() < MANY {
            return None;
        }
        let places = self.coordinates(&same)?;
        let orders = same.iter().map(|&part| self.graph.within_places(part, &places.all)).collect::<Option<Vec<_>>>()?;
        let values = same.iter().zip(&orders).map(|(&part, order)| self.graph.abstracted(part, order, &places.all)).collect();
        Some(Rows { values, beside: without(parts, &same), places })
    }

    /// The rows as calls of one formula of which the numbers are arguments. None where fewer than `least` are like the longest.
    fn by_template(&mut self, longest: NodeId, fit: &[NodeId], parts: &[NodeId], (least, is_long): (usize, bool), fold: NodeId) -> Option<Rows> {
        let places = self.coordinates(fit)?;
        // What a frame computes once is no number of a table.
        let is_place = |id: NodeId| places.all.iter().any(|(place, _)| *place == id);
        let is_whole = |id: NodeId| is_place(id) || matches!(self.graph.node(id), Node::Op(..)) && self.is_uniform(id);
        let Template { slots, parts: rows, columns } = Template::of(self.graph, longest, fit, &is_whole)?;
        // What loops count through is worth one sooner: it needs no table.
        let is_counted = || Turns::of(&columns, rows.len()).is_some();
        let many = if is_long && places.goes_by_cells() && is_counted() { SEVERAL } else { MANY };
        if rows.len() < least.max(many) {
            return None;
        }
        let order = self.graph.within_places(longest, &places.all)?;
        let own = self.spare_variables(MOST_STILL, columns.len());
        let numbers: Vec<NodeId> = own.iter().map(|&v| self.graph.leaf(Leaf::Variable(v))).collect();
        let opposites: Vec<NodeId> = numbers.iter().map(|&number| self.graph.op(Op::Neg, &[number])).collect();
        let given = |id: NodeId, i: usize| {
            let &(column, opposite) = slots.get(&(id, i))?;
            if opposite { &opposites } else { &numbers }.get(column).copied()
        };
        let value = self.graph.abstracted_with(longest, &order, &places.all, given);
        let shape = self.outlined_as(None, value, places.dimensions(), fold);
        let variables = self.graph.shape(shape).map(|s| s.variables.clone())?;
        let point = self.graph.point();
        let mut values = Vec::with_capacity(rows.len());
        for at in 0..rows.len() {
            let numbers = variables.iter().map(|v| match own.iter().position(|own| own == v) {
                Some(column) => columns.get(column)?.get(at).map(|&number| self.graph.constant(number)),
                None => Some(self.graph.leaf(Leaf::Variable(*v))),
            });
            let arguments = point.into_iter().map(Some).chain(numbers).collect::<Option<Vec<NodeId>>>()?;
            values.push(self.graph.call(shape, Function::Field, &arguments));
        }
        Some(Rows { values, beside: without(parts, &rows), places })
    }

    /// In how many of some formulas each node is.
    fn shares(&self, parts: &[NodeId]) -> FxHashMap<NodeId, usize> {
        let mut counts: FxHashMap<NodeId, usize> = FxHashMap::default();
        for &part in parts {
            for id in self.graph.reachable(&[part]) {
                *counts.entry(id).or_default() += 1;
            }
        }
        counts
    }

    /// For each node under some formulas: its form without its numbers, hashed, and how long it is written out. What most of them share is written once, beside them.
    fn forms(&self, parts: &[NodeId]) -> FxHashMap<NodeId, (u64, u32)> {
        let counts = self.shares(parts);
        let is_shared = |id: &NodeId| counts.get(id).is_some_and(|&count| 2 * count > parts.len());
        let mut known: FxHashMap<NodeId, (u64, u32)> = FxHashMap::default();
        for id in self.graph.reachable(parts) {
            let mut hasher = FxHasher::default();
            let node = self.graph.node(id);
            if is_shared(&id) && self.graph.as_constant(id).is_none() {
                id.hash(&mut hasher);
                known.insert(id, (hasher.finish(), 1));
                continue;
            }
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
        known
    }

    /// The numbers of which all of the formulas are made, what they share and what moves: up to three as the coordinates of a point, and numbers beside them that between jumps do not
    /// move, as the cell that the point is in.
    fn coordinates(&mut self, parts: &[NodeId]) -> Option<Places> {
        let numbers = self.numbers(parts)?;
        // Where nothing moves, what jumps is the point.
        let all_still = !numbers.iter().any(|&number| self.moves(number));
        let (coordinates, still): (Vec<NodeId>, Vec<NodeId>) = numbers.into_iter().partition(|&number| all_still || self.moves(number));
        if !(1..=COORDINATES).contains(&coordinates.len()) || still.len() > MOST_STILL {
            return None;
        }
        let variables = self.spare_variables(0, still.len());
        let point = coordinates.iter().copied().zip((0..).map(Leaf::P));
        let all = point.chain(still.iter().copied().zip(variables.iter().map(|&v| Leaf::Variable(v)))).collect();
        Some(Places { coordinates, all })
    }

    /// Variables that stand for numbers which do not move: so many from one of them on.
    pub(super) fn spare_variables(&mut self, first: usize, count: usize) -> Vec<u32> {
        while self.folds.still.len() < first + count {
            self.folds.still.push(self.graph.fresh_variable());
        }
        self.folds.still.get(first..first + count).unwrap_or(&[]).to_vec()
    }

    fn numbers(&self, parts: &[NodeId]) -> Option<Vec<NodeId>> {
        let graph = &*self.graph;
        let moves = |id: NodeId| graph.reads_point(id) || graph.reads(id).variables != 0;
        let counts = self.shares(parts);
        let shared = |id: &NodeId| counts.get(id) == Some(&parts.len()) && moves(*id);
        let own = counts.keys().filter(|id| !shared(id));
        let mut numbers: Vec<NodeId> = own.flat_map(|&id| graph.operands(id)).copied().filter(shared).collect();
        numbers.sort_unstable();
        numbers.dedup();
        let fits = |numbers: &[NodeId]| {
            let moving = numbers.iter().filter(|&&number| self.moves(number)).count();
            moving <= COORDINATES && numbers.len() - moving <= MOST_STILL
        };
        if !fits(&numbers) {
            // What moves and is computed of others among them, as a part of a cell is.
            let among = |id: &NodeId| numbers.contains(id) || !moves(*id);
            let is_made = |id: NodeId| self.moves(id) && matches!(graph.node(id), Node::Op(_, args) if args.iter().all(among));
            let made: Vec<NodeId> = numbers.iter().copied().filter(|&id| is_made(id)).collect();
            if made.len() <= FEW {
                numbers.retain(|id| !made.contains(id));
            }
        }
        if !fits(&numbers) {
            let is_work = |id: &NodeId| shared(id) && matches!(graph.node(*id), Node::Op(..));
            if counts.keys().filter(|id| is_work(id)).count() > FEW {
                return None;
            }
            numbers = counts.keys().copied().filter(|&id| moves(id) && matches!(graph.node(id), Node::Leaf(_))).collect();
            numbers.sort_unstable();
        }
        fits(&numbers).then_some(numbers)
    }
}
