//! An outline: what bounds a region of the plane, in cells that know which pieces are nearest somewhere in them.

use super::clean::Piece;
use super::curve::{Curve, Vec2, add, cross, length, scale, sub};
use crate::kept::{Data, HEAD, Known};
use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, PI};

/// Words of a place where a piece begins, or where the last of a chain ends. They hold the place, where the piece's tangents meet, and the joint's direction.
const PLACE: usize = 6;
/// Cells for each piece of a small outline, which may stand in a text, and of a large one: smaller cells have shorter lists.
const CELLS: [f64; 2] = [3.0, 12.0];
/// An outline of so many pieces is large.
const MANY: usize = 500;
/// The fewest and the most cells.
const FEWEST: f64 = 64.0;
const MOST: f64 = 131_072.0;
/// How far cells reach beyond the outline: so many times its shorter side.
const MARGIN: f64 = 0.5;
/// Bits of a run for how many pieces it has, and the most that it has.
const RUN: u32 = 8;
const LONGEST: u32 = (1 << RUN) - 1;
/// How often a cell is divided to find the pieces of its list.
const HALVINGS: usize = 2;
/// A rectangle over more cells may have any gradient.
const MOST_LOOKED_AT: usize = 16;
/// Nearer to an end than this, along a piece, the direction of the joint tells the sides apart.
const END: f64 = 1e-5;

/// A region of the plane with its signed distance, below zero inside.
///
/// A cell is divided into parts, and its list has what may be nearest somewhere in one of them. Those are the pieces whose way to the part's middle is longer
/// than the least one by at most the part's diagonal: along half a diagonal no way changes by more than that half.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    pieces: Vec<Piece>,
    /// The region's own rectangle.
    from: Vec2,
    to: Vec2,
    /// That of the cells.
    low: Vec2,
    high: Vec2,
    /// The side of a cell; cells are squares.
    cell: f64,
    counts: [usize; 2],
    /// Where each cell's list begins, x first.
    cells: Vec<u32>,
    /// The lists: how many runs, and the runs.
    lists: Vec<u32>,
    content: u64,
}

/// What is nearest to a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// The signed distance.
    pub value: f64,
    /// How it changes along x and y.
    pub gradient: Vec2,
}

impl Outline {
    /// Of the pieces of a boundary; none where there are none.
    pub fn new(pieces: Vec<Piece>) -> Option<Self> {
        let single = |p: Vec2| p.map(|c| f64::from(c as f32));
        let pieces: Vec<Piece> = pieces
            .into_iter()
            .map(|Piece { curve, joints }| Piece { curve: Curve { a: single(curve.a), b: single(curve.b), c: single(curve.c) }, joints: joints.map(single) })
            .collect();
        if pieces.is_empty() {
            return None;
        }
        let bounds: Vec<[Vec2; 2]> = pieces.iter().map(|piece| piece.curve.bounds()).collect();
        let of = |pick: fn(f64, f64) -> f64, end: usize| {
            let corner = |b: &[Vec2; 2]| if end == 0 { b[0] } else { b[1] };
            bounds.iter().map(corner).reduce(|a, b| [pick(a[0], b[0]), pick(a[1], b[1])])
        };
        let (from, to) = (of(f64::min, 0)?, of(f64::max, 1)?);
        let size = sub(to, from);
        let margin = MARGIN * size[0].min(size[1]);
        let (low, high) = (single(from.map(|c| c - margin)), to.map(|c| c + margin));
        let [wide, tall] = sub(high, low);
        let cells = if pieces.len() < MANY { CELLS[0] } else { CELLS[1] };
        let cell = f64::from(((wide * tall / (cells * pieces.len() as f64).clamp(FEWEST, MOST)).sqrt()) as f32);
        let counts = [wide, tall].map(|side| (side / cell).ceil().clamp(1.0, MOST) as usize);
        let mut outline = Self { pieces, from, to, low, high, cell, counts, cells: vec![0; counts[0] * counts[1]], lists: Vec::new(), content: 0 };
        outline.high = outline.corner(counts);
        let all: Vec<u32> = (0..outline.pieces.len() as u32).collect();
        outline.fill([0, 0], counts, &all, &mut BTreeMap::new());
        outline.content = outline.hash();
        Some(outline)
    }

    fn corner(&self, [i, j]: [usize; 2]) -> Vec2 {
        add(self.low, scale([i as f64, j as f64], self.cell))
    }

