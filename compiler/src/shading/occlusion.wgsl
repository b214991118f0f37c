// How much of the sky's light arrives: 1 all, 0 nothing.
fn scene_occlusion(p: vec3f, n: vec3f) -> f32 {
    return sf_occlusion(p, n);
}
