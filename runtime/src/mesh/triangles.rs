//! A mesh, checked and with normals.

use crate::mesh::raw::{LARGEST_FILE, MOST_TRIANGLES, MOST_VERTICES, Raw, Vertex};
use crate::mesh::{normals, read};
use std::panic::{AssertUnwindSafe, catch_unwind};
use surefoot_compiler::compiled::Loader;

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

impl Mesh {
    /// Reads a mesh. The end of its name says which format it has; files that it names are read too.
    pub fn load(loader: &dyn Loader, path: &str) -> Result<Self, String> {
        Self::from_bytes(loader, path, &loader.read_up_to(path, LARGEST_FILE)?)
    }

    /// The same of a file whose bytes were read.
    pub(super) fn from_bytes(loader: &dyn Loader, path: &str, bytes: &[u8]) -> Result<Self, String> {
        // The crates that read are careful, and yet each stops the program at some file; a scene must go on.
        let raw = catch_unwind(AssertUnwindSafe(|| read::read(loader, path, bytes)))
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
