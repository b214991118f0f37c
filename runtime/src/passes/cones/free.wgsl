// How far the scene is from a point at least.
fn scene_free(p: vec3f) -> f32 {
    return sf_bound(p);
}
