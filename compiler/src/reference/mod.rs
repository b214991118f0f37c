//! The picture in 64 bits: the twin of what the emitted module and the pass over the screen do on a GPU.

pub mod camera;
pub mod shade;
pub mod vector;

/// What a picture shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum View {
    /// The scene in its light.
    #[default]
    Shaded,
    /// The normals, each component from -1..1 to 0..1.
    Normals,
    /// How many steps a ray takes.
    Steps,
    /// How far the surface is.
    Depth,
}
