//! A distance at a point that is turned by an angle which itself varies: it is no steeper far away than near the solid.
//!
//! The nearest point c of a solid is no farther from the axis than the solid reaches, R. Turning the point by dt changes the distance as
//! turning c back does: by n·(axis × c) dt with n the unit gradient, at most R |n| dt wherever the point is. So the gradient is that
//! of the unturned map with a slip of R ∇t, and not of |p| ∇t.

use crate::analysis::dual::Dual;
use super::isometry::PlaneTurn;
use super::jacobian_norm::map_norm;
use crate::analysis::formula::Formula;
use crate::analysis::tape::Step;
use crate::analysis::{Box3, Domain, Facts};
use crate::graph::kernel::Op;
use crate::graph::{Exactness, Function, Graph, Leaf, Node, NodeId, ShapeId};

/// A bound of the gradient's norm of a call of a shape, where that is a distance, less or more a number, at a turned point. None where it
/// is anything else, or its solid reaches without end from the axis.
pub fn turned_norm(facts: &mut Facts, graph: &Graph, tape: &Formula, shape: ShapeId, args: &[usize], values: &[Dual]) -> Option<f64> {
    let point = args.get(..3)?;
    let PlaneTurn { coordinates: [i, j], of: [u, v, t] } = PlaneTurn::of(tape, point)?;
    if args.len() > 3 {
        return None;
    }
    let along = *point.get(3 - i - j)?;
    let angle = values.get(t)?;
    if angle.norm == 0.0 || !angle.norm.is_finite() {
        return None;
    }
    let s = graph.shape(shape)?;
    if s.dimensions != 3 {
        return None;
    }
    let level = if s.exactness == Exactness::Exact { 0.0 } else { distance_level(graph, s.value, 8)? };
    let solid = facts.region(graph, s.value, &Domain::of(Box3::ALL), level);
    let reach = if solid.is_empty() { 0.0 } else { solid.axis(i).magnitude().hypot(solid.axis(j).magnitude()) };
    if !reach.is_finite() {
        return None;
    }
    let slip = reach * angle.norm * (1.0 + 1e-12);
    let is = |step: usize| match tape.steps.get(step) {
        Some(Step::Leaf(Leaf::P(k))) => Some(usize::from(*k)),
        _ => None,
    };
    // A turn by an angle that goes along with the axis alone is a shear, of which the largest singular value is known.
    if let (Some(a), Some(b), Some(_)) = (is(u), is(v), is(along))
        && a != b
        && is(along) == Some(3 - a - b)
        && [a, b].iter().all(|&k| angle.gradient.get(k).is_some_and(|g| g.magnitude() == 0.0))
    {
        return Some(slip / 2.0 + (1.0 + slip * slip / 4.0).sqrt().next_up());
    }
    Some(map_norm(tape, values, &[u, v, along]) + slip)
}

/// By how much less a formula is than a distance: at or below that level it holds the solid whose distance it is. None where it is no such
/// formula.
fn distance_level(graph: &Graph, node: NodeId, depth: u32) -> Option<f64> {
    match graph.node(node) {
        Node::Op(op @ (Op::Add | Op::Sub), args) if depth > 0 => {
            let by = graph.as_constant(*args.get(1)?)?;
            let level = distance_level(graph, *args.first()?, depth - 1)?;
            Some(if *op == Op::Add { level + by } else { level - by })
        }
        Node::Call(shape, Function::Field, args) if depth > 0 => {
            let s = graph.shape(*shape)?;
            let moved = |(i, &a): (usize, &NodeId)| crate::analysis::region::shift_along(graph, a, i).is_some();
            if args.len() > 3 || s.dimensions != 3 || !args.iter().enumerate().all(moved) {
                return None;
            }
            if s.exactness == Exactness::Exact { Some(0.0) } else { distance_level(graph, s.value, depth - 1) }
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use crate::analysis::rules::tried::factors;
    use crate::rules::Rule;

    #[test]
    fn a_turned_distance_is_no_steeper_far_away_than_its_solid_reaches() {
        let blend = |turned: &str| format!("scene = chamfer_union({turned}, box(1, 2, 0.6).translate(0.7, 0, 0).stretch((1, 0.5, 2)), 0.3)");
        let [with, without] = factors(Rule::RotatedDistance, &blend("sphere(0.8).twist(y, 2)"));
        assert!(with < without, "{with} {without}");
        let [with, without] = factors(Rule::RotatedDistance, &blend("sphere(0.8).rotate(y, 2)"));
        assert_eq!(with, without, "an angle that does not vary costs nothing");
        // What is turned is no distance: its nearest point is not known to turn along.
        let [with, without] = factors(Rule::RotatedDistance, &blend("ellipsoid(0.8, 0.4, 0.6).twist(y, 2)"));
        assert!(with <= without);
    }
}
