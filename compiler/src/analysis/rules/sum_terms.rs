//! Constants of sums, each term known by itself.
//!
//! Over a box that holds a few bumps the steepest place of each is looked for at the value of another: `exp(-d²)` is largest where its slope is zero. A
//! search of one term is short and finds how steep that is anywhere; in a search of the sum no term counts for more, and one that is known to
//! be flat all over a box is not looked at in any part of it.

use crate::analysis::constant::{Norm, Sought, terms};
use crate::analysis::derivative;
use crate::analysis::dual::{self, Dual};
use crate::analysis::formula::Formula;
use crate::analysis::{Constant, Domain, Facts, leaf_dual};
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::{Graph, Node, NodeId};
use std::rc::Rc;

/// Fewer terms are looked at together, and so are more; where a number may be anything in a range two are enough, since no box is ever small.
const FEWEST: usize = 3;
const FEWEST_RANGING: usize = 2;
const MOST: usize = 512;
/// A term is flat where it is this much less steep than the steepest, over the number of terms.
const FLAT: f64 = 1e-3;
/// How many places say how steep a sum is that has no limit.
const SAMPLES: usize = 64;

/// Which terms still matter somewhere in a box, and what all others are there together.
#[derive(Clone)]
struct Active {
    terms: Rc<[usize]>,
    values: Interval,
    steep: f64,
}

/// A sum that may be cut off.
struct Sum {
    /// What it adds and what it takes away (true).
    terms: Vec<(NodeId, bool)>,
    /// Beyond these values it does not change.
    within: Interval,
}

impl Sum {
    fn of(graph: &Graph, node: NodeId) -> Self {
        let (mut node, mut within) = (node, Interval::ALL);
        while let Node::Op(op @ (Op::Min | Op::Max), args) = graph.node(node)
            && let &[a, b] = args.as_ref()
            && let Some((inner, level)) = graph.as_constant(b).map(|level| (a, level)).or(graph.as_constant(a).map(|level| (b, level)))
        {
            let side = if *op == Op::Min { Interval::new(f64::NEG_INFINITY, level) } else { Interval::new(level, f64::INFINITY) };
            within = within.intersect(side);
            node = inner;
        }
        Self { terms: terms(graph, node), within }
    }
}

impl Facts {
    /// The constant of a node that was not found closely as a whole: `whole`, or a smaller one where it is a sum of terms.
    pub(in crate::analysis) fn term_by_term(&mut self, graph: &Graph, node: NodeId, domain: &Domain, budget: usize, whole: Constant) -> Constant {
        let Sum { terms, within } = Sum::of(graph, node);
        let fewest = if self.is_ranging(graph, node, domain) { FEWEST_RANGING } else { FEWEST };
        // Such a look may cost as much as all else, and must not be the reason that the next formula gets no search at all.
        if !(fewest..=MOST).contains(&terms.len()) || within.is_empty() || whole.jumps || !self.account.has_leisure() {
            return whole;
        }
        let limits = self.limits(graph, &terms, within, domain, budget);
        let steepest = limits.iter().copied().fold(0.0, f64::max);
        // Where terms do not cancel, the sum is as steep as the steepest of them.
        let reached = (steepest.is_finite() && within == Interval::ALL).then_some(steepest);
        if !steepest.is_finite() && within == Interval::ALL {
            return whole;
        }
        let usual = if steepest.is_finite() { steepest } else { self.sampled_slope(graph, node, domain, SAMPLES, 0.5) };
        let flat = if usual.is_finite() { FLAT * usual / terms.len() as f64 } else { 0.0 };
        let tapes: Vec<_> = terms.iter().map(|&(term, _)| self.tape(graph, term)).collect();
        let tape = self.tape(graph, node);
        let domain = &self.without_steady(graph, &tapes, within, domain);
        let known = Active { terms: (0..terms.len()).collect(), values: Interval::ZERO, steep: 0.0 };
        let sought = Sought { polar: None, budget: usize::MAX, known, reached };
        let found = self.supremum(graph, &tape, domain, sought, |facts, d, around| {
            let pinned = facts.pinned.clone();
            let leaf = |leaf| leaf_dual(graph, &pinned, leaf, d);
            let Active { mut values, mut steep, .. } = *around;
            let (mut sum, mut value, mut jumps) = (Dual::constant(Interval::ZERO), values, false);
            let mut active = Vec::new();
            for &i in around.terms.iter() {
                let (Some(tape), Some(&limit), Some(&(_, taken))) = (tapes.get(i), limits.get(i), terms.get(i)) else { continue };
                let (term, runs) = derivative::hull_of_pieces(facts, graph, tape, &leaf);
                facts.account.boxes += runs as u64;
                let term = term.limited(limit);
                let here = if taken { term.value.neg() } else { term.value };
                value = value.add(here);
                if term.jumps == 0 && term.norm < flat {
                    steep += term.norm;
                    values = values.add(here);
                    continue;
                }
                jumps |= term.jumps != 0;
                sum.norm += term.norm;
                sum.gradient = dual::add(sum.gradient, if taken { term.gradient.map(Interval::neg) } else { term.gradient });
                active.push(i);
            }
            let norm = Dual::components_norm(&sum.gradient).min(sum.norm) + steep;
            let changes = !value.intersect(within).is_empty();
            let norm = Norm { norm: if changes { norm } else { 0.0 }, jumps: jumps && changes, runs: 1 };
            (norm, Active { terms: active.into(), values, steep })
        });
        Constant { lipschitz: found.constant.lipschitz.min(whole.lipschitz), ..whole }
    }

