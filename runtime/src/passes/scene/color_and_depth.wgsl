// Colour, and the depth that rasterised triangles compare with: 1 at the near plane, 0 at infinity.
struct SceneFragment {
    @location(0) color: vec4f,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> SceneFragment {
    let direction = scene_direction(position.xy);
    let pixel = scene_pixel(scene_start(position.xy), direction, scene_begin(position.xy), scene.max_distance);
    var depth = 0.0;
    if pixel.t >= 0.0 {
        depth = scene_depth(pixel.t * dot(direction, scene.forward));
    }
    return SceneFragment(scene_target(pixel.color, pixel.t >= 0.0, position.xy), depth);
}
