//! How much of a light's disc is seen, step for step as in the text of `compiler/src/emit/shadow.rs`, which says how.

use super::Reference;
use super::area::toward;
use super::march::{Look, Ray, Scene, at_points, march, sizes};
use crate::vector::{Vec3, along, dot, length, sub};
use crate::analysis::Box3;
use crate::emit::shadow::{BEHIND, LEFT, MET, MET_ASIDE, MOST_ASIDE, RIM, SHARE, STEP};
use crate::graph::interval::Interval;
use std::cell::Cell;

/// Looks of a shadow's ray at most.
const MOST_STEPS: u32 = 256;
/// It goes on by as much as the bound at most divided by this.
const SHORTEST_REST: f64 = 0.25;
/// It goes back where the bound is less than this share of the step.
const CLOSE: f64 = 0.75;
/// Where the distance matters, and is so many times the bound, it goes on by no more than this part of it: a passage between two looks is hardly nearer.
const MATTERS: f64 = 1.25;
const MUCH_MORE: f64 = 1.5;
const BETWEEN: f64 = 0.4;
/// A ray that has spent its looks goes on by guesses so often, and at least by so much for each unit of its coordinates and its way.
const MOST_GUESSES: u32 = 32;
const LEAST_GUESS: f64 = 2e-3;
/// As sharp as this is an edge without a penumbra.
const HARD: f64 = 1e18;
/// So near to the surface, for each unit of the same, it is met.
const TOUCHED: f64 = 2e-6;

/// How much light comes along rays to the middles of discs: 1 lit, 0 dark. Of the `softness` of a ray 0 is a sharp edge, more is sharper.
pub(super) fn shares(scene: &Reference, rays: &[Ray], softness: &[f64], extent: f64) -> Vec<f64> {
    let sharpness: Vec<f64> = softness.iter().map(|softness| if *softness > 0.0 { *softness } else { HARD }).collect();
    let middles = passages(scene, rays, &sharpness, extent, false);
    let mut lit: Vec<f64> = middles.iter().map(|middle| if middle.lit > 0.0 { share(middle.lit) } else { 0.0 }).collect();
    let sharp = |i: usize| sharpness.get(i).copied().unwrap_or(HARD);
    let met: Vec<(usize, &Ray, &Passage)> = (0..)
        .zip(rays.iter().zip(&middles))
        .filter(|(i, (_, middle))| middle.lit <= 0.0 && sharp(*i) < HARD)
        .map(|(i, (ray, middle))| (i, ray, middle))
        .collect();
    // What fills the cone hides all of the light.
    let wide = |i: usize, passage: &Passage| 1.1 * passage.t / sharp(i);
    let deeper: Vec<Vec3> = met.iter().map(|(i, ray, middle)| ray.at(middle.t + wide(*i, middle))).collect();
    let mut hidden: Vec<(usize, Ray)> = Vec::new();
    at_points(&scene.rest.bound, &deeper, &[], |i, values| {
        let fills = |(i, _, middle): &&(usize, &Ray, &Passage)| {
            let wide = wide(*i, middle) * (1.0 + 1.1 / sharp(*i));
            values.first().is_some_and(|bound| *bound <= -wide)
        };
        if let Some((of, ray, _)) = met.get(i).filter(|met| !fills(met)) {
            hidden.push((*of, **ray));
        }
    });
    let around = [[RIM, 0.0], [0.0, RIM], [-RIM, 0.0], [0.0, -RIM]].map(|at| {
        let aimed = |(i, ray): &(usize, Ray)| {
            let direction = toward(ray.direction, 1.0 / sharp(*i), at);
            Ray { direction, t_max: ray.t_max * (1.0 + (RIM / sharp(*i)).powi(2)).sqrt(), ..*ray }
        };
        let aimed: Vec<Ray> = hidden.iter().map(aimed).collect();
        let sharpness: Vec<f64> = hidden.iter().map(|(i, _)| sharp(*i)).collect();
        passages(scene, &aimed, &sharpness, extent, true)
    });
    for (place, &(i, _)) in hidden.iter().enumerate() {
        let seen = [0, 1, 2, 3].map(|turn: usize| around.get(turn).and_then(|passed| passed.get(place)).map_or(0.0, |passed| passed.lit));
        if let Some(lit) = lit.get_mut(i) {
            let quarters = seen.iter().filter(|passed| **passed > 0.0).count() as f64 / 4.0;
            let is_free = middles.get(i).is_some_and(|middle| middle.lit < 0.0);
            *lit = beside(seen).max(if is_free { quarters } else { 0.0 });
        }
    }
    lit
}

