//! Formulas that are gentle at their surface and many times as steep elsewhere in their region, as products of polynomials are: over the constant
//! of all the region a ray would hardly get on. One of two things says more.
//!
//! *Levels.* Who comes to the surface passes all values in between, so that of a way from a value of f = v on only the part counts where f is at
//! most v and not yet below zero: no way is shorter than min(f, v) / L(v), L(v) the steepest place at which f is at most v and no less than some -u. And
//! from within none is shorter than min(-f, u) / L(v).
//!
//! *Curvature.* Where no slope changes faster than a constant M of the second derivatives, a value f of slope g is after a way s still at least
//! |f| - g s - M s²/2 (Taylor's theorem), so a ray may go to where that is zero, 2|f| / (g + √(g² + 2 M |f|)). Near the surface that is f/g, wherever
//! the region is steepest. Kalra and Barr (1989) bound a slope along a ray in the same way.

use crate::analysis::Domain;
use crate::analysis::search::{ROUNDING, Search, Target};
use crate::evaluate::LANES;
use crate::functions::builder::Builder;
use crate::functions::domains::STEEP;
use crate::functions::found::{Levels, Uneven};
use crate::functions::limits::BUDGET;
use crate::functions::measured_fallback::DEAR;
use crate::functions::trial::{number, places, values};
use crate::graph::NodeId;
use crate::graph::kernel::Op;
use crate::random::Random;
use crate::rules::Rule;
use std::rc::Rc;

/// Such a formula is so many times as steep somewhere as it is in most places.
const UNEVEN: f64 = 8.0;
/// A longer formula is not worth a closer look.
const LONGEST: usize = 200;
/// How many places say how steep it is, and which share of them is gentler than most.
const PLACES: usize = 65;
const SHARE: f64 = 0.25;
/// How many levels are tried, and which part of the one before each is.
const LEVELS: usize = 3;
const PART: f64 = 0.0625;
/// How many times as many boxes the constant at a level may cost.
const LONGER: usize = 8;
/// A level is worth its `min` and `max` where it is gentler by so much than what is known without it.
const GENTLER: f64 = 0.5;
/// A slope that changes faster than this says nothing.
const FASTEST: f64 = 1e8;
/// So often places tell in each lane what a way comes to.
const TURNS: usize = 16;
/// No square root is divided by less: of a field of zero the way is zero.
const LEAST: f64 = 1e-12;

