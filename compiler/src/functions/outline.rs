//! What stands for a long formula.

use crate::graph::kernel::Op;
use crate::graph::{NodeId, NodeList, ShapeId};
use smallvec::SmallVec;

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
