//! Outlining: a long formula of one to three numbers of which a claim says how steep it is, as noise is, becomes a function of those numbers. It
//! is written once, however often and at whatever places it is asked for, and its gradient is the chain rule over that function's own.

use super::Builder;
use crate::graph::{Claim, ClaimGroup, Exactness, Function, Leaf, Node, NodeId, NodeList, Shape, ShapeId};

/// A shorter formula is as good where it stands.
const LEAST: usize = 40;

/// What stands for a claim: a shape of no space but that of the claim's numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// Its field is the formula, its point the numbers.
    pub shape: ShapeId,
    /// The numbers, as a call takes them.
    pub arguments: NodeList,
}

impl Builder<'_> {
    /// The outline of a claim. None where its formula is short, reads more than the claim's numbers, or it is no such claim.
    pub(super) fn outline(&mut self, claim: NodeId) -> Option<Outline> {
        if let Some(known) = self.outlines.get(&claim) {
            return known.clone();
        }
        let found = self.find_outline(claim);
        self.outlines.insert(claim, found.clone());
        found
    }

    fn find_outline(&mut self, claim: NodeId) -> Option<Outline> {
        let Node::Claim(of, Claim::Lipschitz(_, groups, _)) = self.graph.node(claim) else { return None };
        if groups.is_empty() || groups.iter().any(|g| matches!(g, ClaimGroup::Values(_))) {
            return None;
        }
        let (&formula, numbers) = of.split_first()?;
        let mut coordinates: Vec<NodeId> = Vec::with_capacity(3);
        for &number in numbers {
            if self.graph.as_constant(number).is_none() && !coordinates.contains(&number) {
                coordinates.push(number);
            }
        }
        if !(1..=3).contains(&coordinates.len()) {
            return None;
        }
        let value = self.graph.abstracted(formula, &coordinates, LEAST)?;
        let dimensions = if coordinates.len() == 3 { 3 } else { 2 };
        coordinates.resize(3, self.graph.constant(0.0));
        let shape = self.outlined(value, dimensions, claim);
        let variables = self.graph.shape(shape).map(|s| s.variables.clone()).unwrap_or_default();
        let variables = variables.iter().map(|&v| self.graph.leaf(Leaf::Variable(v)));
        let arguments = coordinates.into_iter().chain(variables).collect();
        Some(Outline { shape, arguments })
    }

    /// The shape of an outlined formula: one, wherever the first of its claims stands.
    fn outlined(&mut self, value: NodeId, dimensions: u8, claim: NodeId) -> ShapeId {
        if let Some(known) = self.outlined.get(&(value, dimensions)) {
            return *known;
        }
        let name = self.graph.node_name(claim).map(Into::into);
        let (span, exactness) = (self.place(self.root, claim), Exactness::Formula);
        let shape = Shape { name, dimensions, value, variables: [].into(), exactness, material: None, paints: [].into(), span };
        let shape = self.graph.add_shape(shape);
        // What a claim speaks of is continuous.
        self.walled.insert(shape, false);
        self.built.formulas.insert((shape, Function::Field), value);
        self.outlined.insert((value, dimensions), shape);
        shape
    }

    /// The outlines of all claims of the graph, whose formulas no other function need hold.
    pub(super) fn outline_all(&mut self) {
        let mut at = 0;
        // An outline may hold claims of its own.
        while at < self.graph.len() {
            let id = NodeId(at as u32);
            if matches!(self.graph.node(id), Node::Claim(..)) {
                self.outline(id);
            }
            at += 1;
        }
        let found = std::mem::take(&mut self.outlines);
        self.built.outlines = found.into_iter().filter_map(|(claim, outline)| Some((claim, outline?))).collect();
    }
}
