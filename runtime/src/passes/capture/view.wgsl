// The scene in its light, seen from a place that may lie in the solid: then what is beyond the solid is seen.

// Where a ray from the eye leaves the solid that the eye is in.
fn scene_outside(direction: vec3f) -> f32 {
    var t = 0.0;
    for (var i = 0; i < 128; i += 1) {
        let p = scene.eye + t * direction;
        let inside = -sf_bound(p);
        if inside <= 0.0 || t > scene.max_distance {
            break;
        }
        // So far beyond the surface that it is not met again.
        t += inside + scene_off(p, t + inside);
    }
    return t;
}

fn scene_pixel(start: vec3f, direction: vec3f, begin: f32, reach: f32) -> ScenePixel {
    let hit = sf_trace(scene.eye, direction, scene_outside(direction), reach, scene.footprint);
    if !hit.hit {
        return ScenePixel(scene_develop(scene_behind(direction)), -1.0);
    }
    let p = scene.eye + hit.t * direction;
    let met = scene_met(p, scene_normal(p, direction), hit.t);
    let light = scene_shade(p, met.normal, direction, hit.t, met.surface);
    return ScenePixel(scene_develop(scene_haze(light, p, direction, hit.t)), hit.t);
}
