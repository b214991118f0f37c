// How steep the field is at the surface: grey where the length of its gradient is 1, red above, blue below; the brightest at four times and a quarter.
fn scene_pixel(start: vec3f, direction: vec3f, begin: f32, reach: f32) -> ScenePixel {
    let hit = sf_trace(start, direction, begin, reach, scene.footprint);
    if !hit.hit {
        return ScenePixel(vec3f(0.12), -1.0);
    }
    let steep = clamp(0.5 * log2(max(length(sf_gradient(start + hit.t * direction).xyz), 1e-6)), -1.0, 1.0);
    let most = select(vec3f(0.15, 0.35, 0.95), vec3f(0.95, 0.2, 0.12), steep > 0.0);
    return ScenePixel(mix(vec3f(0.78), most, abs(steep)), hit.t);
}
