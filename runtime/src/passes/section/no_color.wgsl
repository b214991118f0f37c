// A view without light shows what is cut in one colour.
fn scene_cut_color(p: vec3f) -> vec3f {
    return vec3f(0.62, 0.62, 0.66);
}
