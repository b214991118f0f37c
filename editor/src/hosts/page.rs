//! A page that draws a scene by WebGPU. It is one file, loads nothing, and says so: its policy names its own script and style by their digests, and
//! forbids all else.

use super::digest::{base64, sha256};
use serde_json::{Value, json};
use surefoot_compiler::compiled::{Compiled, UniformSource};

const PAGE: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// The page.
pub fn write(compiled: &Compiled, parameters: &[Value], title: &str) -> String {
    let module = &compiled.module;
    let start = compiled.uniform_bytes(&compiled.live(), [0.0; 3]);
    let tables = module.tables.as_ref().map_or(Vec::new(), |tables| {
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
        "buffers": tables.iter().map(|bytes| base64(bytes)).collect::<Vec<_>>(),
        "moves": compiled.reads_time(),
    });
    let digest = |text: &str| format!("'sha256-{}'", base64(&sha256(text.as_bytes())));
    let policy = format!("default-src 'none'; script-src {}; style-src {}; img-src data:; base-uri 'none'; form-action 'none'", digest(SCRIPT), digest(STYLE));
    // The texts go in last: what stands in them is no word of the page.
    let parts = [("POLICY", policy), ("TITLE", plain(title)), ("STYLE", STYLE.to_owned()), ("SCENE", harmless(&scene)), ("MODULE", module.code().replace("</", "< /")), ("SCRIPT", SCRIPT.to_owned())];
    let mut page = String::new();
    for piece in PAGE.split("%%") {
        match parts.iter().find(|(name, _)| *name == piece) {
            Some((_, text)) => page.push_str(text),
            None => page.push_str(piece),
        }
    }
    page
}

/// A text in a page.
fn plain(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}

/// Data in a page, which nothing in them ends.
fn harmless(data: &Value) -> String {
    data.to_string().replace('<', "\\u003c")
}
