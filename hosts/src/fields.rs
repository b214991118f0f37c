//! What a host sets of a scene: the view, the time and the parameters, with their values at the start.

use serde_json::{Value, json};
use surefoot_compiler::compiled::{Compiled, UniformSource};

/// What names of these modules begin with.
pub const PREFIX: &str = "sf_";

/// WGSL's types of one to four numbers.
const TYPES: [&str; 4] = ["f32", "vec2f", "vec3f", "vec4f"];

/// A value that a host sets.
#[derive(Clone, Debug)]
pub struct Field {
    /// Its name in the module.
    pub name: String,
    /// What it is.
    pub source: Source,
    /// Its numbers at the start, one to four.
    pub start: Vec<f32>,
}

/// What a value is.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// One of the view.
    View,
    /// Seconds.
    Time,
    /// An index into [`Compiled::parameters`].
    Parameter(usize),
}

impl Field {
    /// Its type in WGSL.
    pub fn ty(&self) -> &'static str {
        TYPES.get(self.start.len().saturating_sub(1)).copied().unwrap_or("f32")
    }
}

/// What a host sets: all else has the value of the text.
pub fn fields(compiled: &Compiled) -> Vec<Field> {
    let start: Vec<f32> = compiled.uniform_bytes(&compiled.live(), [0.0; 3]).chunks_exact(4).map(|c| f32::from_le_bytes([c[0], c[1], c[2], c[3]])).collect();
    let source = |source| match source {
        UniformSource::View(_) => Some(Source::View),
        UniformSource::Time => Some(Source::Time),
        UniformSource::Parameter(first) => compiled.parameters.iter().position(|p| p.first == Some(first)).map(Source::Parameter),
        _ => None,
    };
    let field = |(source, name, at, count): (Source, &str, usize, usize)| {
        let start = start.get(at..at + count).map_or(vec![0.0; count], <[f32]>::to_vec);
        Field { name: name.to_owned(), source, start }
    };
    let all = compiled.module.uniforms.iter();
    all.filter_map(|u| Some((source(u.source)?, u.name.as_str(), u.offset as usize / 4, u.components as usize))).map(field).collect()
}

/// The function of the module that gives the colour and the depth at a place.
pub fn picture(compiled: &Compiled) -> Result<&str, String> {
    let named = |line: &'_ str| line.strip_prefix("fn ").and_then(|rest| rest.split('(').next()).filter(|name| name.starts_with("sf_scene_picture")).is_some();
    let line = compiled.module.wgsl.lines().find(|line| named(line));
    line.and_then(|line| line.get(3..)?.split('(').next()).ok_or_else(|| "the module has no function that draws".to_owned())
}

/// The module's text without the comment at its head and without its entry points: each host has its own.
pub fn wgsl(compiled: &Compiled) -> String {
    let text = compiled.module.wgsl.get(compiled.module.head().len()..).unwrap_or_default();
    let mut out = String::with_capacity(text.len());
    let mut is_entry = false;
    for line in text.lines() {
        is_entry |= line.starts_with("@vertex") || line.starts_with("@fragment");
        if !is_entry {
            out.extend([line, "\n"]);
        }
        is_entry &= line != "}";
    }
    out
}

/// The scene as data for a program: what a host sets, and how the scene's own camera sees it. `parameters` says what is known of each, `renamed` how
/// fields are called that have another name in the shader.
pub fn scene_json(compiled: &Compiled, parameters: &[Value], title: &str, renamed: &[(String, String)]) -> Result<Value, String> {
    let fields = fields(compiled);
    let find = |name: &str| fields.iter().find(|field| field.name == name).map(|field| &field.start);
    let one = |name: &str| find(name).and_then(|start| start.first()).copied().map(short);
    let many = |name: &str| find(name).map(|start| start.iter().copied().map(short).collect::<Vec<_>>());
    let listed = fields.iter().map(|field| {
        let parameter = match field.source {
            Source::Parameter(index) => compiled.parameters.get(index).map(|p| p.name.as_str()),
            _ => None,
        };
        let known = parameters.iter().find(|known| known["name"].as_str().is_some_and(|name| Some(name) == parameter));
        let start: Vec<f64> = field.start.iter().copied().map(short).collect();
        let mut data = json!({ "name": field.name, "type": field.ty(), "start": start });
        if let Some(data) = data.as_object_mut() {
            let source = match field.source {
                Source::View => "view",
                Source::Time => "time",
                Source::Parameter(_) => "parameter",
            };
            data.insert("source".to_owned(), json!(source));
            let uniform = renamed.iter().find(|(name, _)| *name == field.name);
            uniform.into_iter().for_each(|(_, name)| _ = data.insert("uniform".to_owned(), json!(name)));
            parameter.into_iter().for_each(|name| _ = data.insert("parameter".to_owned(), json!(name)));
            for key in ["min", "max", "description"] {
                known.and_then(|known| known.get(key)).filter(|value| !value.is_null()).into_iter().for_each(|value| _ = data.insert(key.to_owned(), value.clone()));
            }
        }
        data
    });
    Ok(json!({
        "name": title,
        "parallel": find("view_height").is_some(),
        "picture": picture(compiled)?,
        "fields": listed.collect::<Vec<_>>(),
        "camera": {
            "eye": many("view_eye"), "target": many("view_look_at"), "up": many("view_up"),
            "fov": one("view_fov"), "height": one("view_height"), "near": one("view_near"), "far": one("view_far"),
        },
        "bounds": compiled.bounds(),
        "moves": compiled.reads_time(),
    }))
}

/// A number with as many digits as tell it from its neighbours in 32 bits.
fn short(number: f32) -> f64 {
    number.to_string().parse().unwrap_or(f64::from(number))
}

/// The scene as text of JavaScript, a row for each field.
pub fn scene_script(compiled: &Compiled, parameters: &[Value], title: &str, renamed: &[(String, String)]) -> Result<String, String> {
    Ok(laid_out(&scene_json(compiled, parameters, title, renamed)?, "").replace("</", "<\\/"))
}

/// A scene as data, with a row for each of its keys and fields; `quote` stands about its keys.
pub fn laid_out(scene: &Value, quote: &str) -> String {
    let rows = |value: &Value| match value {
        Value::Array(rows) if rows.first().is_some_and(Value::is_object) => {
            format!("[\n{}\n  ]", rows.iter().map(|row| format!("    {row}")).collect::<Vec<_>>().join(",\n"))
        }
        other => other.to_string(),
    };
    let entries = scene.as_object().into_iter().flatten().map(|(key, value)| format!("  {quote}{key}{quote}: {}", rows(value)));
    format!("{{\n{}\n}}", entries.collect::<Vec<_>>().join(",\n"))
}
