//! A grid of signed distances: coarse everywhere, fine in bricks near the surface.

// Indices are made from the grid's own counts, and a grid is only made with as many samples as they say.
#![allow(clippy::indexing_slicing)]

use crate::kept::{Data, HEAD, Known};
use crate::vector::Vec3;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Cells of a brick along each axis.
pub const BRICK: usize = 8;
/// Samples of a brick along each axis: those on its faces are its own too.
pub(super) const SIDE: usize = BRICK + 1;
/// Samples of a brick.
pub(super) const VOLUME: usize = SIDE * SIDE * SIDE;

/// Where a grid lies and how many bricks it has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// Its least corner.
    pub origin: Vec3,
    /// The side of a cell; cells are cubes.
    pub cell: f64,
    /// Bricks along x, y and z, each of [`BRICK`] cells a side.
    pub bricks: [u32; 3],
}

impl Shape {
    /// How many bricks there are.
    pub fn count(&self) -> usize {
        self.bricks.iter().map(|b| *b as usize).product()
    }

    /// How many samples there are at corners of bricks.
    pub(super) fn corners(&self) -> usize {
        self.bricks.iter().map(|b| *b as usize + 1).product()
    }

    /// The side of a brick.
    pub fn brick(&self) -> f64 {
        self.cell * BRICK as f64
    }

    /// Which brick stands at this number.
    pub(super) fn place(&self, brick: usize) -> [usize; 3] {
        let [x, y] = [self.bricks[0] as usize, self.bricks[1] as usize];
        [brick % x, brick / x % y, brick / x / y]
    }

    /// The number of a brick.
    pub(super) fn number(&self, [i, j, k]: [usize; 3]) -> usize {
        i + self.bricks[0] as usize * (j + self.bricks[1] as usize * k)
    }

    /// The number of a corner of bricks.
    pub(super) fn corner(&self, [i, j, k]: [usize; 3]) -> usize {
        i + (self.bricks[0] as usize + 1) * (j + (self.bricks[1] as usize + 1) * k)
    }

    /// Where a sample lies, counted in cells.
    pub fn at(&self, sample: [usize; 3]) -> Vec3 {
        [0, 1, 2].map(|i| self.origin[i] + sample[i] as f64 * self.cell)
    }

    /// Whether its places are numbers, and those a cell apart different ones.
    pub(super) fn is_somewhere(&self) -> bool {
        let apart = |from: f64, to: f64| from + 0.5 * self.cell > from && to - 0.5 * self.cell < to && from.abs().max(to.abs()) < 1e17;
        self.cell > 0.0 && self.origin.into_iter().zip(self.end()).all(|(from, to)| apart(from, to))
    }

    /// Its greatest corner.
    pub fn end(&self) -> Vec3 {
        self.at(self.bricks.map(|b| b as usize * BRICK))
    }
}

/// What is certain within a brick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Facts {
    /// The value changes by at most so many times the way from place to place.
    ///
    /// Each component of the gradient of a trilinear interpolant is a mean of the differences along the four edges of its axis, with weights that
    /// are multilinear in the place. So the gradient is a mean of the gradients at the eight corners of the cell, and no longer than the longest.
    pub lipschitz: f32,
    /// Without its sign the value exceeds the distance to the mesh by at most so much, whatever the signs of the samples.
    ///
    /// With cell side h: the distance changes by at most the way, and the mean of the ways to the corners, by their weights, is at most √3/2·h. Where
    /// no place of the cell is closer to the mesh than d, the distance less |x|²/2d is concave, as the minimum of distances to points is (each
    /// has no second derivative above 1/d); a concave function is nowhere below its interpolant, so that ours exceeds it by what |x|²/2d does: 3h²/8d.
    pub excess: f32,
}

