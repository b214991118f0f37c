//! A field sampled into a grid that is as fine everywhere, and how far it is from the field.

// Indices are made from the grid's own counts.
#![allow(clippy::indexing_slicing)]

use super::bake::{MOST_DEVICE_BYTES, Settings, shape};
use super::grid::{BRICK, Grid, SIDE, VOLUME};
use crate::random::Random;
use crate::vector::Vec3;
use rayon::prelude::*;

/// Places at which a grid is compared with its field.
const PLACES: usize = 20_000;
/// Places that one thread asks for in a row.
const ROW: usize = 512;

/// Values of a field at places.
pub type Values<'a> = &'a (dyn Fn(&[Vec3]) -> Vec<f64> + Sync);

/// How far a grid is from its field, in the cells that the surface goes through.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Off {
    /// The largest difference that was found.
    pub largest: f64,
    /// The mean difference.
    pub mean: f64,
}

/// Samples a field in a box and around it. Fails where the grid would be too large.
pub fn sample(bounds: [Vec3; 2], settings: Settings, values: Values) -> Result<Grid, String> {
    let shape = shape(bounds, settings);
    if !shape.is_somewhere() {
        return Err("it is too small for where it stands: places a cell apart are the same in 64 bits".to_owned());
    }
    let bytes = 4 * (shape.count() * (VOLUME + 1) + shape.corners());
    if bytes > MOST_DEVICE_BYTES {
        return Err(format!("the grid would take {} MiB, and a device reads {} at most", bytes >> 20, MOST_DEVICE_BYTES >> 20));
    }
    let [x, y, z] = shape.bricks.map(|b| b as usize * BRICK + 1);
    let mut all = vec![0f32; x * y * z];
    all.par_chunks_mut(x * y).enumerate().for_each(|(k, layer)| {
        let places: Vec<Vec3> = (0..x * y).map(|i| shape.at([i % x, i / x, k])).collect();
        for (value, found) in layer.iter_mut().zip(values(&places)) {
            *value = found as f32;
        }
    });
    let at = |[i, j, k]: [usize; 3]| all[i + x * (j + y * k)];
    let [across, up] = [0, 1].map(|axis| shape.bricks[axis] as usize + 1);
    let coarse = (0..shape.corners()).map(|i| at([i % across, i / across % up, i / across / up].map(|c| c * BRICK))).collect();
    let fine = (0..shape.count() * VOLUME).map(|i| {
        let (place, local) = (shape.place(i / VOLUME), i % VOLUME);
        let local = [local % SIDE, local / SIDE % SIDE, local / SIDE / SIDE];
        at([0, 1, 2].map(|axis| place[axis] * BRICK + local[axis]))
    });
    Ok(Grid::new(shape, coarse, (1..=shape.count() as u32).collect(), fine.collect()))
}

/// Compares a grid with its field at places by chance, the same each time.
pub fn compare(grid: &Grid, values: Values) -> Off {
    let shape = grid.shape();
    let cells = shape.bricks.map(|b| b as usize * BRICK);
    let crossed: Vec<Vec3> = (0..cells.iter().product::<usize>())
        .into_par_iter()
        .map(|i| [i % cells[0], i / cells[0] % cells[1], i / cells[0] / cells[1]])
        .filter(|cell| {
            let corners = (0..8usize).map(|bit| [0, 1, 2].map(|axis| cell[axis] + (bit >> axis & 1)));
            let is_inside = |corner| grid.inside(shape.at(corner)) < 0.0;
            let count = corners.filter(|corner| is_inside(*corner)).count();
            (1..8).contains(&count)
        })
        .map(|cell| shape.at(cell))
        .collect();
    if crossed.is_empty() {
        return Off::default();
    }
    let rows = (0..PLACES.div_ceil(ROW)).into_par_iter().map(|row| {
        let mut random = Random(row as u64);
        let places: Vec<Vec3> = (0..ROW)
            .map(|_| {
                let corner = crossed[((random.next() * crossed.len() as f64) as usize).min(crossed.len() - 1)];
                corner.map(|c| c + shape.cell * random.next())
            })
            .collect();
        let off = values(&places).into_iter().zip(&places).map(|(value, p)| (value - grid.inside(*p)).abs());
        off.fold((0.0, 0.0), |(largest, sum): (f64, f64), off| (largest.max(off), sum + off))
    });
    // One after the other, so that the mean is the same each time.
    let rows: Vec<(f64, f64)> = rows.collect();
    let (largest, sum) = rows.iter().fold((0.0, 0.0), |(largest, sum): (f64, f64), row| (largest.max(row.0), sum + row.1));
    Off { largest, mean: sum / (rows.len() * ROW) as f64 }
}
