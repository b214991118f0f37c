//! Meshes: files of triangles, read into vertices and indices. What is broken is refused with words for a person; memory is bounded by
//! the size of the file, and no file may be larger than [`LARGEST_FILE`].

mod assets;
pub mod field;
mod normals;
mod raw;
mod read;
mod shelf;
mod triangles;

pub use assets::Assets;
pub use raw::{LARGEST_FILE, MOST_TRIANGLES, MOST_VERTICES, Vertex};
pub use triangles::Mesh;
