//! What `compile --for` writes: a scene in the form in which one host takes it, so that a single command ends with a picture.

#![doc = include_str!("../README.md")]

mod bevy;
mod digest;
mod drawn;
mod engine;
mod fields;
mod fill;
mod glsl;
mod godot;
mod page;
mod parameter;
mod shader;
mod shadertoy;
mod three;
mod wgpu_py;

use engine::Engine;
use fields::PREFIX;
pub use drawn::Drawn;
pub use page::{DRAW, SHOW, Showing};
pub use parameter::{parameter_json, parameters};
use serde_json::Value;
use surefoot_compiler::Options;
use surefoot_compiler::compiled::{Colors, Compiled, Entry, Live, Module, Uniforms};
use surefoot_compiler::emit::{Target, translate, vertex_shader};

const UNDRAWN: &str = "the scene can't be drawn";

/// A host.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Host {
    /// A page that draws by WebGPU, or by WebGL 2.
    Html,
    /// A module for three.js and its WebGPURenderer.
    Three,
    /// A module for three.js and its WebGLRenderer.
    ThreeWebgl,
    /// A module for Babylon.js and its WebGPUEngine.
    Babylon,
    /// A module for PlayCanvas with WebGPU.
    Playcanvas,
    /// A module for Python and wgpu-py.
    WgpuPy,
    /// A fragment shader for shadertoy.com.
    Shadertoy,
    /// A shader for Godot 4.
    Godot,
    /// A shader for Bevy, and a plugin beside it.
    Bevy,
    /// Shaders for Direct3D.
    Hlsl,
    /// Shaders for Metal.
    Msl,
    /// Shaders for Vulkan, as SPIR-V or as GLSL.
    Vulkan,
}

