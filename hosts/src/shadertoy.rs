//! A fragment shader for shadertoy.com, where the page gives the time, the size and the mouse, and calls `mainImage`.

use super::glsl;
use surefoot_compiler::compiled::{Compiled, UniformSource, ViewField};

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
    let functions = glsl::functions(compiled)?;
    let mut out = String::from("// For shadertoy.com: a new shader, with all of this in place of its text. Drag to go around the scene.\n//\n");
    out.push_str(&functions.text);
    let has = |source| module.uniforms.iter().any(|uniform| uniform.source == source);
    let time = if has(UniformSource::Time) { "    sf_uniforms.time = iTime;\n" } else { "" };
    if !has(UniformSource::View(ViewField::Size)) {
        return Err("the module knows no view".to_owned());
    }
    out.push('\n');
    out.push_str(&ENTRY.replace("TIME", time).replace("PICTURE", &functions.picture));
    Ok(out)
}
