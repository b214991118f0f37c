// What mesh surface MESH is made of begins; layers and relief follow.
fn mesh_met_MESH(n: vec3f, t: f32) -> SceneMet {
    var surface = sf_mesh_MESH(mesh_point, n);
    let layers = sf_mesh_layers_MESH(mesh_point, n);
    var rise = vec3f(0.0);
