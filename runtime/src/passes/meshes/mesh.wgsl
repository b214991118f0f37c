// Meshes in the picture. Stands after an emitted module, the sections of the scene that shade, and the corners of meshes.

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
