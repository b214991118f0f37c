//! Searches for a constant that can be taken up again: with more boxes, or for the values at which the parameters stand.

use super::account::Account;
use super::{Box3, Domain, Facts, Pinned};
use crate::graph::interval::Interval;
use crate::graph::{Graph, NodeId, ParameterComponent};
use crate::rules::RuleSet;

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
    /// The rules that may be used.
    pub rules: RuleSet,
}

impl Search {
    /// Whether it finds another constant where parameters stand elsewhere.
    pub fn is_live(&self) -> bool {
        !self.parameters.is_empty()
    }

    /// The constant, looked for with at most `boxes` boxes; for the values of the parameters if there are any, else for their whole ranges.
    pub fn run(&self, graph: &Graph, pinned: Pinned, boxes: usize) -> f64 {
        let mut facts = Facts::at(pinned, self.rules);
        facts.account = Account::of_one_search(boxes.saturating_mul(STEPS_A_BOX));
        let nodes = match &self.target {
            Target::Value(node) => std::slice::from_ref(node),
            Target::Map(point) => point.as_slice(),
        };
        let by_boxes = |facts: &mut Facts, boxes| match &self.target {
            Target::Value(node) => facts.constant(graph, *node, &self.domain, boxes),
            Target::Map(point) => facts.map_constant(graph, point, &self.domain, boxes),
        };
        let first = by_boxes(&mut facts, 1);
        let by_cells = match boxes > 1 && !first.jumps {
            true => facts.by_cells(graph, nodes, &self.domain, first.lipschitz, boxes),
            false => None,
        };
        by_cells.unwrap_or_else(|| by_boxes(&mut facts, boxes).lipschitz) * (1.0 + ROUNDING)
    }

    /// How steep it is at the steepest place found: the best of so many points of the domain, with values of the parameters and a time from
    /// their ranges, and from there uphill. No constant is smaller.
    pub fn sample(&self, graph: &Graph, samples: usize) -> f64 {
        let place = |i: usize| self.place(graph, i);
        let mut best: Vec<(f64, Vec<f64>)> = (0..samples).map(|i| (self.at(graph, &place(i)), place(i))).collect();
        best.sort_by(|a, b| b.0.total_cmp(&a.0));
        best.truncate(CLIMBS);
        best.into_iter().map(|(steep, at)| self.climb(graph, steep, at)).fold(0.0, f64::max)
    }

    /// How steep it is at a share of so many points at most (half of them: the median), each at values of the parameters and a time from their
    /// ranges.
    pub fn quantile(&self, graph: &Graph, samples: usize, share: f64) -> f64 {
        let mut slopes: Vec<f64> = (0..samples).map(|i| self.at(graph, &self.place(graph, i))).filter(|s| *s > 0.0).collect();
        slopes.sort_by(f64::total_cmp);
        slopes.get((slopes.len() as f64 * share) as usize).copied().unwrap_or(1.0)
    }

    /// How steep it is at half of the places at most that are nearest to its surface by its value: a quarter of so many points, each at values of
    /// the parameters and a time from their ranges.
    pub fn slope_near_zero(&self, graph: &Graph, samples: usize) -> f64 {
        let places = (0..samples).map(|i| self.place(graph, i));
        let mut found: Vec<(f64, f64)> =
            places.map(|place| (self.size(graph, &place), self.at(graph, &place))).filter(|(_, slope)| *slope > 0.0).collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found.truncate(found.len().div_ceil(4));
        found.sort_by(|a, b| a.1.total_cmp(&b.1));
        found.get(found.len() / 2).map_or(1.0, |(_, slope)| *slope)
    }

    /// The magnitude that a value has at half of so many places at most, of those where it is finite.
    pub fn usual_size(&self, graph: &Graph, samples: usize) -> Option<f64> {
        let mut sizes: Vec<f64> = (0..samples).map(|i| self.size(graph, &self.place(graph, i))).filter(|size| size.is_finite()).collect();
        sizes.sort_by(f64::total_cmp);
        sizes.get(sizes.len() / 2).copied()
    }

    /// The magnitude of a value at one place; without end for a map.
    fn size(&self, graph: &Graph, place: &[f64]) -> f64 {
        let Target::Value(node) = self.target else { return f64::INFINITY };
        let (here, pinned) = self.here(place);
        Facts::at(pinned, RuleSet::default()).range(graph, node, &here).middle().abs()
    }