    /// The domain with a point in place of each side along which all terms are planes: how steep they are is the same all over it.
    fn without_steady(&mut self, graph: &Graph, tapes: &[Rc<Formula>], within: Interval, domain: &Domain) -> Domain {
        let mut left = domain.clone();
        if within != Interval::ALL || !domain.within.is_empty() || domain.tube.is_some() {
            return left;
        }
        let bent: Vec<&Rc<Formula>> = tapes
            .iter()
            .filter(|tape| {
                let (dual, _) = self.dual_of(graph, tape, domain);
                dual.jumps != 0 || dual.gradient.iter().any(|slope| !slope.is_point())
            })
            .collect();
        for i in (0..3).filter(|&i| domain.point.axis(i).is_finite() && !bent.iter().any(|tape| tape.reads(i))) {
            left.point = left.point.with_axis(i, Interval::point(domain.point.axis(i).middle()));
        }
        left
    }

    /// How steep each term of a sum is where the sum is within an interval: there no term can be more than that leaves it beside all others.
    fn limits(&mut self, graph: &Graph, terms: &[(NodeId, bool)], within: Interval, domain: &Domain, budget: usize) -> Vec<f64> {
        let signed = |values: Interval, taken: bool| if taken { values.neg() } else { values };
        let ranges: Vec<Interval> = match within == Interval::ALL {
            true => Vec::new(),
            false => terms.iter().map(|&(term, taken)| signed(self.range(graph, term, domain), taken)).collect(),
        };
        let limit = |facts: &mut Self, i: usize, term: NodeId, taken: bool| {
            if !ranges.is_empty() {
                let others = ranges.iter().enumerate().filter(|(j, _)| *j != i).fold(Interval::ZERO, |sum, (_, range)| sum.add(*range));
                let left = signed(within.sub(others), taken);
                let tape = facts.tape(graph, term);
                if let Some(found) = facts.along_distance(graph, &tape, domain, left, budget) {
                    return found.lipschitz;
                }
            }
            facts.constant(graph, term, domain, budget).lipschitz
        };
        terms.iter().enumerate().map(|(i, &(term, taken))| limit(self, i, term, taken)).collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::analysis::rules::tried::factors;
    use crate::rules::Rule;

    #[test]
    fn a_term_that_is_flat_over_a_box_is_left_out_and_a_single_one_is_not() {
        let [with, without] = factors(Rule::SumTerms, "field f = 0.5 - exp(-dot(p, p)) - exp(-dot(p - 1.2, p - 1.2))\nscene = f.within(box(6))");
        assert!(with < without, "{with} {without}");
        let [with, without] = factors(Rule::SumTerms, "field f = 0.5 - exp(-dot(p, p)) * cos(p.x)\nscene = f.within(box(6))");
        assert_eq!(with, without, "one product is no sum of terms");
        let [with, without] = factors(Rule::SumTerms, "field f = p.x + 0.5 * p.y + 0.25 * p.z\nscene = f.within(box(2))");
        assert_eq!(with, without, "planes are found at once");
    }
}
