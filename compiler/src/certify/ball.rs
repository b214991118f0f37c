//! Whether a ball holds no surface, and how far the surface is.
//!
//! Boxes are looked at from the ball's centre outward. A box is done when the field keeps its sign on what of it lies in the ball; the
//! mean-value form sees the ball itself ([`Domain`]), so a ball that nearly touches the surface takes few boxes more than another. What is
//! left of a box is cut down before it is halved: to the ball, to the piece of the field that is looked at, and to where the field can be zero.

use super::code::Code;
use super::forward::{self, Domain, Slot};
use super::jumps::{self, Guard, Side};
use super::{BRANCHES, Box3, Prover, SHORT, SLOPES};
use crate::graph::interval::Interval;
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::sync::Arc;

/// Whether an open ball holds a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ball {
    /// Proven: the field has the sign of the centre everywhere inside.
    Empty,
    /// Proven: the field has the other sign at this point inside.
    Crossed([f64; 3]),
    /// Neither, within the budget. No surface is nearer to the centre than this.
    Unknown(f64),
}

/// How far the surface is from a point: where the field has another sign than there, or is zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distance {
    /// No surface is nearer.
    pub at_least: f64,
    /// There is a surface within this; infinite where none was found.
    pub at_most: f64,
    /// A point beyond the surface, at most as far away as `at_most`. The question's own point where none was found.
    pub beyond: [f64; 3],
}

/// A box that is still to be looked at. The greatest is the nearest.
struct Open {
    near: f64,
    range: Box3,
    code: Arc<Code>,
    /// The pieces to which the code belongs: outside of them it says nothing.
    guards: Vec<Arc<Guard>>,
}

impl PartialEq for Open {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Open {}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        other.near.total_cmp(&self.near)
    }
}

/// Boxes narrower than this, relative to the ball and its place, are put aside.
const NARROW: f64 = 1e-11;

