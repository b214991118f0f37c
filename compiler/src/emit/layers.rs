//! What lies on surfaces: the structs and functions of layers, and all that meshes are made of.

use crate::emit::body::{Body, Space};
use crate::emit::code::{Code, ExprId};
use crate::emit::error::EmitError;
use crate::emit::names::numbered;
use crate::emit::plan::Plan;
use crate::emit::space::{own_space, scene_space, surface_struct};
use crate::emit::write::{self, Context};
use crate::functions::Surface;
use crate::graph::{ShapeId, Slot};
use crate::interface::UniformSource;
use std::borrow::Cow;
use std::fmt::Write;

/// Name of the struct of what lies on a surface: 0 is the scene's, the others are the meshes'.
pub fn layers_name(which: u32) -> Cow<'static, str> {
    match which.checked_sub(1) {
        None => "Layers".into(),
        Some(_) => numbered("MeshLayers", which as usize).into(),
    }
}

/// Writes what lies on the surface: of each image its weight, where on it, how that grows along each axis, and how sharp its sides are.
pub fn layers_struct(prefix: &str, which: u32, surface: &Surface, wgsl: &mut String) {
    let _ = write!(wgsl, "\nstruct {prefix}{} {{\n", layers_name(which));
    if surface.relief.is_some() {
        wgsl.push_str("  relief: vec3f,\n");
    }
    for i in 1..=surface.layers.len() {
        for name in ["weight", "point", "across", "up", "along"] {
            let _ = writeln!(wgsl, "  {}: vec3f,", numbered(name, i));
        }
        let _ = writeln!(wgsl, "  {}: f32,", numbered("sharpness", i));
    }
    wgsl.push_str("}\n");
}

/// Writes the function that gives it.
pub fn layers_function(
    context: &mut Context,
    root: ShapeId,
    surface: &Surface,
    plan: &Plan,
    body: &mut Body,
    text: &mut String,
) -> Result<(), EmitError> {
    let (graph, prefix) = (context.graph, context.prefix);
    text.push_str("\n// How steeply the surface looks to rise, and the images that lie on it.\n");
    // Of a file only its own name, so that the same text gives the same module in any folder.
    let name = |path: &str| format!("{:?}", path.rsplit(['/', '\\']).next().unwrap_or(path));
    let images = surface.layers.iter().filter_map(|layer| Some((layer.slot, graph.images.get(layer.image as usize)?)));
    let use_of = |slot: Slot| match slot {
        Slot::Color => "the colour",
        Slot::Roughness => "the roughness, by its green",
        Slot::Metallic => "metallic, by its blue",
        Slot::Relief => "heights, by its green",
    };
    let lines = images.enumerate().map(|(i, (slot, image))| format!("//   {i}: {} for {}\n", name(&image.path), use_of(slot)));
    let images: String = lines.collect();
    if !images.is_empty() {
        let _ = write!(
            text,
            "// What {prefix}surface gives is without them:\n{images}\
             // To what each is for a host adds weight times the image at (z, -y), (x, z) and (x, -y) of point, in widths of the image to the right and\n\
             // down, shared by the squares of the normal's components in that space to the power sharpness. Along the scene's axes point grows by\n\
             // across, up and along. Heights lean the normal: how they rise along the scene's axes, less what of that goes along the normal, is taken from it.\n"
        );
    }
    let _ = writeln!(text, "fn {prefix}layers(p: vec3f, normal: vec3f) -> {prefix}Layers {{");
    let _ = writeln!(text, "  let q = p + {}.origin;", context.uniform_name);
    context.uniforms.read(UniformSource::Origin);
    body.clear();
    let space = scene_space(graph, root, body, true);
    let result = layers_value(context, 0, surface, plan, &space, body)?;
    write::write(context, body, result, &["p", "q", "normal"], text);
    text.push_str("}\n");
    Ok(())
}

/// Writes the function that says how much light goes through the surface.
pub fn glass_function(context: &mut Context, root: ShapeId, plan: &Plan, body: &mut Body, text: &mut String) -> Result<(), EmitError> {
    let (graph, prefix) = (context.graph, context.prefix);
    text.push_str("\n// How much light goes through the surface, and the index of refraction of what is under it.\n");
    let _ = writeln!(text, "fn {prefix}glass(p: vec3f, normal: vec3f) -> vec2f {{");
    let _ = writeln!(text, "  let q = p + {}.origin;", context.uniform_name);
    context.uniforms.read(UniformSource::Origin);
    body.clear();
    let space = scene_space(graph, root, body, true);
    let results = body.open(context.plans, graph, plan, &space, &context.uniforms)?;
    let result = body.vector(&results);
    write::write(context, body, result, &["p", "q", "normal"], text);
    text.push_str("}\n");
    Ok(())
}

fn layers_value(
    context: &Context,
    which: u32,
    surface: &Surface,
    plan: &Plan,
    space: &Space,
    body: &mut Body,
) -> Result<ExprId, EmitError> {
    let results = body.open(context.plans, context.graph, plan, space, &context.uniforms)?;
    let mut fields = Vec::new();
    let (relief, layers) = results.split_at_checked(if surface.relief.is_some() { 3 } else { 0 }).unwrap_or((&results, &[]));
    fields.extend(relief.chunks(3).map(|v| body.vector(v)));
    for layer in layers.chunks(16) {
        let (vectors, sharpness) = layer.split_at_checked(15).unwrap_or((layer, &[]));
        fields.extend(vectors.chunks(3).map(|v| body.vector(v)));
        fields.extend_from_slice(sharpness);
    }
    Ok(body.add(Code::Layers(which), &fields))
}

/// Writes what a mesh is made of, in its own space.
pub fn mesh_functions(
    context: &mut Context,
    mesh: u32,
    surface: &Surface,
    plan: &Plan,
    layers: Option<&Plan>,
    body: &mut Body,
    text: &mut String,
) -> Result<(), EmitError> {
    let prefix = context.prefix;
    let space = |body: &mut Body| {
        body.clear();
        let (space, _) = own_space(body, 3, &[]);
        Space { normal: Some(body.add(Code::Normal, &[])), ..space }
    };
    let _ = writeln!(text, "\nfn {prefix}{}(p: vec3f, normal: vec3f) -> {prefix}Surface {{", numbered("mesh", mesh as usize + 1));
    let own = space(body);
    let results = body.open(context.plans, context.graph, plan, &own, &context.uniforms)?;
    let result = surface_struct(body, &results);
    write::write(context, body, result, &["p", "normal"], text);
    text.push_str("}\n");
    if let Some(plan) = layers {
        layers_struct(prefix, mesh + 1, surface, text);
        let name = layers_name(mesh + 1);
        let _ = writeln!(text, "\nfn {prefix}{}(p: vec3f, normal: vec3f) -> {prefix}{name} {{", numbered("mesh_layers", mesh as usize + 1));
        let own = space(body);
        let result = layers_value(context, mesh + 1, surface, plan, &own, body)?;
        write::write(context, body, result, &["p", "normal"], text);
        text.push_str("}\n");
    }
    Ok(())
}