    /// Which of these pieces may be nearest somewhere in a rectangle.
    fn nearest_in(&self, low: Vec2, high: Vec2, pieces: &[u32]) -> Vec<u32> {
        let (middle, half) = (scale(add(low, high), 0.5), 0.5 * length(sub(high, low)));
        let way = |i: &u32| self.pieces.get(*i as usize).map_or(f64::INFINITY, |piece| piece.curve.nearest(middle).1.sqrt());
        let ways: Vec<f64> = pieces.iter().map(way).collect();
        let least = ways.iter().copied().fold(f64::INFINITY, f64::min);
        // What is lost in 32 bits is little of the cell's size.
        let reach = least + 2.0 * half * (1.0 + 1e-3) + 1e-6 * least;
        pieces.iter().zip(&ways).filter(|(_, way)| **way <= reach).map(|(i, _)| *i).collect()
    }

    /// The same, found for each quarter of the rectangle alone, so many times over.
    fn in_quarters(&self, low: Vec2, high: Vec2, near: Vec<u32>, depth: usize) -> Vec<u32> {
        if depth == 0 || near.len() <= 2 {
            return near;
        }
        let middle = scale(add(low, high), 0.5);
        let ([x, y], [across, up], [far_x, far_y]) = (low, middle, high);
        let quarters = [(low, middle), ([across, y], [far_x, up]), ([x, up], [across, far_y]), (middle, high)];
        let mut all: Vec<u32> = quarters.into_iter().flat_map(|(low, high)| self.in_quarters(low, high, self.nearest_in(low, high, &near), depth - 1)).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// Fills the cells from one to before another, where no piece but these matters.
    fn fill(&mut self, from: [usize; 2], to: [usize; 2], pieces: &[u32], known: &mut BTreeMap<Vec<u32>, u32>) {
        let (low, high) = (self.corner(from), self.corner(to));
        let near = self.nearest_in(low, high, pieces);
        let sides = [to[0] - from[0], to[1] - from[1]];
        if sides == [1, 1] {
            let near = self.in_quarters(low, high, near, HALVINGS);
            let begin = known.get(&near).copied().unwrap_or_else(|| {
                let begin = self.lists.len() as u32;
                let runs = self.runs(&near);
                self.lists.push(runs.len() as u32);
                self.lists.extend(runs);
                known.insert(near, begin);
                begin
            });
            if let Some(cell) = self.cells.get_mut(from[1] * self.counts[0] + from[0]) {
                *cell = begin;
            }
        } else if sides[0] >= sides[1] {
            let middle = from[0] + sides[0] / 2;
            self.fill(from, [middle, to[1]], &near, known);
            self.fill([middle, from[1]], to, &near, known);
        } else {
            let middle = from[1] + sides[1] / 2;
            self.fill(from, [to[0], middle], &near, known);
            self.fill([from[0], middle], to, &near, known);
        }
    }

    /// Whether a piece begins as the one before it ends.
    fn follows(&self, i: usize) -> bool {
        let [before, piece] = [i.checked_sub(1), Some(i)].map(|i| i.and_then(|i| self.pieces.get(i)));
        before.zip(piece).is_some_and(|(before, piece)| before.curve.c == piece.curve.a && before.joints[1] == piece.joints[0])
    }

    /// Pieces in their order as runs of such as follow each other: the number of the first, shifted, and how many.
    fn runs(&self, pieces: &[u32]) -> Vec<u32> {
        let mut runs: Vec<u32> = Vec::new();
        for &i in pieces {
            match runs.last_mut() {
                Some(run) if (*run >> RUN) + (*run & LONGEST) == i && *run & LONGEST < LONGEST && self.follows(i as usize) => *run += 1,
                _ => runs.push(i << RUN | 1),
            }
        }
        runs
    }

    fn near(&self, q: Vec2) -> impl Iterator<Item = &Piece> {
        let along = |c: f64, low: f64, count: usize| (((c - low) / self.cell).max(0.0) as usize).min(count - 1);
        self.listed(along(q[1], self.low[1], self.counts[1]) * self.counts[0] + along(q[0], self.low[0], self.counts[0]))
    }

    /// The pieces of a cell's list.
    fn listed(&self, cell: usize) -> impl Iterator<Item = &Piece> {
        let begin = self.cells.get(cell).map_or(0, |begin| *begin as usize);
        let count = self.lists.get(begin).map_or(0, |count| *count as usize);
        self.lists.iter().skip(begin + 1).take(count).flat_map(|run| self.pieces.iter().skip((run >> RUN) as usize).take((run & LONGEST) as usize))
    }

    /// The signed distance at a place. Beyond the cells, at t from their rectangle whose nearest place has the value v, it is √(v² + t²), or the way to the region's
    /// own rectangle where that is more. Neither is more than the distance: the way from there to the outline goes around no less than a right angle.
    pub fn at(&self, p: Vec2) -> Nearest {
        let q = [p[0].clamp(self.low[0], self.high[0]), p[1].clamp(self.low[1], self.high[1])];
        let inside = self.within(q);
        let beyond = sub(p, q);
        if beyond == [0.0, 0.0] {
            return inside;
        }
        let value = inside.value.hypot(length(beyond));
        let out = sub(p, [p[0].clamp(self.from[0], self.to[0]), p[1].clamp(self.from[1], self.to[1])]);
        let way = length(out);
        if way > value {
            return Nearest { value: way, gradient: scale(out, 1.0 / way) };
        }
        let held = |i: f64, t: f64| if t == 0.0 { i } else { 0.0 };
        let along = [held(inside.gradient[0], beyond[0]), held(inside.gradient[1], beyond[1])];
        Nearest { value, gradient: scale(add(scale(along, inside.value), beyond), 1.0 / value) }
    }

    fn within(&self, q: Vec2) -> Nearest {
        let mut best = (f64::INFINITY, [0.0; 2], [1.0, 0.0]);
        for piece in self.near(q) {
            let (t, squared) = piece.curve.nearest(q);
            if squared < best.0 {
                let along = if t < END { piece.joints[0] } else if t > 1.0 - END { piece.joints[1] } else { piece.curve.tangent(t) };
                best = (squared, sub(q, piece.curve.at(t)), along);
            }
        }
        let (squared, away, along) = best;
        let (way, side) = (squared.sqrt(), if cross(along, away) > 0.0 { -1.0 } else { 1.0 });
        // On the outline itself, straight out of the fill.
        let out = scale([along[1], -along[0]], 1.0 / length(along).max(1e-30));
        Nearest { value: side * way, gradient: if way > 1e-12 { scale(away, side / way) } else { out } }
    }

    /// Least and greatest corner of a rectangle that holds the region.
    pub fn bounds(&self) -> [Vec2; 2] {
        [self.from, self.to]
    }

    /// What the value lies between in a rectangle of places: no farther from that in its middle than half its diagonal; no more below zero than half the
    /// region's shorter side; and no less than the way to the region's rectangle.
    pub fn value_within(&self, low: Vec2, high: Vec2) -> [f64; 2] {
        let (from, to) = (self.from, self.to);
        let deepest = 0.5 * (to[0] - from[0]).min(to[1] - from[1]);
        let gap = |i: f64, j: f64| i.max(j).max(0.0);
        let away = length([gap(low[0] - to[0], from[0] - high[0]), gap(low[1] - to[1], from[1] - high[1])]);
        let least = if away > 0.0 { away } else { -deepest };
        let size = length(sub(high, low));
        if !size.is_finite() {
            return [least, f64::INFINITY];
        }
        let value = self.at(scale(add(low, high), 0.5)).value;
        let off = 0.5 * size + 1e-9 * (value.abs() + self.size());
        [least.max(value - off).min(value), value + off]
    }

    /// What the gradient's coordinates lie between in a rectangle of places. It is the normal of the nearest piece where that is nearest, and at an end of it lies between
    /// the normals of both pieces that meet there.
    pub fn gradient_within(&self, low: Vec2, high: Vec2) -> [Vec2; 2] {
        const ALL: [Vec2; 2] = [[-1.0, 1.0]; 2];
        let is_inside = low[0] >= self.low[0] && low[1] >= self.low[1] && high[0] <= self.high[0] && high[1] <= self.high[1];
        let along = |c: f64, low: f64, count: usize| (((c - low) / self.cell).max(0.0) as usize).min(count - 1);
        let [from, to] = [low, high].map(|p| [along(p[0], self.low[0], self.counts[0]), along(p[1], self.low[1], self.counts[1])]);
        if !is_inside || (to[0] - from[0] + 1) * (to[1] - from[1] + 1) > MOST_LOOKED_AT {
            return ALL;
        }
        let (middle, size) = (scale(add(low, high), 0.5), length(sub(high, low)));
        let cells = (from[1]..=to[1]).flat_map(|j| (from[0]..=to[0]).map(move |i| j * self.counts[0] + i));
        let pieces: Vec<(&Piece, f64)> = cells.flat_map(|cell| self.listed(cell)).map(|piece| (piece, piece.curve.nearest(middle).1.sqrt())).collect();
        let least = pieces.iter().fold(f64::INFINITY, |least, (_, way)| least.min(*way));
        let reach = least + size * (1.0 + 1e-6) + 1e-6 * least;
        let near = pieces.iter().filter(|(_, way)| *way <= reach).map(|(piece, _)| piece.normals());
        let hull = |[a, b]: [Vec2; 2], [c, d]: [Vec2; 2]| [[a[0].min(c[0]), a[1].max(c[1])], [b[0].min(d[0]), b[1].max(d[1])]];
        near.reduce(hull).unwrap_or(ALL)
    }

    /// The greatest coordinate of the rectangle of cells, without its sign.
    pub fn size(&self) -> f64 {
        self.low.iter().chain(&self.high).fold(0.0, |size: f64, c| size.max(c.abs()))
    }

    /// How many pieces it has.
    pub fn pieces(&self) -> usize {
        self.pieces.len()
    }

    fn hash(&self) -> u64 {
        let numbers = self.pieces.iter().flat_map(Piece::numbers).map(f64::to_bits);
        let mix = |hash: u64, number: u64| (hash.rotate_left(23) ^ number).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let hash = numbers.fold(0x84_22_23_25_cb_f2_9c_e4, mix);
        mix(hash ^ hash >> 32, 1)
    }

    /// How many bytes it takes on a device.
    pub fn bytes(&self) -> usize {
        let chains = (0..self.pieces.len()).filter(|i| !self.follows(*i)).count();
        4 * (HEAD + self.cells.len() + self.lists.len() + PLACE * (self.pieces.len() + chains))
    }
}

static KNOWN: Known<Outline> = Known::new(BTreeMap::new());

impl Data for Outline {
    fn content(&self) -> u64 {
        self.content
    }

