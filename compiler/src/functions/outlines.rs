//! Outlining: a long formula of one to three numbers, as noise is, or of more of which no more than three move, becomes a function of them. It is written once, however often and at
//! whatever places it is asked for, and its gradient is the chain rule over that function's own. What is known of the formula stays known where it
//! stands: only what is written of it changes.

use crate::functions::builder::Builder;
use crate::functions::outline::{Outline, Outlines, outline_beside};
use crate::graph::{Claim, ClaimGroup, Exactness, Function, Graph, Leaf, Node, NodeId, NodeList, Shape, ShapeId};
use rustc_hash::FxHashSet;
use std::sync::Arc;

/// So many numbers that do not move may a function be given, beside those that do.
pub(super) const MOST_STILL: usize = 6;

/// A formula that may be a function.
struct Candidate {
    formula: NodeId,
    name: Option<Arc<str>>,
    /// The numbers that it is made of.
    of: NodeList,
}

impl Candidate {
    /// Of a node that is claimed to be no steeper than some numbers, or is noted to be the result of a function.
    fn at(graph: &Graph, id: NodeId) -> Option<Self> {
        if let Some(made) = graph.result(id) {
            return Some(Self { formula: id, name: Some(made.by.clone()), of: made.of.clone() });
        }
        let Node::Claim(of, Claim::Lipschitz(_, groups, _)) = graph.node(id) else { return None };
        let (&formula, of) = of.split_first()?;
        let numbers = groups.iter().all(|g| matches!(g, ClaimGroup::Vector(_)));
        numbers.then(|| Self { formula, name: graph.node_name(id).map(Into::into), of: of.into() })
    }
}

