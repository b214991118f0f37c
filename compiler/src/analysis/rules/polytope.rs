//! The box of a polytope: of the points at which some linear formulas are all at most a number.
//!
//! Where a direction is a sum of three planes' normals, each so many times and none less than zero times, no point of the polytope is farther along it
//! than the same sum of the planes' distances (weak duality of linear programs; Chvátal 1983, *Linear Programming*). The best of all triples is the
//! polytope's own end, and every other one is a bound too, so that rounding does no harm.

use crate::analysis::Box3;
use crate::analysis::hc4_projections::Walk;
use crate::analysis::tape::{Step, Tape};
use crate::graph::Leaf;
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::vector::{Vec3, cross, dot, length, scale, sub};

/// More planes are not looked at, nor formulas of more operations within each other.
const MOST: usize = 16;
const DEEPEST: u32 = 16;
/// Normals that span less than this part of what they might are no base.
const FLAT: f64 = 1e-9;
/// What rounding may lead beyond, as a part of the region's size.
const ROUNDING: f64 = 1e-12;

/// The points at which a sum of multiples of the coordinates is at most so much.
#[derive(Clone, Copy, Debug)]
struct Plane {
    normal: Vec3,
    most: f64,
}

impl Walk<'_> {
    /// The part of a region in which a maximum is at most a level, as far as the linear formulas in it tell. None where they tell no more than each by
    /// itself.
    pub(in crate::analysis) fn in_polytope(&mut self, maximum: usize, level: f64, region: &Box3) -> Option<Box3> {
        let mut planes = Vec::new();
        gather(self.tape, maximum, level, &mut planes, DEEPEST);
        let slanted = |plane: &&Plane| plane.normal.iter().filter(|c| **c != 0.0).count() > 1;
        if planes.len() > MOST || planes.iter().filter(slanted).count() < 2 || !region.is_finite() {
            return None;
        }
        for (axis, side) in region.0.iter().enumerate() {
            let along = |sign: f64| std::array::from_fn(|i| if i == axis { sign } else { 0.0 });
            planes.extend([Plane { normal: along(1.0), most: side.hi }, Plane { normal: along(-1.0), most: -side.lo }]);
        }
        let far = region.0.iter().map(|side| side.magnitude()).fold(0.0, f64::max);
        self.counted(planes.len().pow(3) / 6);
        let end = |direction: Vec3| farthest(&planes, direction, far) + ROUNDING * far;
        let mut tight = *region;
        for axis in 0..3 {
            let [up, down] = [1.0, -1.0].map(|sign| end(std::array::from_fn(|i| if i == axis { sign } else { 0.0 })));
            if -down > up {
                return Some(Box3::EMPTY);
            }
            tight = tight.with_axis(axis, tight.axis(axis).intersect(Interval::new(-down, up)));
        }
        Some(tight)
    }
}

/// How far along a direction a point of a polytope, no farther than `far` from the middle along each axis, may lie.
fn farthest(planes: &[Plane], direction: Vec3, far: f64) -> f64 {
    let mut least = f64::INFINITY;
    for (i, a) in planes.iter().enumerate() {
        for (j, b) in planes.iter().enumerate().skip(i + 1) {
            let across = cross(a.normal, b.normal);
            for c in planes.iter().skip(j + 1) {
                let volume = dot(across, c.normal);
                if volume.abs() <= FLAT * length(a.normal) * length(b.normal) * length(c.normal) {
                    continue;
                }
                // How often each normal is in the direction (Cramer's rule).
                let times = [
                    dot(direction, cross(b.normal, c.normal)) / volume,
                    dot(direction, cross(c.normal, a.normal)) / volume,
                    dot(direction, across) / volume,
                ];
                if times.iter().any(|t| *t < -FLAT) {
                    continue;
                }
                let times = times.map(|t| t.max(0.0));
                let mut rest = direction;
                let mut end = 0.0;
                for (plane, t) in [a, b, c].into_iter().zip(times) {
                    rest = sub(rest, scale(plane.normal, t));
                    end += t * plane.most;
                }
                // What is left of the direction leads no farther than the region.
                least = f64::min(least, end + rest.iter().map(|r| r.abs()).sum::<f64>() * far);
            }
        }
    }
    least
}

/// The planes of the linear formulas that a maximum is made of.
fn gather(tape: &Tape, step: usize, level: f64, planes: &mut Vec<Plane>, depth: u32) {
    let Some(depth) = depth.checked_sub(1).filter(|_| planes.len() <= MOST) else { return };
    match tape.operation(step) {
        Some((Op::Max, &[a, b])) => [a, b].iter().for_each(|&arg| gather(tape, arg, level, planes, depth)),
        Some((Op::Abs, &[of])) => {
            if let Some((normal, more)) = linear(tape, of, depth) {
                planes.extend([Plane { normal, most: level - more }, Plane { normal: scale(normal, -1.0), most: level + more }]);
            }
        }
        _ => planes.extend(linear(tape, step, depth).map(|(normal, more)| Plane { normal, most: level - more })),
    }
}

/// A step as a sum of multiples of the coordinates and a number.
fn linear(tape: &Tape, step: usize, depth: u32) -> Option<(Vec3, f64)> {
    let depth = depth.checked_sub(1)?;
    let times = |step: usize, by: f64| linear(tape, step, depth).map(|(normal, more)| (scale(normal, by), by * more));
    match tape.steps.get(step)? {
        Step::Constant(c) => Some(([0.0; 3], *c)),
        Step::Leaf(Leaf::P(axis)) => Some((std::array::from_fn(|i| if i == usize::from(*axis) { 1.0 } else { 0.0 }), 0.0)),
        Step::Op(op, args) => match (op, args.as_slice()) {
            (Op::Neg, &[a]) => times(a, -1.0),
            (Op::Add | Op::Sub, &[a, b]) => {
                let (first, second) = (linear(tape, a, depth)?, times(b, if *op == Op::Sub { -1.0 } else { 1.0 })?);
                Some((std::array::from_fn(|i| first.0.get(i).zip(second.0.get(i)).map_or(0.0, |(a, b)| a + b)), first.1 + second.1))
            }
            (Op::Mul, &[a, b]) => tape.constant(a).and_then(|c| times(b, c)).or_else(|| times(a, tape.constant(b)?)),
            (Op::Div, &[a, b]) => times(a, 1.0 / tape.constant(b).filter(|c| *c != 0.0)?),
            _ => None,
        },
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use crate::analysis::rules::tried::sides;
    use crate::rules::Rule;

    #[test]
    fn planes_that_close_a_solid_are_its_box_and_those_that_do_not_are_none() {
        let gem = |last: &str| format!("field f = max(max(p.x + p.y, p.x - p.y), max(max(-p.x + p.z, -p.x - p.z), max(p.y - p.x, {last}))) - 1\nscene = f");
        let [with, without] = sides(Rule::Polytope, &gem("0 - p.x - p.y"));
        assert!(with < without, "{with} {without}");
        let [with, _] = sides(Rule::Polytope, "field f = max(max(p.x + p.y, p.x - p.y), max(p.x + p.z, p.x - p.z)) - 1\nscene = f");
        assert!(with > 1e3, "one side is open: {with}");
        // What bends is no plane.
        let [with, without] = sides(Rule::Polytope, "field f = max(p.x * p.x + p.y - 1, max(p.z * p.z - p.y, p.y * p.y - 3))\nscene = f");
        assert_eq!(with, without);
    }
}