    /// Cells, lists, places. A place is where a piece begins; one more is where the last of a chain ends.
    fn words(&self, at: u32) -> ([u32; HEAD], Vec<u32>) {
        let bits = |c: f64| (c as f32).to_bits();
        let begins_at = at + self.cells.len() as u32;
        let places = begins_at + self.lists.len() as u32;
        let [[x, y], [far_x, far_y], [from_x, from_y], [to_x, to_y]] = [self.low, self.high, self.from, self.to].map(|corner| corner.map(bits));
        let [i, j] = self.counts.map(|count| count as u32);
        let head = [x, y, far_x, far_y, bits(1.0 / self.cell), i, j, at, begins_at, places, from_x, from_y, to_x, to_y, 0, 0];
        let (mut words, mut place_of) = (Vec::new(), Vec::new());
        let end = |piece: &Piece, words: &mut Vec<u32>| words.extend([piece.curve.c, piece.curve.c, piece.joints[1]].as_flattened().iter().copied().map(bits));
        for (i, piece) in self.pieces.iter().enumerate() {
            if let Some(before) = i.checked_sub(1).and_then(|before| self.pieces.get(before)).filter(|_| !self.follows(i)) {
                end(before, &mut words);
            }
            place_of.push((words.len() / PLACE) as u32);
            words.extend([piece.curve.a, piece.curve.b, piece.joints[0]].as_flattened().iter().copied().map(bits));
        }
        self.pieces.last().into_iter().for_each(|last| end(last, &mut words));
        let mut lists = self.lists.iter();
        let mut all = self.cells.clone();
        while let Some(count) = lists.next() {
            all.push(*count);
            all.extend(lists.by_ref().take(*count as usize).map(|run| place_of.get((run >> RUN) as usize).copied().unwrap_or(0) << RUN | run & LONGEST));
        }
        all.append(&mut words);
        (head, all)
    }

