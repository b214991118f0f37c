//! A shader for Godot 4. Its language is GLSL without global variables: what the module keeps in them goes from function to function as an argument.

use super::fields::{Source, fields};
use super::fill::{fill, on_one_line};
use super::glsl;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use surefoot_compiler::compiled::Compiled;

const SHADER: &str = include_str!("godot.gdshader");

/// Words of the language that GLSL does not have.
const WORDS: [&str; 16] = [
    "PI", "TAU", "E", "instance", "global", "group_uniforms", "source_color", "render_mode", "shader_type", "stencil_mode", "vertex", "fragment", "light",
    "start", "sky", "fog",
];

const PERSPECTIVE: &str = "vec2 at = way.xy / -way.z * scale;
	sf_uniforms.view_fov = 2.0 * atan(1.0 / scale.y);
	sf_uniforms.view_near = abs(clip[2][2] + first) > 1e-9 ? unit * clip[3][2] / (clip[2][2] + first) : 1e12;
	sf_uniforms.view_far = abs(clip[2][2] + last) > 1e-9 ? unit * clip[3][2] / (clip[2][2] + last) : 1e12;";
const PARALLEL: &str = "vec2 at = way.xy * scale;
	sf_uniforms.view_height = 2.0 * unit / scale.y;
	sf_uniforms.view_near = unit * (clip[3][2] - first) / clip[2][2];
	sf_uniforms.view_far = unit * (clip[3][2] - last) / clip[2][2];";

/// The shader.
pub fn write(compiled: &Compiled, title: &str) -> Result<String, String> {
    let functions = glsl::functions(compiled)?;
    let code: String = functions.text.lines().filter(|line| !line.starts_with("//")).flat_map(|line| [line, "\n"]).collect();
    let (code, globals) = without_globals(&code);
    let taken: BTreeSet<&str> = tokens(&code).map(|(_, word)| word).collect();
    let (mut uniforms, mut given) = (String::new(), String::new());
    for field in fields(compiled) {
        let at = compiled.module.uniforms.iter().position(|uniform| uniform.name == field.name);
        let Some((ty, member)) = at.and_then(|at| functions.members.get(at)) else { return Err(format!("the shader has no `{}`", field.name)) };
        let Source::Parameter(index) = field.source else { continue };
        let Some(parameter) = compiled.parameters.get(index) else { continue };
        // No variable may have a uniform's name.
        let members = functions.members.iter().filter(|(_, name)| name == member).count();
        let used = tokens(&code).filter(|(at, word)| word == member && !code[..*at].ends_with('.')).count();
        let name = if used > members || WORDS.contains(&member.as_str()) { format!("{}_value", field.name) } else { member.clone() };
        let numbers: Vec<String> = field.start.iter().map(|number| format!("{number:?}")).collect();
        let (hint, start) = match (numbers.as_slice(), parameter.min.first().zip(parameter.max.first())) {
            ([one], Some((min, max))) => (format!(" : hint_range({:?}, {:?})", *min as f32, *max as f32), one.clone()),
            (many, _) => (String::new(), format!("{ty}({})", many.join(", "))),
        };
        let about = parameter.description.as_deref().map_or(String::new(), |about| format!(" // {}", on_one_line(about)));
        let _ = writeln!(uniforms, "uniform {ty} {name}{hint} = {start};{about}");
        let _ = writeln!(given, "\tsf_uniforms.{member} = {name};");
    }
    let has = |name: &str| functions.members.iter().any(|(_, member)| member == name);
    if has("time") {
        given.push_str("\tsf_uniforms.time = TIME;\n");
    }
    let declared: String = globals.iter().map(|(name, (ty, start))| format!("\t{ty} {name} = {start};\n")).collect();
    let first: Vec<&str> = globals.keys().map(String::as_str).filter(|name| taken.contains(name)).collect();
    let parts = [
        ("TITLE", on_one_line(title)),
        ("UNIFORMS", uniforms),
        ("CODE", code.trim().to_owned()),
        ("DECLARED", declared),
        ("GIVEN", given),
        ("PLANES", if has("view_height") { PARALLEL } else { PERSPECTIVE }.to_owned()),
        ("PICTURE", format!("{}({}, ", functions.picture, first.join(", "))),
    ];
    Ok(fill(SHADER, &parts.each_ref().map(|(name, part)| (*name, part.as_str()))))
}

