// The depth of meshes alone, drawn before the field. Stands after the corners of meshes.

@fragment
fn mesh_before(in: MeshSeen) {
    if length(in.way) > scene.max_distance {
        discard;
    }
}
