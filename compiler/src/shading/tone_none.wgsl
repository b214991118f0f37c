// No curve: what is brighter than a screen's white is white.
fn scene_film(linear: vec3f) -> vec3f {
    return clamp(linear, vec3f(0.0), vec3f(1.0));
}
