//! A surface sampled into a grid, on all cores.

// Indices are made from the grid's own counts.
#![allow(clippy::indexing_slicing)]

use super::grid::{BRICK, Grid, SIDE, Shape, VOLUME, interpolate};
use super::surface::Surface;
use crate::vector::Vec3;
use rayon::prelude::*;
use smallvec::SmallVec;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Grids that would take more memory are refused.
pub const MOST_BYTES: usize = 1 << 30;
/// The most that all grids of a scene take on a device: every one binds a buffer of 128 MiB.
pub const MOST_DEVICE_BYTES: usize = 120 << 20;
/// Cells along the longest side.
pub const RESOLUTIONS: std::ops::RangeInclusive<u32> = 8..=1024;

/// How fine a grid is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Cells along the longest side of the grid, rounded up to whole bricks.
    pub resolution: u32,
    /// Room around the mesh, as a share of its longest side: 0.01 to 1.
    pub padding: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self { resolution: 128, padding: 0.05 }
    }
}

/// A sample of a brick that is nobody else's to compute, or where its value comes from.
enum Source {
    /// It is computed here.
    Own,
    /// It is at a corner of bricks.
    Corner(usize),
    /// It lies on a face of this brick without samples.
    Coarse(usize),
    /// This brick has it.
    Of(usize),
}

