//! Formulas as a straight line of instructions, computed in 64 bits for [`LANES`] points at once.
//!
//! A [`Tape`] holds some formulas of a graph with every call replaced by the formula that it stands for, everything that does not
//! depend on the point computed beforehand, and what is equal computed once. One instruction serves all lanes, so that choosing the
//! operation costs a sixteenth and the compiler of this compiler makes vector code of the arithmetic.
//!
//! Constants, live values and factors are rounded to 32 bits first: the tape and a GPU compute the same function, each in its own
//! precision.

mod tape;
mod build;
mod conforming;
mod narrow;
mod run;

use crate::live::Live;
use crate::graph::kernel::Op;
use crate::graph::{Graph, NodeId, Opened};
use rustc_hash::FxHashMap;

impl Tape {
    /// The formulas `roots`, which stand in the scene's space. Functions of shapes that have no formula of their own in `opened` count
    /// as the shape's field. At most `limit` operations.
    pub fn new(
        graph: &Graph,
        opened: &Opened,
        roots: &[NodeId],
        live: &Live,
        limit: usize,
    ) -> Result<Self, TooLarge> {
        build::tape(graph, opened, roots, live, limit, &FxHashMap::default())
    }

    /// The formula `root`, in which each node of `lesser` is the lesser of its first value and of its second or the first component of the
    /// normal, whichever is larger.
    pub(crate) fn raising(
        graph: &Graph,
        root: NodeId,
        live: &Live,
        limit: usize,
        lesser: &FxHashMap<NodeId, [NodeId; 2]>,
    ) -> Result<Self, TooLarge> {
        build::tape(graph, &Opened::default(), &[root], live, limit, lesser)
    }

    /// Number of operations for one point.
    pub fn operations(&self) -> usize {
        self.code.len()
    }

    /// Number of formulas.
    pub fn outputs(&self) -> usize {
        self.outputs.len()
    }

    /// Its numbers, in registers 6 and on; 0 to 5 are the point and the normal.
    pub(crate) fn constants(&self) -> &[f64] {
        &self.constants
    }

    /// Number of its registers.
    pub(crate) fn registers(&self) -> usize {
        self.registers as usize
    }

    /// Each instruction: the operation, the register of its result, those of its arguments.
    pub(crate) fn instructions(&self) -> impl Iterator<Item = (Op, u32, [u32; 4])> {
        self.code.iter().map(|i| (i.op, i.to, i.from))
    }

    /// The register of a formula's value.
    pub(crate) fn output(&self, index: usize) -> Option<u32> {
        self.outputs.get(index).copied()
    }

    /// Registers for this tape.
    pub fn evaluator(&self) -> Evaluator<'_> {
        Evaluator::new(self)
    }
}

#[cfg(test)]
mod tests;

pub use tape::{Evaluator, LANES, Lanes, Tape, TooLarge};
pub use tape::lanes;
use tape::{INPUTS, Instruction};

