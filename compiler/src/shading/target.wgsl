// Pictures for an eye, on a target for screens.

const SCENE_CAPTURES: bool = false;

// A screen's colour as the target wants it. `field` says that it is the field's, `position` is the pixel.
fn scene_target(encoded: vec3f, field: bool, position: vec2f) -> vec4f {
    let c = clamp(encoded + scene_step * screen_dither(position - floor(scene.corner)), vec3f(0.0), vec3f(1.0));
    if !scene_linear {
        return vec4f(c, 1.0);
    }
    return vec4f(select(pow((c + 0.055) / 1.055, vec3f(2.4)), c / 12.92, c <= vec3f(0.04045)), 1.0);
}
