//! Functions of shaders, in GLSL and WGSL, as text of the language: what people have written for other programs.
//!
//! naga reads the shader. What its statements do one after another to variables becomes names with values: a variable that is written again is a new name
//! that hides the old one, a branch is a choice between values, a loop replaces some names each turn.

mod author;
mod file;
mod failure;
mod formula;
mod function;
mod macros;
mod program;
mod read;
mod tidy;
mod turns;
mod value;
mod write;

pub use failure::{Failure, Language};

use rustc_hash::{FxHashMap, FxHashSet};
use std::ops::Range;

/// A shader as text of the language.
#[derive(Clone, Debug, PartialEq)]
pub struct Translation {
    /// Declarations: `let` for constants, `param` for what is given from outside, `fn` for functions.
    pub text: String,
    /// The functions.
    pub functions: Vec<Function>,
    /// The functions that can't be said, and why.
    pub left_out: Vec<(String, Failure)>,
}

/// A function of a shader that is translated.
#[derive(Clone, Debug, PartialEq)]
pub struct Function {
    /// Its name in the shader.
    pub name: String,
    /// Its names in the text. One that gives back a struct, or writes its arguments, is a function for each number, vector or matrix.
    pub results: Vec<String>,
    /// The types of its parameters.
    pub parameters: Vec<&'static str>,
    /// The type of the first result.
    pub ty: &'static str,
    /// By what share of its value the shader's own loop steps, where it has one, and the bytes where that is written.
    pub step: Option<(f64, Range<usize>)>,
}

impl Function {
    /// Whether it takes a point of space, and gives back a number that may be a distance.
    pub fn is_distance(&self) -> bool {
        self.parameters == ["vec3"] && matches!(self.ty, "float" | "vec2" | "vec3" | "vec4")
    }
}

/// Words that no name may be, and names that the text uses for what the language has.
const OWN: &[&str] = &[
    "time", "true", "false", "min", "max", "abs", "sign", "floor", "ceil", "trunc", "round", "sqrt", "exp", "log", "pow", "sin",
    "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "asinh", "acosh", "atanh", "length", "distance", "dot", "cross", "normalize", "vec2", "vec3", "vec4",
    "mat2", "mat3", "mat4", "transpose", "determinant", "inverse", "int", "clamp", "saturate", "mix", "step", "smoothstep", "fract", "exp2", "log2", "inversesqrt",
    "radians", "degrees", "fma", "reflect", "refract", "faceforward", "p",
];

/// Room for what naga reads of the longest text, in a build without optimisation.
const STACK: usize = 512 << 20;

/// Translates a shader. `keywords` are the language's. What can't be read at all is an error; a function that can't be said is left out.
pub fn translate(text: &str, language: Language, keywords: &[&str]) -> Result<Translation, Vec<Failure>> {
    stacker::maybe_grow(STACK / 2, STACK, || translate_here(text, language, keywords))
}

fn translate_here(text: &str, language: Language, keywords: &[&str]) -> Result<Translation, Vec<Failure>> {
    let read = read::read(text, language)?;
    let file = function::translate_all(&read);
    let is_own = |name: &str| OWN.contains(&name) || keywords.contains(&name);
    let mut reserved: FxHashSet<String> = OWN.iter().filter(|name| **name != "p").chain(keywords).map(|name| (*name).to_owned()).collect();
    let mut renamed: FxHashMap<String, String> = FxHashMap::default();
    let constants = file.constants();
    let made = || read.module.functions.iter().filter_map(|(handle, function)| Some((handle, function.name.as_deref().unwrap_or_default(), file.made.get(&handle)?)));
    let declared = made().filter_map(|(_, _, made)| made.as_ref().ok()).flat_map(|made| made.results.iter().map(|made| made.name.clone()));
    let all = declared.chain(constants.iter().map(|(name, _)| name.clone())).chain(file.uniforms.iter().map(|(name, _, _)| name.clone()));
    for name in all {
        if is_own(&name) {
            renamed.insert(name.clone(), format!("{name}_"));
        }
        reserved.insert(name);
    }
    let writer = write::Writer { reserved: &reserved, renamed: &renamed };
    let called = |name: &str| renamed.get(name).cloned().unwrap_or_else(|| name.to_owned());
    let (mut functions, mut left_out, mut bodies) = (Vec::new(), Vec::new(), Vec::new());
    let steps = author::steps(&read.module);
    for (handle, name, made) in made() {
        match made {
            Ok(made) if made.results.is_empty() => {}
            Ok(made) => {
                functions.push(Function {
                    name: name.to_owned(),
                    results: made.results.iter().map(|made| called(&made.name)).collect(),
                    parameters: made.parameters.iter().map(|(_, ty)| *ty).collect(),
                    step: steps.get(&handle).map(|(share, span)| (*share, read.place(*span))),
                    ty: made.results.first().map_or("float", |made| made.ty),
                });
                for result in &made.results {
                    bodies.push(writer.function(&result.name, &made.parameters, &made.names, &result.body));
                }
            }
            Err(why) => left_out.push((name.to_owned(), why.clone())),
        }
    }
    let bodies = bodies.join("\n\n");
    let is_read = |name: &str| bodies.split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| word == name);
    let mut heads = Vec::new();
    for (name, ty, zero) in &file.uniforms {
        if is_read(&called(name)) {
            heads.push(format!("param {}: {ty} = {}", called(name), writer.constant(zero)));
        }
    }
    for (name, ex) in &constants {
        let value = writer.constant(ex);
        heads.push(format!("let {} = {value}", called(name)));
    }
    let text = [heads.join("\n"), bodies].iter().filter(|part| !part.is_empty()).cloned().collect::<Vec<_>>().join("\n\n");
    Ok(Translation { text: text + "\n", functions, left_out })
}
