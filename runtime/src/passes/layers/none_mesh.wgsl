// What mesh surface MESH is made of, by its formulas alone.
fn mesh_met_MESH(n: vec3f, t: f32) -> SceneMet {
    return SceneMet(sf_mesh_MESH(mesh_point, n), n);
}