/// Samples a surface. `progress` hears which part is done, from any thread. Fails where the grid would be too large.
pub fn bake(surface: &Surface, settings: Settings, progress: &(dyn Fn(f64) + Sync)) -> Result<Grid, String> {
    if !RESOLUTIONS.contains(&settings.resolution) {
        return Err(format!("a grid has {} to {} cells along its longest side", RESOLUTIONS.start(), RESOLUTIONS.end()));
    }
    if !(0.01..=1.0).contains(&settings.padding) {
        return Err("the padding is a share of the longest side, from 0.01 to 1".to_owned());
    }
    let shape = shape(surface.bounds(), settings);
    if !shape.is_somewhere() {
        return Err("it is too small for where it stands: places a cell apart are the same in 64 bits".to_owned());
    }
    let (coarse, hints) = corners(surface, &shape);
    let around = |brick: usize| {
        let [i, j, k] = shape.place(brick);
        [0, 1, 2, 3, 4, 5, 6, 7].map(|bit| shape.corner([i + (bit & 1), j + (bit >> 1 & 1), k + (bit >> 2)]))
    };
    // Where the surface may be within the brick, no place of which is further than half of its diagonal, √3/2 = 0.866 sides, from a corner; and where
    // the side changes, as in a hole of the mesh.
    let reach = 0.87 * shape.brick();
    let is_fine = |brick: &usize| {
        let values = around(*brick).map(|corner| f64::from(coarse[corner]));
        values.iter().any(|v| v.abs() <= reach) || values.iter().any(|v| *v < 0.0) && values.iter().any(|v| *v >= 0.0)
    };
    let bricks: Vec<usize> = (0..shape.count()).into_par_iter().filter(is_fine).collect();
    let bytes = 4 * (bricks.len() * VOLUME + shape.corners() + 3 * shape.count());
    if bytes > MOST_BYTES {
        return Err(format!("the grid would take {} MiB, and {} are the most: lower the resolution", bytes >> 20, MOST_BYTES >> 20));
    }
    let mut index = vec![0u32; shape.count()];
    for (number, brick) in bricks.iter().enumerate() {
        index[*brick] = number as u32 + 1;
    }
    let mut fine = vec![0f32; bricks.len() * VOLUME];
    let done = AtomicUsize::new(0);
    fine.par_chunks_mut(VOLUME).zip(&bricks).for_each(|(samples, brick)| {
        let place = shape.place(*brick);
        let mut hint = hints[shape.corner(place)];
        for row in 0..SIDE * SIDE {
            let (j, k) = (row % SIDE, row / SIDE);
            let j = if k % 2 == 0 { j } else { BRICK - j };
            for i in 0..SIDE {
                // There and back, so that the next sample is always near.
                let i = if row % 2 == 0 { i } else { BRICK - i };
                let sample = &mut samples[i + SIDE * (j + SIDE * k)];
                let at = [0, 1, 2].map(|axis| place[axis] * BRICK + [i, j, k][axis]);
                match source(&shape, &index, *brick, [i, j, k]) {
                    Source::Own => *sample = surface.signed(shape.at(at), &mut hint) as f32,
                    Source::Corner(corner) => *sample = coarse[corner],
                    Source::Coarse(other) => {
                        let from = shape.place(other);
                        let t = [0, 1, 2].map(|axis| (at[axis] as f64 / BRICK as f64) - from[axis] as f64);
                        *sample = interpolate(&around(other).map(|corner| f64::from(coarse[corner])), t) as f32;
                    }
                    Source::Of(_) => {}
                }
            }
        }
        progress((done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / bricks.len() as f64);
    });
    for (number, brick) in bricks.iter().enumerate() {
        let place = shape.place(*brick);
        for local in 0..VOLUME {
            let at = [local % SIDE, local / SIDE % SIDE, local / SIDE / SIDE];
            if let Source::Of(owner) = source(&shape, &index, *brick, at) {
                let from = shape.place(owner);
                let [i, j, k] = [0, 1, 2].map(|axis| place[axis] * BRICK + at[axis] - from[axis] * BRICK);
                fine[number * VOLUME + local] = fine[(index[owner] as usize - 1) * VOLUME + i + SIDE * (j + SIDE * k)];
            }
        }
    }
    Ok(Grid::new(shape, coarse, index, fine))
}

/// The grid that fits a box.
pub(super) fn shape([low, high]: [Vec3; 2], settings: Settings) -> Shape {
    let size = [0, 1, 2].map(|i| high[i] - low[i]);
    let longest = size.into_iter().fold(0.0, f64::max);
    let wanted = size.map(|s| s + 2.0 * settings.padding * longest);
    let cell = longest * (1.0 + 2.0 * settings.padding) / f64::from(settings.resolution);
    // The longest side is a whole number of cells but for its last digit.
    let bricks = wanted.map(|w| (w / cell / BRICK as f64 - 1e-9).ceil().max(1.0) as u32);
    let origin = [0, 1, 2].map(|i| 0.5 * (low[i] + high[i]) - 0.5 * cell * f64::from(bricks[i]) * BRICK as f64);
    Shape { origin, cell, bricks }
}

/// The values at the corners of bricks, and the triangles next to them.
fn corners(surface: &Surface, shape: &Shape) -> (Vec<f32>, Vec<u32>) {
    let [x, y, _] = shape.bricks.map(|b| b as usize + 1);
    let mut found = vec![(0f32, 0u32); shape.corners()];
    found.par_chunks_mut(x).enumerate().for_each(|(row, samples)| {
        let mut hint = 0;
        for (i, sample) in samples.iter_mut().enumerate() {
            let p = shape.at([i * BRICK, row % y * BRICK, row / y * BRICK]);
            *sample = (surface.signed(p, &mut hint) as f32, hint);
        }
    });
    found.into_iter().unzip()
}

/// Where the value of a sample of a brick comes from.
fn source(shape: &Shape, index: &[u32], brick: usize, at: [usize; 3]) -> Source {
    let inner = |c: usize| c != 0 && c != BRICK;
    if at.iter().all(|c| inner(*c)) {
        return Source::Own;
    }
    let place = shape.place(brick);
    if !at.iter().any(|c| inner(*c)) {
        return Source::Corner(shape.corner([0, 1, 2].map(|i| place[i] + at[i] / BRICK)));
    }
    // All bricks that have it, in one order for all of them.
    let touching: [SmallVec<[usize; 2]>; 3] = [0, 1, 2].map(|i| {
        let first = if at[i] == 0 { place[i].saturating_sub(1) } else { place[i] };
        let last = if at[i] == BRICK { (place[i] + 1).min(shape.bricks[i] as usize - 1) } else { place[i] };
        (first..=last).collect()
    });
    let mut owner = None;
    for k in &touching[2] {
        for j in &touching[1] {
            for i in &touching[0] {
                let other = shape.number([*i, *j, *k]);
                if index[other] == 0 {
                    return Source::Coarse(other);
                }
                owner = owner.or(Some(other));
            }
        }
    }
    match owner {
        Some(owner) if owner != brick => Source::Of(owner),
        _ => Source::Own,
    }
}

impl Grid {
    /// The samples that are the mesh's own distance, not what a neighbour says so that no value jumps: their places, and their values.
    pub fn samples(&self) -> Vec<([usize; 3], f32)> {
        let shape = self.shape;
        let mut all = Vec::new();
        for brick in 0..shape.count() {
            let (place, number) = (shape.place(brick), self.index[brick] as usize);
            for local in 0..if number > 0 { VOLUME } else { 0 } {
                let at = [local % SIDE, local / SIDE % SIDE, local / SIDE / SIDE];
                if matches!(source(&shape, &self.index, brick, at), Source::Own) {
                    all.push(([0, 1, 2].map(|i| place[i] * BRICK + at[i]), self.fine[(number - 1) * VOLUME + local]));
                }
            }
        }
        let [x, y, _] = shape.bricks.map(|b| b as usize + 1);
        all.extend(self.coarse.iter().enumerate().map(|(i, value)| ([i % x * BRICK, i / x % y * BRICK, i / x / y * BRICK], *value)));
        all
    }
}
