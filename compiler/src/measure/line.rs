//! What a line meets: where the solid begins and ends along it.

use crate::certify::{Box3, Hit, Truth};
use crate::graph::interval::Interval;
use crate::vector::{Vec3, along, length, sub};

/// Segments that are looked at for each place where the line enters or leaves.
const BUDGET: usize = 200_000;
/// Places where it does, at most.
const MOST: usize = 10_000;
/// What a place is known to, times the largest of one, the way and the coordinates ([`Hit::Hit`]).
const NEAR: f64 = 1e-10;

/// A part of a line that is all solid or all air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Way {
    /// How far from the line's beginning it begins.
    pub from: f64,
    /// And where it ends.
    pub to: f64,
    /// Whether it is solid.
    pub solid: bool,
}

/// A line through a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Its ends.
    pub ends: [Vec3; 2],
    /// How long it is.
    pub length: f64,
    /// Its parts in order.
    pub ways: Vec<Way>,
    /// Each end of a part is known to this.
    pub error: f64,
    /// From here on nothing is known; the whole length where everything is.
    pub known_to: f64,
    /// Places at which the field comes so near to zero that it may touch the surface, or not.
    pub touches: Vec<f64>,
}

/// Follows a line; outside of the box there is air.
pub(super) fn line(truth: &Truth, ends: [Vec3; 2], whole: Box3) -> Line {
    let mut prover = truth.prover();
    let (from, way) = (ends[0], sub(ends[1], ends[0]));
    let long = length(way);
    let unit = way.map(|c| c / long.max(f64::MIN_POSITIVE));
    let scale = ends.iter().flatten().fold(long.max(1.0), |most, c| most.max(c.abs()));
    let mut found = Line { ends, length: long, ways: Vec::new(), error: NEAR * scale, known_to: long, touches: Vec::new() };
    // The part within the box.
    let (mut near, mut far) = (0.0f64, long);
    for ((side, from), slope) in whole.iter().zip(from).zip(unit) {
        if slope == 0.0 {
            if !side.contains(from) {
                far = f64::NEG_INFINITY;
            }
            continue;
        }
        let (a, b) = ((side.lo - from) / slope, (side.hi - from) / slope);
        (near, far) = (near.max(a.min(b)), far.min(a.max(b)));
    }
    if near >= far {
        found.add(long, false);
        return found;
    }
    found.add(near, false);
    let step = 2.0 * found.error;
    let mut at = near;
    for _ in 0..MOST {
        match prover.first_hit(from, unit, at, far, BUDGET) {
            // What 64 bits can't tell is a touch if it is solid on both sides, or on none.
            Hit::Hit(place) | Hit::Ambiguous(place) => {
                if place - at > step {
                    let solid = prover.range(along(from, unit, 0.5 * (at + place)).map(Interval::point)).hi < 0.0;
                    found.add(place, solid);
                }
                at = place.max(at) + step;
            }
            Hit::Miss => {
                let solid = prover.range(along(from, unit, 0.5 * (at + far)).map(Interval::point)).hi < 0.0;
                found.add(far, solid);
                at = far;
            }
            Hit::Exhausted(place) => {
                found.known_to = place;
                return found;
            }
        }
        if at >= far {
            let touches = std::mem::take(&mut found.touches);
            found.add(long, false);
            return Line { touches: touches.into_iter().filter(|touch| *touch > near).collect(), ..found };
        }
    }
    found.known_to = at;
    found
}

impl Line {
    /// How much of it is solid.
    pub fn solid(&self) -> f64 {
        self.ways.iter().filter(|way| way.solid).map(|way| way.to - way.from).sum()
    }

    /// Goes on to a place.
    fn add(&mut self, to: f64, solid: bool) {
        let from = self.ways.last().map_or(0.0, |way| way.to);
        match self.ways.last_mut() {
            _ if to <= from => {}
            Some(last) if last.solid == solid => {
                self.touches.push(from);
                last.to = to;
            }
            _ => self.ways.push(Way { from, to, solid }),
        }
    }
}
