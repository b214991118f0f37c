//! A scene's field at one moment, cut off at a box: what the contour asks, many places at once.

use super::{Mesh, at};
use crate::compiled::{Compiled, Live};
use crate::evaluate::{Evaluator, Tape, TooLarge};
use crate::graph::interval::Interval;
use crate::graph::{Function, NodeId};
use crate::vector::{Vec3, length};
use crate::spread::spread;

/// Operations of a function once every call is replaced by its formula.
const LARGEST: usize = 4_000_000;
/// Corners whose colour one task finds.
const SHARE: usize = 4096;

/// The functions of a scene, and the box.
pub(super) struct Field {
    field: Tape,
    bound: Tape,
    gradient: Option<Tape>,
    cut: [Vec3; 2],
}

/// The same with room to compute in. One for each thread.
pub(super) struct Eyes<'f> {
    field: Evaluator<'f>,
    bound: Evaluator<'f>,
    gradient: Option<Evaluator<'f>>,
    cut: [Vec3; 2],
}

impl Field {
    pub fn new(compiled: &Compiled, live: &Live, cut: [Vec3; 2]) -> Result<Self, TooLarge> {
        let own = |f: Function| compiled.functions.formulas.get(&(compiled.root, f)).copied();
        let value = compiled.graph.shape(compiled.root).map_or(NodeId(0), |s| s.value);
        let field = own(Function::Field).unwrap_or(value);
        let bound = own(Function::Bound).unwrap_or(field);
        let tape = |roots: &[NodeId]| Tape::new(&compiled.graph, &compiled.functions.formulas, roots, live, LARGEST);
        let slopes: Option<Vec<NodeId>> = (0..3).map(|i| own(Function::Gradient(i))).collect();
        let gradient = slopes.map(|slopes| tape(&slopes)).transpose()?;
        Ok(Self { field: tape(&[field])?, bound: tape(&[bound])?, gradient, cut })
    }

    /// The same field with shorter formulas, for the box about some points and `farther` around it. What can't matter there is left out.
    /// Values there stay as they are.
    pub fn near(&self, points: impl Iterator<Item = Vec3>, farther: f64) -> Self {
        let mut region = [Interval::EMPTY; 3];
        for point in points {
            region.iter_mut().zip(point).for_each(|(side, c)| *side = side.hull(Interval::point(c)));
        }
        let region = region.map(|side| side.grow(farther));
        let gradient = self.gradient.as_ref().map(|gradient| gradient.narrow(region));
        Self { field: self.field.narrow(region), bound: self.bound.clone(), gradient, cut: self.cut }
    }

    pub fn eyes(&self) -> Eyes<'_> {
        let gradient = self.gradient.as_ref().map(Tape::evaluator);
        Eyes { field: self.field.evaluator(), bound: self.bound.evaluator(), gradient, cut: self.cut }
    }

    /// The linear colour at each corner of a mesh, without what images add.
    pub fn colors(&self, compiled: &Compiled, live: &Live, mesh: &Mesh) -> Result<Vec<[f32; 3]>, TooLarge> {
        let tape = Tape::new(&compiled.graph, &compiled.functions.formulas, &compiled.functions.surface.color, live, LARGEST)?;
        let shares: Vec<(&[Vec3], &[[f32; 3]])> = mesh.vertices.chunks(SHARE).zip(mesh.normals.chunks(SHARE)).collect();
        let found = spread(shares.len(), &|| tape.evaluator(), &|evaluator, i| {
            let Some((points, normals)) = shares.get(i) else { return Vec::new() };
            let normals: Vec<Vec3> = normals.iter().map(|n| n.map(f64::from)).collect();
            let mut colors = Vec::with_capacity(points.len());
            evaluator.at(points, &normals, |_, rgb| colors.push([0, 1, 2].map(|c| rgb.get(c).map_or(0.5, |c| *c as f32))));
            colors
        });
        Ok(found.into_iter().flatten().collect())
    }
}

impl Eyes<'_> {
    /// The field at some points, at least the distance to the box outside of it.
    pub fn values(&mut self, points: &[Vec3]) -> Vec<f64> {
        let mut values = Vec::with_capacity(points.len());
        self.field.at(points, &[], |_, v| values.push(v.first().copied().unwrap_or(0.0)));
        larger(&mut values, points, self.cut);
        values
    }

    /// How far from each point there is no surface, with the field's sign.
    pub fn bounds(&mut self, points: &[Vec3]) -> Vec<f64> {
        let mut values = Vec::with_capacity(points.len());
        self.bound.at(points, &[], |_, v| values.push(v.first().copied().unwrap_or(0.0)));
        larger(&mut values, points, self.cut);
        values
    }

    /// The gradients of the field as it is cut, at points of which the surface is nearer than `near`.
    pub fn slopes(&mut self, points: &[Vec3], near: f64) -> Vec<Vec3> {
        let mut slopes = Vec::with_capacity(points.len());
        match &mut self.gradient {
            Some(gradient) => gradient.at(points, &[], |_, v| slopes.push([0, 1, 2].map(|i| v.get(i).copied().unwrap_or(0.0)))),
            None => {
                slopes.resize(points.len(), [0.0; 3]);
                for axis in 0..3 {
                    let moved = |by: f64| points.iter().map(|p| shifted(*p, axis, by)).collect::<Vec<_>>();
                    let step = 1e-4 * near;
                    let mut sides = [moved(-step), moved(step)].map(|points| {
                        let mut values = Vec::new();
                        self.field.at(&points, &[], |_, v| values.push(v.first().copied().unwrap_or(0.0)));
                        values.into_iter()
                    });
                    let [low, high] = &mut sides;
                    for (slope, (low, high)) in slopes.iter_mut().zip(low.zip(high)) {
                        slope.iter_mut().skip(axis).take(1).for_each(|c| *c = (high - low) / (2.0 * step));
                    }
                }
            }
        }
        // Where the box is what ends the solid, its face counts.
        let mut field = Vec::with_capacity(points.len());
        self.field.at(points, &[], |_, v| field.push(v.first().copied().unwrap_or(0.0)));
        for ((slope, value), point) in slopes.iter_mut().zip(field).zip(points) {
            let (to_box, normal) = box_distance(*point, self.cut);
            if to_box > value {
                *slope = normal;
            }
        }
        slopes
    }
}

fn shifted(mut point: Vec3, axis: usize, by: f64) -> Vec3 {
    point.iter_mut().skip(axis).take(1).for_each(|c| *c += by);
    point
}

fn larger(values: &mut [f64], points: &[Vec3], cut: [Vec3; 2]) {
    for (value, point) in values.iter_mut().zip(points) {
        let to_box = box_distance(*point, cut).0;
        // What is no number is outside.
        *value = if *value > to_box || value.is_nan() { *value } else { to_box };
    }
}

/// The signed distance to a box, and the normal of its nearest face.
fn box_distance(point: Vec3, [low, high]: [Vec3; 2]) -> (f64, Vec3) {
    let mut outside = [0.0; 3];
    let mut nearest = (f64::NEG_INFINITY, [0.0; 3]);
    for axis in 0..3 {
        for (side, beyond) in [(-1.0, at(low, axis) - at(point, axis)), (1.0, at(point, axis) - at(high, axis))] {
            if beyond > nearest.0 {
                nearest = (beyond, shifted([0.0; 3], axis, side));
            }
            if beyond > 0.0 {
                outside = shifted(outside, axis, beyond);
            }
        }
    }
    (if nearest.0 > 0.0 { length(outside) } else { nearest.0 }, nearest.1)
}
