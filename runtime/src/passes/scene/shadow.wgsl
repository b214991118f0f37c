// How much of a light arrives: 1 all, 0 nothing. `light` is its number, `l` points to it, `off` is how far a ray starts from the surface.
fn scene_lit(light: u32, p: vec3f, n: vec3f, l: vec3f, off: f32, far: f32) -> f32 {
    let softness = scene_softness(light, far);
    // Of a light that throws no shadow the ray ends before it begins.
    return sf_shadow(p + off * n, l, off, select(far, -1.0, softness < 0.0), softness);
}
