//! How far a grid is from the surface that it samples, at random places.

use super::grid::Grid;
use super::surface::Surface;
use crate::vector::{add, along, mul, scale, sub};
use rayon::prelude::*;

/// Places that one thread tries in a row.
const ROW: usize = 256;

/// Differences at places.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measured {
    /// How many places were tried.
    pub places: usize,
    /// The largest difference.
    pub largest: f64,
    /// The mean difference.
    pub mean: f64,
    /// Places of which the grid says the wrong side.
    pub wrong: usize,
    /// The greatest distance of such a place from the surface.
    pub farthest: f64,
    /// The most by which a value exceeded the distance beyond what [`super::Facts::excess`] allows; zero where none did.
    pub unsound: f64,
}

impl Measured {
    fn with(self, other: Self) -> Self {
        let places = self.places + other.places;
        Self {
            places,
            largest: self.largest.max(other.largest),
            mean: (self.mean * self.places as f64 + other.mean * other.places as f64) / places.max(1) as f64,
            wrong: self.wrong + other.wrong,
            farthest: self.farthest.max(other.farthest),
            unsound: self.unsound.max(other.unsound),
        }
    }
}

/// Compares a grid with its surface at so many places all over it, and at as many within a cell of the surface.
pub fn measure(grid: &Grid, surface: &Surface, places: usize) -> [Measured; 2] {
    let shape = grid.shape();
    let (origin, end, triangles) = (shape.origin, shape.end(), surface.triangles());
    let over = |near: bool| {
        let rows = (0..places.div_ceil(ROW)).into_par_iter().map(|row| {
            let mut chance = Chance((row as u64) << 32 | u64::from(near));
            let mut sum = Measured::default();
            let mut hint = 0;
            for _ in 0..ROW.min(places - row * ROW) {
                let p = if near {
                    let at = ((chance.next() * triangles.len() as f64) as usize).min(triangles.len().saturating_sub(1));
                    let Some(triangle) = triangles.get(at) else { continue };
                    hint = at as u32;
                    let (u, v) = (chance.next().sqrt(), chance.next());
                    let [a, b, c] = triangle.corners;
                    let foot = add(add(scale(a, 1.0 - u), scale(b, u * (1.0 - v))), scale(c, u * v));
                    along(foot, triangle.normal, (2.0 * chance.next() - 1.0) * shape.cell)
                } else {
                    add(origin, mul(sub(end, origin), [0; 3].map(|_| chance.next())))
                };
                let (exact, value) = (surface.signed(p, &mut hint), grid.value(p));
                let (off, wrong) = ((exact - value).abs(), (exact < 0.0) != (value < 0.0));
                let unsound = (value.abs() - exact.abs() - f64::from(grid.facts_at(p).excess)).max(0.0);
                let farthest = if wrong { exact.abs() } else { 0.0 };
                sum = sum.with(Measured { places: 1, largest: off, mean: off, wrong: usize::from(wrong), farthest, unsound });
            }
            sum
        });
        // One after the other, so that the mean is the same each time.
        rows.collect::<Vec<_>>().into_iter().fold(Measured::default(), Measured::with)
    };
    [over(false), over(true)]
}

/// Numbers by chance, the same each time (splitmix64; Steele, Lea and Flood, 2014).
struct Chance(u64);

impl Chance {
    /// From 0 to 1, without 1.
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}
