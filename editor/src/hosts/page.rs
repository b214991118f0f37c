//! A page that draws a scene by WebGPU, and by WebGL 2 where there is none. It is one file, loads nothing, and says so: its policy names its own script and
//! style by their digests, and forbids all else.

use super::digest::{base64, sha256};
use super::fields::PREFIX;
use super::fill::fill;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::io::Write as _;
use surefoot_compiler::compiled::{Compiled, Live, UniformSource};
use surefoot_compiler::emit::{Target, translate};

const PAGE: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// The numbers of a union that a text in GLSL holds at most: longer lists of constants compile for minutes.
const MOST_ROWS: usize = 256;

const PANEL: &str = "<details open><summary>Parameters</summary><form></form><button id=\"pause\" type=\"button\">Pause</button></details>\n";

/// How a page shows a scene.
#[derive(Clone, Debug, Default)]
pub struct Showing {
    /// Width and height in CSS pixels; else it fills the window.
    pub size: Option<(u32, u32)>,
    /// Whether there is nothing beside the picture.
    pub bare: bool,
    /// What is seen before the first picture, and where nothing can draw one: a JPEG.
    pub poster: Option<Vec<u8>>,
}

/// The page.
pub fn write(compiled: &Compiled, live: &Live, parameters: &[Value], title: &str, showing: &Showing) -> String {
    let module = &compiled.module;
    let start = compiled.uniform_bytes(live, [0.0; 3]);
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
        "buffers": tables.iter().map(|bytes| packed(bytes)).collect::<Vec<_>>(),
        "moves": compiled.reads_time(),
    });
    let mut style = STYLE.to_owned();
    if let Some((width, height)) = showing.size {
        let _ = writeln!(
            style,
            "body {{ display: grid; place-items: center; }}\ncanvas, #poster {{ position: static; grid-area: 1 / 1; width: min(100vw, {width}px, 100vh * {width} / {height}); height: auto; aspect-ratio: {width} / {height}; }}"
        );
    }
    let poster = showing.poster.as_ref().map_or(String::new(), |jpeg| format!("<img id=\"poster\" alt=\"\" src=\"data:image/jpeg;base64,{}\">\n", base64(jpeg)));
    let glsl = glsl(compiled).map_or(String::new(), |text| format!("<script type=\"application/octet-stream\" id=\"glsl\">{}</script>\n", packed(text.as_bytes())));
    let panel = if showing.bare { "" } else { PANEL };
    let digest = |text: &str| format!("'sha256-{}'", base64(&sha256(text.as_bytes())));
    let policy = format!("default-src 'none'; script-src {}; style-src {}; img-src data:; base-uri 'none'; form-action 'none'", digest(SCRIPT), digest(&style));
    let parts = [
        ("POLICY", policy.as_str()),
        ("TITLE", &plain(title)),
        ("STYLE", &style),
        ("POSTER", &poster),
        ("PANEL", panel),
        ("SCENE", &harmless(&scene)),
        ("MODULE", &packed(module.code().as_bytes())),
        ("GLSL", &glsl),
        ("SCRIPT", SCRIPT),
    ];
    fill(PAGE, &parts)
}

/// A text in a page.
fn plain(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}

/// Data in a page, which nothing in them ends.
fn harmless(data: &Value) -> String {
    data.to_string().replace('<', "\\u003c")
}

/// Bytes packed as zlib does, in base 64.
fn packed(bytes: &[u8]) -> String {
    let mut packer = ZlibEncoder::new(Vec::new(), Compression::best());
    // Nothing that is written into memory fails.
    base64(&packer.write_all(bytes).and_then(|()| packer.finish()).unwrap_or_default())
}

/// The fragment shader for WebGL 2; none where that has no place for what the scene reads.
fn glsl(compiled: &Compiled) -> Option<String> {
    let module = &compiled.module;
    if module.grids || module.tables.as_ref().is_some_and(|tables| tables.tables.rows.len() > MOST_ROWS) {
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
