//! From closed contours that may cross each other to what bounds the filled region: each piece once, with the fill at its left.

use super::curve::{Curve, Vec2, add, cross, dot, length, mix, scale, sub, unit};
use std::collections::{BTreeMap, BTreeSet};

/// What of the plane contours fill.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fill {
    /// What they wind around, in either direction.
    NonZero,
    /// What they wind around an odd number of times.
    EvenOdd,
    /// What they wind around twice or more: of two boundaries, each with its fill at its left, what both hold.
    Both,
}

impl Fill {
    fn holds(self, winding: i32) -> bool {
        match self {
            Fill::NonZero => winding != 0,
            Fill::EvenOdd => winding % 2 != 0,
            Fill::Both => winding >= 2,
        }
    }
}

/// The most curves that a path may have.
pub const MOST_CURVES: usize = 40_000;
/// The most steps of the search for crossings of two curves. Curves that lie on each other would cross everywhere.
const MOST_LOOKS: usize = 100_000;
/// The most steps of all of these searches together, and the most places where a curve is divided: a drawing of more is no drawing.
const MOST_LOOKS_OF_ALL: usize = 20_000_000;
const MOST_CUTS: usize = 80_000;
/// Places are multiples of a unit that the size of the drawing holds so many times: 32 bits hold them exactly.
const UNITS: f64 = 4_194_304.0;
/// A curve is straight where its middle is so many units from the chord's.
const STRAIGHT: f64 = 0.1;

/// A part of the boundary, with the directions that say on which side of its ends a point is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Its curve; the fill is at its left.
    pub curve: Curve,
    /// For each end the mean of the directions of both pieces that meet there, with length one (Bærentzen and Aanæs 2005, in two dimensions).
    pub joints: [Vec2; 2],
}

/// The boundary of what the contours fill; each contour is closed. Where curves cross too often, the words that say so.
pub fn boundary(contours: &[Vec<Curve>], fill: Fill) -> Result<Vec<Piece>, String> {
    let size = contours.iter().flatten().flat_map(|curve| [curve.a, curve.b, curve.c]).flatten().fold(0.0, |size: f64, c| size.max(c.abs()));
    if size.is_nan() || size <= 0.0 || size > 1e30 {
        return Ok(Vec::new());
    }
    let quantum = (size.log2().ceil()).exp2() / UNITS;
    let mut left = [MOST_LOOKS_OF_ALL, MOST_CUTS];
    let mut all = Vec::new();
    for group in groups(contours) {
        all.append(&mut sided(&group, fill, quantum, &mut left).ok_or("its curves cross each other too often")?);
    }
    Ok(joined(all))
}

/// Contours that may meet: those of other groups lie beside the rectangle of each, so that they wind around nothing of it.
fn groups(contours: &[Vec<Curve>]) -> Vec<Vec<&Curve>> {
    let corner = |contour: &[Curve]| contour.iter().map(Curve::bounds).reduce(|[a, b], [c, d]| [[a[0].min(c[0]), a[1].min(c[1])], [b[0].max(d[0]), b[1].max(d[1])]]);
    let mut boxes: Vec<([Vec2; 2], &[Curve])> = contours.iter().filter_map(|contour| Some((corner(contour)?, contour.as_slice()))).collect();
    boxes.sort_by(|(a, _), (b, _)| a[0][0].total_cmp(&b[0][0]));
    // Groups that the sweep from left to right has not passed, with their rectangles; and those that it has.
    let mut open: Vec<([Vec2; 2], Vec<&Curve>)> = Vec::new();
    let mut closed: Vec<Vec<&Curve>> = Vec::new();
    for (mut bounds, contour) in boxes {
        let mut group: Vec<&Curve> = contour.iter().collect();
        let mut left = Vec::with_capacity(open.len());
        for (other, curves) in open {
            if other[1][0] < bounds[0][0] {
                closed.push(curves);
            } else {
                left.push((other, curves));
            }
        }
        // A group that has grown may meet others.
        while let Some(at) = left.iter().position(|(other, _)| other[0][1] <= bounds[1][1] && other[1][1] >= bounds[0][1]) {
            let (other, curves) = left.swap_remove(at);
            bounds = [[bounds[0][0].min(other[0][0]), bounds[0][1].min(other[0][1])], [bounds[1][0].max(other[1][0]), bounds[1][1].max(other[1][1])]];
            group.extend(curves);
        }
        left.push((bounds, group));
        open = left;
    }
    closed.extend(open.into_iter().map(|(_, curves)| curves));
    closed
}

