//! `surefoot-composed SHADER.wgsl…`: whether naga_oil composes each as Bevy does, as a shader of its own and as a module that another imports. The modules of
//! Bevy that they import are replaced by what of them is read.

use naga_oil::compose::{ComposableModuleDescriptor, Composer, NagaModuleDescriptor, ShaderDefValue};
use std::collections::HashMap;
use std::process::ExitCode;

/// What is read of `bevy_pbr::mesh_view_bindings`.
const VIEW: &str = "#define_import_path bevy_pbr::mesh_view_bindings
struct View {
    clip_from_view: mat4x4<f32>,
    world_from_view: mat4x4<f32>,
    viewport: vec4<f32>,
}
struct Globals {
    time: f32,
}
@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(11) var<uniform> globals: Globals;
";

fn main() -> ExitCode {
    let mut code = ExitCode::SUCCESS;
    for path in std::env::args().skip(1) {
        match compose(&path) {
            Ok(entries) => println!("{path}: {entries}"),
            Err(words) => {
                eprintln!("{path}: {words}");
                code = ExitCode::FAILURE;
            }
        }
    }
    code
}

/// Composes a file. The answer: its entry points.
fn compose(path: &str) -> Result<String, String> {
    let source = std::fs::read_to_string(path).map_err(|e| e.to_string())?;
    let mut composer = Composer::default();
    let defs = HashMap::from([("MATERIAL_BIND_GROUP".to_owned(), ShaderDefValue::UInt(3))]);
    let add = |composer: &mut Composer, source: &str, file_path: &str| {
        let descriptor = ComposableModuleDescriptor { source, file_path, shader_defs: defs.clone(), ..Default::default() };
        composer.add_composable_module(descriptor).map(|_| ()).map_err(|e| e.emit_to_string(&Composer::default()))
    };
    let make = |composer: &mut Composer, source: &str, file_path: &str| {
        let descriptor = NagaModuleDescriptor { source, file_path, shader_defs: defs.clone(), ..Default::default() };
        composer.make_naga_module(descriptor).map_err(|e| e.emit_to_string(composer))
    };
    add(&mut composer, VIEW, "view.wgsl")?;
    let module = make(&mut composer, &source, path)?;
    let entries: Vec<&str> = module.entry_points.iter().map(|entry| entry.name.as_str()).collect();
    if entries != ["vertex", "fragment"] {
        return Err(format!("it has the entry points {entries:?}"));
    }
    // Another shader asks for the field and its gradient.
    let own = source.lines().find_map(|line| line.strip_prefix("#define_import_path ")).ok_or("it has no path to import it by")?;
    add(&mut composer, &source, path)?;
    let other = format!("#import {own}::sf_gradient\n@fragment\nfn fragment() -> @location(0) vec4<f32> {{\n    return sf_gradient(vec3<f32>(0.0));\n}}\n");
    make(&mut composer, &other, "other.wgsl")?;
    Ok(entries.join(", "))
}
