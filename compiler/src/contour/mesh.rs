//! A surface as triangles, the grid that it was found in, and why there is none.

use crate::evaluate::TooLarge;
use crate::vector::Vec3;

/// The most vertices of a mesh, about: twice as many triangles.
pub const MOST_VERTICES: usize = 4_000_000;

/// A surface of triangles, seen from outside in counterclockwise order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// The corners, in the scene's space.
    pub vertices: Vec<Vec3>,
    /// For each corner the surface's direction outward, of length one; the mean at an edge.
    pub normals: Vec<[f32; 3]>,
    /// Linear colour of each corner.
    pub colors: Vec<[f32; 3]>,
    /// Three indices of corners each.
    pub triangles: Vec<[u32; 3]>,
    /// How large a cell is.
    pub cell: f64,
    /// How many cells there are along the longest side.
    pub cells: u32,
    /// The largest distance from a triangle to the surface that was found; measured, not proven.
    pub deviation: f64,
}

/// Why there is no mesh.
#[derive(Clone, Debug, PartialEq)]
pub enum Refused {
    /// What is solid has no end that is known.
    Endless,
    /// A box reaches beyond the extent, where nothing is known of the scene.
    Beyond(f64),
    /// Nothing is solid, or not in the box, or all of it is.
    Empty,
    /// There would be more vertices than allowed, at so many cells along the longest side.
    TooMany(u32),
    /// The tolerance is not met with as many cells as allowed; the farthest triangle that was found, and the number of cells.
    Farther(f64, u32),
    /// So many edges are not in exactly two triangles: the field says different things of one place.
    Torn(usize),
    /// The formulas are too long.
    Long(TooLarge),
}

/// Cubic cells: where the first begins, how large they are, and how many there are along each axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    pub(super) low: Vec3,
    pub(super) cell: f64,
    pub(super) counts: [u32; 3],
}

/// A component.
pub(super) fn at(of: Vec3, axis: usize) -> f64 {
    of.get(axis).copied().unwrap_or(0.0)
}
