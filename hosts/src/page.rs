//! A page that draws a scene by WebGPU, and by WebGL 2 where there is none. It is one file, loads nothing, and says so: its policy names its own script and
//! style by their digests, and forbids all else.

use super::digest::{base64, sha256};
use super::drawn::Drawn;
use super::fill::fill;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::io::Write as _;
use surefoot_compiler::compiled::{Compiled, Live};

const PAGE: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
/// How scenes are drawn and shown: modules of JavaScript that import nothing. A page of its own stands on them too.
pub const DRAW: &str = include_str!("draw.js");
/// See [`DRAW`].
pub const SHOW: &str = include_str!("show.js");
const PAGE_SCRIPT: &str = include_str!("page.js");

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
    let drawn = Drawn::of(compiled, live, parameters);
    let mut scene = drawn.scene;
    if let Some(scene) = scene.as_object_mut() {
        scene.insert("buffers".to_owned(), json!(drawn.buffers.iter().map(|bytes| packed(bytes)).collect::<Vec<_>>()));
    }
    let mut style = STYLE.to_owned();
    if let Some((width, height)) = showing.size {
        let _ = writeln!(
            style,
            "body {{ display: grid; place-items: center; }}\ncanvas, #poster {{ position: static; grid-area: 1 / 1; width: min(100vw, {width}px, 100vh * {width} / {height}); height: auto; aspect-ratio: {width} / {height}; }}"
        );
    }
    let poster = showing.poster.as_ref().map_or(String::new(), |jpeg| format!("<img id=\"poster\" alt=\"\" src=\"data:image/jpeg;base64,{}\">\n", base64(jpeg)));
    let glsl = drawn.glsl.map_or(String::new(), |text| format!("<script type=\"application/octet-stream\" id=\"glsl\">{}</script>\n", packed(text.as_bytes())));
    // Nothing in a page of one file is imported.
    let script = format!("\n{DRAW}\n{SHOW}\n{PAGE_SCRIPT}");
    let panel = if showing.bare { "" } else { PANEL };
    let digest = |text: &str| format!("'sha256-{}'", base64(&sha256(text.as_bytes())));
    let policy = format!("default-src 'none'; script-src {}; style-src {}; img-src data:; base-uri 'none'; form-action 'none'", digest(&script), digest(&style));
    let parts = [
        ("POLICY", policy.as_str()),
        ("TITLE", &plain(title)),
        ("STYLE", &style),
        ("POSTER", &poster),
        ("PANEL", panel),
        ("SCENE", &harmless(&scene)),
        ("MODULE", &packed(drawn.code.as_bytes())),
        ("GLSL", &glsl),
        ("SCRIPT", &script),
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
