//! What is in each cell: which of its edges the surface crosses, how the crossings are joined to loops, and the vertex of each loop.
//!
//! A corner has the number x + 2y + 4z. An edge along axis a has the number 4a + b + 2c, b and c its sides along the next two axes. A face across
//! axis a has the number 2a, or 2a + 1 on the upper side.

#![allow(clippy::indexing_slicing)] // Every index is that of a corner, an edge or a face, counted here.

use super::descend::{BRICK, cell_of};
use super::field::{Eyes, Field};
use super::place::{Found, Placed, place};
use super::{Grid, MOST_VERTICES};
use crate::vector::{Vec3, add, along, dot, length, mix, scale, sub, unit};
use crate::spread::spread;
use rustc_hash::FxHashMap;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Bricks that one task looks into.
const SHARE: usize = 64;
/// No farther from its bricks is asked what the field is, in cells: see [`reach`].
const ASKED: f64 = 2.0;
/// Corners along each axis of a brick.
const SIDE: usize = BRICK as usize + 1;
/// Steps by which a crossing is looked for; every second one halves what is left.
const STEPS: usize = 24;
/// A value this small beside those at the edge's ends is zero.
const ZERO: f64 = 1e-5;
/// How far from the walls of its cell a vertex stays, in cells: so that two are never one.
const MARGIN: f64 = 0.001;
/// No such thing.
pub(super) const NONE: u8 = u8::MAX;
/// No crossing.
const NO_CROSSING: u16 = u16::MAX;

/// What the surface is in one brick.
#[derive(Debug)]
pub(super) struct Patch {
    /// Its place, in bricks.
    pub at: [u32; 3],
    /// For each cell its index among `cells`, or [`NONE`].
    slots: [u8; 64],
    cells: Vec<Cell>,
    /// The vertices of all cells.
    pub vertices: Vec<Placed>,
    /// The edges that begin in it, and change sign.
    pub edges: Vec<Edge>,
    /// Where two cells are joined twice through a face: points on it.
    pub folds: Vec<Fold>,
    /// Bricks around it, of 27, that hold cells about its edges.
    needs: u32,
}

/// A cell through which the surface goes.
#[derive(Clone, Copy, Debug)]
struct Cell {
    /// The first of its vertices.
    first: u32,
    /// For each edge the loop that crosses it, or [`NONE`].
    loops: [u8; 12],
    /// Faces of which both pairs of crossings belong to one loop.
    doubled: u8,
    /// How the crossings of alternating faces are paired: about corners 1 and 3, else 0 and 2.
    paired: u8,
}

/// An edge that changes sign.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    /// The cell at whose least corner it begins.
    pub cell: [u32; 3],
    pub axis: usize,
    /// Whether it begins in the solid.
    pub leaves: bool,
    /// Where on it the surface is, from 0 to 1.
    pub part: f32,
    /// How far apart the values at its ends are.
    pub rise: f32,
}

/// A point on a cell's lower face across an axis, for one of its two pairs of crossings.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fold {
    pub cell: [u32; 3],
    pub axis: usize,
    pub pair: usize,
    pub point: Vec3,
    pub normal: Vec3,
}

/// Patches by their place.
pub(super) struct Patches {
    pub all: Vec<Patch>,
    places: FxHashMap<[u32; 3], usize>,
}

/// What is known of a cell.
pub(super) struct Looked<'a> {
    patch: usize,
    cell: &'a Cell,
}

impl Looked<'_> {
    /// The loop's vertex that crosses an edge: the patch, and the index among its vertices.
    pub fn vertex(&self, edge: usize) -> Option<(usize, u32)> {
        let which = self.cell.loops.get(edge).copied().filter(|l| *l != NONE)?;
        Some((self.patch, self.cell.first + u32::from(which)))
    }

    /// Whether both pairs of a face's crossings are one loop's.
    pub fn is_doubled(&self, face: usize) -> bool {
        self.cell.doubled >> face & 1 == 1
    }

    /// Which pair of an alternating face's crossings an edge belongs to: 0 that of the face's first edge.
    pub fn pair(&self, face: usize, edge: usize) -> usize {
        let edges = edges_of(face);
        let [first, second] = pairs(edges, self.cell.paired >> face & 1 == 1);
        usize::from(if first.contains(&edges[0]) { !first.contains(&edge) } else { !second.contains(&edge) })
    }
}