/// The share that is seen of a disc whose middle is hidden. `seen`: how narrowly rays to four places near its rim pass, one after the other around it.
fn beside(seen: [f64; 4]) -> f64 {
    let [a, b, c, d] = seen;
    let (x, y) = (a.max(c), b.max(d));
    if x.max(y) <= 0.0 {
        return 0.0;
    }
    // Where one of each pair sees, both tell how far off an edge is; where both of a pair do, what hides the middle is narrow.
    let edge = 0.5 * (x + y - (2.0 * RIM * RIM - (x - y) * (x - y)).max(0.0).sqrt());
    let best = if x.min(y) > 0.0 { edge } else { x.max(y) - RIM };
    let side = |a: f64| if a > 0.0 { share(a - RIM) } else { 0.0 };
    share(best.min(0.0)).max((side(a) + side(c)).max(side(b) + side(d)).min(1.0))
}

/// The share of a disc of radius one on one side of a straight line, which is so far from its middle.
fn share(a: f64) -> f64 {
    let a = a.clamp(-1.0, 1.0);
    let [first, third, fifth] = SHARE;
    0.5 + a * (first + a * a * (third + fifth * a * a))
}

/// The part of a ray that lies within a box, or so near to it that what is solid can stand in a cone about the ray, as `sf_beside` finds it.
fn near(ray: &Ray, region: &Box3, sharpness: f64, unit: f64) -> Option<Ray> {
    let farther = |(side, start): (&Interval, &f64)| (side.lo - start).abs().max((side.hi - start).abs());
    let far: Vec3 = std::array::from_fn(|i| region.0.get(i).zip(ray.origin.get(i)).map_or(0.0, farther));
    let margin = length(far) / sharpness;
    let wider = Box3(region.0.map(|side| Interval { lo: side.lo - margin, hi: side.hi + margin }));
    ray.within(&wider, unit)
}

/// How narrowly each ray passes what is solid. `aside`: whether they do not go to the middle of the light.
fn passages(scene: &Reference, rays: &[Ray], sharpness: &[f64], extent: f64, aside: bool) -> Vec<Passage> {
    let sharp = |ray: usize| sharpness.get(ray).copied().unwrap_or(HARD);
    let least = if aside { MET_ASIDE } else { MET };
    let clipped: Vec<Option<Ray>> = rays.iter().map(|ray| ray.clip(extent)).collect();
    let passed = |planes: &super::PlanesApart| planes.passages(&clipped, scene.rounding.unit, sharp);
    let planes = scene.planes.as_ref().map_or_else(|| vec![(f64::INFINITY, 0.0); rays.len()], passed);
    let starts = planes.iter().map(|&(past, t)| Cell::new(Passage { lit: past.min(1.0), t, ..Passage::START }));
    let states: Vec<Cell<Passage>> = starts.collect();
    let near: Vec<Option<Ray>> = clipped
        .iter()
        .zip(&states)
        .enumerate()
        .map(|(i, (ray, state))| {
            let ray = ray.filter(|_| state.get().lit >= least)?;
            scene.region.as_ref().map_or(Some(ray), |region| near(&ray, region, sharp(i), scene.rounding.unit))
        })
        .collect();
    let state = |look: &Look| states.get(look.ray).map_or(Passage::START, Cell::get);
    let size = sizes(rays, scene.rounding);
    let way = |look: &Look| size(look) + look.t;
    let light = |ray: usize| rays.get(ray).filter(|_| scene.lamps).map_or(f64::INFINITY, |ray| ray.t_max);
    let apart = |look: &Look| look.t.max(TOUCHED * way(look));
    let is_hard = |look: &Look| sharp(look.ray) >= HARD;
    march(
        match sharpness.iter().all(|sharpness| *sharpness >= HARD) {
            true => Scene::Apart(&scene.rest.bound, &scene.rest.distance),
            false => Scene::Both(&scene.rest.both),
        },
        &near,
        |look| {
            // The distance is looked at where the bound says that it can matter.
            let matters = !is_hard(look) && look.free > TOUCHED * way(look) && sharp(look.ray) * look.free < state(look).lit * apart(look);
            matters || state(look).is_spent() && !aside
        },
        |look, distance| {
            let ray = near.get(look.ray).copied().flatten()?;
            let mut passage = state(look);
            let past = distance.map(|distance| (sharp(look.ray) * distance / apart(look), distance));
            let lit = state(look).lit;
            let mut next = passage.turn(look, past, way(look), (ray.t_max, light(look.ray), sharp(look.ray)));
            if passage.lit < least || next.is_some() && aside && passage.steps >= MOST_ASIDE {
                (passage.lit, next) = (0.0, None);
            }
            if passage.lit < lit {
                passage.nearest = look.t;
            }
            states.get(look.ray)?.set(passage);
            next
        },
    );
    let ended = |passage: Passage| Passage { lit: if passage.lit < least { 0.0 } else { passage.lit }, ..passage };
    let passed = states.iter().map(|state| ended(state.get())).zip(rays);
    let told = |(passage, ray): (Passage, &Ray)| {
        let known = !scene.loose || passage.lit <= 0.0 || passage.nearest < 0.0 || is_real(scene, ray, passage.nearest);
        let otherwise = if aside { 1.0 } else { -1.0 };
        Passage { lit: if known { passage.lit } else { otherwise }, ..passage }
    };
    passed.map(told).collect()
}

