// How far the box is from a point that holds all that is solid, but for planes.
fn scene_box(p: vec3f) -> f32 {
    let q = p - scene.center;
    return length(max(max(sf_region_low - q, q - sf_region_high), vec3f(0.0)));
}
