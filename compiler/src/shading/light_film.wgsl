// Light as it is, on a target of 16-bit floats: what stands after it develops it.

const SCENE_CAPTURES: bool = false;

fn scene_develop(light: vec3f) -> vec3f {
    return clamp(light * scene.exposure, vec3f(0.0), vec3f(65000.0));
}

// `field` says that the light is the field's, `position` is the pixel.
fn scene_target(light: vec3f, field: bool, position: vec2f) -> vec4f {
    return vec4f(light, 1.0);
}
