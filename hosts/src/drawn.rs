//! What a page in a browser draws a scene from: its uniforms and parameters as data, its shaders, and the numbers of its tables.

use super::fields::PREFIX;
use serde_json::{Value, json};
use surefoot_compiler::compiled::{Compiled, Live, UniformSource};
use surefoot_compiler::emit::{Target, translate};

/// The numbers of a union that a text in GLSL holds at most: longer lists of constants compile for minutes.
const MOST_ROWS: usize = 256;

/// A scene for `draw.js` and `show.js`.
#[derive(Clone, Debug)]
pub struct Drawn {
    /// `fields`: where each value that a page sets stands in the uniform block, counted in numbers of 32 bits; `start`: the block as such words;
    /// `parameters`; `moves`: whether the scene reads the time.
    pub scene: Value,
    /// The module in WGSL, without the comment at its head.
    pub code: String,
    /// The fragment shader for WebGL 2; none where that has no place for what the scene reads.
    pub glsl: Option<String>,
    /// The tables and lists of large unions, bound after the uniforms.
    pub buffers: Vec<Vec<u8>>,
}

impl Drawn {
    /// That of a scene whose module is that of [`Host::Html`](crate::Host::Html), with these values at its start. `parameters` are those of the scene as data.
    pub fn of(compiled: &Compiled, live: &Live, parameters: &[Value]) -> Self {
        let module = &compiled.module;
        let start = compiled.uniform_bytes(live, [0.0; 3]);
        let buffers = module.tables.as_ref().map_or(Vec::new(), |tables| {
            let mut rows: Vec<u8> = tables.tables.rows.iter().flatten().flat_map(|number| number.to_le_bytes()).collect();
            // No buffer may be empty.
            rows.resize(rows.len().max(16), 0);
            vec![rows, tables.lists().iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<u8>>()]
        });
        let fields = module.uniforms.iter().map(|uniform| {
            let source = match uniform.source {
                UniformSource::View(field) => field.name().to_owned(),
                UniformSource::Time => "time".to_owned(),
                UniformSource::Parameter(first) => {
                    let parameter = compiled.parameters.iter().find(|p| p.first == Some(first));
                    format!("parameter {}", parameter.map_or("", |p| p.name.as_str()))
                }
                _ => String::new(),
            };
            (source, json!(uniform.offset / 4))
        });
        let scene = json!({
            "fields": fields.filter(|(source, _)| !source.is_empty()).collect::<serde_json::Map<_, _>>(),
            "start": start.chunks_exact(4).map(|c| f32::from_le_bytes([c[0], c[1], c[2], c[3]]).to_bits()).collect::<Vec<u32>>(),
            "parameters": parameters,
            "moves": compiled.reads_time(),
        });
        Self { scene, code: module.code().to_owned(), glsl: glsl(compiled), buffers }
    }
}

/// The fragment shader for WebGL 2; none where that has no place for what the scene reads.
fn glsl(compiled: &Compiled) -> Option<String> {
    let module = &compiled.module;
    if module.needs_buffers || module.tables.as_ref().is_some_and(|tables| tables.tables.rows.len() > MOST_ROWS) {
        return None;
    }
    let text = String::from_utf8(translate(module, PREFIX, Target::Glsl).ok()?).ok()?;
    // OpenGL counts rows from the bottom.
    let block = text.lines().find(|line| line.contains(") uniform ") && line.contains("_block_"))?;
    let variable = block.split(';').next()?.rsplit(' ').next()?;
    let text = text.replace("= gl_FragCoord;", &format!("= vec4(gl_FragCoord.x, {variable}.view_size.y - gl_FragCoord.y, gl_FragCoord.zw);"));
    Some(text.lines().filter(|line| !line.trim_start().starts_with("//")).fold(String::new(), |mut code, line| {
        code.push_str(line.trim_start());
        code.push('\n');
        code
    }))
}
