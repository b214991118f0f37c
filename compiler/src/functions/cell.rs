//! Formulas of cells, seen in one of them. Sums over neighbouring cells and noise of random numbers read the point by its part of a cell, x - ⌊x⌋, and
//! numbers that are the same all over a cell: with a free number in place of each of the latter all cells are one, in which a search finds at once
//! how steep the pieces are; in a box of many cells it would have to come down to each of them.

use crate::analysis::{Constant, Domain};
use crate::functions::builder::Builder;
use crate::functions::domains::{LONGER, STEEP};
use crate::functions::found::OneCell;
use crate::functions::limits::BUDGET;
use crate::functions::one_sided_form::LONGEST;
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::{Leaf, Node, NodeId, WORLD};
use crate::rules::Rule;
use rustc_hash::{FxHashMap, FxHashSet};
use std::rc::Rc;

/// Formulas in which more numbers change from cell to cell are not looked at.
const MOST_FREE: usize = 256;
/// Sums are looked through so deep for a whole part.
const DEEPEST: usize = 4;

/// A fractional part, x - ⌊x⌋ or x - round(x), of a multiple of one coordinate.
struct Part {
    axis: usize,
    /// The multiple.
    times: f64,
    /// The number of which it is the part.
    of: NodeId,
    values: Interval,
}

