// Meshes in the picture. Stands after an emitted module, the sections of the scene that shade, and the corners of meshes.

@fragment
fn mesh_fragment(in: MeshSeen) -> @location(0) vec4f {
    let way = scene_way(in.way);
    let t = length(way);
    let direction = way / max(t, 1e-9);
    // The triangle's own side that is seen, whichever way round its file has it.
    let right = dpdx(in.way);
    let below = dpdy(in.way);
    let across = cross(right, below);
    let facet = normalize(select(across, -across, dot(across, direction) > 0.0));
    mesh_place = meshes[in.index];
    mesh_point = in.own;
    mesh_coordinates = in.coordinates;
    mesh_steps = vec4f(dpdx(in.coordinates), dpdy(in.coordinates));
    // The slopes of what changes so over the screen (Mikkelsen, "Bump Mapping Unparametrized Surfaces on the GPU", 2010).
    let first = cross(below, facet);
    let second = cross(facet, right);
    let area = dot(right, first);
    let scaled = select(area, 1e-30, abs(area) < 1e-30);
    mesh_across = (mesh_steps.x * first + mesh_steps.z * second) / scaled;
    mesh_down = (mesh_steps.y * first + mesh_steps.w * second) / scaled;
    let smooth_normal = normalize(in.normal);
    let n = select(smooth_normal, -smooth_normal, dot(smooth_normal, facet) < 0.0);
    // What is drawn for mirrors leaves out what is seen from behind: it may be drawn from the middle of what mirrors.
    if t > scene.max_distance || (SCENE_CAPTURES && dot(smooth_normal, facet) < 0.0) {
        discard;
    }
    // The mean of the places on the planes of the triangle's corners (Boubekeur and Alexa, "Phong Tessellation", 2008), if it is further out: a
    // flat triangle would have its own shadow on it before the shape does (Hanika, "Hacking the Shadow Terminator", 2021).
    let onto = in.lift - vec3f(
        in.squares.x * in.way.x + in.products.x * in.way.y + in.products.z * in.way.z,
        in.products.x * in.way.x + in.squares.y * in.way.y + in.products.y * in.way.z,
        in.products.z * in.way.x + in.products.y * in.way.y + in.squares.z * in.way.z,
    );
    scene_flat = scene.eye + in.way;
    scene_round = scene_flat + max(dot(onto, n), 0.0) * n;
    return scene_target(mesh_color(scene.eye + in.way, n, facet, direction, t), false, in.position.xy);
}
