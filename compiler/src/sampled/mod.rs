//! A mesh of triangles as a grid of signed distances: read by interpolation, exact at its samples. Plain data in, plain data out.
//!
//! [`Surface`] examines triangles and answers how far a point is from them and on which side; [`bake`] samples it into a [`Grid`].

mod bake;
mod boxes;
mod dense;
mod examine;
mod file;
mod grid;
mod measure;
mod surface;
mod triangle;

pub use bake::{MOST_BYTES, MOST_DEVICE_BYTES, RESOLUTIONS, Settings, bake};
pub use dense::{Off, Values, compare, sample};
pub use examine::{Findings, MOST_TRIANGLES};
pub use grid::{BRICK, Facts, Grid, Hull, Shape};
pub use measure::{Measured, measure};
pub use surface::{Near, Sign, Surface};
pub use triangle::{Part, Triangle};
pub(crate) use boxes::Boxes;
