//! `surefoot compile`: the functions of a scene as shader text.

use super::values::{self, Setting};
use super::console::{Exit, Failure, ends_wrong, print, show_broken, spare};
use crate::files;
use clap::builder::PossibleValuesParser;
use serde_json::{Value, json};
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use surefoot_compiler::compiled::{Colors, Compiled, Entry, Module, Uniform, UniformSource, Uniforms};
use surefoot_compiler::emit::{Target, signature, translate, validate};
use surefoot_compiler::{Export, Options};
use surefoot_hosts::{Host, left_out, parameter_json, parameters};

const BLOCK: &str = "block";
const SCREEN: &str = "screen";
const NONE: &str = "none";
const DRAW: &str = "draw";
/// How a module declares what a host sets.
const UNIFORMS: [(&str, Uniforms); 3] = [(BLOCK, Uniforms::Block), ("private", Uniforms::Private), ("separate", Uniforms::Separate)];
/// What one that draws makes of light.
const COLORS: [(&str, Colors); 3] = [(SCREEN, Colors::Screen), ("linear", Colors::Linear), ("light", Colors::Light)];
const TEXT: &str = "text";
const BUFFERS: &str = "buffers";

/// What to write, and how it is named.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The scene.
    scene: String,
    /// The file to write; stdout if this is `-` or left out.
    #[arg(short, long, value_name = "FILE")]
    output: Option<String>,
    /// The functions to write, separated by commas; functions that they call are written too.
    #[arg(long, value_delimiter = ',', value_parser = export, value_name = "NAMES",
          default_value = "field,bound,distance,gradient,trace,shadow,collision,occlusion,surface")]
    functions: Vec<Export>,
    /// Prefix of every name. Names that the translation to another language adds have no prefix.
    #[arg(long, default_value = "sf_", value_parser = prefix)]
    prefix: String,
    /// Bind group of the uniform block.
    #[arg(long, default_value_t = 0, value_name = "N", value_parser = clap::value_parser!(u32).range(..256))]
    group: u32,
    /// Binding of the uniform block.
    #[arg(long, default_value_t = 0, value_name = "N")]
    binding: u32,
    /// How the module declares what a host sets: one uniform block; a private variable that the shader sets itself, with the values at the start; or a
    /// uniform variable for each, from --binding on.
    #[arg(long, default_value = BLOCK, value_parser = PossibleValuesParser::new(UNIFORMS.map(|(name, _)| name)), value_name = "FORM")]
    uniforms: String,
    /// Whether the module draws the scene by itself: `draw` adds entry points that do, with the scene's light, sky and camera, and write its depth.
    #[arg(long, default_value = NONE, value_parser = PossibleValuesParser::new([NONE, DRAW]))]
    entry: String,
    /// What a module that draws makes of light: a screen's colours, the same for a target that encodes them as sRGB itself, or light without a tone curve.
    #[arg(long, default_value = SCREEN, value_parser = PossibleValuesParser::new(COLORS.map(|(name, _)| name)), value_name = "FORM")]
    colors: String,
    /// Write the scene for a host, so that the file shows it: `html`, a page that draws by WebGPU, as one file that loads nothing;
    /// `three` and `three-webgl`, `babylon` and `playcanvas`, modules whose object a page adds to its scene; `wgpu-py`, a module whose
    /// object a program of Python draws; `godot`, a shader for Godot 4;
    /// `bevy`, a shader for Bevy 0.19, with its plugin in OUT.rs; `shadertoy`, a fragment shader for shadertoy.com; `vulkan`, both shaders as
    /// SPIR-V (.spv), or one in GLSL 4.50 (.frag, .vert); `hlsl` and `msl`, both shaders as text for Direct3D and Metal.
    #[arg(long = "for", value_name = "HOST", value_parser = PossibleValuesParser::new(Host::ALL.map(Host::name)),
          conflicts_with_all = ["functions", "prefix", "group", "binding", "uniforms", "entry", "colors", "target", "tables", "layout", "live_in_shader"])]
    host: Option<String>,
    /// The language to write. GLSL gets an entry point that draws, since it needs one; names that GLSL forbids get a `_` at the end.
    #[arg(long, default_value = "wgsl", value_parser = PossibleValuesParser::new(Target::ALL.map(Target::name)))]
    target: String,
    /// Where the numbers of large unions are stored: in the text, or in two storage buffers with their bytes in OUT.table.bin and OUT.lists.bin.
    /// Buffers are faster: near a point only the operands that matter there are evaluated.
    #[arg(long, default_value = TEXT, value_parser = PossibleValuesParser::new([TEXT, BUFFERS]))]
    tables: String,
    /// Also write a JSON description of the module for a host: its functions, uniform fields, parameters and the values that the host computes.
    #[arg(long, value_name = "FILE")]
    layout: Option<String>,
    /// Make it an error where a factor is measured and not proven.
    #[arg(long)]
    strict: bool,
    /// Fix a parameter that is a choice: the module then contains only the chosen part. The host sets all other parameters.
    #[arg(long, value_parser = values::setting, value_name = "NAME=CHOICE")]
    set: Vec<Setting>,
    /// Compute expressions of only parameters and time in the shader, so that the host needs to write nothing else.
    #[arg(long)]
    live_in_shader: bool,
}

