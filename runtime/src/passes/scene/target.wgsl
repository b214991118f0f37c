// Pictures for an eye, on a target for screens.

const SCENE_CAPTURES: bool = false;

// A screen's colour as the target wants it. `field` says that it is the field's.
fn scene_target(encoded: vec3f, field: bool) -> vec4f {
    if !scene_linear {
        return vec4f(encoded, 1.0);
    }
    let c = encoded;
    return vec4f(select(pow((c + 0.055) / 1.055, vec3f(2.4)), c / 12.92, c <= vec3f(0.04045)), 1.0);
}
