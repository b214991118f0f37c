// How far the scene is from a point at least. All of it but planes lies in a box.
fn scene_free(p: vec3f) -> f32 {
    return min(sf_planes(p), max(sf_rest_bound(p), scene_box(p)));
}
