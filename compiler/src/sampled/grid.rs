//! A grid of signed distances: coarse everywhere, fine in bricks near the surface.

// Indices are made from the grid's own counts, and a grid is only made with as many samples as they say.
#![allow(clippy::indexing_slicing)]

use crate::vector::Vec3;
use rayon::prelude::*;

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
}

/// The eight samples of a cell, x first.
type Cell = [f64; 8];

impl Grid {
    /// A grid of samples. Their numbers must fit.
    pub(super) fn new(shape: Shape, coarse: Vec<f32>, index: Vec<u32>, fine: Vec<f32>) -> Self {
        let mut grid = Self { shape, coarse, index, fine, facts: Vec::new() };
        let all = 0..shape.count();
        // Those without samples first: their excess reaches the faces of their neighbours.
        grid.facts = all.clone().into_par_iter().map(|brick| if grid.index[brick] == 0 { grid.known(brick, 0.0) } else { Facts::default() }).collect();
        let of = |brick: usize| match grid.index[brick] {
            0 => grid.facts[brick],
            _ => grid.known(brick, grid.excess_around(brick)),
        };
        grid.facts = all.into_par_iter().map(of).collect();
        grid
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
        let mut place = [0; 3];
        let mut cell = [0; 3];
        let mut rest = [0.0; 3];
        for i in 0..3 {
            let bricks = self.shape.bricks[i] as usize;
            let cells = ((p[i] - self.shape.origin[i]) / self.shape.cell).clamp(0.0, (bricks * BRICK) as f64);
            let whole = (cells as usize).min(bricks * BRICK - 1);
            (place[i], cell[i], rest[i]) = (whole / BRICK, whole % BRICK, cells - whole as f64);
        }
        let brick = self.shape.number(place);
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
        let (brick, cell, at) = self.find(p);
        let value = interpolate(&self.cell(brick, cell), at);
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

/// The trilinear mean of eight samples.
pub(super) fn interpolate(cell: &Cell, [x, y, z]: Vec3) -> f64 {
    let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
    let [a, b, c, d, e, f, g, h] = *cell;
    mix(mix(mix(a, b, x), mix(c, d, x), y), mix(mix(e, f, x), mix(g, h, x), y), z)
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
