// What the pass over the screen calls, for a sphere.
struct sf_Hit {
    hit: bool,
    t: f32,
    steps: u32,
}
struct sf_Surface {
    color: vec3f,
    emission: vec3f,
    roughness: f32,
    metallic: f32,
    reflectivity: f32,
}
fn sf_gradient(p: vec3f) -> vec4f {
    return vec4f(normalize(p), length(p) - 1.0);
}
fn sf_trace(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32, footprint: f32) -> sf_Hit {
    return sf_Hit(true, 1.0, 1u);
}
fn sf_shadow(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32, softness: f32) -> f32 {
    return 1.0;
}
fn sf_occlusion(p: vec3f, normal: vec3f) -> f32 {
    return 1.0;
}
fn sf_surface(p: vec3f, normal: vec3f) -> sf_Surface {
    return sf_Surface(vec3f(0.5), vec3f(0.0), 0.5, 0.0, 0.0);
}
fn sf_bound(p: vec3f) -> f32 {
    return length(p) - 1.0;
}
fn sf_across(n: vec3f) -> vec3f {
    return normalize(n.yzx);
}
