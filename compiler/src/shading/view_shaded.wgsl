// The scene in its light.
fn scene_pixel(start: vec3f, direction: vec3f, begin: f32, reach: f32) -> ScenePixel {
    let hit = sf_trace(start, direction, begin, reach, scene.footprint);
    if !hit.hit {
        return ScenePixel(scene_develop(scene_behind(direction)), -1.0);
    }
    let p = start + hit.t * direction;
    let n = scene_normal(p, direction);
    let met = scene_met(p, n, hit.t);
    let light = scene_shade(p, met.normal, direction, hit.t, met.surface);
    return ScenePixel(scene_develop(scene_haze(light, p, direction, hit.t)), hit.t);
}
