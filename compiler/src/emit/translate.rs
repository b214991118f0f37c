//! Modules checked, and in other languages, through naga.

use super::{library, spirv, straight, table};
use super::Module;
use crate::interface::Export;
use naga::back::{glsl, hlsl, msl, spv};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};

/// A language of shaders.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Target {
    /// WebGPU's, as emitted.
    Wgsl,
    /// OpenGL ES 3.0 and WebGL 2: a fragment shader.
    Glsl,
    /// Vulkan's GLSL, version 4.50: a fragment shader, whose blocks have the module's bindings in set 0.
    Glsl450,
    /// Direct3D's, shader model 6.0.
    Hlsl,
    /// Metal's.
    Msl,
    /// Vulkan's, as bytes.
    Spirv,
}

impl Target {
    /// All of them.
    pub const ALL: [Target; 6] = [Target::Wgsl, Target::Glsl, Target::Glsl450, Target::Hlsl, Target::Msl, Target::Spirv];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Target::Wgsl => "wgsl",
            Target::Glsl => "glsl",
            Target::Glsl450 => "glsl450",
            Target::Hlsl => "hlsl",
            Target::Msl => "msl",
            Target::Spirv => "spirv",
        }
    }
}

/// The module as naga reads it, with what its validator found out; or what is wrong, as naga shows it.
pub fn validate(wgsl: &str) -> Result<(naga::Module, ModuleInfo), String> {
    let module = naga::front::wgsl::parse_str(wgsl).map_err(|e| e.emit_to_string(wgsl))?;
    let info = Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .map_err(|e| e.emit_to_string(wgsl))?;
    Ok((module, info))
}

/// The module in another language. A language that has no modules without an entry point gets a fragment function that looks
/// at the scene, unless the module draws by itself: GLSL is its fragment function then.
pub fn translate(module: &Module, prefix: &str, target: Target) -> Result<Vec<u8>, String> {
    if target == Target::Wgsl {
        return Ok(module.wgsl.clone().into_bytes());
    }
    let mut text = match target {
        Target::Spirv => module.wgsl.clone(),
        _ => table::text::with_constants(&module.wgsl, prefix),
    };
    if matches!(target, Target::Glsl | Target::Glsl450) && !module.draws {
        text.push('\n');
        let entry = entry(module).replace("sf_uniforms.origin", "ORIGIN").replace("sf_", prefix);
        text.push_str(&entry.replace("ORIGIN", &module.origin));
    }
    let (parsed, info) = validate(&text)?;
    match target {
        Target::Wgsl => Ok(text.into_bytes()),
        Target::Glsl | Target::Glsl450 => {
            let fragment = (naga::ShaderStage::Fragment, &*format!("{prefix}fragment"));
            let (parsed, info) = with_loops(parsed)?;
            let text = glsl(module, (&parsed, &info), target, fragment)?;
            // OpenGL ES 3.0 chooses between whole numbers by a branch alone.
            Ok(if target == Target::Glsl { straight::choices(&text, &format!("{prefix}pick")) } else { text }.into_bytes())
        }
        Target::Hlsl => {
            let options = hlsl::Options {
                shader_model: hlsl::ShaderModel::V6_0,
                ..hlsl::Options::default()
            };
            let pipeline = hlsl::PipelineOptions::default();
            let mut out = String::new();
            hlsl::Writer::new(&mut out, &options, &pipeline)
                .write(&parsed, &info, None)
                .map_err(|e| e.to_string())?;
            Ok((head(module) + &out).into_bytes())
        }
        Target::Msl => {
            let pipeline = msl::PipelineOptions::default();
            msl::write_string(&parsed, &info, &metal(&parsed), &pipeline)
                .map(|(text, _)| (head(module) + &text).into_bytes())
                .map_err(|e| e.to_string())
        }
        Target::Spirv => {
            let mut options = spv::Options::default();
            options.flags |= spv::WriterFlags::DEBUG;
            let mut words = spv::write_vec(&parsed, &info, &options, None).map_err(|e| e.to_string())?;
            // Where there are entry points nobody links to functions, and Vulkan takes none that say so.
            if !module.draws {
                let names: Vec<String> = module.exports.iter().map(|export| format!("{prefix}{}", export.name())).collect();
                spirv::export(&mut words, &names);
            }
            Ok(words.into_iter().flat_map(u32::to_le_bytes).collect())
        }
    }
}

/// How a module is written for Metal: what entry points bind are buffers by the numbers of their bindings. The sizes of tables follow them.
fn metal(parsed: &naga::Module) -> msl::Options {
    let bindings = || parsed.global_variables.iter().filter_map(|(_, variable)| variable.binding);
    let slot = |number: u32| u8::try_from(number).ok();
    let resources = msl::EntryPointResources {
        resources: bindings().map(|binding| (binding, msl::BindTarget { buffer: slot(binding.binding), ..Default::default() })).collect(),
        sizes_buffer: slot(bindings().map(|binding| binding.binding + 1).max().unwrap_or(0)),
        ..Default::default()
    };
    let entries = parsed.entry_points.iter().map(|entry| (entry.name.clone(), resources.clone()));
    msl::Options { per_entry_point_map: entries.collect(), ..msl::Options::default() }
}