impl Prover<'_> {
    /// Whether the open ball about `centre` holds no surface. Looks at `budget` boxes at most.
    pub fn empty_ball(&mut self, centre: [f64; 3], radius: f64, budget: usize) -> Ball {
        if radius.is_nan() || radius <= 0.0 {
            return Ball::Empty;
        }
        let found = self.search(centre, radius, None, budget);
        if found.at_most < f64::INFINITY {
            Ball::Crossed(found.beyond)
        } else if found.at_least >= radius {
            Ball::Empty
        } else {
            Ball::Unknown(found.at_least)
        }
    }

    /// How far the surface is from a point, to within the relative width `close` (0 to 1). No farther than `reach` is looked, at `budget`
    /// boxes at most; what is not settled then is left open between the two ends.
    pub fn distance(&mut self, point: [f64; 3], reach: f64, close: f64, budget: usize) -> Distance {
        self.search(point, reach, Some(close.clamp(1e-12, 1.0)), budget)
    }

    /// With `close`: shrinks the ball to just within each surface that is found. Without: stops at the first.
    fn search(&mut self, centre: [f64; 3], reach: f64, close: Option<f64>, budget: usize) -> Distance {
        let root = self.truth.point.clone();
        let mut found = Distance { at_least: 0.0, at_most: f64::INFINITY, beyond: centre };
        let side = self.sign(&root, centre);
        if side == 0 {
            if self.value(centre) == 0.0 {
                found.at_most = 0.0;
            }
            return found;
        }
        let mut radius = reach;
        let cube = centre.map(|c| Interval::outward(c - radius, c + radius));
        let mut open = BinaryHeap::from([Open { near: 0.0, range: cube, code: root.clone(), guards: Vec::new() }]);
        // The nearest box that could not be told.
        let mut aside = f64::INFINITY;
        let mut left = budget;
        while let Some(Open { near, range, code, mut guards }) = open.pop() {
            if near >= radius.min(aside) {
                break;
            }
            if left == 0 || self.work >= self.most {
                aside = aside.min(near);
                break;
            }
            left -= 1;
            self.boxes += 1;
            let Some(mut range) = clipped(range, centre, radius) else { continue };
            let mut domain = Domain::new(range, Some((centre, radius)));
            if !guards.is_empty() {
                self.work += SLOPES * guards.iter().map(|guard| guard.steps() as u64).sum::<u64>();
                match jumps::within(&mut guards, &domain, &mut self.slots).and_then(|left| clipped(left, centre, radius)) {
                    Some(left) => range = left,
                    None => continue,
                }
                domain = Domain::new(range, Some((centre, radius)));
            }
            let code = if code.steps.len() > SHORT {
                let (value, code) = self.narrowed(code, &range);
                if excludes(value, side) {
                    continue;
                }
                code
            } else {
                code
            };
            self.work += SLOPES * code.steps.len() as u64;
            let whole = forward::full(&code, &domain, &mut self.slots);
            let flat = near == 0.0 && excludes(whole.centre, side) && self.flat(&code, &domain, whole.centre);
            if flat || excludes(whole.range, side) {
                continue;
            }
            if whole.jump
                && let Some(pieces) = jumps::parted(&code, &self.slots, &mut self.live)
            {
                open.extend(pieces.into_iter().map(|(code, guard)| {
                    let guards = guards.iter().cloned().chain([Arc::new(guard)]).collect();
                    Open { near, range, code: Arc::new(code), guards }
                }));
                continue;
            }
            let slots = &self.slots;
            let code = code.shorter(|i| slots.get(i).map_or(Interval::ALL, |s| s.range), &mut self.room).map_or(code, Arc::new);
            let guess = nearest_fall(&domain, &whole.gradient.map(Interval::middle), centre, radius, side);
            for (at, known) in [(domain.middle, Some(whole.centre)), (guess, None)] {
                if far(centre, at) >= radius {
                    continue;
                }
                let here = Domain::new(at.map(Interval::point), None);
                // The code tells of points in its piece only.
                if guards.iter().any(|guard| guard.side(&here, &mut self.slots) != Side::Inside) {
                    continue;
                }
                let other = match known {
                    Some(value) => excludes(value, -side),
                    None => self.sign(&code, at) == -side,
                };
                // Where conditions meet, a piece may be one that no point is in; the field itself has the last word.
                if other && self.sign(&root, at) == -side {
                    found = self.closer(&root, found, centre, at, side, close.is_some());
                    let Some(close) = close else { return found };
                    radius = radius.min(found.at_most * (1.0 - close));
                }
            }
            // What is left is where the field can have come down to zero.
            let zero = Interval { lo: if side > 0 { f64::NEG_INFINITY } else { 0.0 }, hi: if side > 0 { 0.0 } else { f64::INFINITY } };
            let held = if whole.jump { Some(range) } else { domain.holding(whole.centre, &whole.gradient, zero) };
            let Some(range) = held.and_then(|held| clipped(held, centre, radius)) else { continue };
            let scale = radius.max(centre.iter().fold(0.0, |s: f64, c| s.max(c.abs())));
            let [first, second] = halves(&range, &whole.gradient);
            for half in [first, second] {
                let near = nearest(&half, centre);
                if half.iter().all(|x| x.width() <= NARROW * scale) {
                    aside = aside.min(near);
                } else if near < radius {
                    open.push(Open { near, range: half, code: code.clone(), guards: guards.clone() });
                }
            }
        }
        found.at_least = radius.min(aside);
        found
    }

    /// Whether no piece of the field is steep enough anywhere in a domain that is the ball's cube to bring it from its value at the ball's
    /// centre to zero within the ball.
    fn flat(&mut self, code: &Code, domain: &Domain<3>, value: Interval) -> bool {
        let Some(radius) = domain.whole_ball() else { return false };
        let reaches = |norm: f64, jump: bool| jump || norm.is_nan() || norm * radius * (1.0 + 8.0 * f64::EPSILON) >= value.mignitude();
        let whole = self.slots.last().copied().unwrap_or(Slot::ZERO);
        if !reaches(whole.norm, whole.jump) {
            return true;
        }
        let mut flat = true;
        let looked = self.branches.each(code, &self.slots, BRANCHES, |piece| {
            flat &= !reaches(piece.norm, piece.jump);
            flat
        });
        self.work += SLOPES * looked;
        flat
    }

    /// With `polish`, walks from a point of the other side toward the surface's nearest point: the crossing of the segment from the centre,
    /// then that along the normal there, and again.
    fn closer(&mut self, root: &Code, mut found: Distance, centre: [f64; 3], beyond: [f64; 3], side: i8, polish: bool) -> Distance {
        let mut at = beyond;
        for _ in 0..if polish { 6 } else { 1 } {
            // The nearest place on the segment that is certainly beyond.
            let (mut before, mut after) = (0.0, 1.0);
            for _ in 0..if polish { 50 } else { 0 } {
                let middle = 0.5 * (before + after);
                let place = between(centre, at, middle);
                if self.sign(root, place) == -side { after = middle } else { before = middle }
            }
            at = between(centre, at, after);
            let distance = far(centre, at);
            if distance >= found.at_most {
                break;
            }
            found = Distance { at_most: distance, beyond: at, ..found };
            if !polish {
                break;
            }
            self.work += SLOPES * root.steps.len() as u64;
            let here = forward::full(root, &Domain::new(at.map(Interval::point), None), &mut self.slots);
            let gradient = here.gradient.map(Interval::middle);
            let size = gradient.iter().map(|g| g * g).sum::<f64>().sqrt();
            if size.is_nan() || size <= 1e-12 || !size.is_finite() {
                break;
            }
            let step = -f64::from(side) * distance / size;
            at = centre;
            at.iter_mut().zip(gradient).for_each(|(x, g)| *x += step * g);
            if self.sign(root, at) != -side {
                break;
            }
        }
        found
    }
}