impl Patches {
    /// The cell at a place.
    pub fn cell(&self, at: [u32; 3]) -> Option<Looked<'_>> {
        let patch = *self.places.get(&at.map(|c| c / BRICK))?;
        let found = self.all.get(patch)?;
        let [x, y, z] = at.map(|c| (c % BRICK) as usize);
        let slot = found.slots[x + 4 * y + 16 * z];
        Some(Looked { patch, cell: found.cells.get(usize::from(slot)).filter(|_| slot != NONE)? })
    }
}

/// The face's edges, in a circle about it: the first between its corners 0 and 1 of [`corners_of`].
fn edges_of(face: usize) -> [usize; 4] {
    let (a, side) = (face / 2, face % 2);
    let (b, c) = ((a + 1) % 3, (a + 2) % 3);
    [4 * b + 2 * side, 4 * c + side + 2, 4 * b + 1 + 2 * side, 4 * c + side]
}

/// The face's corners, in a circle about it.
#[cfg(test)]
fn corners_of(face: usize) -> [usize; 4] {
    let (a, side) = (face / 2, face % 2);
    let (b, c) = ((a + 1) % 3, (a + 2) % 3);
    [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(i, j)| side << a | i << b | j << c)
}

/// The crossings of an alternating face in pairs: those about its corners 0 and 2, or 1 and 3.
fn pairs([e0, e1, e2, e3]: [usize; 4], odd: bool) -> [[usize; 2]; 2] {
    if odd { [[e0, e1], [e2, e3]] } else { [[e3, e0], [e1, e2]] }
}

