//! A fragment shader for shadertoy.com, where the page gives the time, the size and the mouse, and calls `mainImage`.

use surefoot_compiler::compiled::{Compiled, UniformSource, ViewField};
use surefoot_compiler::emit::{Target, translate};

/// What stands for naga's entry point. `PICTURE` is the function that draws, `TIME` a line that takes the time where the scene has one.
const ENTRY: &str = "\
void mainImage(out vec4 fragColor, in vec2 fragCoord) {
TIME    sf_uniforms.view_size = iResolution.xy;
    // Who drags goes around what the eye looks at.
    vec2 dragged = (iMouse.xy - abs(iMouse.zw)) / iResolution.xy;
    vec3 way = sf_uniforms.view_eye - sf_uniforms.view_look_at;
    float far = max(length(way), 1e-9);
    float turn = atan(way.x, way.z) - 6.2831853 * dragged.x;
    float rise = asin(clamp(way.y / far, -1.0, 1.0));
    rise = dragged.y == 0.0 ? rise : clamp(rise - 3.0 * dragged.y, -1.55, 1.55);
    if (dragged != vec2(0.0)) {
        sf_uniforms.view_eye = sf_uniforms.view_look_at + far * vec3(sin(turn) * cos(rise), sin(rise), cos(turn) * cos(rise));
    }
    // Rows count from the top.
    fragColor = vec4(PICTURE(vec2(fragCoord.x, iResolution.y - fragCoord.y)).color.rgb, 1.0);
}
";

/// The shader, of a scene whose uniforms are private.
pub fn write(compiled: &Compiled) -> Result<String, String> {
    let module = &compiled.module;
    let bytes = translate(module, "sf_", Target::Glsl)?;
    let text = String::from_utf8(bytes).map_err(|e| e.to_string())?;
    let picture = module.wgsl.lines().find_map(|line| line.strip_prefix("fn ")?.split('(').next().filter(|name| name.starts_with("sf_scene_picture")));
    let picture = picture.ok_or("the module has no function that draws")?;
    let (functions, _) = text.split_once("\nvoid main() {").ok_or("the shader has no entry point")?;
    let own = |line: &&str| !["#version", "precision ", "layout(location", "smooth in", "// The uniform block"].iter().any(|start| line.starts_with(start));
    let mut out = String::from("// For shadertoy.com: a new shader, with all of this in place of its text. Drag to go around the scene.\n//\n");
    for line in functions.lines().filter(own) {
        out.push_str(line);
        out.push('\n');
    }
    let has = |source| module.uniforms.iter().any(|uniform| uniform.source == source);
    let time = if has(UniformSource::Time) { "    sf_uniforms.time = iTime;\n" } else { "" };
    if !has(UniformSource::View(ViewField::Size)) {
        return Err("the module knows no view".to_owned());
    }
    out.push('\n');
    out.push_str(&ENTRY.replace("TIME", time).replace("PICTURE", picture));
    Ok(out)
}