/// The endings of files in each language.
const ENDINGS_OF: [(&[&str], Target); 6] = [
    (&["wgsl"], Target::Wgsl),
    (&["glsl", "frag", "vert"], Target::Glsl),
    (&["glsl", "frag"], Target::Glsl450),
    (&["hlsl"], Target::Hlsl),
    (&["msl", "metal"], Target::Msl),
    (&["spv", "spirv"], Target::Spirv),
];

fn export(name: &str) -> Result<Export, String> {
    Export::ALL.into_iter().find(|export| export.name() == name.trim()).ok_or_else(|| {
        let known: Vec<_> = Export::ALL.iter().map(|export| export.name()).collect();
        format!("there is no such function; there are {}", known.join(", "))
    })
}

/// A prefix must leave every name a name in every target: GLSL keeps `gl_` and two underscores for itself, WGSL two at the start.
fn prefix(text: &str) -> Result<String, String> {
    let mut characters = text.chars();
    let starts = characters.next().is_none_or(|c| c.is_ascii_alphabetic());
    if !starts || !characters.all(|c| c.is_ascii_alphanumeric() || c == '_') {
        return Err("a prefix has a letter, then letters, digits and underscores".to_owned());
    }
    if text.contains("__") || text.starts_with("gl_") {
        return Err("shader languages keep two underscores and `gl_` for themselves".to_owned());
    }
    Ok(text.to_owned())
}

