// How many operations a ray takes, as the module has counted them: by the logarithm, dark at 64 and the brightest at 2²⁰.
fn scene_pixel(start: vec3f, direction: vec3f, begin: f32, reach: f32) -> ScenePixel {
    sf_counted = 0u;
    let hit = sf_trace(start, direction, begin, reach, scene.footprint);
    return ScenePixel(scene_ramp((log2(max(f32(sf_counted), 64.0)) - 6.0) / 14.0), select(-1.0, hit.t, hit.hit));
}
