//! Modules for Python and wgpu-py: a class that a program draws within a pass of its own.

use super::fields::{laid_out, scene_json, wgsl};
use super::fill::{fill, on_one_line};
use serde_json::{Value, json};
use surefoot_compiler::compiled::Compiled;

const TEMPLATE: &str = include_str!("wgpu_py.py");

/// The module.
pub fn write(compiled: &Compiled, parameters: &[Value], title: &str) -> Result<String, String> {
    let mut scene = scene_json(compiled, parameters, title, &[])?;
    for field in scene["fields"].as_array_mut().into_iter().flatten() {
        let uniform = compiled.module.uniforms.iter().find(|uniform| Some(uniform.name.as_str()) == field["name"].as_str());
        field["offset"] = json!(uniform.map(|uniform| uniform.offset));
    }
    let scene = laid_out(&scene, "\"");
    let start: String = compiled.uniform_bytes(&compiled.live(), [0.0; 3]).iter().map(|byte| format!("{byte:02x}")).collect();
    let title = on_one_line(title);
    let head = format!(
        "# {title} for wgpu-py, written by `surefoot compile --for wgpu-py`:\n#\n#     from {title} import Field\n#     field = Field(device, \
         \"bgra8unorm\", \"depth32float\")\n#     field.draw(render_pass, view, projection, (width, height))\n#\n# It hides what stands behind it, and is \
         hidden. `field.camera(aspect)` is the scene's own camera. `field.parameters` has the\n# scene's parameters by their names, `field.world` is where it \
         stands.\n"
    );
    // Nothing of a scene ends a text of Python: a comment of the module could.
    let module = wgsl(compiled).replace("'''", "' ' '");
    Ok(fill(TEMPLATE, &[("HEAD", &head), ("SCENE", &scene.replace('\'', "\\u0027")), ("START", &start), ("MODULE", &module)]))
}
