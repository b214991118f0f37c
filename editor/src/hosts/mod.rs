//! What `compile --for` writes: a scene in the form in which one host takes it, so that a single command ends with a picture.

mod digest;
mod page;
mod shadertoy;

use serde_json::Value;
use surefoot_compiler::Options;
use surefoot_compiler::compiled::{Compiled, Entry, Live, Uniforms};
use surefoot_compiler::emit::{Target, translate, vertex_shader};

/// What names of these modules begin with.
const PREFIX: &str = "sf_";

const UNDRAWN: &str = "the scene can't be drawn";

/// How a page shows a scene.
#[derive(Clone, Debug, Default)]
pub struct Showing {
    /// Width and height in CSS pixels; else it fills the window.
    pub size: Option<(u32, u32)>,
    /// Whether there is nothing beside the picture.
    pub bare: bool,
    /// What is seen before the first picture, and where nothing can draw one: a JPEG.
    pub poster: Option<Vec<u8>>,
}

/// A host.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Host {
    /// A page that draws by WebGPU, or by WebGL 2.
    Html,
    /// A fragment shader for shadertoy.com.
    Shadertoy,
    /// Shaders for Vulkan, as SPIR-V or as GLSL.
    Vulkan,
}

impl Host {
    /// All of them.
    pub const ALL: [Host; 3] = [Host::Html, Host::Shadertoy, Host::Vulkan];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Host::Html => "html",
            Host::Shadertoy => "shadertoy",
            Host::Vulkan => "vulkan",
        }
    }

    /// How its files end.
    pub fn endings(self) -> &'static [&'static str] {
        match self {
            Host::Html => &["html", "htm"],
            Host::Shadertoy => &["glsl", "frag", "txt"],
            Host::Vulkan => &["spv", "frag", "vert"],
        }
    }

    /// Whether it has storage buffers, from which grids are read.
    pub fn has_buffers(self) -> bool {
        self == Host::Html
    }

    /// What its module is: one that draws, in which all is computed from parameters and time.
    pub fn options(self) -> Options {
        let uniforms = if self == Host::Shadertoy { Uniforms::Private } else { Uniforms::Block };
        Options { exports: Vec::new(), prefix: PREFIX.to_owned(), entry: Entry::Draw, live_in_shader: true, uniforms, ..Options::default() }
    }

    /// The file, of a scene with that module; `title` is what a person calls it, `parameters` are its parameters as data, `ending` is how its name ends.
    pub fn write(self, compiled: &Compiled, parameters: &[Value], title: &str, ending: &str) -> Result<Vec<u8>, String> {
        if !compiled.module.draws {
            return Err(UNDRAWN.to_owned());
        }
        match self {
            Host::Html => page(compiled, &compiled.live(), parameters, title, &Showing::default()),
            Host::Shadertoy => shadertoy::write(compiled).map(String::into_bytes),
            Host::Vulkan if ending == "spv" => translate(&compiled.module, PREFIX, Target::Spirv),
            Host::Vulkan if ending == "vert" => vertex_shader(&compiled.module, PREFIX),
            Host::Vulkan => translate(&compiled.module, PREFIX, Target::Glsl450),
        }
    }
}

/// The page of a scene whose module is that of [`Host::Html`], with these values at its start.
pub fn page(compiled: &Compiled, live: &Live, parameters: &[Value], title: &str, showing: &Showing) -> Result<Vec<u8>, String> {
    if !compiled.module.draws {
        return Err(UNDRAWN.to_owned());
    }
    Ok(page::write(compiled, live, parameters, title, showing).into_bytes())
}
