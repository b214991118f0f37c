//! How steep a value is by what is claimed of it.

use crate::analysis::dual::Dual;
use crate::analysis::matrix::{Rows, matrix_norm};
use crate::analysis::{Box3, Domain, leaf_range};
use crate::graph::algebra::Intervals;
use crate::graph::interval::Interval;
use crate::graph::{Claim, ClaimGroup, Graph, Leaf, NodeId};
use smallvec::SmallVec;
use std::ops::Range;

/// A value that is claimed to be no steeper than a formula of the groups that it is made of. `of_vector` may know a smaller norm of a vector than
/// its rows say; it is told where among the nodes its rows stand.
pub fn claimed(graph: &Graph, pinned: &[f64], (value, claim): (Dual, &Claim), of: &[Dual], of_vector: impl Fn(Range<usize>, f64) -> f64) -> Dual {
    let Claim::Lipschitz(constant, groups, _) = claim else { return value };
    let mut constants: SmallVec<[f64; 4]> = SmallVec::new();
    let mut at = 0;
    for group in groups.iter() {
        let (n, is_vector) = match group {
            ClaimGroup::Vector(n) => (usize::from(*n), true),
            ClaimGroup::Values(n) | ClaimGroup::Bounds(n) => (*n as usize, false),
        };
        let these = of.get(at..at + n).unwrap_or_default();
        constants.push(if is_vector {
            of_vector(at..at + n, matrix_norm(&these.iter().map(|d| (d.gradient, d.norm)).collect::<Rows>()))
        } else {
            these.iter().map(|d| d.norm).fold(0.0, f64::max)
        });
        at += n;
    }
    let limit = claim_constant(graph, pinned, *constant, &constants);
    let jumps = of.iter().fold(0, |j, d| j | d.jumps);
    let mut dual = value.limited(limit);
    dual.value = claim.within(dual.value);
    dual.jumps = jumps;
    dual
}

/// The value of a claim's formula for the constants of its arguments.
pub fn claim_constant(graph: &Graph, pinned: &[f64], formula: NodeId, constants: &[f64]) -> f64 {
    let domain = Domain::of(Box3::ALL);
    let range = graph.evaluate(
        &mut Intervals,
        &[formula],
        |_, leaf| match leaf {
            Leaf::Variable(i) => {
                Interval::new(0.0, constants.get(i as usize).copied().unwrap_or(0.0))
            }
            other => leaf_range(graph, pinned, other, &domain),
        },
        |_, _, _, _| Interval::ALL,
    );
    range.first().map_or(f64::INFINITY, |r| {
        // Rounding outward must not turn a constant of one into a factor.
        let nearest = (r.hi * 1e9).round() / 1e9;
        if (r.hi - nearest).abs() < 1e-12 * nearest.abs() { nearest } else { r.hi }
    })
}

#[cfg(test)]
mod tests {
    use crate::analysis::rules::tried::factors;
    use crate::rules::Rule;

    #[test]
    fn a_claim_counts_where_it_stands_and_not_for_the_same_formula_written_out() {
        let [with, without] = factors(Rule::Claims, "scene = sphere(1).displace(0.1 * fbm(3 * p))");
        assert!(with < 0.7 * without, "{with} {without}");
        let [with, without] = factors(Rule::Claims, "field f = length(p) - 1 + 0.1 * sin(3 * p.x) * sin(3 * p.y)\nscene = f");
        assert_eq!(with, without);
        // A claim in the constants of its operands is as steep as they are.
        let [with, _] = factors(Rule::Claims, "field steep = 2 * p.y\nscene = smooth_union(steep, sphere(1), 0.3)");
        assert!((2.0..2.001).contains(&with), "{with}");
    }
}