impl Host {
    /// All of them.
    pub const ALL: [Host; 12] = [
        Host::Html,
        Host::Three,
        Host::ThreeWebgl,
        Host::Babylon,
        Host::Playcanvas,
        Host::WgpuPy,
        Host::Godot,
        Host::Bevy,
        Host::Shadertoy,
        Host::Vulkan,
        Host::Hlsl,
        Host::Msl,
    ];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Host::Html => "html",
            Host::Three => "three",
            Host::ThreeWebgl => "three-webgl",
            Host::Babylon => "babylon",
            Host::Playcanvas => "playcanvas",
            Host::WgpuPy => "wgpu-py",
            Host::Shadertoy => "shadertoy",
            Host::Godot => "godot",
            Host::Bevy => "bevy",
            Host::Vulkan => "vulkan",
            Host::Hlsl => "hlsl",
            Host::Msl => "msl",
        }
    }

    /// How its files end.
    pub fn endings(self) -> &'static [&'static str] {
        match self {
            Host::Html => &["html", "htm"],
            Host::Three | Host::ThreeWebgl | Host::Babylon | Host::Playcanvas => &["js", "mjs"],
            Host::WgpuPy => &["py"],
            Host::Shadertoy => &["glsl", "frag", "txt"],
            Host::Godot => &["gdshader", "txt"],
            Host::Bevy => &["wgsl"],
            Host::Vulkan => &["spv", "frag", "vert"],
            Host::Hlsl => &["hlsl"],
            Host::Msl => &["metal", "msl"],
        }
    }

    /// Refuses a scene that it can't draw: `mesh_field`, `baked` and long texts read storage buffers, and most of these files have none.
    pub fn takes(self, compiled: &Compiled) -> Result<(), String> {
        match compiled.module.needs_buffers && self != Host::Html {
            false => Ok(()),
            true => Err(format!("what is written for {} reads no storage buffers, from which `mesh_field`, `baked` and long texts are read: write --for html, or a module with --entry draw", self.name())),
        }
    }

    /// What its module is: one that draws, in which all is computed from parameters and time.
    pub fn options(self) -> Options {
        let uniforms = match self {
            Host::Html | Host::WgpuPy | Host::Vulkan | Host::Hlsl | Host::Msl => Uniforms::Block,
            _ => Uniforms::Private,
        };
        // A renderer that encodes what it is given takes light's own numbers.
        let colors = match self {
            Host::Three | Host::ThreeWebgl | Host::Godot | Host::Bevy => Colors::Linear,
            _ => Colors::Screen,
        };
        Options { colors, exports: Vec::new(), prefix: PREFIX.to_owned(), entry: Entry::Draw, live_in_shader: true, uniforms, ..Options::default() }
    }

    /// The file, of a scene with that module; `title` is what a person calls it, `parameters` are its parameters as data, `ending` is how its name ends.
    pub fn write(self, compiled: &Compiled, parameters: &[Value], title: &str, ending: &str) -> Result<Vec<u8>, String> {
        if !compiled.module.draws {
            return Err(UNDRAWN.to_owned());
        }
        match self {
            Host::Html => page(compiled, &compiled.live(), parameters, title, &Showing::default()),
            Host::Three => three::write(compiled, parameters, title, false).map(String::into_bytes),
            Host::ThreeWebgl => three::write(compiled, parameters, title, true).map(String::into_bytes),
            Host::Babylon => engine::write(compiled, parameters, title, Engine::Babylon).map(String::into_bytes),
            Host::Playcanvas => engine::write(compiled, parameters, title, Engine::PlayCanvas).map(String::into_bytes),
            Host::WgpuPy => wgpu_py::write(compiled, parameters, title).map(String::into_bytes),
            Host::Godot => godot::write(compiled, title).map(String::into_bytes),
            Host::Bevy => bevy::shader(compiled, title).map(String::into_bytes),
            Host::Hlsl => shader::hlsl(compiled, title).map(String::into_bytes),
            Host::Msl => shader::msl(compiled, title).map(String::into_bytes),
            Host::Shadertoy => shadertoy::write(compiled).map(String::into_bytes),
            Host::Vulkan if ending == "spv" => translate(&compiled.module, PREFIX, Target::Spirv),
            Host::Vulkan if ending == "vert" => vertex_shader(&compiled.module, PREFIX),
            Host::Vulkan => translate(&compiled.module, PREFIX, Target::Glsl450),
        }
    }

    /// How a second file ends that stands beside the first and uses it.
    pub fn beside(self) -> Option<&'static str> {
        (self == Host::Bevy).then_some("rs")
    }

    /// That second file, where the first is called `file`.
    pub fn write_beside(self, compiled: &Compiled, title: &str, file: &str) -> Option<Vec<u8>> {
        (self == Host::Bevy).then(|| bevy::plugin(compiled, title, file).into_bytes())
    }
}

/// The page of a scene whose module is that of [`Host::Html`], with these values at its start.
pub fn page(compiled: &Compiled, live: &Live, parameters: &[Value], title: &str, showing: &Showing) -> Result<Vec<u8>, String> {
    if !compiled.module.draws {
        return Err(UNDRAWN.to_owned());
    }
    Ok(page::write(compiled, live, parameters, title, showing).into_bytes())
}

/// What of a scene a module does not hold: each with what that means for the picture.
pub fn left_out(compiled: &Compiled, module: &Module) -> Vec<String> {
    let (blocks, draws) = (&compiled.blocks, module.draws);
    let mut words: Vec<String> = Vec::new();
    for (count, what) in [(blocks.meshes.len(), "meshes"), (blocks.balls.len(), "balls")] {
        if count > 0 {
            words.push(format!("{what}; the module holds the field alone"));
        }
    }
    let kinds = [
        (draws && !compiled.functions.surface.layers.is_empty(), "images; what lies on a surface is drawn without them"),
        (draws && (blocks.environment.is_some() || blocks.capture.is_some()), "images of the sky; the module draws the sky of a scene that names none"),
        (draws && blocks.bloom.is_some(), "bloom; bright places have no glow"),
    ];
    words.extend(kinds.into_iter().filter(|(is, _)| *is).map(|(_, words)| words.to_owned()));
    words
}
