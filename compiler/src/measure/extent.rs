//! The box about what is solid, each side between two numbers: nothing solid lies beyond the one, and a point of the solid was found at the other.
//!
//! For each side boxes are looked at that may hold the solid, the outermost first. Half of what stands out beyond the outermost solid point so far
//! is cut off where it is proven to be empty; else the box is halved. So only boxes at the outermost places become small. The search begins with what a
//! mesh has found, and with how far out the solid goes on beside that.

#![allow(clippy::indexing_slicing)] // Every index is that of an axis.

use crate::certify::{Box3, Prover, Truth};
use crate::graph::interval::Interval;
use crate::spread::spread;
use crate::vector::{Vec3, along};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// As a part of the box's longest side, a side is known well enough.
const NEAR: f64 = 1e-9;
/// Boxes that are looked at for a side.
const BOXES: u64 = 40_000;
/// Operations over boxes that they may take.
const WORK: u64 = 500_000_000;

/// One of the six sides of a box.
#[derive(Clone, Copy)]
struct Side {
    axis: usize,
    /// Above zero for the upper side.
    sign: f64,
}

impl Side {
    /// How far out a box reaches.
    fn reach(self, range: &Box3) -> f64 {
        let side = range[self.axis];
        if self.sign > 0.0 { side.hi } else { -side.lo }
    }

    /// What of a box is farther out than this.
    fn beyond(self, mut range: Box3, out: f64) -> Box3 {
        let side = &mut range[self.axis];
        if self.sign > 0.0 { side.lo = side.lo.max(out) } else { side.hi = side.hi.min(-out) }
        range
    }

    /// What of a box is not farther out than this.
    fn inside(self, mut range: Box3, out: f64) -> Box3 {
        let side = &mut range[self.axis];
        if self.sign > 0.0 { side.hi = side.hi.min(out) } else { side.lo = side.lo.max(-out) }
        range
    }
}

/// A box that may hold the solid. The greatest reaches out farthest.
struct Open(f64, Box3);

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
        self.0.total_cmp(&other.0)
    }
}

/// For each axis between which numbers the lower side of the solid within a box lies, and the upper one. None where nothing is solid there.
/// `hints` are points near the solid and ways into it, for each of the six sides.
pub(super) fn extent(truth: &Truth, whole: Box3, hints: &[[Vec3; 2]]) -> Option<[[Interval; 2]; 3]> {
    let sides = [0, 1, 2, 3, 4, 5].map(|i| Side { axis: i / 2, sign: if i % 2 == 0 { -1.0 } else { 1.0 } });
    let found = spread(sides.len(), &|| truth.prover(), &|prover, i| {
        let side = sides[i];
        outermost(prover, whole, side, hints.get(i)).map(|out| if side.sign > 0.0 { out } else { out.neg() })
    });
    let found: Vec<Interval> = found.into_iter().collect::<Option<_>>()?;
    Some([0, 1, 2].map(|axis| [found[2 * axis], found[2 * axis + 1]]))
}

/// How far out the solid within a box reaches: a solid point is as far as the lower end, and none is beyond the upper one. None where nothing is solid.
fn outermost(prover: &mut Prover<'_>, whole: Box3, side: Side, hint: Option<&[Vec3; 2]>) -> Option<Interval> {
    let near = NEAR * whole.iter().fold(0.0, |most: f64, side| most.max(side.width()));
    let (boxes, work) = (prover.boxes(), prover.work());
    let mut found = hint.and_then(|[place, inward]| climbed(prover, whole, side, *place, *inward, near));
    let mut open = BinaryHeap::from([Open(side.reach(&whole), whole)]);
    while let Some(Open(reach, range)) = open.pop() {
        let least = found.unwrap_or(f64::NEG_INFINITY);
        let spent = prover.boxes() - boxes >= BOXES || prover.work() - work >= WORK;
        if reach - least <= near || spent {
            // The opposite side where no solid point was found: nothing is known of it then.
            let opposite = side.reach(&whole) - whole[side.axis].width();
            return Some(Interval::new(found.unwrap_or(opposite), reach));
        }
        let range = side.beyond(range, least);
        if is_empty(prover.range(range)) {
            continue;
        }
        let half = reach - 0.5 * range[side.axis].width();
        let outer = side.beyond(range, half);
        if is_empty(prover.range(outer)) {
            open.push(Open(half, side.inside(range, half)));
            continue;
        }
        let middle = outer.map(Interval::middle);
        if let Some(out) = solid_out(prover, middle, side, reach, near) {
            found = Some(found.map_or(out, |found| found.max(out)));
        }
        open.extend(halves(range).into_iter().map(|half| Open(side.reach(&half), half)));
    }
    // All that was left lies no farther out than a solid point.
    found.map(Interval::point)
}

