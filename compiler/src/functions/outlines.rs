//! Outlining: a long formula of one to three numbers, as noise is, or of more of which no more than three move, becomes a function of them. It is written once, however often and at
//! whatever places it is asked for, and its gradient is the chain rule over that function's own. What is known of the formula stays known where it
//! stands: only what is written of it changes.

use super::{Builder, Carry, Functions};
use crate::graph::kernel::Op;
use crate::graph::{Claim, ClaimGroup, Exactness, Function, Graph, Leaf, Node, NodeId, NodeList, Shape, ShapeId};
use rustc_hash::FxHashSet;
use smallvec::SmallVec;
use std::sync::Arc;

/// So many numbers that do not move may a function be given, beside those that do.
pub(super) const MOST_STILL: usize = 6;

/// What stands for a formula: a function of its numbers, and of a fold of many what stands beside those that are alike.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// A shape of no space but that of the formula's numbers: its field is the formula, its point the numbers.
    pub shape: ShapeId,
    /// What the formula is made of: the numbers, as a call of the shape takes them, then what the call's value is folded with. All are older than what the outline stands for.
    pub operands: NodeList,
    /// How many of them the call takes: three coordinates, of which the last stands for those that nobody reads, then numbers that between jumps do not move.
    arguments: usize,
    /// How many of the coordinates are read.
    pub read: usize,
    /// Whether the value changes with them between its jumps.
    pub moves: bool,
    /// The operation by which the call's value is folded with the rest.
    pub by: Option<Op>,
}

impl Outline {
    /// A call, and what its value is folded with.
    pub(super) fn new(shape: ShapeId, arguments: Vec<NodeId>, (read, moves): (usize, bool), beside: Option<(Op, Vec<NodeId>)>) -> Self {
        let (by, beside) = beside.unzip();
        let count = arguments.len();
        let operands = arguments.into_iter().chain(beside.into_iter().flatten()).collect();
        Self { shape, operands, arguments: count, read, moves, by }
    }

    /// What the shape's function takes.
    pub fn arguments(&self) -> &[NodeId] {
        self.operands.get(..self.arguments).unwrap_or(&[])
    }

    /// What its value is folded with.
    pub fn beside(&self) -> &[NodeId] {
        self.operands.get(self.arguments..).unwrap_or(&[])
    }
}

/// What may stand for a node: the function that it is the result of, then the fold that ends in it.
pub type Outlines = SmallVec<[Outline; 1]>;

/// The one that stands for a node in the formula of a shape, which is not the shape itself.
pub fn outline_beside(outlines: &[Outline], own: Option<ShapeId>) -> Option<&Outline> {
    outlines.iter().find(|outline| Some(outline.shape) != own)
}

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
        let own = self.own;
        if let Some(known) = self.outlines.get(&id) {
            return outline_beside(known, own).cloned();
        }
        let function = if is_function { self.find_outline(id) } else { None };
        let fold = if is_fold { self.find_fold(id) } else { None };
        let found: Outlines = function.into_iter().chain(fold).collect();
        let outline = outline_beside(&found, own).cloned();
        self.outlines.insert(id, found);
        outline
    }

    fn is_function(&self, id: NodeId) -> bool {
        matches!(self.graph.node(id), Node::Claim(..)) || self.graph.result(id).is_some()
    }

    /// Whether a shape stands for formulas.
    pub(super) fn is_outlined(&self, shape: ShapeId) -> bool {
        let known = |s: &Shape| self.outlined.get(&(s.value, s.dimensions)) == Some(&shape);
        !self.outlined.is_empty() && self.graph.shape(shape).is_some_and(known)
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
        if let Some(&known) = self.outlined.get(&(value, dimensions)) {
            return known;
        }
        let (span, exactness) = (self.place(self.root, first), Exactness::Formula);
        let shape = Shape { name, dimensions, value, variables: [].into(), exactness, material: None, paints: [].into(), span };
        let shape = self.graph.add_shape(shape);
        // Where it jumps the shapes that ask for it say so.
        self.walled.insert(shape, false);
        self.built.formulas.insert((shape, Function::Field), value);
        self.outlined.insert((value, dimensions), shape);
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
            self.own = own;
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
        self.own = None;
        let found = std::mem::take(&mut self.outlines);
        self.built.outlines = found.into_iter().filter(|(_, outlines)| !outlines.is_empty()).collect();
        shapes
    }
}

impl Functions {
    /// What is computed beside the formulas of shapes: surfaces, how what is solid moves, and what is ahead of rays.
    fn roots(&self) -> Vec<NodeId> {
        let surfaces = self.meshes.iter().chain([&self.surface]);
        let mut roots: Vec<NodeId> = surfaces.flat_map(super::Surface::nodes).collect();
        roots.extend(self.carry.iter().flat_map(Carry::nodes));
        roots.extend(self.ahead.planes.iter().flat_map(|planes| [planes.distance, planes.way, planes.rest_bound, planes.rest_distance]));
        roots
    }
}
