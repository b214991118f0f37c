//! Formulas that are alike but for numbers of which some are not written: `c` is `c + 0` and `1 * c`. One of them is the template, and what a number of it is in another is
//! found by going through both at once.

use crate::graph::kernel::Op;
use crate::graph::{Graph, Node, NodeId};
use rustc_hash::FxHashMap;

/// No template has more numbers that differ: each is one of the row of a table, four of which are read at once.
const MOST_NUMBERS: usize = 16;

/// Where a number stands: in which node, as which argument.
pub(super) type Slot = (NodeId, usize);

/// Formulas as one, of the numbers in which they differ.
pub(super) struct Template {
    /// For each slot whose number is not the same in all formulas: the column of numbers, and whether it is the opposite of what stands there.
    pub slots: FxHashMap<Slot, (usize, bool)>,
    /// The formulas that fit.
    pub parts: Vec<NodeId>,
    /// The numbers in which they differ: in each column one for each of them.
    pub columns: Vec<Vec<f64>>,
}

impl Template {
    /// Of a formula that others are like. `is_whole`: whether a node is not looked into, and has to be the same in all. None where they differ in too many numbers.
    pub fn of(graph: &Graph, formula: NodeId, parts: &[NodeId], is_whole: &dyn Fn(NodeId) -> bool) -> Option<Self> {
        let found: Vec<(NodeId, FxHashMap<Slot, f64>)> = parts.iter().filter_map(|&part| Some((part, Fitting::of(graph, formula, part, is_whole)?))).collect();
        let mut order: Vec<Slot> = found.first()?.1.keys().copied().collect();
        order.sort_unstable();
        let mut columns: Vec<Vec<f64>> = Vec::new();
        let mut slots = FxHashMap::default();
        for slot in order {
            // A slot that one of them lacks is in a part that this one does without.
            let column = found.iter().map(|(_, numbers)| numbers.get(&slot).copied()).collect::<Option<Vec<f64>>>()?;
            if column.iter().all(|number| Some(number) == column.first()) {
                continue;
            }
            let opposite: Vec<f64> = column.iter().map(|number| -number).collect();
            let known = columns.iter().position(|c| *c == column || *c == opposite);
            let turned = known.and_then(|at| columns.get(at)).is_some_and(|c| *c != column);
            let at = known.unwrap_or_else(|| {
                columns.push(column);
                columns.len() - 1
            });
            slots.insert(slot, (at, turned));
        }
        let parts = found.into_iter().map(|(part, _)| part).collect();
        (columns.len() <= MOST_NUMBERS).then_some(Self { slots, parts, columns })
    }
}

/// A formula that is being laid on a template.
struct Fitting<'a> {
    graph: &'a Graph,
    is_whole: &'a dyn Fn(NodeId) -> bool,
    /// What each node of the template is in the formula.
    held: FxHashMap<NodeId, NodeId>,
    numbers: FxHashMap<Slot, f64>,
}

impl<'a> Fitting<'a> {
    /// The numbers of a formula, if it fits.
    fn of(graph: &'a Graph, template: NodeId, formula: NodeId, is_whole: &'a dyn Fn(NodeId) -> bool) -> Option<FxHashMap<Slot, f64>> {
        let mut fitting = Self { graph, is_whole, held: FxHashMap::default(), numbers: FxHashMap::default() };
        let mut open = vec![(template, formula)];
        while let Some((own, other)) = open.pop() {
            match fitting.held.insert(own, other) {
                // A node that is computed once is the same wherever it is asked for.
                Some(known) if known != other => return None,
                Some(_) => continue,
                None => fitting.lay(own, other, &mut open)?,
            }
        }
        Some(fitting.numbers)
    }

    /// Lays a node on one of the template. None where it does not fit.
    fn lay(&mut self, own: NodeId, other: NodeId, open: &mut Vec<(NodeId, NodeId)>) -> Option<()> {
        match ((self.is_whole)(own), (self.is_whole)(other)) {
            (true, _) => return (own == other).then_some(()),
            (false, true) => return self.unwritten(own, other, open),
            (false, false) => {}
        }
        match (self.graph.node(own), self.graph.node(other)) {
            (Node::Op(op, args), Node::Op(same, others)) if op == same && self.fits(args, others) => self.all(own, args, others, open),
            // What is less by a number is more by its opposite.
            (Node::Op(Op::Add, args), Node::Op(Op::Sub, others)) | (Node::Op(Op::Sub, args), Node::Op(Op::Add, others)) => {
                let ([a, b], [x, y]) = (&args[..], &others[..]) else { return None };
                match (self.graph.as_constant(*b), self.graph.as_constant(*y)) {
                    (Some(_), Some(number)) => {
                        self.numbers.insert((own, 1), -number);
                        open.push((*a, *x));
                        Some(())
                    }
                    _ => self.unwritten(own, other, open),
                }
            }
            (Node::Claim(args, claim), Node::Claim(others, same)) if claim == same => self.all(own, args, others, open),
            (Node::Op(..), _) => self.unwritten(own, other, open),
            _ => (own == other).then_some(()),
        }
    }

    /// Whether numbers stand in the same places of both.
    fn fits(&self, args: &[NodeId], others: &[NodeId]) -> bool {
        let is_number = |id: &NodeId| self.graph.as_constant(*id).is_some();
        args.len() == others.len() && args.iter().zip(others).all(|(a, b)| is_number(a) == is_number(b))
    }

    fn all(&mut self, own: NodeId, args: &[NodeId], others: &[NodeId], open: &mut Vec<(NodeId, NodeId)>) -> Option<()> {
        if !self.fits(args, others) {
            return None;
        }
        for (i, (&a, &b)) in args.iter().zip(others).enumerate() {
            match self.graph.as_constant(b) {
                Some(number) => _ = self.numbers.insert((own, i), number),
                None => open.push((a, b)),
            }
        }
        Some(())
    }

    /// Lays what has no number there on what has one: nothing is added to it, it is taken once, or it is the opposite.
    fn unwritten(&mut self, own: NodeId, other: NodeId, open: &mut Vec<(NodeId, NodeId)>) -> Option<()> {
        let Node::Op(op, args) = self.graph.node(own) else { return None };
        let [a, b] = args[..] else { return None };
        let (at, of) = match (self.graph.as_constant(a), self.graph.as_constant(b)) {
            (None, Some(_)) => (1, a),
            (Some(_), None) if *op != Op::Sub => (0, b),
            _ => return None,
        };
        let (number, other) = match (op, self.graph.node(other)) {
            (Op::Mul, Node::Op(Op::Neg, of)) => (-1.0, *of.first()?),
            (Op::Mul, _) => (1.0, other),
            (Op::Add | Op::Sub, _) => (0.0, other),
            _ => return None,
        };
        self.numbers.insert((own, at), number);
        open.push((of, other));
        Some(())
    }
}
