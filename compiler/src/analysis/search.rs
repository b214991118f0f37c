//! Searches for a constant that can be taken up again: with more boxes, or for the values at which the parameters stand.

use super::{Box3, Domain, Facts, Pinned};
use crate::graph::interval::Interval;
use crate::graph::{Graph, NodeId, ParameterComponent};

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

    /// The steepest of so many points of the domain, with values of the parameters from their ranges.
    pub fn sample(&self, graph: &Graph, samples: usize) -> f64 {
        let mut steepest: f64 = 0.0;
        for i in 0..samples {
            let (here, pinned) = spread(graph, &self.domain, &[], i);
            let found = Search { domain: here, ..self.clone() }.run(graph, pinned, 1);
            if found.is_finite() {
                steepest = steepest.max(found);
            }
        }
        steepest
    }
}

/// The `i`-th of points that fill a domain evenly, by an additive recurrence (Roberts 2018), and values of the parameters.
pub fn spread(graph: &Graph, domain: &Domain, pinned: &[f64], i: usize) -> (Domain, Pinned) {
    let part = |k: u32| ((i as f64 + 0.5) * PLASTIC.powi(-(k as i32))).fract();
    let within = |side: Interval, k: u32| {
        Interval::point(if side.is_finite() { side.lo + part(k) * side.width() } else { side.middle() + 20.0 * part(k) - 10.0 })
    };
    let mut here = domain.at(Box3([1, 2, 3].map(|k| within(domain.point.axis(k as usize - 1), k))));
    for (v, range) in &mut here.variables {
        *range = within(*range, 4 + *v % 7);
    }
    let value = |(k, p): (usize, &ParameterComponent)| {
        pinned.get(k).copied().unwrap_or(p.min + part(11 + k as u32 % 7) * (p.max - p.min))
    };
    let values = graph.parameters.iter().enumerate().map(value).collect();
    (here, values)
}

/// The real root of x⁴ = x + 1, whose powers are the steps of the recurrence in three dimensions.
const PLASTIC: f64 = 1.220_744_084_605_759_6;
/// How many steps of a formula a box may cost before it counts as more than one.
const STEPS_A_BOX: usize = 100;
/// What the search itself may be off by.
pub const ROUNDING: f64 = 1e-9;
