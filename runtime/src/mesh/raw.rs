//! What a file of triangles says, and how much of it is taken.

use bytemuck::{Pod, Zeroable};

/// Larger files are refused.
pub const LARGEST_FILE: u64 = 256 << 20;
/// The most vertices of a mesh: a buffer of them is one that every device takes.
pub const MOST_VERTICES: usize = (128 << 20) / size_of::<Vertex>();
/// The most triangles of a mesh.
pub const MOST_TRIANGLES: usize = (128 << 20) / 12;

/// A corner of triangles, in the mesh's own space.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Vertex {
    /// Where it is.
    pub position: [f32; 3],
    /// The surface's direction, of length one.
    pub normal: [f32; 3],
    /// Where it lies on an image: from 0 to 1, to the right and down. Zero where the file says nothing.
    pub coordinates: [f32; 2],
}

/// What a file says, before anything is made of it.
#[derive(Clone, Debug, Default)]
pub(super) struct Raw {
    pub positions: Vec<[f32; 3]>,
    /// As many as positions, or none.
    pub normals: Vec<[f32; 3]>,
    /// As many as positions, or none.
    pub coordinates: Vec<[f32; 2]>,
    pub indices: Vec<u32>,
}
