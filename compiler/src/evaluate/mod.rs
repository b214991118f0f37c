//! Formulas as a straight line of instructions, computed in 64 bits for [`LANES`] points at once.
//!
//! A [`Tape`] holds some formulas of a graph with every call replaced by the formula that it stands for, everything that does not
//! depend on the point computed beforehand, and what is equal computed once. One instruction serves all lanes, so that choosing the
//! operation costs a sixteenth and the compiler of this compiler makes vector code of the arithmetic.
//!
//! Constants, live values and factors are rounded to 32 bits first: the tape and a GPU compute the same function, each in its own
//! precision.

mod build;
mod conforming;
mod narrow;
mod run;

use crate::live::Live;
use crate::graph::kernel::Op;
use crate::graph::{Graph, NodeId, Opened};
use rustc_hash::FxHashMap;

/// How many points are computed at once.
pub const LANES: usize = 16;

/// A number at each of the points.
pub type Lanes = [f64; LANES];

/// Registers 0, 1, 2 hold the point, 3, 4, 5 the normal; constants follow, then what is computed.
const INPUTS: usize = 6;

/// Formulas, ready to be computed at points of the scene.
#[derive(Clone, Debug, Default)]
pub struct Tape {
    code: Vec<Instruction>,
    constants: Vec<f64>,
    registers: u32,
    outputs: Vec<u32>,
}

/// `to = op(from)`; indices of registers.
#[derive(Clone, Copy, Debug)]
struct Instruction {
    op: Op,
    to: u32,
    from: [u32; 4],
}

/// The formulas take more operations than allowed once every call is replaced by its formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooLarge {
    /// The number of operations allowed.
    pub limit: usize,
}

impl std::fmt::Display for TooLarge {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "the scene takes more than {} operations", self.limit)
    }
}

impl std::error::Error for TooLarge {}

/// A tape with the registers in which it computes. One for each thread.
#[derive(Clone, Debug)]
pub struct Evaluator<'t> {
    tape: &'t Tape,
    registers: Vec<Lanes>,
}

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

/// Up to [`LANES`] points as lanes; the last one fills up.
pub fn lanes(points: &[[f64; 3]]) -> [Lanes; 3] {
    let mut lanes = [[0.0; LANES]; 3];
    let Some(&last) = points.last() else { return lanes };
    for (axis, lane) in lanes.iter_mut().enumerate() {
        let component = |p: &[f64; 3]| p.get(axis).copied().unwrap_or(0.0);
        *lane = std::array::from_fn(|i| component(points.get(i).unwrap_or(&last)));
    }
    lanes
}

#[cfg(test)]
mod tests;
