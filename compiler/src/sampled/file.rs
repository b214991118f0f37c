//! A grid as bytes, `.sfgrid`. All numbers are little-endian:
//!
//! | bytes | what |
//! |---|---|
//! | 6 | `SFGRID` |
//! | 2 | version, 1 |
//! | 4 | cells of a brick along each axis, 8 |
//! | 3 × 4 | bricks along x, y, z |
//! | 4 | bricks with samples |
//! | 3 × 8, 8 | least corner and side of a cell, 64 bits |
//! | 4 each | samples at the corners of bricks, x first, 32 bits |
//! | 4 each | of each brick, x first, the number of its samples from 1 on, in order; 0 where it has none |
//! | 729 × 4 each | samples of bricks, x first, 32 bits |
//!
//! Constants and errors are not kept: who reads derives them from the samples.

use super::grid::{BRICK, Grid, Shape, VOLUME};

const MAGIC: &[u8; 6] = b"SFGRID";
const VERSION: u16 = 1;
const HEADER: usize = 6 + 2 + 4 + 12 + 4 + 32;

impl Grid {
    /// Its bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let shape = self.shape;
        let mut bytes = MAGIC.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        for number in [BRICK as u32].into_iter().chain(shape.bricks).chain([self.fine_bricks() as u32]) {
            bytes.extend(number.to_le_bytes());
        }
        for number in shape.origin.into_iter().chain([shape.cell]) {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend(self.coarse.iter().flat_map(|v| v.to_le_bytes()));
        bytes.extend(self.index.iter().flat_map(|v| v.to_le_bytes()));
        bytes.extend(self.fine.iter().flat_map(|v| v.to_le_bytes()));
        bytes
    }

    /// Reads a grid. What is broken is an error; memory stays within some times the number of the bytes.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, String> {
        let (header, body) = bytes.split_at_checked(HEADER).ok_or("it ends within its header")?;
        let (magic, mut header) = header.split_at(MAGIC.len());
        if magic != MAGIC {
            return Err("it is no grid of distances: it does not begin with SFGRID".to_owned());
        }
        let [version] = take(&mut header, u16::from_le_bytes).ok_or("it ends within its header")?;
        if version != VERSION {
            return Err(format!("it is of version {version}, and only {VERSION} is known"));
        }
        let [brick, x, y, z, count] = take(&mut header, u32::from_le_bytes).ok_or("it ends within its header")?;
        let [ox, oy, oz, cell] = take(&mut header, f64::from_le_bytes).ok_or("it ends within its header")?;
        if brick as usize != BRICK {
            return Err(format!("its bricks have {brick} cells a side, and only {BRICK} is known"));
        }
        let shape = Shape { origin: [ox, oy, oz], cell, bricks: [x, y, z] };
        if !shape.bricks.iter().all(|b| (1..=1 << 16).contains(b)) {
            return Err(format!("it has {x} × {y} × {z} bricks, and 1 to {} along each axis are known", 1 << 16));
        }
        if !shape.is_somewhere() {
            return Err("it lies nowhere: its corner or the side of its cells is no place, or too large".to_owned());
        }
        // At most 2⁵¹, so that no product overflows.
        let samples = |number: u64, each: u64| number * each * 4;
        let [corners, bricks] = [1u64, 0].map(|more| shape.bricks.iter().map(|b| u64::from(*b) + more).product());
        let wanted = samples(corners, 1) + samples(bricks, 1) + samples(u64::from(count), VOLUME as u64);
        if body.len() as u64 != wanted {
            return Err(format!("it has {} bytes after its header, and should have {wanted}", body.len()));
        }
        let (coarse, rest) = body.split_at(4 * corners as usize);
        let (index, fine) = rest.split_at(4 * bricks as usize);
        let index: Vec<u32> = index.as_chunks().0.iter().map(|b| u32::from_le_bytes(*b)).collect();
        if !index.iter().filter(|number| **number != 0).copied().eq(1..=count) {
            return Err("the numbers of its bricks are not in order".to_owned());
        }
        let numbers = |bytes: &[u8]| -> Result<Vec<f32>, String> {
            let all: Vec<f32> = bytes.as_chunks().0.iter().map(|b| f32::from_le_bytes(*b)).collect();
            match all.iter().position(|v| !v.is_finite()) {
                Some(at) => Err(format!("sample {} is not a number", at + 1)),
                None => Ok(all),
            }
        };
        let grid = Self::new(shape, numbers(coarse)?, index, numbers(fine)?);
        if !grid.has_outside() {
            return Err("a place on its wall is inside of the solid".to_owned());
        }
        Ok(grid)
    }
}

/// The next numbers of some bytes; none where these end.
fn take<const WIDTH: usize, const COUNT: usize, T: Copy + Default>(bytes: &mut &[u8], read: fn([u8; WIDTH]) -> T) -> Option<[T; COUNT]> {
    let (these, rest) = bytes.split_at_checked(WIDTH * COUNT)?;
    *bytes = rest;
    let mut numbers = [T::default(); COUNT];
    for (number, bytes) in numbers.iter_mut().zip(these.as_chunks().0) {
        *number = read(*bytes);
    }
    Some(numbers)
}