/// The pieces of some contours that have the fill on one side, which is turned to the left; their joints are their own directions.
/// None where curves cross more often than is left.
fn sided(contours: &[&Curve], fill: Fill, quantum: f64, left: &mut [usize; 2]) -> Option<Vec<Piece>> {
    let round = |p: Vec2| p.map(|c| (c / quantum).round() * quantum);
    let gentle = contours.iter().flat_map(|curve| curve.gentle());
    let rounded = gentle.map(|curve| Piece { curve: Curve { a: round(curve.a), b: curve.b, c: round(curve.c) }, joints: curve.ends() });
    let whole: Vec<Piece> = rounded.filter(|piece| piece.curve.a != piece.curve.c).collect();
    let parts = divided(&whole, quantum, round, left)?;
    let curves: Vec<Curve> = parts.iter().map(|piece| piece.curve).collect();
    let bins = Bins::new(&curves);
    let mut seen = BTreeSet::new();
    let mut kept = Vec::new();
    for piece in parts {
        let curve = piece.curve;
        let (middle, along) = (curve.at(0.5), unit(curve.tangent(0.5)).unwrap_or([1.0, 0.0]));
        let beside = |side: f64| add(middle, scale([-along[1], along[0]], side * 1e-3 * quantum));
        let [left, right] = [1.0, -1.0].map(|side| fill.holds(bins.winding(&curves, beside(side))));
        if left == right {
            continue;
        }
        let piece = if left { piece } else { Piece { curve: curve.reversed(), joints: [scale(piece.joints[1], -1.0), scale(piece.joints[0], -1.0)] } };
        let curve = piece.curve;
        // Two that lie on each other count once.
        let place = |p: Vec2| p.map(|c| (c / quantum).round() as i64);
        let key = (place(curve.a), place(curve.c), place(scale(curve.at(0.5), 0.25)));
        if seen.insert(key) {
            kept.push(piece);
        }
    }
    Some(kept)
}

