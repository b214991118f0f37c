//! What a ball meets: the field's surface, as one nearest point.

use super::NEAR;
use crate::compiled::Compiled;
use crate::live::Live;
use crate::evaluate::{Tape, TooLarge, lanes};
use crate::functions::Functions;
use crate::graph::{Function, NodeId};
use crate::vector::{Vec3, along, cross, dot, length, scale, sub};

/// The surface as balls meet it.
pub trait Ground {
    /// How far a centre may go from a point without passing the surface.
    fn free(&self, p: Vec3) -> f64;
    /// The nearest point of the surface, for a ball.
    fn touch(&self, center: Vec3, radius: f64) -> Touch;
    /// The distance of a point, as an estimate.
    fn distance(&self, p: Vec3) -> f64;
    /// The distance of a point before the newest part of a step, where the surface moves.
    fn before(&self, p: Vec3) -> Option<f64>;
    /// Whether it moves by nothing but time.
    fn is_moved_by_time(&self) -> bool {
        false
    }
    /// How far what is solid at a point went in the newest part of a step, where it moves as a whole. Along the surface only: how the
    /// surface itself goes up and down is in the distances.
    fn carried(&self, _: Vec3) -> Vec3 {
        [0.0; 3]
    }
}

/// The nearest point of a surface, seen from a centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Out of the solid, of length one.
    pub normal: Vec3,
    /// How far the centre is from the surface; negative inside.
    pub distance: f64,
}

/// A scene's functions at one moment.
#[derive(Clone, Debug)]
pub struct Field {
    bound: Tape,
    /// Gradient, field, distance.
    slopes: Tape,
    before: Option<Tape>,
    by_time: bool,
    /// Where a point lies in its part, now and before.
    carry: Option<[Tape; 2]>,
}

/// The most operations of a function at one point.
const LIMIT: usize = 2_000_000;
/// How often the nearest point is improved.
const IMPROVEMENTS: u32 = 10;
/// A way to the centre that leans by no more than this is upright.
const UPRIGHT: f64 = 0.01;

impl Field {
    /// The field at one moment, and as it was `before`, where it moves.
    pub fn new(compiled: &Compiled, live: &Live, before: Option<&Live>) -> Result<Self, TooLarge> {
        let compiled = compiled.ground();
        let functions: &Functions = &compiled.functions;
        let own = |f: Function| functions.formulas.get(&(compiled.root, f)).copied();
        let value = compiled.graph.shape(compiled.root).map_or(NodeId(0), |s| s.value);
        let field = own(Function::Field).unwrap_or(value);
        let distance = own(Function::Distance).unwrap_or(field);
        let slope = |i| own(Function::Gradient(i)).unwrap_or(field);
        let tape = |roots: &[NodeId], live| Tape::new(&compiled.graph, &functions.formulas, roots, live, LIMIT);
        Ok(Self {
            bound: tape(&[own(Function::Bound).unwrap_or(field)], live)?,
            slopes: tape(&[slope(0), slope(1), slope(2), field, distance], live)?,
            by_time: before.is_some_and(|before| before.components == live.components),
            before: before.map(|before| tape(&[distance], before)).transpose()?,
            carry: match (before, functions.carry.map(|carry| carry.nodes())) {
                (Some(before), Some(nodes)) => Some([tape(&nodes, live)?, tape(&nodes, before)?]),
                _ => None,
            },
        })
    }

    /// Gradient, field and distance at a point.
    fn slopes(&self, p: Vec3) -> (Vec3, f64, f64) {
        let mut evaluator = self.slopes.evaluator();
        evaluator.run(&lanes(&[p]));
        let at = |i| evaluator.output(i).first().copied().unwrap_or(0.0);
        ([at(0), at(1), at(2)], at(3), at(4))
    }
}

fn one(tape: &Tape, p: Vec3) -> f64 {
    let mut evaluator = tape.evaluator();
    evaluator.run(&lanes(&[p]));
    evaluator.output(0).first().copied().unwrap_or(0.0)
}

/// How exactly a point of the surface is found for a ball at a place: what 32 bits resolve there.
pub fn landing(center: Vec3, radius: f64) -> f64 {
    (5e-5 * radius).max(4e-7 * (length(center) + 1.0))
}