    /// The `i`-th place that samples look at, as [`Search::at`] takes it.
    fn place(&self, graph: &Graph, i: usize) -> Vec<f64> {
        let (here, pinned) = spread(graph, &self.domain, &[], i);
        let point = here.point.0.iter().chain(here.variables.iter().map(|(_, r)| r)).map(|r| r.middle());
        point.chain(pinned.iter().copied()).chain([0.37 * i as f64 % 20.0]).collect()
    }

    /// How steep it is at one place: the point, the variables, the parameters and the time. Nothing where no finite slope is known.
    fn at(&self, graph: &Graph, place: &[f64]) -> f64 {
        let (here, pinned) = self.here(place);
        let mut facts = Facts::at(pinned.clone(), self.rules);
        let beyond = |(node, level): &(NodeId, f64)| facts.range(graph, *node, &here).lo > *level;
        if self.domain.leaves_out(&here.point) || self.domain.within.iter().any(beyond) {
            return 0.0;
        }
        let search = Search { target: self.target.clone(), domain: here, parameters: Vec::new(), rules: self.rules };
        let found = search.run(graph, pinned, 1);
        if found.is_finite() { found } else { 0.0 }
    }

    /// The numbers of a place: the point and the variables; and the parameters and the time.
    fn here(&self, place: &[f64]) -> (Domain, Pinned) {
        let mut numbers = place.iter().copied();
        let mut next = || Interval::point(numbers.next().unwrap_or(0.0));
        let mut here = self.domain.at(Box3([next(), next(), next()]));
        here.variables.iter_mut().for_each(|(_, range)| *range = next());
        (here, numbers.collect())
    }

    /// From a place uphill, along one coordinate at a time (a compass search: Kolda, Lewis and Torczon 2003).
    fn climb(&self, graph: &Graph, mut steep: f64, mut at: Vec<f64>) -> f64 {
        let sides = self.domain.point.0.iter().chain(self.domain.variables.iter().map(|(_, r)| r)).copied();
        let sides: Vec<Interval> = sides.chain(graph.parameters.iter().map(|p| Interval::new(p.min, p.max))).chain([Interval::ALL]).collect();
        let mut stride = 0.2;
        for round in 0..ROUNDS {
            let before = steep;
            for i in 0..sides.len() + SLANTED {
                // Along an edge of the domain no coordinate alone may lead on.
                let slanted = |k: usize| (2.4 * (round * SLANTED + i) as f64 + 1.7 * k as f64).sin();
                let direction = |k: usize| if i < sides.len() { f64::from(u8::from(i == k)) } else { slanted(k) };
                for sign in [1.0, -1.0] {
                    let moved = |(k, (x, side)): (usize, (&f64, &Interval))| {
                        let width = if side.is_finite() { side.width() } else { 4.0 };
                        (x + sign * stride * width * direction(k)).clamp(side.lo, side.hi)
                    };
                    let next: Vec<f64> = at.iter().zip(&sides).enumerate().map(moved).collect();
                    let found = self.at(graph, &next);
                    if found > steep {
                        (steep, at) = (found, next);
                        break;
                    }
                }
            }
            if steep <= before {
                stride /= 2.0;
            }
        }
        steep
    }
}

/// The `i`-th of points that fill a domain evenly, by an additive recurrence (Roberts 2018), and values of the parameters.
pub fn spread(graph: &Graph, domain: &Domain, pinned: &[f64], i: usize) -> (Domain, Pinned) {
    let part = |k: u32| ((i as f64 + 0.5) * PLASTIC.powi(-(k as i32))).fract();
    let within = |side: Interval, k: u32| {
        // Without end: most of them near the middle.
        let far = |t: f64| 4.0 * t / (1.0 - t * t);
        Interval::point(if side.is_finite() { side.lo + part(k) * side.width() } else { side.middle() + far(2.0 * part(k) - 1.0) })
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
/// From how many samples a climb begins, and how often it tries every direction.
const CLIMBS: usize = 12;
const ROUNDS: usize = 32;
/// How many directions it tries beside the coordinates.
const SLANTED: usize = 6;
/// How many steps of a formula a box may cost before it counts as more than one.
const STEPS_A_BOX: usize = 100;
/// What the search itself may be off by.
pub const ROUNDING: f64 = 1e-9;