/// The pieces, divided where they meet others. Their directions at the ends are those of the curves before any place is rounded.
fn divided(pieces: &[Piece], quantum: f64, round: impl Fn(Vec2) -> Vec2, left: &mut [usize; 2]) -> Option<Vec<Piece>> {
    let bounds: Vec<[Vec2; 2]> = pieces.iter().map(|piece| piece.curve.bounds()).collect();
    let mut order: Vec<usize> = (0..pieces.len()).collect();
    let low = |i: usize| bounds.get(i).map_or(0.0, |b| b[0][0]);
    order.sort_unstable_by(|i, j| low(*i).total_cmp(&low(*j)));
    // For each curve where along it, and at which place, it meets another one.
    let mut cuts: Vec<Vec<(f64, Vec2)>> = vec![Vec::new(); pieces.len()];
    for (at, &i) in order.iter().enumerate() {
        let (Some(first), Some([a, b])) = (pieces.get(i).map(|piece| &piece.curve), bounds.get(i)) else { continue };
        for &j in order.iter().skip(at + 1) {
            let (Some(second), Some([c, d])) = (pieces.get(j).map(|piece| &piece.curve), bounds.get(j)) else { continue };
            if c[0] > b[0] {
                break;
            }
            if c[1] > b[1] || d[1] < a[1] {
                continue;
            }
            if first == second || *first == second.reversed() {
                continue;
            }
            let mut found = Crossings { quantum, looks: 0, found: Vec::new() };
            found.search(first, [0.0, 1.0], second, [0.0, 1.0]);
            left[0] = left[0].checked_sub(found.looks)?;
            for (s, t) in found.found {
                let place = round(mix(first.at(s), second.at(t), 0.5));
                for (curve, which, along) in [(first, i, s), (second, j, t)] {
                    if place != curve.a
                        && place != curve.c
                        && let Some(cuts) = cuts.get_mut(which)
                    {
                        cuts.push((along, place));
                        left[1] = left[1].checked_sub(1)?;
                    }
                }
            }
        }
    }
    let mut parts = Vec::with_capacity(pieces.len());
    for (piece, mut cuts) in pieces.iter().zip(cuts) {
        cuts.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let (mut rest, mut from) = (*piece, 0.0);
        for (along, place) in cuts {
            let share = ((along - from) / (1.0 - from)).clamp(0.0, 1.0);
            let [mut before, mut after] = rest.curve.split(share);
            let direction = unit(piece.curve.tangent(along)).unwrap_or(rest.joints[1]);
            (before.c, after.a) = (place, place);
            if before.a != before.c {
                parts.push(Piece { curve: before, joints: [rest.joints[0], direction] });
                (rest, from) = (Piece { curve: after, joints: [direction, rest.joints[1]] }, along);
            }
        }
        if rest.curve.a != rest.curve.c {
            parts.push(rest);
        }
    }
    Some(parts)
}

/// Where two curves meet.
struct Crossings {
    quantum: f64,
    looks: usize,
    found: Vec<(f64, f64)>,
}

impl Crossings {
    /// Parts of two curves, with where they begin and end along the whole.
    fn search(&mut self, first: &Curve, s: [f64; 2], second: &Curve, t: [f64; 2]) {
        self.looks += 1;
        let ([a, b], [c, d]) = (first.bounds(), second.bounds());
        let near = 0.5 * self.quantum;
        let apart = c[0] > b[0] + near || d[0] < a[0] - near || c[1] > b[1] + near || d[1] < a[1] - near;
        if apart || self.looks > MOST_LOOKS {
            return;
        }
        let bend = |curve: &Curve| length(sub(mix(curve.a, curve.c, 0.5), curve.b));
        let straight = [first, second].map(|curve| bend(curve) < STRAIGHT * self.quantum);
        let middle = |[from, to]: [f64; 2]| 0.5 * (from + to);
        match straight {
            [true, true] => self.lines(first, s, second, t),
            [true, false] => {
                let [before, after] = second.split(0.5);
                self.search(first, s, &before, [t[0], middle(t)]);
                self.search(first, s, &after, [middle(t), t[1]]);
            }
            [false, _] => {
                // The two take turns.
                let [before, after] = first.split(0.5);
                let swapped = &mut Crossings { quantum: self.quantum, looks: self.looks, found: Vec::new() };
                swapped.search(second, t, &before, [s[0], middle(s)]);
                swapped.search(second, t, &after, [middle(s), s[1]]);
                self.looks = swapped.looks;
                self.found.extend(swapped.found.iter().map(|(t, s)| (*s, *t)));
            }
        }
    }

    /// Two straight parts: they cross, or an end of one lies on the other.
    fn lines(&mut self, first: &Curve, s: [f64; 2], second: &Curve, t: [f64; 2]) {
        let (along, across, between) = (sub(first.c, first.a), sub(second.c, second.a), sub(second.a, first.a));
        let whole = |[from, to]: [f64; 2], share: f64| from + (to - from) * share;
        let area = cross(along, across);
        let (u, v) = (cross(between, across) / area, cross(between, along) / area);
        if area != 0.0 && (0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&v) {
            self.found.push((whole(s, u), whole(t, v)));
        }
        for (share, end) in [(0.0, second.a), (1.0, second.c)] {
            if let Some(on) = self.on(first, end) {
                self.found.push((whole(s, on), whole(t, share)));
            }
        }
        for (share, end) in [(0.0, first.a), (1.0, first.c)] {
            if let Some(on) = self.on(second, end) {
                self.found.push((whole(s, share), whole(t, on)));
            }
        }
    }

