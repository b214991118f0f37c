// Meshes in a map. Stands after cast.wgsl and the place of a mesh.

struct MapVertex {
    @builtin(position) position: vec4f,
    // From the light's centre to the surface.
    @location(0) way: vec3f,
}

@vertex
fn map_vertex(@location(0) position: vec3f, @builtin(instance_index) index: u32) -> MapVertex {
    let place = meshes[index];
    let way = position.x * place.x + position.y * place.y + position.z * place.z + (place.origin - shadow_lights[shadow_view.light].center);
    return MapVertex(shadow_project(way), way);
}

@fragment
fn map_fragment(in: MapVertex) -> @builtin(frag_depth) f32 {
    return shadow_depth(in.way);
}