fn excludes(value: Interval, side: i8) -> bool {
    if side > 0 { value.lo > 0.0 } else { value.hi < 0.0 }
}

/// The least box that holds what of a box lies in a ball; none where nothing does.
fn clipped(mut range: Box3, centre: [f64; 3], radius: f64) -> Option<Box3> {
    let square = |x: f64| x * x * (1.0 - 4.0 * f64::EPSILON);
    let mut away = [0.0; 3];
    for ((away, side), c) in away.iter_mut().zip(&range).zip(centre) {
        *away = square((side.lo - c).max(c - side.hi).max(0.0));
    }
    let all = away.iter().sum::<f64>();
    for ((side, c), own) in range.iter_mut().zip(centre).zip(away) {
        let half = (radius * radius - (all - own)).max(0.0).sqrt() * (1.0 + 8.0 * f64::EPSILON) + 8.0 * f64::EPSILON * radius;
        *side = side.intersect(Interval::outward(c - half, c + half));
    }
    range.iter().all(|x| !x.is_empty()).then_some(range)
}

fn between(from: [f64; 3], to: [f64; 3], part: f64) -> [f64; 3] {
    let mut at = from;
    at.iter_mut().zip(to).for_each(|(x, end)| *x += part * (end - *x));
    at
}

/// The distance of two points, rounded up.
fn far(a: [f64; 3], b: [f64; 3]) -> f64 {
    let square = a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum::<f64>();
    square.sqrt() * (1.0 + 8.0 * f64::EPSILON)
}

/// The distance of a point from a box, rounded down.
fn nearest(range: &Box3, from: [f64; 3]) -> f64 {
    let square = range.iter().zip(from).map(|(side, x)| (side.lo - x).max(x - side.hi).max(0.0).powi(2)).sum::<f64>();
    square.sqrt() * (1.0 - 8.0 * f64::EPSILON)
}

/// Where in the domain the field is likely to change its sign, if anywhere: the ball's point farthest down its slope, held within the box.
fn nearest_fall(domain: &Domain<3>, slope: &[f64; 3], centre: [f64; 3], radius: f64, side: i8) -> [f64; 3] {
    let size = slope.iter().map(|g| g * g).sum::<f64>().sqrt();
    let mut at = domain.middle;
    if size > 0.0 && size.is_finite() {
        let step = -f64::from(side) * radius * (1.0 - 1e-9) / size;
        for (((at, c), g), side) in at.iter_mut().zip(centre).zip(slope).zip(&domain.range) {
            *at = (c + step * g).clamp(side.lo, side.hi);
        }
    }
    at
}

/// A box cut in two, across the axis along which not knowing the gradient costs most.
pub(super) fn halves(range: &Box3, gradient: &[Interval; 3]) -> [Box3; 2] {
    let known = gradient.iter().all(|g| g.is_finite());
    let cost = |i: usize| {
        let width = range.get(i).map_or(0.0, |x| x.width());
        // No axis is left long for ever.
        let unsure = gradient.get(i).map_or(0.0, |g| g.width() + 0.02 * g.magnitude());
        if known { width * (unsure + 1e-3) } else { width }
    };
    let axis = (0..3).max_by(|&i, &j| cost(i).total_cmp(&cost(j))).unwrap_or(0);
    cut(range, axis)
}

/// A box cut in two across an axis, a little off its middle, so that no symmetric scene has its kinks on the cuts.
pub(super) fn cut(range: &Box3, axis: usize) -> [Box3; 2] {
    let (mut first, mut second) = (*range, *range);
    if let (Some(a), Some(b)) = (first.get_mut(axis), second.get_mut(axis)) {
        let at = a.lo + 0.493 * a.width();
        a.hi = at;
        b.lo = at;
    }
    [first, second]
}
