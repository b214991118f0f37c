// How far the surface is: white at the eye, falling with the logarithm, black at the far end and where there is nothing.
fn scene_pixel(start: vec3f, direction: vec3f, begin: f32, reach: f32) -> ScenePixel {
    let hit = sf_trace(start, direction, begin, reach, scene.footprint);
    if !hit.hit {
        return ScenePixel(vec3f(0.0), -1.0);
    }
    let share = clamp(hit.t / scene.max_distance, 0.0, 1.0);
    return ScenePixel(vec3f(1.0 - log2(1.0 + 63.0 * share) / 6.0), hit.t);
}
