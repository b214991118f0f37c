//! Formulas of an angle about an axis and the distance from it, looked at in those two coordinates.
//!
//! In a box of x and y the gradient of the angle has two components that both vary; along the circle and across it, it is 1/r and 0 everywhere.
//! So boxes of distance and angle say far more of such a formula than boxes of x and y, and the cut of the angle is nothing but an end.
//!
//! Of what is the same all around the axis the distance is all there is: a formula in a plane through the axis, where its gradient is as long.

use crate::analysis::dual::{Dual, JUMPS_HERE};
use crate::analysis::formula::Formula;
use crate::analysis::tape::{Step, Tape};
use crate::analysis::{Box3, Domain, Pinned, leaf_dual};
use crate::graph::interval::Interval;
use crate::graph::kernel::{self, Op};
use crate::graph::{Graph, Leaf};
use std::f64::consts::PI;

/// A tape that reads two coordinates only through their length and their angle.
pub struct Polar {
    /// The same tape with the distance from the axis in the place of the first coordinate, the angle in that of the second.
    pub tape: Formula,
    x: u8,
    y: u8,
    turns: bool,
    /// The points of interest, in x and y.
    points: Box3,
}

impl Polar {
    /// The tape in polar coordinates. None where it reads the coordinates in another way, or an angle over a box that is not finite.
    pub fn of(tape: &Tape, points: Box3) -> Option<Self> {
        let coordinate = |step: usize| match tape.steps.get(step) {
            Some(Step::Leaf(Leaf::P(i))) => Some(*i),
            _ => None,
        };
        let pair = |args: &[usize]| Some((coordinate(*args.first()?)?, coordinate(*args.get(1)?)?));
        let of = |op: Op| {
            tape.steps.iter().find_map(|step| match step {
                Step::Op(found, args) if *found == op => pair(args).filter(|(y, x)| y != x),
                _ => None,
            })
        };
        let angle = of(Op::Atan2);
        let (turns, (y, x)) = (angle.is_some(), angle.or_else(|| of(Op::Length2))?);
        let finite = !turns || [x, y].iter().all(|&i| points.axis(usize::from(i)).is_finite());
        let mut polar = Tape::clone(tape);
        for (step, slot) in tape.steps.iter().zip(&mut polar.steps) {
            let args: &[usize] = match step {
                Step::Constant(_) | Step::Leaf(_) => continue,
                Step::Op(_, args) | Step::Call(_, args) | Step::Claim(_, args) => args,
            };
            match step {
                Step::Op(Op::Atan2, args) if pair(args) == Some((y, x)) => *slot = Step::Leaf(Leaf::P(y)),
                Step::Op(Op::Length2, args) if pair(args).is_some_and(|of| of == (x, y) || of == (y, x)) => *slot = Step::Leaf(Leaf::P(x)),
                _ if args.iter().any(|&a| coordinate(a).is_some_and(|i| i == x || i == y)) => return None,
                _ => {}
            }
        }
        let root = tape.roots().any(|r| coordinate(r).is_some());
        (finite && !root).then(|| Self { tape: Formula::of(polar).unmirrored(), x, y, turns, points })
    }

    /// Whether it reads the angle.
    pub fn turns(&self) -> bool {
        self.turns
    }

    /// The domain in distance and angle: at least the points of interest.
    pub fn domain(&self, domain: &Domain) -> Domain {
        let (x, y) = (self.points.axis(self.x.into()), self.points.axis(self.y.into()));
        let radius = x.square().add(y.square()).sqrt();
        let angle = match x.lo <= 0.0 && y.contains(0.0) {
            _ if !self.turns => Interval::ZERO,
            true => Interval::new(-PI, PI),
            false => kernel::interval(Op::Atan2, &[y, x]),
        };
        let radius = Interval::new(radius.lo.max(0.0), radius.hi);
        domain.at(self.points.with_axis(self.x.into(), radius).with_axis(self.y.into(), angle))
    }

    /// A box of the plain coordinates that holds all points of a part; none where that holds no point of interest.
    pub fn place(&self, part: &Box3) -> Option<Box3> {
        let (radius, angle) = (part.axis(self.x.into()), part.axis(self.y.into()));
        let all_around = Interval::new(-radius.hi, radius.hi);
        let along = |op| if self.turns { radius.mul(kernel::interval(op, &[angle])) } else { all_around };
        let around = part.with_axis(self.x.into(), along(Op::Cos)).with_axis(self.y.into(), along(Op::Sin));
        let place = around.intersect(&self.points);
        (!place.is_empty()).then_some(place)
    }

    /// How much a side of a part counts against the others: an angle as far as it leads, and a part that reaches the axis, where the angle
    /// turns infinitely fast, is cut between what is near the axis and what is not.
    pub fn weight(&self, part: &Box3, axis: usize) -> f64 {
        let radius = part.axis(self.x.into());
        match axis {
            _ if axis == usize::from(self.y) => radius.hi,
            _ if axis == usize::from(self.x) && radius.lo <= 0.0 && self.turns => 1e6,
            _ => 1.0,
        }
    }

    /// A leaf of the tape, differentiated along the radius, along the circle and along the axis.
    pub fn leaf(&self, graph: &Graph, pinned: &Pinned, leaf: Leaf, domain: &Domain) -> Dual {
        if leaf != Leaf::P(self.y) {
            return leaf_dual(graph, pinned, leaf, domain);
        }
        let (radius, angle) = (domain.point.axis(self.x.into()), domain.point.axis(self.y.into()));
        let turned = Interval::ONE.div(radius);
        let mut dual = Dual::coordinate(self.y.into(), angle);
        if let Some(slot) = dual.gradient.get_mut(usize::from(self.y)) {
            *slot = turned;
        }
        let cut = radius.lo <= 0.0 || angle.lo <= -PI || angle.hi >= PI;
        Dual { norm: turned.magnitude(), jumps: if cut { JUMPS_HERE } else { 0 }, ..dual }
    }
}

#[cfg(test)]
mod tests {
    use crate::analysis::rules::tried::factors;
    use crate::rules::Rule;

    #[test]
    fn an_angle_and_its_distance_are_two_coordinates_where_nothing_else_is_read() {
        let gear = |tooth: &str| format!("field gear = max(length(p.xz) - 1 - 0.06 * {tooth}, abs(p.y) - 0.2)\nscene = gear.within(box(2.5, 0.5, 2.5) - cylinder(0.5, 1))");
        let [with, without] = factors(Rule::Polar, &gear("cos(12 * atan(p.z, p.x))"));
        assert!(with < without, "{with} {without}");
        let [with, without] = factors(Rule::Polar, &gear("p.x * cos(12 * atan(p.z, p.x))"));
        assert_eq!(with, without, "a coordinate is read beside its angle");
        // The angle of two other coordinates than those of the distance.
        let [with, without] = factors(Rule::Polar, &gear("cos(12 * atan(p.y + 2, p.x))"));
        assert_eq!(with, without);
    }
}