impl Builder<'_> {
    /// What stands for a node. None where its formula is short, made of more numbers than a function takes, or reads more than those.
    pub(super) fn outline(&mut self, id: NodeId) -> Option<Outline> {
        let (is_function, is_fold) = (self.is_function(id), self.ends_fold(id));
        if !is_function && !is_fold {
            return None;
        }
        let own = self.gradients.own;
        if let Some(known) = self.folds.outlines.get(&id) {
            return outline_beside(known, own).cloned();
        }
        let function = if is_function { self.find_outline(id) } else { None };
        let fold = if is_fold { self.find_fold(id) } else { None };
        let found: Outlines = function.into_iter().chain(fold).collect();
        let outline = outline_beside(&found, own).cloned();
        self.folds.outlines.insert(id, found);
        outline
    }

    fn is_function(&self, id: NodeId) -> bool {
        matches!(self.graph.node(id), Node::Claim(..)) || self.graph.result(id).is_some()
    }

    /// Whether a shape stands for formulas.
    pub(super) fn is_outlined(&self, shape: ShapeId) -> bool {
        let known = |s: &Shape| self.folds.outlined.get(&(s.value, s.dimensions)) == Some(&shape);
        !self.folds.outlined.is_empty() && self.graph.shape(shape).is_some_and(known)
    }

    fn find_outline(&mut self, id: NodeId) -> Option<Outline> {
        let Candidate { formula, name, of } = Candidate::at(self.graph, id)?;
        let mut numbers: Vec<NodeId> = Vec::with_capacity(3);
        for &number in of.iter() {
            if self.graph.as_constant(number).is_none() && !numbers.contains(&number) {
                numbers.push(number);
            }
        }
        // Three or fewer are the coordinates of a point, whether they move or not.
        let few = numbers.len() <= 3;
        let (mut coordinates, still): (Vec<NodeId>, Vec<NodeId>) = numbers.into_iter().partition(|&number| few || self.moves(number));
        if !(1..=3).contains(&coordinates.len()) || still.len() > MOST_STILL {
            return None;
        }
        let own = self.spare_variables(0, still.len());
        let point = (0..3).map(Leaf::P);
        let variables = own.iter().map(|&v| Leaf::Variable(v));
        let places: Vec<(NodeId, Leaf)> =
            coordinates.iter().copied().zip(point).chain(still.iter().copied().zip(variables)).collect();
        let order = self.graph.within_places(formula, &places).filter(|order| self.graph.is_long(order.iter().copied()))?;
        let value = self.graph.abstracted(formula, &order, &places);
        let read = coordinates.len();
        let dimensions = if read == 3 { 3 } else { 2 };
        coordinates.resize(3, *coordinates.last()?);
        let shape = self.outlined_as(name, value, dimensions, id);
        let variables = self.graph.shape(shape).map(|s| s.variables.clone()).unwrap_or_default();
        let variables = variables.iter().map(|&v| {
            let given = own.iter().position(|&own| own == v).and_then(|i| still.get(i));
            given.copied().unwrap_or_else(|| self.graph.leaf(Leaf::Variable(v)))
        });
        let arguments = coordinates.into_iter().chain(variables).collect();
        Some(Outline::new(shape, arguments, (read, true), None))
    }

    /// Whether a number changes with the point between its jumps.
    pub(super) fn moves(&self, number: NodeId) -> bool {
        let graph = &*self.graph;
        let mut open = vec![number];
        let mut seen = FxHashSet::default();
        while let Some(id) = open.pop() {
            match graph.node(id) {
                Node::Leaf(Leaf::P(_)) => return true,
                Node::Op(op, _) if op.is_flat() => {}
                _ if seen.insert(id) => open.extend(graph.operands(id)),
                _ => {}
            }
        }
        false
    }

    /// The shape of a formula: one, wherever the first node that it stands for is.
    pub(super) fn outlined_as(&mut self, name: Option<Arc<str>>, value: NodeId, dimensions: u8, first: NodeId) -> ShapeId {
        if let Some(&known) = self.folds.outlined.get(&(value, dimensions)) {
            return known;
        }
        let (span, exactness) = (self.place(self.root, first), Exactness::Formula);
        let mut outline = Shape { name, dimensions, value, variables: [].into(), exactness, material: None, paints: [].into(), span };
        let new = self.graph.shapes().len();
        let mut shape = self.graph.add_shape(outline.clone());
        // A shape of the scene may be the same, and can't stand for its own formula.
        while (shape.0 as usize) < new {
            outline.name = Some(format!("{}_formula", outline.name.as_deref().unwrap_or("own")).into());
            shape = self.graph.add_shape(outline.clone());
        }
        // Where it jumps the shapes that ask for it say so.
        self.gradients.walled.insert(shape, false);
        self.built.formulas.insert((shape, Function::Field), value);
        self.folds.outlined.insert((value, dimensions), shape);
        shape
    }

    /// What stands for the nodes of which the functions and the surface are computed. The answer: the shapes that stand for them.
    pub(super) fn outline_all(&mut self) -> FxHashSet<ShapeId> {
        if !(0..self.graph.len() as u32).map(NodeId).any(|id| self.is_function(id) || self.ends_fold(id)) {
            return FxHashSet::default();
        }
        let mut formulas: Vec<(ShapeId, Function)> = self.built.formulas.keys().copied().collect();
        formulas.sort_unstable();
        formulas.retain(|of| !self.is_outlined(of.0));
        let mut open: Vec<(NodeId, Option<ShapeId>)> = self.built.roots().into_iter().map(|id| (id, None)).collect();
        for of in formulas {
            open.extend(self.built.formulas.get(&of).map(|&id| (id, None)));
        }
        let (mut seen, mut shapes) = (FxHashSet::default(), FxHashSet::default());
        while let Some((id, own)) = open.pop() {
            if !seen.insert((id, own)) {
                continue;
            }
            self.gradients.own = own;
            let Some(Outline { shape, operands, .. }) = self.outline(id) else {
                open.extend(self.graph.operands(id).iter().map(|&operand| (operand, own)));
                continue;
            };
            open.extend(operands.iter().map(|&operand| (operand, own)));
            if shapes.insert(shape) {
                for function in [Function::Field, Function::Gradient(0), Function::Gradient(1), Function::Gradient(2)] {
                    open.extend(self.built.formulas.get(&(shape, function)).map(|&formula| (formula, Some(shape))));
                }
            }
        }
        self.gradients.own = None;
        let found = std::mem::take(&mut self.folds.outlines);
        self.built.outlines = found.into_iter().filter(|(_, outlines)| !outlines.is_empty()).collect();
        shapes
    }
}
