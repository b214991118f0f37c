// How much of the sky's light arrives: white all of it.
fn scene_pixel(start: vec3f, direction: vec3f, begin: f32, reach: f32) -> ScenePixel {
    let hit = sf_trace(start, direction, begin, reach, scene.footprint);
    if !hit.hit {
        return ScenePixel(vec3f(0.12), -1.0);
    }
    let p = start + hit.t * direction;
    return ScenePixel(vec3f(scene_occlusion(p, scene_normal(p, direction))), hit.t);
}
