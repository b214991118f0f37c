// Where a shadow's ray ends: at the lamp, or so far before the solid in which it stands if that emits light: it throws no shadow of its own.
fn scene_end(light: u32, l: vec3f, far: f32, before: f32) -> f32 {
    let lamp = scene.lights[light];
    var out = 0.0;
    if lamp.position > 0u {
        for (var look = 0u; look < 64u; look++) {
            let inside = -sf_bound(lamp.vector - out * l);
            if inside <= 1e-4 * out {
                break;
            }
            out += inside;
        }
    }
    if out <= 0.0 {
        return far;
    }
    let emission = sf_surface(lamp.vector, l).emission;
    return select(far, far - out - before, max(emission.x, max(emission.y, emission.z)) > 0.0);
}
