// Glass: rays go on inside of it. What else surfaces mirror is followed as in reflections.wgsl. The twin is compiler/src/reference/glass.rs.

// How much of what a surface mirrors is followed: all of a polished one's, nothing of a rough one's or where too little arrives to be seen.
fn scene_followed(roughness: f32, share: vec3f) -> f32 {
    return (1.0 - scene_smooth(0.25, 0.5, roughness)) * scene_smooth(0.01, 0.03, max(share.x, max(share.y, share.z)));
}

// What a surface between two clear bodies mirrors: Fresnel's equations for light without polarisation. `index` is that of the body beyond over
// that of the one before.
fn scene_fresnel(cosine: f32, index: f32) -> f32 {
    let c = clamp(cosine, 0.0, 1.0);
    let squared = 1.0 - (1.0 - c * c) / (index * index);
    let beyond = sqrt(max(squared, 0.0));
    let across = (c - index * beyond) / (c + index * beyond);
    let along = (index * c - beyond) / (index * c + beyond);
    return select(0.5 * (across * across + along * along), 1.0, squared <= 0.0);
}

// How far it is from a place in the solid to where a ray leaves it; below 0: too far. `way` is how far the place is from the eye.
fn scene_inside(origin: vec3f, direction: vec3f, way: f32) -> f32 {
    var t = 0.0;
    var out = false;
    for (var step = 0; (step < 192) & (t <= 2.0 * scene.extent) & !out; step += 1) {
        let p = origin + t * direction;
        let near = 0.25 * scene_off(p, way + t);
        let free = -sf_bound(p);
        let met = free <= near;
        if met {
            out = dot(scene_normal(p, -direction), direction) > 0.0;
        }
        // Where it meets the surface and goes on, it has only come in.
        t += select(select(free, 2.0 * near, met), 0.0, out);
    }
    return select(t, -1.0, t > 2.0 * scene.extent);
}

// A ray that has come through glass, or that has gone as often from surface to surface as it may.
struct SceneThrough {
    // Where it begins, beyond the surface.
    at: vec3f,
    direction: vec3f,
    // How far it has come from the eye.
    way: f32,
    weight: f32,
    // How many surfaces it has met inside.
    met: u32,
    // Whether it is outside of the glass. Inside with a weight of 0 it is lost.
    out: bool,
}

// What comes of a ray that goes into glass with this index. At most so many surfaces are met inside.
fn scene_through(p: vec3f, n: vec3f, toward: vec3f, way: f32, index: f32, most: u32) -> SceneThrough {
    let off = scene_off(p, way);
    var ray = SceneThrough(p - off * n, refract(toward, n, 1.0 / index), way, 1.0, 0u, false);
    for (var i = 0u; i < scene_bounces; i += 1u) {
        if i >= most {
            break;
        }
        ray.met = i + 1u;
        let t = scene_inside(ray.at, ray.direction, ray.way);
        if t < 0.0 {
            ray.weight = 0.0;
            break;
        }
        let place = ray.at + t * ray.direction;
        ray.way += t;
        let outward = scene_normal(place, -ray.direction);
        let mirrored = scene_fresnel(dot(ray.direction, outward), 1.0 / index);
        let aside = scene_off(place, ray.way);
        if mirrored < 1.0 {
            ray.direction = refract(ray.direction, -outward, index);
            ray.at = place + aside * outward;
            ray.weight = 1.0 - mirrored;
            ray.out = true;
            break;
        }
        ray.direction = reflect(ray.direction, outward);
        ray.at = place - aside * outward;
    }
    return ray;
}

