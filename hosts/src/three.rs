//! Modules for three.js: an object that its page adds to a scene. Its renderers take different shaders: `WebGPURenderer` functions of WGSL, as nodes;
//! `WebGLRenderer` GLSL.

use super::fields::{fields, scene_script, wgsl};
use super::fill::{fill, on_one_line, quoted};
use super::glsl;
use serde_json::Value;
use surefoot_compiler::compiled::Compiled;

const GPU: &str = include_str!("three.js");
const GL: &str = include_str!("three_webgl.js");
const LOOK: &str = include_str!("look.js");
const FIELD: &str = include_str!("three_field.js");
const METHODS: &str = include_str!("three_methods.js");

/// What `ShaderMaterial` declares itself.
const DECLARED: [&str; 8] =
    ["modelMatrix", "modelViewMatrix", "projectionMatrix", "viewMatrix", "normalMatrix", "cameraPosition", "isOrthographic", "toneMappingExposure"];

/// The module for one of the renderers.
pub fn write(compiled: &Compiled, parameters: &[Value], title: &str, webgl: bool) -> Result<String, String> {
    let (host, renderer, template) = if webgl { ("three-webgl", "WebGLRenderer", GL) } else { ("three", "WebGPURenderer", GPU) };
    let (module, renamed) = if webgl { shader(compiled)? } else { (wgsl(compiled), Vec::new()) };
    let scene = scene_script(compiled, parameters, title, &renamed)?;
    let (head, module) = (head(title, host, renderer), quoted(&module));
    Ok(fill(template, &[("HEAD", &head), ("SCENE", &scene), ("MODULE", &module), ("LOOK", LOOK), ("FIELD", FIELD), ("METHODS", METHODS)]))
}

/// How it is used.
fn head(title: &str, host: &str, renderer: &str) -> String {
    let title = on_one_line(title);
    format!(
        "// {title} for three.js with {renderer}, written by `surefoot compile --for {host}`:\n//\n//     import {{ Field }} from './{title}.js';\n//     \
         scene.add(new Field());\n//\n// It is drawn with the host's camera, hides what stands behind it, and is hidden. `field.see(camera)` puts a camera where the\n\
         // scene's own camera is. `field.parameters` has the scene's parameters by their names.\n"
    )
}

/// The fragment shader, and the names of its uniforms where they are others than those of the fields.
fn shader(compiled: &Compiled) -> Result<(String, Vec<(String, String)>), String> {
    let functions = glsl::functions(compiled)?;
    let mut renamed = Vec::new();
    let (mut uniforms, mut taken) = (String::new(), String::new());
    for field in fields(compiled) {
        let at = compiled.module.uniforms.iter().position(|uniform| uniform.name == field.name);
        let Some((ty, member)) = at.and_then(|at| functions.members.get(at)) else { return Err(format!("the shader has no `{}`", field.name)) };
        let name = if DECLARED.contains(&member.as_str()) { format!("{member}_value") } else { member.clone() };
        uniforms.push_str(&format!("uniform {ty} {name};\n"));
        taken.push_str(&format!("  sf_uniforms.{member} = {name};\n"));
        if name != field.name {
            renamed.push((field.name, name));
        }
    }
    let entry = format!(
        "\n{uniforms}varying vec2 sf_at;\nvoid main() {{\n{taken}  vec2 size = sf_uniforms.view_size;\n  \
         sf_SceneFragment picture = {}(vec2(0.5 + 0.5 * sf_at.x, 0.5 - 0.5 * sf_at.y) * size);\n#ifndef SF_SKY\n  \
         if (picture.depth == (sf_uniforms.view_far > sf_uniforms.view_near ? 1.0 : 0.0)) discard;\n#endif\n  \
         gl_FragColor = vec4(picture.color.rgb, 1.0);\n  gl_FragDepth = picture.depth;\n  #include <colorspace_fragment>\n}}\n",
        functions.picture
    );
    Ok((functions.text + &entry, renamed))
}
