// Colour and depth, where the depth of triangles was drawn before: a ray ends at them, and a field that they hide costs nothing.
struct SceneFragment {
    @location(0) color: vec4f,
    @builtin(frag_depth) depth: f32,
}

@group(2) @binding(0) var scene_before: texture_2d<f32>;

@fragment
fn fragment(@builtin(position) position: vec4f) -> SceneFragment {
    let direction = scene_direction(position.xy);
    let ahead = dot(direction, scene.forward);
    let before = textureLoad(scene_before, vec2i(position.xy), 0).x;
    var reach = scene.max_distance;
    if before > 0.0 {
        reach = min(reach, scene_ahead(before) / ahead);
    }
    let pixel = scene_pixel(scene_start(position.xy), direction, scene_begin(position.xy), reach);
    var depth = before;
    if pixel.t >= 0.0 {
        depth = max(before, scene_depth(pixel.t * ahead));
    }
    return SceneFragment(scene_target(pixel.color, pixel.t >= 0.0, position.xy), depth);
}