    /// Where along a straight part a place lies that is on it.
    fn on(&self, line: &Curve, place: Vec2) -> Option<f64> {
        let (along, from) = (sub(line.c, line.a), sub(place, line.a));
        let share = dot(from, along) / dot(along, along).max(1e-300);
        let off = length(sub(from, scale(along, share)));
        (off <= 0.5 * self.quantum && (0.0..=1.0).contains(&share)).then_some(share)
    }
}

/// Curves by the heights that they reach, for rays to the right.
struct Bins {
    low: f64,
    per: f64,
    bins: Vec<Vec<usize>>,
}

impl Bins {
    fn new(curves: &[Curve]) -> Self {
        let heights = |curve: &Curve| curve.bounds().map(|corner| corner[1]);
        let low = curves.iter().map(|curve| heights(curve)[0]).fold(f64::INFINITY, f64::min);
        let high = curves.iter().map(|curve| heights(curve)[1]).fold(f64::NEG_INFINITY, f64::max);
        let count = (curves.len() / 4).clamp(1, 4_096);
        let per = if high > low { count as f64 / (high - low) } else { 0.0 };
        let mut bins = Self { low, per, bins: vec![Vec::new(); count] };
        for (i, curve) in curves.iter().enumerate() {
            let [from, to] = heights(curve).map(|y| bins.at(y));
            for bin in bins.bins.iter_mut().take(to + 1).skip(from) {
                bin.push(i);
            }
        }
        bins
    }

    fn at(&self, y: f64) -> usize {
        (((y - self.low) * self.per).max(0.0) as usize).min(self.bins.len().saturating_sub(1))
    }

    /// How often the curves wind around a point.
    fn winding(&self, curves: &[Curve], p: Vec2) -> i32 {
        let near = self.bins.get(self.at(p[1])).into_iter().flatten();
        near.filter_map(|i| curves.get(*i)).map(|curve| curve.winding(p)).sum()
    }
}

/// The pieces with what their ends have in common; until then the joints of each are its own directions.
fn joined(mut pieces: Vec<Piece>) -> Vec<Piece> {
    let key = |p: Vec2| p.map(|c| (c + 0.0).to_bits());
    let own: Vec<[Vec2; 2]> = pieces.iter().map(|piece| piece.joints).collect();
    let direction = |i: usize| own.get(i).copied().unwrap_or_default();
    let mut begins: BTreeMap<[u64; 2], Vec<usize>> = BTreeMap::new();
    for (i, piece) in pieces.iter().enumerate() {
        begins.entry(key(piece.curve.a)).or_default().push(i);
    }
    for i in 0..pieces.len() {
        let Some(next) = pieces.get(i).and_then(|piece| begins.get_mut(&key(piece.curve.c))) else { continue };
        let into = direction(i)[1];
        // Where several pieces meet, the one that turns most to the left bounds the same part of the fill.
        let turn = |j: &usize| cross(into, direction(*j)[0]).atan2(dot(into, direction(*j)[0]));
        let chosen = next.iter().enumerate().max_by(|(_, a), (_, b)| turn(a).total_cmp(&turn(b))).map(|(at, j)| (at, *j));
        let Some((at, j)) = chosen else { continue };
        next.swap_remove(at);
        // Where the way turns back, the side is that of both.
        let both = unit(add(into, direction(j)[0])).unwrap_or(into);
        for (which, end) in [(i, 1), (j, 0)] {
            if let Some(joint) = pieces.get_mut(which).and_then(|piece| piece.joints.get_mut(end)) {
                *joint = both;
            }
        }
    }
    pieces
}