// How much of a light arrives, with what comes straight through one body of glass.
fn scene_lit_through(light: u32, p: vec3f, n: vec3f, l: vec3f, off: f32, far: f32) -> f32 {
    var lit = scene_lit(light, p, n, l, off, far);
    if lit < 1.0 {
        let hit = sf_trace(p + off * n, l, off, far, scene.footprint);
        let at = p + off * n + hit.t * l;
        var normal = -l;
        var glass = vec2f(0.0, 1.0);
        if hit.hit {
            normal = scene_normal(at, l);
            glass = scene_glass(at, normal);
        }
        if glass.x > 0.0 {
            let inner = at - scene_off(at, hit.t) * normal;
            let t = scene_inside(inner, l, hit.t);
            let place = inner + t * l;
            let outward = scene_normal(place, -l);
            let color = clamp(sf_surface(at, normal).color, vec3f(0.0), vec3f(1.0));
            let passed = 1.0 - scene_fresnel(-dot(l, normal), glass.y);
            // A ray of no length is free: what never leaves the glass lets nothing through.
            let rest = scene_lit(light, place, outward, l, scene_off(place, hit.t + t), select(far - hit.t - t, -1.0, t < 0.0));
            lit += select((1.0 - lit) * glass.x * passed * passed * dot(color, vec3f(1.0 / 3.0)) * rest, 0.0, t < 0.0);
        }
    }
    return lit;
}

// How much goes through a surface, 0 to 1, and the index of refraction of what is under it, at least 1.
fn scene_glass(p: vec3f, n: vec3f) -> vec2f {
    let glass = sf_glass(p, n);
    return vec2f(clamp(glass.x, 0.0, 1.0), max(glass.y, 1.0));
}

// The light that leaves a surface at `p` toward the eye. `direction` goes from the eye to it, `t` is how far that is.
fn scene_shade(p: vec3f, n: vec3f, direction: vec3f, t: f32, surface: sf_Surface) -> vec3f {
    var at = p;
    var normal = n;
    var toward = direction;
    var way = t;
    var answer = scene_answer(surface);
    var emission = surface.emission;
    var color = surface.color;
    var light = vec3f(0.0);
    var weight = vec3f(1.0);
    var used = 0u;
    for (var bounce = 0u; bounce <= scene_bounces; bounce += 1u) {
        let glass = scene_glass(at, normal);
        answer.diffuse *= 1.0 - glass.x;
        let here = scene_local(at, normal, toward, way, answer, emission);
        let mirror = reflect(toward, normal);
        let fresnel = scene_fresnel(-dot(toward, normal), glass.y);
        let share = weight * mix(here.share, vec3f(fresnel), glass.x);
        let more = used < scene.reflections;
        let clear = glass.x > 0.0;
        let followed = select(0.0, scene_followed(answer.roughness, share), more & !clear);
        light += weight * here.light;
        if followed < 1.0 {
            let mirrored = scene_fogged(scene_mirror(mirror, answer.roughness), scene.max_distance - way);
            light += (1.0 - followed) * here.occlusion * share * mirrored;
        }
        let off = scene_off(at, way);
        var origin = at + off * normal;
        var next = mirror;
        var began = way + off;
        if clear {
            weight *= glass.x * (1.0 - fresnel) * clamp(color, vec3f(0.0), vec3f(1.0));
            let ray = scene_through(at, normal, toward, way, glass.y, select(0u, scene.reflections - used, more));
            weight *= ray.weight * select(vec3f(1.0), clamp(color, vec3f(0.0), vec3f(1.0)), ray.out);
            used += 1u + ray.met;
            if !ray.out {
                light += weight * scene_fogged(scene_mirror(ray.direction, answer.roughness), scene.max_distance - ray.way);
                break;
            }
            origin = ray.at;
            next = ray.direction;
            way = ray.way;
            began = way;
        } else {
            if followed <= 0.0 {
                break;
            }
            weight = followed * share;
            used += 1u;
        }
        // As if the ray came straight from the eye: pixels grow with the whole way.
        origin -= way * next;
        let hit = sf_trace(origin, next, began, scene.max_distance, scene.footprint);
        if !hit.hit {
            light += weight * scene_fogged(scene_beyond(next, answer.roughness), scene.max_distance - way);
            break;
        }
        // The fog on the way from one surface to the next.
        let air = scene_clear(hit.t - way);
        light += weight * (1.0 - air) * scene.fog;
        weight *= air;
        at = origin + hit.t * next;
        toward = next;
        way = hit.t;
        let met = scene_met(at, scene_normal(at, toward), way);
        normal = met.normal;
        answer = scene_answer(met.surface);
        emission = met.surface.emission;
        color = met.surface.color;
        let lost = scene_lost(at, way);
        light += weight * lost * scene_sky(toward);
        weight *= 1.0 - lost;
    }
    return light;
}