/// Signed distances to a mesh, below zero inside, read between samples by trilinear interpolation.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    pub(super) shape: Shape,
    /// At the corners of bricks, x first.
    pub(super) coarse: Vec<f32>,
    /// Of each brick the number of its samples plus one, or zero where its corners are all there is.
    pub(super) index: Vec<u32>,
    /// [`VOLUME`] samples a brick, x first. On a face towards a brick without samples they are what its corners say, so that no value jumps.
    pub(super) fine: Vec<f32>,
    facts: Vec<Facts>,
    /// Of each brick, and then of all of them.
    hulls: Vec<Hull>,
    content: u64,
}

/// Least and greatest of some numbers.
pub type Span = [f64; 2];

const NOWHERE: Span = [f64::INFINITY, f64::NEG_INFINITY];

fn hull(a: Span, b: Span) -> Span {
    [a[0].min(b[0]), a[1].max(b[1])]
}

/// What the values and slopes of some cells lie between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hull {
    /// The values.
    pub values: Span,
    /// How fast they change along x, y and z.
    pub slopes: [Span; 3],
    /// No gradient is longer.
    pub lipschitz: f64,
}

impl Hull {
    const EMPTY: Self = Self { values: NOWHERE, slopes: [NOWHERE; 3], lipschitz: 0.0 };

    fn with(self, other: Self) -> Self {
        let slopes = [0, 1, 2].map(|i| hull(self.slopes[i], other.slopes[i]));
        Self { values: hull(self.values, other.values), slopes, lipschitz: self.lipschitz.max(other.lipschitz) }
    }

    /// Of one cell. A trilinear value lies between its samples, and each slope between the differences along its axis.
    fn of(cell: &Cell, side: f64) -> Self {
        let values = cell.iter().fold(NOWHERE, |all, v| hull(all, [*v, *v]));
        let slopes = [1, 2, 4].map(|bit| {
            let along = (0..8usize).filter(|corner| corner & bit == 0).map(|corner| (cell[corner | bit] - cell[corner]) / side);
            // For what is lost in rounding.
            let [low, high] = along.fold(NOWHERE, |all, d| hull(all, [d, d]));
            [low - 1e-12 * low.abs(), high + 1e-12 * high.abs()]
        });
        Self { values, slopes, lipschitz: slope(cell) / side * (1.0 + 1e-12) }
    }

    /// Of a part of one cell, between two places in it, each from 0 to 1. Values and slopes are linear in each coordinate, and so lie between those at
    /// the part's corners; a gradient is a mean of those there.
    fn of_part(cell: &Cell, side: f64, ends: [Vec3; 2]) -> Self {
        let size = cell.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        // For what is lost in rounding.
        let (value_off, slope_off) = (1e-14 * size, 1e-14 * size / side);
        (0..8usize).fold(Self::EMPTY, |found, corner| {
            let at = [0, 1, 2].map(|i| ends[corner >> i & 1][i]);
            let (value, slopes) = (interpolate(cell, at), slopes(cell, at).map(|s| s / side));
            let length = slopes.iter().map(|s| s * s).sum::<f64>().sqrt() + slope_off;
            let [values, slopes] = [([value; 3], value_off), (slopes, slope_off)].map(|(all, off)| all.map(|v| [v - off, v + off]));
            found.with(Self { values: values[0], slopes, lipschitz: length })
        })
    }
}

/// The eight samples of a cell, x first.
type Cell = [f64; 8];

impl Grid {
    /// A grid of samples. Their numbers must fit.
    pub(super) fn new(shape: Shape, coarse: Vec<f32>, index: Vec<u32>, fine: Vec<f32>) -> Self {
        let mut grid = Self { shape, coarse, index, fine, facts: Vec::new(), hulls: Vec::new(), content: 0 };
        let all = 0..shape.count();
        // Those without samples first: their excess reaches the faces of their neighbours.
        grid.facts = all.clone().into_par_iter().map(|brick| if grid.index[brick] == 0 { grid.known(brick, 0.0) } else { Facts::default() }).collect();
        let of = |brick: usize| match grid.index[brick] {
            0 => grid.facts[brick],
            _ => grid.known(brick, grid.excess_around(brick)),
        };
        grid.facts = all.clone().into_par_iter().map(of).collect();
        grid.hulls = all.into_par_iter().map(|brick| grid.brick_hull(brick)).collect();
        grid.hulls.push(grid.hulls.iter().fold(Hull::EMPTY, |all, one| all.with(*one)));
        grid.content = grid.hash();
        grid
    }

