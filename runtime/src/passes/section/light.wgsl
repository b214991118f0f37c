// What is cut is seen in flat light of its own, in the colour of what it is made of.
fn scene_cut(color: vec3f, p: vec3f, t: f32) -> vec3f {
    return scene_develop((0.25 + 0.5 * color) * scene_stripes(p) / max(scene.exposure, 1e-9));
}
