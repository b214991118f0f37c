// Surfaces mirror the field: rays are followed on, and what leaves the field finds the sky.

// How much of what a surface mirrors is followed: all of a polished one's, nothing of a rough one's or where too little arrives to be seen.
fn scene_followed(roughness: f32, share: vec3f) -> f32 {
    return (1.0 - scene_smooth(0.25, 0.5, roughness)) * scene_smooth(0.01, 0.03, max(share.x, max(share.y, share.z)));
}

// The light that leaves a surface at `p` toward the eye. `direction` goes from the eye to it, `t` is how far that is.
fn scene_shade(p: vec3f, n: vec3f, direction: vec3f, t: f32, surface: sf_Surface) -> vec3f {
    var at = p;
    var normal = n;
    var toward = direction;
    var way = t;
    var answer = scene_answer(surface);
    var emission = surface.emission;
    var light = vec3f(0.0);
    var weight = vec3f(1.0);
    for (var bounce = 0u; bounce <= scene_bounces; bounce += 1u) {
        let here = scene_local(at, normal, toward, way, answer, emission);
        let mirror = reflect(toward, normal);
        let share = weight * here.share;
        let followed = select(0.0, scene_followed(answer.roughness, share), bounce < scene.reflections);
        light += weight * here.light;
        if followed < 1.0 {
            let mirrored = scene_fogged(scene_mirror(mirror, answer.roughness), scene.max_distance - way);
            light += (1.0 - followed) * here.occlusion * share * mirrored;
        }
        if followed <= 0.0 {
            break;
        }
        weight = followed * share;
        let off = scene_off(at, way);
        // As if the ray came straight from the eye: pixels grow with the whole way.
        let origin = at + off * normal - way * mirror;
        let hit = sf_trace(origin, mirror, way + off, scene.max_distance, scene.footprint);
        if !hit.hit {
            light += weight * scene_fogged(scene_beyond(mirror, answer.roughness), scene.max_distance - way);
            break;
        }
        // The fog on the way from one surface to the next.
        let clear = scene_clear(hit.t - way);
        light += weight * (1.0 - clear) * scene.fog;
        weight *= clear;
        at = origin + hit.t * mirror;
        toward = mirror;
        way = hit.t;
        let met = scene_met(at, scene_normal(at, toward), way);
        normal = met.normal;
        answer = scene_answer(met.surface);
        emission = met.surface.emission;
        let lost = scene_lost(at, way);
        light += weight * lost * scene_sky(toward);
        weight *= 1.0 - lost;
    }
    return light;
}
