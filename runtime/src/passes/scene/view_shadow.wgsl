// How much of the lights arrives that shine on the front of the surface: white all of it, black nothing; blue-grey where none of them shines on it.
fn scene_pixel(start: vec3f, direction: vec3f, begin: f32, reach: f32) -> ScenePixel {
    let hit = sf_trace(start, direction, begin, reach, scene.footprint);
    if !hit.hit {
        return ScenePixel(vec3f(0.12), -1.0);
    }
    let p = start + hit.t * direction;
    let n = scene_normal(p, direction);
    let off = scene_off(p, hit.t);
    var lit = 0.0;
    var count = 0.0;
    for (var i = 0u; i < scene_lights; i += 1u) {
        let lamp = scene.lights[i];
        let placed = lamp.position > 0u;
        let way = select(lamp.vector, lamp.vector - p, placed);
        let apart = max(length(way), 1e-9);
        let l = select(way, way / apart, placed);
        if dot(n, l) > 0.0 {
            lit += scene_lit(i, p, n, l, off, select(4.0 * scene.extent, apart, placed));
            count += 1.0;
        }
    }
    return ScenePixel(select(vec3f(0.16, 0.2, 0.3), vec3f(lit / max(count, 1.0)), count > 0.0), hit.t);
}
