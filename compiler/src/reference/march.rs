//! Many rays at once through a field: in step with each other, sixteen to a batch, over tapes that are shortened for the slab of space
//! that they are in.
//!
//! What a ray meets does not depend on the others: slabs say only when its turn comes and which tape serves it.

use crate::vector::{Vec3, along, dot, length, only};
use crate::analysis::Box3;
use crate::interface::Rounding;
use crate::evaluate::{LANES, Tape, lanes};
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

    /// The part of it that lies within a box, if any does, as `sf_within` finds it. `unit`: [`Rounding::unit`].
    pub fn within(&self, region: &Box3, unit: f64) -> Option<Ray> {
        let rounding = 1e-6 * (length(self.origin) + unit);
        let (mut t_min, mut t_max) = (self.t_min, self.t_max);
        for ((side, start), direction) in region.0.iter().zip(self.origin).zip(self.direction) {
            let moved = if direction.abs() < 1e-12 { 1e-12 } else { direction };
            let (one, other) = ((side.lo - rounding - start) / moved, (side.hi + rounding - start) / moved);
            t_min = t_min.max(one.min(other));
            t_max = t_max.min(one.max(other));
        }
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

/// What rounding in 32 bits grows with along each ray, beside the way: coordinates are no larger than both.
pub fn sizes(rays: &[Ray], rounding: Rounding) -> impl Fn(&Look) -> f64 {
    let Rounding { reads_scene, unit } = rounding;
    let sizes: Vec<f64> = rays.iter().map(|r| unit + length(only(r.origin, reads_scene))).collect();
    move |look| sizes.get(look.ray).copied().unwrap_or(unit)
}

/// Tapes of fewer operations are not worth shortening.
const SHORT: usize = 48;
/// Fewer rays than these are not worth shortening a tape for.
const FEW: usize = 48;
/// A tape that keeps more than this share of its operations was not worth shortening, and half of its rays would not be either.
const KEPT: f64 = 0.8;

/// What rays look at.
#[derive(Clone, Copy, Debug)]
pub enum Scene<'t> {
    /// Bound and distance, both at each look: the two formulas of one tape.
    Both(&'t Tape),
    /// The bound at each look, the distance where it is asked for.
    Apart(&'t Tape, &'t Tape),
}

/// Leads rays, each from its `t_min`, until `turn` ends them. `turn` is told what a ray finds, with the distance where `wants` asked
/// for it, and answers how far along the ray to look next, or nothing. A ray may go back, but not behind the place before the last
/// that lay ahead.
pub fn march(
    scene: Scene<'_>,
    rays: &[Option<Ray>],
    mut wants: impl FnMut(&Look) -> bool,
    mut turn: impl FnMut(&Look, Option<f64>) -> Option<f64>,
) {
    let mut under_way: Vec<Walker> = rays
        .iter()
        .enumerate()
        .filter_map(|(index, ray)| ray.map(|ray| Walker { index, ray, t: ray.t_min, from: ray.t_min }))
        .collect();
    let (tape, distance) = match scene {
        Scene::Both(tape) => (tape, None),
        Scene::Apart(bound, distance) => (bound, Some(distance)),
    };
    while !under_way.is_empty() {
        let start = under_way.iter().fold(f64::INFINITY, |t, w| t.min(w.t));
        let end = start + slab(&under_way, start);
        let near = take_before(&mut under_way, end);
        let mut turns =
            Turns { distance, wants: &mut wants, turn: &mut turn, beyond: &mut under_way };
        turns.lead_short(tape, near, (start, end));
    }
}

/// Those that are before a place on their way.
fn take_before(walkers: &mut Vec<Walker>, end: f64) -> Vec<Walker> {
    let (near, far) = walkers.drain(..).partition(|w| w.t < end);
    *walkers = far;
    near
}

/// A ray on its way.
#[derive(Clone, Copy, Debug)]
struct Walker {
    index: usize,
    ray: Ray,
    t: f64,
    /// It does not go back behind this place.
    from: f64,
}

/// How thick the next slab is: about as thick as the rays are apart there, and growing with the way.
fn slab(walkers: &[Walker], start: f64) -> f64 {
    let sides = bounds(walkers.iter().map(|w| w.ray.at(start)));
    let wide = length(sides.map(Interval::width));
    (0.5 * wide).max(0.15 * start).max(1e-3)
}

/// The box of the rays from where they are to the slab's end.
fn region(walkers: &[Walker], end: f64) -> [Interval; 3] {
    bounds(walkers.iter().flat_map(|w| [w.ray.at(w.from), w.ray.at(end.min(w.ray.t_max))]))
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

/// What is done at each look, and where rays go that leave a slab.
struct Turns<'a, W, T> {
    /// Where it does not come with the bound.
    distance: Option<&'a Tape>,
    wants: &'a mut W,
    turn: &'a mut T,
    beyond: &'a mut Vec<Walker>,
}

impl<W: FnMut(&Look) -> bool, T: FnMut(&Look, Option<f64>) -> Option<f64>> Turns<'_, W, T> {
    /// Leads rays through a slab over tapes that are shortened for it; where they still are long, the rays go in two halves, or
    /// the slab is crossed in two.
    fn lead_short(&mut self, tape: &Tape, near: Vec<Walker>, (start, end): (f64, f64)) {
        if tape.operations() <= SHORT || near.len() < FEW {
            return self.lead(tape, near, end);
        }
        let short = &tape.narrow(region(&near, end));
        let kept = short.operations() as f64 / tape.operations() as f64;
        if short.operations() <= SHORT || kept > KEPT && near.len() < 8 * FEW {
            return self.lead(short, near, end);
        }
        let across = bounds(near.iter().map(|w| w.ray.at(start)));
        let widths = across.map(Interval::width);
        if length(widths) < end - start {
            let middle = start + 0.5 * (end - start);
            let mut near = near;
            let first = take_before(&mut near, middle);
            let beyond = std::mem::replace(self.beyond, near);
            self.lead_short(short, first, (start, middle));
            let second = std::mem::replace(self.beyond, beyond);
            let mut second = second;
            let rest = take_before(&mut second, end);
            self.beyond.append(&mut second);
            return self.lead_short(short, rest, (middle, end));
        }
        if near.len() < 2 * FEW {
            return self.lead(short, near, end);
        }
        let axis = (0..3).max_by(|&a: &usize, &b| {
            let width = |i: usize| widths.get(i).copied().unwrap_or(0.0);
            width(a).total_cmp(&width(b))
        });
        let axis = axis.unwrap_or(0);
        let mut near = near;
        let place = |w: &Walker| w.ray.at(start).get(axis).copied().unwrap_or(0.0);
        near.sort_by(|a, b| place(a).total_cmp(&place(b)));
        let other = near.split_off(near.len() / 2);
        self.lead_short(short, near, (start, end));
        self.lead_short(short, other, (start, end));
    }

    /// Leads the rays `near` until they end or are past `end`.
    fn lead(&mut self, tape: &Tape, mut near: Vec<Walker>, end: f64) {
        let mut bound = tape.evaluator();
        let mut still = Vec::with_capacity(near.len());
        while !near.is_empty() {
            let mut asking = Vec::new();
            for batch in near.chunks(LANES) {
                let mut points = [[0.0; 3]; LANES];
                for (point, walker) in points.iter_mut().zip(batch) {
                    *point = walker.ray.at(walker.t);
                }
                bound.run(&lanes(points.get(..batch.len()).unwrap_or(&points)));
                let (frees, distances) = (bound.output(0), bound.output(1));
                let found = points.iter().zip(frees).zip(distances);
                for (walker, ((&point, &free), &distance)) in batch.iter().zip(found) {
                    let look = Look { ray: walker.index, point, t: walker.t, free };
                    if !(self.wants)(&look) {
                        self.go_on(walker, &look, None, end, &mut still);
                    } else if self.distance.is_none() {
                        self.go_on(walker, &look, Some(distance), end, &mut still);
                    } else {
                        asking.push((*walker, look));
                    }
                }
            }
            if let Some(distance) = self.distance.filter(|_| !asking.is_empty()) {
                let points: Vec<Vec3> = asking.iter().map(|(_, look)| look.point).collect();
                at_points(distance, &points, &[], |i, values| {
                    if let Some((walker, look)) = asking.get(i) {
                        self.go_on(walker, look, values.first().copied(), end, &mut still);
                    }
                });
            }
            near.clear();
            std::mem::swap(&mut near, &mut still);
        }
    }

    /// Tells a ray what it found, and keeps it where it goes on.
    fn go_on(
        &mut self,
        walker: &Walker,
        look: &Look,
        distance: Option<f64>,
        end: f64,
        still: &mut Vec<Walker>,
    ) {
        if let Some(t) = (self.turn)(look, distance) {
            let from = if t > look.t { look.t } else { walker.from };
            let walker = Walker { t, from, ..*walker };
            if t < end { still.push(walker) } else { self.beyond.push(walker) }
        }
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