/// Compiles and writes. Nothing is written where anything is wrong.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    if let Some(host) = Host::ALL.into_iter().find(|host| Some(host.name()) == args.host.as_deref()) {
        return for_host(args, host);
    }
    let target = Target::ALL.into_iter().find(|t| t.name() == args.target).unwrap_or(Target::Wgsl);
    let file = args.output.as_deref().filter(|file| *file != "-").map(Path::new);
    let buffered = args.tables == BUFFERS;
    if buffered && file.is_none() {
        return Err(Failure::usage("tables in buffers are files of their own: say where to write with -o FILE"));
    }
    if buffered && target == Target::Glsl {
        return Err(Failure::usage("GLSL ES 3.0 has no storage buffers: leave --tables buffers out"));
    }
    fn chosen<T: Copy>(name: &str, of: &[(&str, T)], usual: T) -> T {
        of.iter().find(|(known, _)| *known == name).map_or(usual, |(_, value)| *value)
    }
    let uniforms = chosen(&args.uniforms, &UNIFORMS, Uniforms::Block);
    if args.prefix.is_empty() && uniforms == Uniforms::Separate {
        return Err(Failure::usage("uniforms that are variables of their own need a --prefix before their names"));
    }
    let options = Options {
        uniforms,
        entry: if args.entry == DRAW { Entry::Draw } else { Entry::None },
        colors: chosen(&args.colors, &COLORS, Colors::Screen),
        exports: args.functions.clone(),
        prefix: args.prefix.clone(),
        group: args.group,
        binding: args.binding,
        strict: args.strict,
        live_in_shader: args.live_in_shader,
        ..Options::default()
    };
    let (outcome, _) = values::read(&args.scene, &args.set, &options)?;
    let Some(compiled) = &outcome.compiled else { return Ok(Exit::Errors) };
    only_choices(args, compiled)?;
    if show_broken(&outcome, &crate::picture::broken_meshes(compiled)) == Exit::Errors {
        return Ok(Exit::Errors);
    }
    // What is too large for a text stands beside it.
    if compiled.module.needs_buffers && file.is_none() {
        return Err(Failure::usage("its grids and its long texts stand in files of their own: say where to write with -o FILE"));
    }
    if compiled.module.needs_buffers && target == Target::Glsl {
        return Err(Failure::usage("GLSL ES 3.0 has no storage buffers, from which `mesh_field`, `baked` and long texts are read: write another target"));
    }
    let buffered = buffered || compiled.module.needs_buffers;
    let with_buffers = compiled.module.with_buffers(&options).filter(|_| buffered);
    let (module, tables): (&Module, Vec<(PathBuf, &Vec<u8>)>) = match &with_buffers {
        Some((module, bytes)) => (module, file.into_iter().flat_map(|file| ["table.bin", "lists.bin"].map(|end| file.with_extension(end))).zip(bytes).collect()),
        None => (&compiled.module, Vec::new()),
    };
    if args.layout.as_deref() == Some("-") {
        return Err(Failure::usage("the layout is a file of its own: say where to write it with --layout FILE"));
    }
    let layout = args.layout.as_deref().map(|path| (Path::new(path), layout_json(args, &options, compiled, module, &tables)));
    let paths: Vec<&Path> = file.into_iter().chain(layout.iter().map(|(path, _)| *path)).chain(tables.iter().map(|(path, _)| path.as_path())).collect();
    let same = |a: &Path, b: &Path| match (std::path::absolute(a), std::path::absolute(b)) {
        (Ok(a), Ok(b)) => a == b,
        _ => a == b,
    };
    if let Some(twice) = (1..paths.len()).find(|&i| paths[..i].iter().any(|path| same(path, paths[i]))) {
        return Err(Failure::usage(format!("{} would be written twice: say another file", paths[twice].display())));
    }
    for path in paths {
        spare(path, &outcome)?;
    }
    let endings = ENDINGS_OF.iter().find(|(_, t)| *t == target).map_or(&[][..], |(endings, _)| endings);
    let wrong = file.and_then(|file| ends_wrong(file, endings)).or_else(|| ends_wrong(layout.as_ref()?.0, &["json"]));
    if let Some(words) = wrong {
        return Err(Failure::usage(words));
    }
    for skipped in &compiled.module.skipped {
        eprintln!("note: left out: {skipped}");
    }
    say_left_out(compiled, module);
    if !module.draws && !compiled.functions.surface.layers.is_empty() {
        eprintln!("note: left out: images; {}layers says where they lie", args.prefix);
    }
    match (&compiled.module.tables, buffered) {
        (None, true) => eprintln!("note: the scene has no large unions, and so no tables"),
        (Some(_), false) => eprintln!("note: the numbers of large unions stand in the text; --tables buffers is faster, by far where there are many"),
        _ => {}
    }
    let bytes = validate(&module.wgsl)
        .and_then(|_| translate(module, &args.prefix, target))
        .map_err(|why| Failure {
            exit: Exit::Errors,
            words: format!(
                "{}: nothing is written, because the module is not valid:
{why}",
                args.scene
            ),
        })?;
    let write = |path: &Path, bytes: &[u8]| {
        files::write(path, bytes).map_err(|why| Failure::usage(format!("can't write {}: {why}", path.display())))
    };
    if let Some((path, layout)) = &layout {
        write(path, format!("{layout:#}\n").as_bytes())?;
    }
    let Some(file) = file else {
        if target == Target::Spirv && std::io::stdout().is_terminal() {
            return Err(Failure::usage(
                "SPIR-V is no text: say where to write it with -o FILE",
            ));
        }
        print(&bytes)?;
        return Ok(Exit::Fine);
    };
    for (path, bytes) in tables.iter().map(|(path, bytes)| (path.as_path(), *bytes)).chain([(file, &bytes)]) {
        write(path, bytes)?;
    }
    Ok(Exit::Fine)
}