    fn known() -> &'static Known<Self> {
        &KNOWN
    }
}

impl Piece {
    /// What the coordinates of its normal lie between, out of the fill, with those halfway to the pieces that it meets.
    fn normals(&self) -> [Vec2; 2] {
        let [first, last] = self.curve.ends();
        let turn = |a: Vec2, b: Vec2| cross(a, b).atan2(a[0] * b[0] + a[1] * b[1]);
        // A normal is a quarter of a turn to the right of the way.
        let begin = first[1].atan2(first[0]) - FRAC_PI_2;
        let end = begin + turn(first, last);
        let angles = [begin, end, begin - turn(self.joints[0], first), end + turn(last, self.joints[1])];
        let low = angles.iter().copied().fold(f64::INFINITY, f64::min) - 1e-6;
        let high = angles.iter().copied().fold(f64::NEG_INFINITY, f64::max) + 1e-6;
        // A cosine is largest and smallest at the ends, or where the angle is a multiple of half a turn.
        let cosines = |low: f64, high: f64| {
            let at = (low / PI).ceil();
            let turned = [at, at + 1.0].into_iter().filter(|k| k * PI <= high).map(|k| if k % 2.0 == 0.0 { 1.0 } else { -1.0 });
            turned.chain([low.cos(), high.cos()]).fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], c| [a.min(c), b.max(c)])
        };
        [cosines(low, high), cosines(low - FRAC_PI_2, high - FRAC_PI_2)]
    }

    fn numbers(&self) -> [f64; 10] {
        let Self { curve: Curve { a, b, c }, joints: [from, to] } = *self;
        [a[0], a[1], b[0], b[1], c[0], c[1], from[0], from[1], to[0], to[1]]
    }
}
