//! Examples that come with the program: their texts, and small pictures of them.
//!
//! The pictures are those of `docs/gallery`: `convert menger.png -resize 256x144 -colors 200 PNG8:menger.png`.

/// A scene, with its picture.
#[derive(Debug)]
pub struct Example {
    /// What its file is called.
    pub name: &'static str,
    /// Its text.
    pub text: &'static str,
    /// Its picture, as PNG.
    pub picture: &'static [u8],
}

macro_rules! examples {
    ($($name:literal),*) => {
        &[$(Example {
            name: $name,
            text: include_str!(concat!("../../../examples/", $name, ".sdf")),
            picture: include_bytes!(concat!("examples/", $name, ".png")),
        }),*]
    };
}

/// All of them. None needs another file.
pub const EXAMPLES: &[Example] = examples!["csg", "repetition", "metaballs", "menger", "gyroid_ring", "turbulence", "lantern", "kaleidoscope", "glass"];

/// What a new scene begins with.
pub const TEMPLATE: &str = "\
param size = 1 in 0.2..2

material clay { color: #c8603a, roughness: 0.6 }

scene = box(size).round(0.1).material(clay) | plane(y).translate(0, -0.5 * size, 0)
";