/// The words of a text that are names, and where each stands.
fn tokens(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let is_name = |c: u8| c.is_ascii_alphanumeric() || c == b'_';
    let bytes = text.as_bytes();
    let mut at = 0;
    std::iter::from_fn(move || {
        while at < bytes.len() && !is_name(bytes[at]) {
            at += 1;
        }
        let from = at;
        while at < bytes.len() && is_name(bytes[at]) {
            at += 1;
        }
        (from < at).then(|| (from, &text[from..at]))
    })
}

/// The code without its global variables, and they: name, type and first value. Each function that reads one, or calls one that does, gets it as an argument
/// before its own.
fn without_globals(code: &str) -> (String, BTreeMap<String, (String, String)>) {
    let mut globals = BTreeMap::new();
    let mut rest = String::with_capacity(code.len());
    for line in code.lines() {
        let is_plain = !line.starts_with([' ', '}']) && !line.starts_with("const ") && line.ends_with(';');
        match is_plain.then(|| line.trim_end_matches(';').split_once(" = ")).flatten().and_then(|(left, start)| Some((left.split_once(' ')?, start))) {
            Some(((ty, name), start)) => _ = globals.insert(name.to_owned(), (ty.to_owned(), start.to_owned())),
            None => rest.extend([line, "\n"]),
        }
    }
    // Functions in their order: no one calls one that stands behind it.
    let mut needs: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    let mut of = None;
    for line in rest.lines() {
        if !line.starts_with([' ', '}']) && line.ends_with(") {") {
            of = line.split('(').next().and_then(|head| head.rsplit(' ').next());
            of.into_iter().for_each(|name| _ = needs.entry(name).or_default());
            continue;
        }
        let Some(name) = of else { continue };
        for (at, word) in tokens(line) {
            let own = globals.get_key_value(word).filter(|_| !line[..at].ends_with('.')).map(|(key, _)| key.as_str());
            let called: Vec<&str> = needs.get(word).into_iter().flatten().copied().chain(own).collect();
            needs.entry(name).or_default().extend(called);
        }
    }
    let mut text = String::with_capacity(rest.len());
    let mut copied = 0;
    for (at, word) in tokens(&rest) {
        let end = at + word.len();
        let Some(needed) = needs.get(word).filter(|needed| !needed.is_empty() && rest[end..].starts_with('(')) else { continue };
        let line = rest[..at].rfind('\n').map_or(0, |at| at + 1);
        let declares = !rest[line..].starts_with([' ', '}']);
        let arguments: Vec<String> = needed
            .iter()
            .map(|name| match globals.get(*name).filter(|_| declares) {
                Some((ty, _)) => format!("inout {ty} {name}"),
                None => (*name).to_owned(),
            })
            .collect();
        text.push_str(&rest[copied..=end]);
        text.push_str(&arguments.join(", "));
        if !rest[end + 1..].starts_with(')') {
            text.push_str(", ");
        }
        copied = end + 1;
    }
    text.push_str(&rest[copied..]);
    (text, globals)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn globals_become_arguments() {
        let code = "const float k = 1.0;\nS sf_s = S(0.0);\nfloat one(float s) {\n    return s;\n}\nfloat two() {\n    return sf_s.x + one(k);\n}\nfloat three(vec3 p) {\n    return two() * p.x;\n}\n";
        let (text, globals) = without_globals(code);
        assert_eq!(globals, BTreeMap::from([("sf_s".to_owned(), ("S".to_owned(), "S(0.0)".to_owned()))]));
        assert_eq!(
            text,
            "const float k = 1.0;\nfloat one(float s) {\n    return s;\n}\nfloat two(inout S sf_s) {\n    return sf_s.x + one(k);\n}\nfloat three(inout S sf_s, vec3 p) {\n    return two(sf_s) * p.x;\n}\n"
        );
    }
}