/// Whether the surface is where the estimate of the distance and the gradient at a place of a ray say.
fn is_real(scene: &Reference, ray: &Ray, t: f64) -> bool {
    let at = ray.at(t);
    let estimate = |tape, at: Vec3| {
        let mut found = f64::INFINITY;
        at_points(tape, &[at], &[], |_, values| found = values.first().copied().unwrap_or(found));
        found
    };
    let distance = estimate(&scene.rest.distance, at);
    if scene.planes.as_ref().is_some_and(|planes| estimate(&planes.distance, at) <= distance) {
        return true;
    }
    let slope = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| estimate(&scene.rest.distance, along(at, axis, STEP * distance)) - distance);
    let there = along(at, slope, -distance / length(slope).max(1e-12));
    dot(sub(there, ray.origin), ray.direction) > 0.0 && estimate(&scene.rest.distance, there) <= LEFT * distance
}

/// The variables of `sf_passage`.
#[derive(Clone, Copy, Debug)]
struct Passage {
    /// The least angle so far, in half-angles of the light; 0 where something was met.
    lit: f64,
    /// Where the last look was.
    t: f64,
    /// Where it passed most narrowly so far; below 0: nothing.
    nearest: f64,
    /// Of the last sphere that is known to be empty.
    radius: f64,
    /// From its centre to here.
    stride: f64,
    steps: u32,
}

impl Passage {
    /// At the ray's beginning, before the first look.
    const START: Self = Self { lit: 1.0, t: 0.0, nearest: -1.0, radius: 1e18, stride: 1.0, steps: 0 };

    /// Whether it has spent its looks, and goes on by guesses.
    fn is_spent(&self) -> bool {
        self.steps >= MOST_STEPS
    }

    /// One look. `past`: the angle and the distance of what it passes, where that can matter; `size`: how large coordinates are there, and the way to
    /// it; `ends`: where the ray ends and where the light is, and how sharp its shadow. The answer: where to look next.
    fn turn(&mut self, look: &Look, past: Option<(f64, f64)>, size: f64, ends: (f64, f64, f64)) -> Option<f64> {
        let Self { radius, stride, lit, .. } = *self;
        let (t, free) = (look.t, look.free);
        let (end, light, sharpness) = ends;
        let tolerance = TOUCHED * size;
        let guesses = self.is_spent();
        let back = stride > radius && free < CLOSE * stride;
        self.steps += 1;
        self.t = t;
        // What the slope over the last step says to be behind the light hides less of it.
        let behind = BEHIND * (free * (radius - free) / stride - (light - t)).max(0.0);
        if let Some((_, distance)) = past {
            self.lit = lit.min(sharpness * (distance + behind) / t.max(tolerance));
        }
        if free <= if guesses { 0.0 } else { tolerance } || self.lit < MET {
            self.lit = 0.0;
            return None;
        }
        if guesses {
            let next = t + past.map_or(free, |(_, distance)| distance).max(LEAST_GUESS * size);
            return (next <= end && self.steps < MOST_STEPS + MOST_GUESSES).then_some(next);
        }
        let on = free * stride / (stride + radius - free).min(stride).max(SHORTEST_REST * stride);
        let left = (light - t) * sharpness / light;
        let stop = light * (1.0 - 0.5 * ((2.0 * left - 0.01).ceil() - 1.0).clamp(0.0, 2.0) / sharpness);
        let is_near = t < light && free * sharpness / light - left < self.lit;
        let stop = if is_near { stop } else { f64::INFINITY };
        let mut next = (t + free).min(stop).max((t + on).min(end).min(stop));
        if back {
            next = t + radius - stride;
            self.stride = radius;
        } else {
            (self.radius, self.stride) = (free, next - t);
            if let Some((share, distance)) = past
                && share < MATTERS * lit
                && distance > MUCH_MORE * free
            {
                self.stride = self.stride.min(tolerance.max(BETWEEN * distance));
                next = t + self.stride;
            }
        }
        (next <= end).then_some(next)
    }
}
