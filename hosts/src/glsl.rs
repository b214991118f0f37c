//! The functions of a scene as GLSL ES 3.0, for hosts that put their own entry point behind them.

use super::fields::{PREFIX, picture};
use surefoot_compiler::compiled::Compiled;
use surefoot_compiler::emit::{Target, translate};

/// The functions, and the one that gives colour and depth at a place.
pub struct Functions {
    /// Their text, without version, precision, and entry point.
    pub text: String,
    /// The name of the function that draws.
    pub picture: String,
    /// Type and name of each field of the struct of what can be set, in the module's order.
    pub members: Vec<(String, String)>,
}

/// The functions of a scene whose uniforms are private.
pub fn functions(compiled: &Compiled) -> Result<Functions, String> {
    let bytes = translate(&compiled.module, PREFIX, Target::Glsl)?;
    let text = String::from_utf8(bytes).map_err(|e| e.to_string())?;
    let (functions, _) = text.split_once("\nvoid main() {").ok_or("the shader has no entry point")?;
    let own = |line: &&str| !["#version", "precision ", "layout(location", "smooth in", "// The uniform block"].iter().any(|start| line.starts_with(start));
    let text: String = functions.lines().filter(own).flat_map(|line| [line, "\n"]).collect();
    let members = text.split_once("struct sf_Uniforms {").and_then(|(_, rest)| rest.split_once('}')).map_or("", |(members, _)| members);
    let member = |line: &str| line.trim().trim_end_matches(';').split_once(' ').map(|(ty, name)| (ty.to_owned(), name.to_owned()));
    let members = members.lines().filter_map(member).collect();
    Ok(Functions { picture: picture(compiled)?.to_owned(), members, text })
}
