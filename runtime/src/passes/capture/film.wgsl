// Pictures for mirrors: light as it is, on a target of 16-bit floats.

const SCENE_CAPTURES: bool = true;

fn scene_develop(light: vec3f) -> vec3f {
    return clamp(light, vec3f(0.0), vec3f(65000.0));
}

// `field` says that the light is the field's.
fn scene_target(light: vec3f, field: bool, position: vec2f) -> vec4f {
    return vec4f(light, select(0.0, 1.0, field));
}
