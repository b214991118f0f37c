//! Searches for a constant that can be taken up again: with more boxes, or for the values at which the parameters stand.

use super::{Domain, Facts, Pinned};
use crate::graph::{Graph, NodeId};

/// Whose constant it is.
#[derive(Clone, Debug, PartialEq)]
pub enum Target {
    /// A value's.
    Value(NodeId),
    /// That of a map of points: three coordinates.
    Map(Vec<NodeId>),
}

/// What a factor's constant was found from.
#[derive(Clone, Debug, PartialEq)]
pub struct Search {
    /// Whose constant it is.
    pub target: Target,
    /// Where it holds.
    pub domain: Domain,
    /// The components of parameters that it depends on.
    pub parameters: Vec<u32>,
}

impl Search {
    /// The constant, looked for with at most `boxes` boxes; for the values of the parameters if there are any, else for their whole ranges.
    pub fn run(&self, graph: &Graph, pinned: Pinned, boxes: usize) -> f64 {
        let mut facts = Facts { pinned, steps: boxes.saturating_mul(STEPS_A_BOX), ..Facts::default() };
        let found = match &self.target {
            Target::Value(node) => facts.constant(graph, *node, &self.domain, boxes),
            Target::Map(point) => facts.map_constant(graph, point, &self.domain, boxes),
        };
        found.lipschitz * (1.0 + ROUNDING)
    }
}

/// How many steps of a formula a box may cost before it counts as more than one.
const STEPS_A_BOX: usize = 100;
/// What the search itself may be off by.
pub const ROUNDING: f64 = 1e-9;
