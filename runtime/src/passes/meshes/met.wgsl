// What a mesh is made of at the place that the fragment shows.
fn mesh_met(n: vec3f, t: f32) -> SceneMet {
    switch mesh_place.material {
        // CASES
        default: { return mesh_plain(n); }
    }
}
