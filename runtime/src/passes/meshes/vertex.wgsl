// The corners of meshes as the eye sees them. Stands after the base of the scene and the place of a mesh.

struct MeshVertex {
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) coordinates: vec2f,
}

struct MeshSeen {
    @builtin(position) @invariant position: vec4f,
    // From the eye to the surface.
    @location(0) way: vec3f,
    @location(1) normal: vec3f,
    @location(2) coordinates: vec2f,
    @location(3) @interpolate(flat) index: u32,
    // Of the corners' planes: the foot of the eye on each, and the squares and products of their normals.
    @location(4) lift: vec3f,
    @location(5) squares: vec3f,
    @location(6) products: vec3f,
    // In the mesh's own space.
    @location(7) own: vec3f,
}

// Where a point of a mesh is, seen from the eye.
fn mesh_way(place: MeshPlace, q: vec3f) -> vec3f {
    return q.x * place.x + q.y * place.y + q.z * place.z + (place.origin - scene.eye);
}

@vertex
fn mesh_vertex(in: MeshVertex, @builtin(instance_index) index: u32) -> MeshSeen {
    let place = meshes[index];
    let way = mesh_way(place, in.position);
    // Normals stay upright on what is stretched: the axes' cofactors.
    let normal = in.normal.x * cross(place.y, place.z) + in.normal.y * cross(place.z, place.x) + in.normal.z * cross(place.x, place.y);
    let n = normal / max(length(normal), 1e-30);
    return MeshSeen(scene_project(way), way, n, in.coordinates, index, dot(way, n) * n, n * n, n * n.yzx, in.position);
}