impl Builder<'_> {
    /// A formula of which the pieces are as steep as this one's, and where it is looked at: one cell of the axes along which it goes by cells. None
    /// where it goes by none.
    pub(super) fn one_cell(&mut self, node: NodeId, domain: &Domain) -> Option<Rc<OneCell>> {
        if !self.facts.rules.has(Rule::OneCell) {
            return None;
        }
        let key = (node, domain.key());
        if let Some(known) = self.found.cells.get(&key) {
            return known.clone();
        }
        let found = self.find_cell(node, domain).map(Rc::new);
        self.found.cells.insert(key, found.clone());
        found
    }

    /// The constant of a formula that jumps, found in one cell of it. None where it goes by none.
    pub(super) fn constant_of_a_cell(&mut self, node: NodeId, near: &Domain) -> Option<Constant> {
        let cell = self.one_cell(node, near)?;
        let found = self.facts.constant(self.graph, cell.0, &cell.1, BUDGET);
        Some(Constant { jumps: true, ..found })
    }

    /// The constant of a formula over a domain, and whether it was found in one cell; the shorter look first.
    pub(super) fn constant_near(&mut self, node: NodeId, near: &Domain, jumps: bool) -> (Constant, bool) {
        let of_a_cell = if jumps { self.constant_of_a_cell(node, near) } else { None };
        if let Some(found) = of_a_cell.filter(|found| found.lipschitz <= STEEP) {
            return (found, true);
        }
        let mut whole = self.facts.constant(self.graph, node, near, BUDGET);
        // With what a condition leaves out, less is found at once than there is; where it is mild already, a search in the background will do.
        if whole.lipschitz > STEEP {
            whole = self.constant_within(node, near, LONGER);
        }
        of_a_cell.filter(|found| found.lipschitz < whole.lipschitz).map_or((whole, false), |found| (found, true))
    }

    fn find_cell(&mut self, node: NodeId, domain: &Domain) -> Option<OneCell> {
        let node = self.parts_first(node)?;
        let order = self.graph.reachable(&[node]);
        let world = |id: &NodeId| matches!(self.graph.node(*id), Node::Leaf(Leaf::Variable(v)) if *v < WORLD + 3);
        if order.len() > LONGEST || order.iter().any(world) {
            return None;
        }
        let still = self.still(&order);
        let parts = self.parts_of_cells(&order);
        if parts.is_empty() {
            return None;
        }
        // What does not change within a cell, as far down as what it is made of is known by itself: two numbers and their difference are two numbers.
        let whole_of = |id: NodeId, arg: NodeId| parts.contains_key(&id) && self.graph.arguments(id).get(1) == Some(&arg);
        let holds = |id: &NodeId| still.contains(id) && self.graph.reads_point(*id);
        let mut open: Vec<NodeId> = order
            .iter()
            .filter(|id| !still.contains(*id))
            .flat_map(|&id| self.graph.arguments(id).iter().copied().filter(move |&arg| !whole_of(id, arg)))
            .filter(holds)
            .collect();
        let (mut changing, mut seen) = (FxHashSet::default(), FxHashSet::default());
        while let Some(id) = open.pop() {
            if !seen.insert(id) {
                continue;
            }
            match self.graph.node(id) {
                Node::Op(op, args) if !(op.is_flat() || *op == Op::Sub && self.is_part(args)) => open.extend(args.iter().copied().filter(holds)),
                _ => {
                    changing.insert(id);
                }
            }
        }
        if changing.len() > MOST_FREE {
            return None;
        }
        let mut cell = Domain { within: Vec::new(), tube: None, ..domain.clone() };
        let mut free = FxHashMap::default();
        for &id in order.iter().filter(|id| changing.contains(id)) {
            let range = self.facts.range(self.graph, id, domain);
            free.insert(id, cell.free_number(self.graph, range));
        }
        // Each part by a coordinate of its own.
        let own = [(); 3].map(|()| cell.free_number(self.graph, Interval::ALL));
        let mut by_axis: [Option<&Part>; 3] = [None; 3];
        let mut axes = vec![0, 1, 2];
        for part in parts.values() {
            let slot = by_axis.get_mut(part.axis)?;
            // Parts of two numbers, or of one by other ways of rounding, don't begin at the same place.
            if slot.is_some_and(|other| other.of != part.of || other.values != part.values) {
                axes.retain(|axis| *axis != part.axis);
            }
            *slot = Some(part);
        }
        axes.retain(|&axis| by_axis.get(axis).is_some_and(Option::is_some));
        loop {
            let made = self.rebuilt(node, &mut |builder, id, _| {
                if let Some(&number) = free.get(&id) {
                    return Some(Some(number));
                }
                let Some(part) = parts.get(&id).filter(|part| axes.contains(&part.axis)) else { return Some(None) };
                let times = builder.graph.constant(part.times);
                Some(Some(builder.graph.op(Op::Mul, &[times, *own.get(part.axis)?])))
            })?;
            // What reads the coordinate in another way too is not the same in all cells.
            let reached = self.graph.reachable(&[made]);
            let reads = |i: usize| reached.iter().any(|&id| *self.graph.node(id) == Node::Leaf(Leaf::P(i as u8)));
            let left: Vec<usize> = axes.iter().copied().filter(|&i| !reads(i)).collect();
            if left.len() < axes.len() {
                axes = left;
                continue;
            }
            let made = self.rebuilt(made, &mut |builder, id, _| {
                let axis = own.iter().position(|&coordinate| coordinate == id);
                Some(axis.map(|i| builder.graph.leaf(Leaf::P(i as u8))))
            })?;
            for part in parts.values().filter(|part| axes.contains(&part.axis)) {
                let side = part.values.mul(Interval::point(1.0 / part.times));
                cell.point = cell.point.with_axis(part.axis, side);
            }
            return Some((made, cell));
        }
    }

    /// A formula in which each difference of a number and a sum that holds the number's whole part begins with the fractional part.
    fn parts_first(&mut self, node: NodeId) -> Option<NodeId> {
        self.rebuilt(node, &mut |builder, id, args| {
            let (Node::Op(Op::Sub, _), &[a, b]) = (builder.graph.node(id), args) else { return Some(None) };
            let (part_of, sum, turned) = match builder.without_whole(a, b, DEEPEST) {
                Some(found) => (a, found, false),
                None => match builder.without_whole(b, a, DEEPEST) {
                    Some(found) => (b, found, true),
                    None => return Some(None),
                },
            };
            let (whole, rest) = sum;
            let part = builder.graph.op(Op::Sub, &[part_of, whole]);
            Some(Some(builder.graph.op(Op::Sub, &if turned { [rest, part] } else { [part, rest] })))
        })
    }

    /// The whole part of `a` in a sum, and what else that is.
    fn without_whole(&mut self, a: NodeId, sum: NodeId, deep: usize) -> Option<(NodeId, NodeId)> {
        let Node::Op(op @ (Op::Add | Op::Sub), args) = self.graph.node(sum) else { return None };
        let (op, &[x, y]) = (*op, args.as_ref()) else { return None };
        let is_whole = |id: NodeId| matches!(self.graph.node(id), Node::Op(op, of) if op.part().is_some() && of.first() == Some(&a));
        if deep == 0 {
            return None;
        }
        if is_whole(x) {
            let rest = if op == Op::Add { y } else { self.graph.op(Op::Neg, &[y]) };
            return Some((x, rest));
        }
        if op == Op::Add && is_whole(y) {
            return Some((y, x));
        }
        if let Some((whole, rest)) = self.without_whole(a, x, deep - 1) {
            return Some((whole, self.graph.op(op, &[rest, y])));
        }
        let (whole, rest) = self.without_whole(a, y, deep - 1).filter(|_| op == Op::Add)?;
        Some((whole, self.graph.op(Op::Add, &[x, rest])))
    }

    /// Fractional parts of multiples of a coordinate.
    fn parts_of_cells(&mut self, order: &[NodeId]) -> FxHashMap<NodeId, Part> {
        let mut parts = FxHashMap::default();
        for &id in order {
            let Node::Op(Op::Sub, args) = self.graph.node(id) else { continue };
            let &[of, whole] = args.as_ref() else { continue };
            let Node::Op(rounds, inside) = self.graph.node(whole) else { continue };
            let Some(values) = rounds.part().filter(|_| inside.first() == Some(&of)) else { continue };
            let slopes = self.gradient(of).map(|slope| self.graph.as_constant(slope));
            let mut along = slopes.iter().enumerate().filter(|(_, slope)| **slope != Some(0.0));
            if let (Some((axis, Some(times))), None) = (along.next(), along.next()) {
                parts.insert(id, Part { axis, times: *times, of, values });
            }
        }
        parts
    }
}
