// What is cut shows the plane's normal, each component from -1..1 to 0..1.
fn scene_cut(color: vec3f, p: vec3f, t: f32) -> vec3f {
    return 0.5 + 0.5 * scene_section_normal();
}
