//! What lies on a surface, as text: for each layer of the scene's surface a few lines that add what its image says.

use std::borrow::Cow;
use surefoot_compiler::compiled::Compiled;
use surefoot_compiler::emit::{letters, numbered};
use surefoot_compiler::functions::{Functions, Surface};
use surefoot_compiler::graph::Slot;
use surefoot_compiler::images::TextureKind;
use surefoot_compiler::shading;

/// The binding of the first texture in group 1; that of their sampler is the one before.
pub(super) const FIRST_TEXTURE: u32 = 5;

/// How the lines of a layer speak of its axes and its image.
const ON_FIELDS: [(&str, &str); 4] =
    [("AXES", "SceneAxes"), ("LAID", "scene_laid"), ("RISEN", "scene_risen"), ("SLOPE(layers.relief)", "layers.relief")];
const ON_MESHES: [(&str, &str); 4] =
    [("AXES", "mesh_axes"), ("LAID", "mesh_laid"), ("RISEN", "mesh_risen"), ("SLOPE", "mesh_slope")];

/// The textures of a scene that a pass has which takes so many.
fn textures(functions: &Functions, most: u32) -> Vec<(u32, TextureKind)> {
    functions.textures().into_iter().take(most as usize).collect()
}

/// The text that says of a place of the field what is there: the function `scene_met`. `most` textures are looked at.
pub(super) fn text(functions: &Functions, most: u32) -> Vec<Cow<'static, str>> {
    let surface = &functions.surface;
    let textures = textures(functions, most);
    let mut text: Vec<Cow<'static, str>> = vec![shading::MET.into()];
    if surface.is_layered() || !textures.is_empty() {
        text.push(include_str!("layers/base.wgsl").into());
    }
    if !textures.is_empty() {
        text.push(include_str!("layers/images.wgsl").into());
    }
    for texture in 0..textures.len() {
        let binding = FIRST_TEXTURE + texture as u32;
        let image = include_str!("layers/image.wgsl");
        text.push(image.replace("TEXTURE", &texture.to_string()).replace("BINDING", &binding.to_string()).into());
    }
    if !surface.is_layered() {
        text.push(shading::MET_PLAIN.into());
        return text;
    }
    text.push(include_str!("layers/begin.wgsl").into());
    lines(surface, &textures, &ON_FIELDS, &mut text);
    text
}

/// The text that says of a place of a mesh what is there: the function `mesh_met`. Stands after [`text`] and the mesh's place.
pub(super) fn mesh_text(compiled: &Compiled, most: u32) -> Vec<Cow<'static, str>> {
    let functions = &compiled.functions;
    let textures = textures(functions, most);
    let mut text: Vec<Cow<'static, str>> = vec![include_str!("meshes/plain.wgsl").into(), compiled.module.meshes.clone().into()];
    if functions.meshes.iter().any(Surface::is_layered) {
        text.push(include_str!("meshes/axes.wgsl").into());
    }
    if functions.meshes.iter().any(|s| !s.layers.is_empty()) && !textures.is_empty() {
        text.push(include_str!("meshes/laid.wgsl").into());
    }
    let mut cases = String::new();
    for (i, surface) in functions.meshes.iter().enumerate() {
        let named = |lines: &'static str| Cow::Owned(lines.replace("MESH", &letters(i + 1)));
        cases += &format!("        case {i}u: {{ return {}(n, t); }}\n", numbered("mesh_met", i + 1));
        if surface.is_layered() {
            text.push(named(include_str!("layers/begin_mesh.wgsl")));
            lines(surface, &textures, &ON_MESHES, &mut text);
        } else {
            text.push(named(include_str!("layers/none_mesh.wgsl")));
        }
    }
    text.push(include_str!("meshes/met.wgsl").replace("        // CASES\n", &cases).into());
    text
}

/// What follows the begin of a function: relief, layers, end.
fn lines(surface: &Surface, textures: &[(u32, TextureKind)], words: &[(&str, &str)], text: &mut Vec<Cow<'static, str>>) {
    let mut push = |lines: String| text.push(words.iter().fold(lines, |lines, (word, by)| lines.replace(word, by)).into());
    if surface.relief.is_some() {
        push(include_str!("layers/formula.wgsl").to_owned());
    }
    for (i, layer) in surface.layers.iter().enumerate() {
        let wanted = (layer.image, TextureKind::of(layer.slot));
        let Some(texture) = textures.iter().position(|t| *t == wanted) else { continue };
        let lines = match layer.slot {
            Slot::Color => include_str!("layers/color.wgsl"),
            Slot::Roughness => include_str!("layers/roughness.wgsl"),
            Slot::Metallic => include_str!("layers/metallic.wgsl"),
            Slot::Relief => include_str!("layers/relief.wgsl"),
        };
        push(lines.replace('#', &letters(i + 1)).replace("TEXTURE", &texture.to_string()));
    }
    push(include_str!("layers/end.wgsl").to_owned());
}