impl Builder<'_> {
    /// What is known of a formula that is gentle at its surface and as steep as `constant` somewhere in `domain`. None where it is not.
    pub(super) fn uneven(&mut self, node: NodeId, domain: &Domain, constant: f64) -> Option<Rc<Uneven>> {
        if constant <= STEEP || self.facts.weight(self.graph, node) > LONGEST || self.graph.reads(node).variables != 0 {
            return None;
        }
        let key = (node, domain.key());
        if let Some(known) = self.found.unevens.get(&key) {
            return known.clone();
        }
        let found = self.find_uneven(node, domain, constant).map(Rc::new);
        self.found.unevens.insert(key, found.clone());
        found
    }

    fn find_uneven(&mut self, node: NodeId, domain: &Domain, constant: f64) -> Option<Uneven> {
        let target = Target::Value(node);
        let parameters = self.parameters_of(&target);
        let usual = Search { target, domain: domain.clone(), parameters, rules: self.facts.rules }.quantile(self.graph, PLACES, SHARE);
        if constant < UNEVEN * usual {
            return None;
        }
        // Over a jump neither holds.
        if self.facts.constant(self.graph, node, domain, 1).jumps {
            return Some(Uneven::Levels(Levels::default()));
        }
        let curved = if self.facts.rules.has(Rule::Curvature) { self.curvature(node, domain) } else { None }.map(Uneven::Curvature);
        let by_curvature = curved.as_ref().map_or(f64::INFINITY, |curved| self.usual_divisor(node, domain, constant, curved));
        if curved.is_some() && by_curvature <= DEAR.max(UNEVEN * usual) {
            return curved;
        }
        if !self.facts.rules.has(Rule::Levels) {
            return Some(curved.unwrap_or(Uneven::Levels(Levels::default())));
        }
        let levels = Uneven::Levels(self.aside(|builder| builder.levels(node, domain, constant)));
        // A slope that changes very fast in one place says next to nothing of all others.
        Some(curved.filter(|_| by_curvature <= self.usual_divisor(node, domain, constant, &levels)).unwrap_or(levels))
    }

    /// By what a value is divided, at half of the places outside, for the way that is known: by `constant`, or by less.
    pub(super) fn usual_divisor(&mut self, node: NodeId, domain: &Domain, constant: f64, uneven: &Uneven) -> f64 {
        let share = self.graph.constant(1.0 / constant);
        let way = self.graph.op(Op::Mul, &[node, share]);
        let way = self.gentler_way(node, way, uneven);
        let Some(tape) = self.tape_of(domain, &[node, way], 0) else { return constant };
        let (mut evaluator, mut random) = (tape.evaluator(), Random(0));
        let mut found = Vec::with_capacity(TURNS * LANES);
        for turn in 0..TURNS {
            let [values, ways] = values(&mut evaluator, &places(domain, turn, &mut random));
            let outside = (0..LANES).map(|lane| (number(&values, lane), number(&ways, lane))).filter(|(value, way)| *value > 0.0 && *way > 0.0);
            found.extend(outside.map(|(value, way)| value / way));
        }
        found.sort_by(f64::total_cmp);
        found.get(found.len() / 2).copied().unwrap_or(constant)
    }

    /// How many times as many steps that is at half of the places as if rays knew how steep it is there.
    pub(super) fn steps_over_slope(&mut self, node: NodeId, domain: &Domain, constant: f64, uneven: &Uneven) -> f64 {
        let search = Search { target: Target::Value(node), domain: domain.clone(), parameters: Vec::new(), rules: self.facts.rules };
        self.usual_divisor(node, domain, constant, uneven) / search.quantile(self.graph, PLACES, 0.5)
    }

    fn levels(&mut self, node: NodeId, domain: &Domain, constant: f64) -> Levels {
        let highest = self.facts.range(self.graph, node, domain).hi;
        // It may be that high in a few places alone.
        let usual = Search { target: Target::Value(node), domain: domain.clone(), parameters: Vec::new(), rules: self.facts.rules }.usual_size(self.graph, PLACES);
        let mut level = (PART * highest).min(usual.unwrap_or(highest));
        let down_to = PART * level;
        let below = self.graph.op(Op::Neg, &[node]);
        let (mut least, mut up_to) = (constant, Vec::new());
        for _ in 0..LEVELS {
            if !self.facts.account.has_leisure() {
                break;
            }
            let mut near = domain.clone();
            near.within.extend([(node, level), (below, down_to)]);
            let steep = self.constant_within(node, &near, LONGER).lipschitz * (1.0 + ROUNDING);
            if steep > 0.0 && steep < GENTLER * least {
                least = steep;
                up_to.push((level, steep));
            }
            level *= PART;
        }
        Levels { up_to, down_to }
    }

    fn curvature(&mut self, node: NodeId, domain: &Domain) -> Option<f64> {
        let gradient = self.gradient(node);
        // A call's gradient is a function of the module, not of the graph.
        if gradient.iter().any(|&g| self.graph.reads(g).shapes) {
            return None;
        }
        let found = self.facts.map_constant(self.graph, &gradient, domain, BUDGET);
        let fastest = found.lipschitz * (1.0 + ROUNDING);
        (!found.jumps && fastest <= FASTEST).then_some(fastest)
    }

    /// How far a field may be stepped by: `way`, which its constant says, or what is known beside it, where that is more.
    pub(super) fn gentler_way(&mut self, node: NodeId, way: NodeId, uneven: &Uneven) -> NodeId {
        if uneven.is_unknown() {
            return way;
        }
        let size = self.graph.op(Op::Abs, &[node]);
        let further = match uneven {
            Uneven::Curvature(curvature) => [self.by_curvature(node, size, *curvature); 2],
            Uneven::Levels(Levels { up_to, down_to }) => {
                let mut kept = |level: f64, steep: f64| {
                    let [level, share] = [level, 1.0 / steep].map(|c| self.graph.constant(c));
                    let kept = self.graph.op(Op::Min, &[size, level]);
                    self.graph.op(Op::Mul, &[kept, share])
                };
                let ways: Vec<NodeId> = up_to.iter().map(|&(level, steep)| kept(level, steep)).collect();
                let back = up_to.last().map_or(way, |&(_, steep)| kept(*down_to, steep));
                [ways.into_iter().reduce(|a, b| self.graph.op(Op::Max, &[a, b])).unwrap_or(way), back]
            }
        };
        let [further, back] = further;
        let back = self.graph.op(Op::Neg, &[back]);
        self.further(node, way, [further, back])
    }

    /// Of a way and of others outside and inside of a field's surface the longer one.
    pub(super) fn further(&mut self, node: NodeId, way: NodeId, others: [NodeId; 2]) -> NodeId {
        let zero = self.graph.constant(0.0);
        let [outside, inside] = others;
        let outside = self.graph.op(Op::Max, &[way, outside]);
        let inside = self.graph.op(Op::Min, &[way, inside]);
        let is_outside = self.graph.op(Op::Lt, &[zero, node]);
        self.graph.op(Op::Select, &[is_outside, outside, inside])
    }

    /// The way from a field of this size to where its slope, changing as fast as it can, brings it to zero.
    fn by_curvature(&mut self, node: NodeId, size: NodeId, curvature: f64) -> NodeId {
        let gradient = self.gradient(node);
        let slope = self.graph.op(Op::Length3, &gradient);
        let [two, least, twice] = [2.0, LEAST, 2.0 * curvature].map(|c| self.graph.constant(c));
        let bend = self.graph.op(Op::Mul, &[twice, size]);
        let square = self.graph.op(Op::Square, &[slope]);
        let square = self.graph.op(Op::Add, &[square, bend]);
        let root = self.graph.op(Op::Sqrt, &[square]);
        let sum = self.graph.op(Op::Add, &[slope, root]);
        let sum = self.graph.op(Op::Max, &[sum, least]);
        let double = self.graph.op(Op::Mul, &[two, size]);
        self.graph.op(Op::Div, &[double, sum])
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]
mod tests {
    use crate::evaluate::Tape;
    use crate::graph::Function;
    use crate::{MemoryLoader, Options, compile};

