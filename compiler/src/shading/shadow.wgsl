// How much of a light arrives: 1 all, 0 nothing. `light` is its number, `l` points to it, `off` is how far a ray starts from the surface.
fn scene_lit(light: u32, p: vec3f, n: vec3f, l: vec3f, off: f32, far: f32) -> f32 {
    return scene_seen(light, p, n, l, off, far);
}
