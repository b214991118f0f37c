// Meshes in a picture that is cut open.

// What a mesh shows at a place. One that is seen from behind past the plane, as the file has its sides, is cut there.
fn mesh_cut(p: vec3f, n: vec3f, facet: vec3f, direction: vec3f, t: f32, behind: bool) -> vec3f {
    let begin = t - scene_section_height(p) / dot(scene_section_normal(), direction);
    if behind & (begin > 0.0) & (begin < t) {
        return scene_cut(vec3f(0.62, 0.62, 0.66), p + (begin - t) * direction, begin);
    }
    return mesh_color(p, n, facet, direction, t);
}
