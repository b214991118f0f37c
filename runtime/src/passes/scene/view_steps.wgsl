// How many steps a ray takes, 64 and more the brightest.
fn scene_pixel(start: vec3f, direction: vec3f, begin: f32, reach: f32) -> ScenePixel {
    let hit = sf_trace(start, direction, begin, reach, scene.footprint);
    return ScenePixel(scene_ramp(f32(hit.steps) / 64.0), select(-1.0, hit.t, hit.hit));
}