    fn brick_hull(&self, brick: usize) -> Hull {
        let (side, cells) = if self.index[brick] == 0 { (self.shape.brick(), 1) } else { (self.shape.cell, BRICK) };
        let all = (0..cells * cells * cells).map(|i| [i % cells, i / cells % cells, i / cells / cells]);
        all.map(|cell| Hull::of(&self.cell(brick, cell), side)).fold(Hull::EMPTY, Hull::with)
    }

    /// A number of all that it holds, the same on every machine.
    fn hash(&self) -> u64 {
        let Shape { origin, cell, bricks } = self.shape;
        let head = origin.into_iter().chain([cell]).map(f64::to_bits).chain(bricks.map(u64::from));
        let samples = self.coarse.iter().chain(&self.fine).map(|v| u64::from(v.to_bits()));
        let all = head.chain(self.index.iter().map(|number| u64::from(*number))).chain(samples);
        // Multiply and rotate, as the finalizers of hash functions do, for each number.
        let mix = |hash: u64, number: u64| (hash.rotate_left(23) ^ number).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let hash = all.fold(0xcbf2_9ce4_8422_2325, mix);
        mix(hash ^ hash >> 32, 0)
    }

    /// Of all of it.
    pub fn hull(&self) -> Hull {
        self.hulls.last().copied().unwrap_or(Hull::EMPTY)
    }

    /// The box about the cells with a sample that is not above zero: what is solid lies within. None where all are above.
    pub fn solid(&self) -> Option<[Vec3; 2]> {
        let mut found: Option<[Vec3; 2]> = None;
        for brick in (0..self.shape.count()).filter(|brick| self.hulls[*brick].values[0] <= 0.0) {
            let place = self.shape.place(brick);
            let (step, cells) = if self.index[brick] == 0 { (BRICK, 1) } else { (1, BRICK) };
            for i in 0..cells * cells * cells {
                let cell = [i % cells, i / cells % cells, i / cells / cells];
                if self.cell(brick, cell).iter().all(|v| *v > 0.0) {
                    continue;
                }
                let first = [0, 1, 2].map(|axis| place[axis] * BRICK + cell[axis] * step);
                let (low, high) = (self.shape.at(first), self.shape.at(first.map(|c| c + step)));
                let known = found.unwrap_or([low, high]);
                found = Some([[0, 1, 2].map(|i| known[0][i].min(low[i])), [0, 1, 2].map(|i| known[1][i].max(high[i]))]);
            }
        }
        found
    }