/// From a point at the surface as far out as another, and then to all sides of that, as long as the solid goes farther out there.
fn climbed(prover: &mut Prover<'_>, whole: Box3, side: Side, place: Vec3, inward: Vec3, near: f64) -> Option<f64> {
    /// Parts of a cell that are stepped inward.
    const INWARD: [f64; 5] = [1e-6, 1e-4, 1e-2, 0.1, 0.5];
    const STEPS: usize = 400;
    let held = |p: &Vec3| p.iter().zip(&whole).all(|(c, side)| side.contains(*c));
    let mut at = INWARD.iter().map(|part| along(place, inward, *part)).find(|p| held(p) && prover.value(*p) < 0.0)?;
    let reach = side.reach(&whole);
    let mut best = solid_out(prover, at, side, reach, near)?;
    let mut step = crate::vector::length(inward);
    let across = [(side.axis + 1) % 3, (side.axis + 2) % 3];
    for _ in 0..STEPS {
        if step < near {
            break;
        }
        let mut better = false;
        for (axis, sign) in across.into_iter().flat_map(|axis| [(axis, -1.0), (axis, 1.0)]) {
            let mut beside = at;
            beside[axis] += sign * step;
            // From a little within: the solid falls off to the sides.
            beside[side.axis] = side.sign * (best - step.min(0.25 * whole[side.axis].width()));
            if !whole[axis].contains(beside[axis]) {
                continue;
            }
            if let Some(out) = solid_out(prover, beside, side, reach, near)
                && out > best
            {
                (best, at, better) = (out, beside, true);
            }
        }
        step *= if better { 1.0 } else { 0.5 };
    }
    Some(best)
}

/// From a solid point, how far out the solid goes on, up to `reach`; none where the point is not surely solid.
fn solid_out(prover: &mut Prover<'_>, from: [f64; 3], side: Side, reach: f64, near: f64) -> Option<f64> {
    let at = |out: f64| {
        let mut point = from;
        point[side.axis] = side.sign * out;
        point
    };
    let start = side.sign * from[side.axis];
    if prover.value(from) >= 0.0 {
        return None;
    }
    let (mut solid, mut not) = (start, reach);
    if prover.value(at(reach)) < 0.0 {
        solid = reach;
    }
    while not - solid > 0.25 * near {
        let middle = 0.5 * (solid + not);
        if middle <= solid || middle >= not {
            break;
        }
        if prover.value(at(middle)) < 0.0 { solid = middle } else { not = middle }
    }
    // Numbers of 64 bits are no proof: intervals are.
    let surely = |prover: &mut Prover<'_>, out: f64| prover.range(at(out).map(Interval::point)).hi < 0.0;
    [solid, solid - 0.25 * near, start].into_iter().filter(|out| *out >= start).find(|out| surely(prover, *out))
}

/// Whether nothing in a range is solid.
fn is_empty(values: Interval) -> bool {
    values.lo >= 0.0
}

/// A box cut in two across its longest side, a little off the middle: what people write is symmetric.
fn halves(range: Box3) -> [Box3; 2] {
    let axis = (0..3).max_by(|a, b| range[*a].width().total_cmp(&range[*b].width())).unwrap_or(0);
    let at = range[axis].lo + 0.493 * range[axis].width();
    let (mut first, mut second) = (range, range);
    first[axis].hi = at;
    second[axis].lo = at;
    [first, second]
}
