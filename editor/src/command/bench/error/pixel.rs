//! What is certain of a pixel.

use surefoot_compiler::vector::Vec3;

/// What is certain of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pixel {
    /// The ray meets the surface first here.
    Hit {
        /// How far along the ray.
        t: f64,
        /// The cosine of the angle between the ray and the normal.
        facing: f64,
        /// The gradient of the field, of length one.
        normal: Vec3,
    },
    /// It meets nothing.
    Miss,
    /// Nobody knows.
    Unknown(Doubt),
}

/// What is not known of a pixel: nothing is met before, and here it is not certain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Doubt {
    /// How far along the ray.
    pub t: f64,
    /// Why.
    pub why: &'static str,
}
