//! What `compile --for` writes: a scene in the form in which one host takes it, so that a single command ends with a picture.

mod digest;
mod page;
mod shadertoy;

use serde_json::Value;
use surefoot_compiler::Options;
use surefoot_compiler::compiled::{Compiled, Entry, Uniforms};

/// A host.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Host {
    /// A page that draws by WebGPU.
    Html,
    /// A fragment shader for shadertoy.com.
    Shadertoy,
}

impl Host {
    /// All of them.
    pub const ALL: [Host; 2] = [Host::Html, Host::Shadertoy];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Host::Html => "html",
            Host::Shadertoy => "shadertoy",
        }
    }

    /// How its files end.
    pub fn endings(self) -> &'static [&'static str] {
        match self {
            Host::Html => &["html", "htm"],
            Host::Shadertoy => &["glsl", "frag", "txt"],
        }
    }

    /// Whether it has storage buffers, from which grids are read.
    pub fn has_buffers(self) -> bool {
        self == Host::Html
    }

    /// What its module is: one that draws, in which all is computed from parameters and time.
    pub fn options(self) -> Options {
        let uniforms = if self == Host::Html { Uniforms::Block } else { Uniforms::Private };
        Options { exports: Vec::new(), entry: Entry::Draw, live_in_shader: true, uniforms, ..Options::default() }
    }

    /// The file, of a scene with that module; `title` is what a person calls it, `parameters` are its parameters as data.
    pub fn write(self, compiled: &Compiled, parameters: &[Value], title: &str) -> Result<String, String> {
        if !compiled.module.draws {
            return Err("the scene can't be drawn".to_owned());
        }
        match self {
            Host::Html => Ok(page::write(compiled, parameters, title)),
            Host::Shadertoy => shadertoy::write(compiled),
        }
    }
}
