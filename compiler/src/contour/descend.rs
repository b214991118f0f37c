//! Which bricks of cells may hold the surface: from large blocks to small ones, each left out of which the bound proves that it is empty.

use super::field::Field;
use super::{Grid, MOST_VERTICES, Refused};
use crate::vector::{Vec3, add, scale};
use crate::spread::spread;

/// Cells along each axis of a brick.
pub(super) const BRICK: u32 = 4;
/// Blocks along the longest side with which the descent begins, at most.
const FIRST: u32 = 8;
/// Blocks that one task looks at.
const SHARE: usize = 1024;
/// More bricks are refused: a brick through which the surface goes has a dozen vertices and more.
const MOST_BRICKS: usize = MOST_VERTICES;

/// Bricks that may hold the surface, by their place in bricks; none where there are too many.
pub(super) fn descend(field: &Field, grid: &Grid) -> Result<Option<Vec<[u32; 3]>>, Refused> {
    let bricks = grid.counts.map(|n| n.div_ceil(BRICK));
    let most = bricks.into_iter().max().unwrap_or(1);
    // How wide a block is, in bricks.
    let mut wide = 1;
    while most.div_ceil(wide) > FIRST {
        wide *= 2;
    }
    let [x, y, z] = bricks.map(|n| n.div_ceil(wide));
    let mut blocks: Vec<[u32; 3]> = (0..z).flat_map(|k| (0..y).flat_map(move |j| (0..x).map(move |i| [i, j, k]))).collect();
    loop {
        blocks = full(field, grid, &blocks, wide * BRICK);
        if wide == 1 || blocks.is_empty() {
            return Ok((blocks.len() <= MOST_BRICKS).then_some(blocks));
        }
        if blocks.len() > MOST_BRICKS {
            return Ok(None);
        }
        wide /= 2;
        let counts = bricks.map(|n| n.div_ceil(wide));
        let parts = |[i, j, k]: [u32; 3]| (0..8).map(move |part| [2 * i + (part & 1), 2 * j + (part >> 1 & 1), 2 * k + (part >> 2)]);
        let inside = |block: &[u32; 3]| block.iter().zip(counts).all(|(at, count)| *at < count);
        blocks = blocks.into_iter().flat_map(parts).filter(inside).collect();
    }
}

/// Those blocks, `wide` cells along each side, that are not proven to be empty.
fn full(field: &Field, grid: &Grid, blocks: &[[u32; 3]], wide: u32) -> Vec<[u32; 3]> {
    let side = grid.cell * f64::from(wide);
    // A hair more than half of the diagonal, for rounding.
    let reach = 0.5 * 3f64.sqrt() * side * (1.0 + 1e-6);
    let shares: Vec<&[[u32; 3]]> = blocks.chunks(SHARE).collect();
    let found = spread(shares.len(), &|| field.eyes(), &|eyes, i| {
        let share = shares.get(i).copied().unwrap_or_default();
        let middles: Vec<Vec3> = share.iter().map(|at| add(grid.corner(at.map(|c| c * wide)), [0.5 * side; 3])).collect();
        let bounds = eyes.bounds(&middles);
        // What is no number is no proof.
        let holds = |bound: f64| bound.abs() <= reach || bound.is_nan();
        share.iter().zip(bounds).filter(|(_, bound)| holds(*bound)).map(|(at, _)| *at).collect::<Vec<_>>()
    });
    found.into_iter().flatten().collect()
}

/// A box about all cells of a coarse grid that may hold the surface.
pub(super) fn close_box(field: &Field, grid: &Grid) -> Result<[Vec3; 2], Refused> {
    let bricks = descend(field, grid)?.unwrap_or_default();
    // Once more, cell by cell.
    let parts = |at: [u32; 3]| (0..BRICK * BRICK * BRICK).map(move |i| cell_of(at, i));
    let cells = full(field, grid, &bricks.into_iter().flat_map(parts).collect::<Vec<_>>(), 1);
    if cells.is_empty() {
        return Err(Refused::Empty);
    }
    let fold = |pick: fn(u32, u32) -> u32, start: u32| cells.iter().fold([start; 3], |[x, y, z], [a, b, c]| [pick(x, *a), pick(y, *b), pick(z, *c)]);
    let (low, high) = (fold(u32::min, u32::MAX), fold(u32::max, 0));
    Ok([grid.corner(low), add(grid.corner(high), scale([1.0; 3], grid.cell))])
}

/// A cell of a brick, by its place in cells; `index` counts x first.
pub(super) fn cell_of([x, y, z]: [u32; 3], index: u32) -> [u32; 3] {
    [x * BRICK + index % BRICK, y * BRICK + index / BRICK % BRICK, z * BRICK + index / (BRICK * BRICK)]
}