    /// What values and slopes lie between in a box of places, each of which counts as the nearest of the grid's own box.
    pub fn hull_within(&self, low: Vec3, high: Vec3) -> Hull {
        /// More cells are taken brick by brick, and more bricks together.
        const MOST: usize = 512;
        /// Of so few, only the part within the box counts.
        const FEW: usize = 8;
        let ends = [low, high].map(|p| [0, 1, 2].map(|i| self.place_along(i, p[i])));
        let [first, last] = [0, 1].map(|end| ends[end].map(|(whole, _)| whole));
        let count = |step: usize| (0..3).map(|i| last[i] / step - first[i] / step + 1).product::<usize>();
        let is_few = count(1) <= FEW;
        let (step, all) = if count(1) <= MOST { (1, false) } else { (BRICK, count(BRICK) > MOST) };
        if all || low.iter().chain(&high).any(|c| c.is_nan()) {
            return self.hull();
        }
        let [from, to] = [first, last].map(|place| place.map(|c| c / step));
        let mut found = Hull::EMPTY;
        for k in from[2]..=to[2] {
            for j in from[1]..=to[1] {
                for i in from[0]..=to[0] {
                    let place = [i, j, k].map(|c| c * step);
                    let brick = self.shape.number(place.map(|c| c / BRICK));
                    let is_fine = self.index[brick] != 0;
                    found = found.with(match self.index[brick] {
                        _ if is_few => {
                            let cell = if is_fine { place.map(|c| c % BRICK) } else { [0; 3] };
                            let part = [0, 1].map(|end| {
                                let along = |i: usize| if place[i] == ends[end][i].0 { ends[end][i].1 } else { end as f64 };
                                [0, 1, 2].map(|i| if is_fine { along(i) } else { ((place[i] % BRICK) as f64 + along(i)) / BRICK as f64 })
                            });
                            Hull::of_part(&self.cell(brick, cell), if is_fine { self.shape.cell } else { self.shape.brick() }, part)
                        }
                        _ if step == BRICK => self.hulls[brick],
                        0 => self.hulls[brick],
                        _ => Hull::of(&self.cell(brick, place.map(|c| c % BRICK)), self.shape.cell),
                    });
                }
            }
        }
        // From the middle it is at most so far, along each axis and in all.
        let (end, mut half) = (self.shape.end(), [0.0; 3]);
        let within = |p: Vec3| [0, 1, 2].map(|i| p[i].clamp(self.shape.origin[i], end[i]));
        let [low, high] = [low, high].map(within);
        let middle = [0, 1, 2].map(|i| 0.5 * (low[i] + high[i]));
        for i in 0..3 {
            half[i] = 0.5 * (high[i] - low[i]);
        }
        let by_axes: f64 = (0..3).map(|i| half[i] * found.slopes[i][0].abs().max(found.slopes[i][1].abs())).sum();
        let by_length = found.lipschitz * half.iter().map(|h| h * h).sum::<f64>().sqrt();
        let value = self.inside(middle);
        let way = by_axes.min(by_length);
        let rounding = 1e-14 * (value.abs() + way + found.lipschitz * (0..3).map(|i| low[i].abs() + high[i].abs()).sum::<f64>());
        // Where a place lies in its cell is rounded too.
        let found = Hull { values: [found.values[0] - rounding, found.values[1] + rounding], ..found };
        let values = [found.values[0].max(value - way - rounding), found.values[1].min(value + way + rounding)];
        Hull { values: if values[0] <= values[1] { values } else { found.values }, ..found }
    }

    /// In which cell along an axis a coordinate lies, and where in it, from 0 to 1. Outside of the grid it is the last.
    fn place_along(&self, axis: usize, c: f64) -> (usize, f64) {
        let most = self.shape.bricks[axis] as usize * BRICK;
        let cells = ((c - self.shape.origin[axis]) / self.shape.cell).clamp(0.0, most as f64);
        let whole = (cells as usize).min(most - 1);
        (whole, cells - whole as f64)
    }

    /// The value at a place, which counts as the nearest of the grid's box.
    pub fn inside(&self, p: Vec3) -> f64 {
        let (brick, cell, at) = self.find(p);
        interpolate(&self.cell(brick, cell), at)
    }

    /// The gradient of [`Grid::inside`] within the cell of a place.
    pub fn gradient(&self, p: Vec3) -> Vec3 {
        let (brick, cell, at) = self.find(p);
        let side = if self.index[brick] == 0 { self.shape.brick() } else { self.shape.cell };
        slopes(&self.cell(brick, cell), at).map(|s| s / side)
    }

    /// How many bytes it takes on a device.
    pub fn bytes(&self) -> usize {
        4 * (HEAD + self.coarse.len() + self.index.len() + self.fine.len())
    }

