// How far the scene is from a point at least. All of it lies in a box.
fn scene_free(p: vec3f) -> f32 {
    return max(sf_bound(p), scene_box(p));
}