    /// Of a formula of r, the distance from the origin, that is zero on the unit sphere alone: how much of the way to there the bound and the estimate
    /// are, at each of some distances from it; and how steep the formula is at most.
    fn shares(formula: &str, ways: &[f64]) -> (Vec<[f64; 2]>, f64) {
        shares_in(&format!("field f = {formula}\nscene = f.within(box(6))"), ways)
    }

    fn shares_in(text: &str, ways: &[f64]) -> (Vec<[f64; 2]>, f64) {
        let scene = compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default()).compiled.unwrap();
        let roots = [Function::Bound, Function::Distance].map(|f| scene.functions.formulas[&(scene.root, f)]);
        let tape = Tape::new(&scene.graph, &scene.functions.formulas, &roots, &scene.live(), 1_000_000).unwrap();
        let part = |c: f64, way: f64| c * (1.0 + way) / 3f64.sqrt();
        let points: Vec<[f64; 3]> = ways.iter().map(|&way| [part(1.0, way), part(-1.0, way), part(1.0, way)]).collect();
        let mut found = vec![[0.0; 2]; ways.len()];
        tape.evaluator().at(&points, &[], |i, values| found[i] = [values[0] / ways[i], values[1] / ways[i]]);
        (found, scene.summary.factor)
    }

    const WAYS: [f64; 5] = [1e-3, 0.01, 0.1, 0.3, -0.01];

    #[test]
    fn what_is_gentle_at_its_surface_is_near_there() {
        // As steep as 6 at its surface, and 2,000 times as steep at the corner of its region.
        let (found, factor) = shares("{ let q = dot(p, p); (q - 1) * (q * q * q + 2) }", &WAYS);
        assert!(factor > 100.0, "{factor}");
        for ([bound, estimate], [least, near]) in found.iter().zip([[0.8, 0.99], [0.5, 0.95], [0.2, 0.7], [0.15, 0.4], [0.5, 0.95]]) {
            assert!((least..1.0 + 1e-9).contains(bound), "{found:?}");
            assert!((near..1.0 + 1e-9).contains(estimate) && estimate >= bound, "{found:?}");
        }
    }

    #[test]
    fn what_has_an_edge_goes_by_its_levels() {
        // The slope jumps at the middle, and where x is zero.
        let (found, factor) = shares("{ let a = length(p) - 1; a * (1 + a * a * a * a * (20 + abs(p.x))) }", &WAYS);
        assert!(factor > 100.0, "{factor}");
        for [bound, estimate] in found {
            assert!(bound > 3.0 / factor && bound <= 1.0 && estimate <= 1.0 && bound <= estimate + 1e-9, "{bound} {estimate} of {factor}");
        }
    }

    #[test]
    fn what_is_steep_in_one_place_goes_by_its_levels() {
        // As steep as 300 within a thousandth of the middle, which is far from the surface.
        let (found, factor) = shares_in("field f = { let u = p / max(length(p), 0.001); (length(p) - 1) * (1 + 0.3 * u.x * u.z) }\nscene = f", &[0.01, 0.1, 0.3, -0.01]);
        assert!(factor > 100.0, "{factor}");
        for [bound, estimate] in found {
            assert!(bound > 0.1 && bound <= 1.0 && estimate <= 1.0 && bound <= estimate + 1e-9, "{bound} {estimate} of {factor}");
        }
    }

    #[test]
    fn what_jumps_keeps_its_constant() {
        let (found, factor) = shares("{ let q = dot(p, p); (q - 1) * (q * q * q + 2 + fract(p.x)) }", &[0.01]);
        // No steeper than 7 there, so that no more than this is known of the value.
        assert!(factor > 100.0 && found[0][0] * factor < 7.5, "{found:?} {factor}");
    }
}
