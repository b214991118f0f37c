//! Images that a scene names, as data: which files they are, and what is made of their pixels. Reading and decoding is the host's.

mod bitmap;
mod cube;
mod texture;

pub use bitmap::Bitmap;

pub use cube::{Cube, FACES};
pub use texture::{Texture, TextureKind, sides};

use crate::source::ImageFile;
use std::sync::Arc;

/// How images stand for the sky.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum EnvironmentKind {
    /// A folder with six faces, named by [`FACES`].
    Cubemap,
    /// One image, its columns the way around, its rows from straight up to straight down; -z is in its middle, x to the right of it.
    Equirect,
}

/// Images that stand for the sky.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct EnvironmentFile {
    /// How.
    pub kind: EnvironmentKind,
    /// The folder, or the file.
    pub file: ImageFile,
}

/// What the host read of a scene's images.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Images {
    /// What stands for the sky, where the scene names something and it could be read.
    pub environment: Option<Arc<Cube>>,
    /// What is made of the materials' images, in the order of [`crate::functions::Surface::textures`]; what could not be read changes nothing.
    pub textures: Vec<Arc<Texture>>,
}
