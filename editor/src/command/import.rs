//! `surefoot import`: a shader's functions as a scene.

use super::console::{Exit, Failure, colored, print};
use crate::files;
use std::path::{Path, PathBuf};
use surefoot_compiler::diagnostic::{self, Code, Diagnostic};
use surefoot_compiler::program::load::translate;
use surefoot_compiler::shader::{Language, Translation};
use surefoot_compiler::source::{Sources, Span};
use surefoot_compiler::syntax;

/// What to write as a scene.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The shader: GLSL (`.glsl`, `.frag`) as for shadertoy.com, or WGSL (`.wgsl`).
    #[arg(value_name = "SHADER")]
    shader: String,
    /// The scene to write; standard output where it is left out.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// The function whose value is the distance. Left out, it is `map`, or the last that takes a point and gives back a distance.
    #[arg(long, value_name = "NAME")]
    function: Option<String>,
}

/// Translates the shader. What it has that the language can't say is named.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    let Some(language) = Language::of(&args.shader) else {
        return Err(Failure::usage(format!("{} is no shader by its name: its end is `.glsl`, `.frag` or `.wgsl`", args.shader)));
    };
    let bytes = files::read(Path::new(&args.shader)).map_err(|why| Failure::usage(format!("can't read {}: {why}", args.shader)))?;
    let text = String::from_utf8(bytes).map_err(|_| Failure::usage(format!("can't read {}: the text is not UTF-8", args.shader)))?;
    let mut sources = Sources::default();
    let file = sources.add(args.shader.as_str(), text.as_str());
    let made = match translate(&args.shader, &text, language) {
        Ok(made) => made,
        Err(failures) => {
            let said = |why: &surefoot_compiler::shader::Failure| {
                Diagnostic::new(Code::Shader, Span::new(file, why.range.start, why.range.end), why.message.clone(), why.help.clone())
            };
            let diagnostics: Vec<Diagnostic> = failures.iter().map(said).collect();
            eprint!("{}", diagnostic::render(&sources, &diagnostics, colored(&std::io::stderr())));
            return Ok(Exit::Errors);
        }
    };
    for (name, why) in &made.left_out {
        let (_, line, _) = sources.position(file, why.range.start as u32);
        eprintln!("note: {}:{line}: `{name}` is left out: {}", args.shader, why.message);
    }
    let scene = scene(&made, args.function.as_deref()).map_err(Failure::usage)?;
    let whole = format!("{}\n{scene}", made.text);
    let whole = syntax::format(&whole).unwrap_or(whole);
    match &args.output {
        None => print(whole.as_bytes())?,
        Some(path) => files::write(path, whole.as_bytes()).map_err(|why| Failure::usage(format!("can't write {}: {why}", path.display())))?,
    }
    Ok(Exit::Fine)
}

/// The declarations that make a scene of one of the functions.
fn scene(made: &Translation, wanted: Option<&str>) -> Result<String, String> {
    let distances = || made.functions.iter().filter(|function| function.is_distance());
    let function = match wanted {
        Some(name) => made.functions.iter().find(|function| function.name == name).ok_or_else(|| {
            let why = made.left_out.iter().find(|(known, _)| known == name).map(|(_, why)| why.message.as_str());
            format!("`{name}` can't be the scene: {}", why.unwrap_or("the shader has no such function"))
        })?,
        None => match distances().find(|function| function.name == "map").or_else(|| distances().next_back()) {
            Some(function) => function,
            None => return Err("no function of the shader takes a point and gives back a distance; `--function NAME` names another one".to_owned()),
        },
    };
    let Some(first) = function.results.first() else { return Err(format!("`{}` gives nothing back", function.name)) };
    let part = if function.ty.starts_with("vec") { ".x" } else { "" };
    let name = ["solid", "solid_field", "the_solid"].into_iter().find(|name| !made.functions.iter().any(|function| function.results.iter().any(|known| known == name)));
    let name = name.unwrap_or("solid_of_the_shader");
    Ok(format!("field {name} = {first}(p){part}\n\nscene = {name}\n"))
}