/// Within how much of its radius a ball counts as touching.
pub fn near(center: Vec3, radius: f64) -> f64 {
    (NEAR * radius).max(1e-6 * (length(center) + 1.0))
}

impl Ground for Field {
    fn free(&self, p: Vec3) -> f64 {
        one(&self.bound, p)
    }

    /// From the estimate at the centre down to the surface by Newton's steps, then along it to where the way to the centre stands upright on
    /// it. Where it never does, as at an edge, the nearest point that was on the surface is the answer; where none was, the estimate.
    fn touch(&self, center: Vec3, radius: f64) -> Touch {
        let (gradient, field, estimate) = self.slopes(center);
        let steepness = length(gradient);
        let first = if steepness > 1e-12 { scale(gradient, 1.0 / steepness) } else { [0.0, 1.0, 0.0] };
        let side = if field < 0.0 { -1.0 } else { 1.0 };
        let tolerance = landing(center, radius);
        // From the surface's point to the centre.
        let mut way = scale(first, estimate);
        let mut best = Touch { normal: first, distance: estimate };
        let (mut least, mut from, mut across) = (f64::INFINITY, way, [0.0; 3]);
        let mut stride = 1.0;
        for _ in 0..IMPROVEMENTS {
            let (gradient, field, _) = self.slopes(sub(center, way));
            let steepness = length(gradient);
            if steepness < 1e-12 {
                break;
            }
            let normal = scale(gradient, 1.0 / steepness);
            let rest = field / steepness;
            if rest.abs() > tolerance {
                way = along(way, normal, rest);
                continue;
            }
            let far = length(way);
            let height = dot(way, normal);
            let aside = sub(way, scale(normal, height));
            if length(aside) <= UPRIGHT * far {
                return Touch { normal, distance: height };
            }
            if far < least {
                let upright = far > 1e-3 * radius;
                best = Touch { normal: if upright { scale(way, side / far) } else { normal }, distance: side * far };
                (least, from, across) = (far, way, aside);
            } else {
                // Too far, past an edge: a shorter step from the nearest point.
                stride *= 0.4;
            }
            way = along(from, across, -stride);
        }
        best
    }

    fn distance(&self, p: Vec3) -> f64 {
        self.slopes(p).2
    }

    fn before(&self, p: Vec3) -> Option<f64> {
        self.before.as_ref().map(|tape| one(tape, p))
    }

    fn is_moved_by_time(&self) -> bool {
        self.by_time
    }

    fn carried(&self, p: Vec3) -> Vec3 {
        let Some([now, before]) = &self.carry else { return [0.0; 3] };
        let three = |tape: &Tape| {
            let mut evaluator = tape.evaluator();
            evaluator.run(&lanes(&[p]));
            [0, 1, 2, 3].map(|row| [0, 1, 2].map(|i| evaluator.output(3 * row + i).first().copied().unwrap_or(0.0)))
        };
        let [point, x, y, z] = three(now);
        let [was, ..] = three(before);
        way([x, y, z], sub(was, point))
    }
}

/// The way along which three coordinates with these slopes grow by so much: the shortest one of those that come nearest.
fn way(slopes: [Vec3; 3], growth: Vec3) -> Vec3 {
    let mut columns = [[0.0; 3]; 3];
    let mut right = [0.0; 3];
    for (slope, by) in slopes.into_iter().zip(growth) {
        right = along(right, slope, by);
        for (column, c) in columns.iter_mut().zip(slope) {
            *column = along(*column, slope, c);
        }
    }
    let trace: f64 = slopes.iter().map(|s| dot(*s, *s)).sum();
    for (i, column) in columns.iter_mut().enumerate() {
        if let Some(c) = column.get_mut(i) {
            *c += 1e-6 * trace + 1e-30;
        }
    }
    let [a, b, c] = columns;
    let whole = dot(a, cross(b, c));
    // Coordinates that hardly grow anywhere say nothing.
    if whole < 1e-30 {
        return [0.0; 3];
    }
    [cross(b, c), cross(c, a), cross(a, b)].map(|row| dot(row, right) / whole)
}
