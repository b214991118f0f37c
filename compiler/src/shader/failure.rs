//! Languages of shaders, and what is wrong with one.

use std::ops::Range;

/// Languages of shaders.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    /// The shading language of OpenGL, Vulkan and shadertoy.com.
    Glsl,
    /// The shading language of WebGPU.
    Wgsl,
}

impl Language {
    /// The language of a file, by the end of its name; none where it is no shader's.
    pub fn of(path: &str) -> Option<Self> {
        let (_, end) = path.rsplit_once('.')?;
        match end.to_ascii_lowercase().as_str() {
            "glsl" | "frag" | "fs" | "fsh" | "vert" | "comp" | "shadertoy" => Some(Language::Glsl),
            "wgsl" => Some(Language::Wgsl),
            _ => None,
        }
    }
}

/// What can't be read or said.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// The bytes of the shader.
    pub range: Range<usize>,
    /// What is wrong.
    pub message: String,
    /// What to write instead.
    pub help: String,
}

impl Failure {
    /// What naga's own checks rule out.
    pub(super) fn nowhere() -> Self {
        Self { range: 0..0, message: "this module is not whole".to_owned(), help: "write the shader anew".to_owned() }
    }
}
