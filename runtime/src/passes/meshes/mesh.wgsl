// Meshes in the picture. Stands after an emitted module, the sections of the scene that shade, and the place of a mesh.

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
    return MeshSeen(scene_project(way), way, normal, in.coordinates, index);
}

@fragment
fn mesh_fragment(in: MeshSeen) -> @location(0) vec4f {
    let t = length(in.way);
    let direction = in.way / max(t, 1e-9);
    // The triangle's own side that is seen, whichever way round its file has it.
    let across = cross(dpdx(in.way), dpdy(in.way));
    let facet = normalize(select(across, -across, dot(across, direction) > 0.0));
    let smooth_normal = normalize(in.normal);
    let n = select(smooth_normal, -smooth_normal, dot(smooth_normal, facet) < 0.0);
    if t > scene.max_distance {
        discard;
    }
    return scene_target(mesh_color(scene.eye + in.way, n, facet, direction, t, meshes[in.index]));
}