/// Refuses values at the start of what a host sets by itself.
fn only_choices(args: &Args, compiled: &Compiled) -> Result<(), Failure> {
    let set = |name: &str| args.set.iter().any(|setting| setting.name == name);
    match compiled.parameters.iter().find(|p| p.first.is_some() && set(&p.name)) {
        None => Ok(()),
        Some(live) => {
            let name = &live.name;
            Err(Failure::usage(format!("--set {name}=…: only choices are set here; the host sets `{name}`. A page starts with it by `surefoot export --set {name}=…`")))
        }
    }
}

/// What a host shows of a scene beside its picture: its name, and its parameters as data.
pub fn shown(scene: &str, compiled: &Compiled) -> (String, Vec<Value>) {
    let title = Path::new(scene).file_stem().map_or(String::new(), |name| name.to_string_lossy().into_owned());
    (title, parameters(compiled))
}

/// Writes the file of a host.
fn for_host(args: &Args, host: Host) -> Result<Exit, Failure> {
    let file = args.output.as_deref().filter(|file| *file != "-").map(Path::new);
    let options = Options { strict: args.strict, ..host.options() };
    let (outcome, _) = values::read(&args.scene, &args.set, &options)?;
    let Some(compiled) = &outcome.compiled else { return Ok(Exit::Errors) };
    only_choices(args, compiled)?;
    if show_broken(&outcome, &crate::picture::broken_meshes(compiled)) == Exit::Errors {
        return Ok(Exit::Errors);
    }
    host.takes(compiled).map_err(Failure::usage)?;
    let beside = file.zip(host.beside()).map(|(file, ending)| file.with_extension(ending));
    for path in file.into_iter().chain(beside.as_deref()) {
        spare(path, &outcome)?;
    }
    if let Some(words) = file.and_then(|file| ends_wrong(file, host.endings())) {
        return Err(Failure::usage(words));
    }
    if let Some((first, second)) = file.zip(beside.as_deref()).filter(|(first, second)| first == second) {
        let ending = host.endings().first().copied().unwrap_or_default();
        return Err(Failure::usage(format!("{} is the second file that is written: say -o {}", second.display(), first.with_extension(ending).display())));
    }
    say_left_out(compiled, &compiled.module);
    let (title, parameters) = shown(&args.scene, compiled);
    let invalid = |why| Failure { exit: Exit::Errors, words: format!("{}: nothing is written: {why}", args.scene) };
    let ending = file.and_then(|file| file.extension()).map_or(String::new(), |ending| ending.to_string_lossy().to_lowercase());
    let bytes = validate(&compiled.module.wgsl).and_then(|_| host.write(compiled, &parameters, &title, &ending)).map_err(invalid)?;
    let Some(file) = file else {
        print(&bytes)?;
        return Ok(Exit::Fine);
    };
    let called = file.file_name().map_or(String::new(), |name| name.to_string_lossy().into_owned());
    let second = beside.zip(host.write_beside(compiled, &title, &called));
    for (path, bytes) in second.iter().map(|(path, bytes)| (path.as_path(), bytes)).chain([(file, &bytes)]) {
        files::write(path, bytes).map_err(|why| Failure::usage(format!("can't write {}: {why}", path.display())))?;
    }
    Ok(Exit::Fine)
}

/// Says what of the scene a module does not hold.
pub fn say_left_out(compiled: &Compiled, module: &Module) {
    left_out(compiled, module).iter().for_each(|what| eprintln!("note: left out: {what}"));
}

/// WGSL's types of one to four numbers.
const TYPES: [&str; 4] = ["f32", "vec2f", "vec3f", "vec4f"];
/// Those of the two buffers with tables.
const BUFFER_TYPES: [&str; 2] = ["array<vec4f>", "array<u32>"];