/// Looks into bricks, and into those that they turn out to need. None where there are too many vertices.
pub(super) fn patches(field: &Field, grid: &Grid, bricks: Vec<[u32; 3]>, sharp: bool, progress: &(dyn Fn(f64) + Sync)) -> Option<Patches> {
    let mut places: FxHashMap<[u32; 3], usize> = FxHashMap::default();
    let mut all: Vec<Patch> = Vec::new();
    let mut next = bricks;
    let vertices = AtomicUsize::new(0);
    while !next.is_empty() {
        let shares: Vec<&[[u32; 3]]> = next.chunks(SHARE).collect();
        let done = AtomicUsize::new(0);
        let found = spread(shares.len(), &|| (), &|(), i| {
            if vertices.load(Ordering::Relaxed) > MOST_VERTICES {
                return Vec::new();
            }
            let share = shares.get(i).copied().unwrap_or_default();
            let ends = share.iter().flat_map(|at| [*at, at.map(|c| c + 1)]).map(|at| grid.corner(at.map(|c| c * BRICK)));
            let near = field.near(ends, ASKED * grid.cell);
            let mut eyes = near.eyes();
            let patches: Vec<Patch> = share.iter().filter_map(|at| patch(&mut eyes, grid, *at, sharp)).collect();
            vertices.fetch_add(patches.iter().map(|p| p.vertices.len()).sum(), Ordering::Relaxed);
            progress((done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / shares.len() as f64);
            patches
        });
        if vertices.load(Ordering::Relaxed) > MOST_VERTICES {
            return None;
        }
        places.extend(next.iter().map(|at| (*at, usize::MAX)));
        for patch in found.into_iter().flatten() {
            places.insert(patch.at, all.len());
            all.push(patch);
        }
        // The surface goes on where the bound said that there is none: it is followed, so that no hole is left.
        let mut wanted: Vec<[u32; 3]> = all.iter().flat_map(Patch::needed).filter(|at| !places.contains_key(at)).collect();
        wanted.sort_unstable();
        wanted.dedup();
        next = wanted;
    }
    progress(1.0);
    Some(Patches { all, places })
}

impl Patch {
    /// The bricks that hold cells about its edges.
    fn needed(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        (0..27).filter(|bit| self.needs >> bit & 1 == 1).filter_map(|bit| {
            let [x, y, z] = self.at;
            let moved = |c: u32, by: u32| (c + by).checked_sub(1);
            Some([moved(x, bit % 3)?, moved(y, bit / 3 % 3)?, moved(z, bit / 9)?])
        })
    }
}

/// A corner of a brick by its number.
fn corner(index: usize) -> [usize; 3] {
    [index % SIDE, index / SIDE % SIDE, index / (SIDE * SIDE)]
}

const STEP: [usize; 3] = [1, SIDE, SIDE * SIDE];

/// A crossing: the corner at which its edge begins, the axis, and where it is.
struct Crossing {
    from: usize,
    axis: usize,
    part: f64,
    point: Vec3,
    normal: Vec3,
}

/// What is in a brick; none where all its corners are on one side.
fn patch(eyes: &mut Eyes<'_>, grid: &Grid, at: [u32; 3], sharp: bool) -> Option<Patch> {
    let place = |index: usize| {
        let c = corner(index);
        grid.corner([0, 1, 2].map(|i| at[i] * BRICK + c[i] as u32))
    };
    let corners: Vec<Vec3> = (0..SIDE * SIDE * SIDE).map(place).collect();
    let values = eyes.values(&corners);
    let solid: Vec<bool> = values.iter().map(|v| *v < 0.0).collect();
    if solid.iter().all(|s| *s == solid[0]) {
        return None;
    }
    let mut numbers = vec![[NO_CROSSING; 3]; corners.len()];
    let mut crossings = Vec::new();
    let mut needs = 0u32;
    for from in 0..corners.len() {
        for axis in 0..3 {
            if corner(from)[axis] + 1 == SIDE || solid[from] == solid[from + STEP[axis]] {
                continue;
            }
            numbers[from][axis] = crossings.len() as u16;
            crossings.push(Crossing { from, axis, part: 0.0, point: corners[from], normal: [0.0; 3] });
            needs |= bricks_about(corner(from), axis);
        }
    }
    locate(eyes, grid.cell, &corners, &values, &mut crossings);
    let paired = alternating(eyes, grid.cell, &corners, &values, &solid);
    let mut made = Patch { at, slots: [NONE; 64], cells: Vec::new(), vertices: Vec::new(), edges: Vec::new(), folds: Vec::new(), needs };
    let mut found = Vec::new();
    for index in 0..64 {
        let base = corner_of_cell(index);
        let signs = (0..8).fold(0u8, |signs, i| signs | u8::from(solid[base + offset(i)]) << i);
        if signs == 0 || signs == 255 {
            continue;
        }
        let number = |edge: usize| numbers[base + start_of(edge)][edge / 4];
        let crossing = |edge: usize| &crossings[usize::from(number(edge))];
        let mut cell = Cell { first: made.vertices.len() as u32, loops: [NONE; 12], doubled: 0, paired: 0 };
        for (edge, which) in cell.loops.iter_mut().enumerate() {
            if number(edge) != NO_CROSSING {
                *which = edge as u8;
            }
        }
        let mut alternate = Vec::new();
        for face in 0..6 {
            let edges = edges_of(face);
            let crossed: Vec<usize> = edges.into_iter().filter(|e| number(*e) != NO_CROSSING).collect();
            match crossed.as_slice() {
                [a, b] => merge(&mut cell.loops, *a, *b),
                [_, _, _, _] => {
                    let odd = paired.get(&(base + if face % 2 == 1 { STEP[face / 2] } else { 0 }, face / 2)).copied().unwrap_or(false);
                    cell.paired |= u8::from(odd) << face;
                    pairs(edges, odd).into_iter().for_each(|[a, b]| merge(&mut cell.loops, a, b));
                    alternate.push(face);
                }
                _ => {}
            }
        }
        let mut labels: Vec<u8> = cell.loops.iter().copied().filter(|l| *l != NONE).collect();
        labels.sort_unstable();
        labels.dedup();
        let [x, y, z] = cell_of(at, index as u32);
        let low = grid.corner([x, y, z]);
        let (low, high) = (add(low, [MARGIN * grid.cell; 3]), add(low, [(1.0 - MARGIN) * grid.cell; 3]));
        for (i, label) in labels.into_iter().enumerate() {
            let edges: Vec<usize> = (0..12).filter(|e| cell.loops[*e] == label).collect();
            let points: Vec<Vec3> = edges.iter().map(|e| crossing(*e).point).collect();
            let normals: Vec<Vec3> = edges.iter().map(|e| crossing(*e).normal).collect();
            let vertex = self::place(&points, &normals, low, high, sharp);
            made.vertices.push(vertex.placed);
            found.push(vertex);
            // Labels are edges of a cell and rise, so none is taken for one that is new.
            edges.into_iter().for_each(|e| cell.loops[e] = i as u8);
        }
        for face in alternate {
            let edges = edges_of(face);
            if edges.iter().any(|e| cell.loops[*e] != cell.loops[edges[0]]) {
                continue;
            }
            cell.doubled |= 1 << face;
            if face % 2 == 0 {
                for pair in pairs(edges, cell.paired >> face & 1 == 1) {
                    let [a, b] = pair.map(crossing);
                    let which = usize::from(!pair.contains(&edges[0]));
                    let point = mix(a.point, b.point, 0.5);
                    made.folds.push(Fold { cell: [x, y, z], axis: face / 2, pair: which, point, normal: unit(add(a.normal, b.normal)).unwrap_or([0.0, 0.0, 1.0]) });
                }
            }
        }
        made.slots[index] = made.cells.len() as u8;
        made.cells.push(cell);
    }
    for c in &crossings {
        let place = corner(c.from);
        if (0..3).all(|i| place[i] < BRICK as usize) {
            let rise = (values[c.from] - values[c.from + STEP[c.axis]]).abs() as f32;
            let cell = [0, 1, 2].map(|i| at[i] * BRICK + place[i] as u32);
            made.edges.push(Edge { cell, axis: c.axis, leaves: solid[c.from], part: c.part as f32, rise });
        }
    }
    settle(eyes, grid, &mut made);
    reach(eyes, grid, &mut made, &found);
    part(grid.cell, &mut made, &found);
    Some(made)
}

/// The number of the corner at which a cell begins.
fn corner_of_cell(index: usize) -> usize {
    index % 4 + STEP[1] * (index / 4 % 4) + STEP[2] * (index / 16)
}

/// From there to a corner of the cell.
fn offset(corner: usize) -> usize {
    (corner & 1) * STEP[0] + (corner >> 1 & 1) * STEP[1] + (corner >> 2) * STEP[2]
}

/// From there to the corner at which an edge of the cell begins.
fn start_of(edge: usize) -> usize {
    let axis = edge / 4;
    (edge & 1) * STEP[(axis + 1) % 3] + (edge >> 1 & 1) * STEP[(axis + 2) % 3]
}

/// Two edges are of one loop.
fn merge(loops: &mut [u8; 12], a: usize, b: usize) {
    let (kept, gone) = (loops[a].min(loops[b]), loops[a].max(loops[b]));
    loops.iter_mut().filter(|l| **l == gone).for_each(|l| *l = kept);
}

/// Bricks that hold the cells about an edge.
fn bricks_about(from: [usize; 3], axis: usize) -> u32 {
    let sides = |i: usize| match from[i] {
        _ if i == axis => 0b010,
        0 => 0b011,
        last if last + 1 == SIDE => 0b110,
        _ => 0b010,
    };
    let [x, y, z] = [0, 1, 2].map(sides);
    let mut needs = 0u32;
    for bit in 0..27 {
        needs |= (x >> (bit % 3) & y >> (bit / 3 % 3) & z >> (bit / 9) & 1) << bit;
    }
    needs
}

/// Finds where on each edge the field is zero, and its direction there: by secants and halves in turn. Where it jumps, the jump is found.
fn locate(eyes: &mut Eyes<'_>, cell: f64, corners: &[Vec3], values: &[f64], crossings: &mut [Crossing]) {
    struct Left {
        which: usize,
        low: (f64, f64),
        high: (f64, f64),
        zero: f64,
    }
    let mut left: Vec<Left> = crossings.iter().enumerate().map(|(which, c)| {
        let ends = (values[c.from], values[c.from + STEP[c.axis]]);
        Left { which, low: (0.0, ends.0), high: (1.0, ends.1), zero: ZERO * (ends.0.abs() + ends.1.abs()) }
    }).collect();
    let along = |c: &Crossing, part: f64| mix(corners[c.from], corners[c.from + STEP[c.axis]], part);
    for step in 0..STEPS {
        let half = |l: &Left| 0.5 * (l.low.0 + l.high.0);
        let parts: Vec<f64> = left.iter().map(|l| {
            let secant = l.low.0 + (l.high.0 - l.low.0) * l.low.1 / (l.low.1 - l.high.1);
            if step % 2 == 0 && secant > l.low.0 && secant < l.high.0 { secant } else { half(l) }
        }).collect();
        let points: Vec<Vec3> = left.iter().zip(&parts).map(|(l, part)| along(&crossings[l.which], *part)).collect();
        let found = eyes.values(&points);
        let mut next = Vec::new();
        for ((mut l, part), value) in left.into_iter().zip(parts).zip(found) {
            crossings[l.which].part = part;
            if value.abs() <= l.zero {
                continue;
            }
            if (value < 0.0) == (l.low.1 < 0.0) { l.low = (part, value) } else { l.high = (part, value) }
            next.push(l);
        }
        left = next;
    }
    for l in &left {
        crossings[l.which].part = 0.5 * (l.low.0 + l.high.0);
    }
    for c in crossings.iter_mut() {
        c.point = along(c, c.part);
    }
    let points: Vec<Vec3> = crossings.iter().map(|c| c.point).collect();
    for (c, slope) in crossings.iter_mut().zip(eyes.slopes(&points, cell)) {
        c.normal = unit(slope).unwrap_or([0.0; 3]);
    }
}

/// How the crossings of each alternating face are paired, by the corner at which it begins and the axis across it. The field at the saddle point of
/// what the corners say decides which two corners are joined.
fn alternating(eyes: &mut Eyes<'_>, cell: f64, corners: &[Vec3], values: &[f64], solid: &[bool]) -> FxHashMap<(usize, usize), bool> {
    let mut faces = Vec::new();
    let mut points = Vec::new();
    for (from, start) in corners.iter().enumerate() {
        for axis in 0..3 {
            let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
            let place = corner(from);
            if place[b] + 1 == SIDE || place[c] + 1 == SIDE {
                continue;
            }
            let round = [from, from + STEP[b], from + STEP[b] + STEP[c], from + STEP[c]];
            let [s0, s1, s2, s3] = round.map(|i| solid[i]);
            if s0 != s2 || s1 != s3 || s0 == s1 {
                continue;
            }
            let [v0, v1, v2, v3] = round.map(|i| values[i]);
            let both = v0 + v2 - v1 - v3;
            let mut point = *start;
            for (i, part) in [(b, (v0 - v3) / both), (c, (v0 - v1) / both)] {
                point[i] += cell * if part.is_finite() { part.clamp(0.0, 1.0) } else { 0.5 };
            }
            faces.push((from, axis, s0));
            points.push(point);
        }
    }
    let found = eyes.values(&points);
    // Corners of the other sign than the saddle's stand alone: 0 and 2, or 1 and 3.
    faces.into_iter().zip(found).map(|((from, axis, first), value)| ((from, axis), (value < 0.0) == first)).collect()
}

/// Moves the vertices of what is smooth onto the surface.
fn settle(eyes: &mut Eyes<'_>, grid: &Grid, patch: &mut Patch) {
    let mut smooth: Vec<(usize, Vec3)> = Vec::new();
    for (index, slot) in patch.slots.iter().enumerate().filter(|(_, slot)| **slot != NONE) {
        let first = patch.cells[usize::from(*slot)].first as usize;
        let end = patch.cells.get(usize::from(*slot) + 1).map_or(patch.vertices.len(), |next| next.first as usize);
        let low = grid.corner(cell_of(patch.at, index as u32));
        smooth.extend((first..end).filter(|v| patch.vertices[*v].smooth).map(|v| (v, low)));
    }
    for _ in 0..2 {
        let points: Vec<Vec3> = smooth.iter().map(|(v, _)| patch.vertices[*v].point).collect();
        let values = eyes.values(&points);
        let slopes = eyes.slopes(&points, grid.cell);
        let moved: Vec<Vec3> = (0..points.len()).map(|i| {
            let steep = dot(slopes[i], slopes[i]);
            let step = if steep > 0.0 { scale(slopes[i], values[i] / steep) } else { [0.0; 3] };
            let (to, low) = (sub(points[i], step), smooth[i].1);
            [0, 1, 2].map(|k| to[k].clamp(low[k] + MARGIN * grid.cell, low[k] + (1.0 - MARGIN) * grid.cell))
        }).collect();
        let after = eyes.values(&moved);
        for (i, (v, _)) in smooth.iter().enumerate() {
            if after[i].abs() < values[i].abs() {
                patch.vertices[*v].point = moved[i];
            }
        }
    }
}

/// Moves vertices to edges and corners of the surface that lie a little beyond their cells: so narrow is the surface there that no corner of the next
/// cell is in it, or it turns within a hair of the wall.
fn reach(eyes: &mut Eyes<'_>, grid: &Grid, patch: &mut Patch, found: &[Found]) {
    /// So much nearer to the surface it must be.
    const NEARER: f64 = 0.2;
    /// And no farther, in cells.
    const FAR: f64 = 1.5;
    let beyond = found.iter().enumerate().filter(|(_, f)| !f.placed.smooth).filter_map(|(v, f)| Some((v, f.beyond?)));
    let beyond: Vec<(usize, Vec3)> = beyond.filter(|(v, to)| length(sub(*to, patch.vertices[*v].point)) < FAR * grid.cell).collect();
    let before: Vec<f64> = eyes.values(&beyond.iter().map(|(v, _)| patch.vertices[*v].point).collect::<Vec<_>>());
    let after: Vec<f64> = eyes.values(&beyond.iter().map(|(_, to)| *to).collect::<Vec<_>>());
    for ((v, to), (before, after)) in beyond.into_iter().zip(before.into_iter().zip(after)) {
        if after.abs() < NEARER * before.abs() {
            // Another cell may find the same place: each keeps a hair to its own side.
            patch.vertices[v].point = toward(to, found[v].middle, MARGIN * grid.cell);
        }
    }
}

/// Parts the vertices of two loops in a cell that stand at one place, as where two solids touch.
fn part(cell: f64, patch: &mut Patch, found: &[Found]) {
    for i in 0..patch.cells.len() {
        let first = patch.cells[i].first as usize;
        let end = patch.cells.get(i + 1).map_or(patch.vertices.len(), |next| next.first as usize);
        let places: Vec<Vec3> = patch.vertices[first..end].iter().map(|v| v.point).collect();
        for (a, place) in places.iter().enumerate() {
            if places.iter().enumerate().any(|(b, other)| a != b && length(sub(*place, *other)) < MARGIN * cell) {
                patch.vertices[first + a].point = toward(*place, found[first + a].middle, MARGIN * cell);
            }
        }
    }
}

/// From one place toward another, no farther than so far.
fn toward(from: Vec3, to: Vec3, far: f64) -> Vec3 {
    let way = sub(to, from);
    along(from, way, (far / length(way).max(1e-300)).min(0.5))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_of_a_face_lie_between_its_corners() {
        for face in 0..6 {
            let (edges, corners) = (edges_of(face), corners_of(face));
            for i in 0..4 {
                let axis = edges[i] / 4;
                let begin = (edges[i] & 1) << ((axis + 1) % 3) | (edges[i] >> 1 & 1) << ((axis + 2) % 3);
                let mut ends = [begin, begin | 1 << axis];
                let mut between = [corners[i], corners[(i + 1) % 4]];
                ends.sort_unstable();
                between.sort_unstable();
                assert_eq!(ends, between, "{face} {i}");
            }
        }
    }
}