    /// The most excess of bricks without samples that touch a brick.
    fn excess_around(&self, brick: usize) -> f64 {
        let place = self.shape.place(brick);
        let [x, y, z] = [0, 1, 2].map(|i| place[i].saturating_sub(1)..(place[i] + 2).min(self.shape.bricks[i] as usize));
        let all = z.flat_map(|k| y.clone().flat_map({ let x = x.clone(); move |j| x.clone().map(move |i| [i, j, k]) }));
        all.map(|place| self.shape.number(place)).filter(|b| self.index[*b] == 0).map(|b| f64::from(self.facts[b].excess)).fold(0.0, f64::max)
    }

    /// What is certain of a brick whose samples exceed the distance by at most `above`.
    fn known(&self, brick: usize, above: f64) -> Facts {
        let (side, cells) = if self.index[brick] == 0 { (self.shape.brick(), 1) } else { (self.shape.cell, BRICK) };
        let (mut steepest, mut excess, mut largest) = (0.0f64, 0.0f64, 0.0f64);
        for k in 0..cells {
            for j in 0..cells {
                for i in 0..cells {
                    let cell = self.cell(brick, [i, j, k]);
                    steepest = steepest.max(slope(&cell));
                    let half = 0.75f64.sqrt() * side;
                    let least = cell.iter().fold(f64::INFINITY, |least, v| least.min(v.abs())) - above - half;
                    excess = excess.max(if least > 0.0 { half.min(0.375 * side * side / least) } else { half });
                    largest = cell.iter().fold(largest, |most, v| most.max(v.abs()));
                }
            }
        }
        // Samples are rounded to 24 bits.
        let excess = excess + above + largest * f64::from(f32::EPSILON);
        Facts { lipschitz: ((steepest / side) as f32).next_up(), excess: (excess as f32).next_up() }
    }

    /// The samples about a cell of a brick; a brick without samples is one cell.
    fn cell(&self, brick: usize, [i, j, k]: [usize; 3]) -> Cell {
        let read = |from: &[f32], first: usize, row: usize, layer: usize| {
            [0, 1, row, row + 1, layer, layer + 1, layer + row, layer + row + 1].map(|step| f64::from(from[first + step]))
        };
        match self.index[brick] as usize {
            0 => {
                let row = self.shape.bricks[0] as usize + 1;
                read(&self.coarse, self.shape.corner(self.shape.place(brick)), row, row * (self.shape.bricks[1] as usize + 1))
            }
            number => read(&self.fine, (number - 1) * VOLUME + i + SIDE * (j + SIDE * k), SIDE, SIDE * SIDE),
        }
    }

    /// Where it lies.
    pub fn shape(&self) -> Shape {
        self.shape
    }

    /// How many bricks have samples of their own.
    pub fn fine_bricks(&self) -> usize {
        self.fine.len() / VOLUME
    }

    /// What is certain of each brick, x first.
    pub fn facts(&self) -> &[Facts] {
        &self.facts
    }

    /// The brick in which a place of the grid lies, by its number, and the cell and the place in it, from 0 to 1.
    fn find(&self, p: Vec3) -> (usize, [usize; 3], Vec3) {
        let along = [0, 1, 2].map(|i| self.place_along(i, p[i]));
        let (cell, rest) = (along.map(|(whole, _)| whole % BRICK), along.map(|(_, rest)| rest));
        let brick = self.shape.number(along.map(|(whole, _)| whole / BRICK));
        if self.index[brick] == 0 {
            return (brick, [0; 3], [0, 1, 2].map(|i| (cell[i] as f64 + rest[i]) / BRICK as f64));
        }
        (brick, cell, rest)
    }

    /// What is certain of the brick in which a place of the grid lies.
    pub fn facts_at(&self, p: Vec3) -> Facts {
        self.facts[self.find(p).0]
    }

