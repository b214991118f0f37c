// How far the scene is from a point at least. All of it lies in a box.
fn scene_free(p: vec3f) -> f32 {
    let q = p - scene.center;
    let box = length(max(max(sf_region_low - q, q - sf_region_high), vec3f(0.0)));
    return max(sf_bound(p), box);
}
