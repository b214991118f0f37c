// The normals, each component from -1..1 to 0..1.
fn scene_pixel(start: vec3f, direction: vec3f, begin: f32, reach: f32) -> ScenePixel {
    let hit = sf_trace(start, direction, begin, reach, scene.footprint);
    if !hit.hit {
        return ScenePixel(vec3f(0.12), -1.0);
    }
    return ScenePixel(0.5 + 0.5 * scene_normal(start + hit.t * direction, direction), hit.t);
}