    /// The value at a place; it is continuous, but for the last digit of samples at faces between bricks.
    ///
    /// Outside of the grid, at t from its box whose nearest place has the value v, it is √(v² + t²): as the mesh lies within the convex box, the way to
    /// it is at least that of a right angle there. It changes no faster than the value at the wall does, or than the way.
    pub fn value(&self, p: Vec3) -> f64 {
        let end = self.shape.end();
        let away: f64 = (0..3).map(|i| (self.shape.origin[i] - p[i]).max(p[i] - end[i]).max(0.0)).map(|t| t * t).sum();
        let value = self.inside(p);
        if away > 0.0 { (value * value + away).sqrt() } else { value }
    }

    /// Whether no sample on the faces of its box is below zero: outside of it nothing is.
    pub(super) fn has_outside(&self) -> bool {
        let bricks = self.shape.bricks.map(|b| b as usize);
        (0..self.shape.count()).into_par_iter().all(|brick| {
            let place = self.shape.place(brick);
            let cells = if self.index[brick] == 0 { 1 } else { BRICK };
            let wall = |axis: usize, at: usize| (place[axis] == 0 && at == 0) || (place[axis] + 1 == bricks[axis] && at == cells);
            (0..=cells).all(|k| {
                (0..=cells).all(|j| {
                    (0..=cells).all(|i| {
                        let on = wall(0, i) || wall(1, j) || wall(2, k);
                        let cell = [i, j, k].map(|c| c.min(cells - 1));
                        let corner = [i, j, k].iter().zip(cell).enumerate().map(|(axis, (at, c))| (at - c) << axis).sum::<usize>();
                        !on || self.cell(brick, cell)[corner] >= 0.0
                    })
                })
            })
        })
    }
}

static KNOWN: Known<Grid> = Known::new(BTreeMap::new());

impl Data for Grid {
    fn content(&self) -> u64 {
        self.content
    }

    fn words(&self, at: u32) -> ([u32; HEAD], Vec<u32>) {
        let Shape { origin: [x, y, z], cell, bricks: [i, j, k] } = self.shape;
        let bits = |c: f64| (c as f32).to_bits();
        let (corners, index) = (at, at + self.coarse.len() as u32);
        let fine = index + self.index.len() as u32;
        let head = [bits(x), bits(y), bits(z), bits(1.0 / cell), i, j, k, corners, index, fine, 0, 0, 0, 0, 0, 0];
        let samples = |from: &[f32]| from.iter().map(|v| v.to_bits()).collect::<Vec<u32>>();
        (head, [samples(&self.coarse), self.index.clone(), samples(&self.fine)].concat())
    }

    fn known() -> &'static Known<Self> {
        &KNOWN
    }
}

/// The trilinear mean of eight samples.
pub(super) fn interpolate(cell: &Cell, [x, y, z]: Vec3) -> f64 {
    let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
    let [a, b, c, d, e, f, g, h] = *cell;
    mix(mix(mix(a, b, x), mix(c, d, x), y), mix(mix(e, f, x), mix(g, h, x), y), z)
}

/// How fast that changes along x, y and z, in a cell of side one.
fn slopes(cell: &Cell, [x, y, z]: Vec3) -> Vec3 {
    let [a, b, c, d, e, f, g, h] = *cell;
    let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
    let plane = |[a, b, c, d]: [f64; 4], s: f64, t: f64| mix(mix(a, b, s), mix(c, d, s), t);
    [plane([b - a, d - c, f - e, h - g], y, z), plane([c - a, d - b, g - e, h - f], x, z), plane([e - a, f - b, g - c, h - d], x, y)]
}

/// The longest gradient within a cell of side one: at one of its corners, see [`Facts::lipschitz`].
fn slope(cell: &Cell) -> f64 {
    let squared = (0..8usize).map(|corner| {
        let along = |bit: usize| cell[corner | bit] - cell[corner & !bit];
        let [x, y, z] = [1, 2, 4].map(along);
        x * x + y * y + z * z
    });
    squared.fold(0.0, f64::max).sqrt()
}
