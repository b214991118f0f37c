//! A material for Bevy: the module with the imports of naga_oil, and the Rust that adds it to an app.

use super::fields::{Field, Source, fields, picture, wgsl};
use super::fill::{fill, on_one_line};
use std::fmt::Write;
use surefoot_compiler::compiled::Compiled;

const SHADER: &str = include_str!("bevy.wgsl");
const PLUGIN: &str = include_str!("bevy.rs.txt");

/// The near and the far plane where rays come from the eye, and where they go side by side; the depth of a reversed projection without end included.
const PERSPECTIVE: &str = "sf_uniforms.view_fov = 2.0 * atan(1.0 / clip[1][1]);
  sf_uniforms.view_near = select(1e12, clip[3][2] / clip[2][2], abs(clip[2][2]) > 1e-9);
  sf_uniforms.view_far = select(1e12, clip[3][2] / (clip[2][2] + 1.0), abs(clip[2][2] + 1.0) > 1e-9);
  let aside = vec2f(clip[2][0], clip[2][1]);";
const PARALLEL: &str = "sf_uniforms.view_height = 2.0 / clip[1][1];
  sf_uniforms.view_near = clip[3][2] / clip[2][2];
  sf_uniforms.view_far = (clip[3][2] - 1.0) / clip[2][2];
  let aside = -vec2f(clip[3][0], clip[3][1]);";

/// The shader.
pub fn shader(compiled: &Compiled, title: &str) -> Result<String, String> {
    let fields = fields(compiled);
    let has = |name: &str| fields.iter().any(|field| field.name == name);
    let (mut members, mut taken) = (String::new(), String::new());
    for field in parameters(&fields) {
        let _ = writeln!(members, "  {}: {},", field.name, field.ty());
        let _ = writeln!(taken, "  sf_uniforms.{0} = sf_parameters.{0};", field.name);
    }
    if has("time") {
        taken.push_str("  sf_uniforms.time = globals.time;\n");
    }
    let declared = match members.is_empty() {
        true => String::new(),
        false => format!("struct sf_Parameters {{\n{members}}}\n@group(#{{MATERIAL_BIND_GROUP}}) @binding(0) var<uniform> sf_parameters: sf_Parameters;\n"),
    };
    let imports = if has("time") { "{view, globals}" } else { "view" };
    let parts = [
        ("TITLE", on_one_line(title)),
        ("PATH", name(title, false)),
        ("IMPORTS", imports.to_owned()),
        ("PARAMETERS", declared),
        ("MODULE", wgsl(compiled)),
        ("TAKEN", taken),
        ("PLANES", if has("view_height") { PARALLEL } else { PERSPECTIVE }.to_owned()),
        ("PICTURE", picture(compiled)?.to_owned()),
    ];
    Ok(fill(SHADER, &parts.each_ref().map(|(name, part)| (*name, part.as_str()))))
}

/// The plugin, which loads the shader as `file` from the app's assets.
pub fn plugin(compiled: &Compiled, title: &str, file: &str) -> String {
    let (mut members, mut start) = (String::new(), String::new());
    for field in parameters(&fields(compiled)) {
        let Source::Parameter(index) = field.source else { continue };
        let Some(parameter) = compiled.parameters.get(index) else { continue };
        let about = parameter.description.as_deref().map_or(String::new(), |about| format!("{}.", on_one_line(about)));
        let about = about.trim_start();
        let numbers: Vec<String> = field.start.iter().map(|number| format!("{number:?}")).collect();
        let (ty, value) = match numbers.as_slice() {
            [one] => ("f32".to_owned(), one.clone()),
            many => (format!("Vec{}", many.len()), format!("Vec{}::new({})", many.len(), many.join(", "))),
        };
        let range = |numbers: &[f64]| numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(", ");
        let (min, max) = (range(&parameter.min), range(&parameter.max));
        let _ = writeln!(members, "    /// {about}{}From {min} to {max}.\n    #[uniform(0)]\n    pub {}: {ty},", if about.is_empty() { "" } else { " " }, field.name);
        let _ = writeln!(start, "            {}: {value},", field.name);
    }
    let parts = [
        ("TITLE", on_one_line(title)),
        ("NAME", name(title, true)),
        ("FILE", file.replace(['\\', '"'], "_")),
        ("MEMBERS", members),
        ("START", start),
    ];
    fill(PLUGIN, &parts.each_ref().map(|(name, part)| (*name, part.as_str())))
}

fn parameters(fields: &[Field]) -> impl Iterator<Item = &Field> {
    fields.iter().filter(|field| matches!(field.source, Source::Parameter(_)))
}

/// What a person calls it, as a name of Rust: of a type, or of a module.
fn name(title: &str, is_type: bool) -> String {
    let words = title.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    let whole: Vec<String> = words
        .map(|word| match is_type {
            true => word[..1].to_uppercase() + &word[1..],
            false => word.to_lowercase(),
        })
        .collect();
    let text = whole.join(if is_type { "" } else { "_" });
    // No name ends in a digit, which naga would change, and none begins with one.
    let text = text.trim_matches(|c: char| c.is_ascii_digit() || c == '_');
    match (text.is_empty(), is_type) {
        (false, _) => text.to_owned(),
        (true, true) => "Scene".to_owned(),
        (true, false) => "scene".to_owned(),
    }
}