/// The version of what `--layout` writes, which docs/layout.schema.json describes.
const LAYOUT_VERSION: u32 = 1;

/// What a host must know of a module.
fn layout_json(args: &Args, options: &Options, compiled: &Compiled, module: &Module, tables: &[(PathBuf, &Vec<u8>)]) -> Value {
    let start = compiled.uniform_bytes(&compiled.live(), [0.0; 3]);
    // GLSL knows its block by name: the head of the text says it.
    let bound = |number: u32| (args.target != Target::Glsl.name()).then_some(number);
    let field = |(place, uniform): (u32, &Uniform)| {
        // As many digits as tell it from its neighbours in 32 bits.
        let short = |number: f32| number.to_string().parse::<f64>().ok();
        let of = |i: u32| short(f32::from_le_bytes(*start.get((uniform.offset + 4 * i) as usize..)?.first_chunk()?));
        let parameter = match uniform.source {
            UniformSource::Parameter(first) => compiled.parameters.iter().find(|p| p.first == Some(first)).map(|p| p.name.as_str()),
            _ => None,
        };
        json!({
            "name": uniform.name,
            "offset": (options.uniforms != Uniforms::Separate).then_some(uniform.offset),
            "binding": bound(args.binding + place).filter(|_| options.uniforms == Uniforms::Separate),
            "type": TYPES.get((uniform.components as usize).saturating_sub(1)),
            "source": match uniform.source {
                UniformSource::Origin => "origin",
                UniformSource::Time => "time",
                UniformSource::Parameter(_) => "parameter",
                UniformSource::OcclusionReach => "occlusion_reach",
                UniformSource::OcclusionStrength => "occlusion_strength",
                UniformSource::Factor(_) => "factor",
                UniformSource::Formula(_) => "computed",
                UniformSource::View(field) => field.name(),
            },
            "parameter": parameter,
            "start": (0..uniform.components).map(of).collect::<Vec<_>>(),
        })
    };
    let signature = |export: &Export| signature(*export).replace("sf_", &args.prefix);
    let buffer = |(i, (path, bytes)): (usize, &(PathBuf, &Vec<u8>))| {
        json!({ "binding": options.first_buffer(module.uniforms.len()) + i as u32, "type": BUFFER_TYPES.get(i), "bytes": bytes.len(), "file": path })
    };
    let chosen = compiled.parameters.iter().filter(|p| !p.choices.is_empty()).map(|p| {
        let set = values::choices(&args.set).into_iter().find(|(name, _)| *name == p.name).map(|(_, choice)| choice);
        (p.name.clone(), json!(set.or_else(|| p.choice().map(str::to_owned))))
    });
    json!({
        "version": LAYOUT_VERSION,
        "functions": module.exports.iter().map(signature).collect::<Vec<_>>(),
        "entries": if module.draws { vec![format!("{}vertex", args.prefix), format!("{}fragment", args.prefix)] } else { Vec::new() },
        "form": args.uniforms,
        "group": bound(args.group).filter(|_| options.uniforms != Uniforms::Private),
        "binding": bound(args.binding).filter(|_| options.uniforms == Uniforms::Block),
        "size": module.uniform_size,
        "uniforms": (0..).zip(&module.uniforms).map(field).collect::<Vec<_>>(),
        "parameters": compiled.parameters.iter().map(parameter_json).collect::<Vec<_>>(),
        "chosen": chosen.collect::<serde_json::Map<_, _>>(),
        "computed": module.computed,
        "buffers": tables.iter().enumerate().map(buffer).collect::<Vec<_>>(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prefixes_stay_names() {
        assert!(prefix("sf_").is_ok());
        assert!(prefix("").is_ok());
        for wrong in ["1a", "a-b", "a__b", "gl_a", "_", "é"] {
            assert!(prefix(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn functions_have_the_names_of_the_exports() {
        assert_eq!(export("trace"), Ok(Export::Trace));
        assert!(export("tracer").unwrap_err().contains("occlusion"));
    }
}
