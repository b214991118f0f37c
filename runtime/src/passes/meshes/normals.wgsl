// A mesh's normals, each component from -1..1 to 0..1.
fn mesh_color(p: vec3f, n: vec3f, facet: vec3f, direction: vec3f, t: f32) -> vec3f {
    return 0.5 + 0.5 * n;
}