/// The vertex shader of a module that draws, in GLSL for Vulkan.
pub fn vertex_shader(module: &Module, prefix: &str) -> Result<Vec<u8>, String> {
    let (parsed, info) = validate(&table::text::with_constants(&module.wgsl, prefix))?;
    glsl(module, (&parsed, &info), Target::Glsl450, (naga::ShaderStage::Vertex, &format!("{prefix}vertex"))).map(String::into_bytes)
}

/// The module with loops that compile fast, and what naga's validator says of it.
fn with_loops(mut module: naga::Module) -> Result<(naga::Module, ModuleInfo), String> {
    straight::loops(&mut module);
    let info = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module).map_err(|e| e.to_string())?;
    Ok((module, info))
}

/// A stage of a module in GLSL, by its entry point.
fn glsl(module: &Module, (parsed, info): (&naga::Module, &ModuleInfo), target: Target, (stage, entry): (naga::ShaderStage, &str)) -> Result<String, String> {
    let is_vulkan = target == Target::Glsl450;
    let bindings = parsed.global_variables.iter().filter_map(|(_, variable)| variable.binding).map(|binding| (binding, binding.binding as u8));
    let options = glsl::Options {
        version: if is_vulkan { glsl::Version::Desktop(450) } else { glsl::Version::new_gles(300) },
        writer_flags: glsl::WriterFlags::empty(),
        binding_map: if is_vulkan { bindings.collect() } else { Default::default() },
        ..glsl::Options::default()
    };
    let pipeline = glsl::PipelineOptions { shader_stage: stage, entry_point: entry.to_owned(), multiview: None };
    let mut out = String::new();
    let policies = naga::proc::BoundsCheckPolicies::default();
    let reflection = glsl::Writer::new(&mut out, parsed, info, &options, &pipeline, policies)
        .and_then(|mut writer| writer.write())
        .map_err(|e| e.to_string())?;
    if is_vulkan {
        // OpenGL's name of it.
        out = out.replace("gl_VertexID", "gl_VertexIndex");
    }
    // A block for each uniform variable, in their order.
    let mut blocks: Vec<_> = reflection.uniforms.iter().collect();
    blocks.sort_unstable();
    let block: String = match &blocks[..] {
        _ if is_vulkan => String::new(),
        [] => String::new(),
        [(_, name)] => format!("// The uniform block is found by its name, `{name}`; it has no binding.\n"),
        all => {
            let known = |(handle, name): &(&naga::Handle<naga::GlobalVariable>, &String)| {
                let variable = parsed.global_variables.try_get(**handle).ok().and_then(|variable| variable.name.as_deref());
                format!("//   {}: `{name}`\n", variable.unwrap_or(""))
            };
            format!("// Uniforms have no bindings; each is a block that is found by its name:\n{}", all.iter().map(known).collect::<String>())
        }
    };
    // Before the version nothing may stand.
    let (version, rest) = out.split_once('\n').unwrap_or((&out, ""));
    Ok(format!("{version}\n{}{block}{rest}", head(module)))
}

/// What the module says of itself, for a language with the same comments.
fn head(module: &Module) -> String {
    let mut head = module.head().to_owned();
    head.push_str("//\n// This says so of the module in WGSL. Here names that the language does not take end in `_`.\n\n");
    head
}

/// A fragment function that calls something of the module: the tracer where there is one. What is written is what reads no more of the outside than
/// that does, which is all of it, as each of them reads the uniforms.
fn entry(module: &Module) -> String {
    let has = |export| module.exports.contains(&export);
    if has(Export::Trace) && has(Export::Gradient) {
        return library::ENTRY_TRACE.to_owned();
    }
    let value = module.exports.first().map(|export| match export {
        Export::Field => "sf_field(p)",
        Export::Bound => "sf_bound(p)",
        Export::Distance => "sf_distance(p)",
        Export::Gradient => "sf_gradient(p).w",
        Export::Trace => "sf_trace(p, vec3f(0.0, 0.0, 1.0), 0.0, 1.0, 0.01).t",
        Export::Shadow => "sf_shadow(p, vec3f(0.0, 1.0, 0.0), 0.0, 1.0, 8.0)",
        Export::Collision => "sf_collision(p, 1.0).depth",
        Export::Occlusion => "sf_occlusion(p, vec3f(0.0, 1.0, 0.0))",
        Export::Surface => "sf_surface(p, vec3f(0.0, 1.0, 0.0)).roughness",
    });
    library::ENTRY_SLICE.replace("VALUE", value.unwrap_or("0.0"))
}
