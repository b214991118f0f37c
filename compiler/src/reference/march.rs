//! Many rays at once through a field: in step with each other, sixteen to a batch, over tapes that are shortened for the slab of space
//! that they are in.
//!
//! What a ray meets does not depend on the others: slabs say only when its turn comes and which tape serves it.

use super::vector::{Vec3, along, dot, length};
use crate::evaluate::{Evaluator, LANES, Tape, lanes};
use crate::graph::interval::Interval;

/// A ray, and the part of it that is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where `t` is zero.
    pub origin: Vec3,
    /// Length one.
    pub direction: Vec3,
    /// From here.
    pub t_min: f64,
    /// To here.
    pub t_max: f64,
}

impl Ray {
    /// The point at a distance from the origin.
    pub fn at(&self, t: f64) -> Vec3 {
        along(self.origin, self.direction, t)
    }

    /// The part of it that lies within a sphere about the scene's origin, if any does.
    pub fn clip(&self, extent: f64) -> Option<Ray> {
        let middle = -dot(self.origin, self.direction);
        let nearest = self.at(middle);
        let rest = extent * extent - dot(nearest, nearest);
        if rest < 0.0 {
            return None;
        }
        let reach = rest.sqrt();
        let (t_min, t_max) = (self.t_min.max(middle - reach), self.t_max.min(middle + reach));
        (t_min <= t_max).then_some(Ray { t_min, t_max, ..*self })
    }
}

/// What a ray finds where it is.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// The ray.
    pub ray: usize,
    /// The point.
    pub point: Vec3,
    /// How far along the ray.
    pub t: f64,
    /// How far it may step.
    pub free: f64,
}

/// Tapes of fewer operations are not worth shortening.
const SHORT: usize = 48;
/// Fewer rays than these are not worth shortening a tape for.
const FEW: usize = 48;

/// Leads rays, each from its `t_min`, until `turn` ends them. `turn` is told what a ray finds, with the distance where `wants` asked
/// for it, and answers how far along the ray to look next, or nothing.
pub fn march(
    bound: &Tape,
    distance: &Tape,
    rays: &[Option<Ray>],
    mut wants: impl FnMut(&Look) -> bool,
    mut turn: impl FnMut(&Look, Option<f64>) -> Option<f64>,
) {
    let mut under_way: Vec<Walker> = rays
        .iter()
        .enumerate()
        .filter_map(|(index, ray)| ray.map(|ray| Walker { index, ray, t: ray.t_min }))
        .collect();
    let mut full = (bound.evaluator(), distance.evaluator());
    while !under_way.is_empty() {
        let start = under_way.iter().fold(f64::INFINITY, |t, w| t.min(w.t));
        let end = start + slab(&under_way, start);
        // Those of this slab to the front.
        under_way.sort_by_key(|w| w.t >= end);
        let count = under_way.partition_point(|w| w.t < end);
        let mut near: Vec<Walker> = under_way.drain(..count).collect();
        let worth = bound.operations() > SHORT && near.len() >= FEW;
        if worth {
            let region = region(&near, end);
            let short = (bound.narrow(region), distance.narrow(region));
            let mut tapes = (short.0.evaluator(), short.1.evaluator());
            lead(&mut tapes, &mut near, &mut under_way, end, &mut wants, &mut turn);
        } else {
            lead(&mut full, &mut near, &mut under_way, end, &mut wants, &mut turn);
        }
    }
}

/// A ray on its way.
#[derive(Clone, Copy, Debug)]
struct Walker {
    index: usize,
    ray: Ray,
    t: f64,
}

/// How thick the next slab is: about as thick as the rays are apart there, and growing with the way.
fn slab(walkers: &[Walker], start: f64) -> f64 {
    let sides = bounds(walkers.iter().map(|w| w.ray.at(start)));
    let wide = length(sides.map(Interval::width));
    (0.5 * wide).max(0.15 * start).max(1e-3)
}

/// The box of the rays from where they are to the slab's end.
fn region(walkers: &[Walker], end: f64) -> [Interval; 3] {
    bounds(walkers.iter().flat_map(|w| [w.ray.at(w.t), w.ray.at(end.min(w.ray.t_max))]))
}

/// The box of some points, with room for rounding.
fn bounds(points: impl Iterator<Item = Vec3>) -> [Interval; 3] {
    let mut sides = [Interval::EMPTY; 3];
    for point in points {
        for (side, c) in sides.iter_mut().zip(point) {
            *side = Interval { lo: side.lo.min(c), hi: side.hi.max(c) };
        }
    }
    sides.map(|side| side.grow(1e-12 * (1.0 + side.magnitude())))
}

/// Leads the rays `near` until they end or are past `end`; those go to `beyond`.
fn lead(
    (bound, distance): &mut (Evaluator<'_>, Evaluator<'_>),
    near: &mut Vec<Walker>,
    beyond: &mut Vec<Walker>,
    end: f64,
    wants: &mut impl FnMut(&Look) -> bool,
    turn: &mut impl FnMut(&Look, Option<f64>) -> Option<f64>,
) {
    let mut still = Vec::with_capacity(near.len());
    while !near.is_empty() {
        for batch in near.chunks(LANES) {
            let mut points = [[0.0; 3]; LANES];
            for (point, walker) in points.iter_mut().zip(batch) {
                *point = walker.ray.at(walker.t);
            }
            let place = lanes(points.get(..batch.len()).unwrap_or(&points));
            bound.run(&place);
            let looks: [Look; LANES] = std::array::from_fn(|lane| {
                let (ray, t) = batch.get(lane).map_or((0, 0.0), |w| (w.index, w.t));
                let point = points.get(lane).copied().unwrap_or_default();
                Look { ray, point, t, free: bound.output(0).get(lane).copied().unwrap_or(0.0) }
            });
            let mut wanted = [false; LANES];
            for (wanted, look) in wanted.iter_mut().zip(&looks).take(batch.len()) {
                *wanted = wants(look);
            }
            if wanted.contains(&true) {
                distance.run(&place);
            }
            for (lane, (walker, look)) in batch.iter().zip(&looks).enumerate() {
                let asked = wanted.get(lane) == Some(&true);
                let far = distance.output(0).get(lane).copied().filter(|_| asked);
                if let Some(t) = turn(look, far) {
                    let walker = Walker { t, ..*walker };
                    if t < end { still.push(walker) } else { beyond.push(walker) }
                }
            }
        }
        near.clear();
        std::mem::swap(near, &mut still);
    }
}

/// Computes the formulas of a tape at points that lie close together: shortened first where that pays.
pub fn at_points(tape: &Tape, points: &[Vec3], normals: &[Vec3], each: impl FnMut(usize, &[f64])) {
    if tape.operations() > SHORT && points.len() >= FEW {
        tape.narrow(bounds(points.iter().copied())).evaluator().at(points, normals, each);
    } else {
        tape.evaluator().at(points, normals, each);
    }
}
