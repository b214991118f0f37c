//! A formula as a list of instructions, and the registers in which it computes.

use crate::graph::kernel::Op;

/// How many points are computed at once.
pub const LANES: usize = 16;

/// A number at each of the points.
pub type Lanes = [f64; LANES];

/// Registers 0, 1, 2 hold the point, 3, 4, 5 the normal; constants follow, then what is computed.
pub(super) const INPUTS: usize = 6;

/// Formulas, ready to be computed at points of the scene.
#[derive(Clone, Debug, Default)]
pub struct Tape {
    pub(super) code: Vec<Instruction>,
    pub(super) constants: Vec<f64>,
    pub(super) registers: u32,
    pub(super) outputs: Vec<u32>,
}

/// `to = op(from)`; indices of registers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Instruction {
    pub(super) op: Op,
    pub(super) to: u32,
    pub(super) from: [u32; 4],
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
    pub(super) tape: &'t Tape,
    pub(super) registers: Vec<Lanes>,
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
