// What is cut is flat and striped.
fn scene_cut(color: vec3f, p: vec3f, t: f32) -> vec3f {
    return color * scene_stripes(p);
}
