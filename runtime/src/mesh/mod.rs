//! Meshes: files of triangles, read into vertices and indices. What is broken is refused with words for a person; memory is bounded by
//! the size of the file, and no file may be larger than [`LARGEST_FILE`].

mod assets;
mod normals;
mod read;

pub use assets::Assets;

use bytemuck::{Pod, Zeroable};
use std::panic::{AssertUnwindSafe, catch_unwind};
use surefoot_compiler::compiled::Loader;

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

/// Triangles with normals.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// The corners.
    pub vertices: Vec<Vertex>,
    /// Three for each triangle: indices into the vertices.
    pub indices: Vec<u32>,
    /// Whether the file says where the corners lie on an image.
    pub mapped: bool,
    /// Least and greatest corner of the box that holds it.
    pub bounds: [[f32; 3]; 2],
}

/// What a file says, before anything is made of it.
#[derive(Clone, Debug, Default)]
struct Raw {
    positions: Vec<[f32; 3]>,
    /// As many as positions, or none.
    normals: Vec<[f32; 3]>,
    /// As many as positions, or none.
    coordinates: Vec<[f32; 2]>,
    indices: Vec<u32>,
}

impl Mesh {
    /// Reads a mesh. The end of its name says which format it has; files that it names are read too.
    pub fn load(loader: &dyn Loader, path: &str) -> Result<Self, String> {
        let bytes = loader.read_up_to(path, LARGEST_FILE)?;
        // The crates that read are careful, and yet each stops the program at some file; a scene must go on.
        let raw = catch_unwind(AssertUnwindSafe(|| read::read(loader, path, &bytes)))
            .unwrap_or_else(|_| Err("the file is broken".to_owned()))?;
        Self::of(raw)
    }

    /// Checks what a file says and makes the normals that it lacks.
    fn of(raw: Raw) -> Result<Self, String> {
        let count = raw.positions.len();
        if raw.indices.is_empty() {
            return Err("it has no triangles".to_owned());
        }
        if count > MOST_VERTICES || raw.indices.len() / 3 > MOST_TRIANGLES {
            return Err(format!("it has {count} vertices and {} triangles: too many", raw.indices.len() / 3));
        }
        if let Some(at) = raw.positions.iter().flatten().position(|c| !c.is_finite() || c.abs() > 1e15) {
            return Err(format!("vertex {} is nowhere: a coordinate is not a number, or too large", at / 3 + 1));
        }
        if let Some(index) = raw.indices.iter().find(|i| **i as usize >= count) {
            return Err(format!("a triangle names vertex {}, and there are {count}", u64::from(*index) + 1));
        }
        let mapped = raw.coordinates.len() == count && raw.coordinates.iter().flatten().all(|c| c.is_finite());
        let (vertices, indices) = normals::complete(raw, mapped)?;
        let bounds = vertices.iter().fold([[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]], |[low, high], vertex| {
            let p = vertex.position;
            [[0, 1, 2].map(|i| low[i].min(p[i])), [0, 1, 2].map(|i| high[i].max(p[i]))]
        });
        Ok(Self { vertices, indices, mapped, bounds })
    }
}
