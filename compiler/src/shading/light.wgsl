// Light: the scene's lights by a microfacet model, the sky's by its gradient or its images.

// The roughness of what counts as a mirror: the sharpest level of blurred images belongs to it.
const SCENE_POLISHED: f32 = 0.06;

// A surface's answer to light.
struct SceneAnswer {
    // The share that is scattered, by colour.
    diffuse: vec3f,
    // The share that is mirrored head-on, by colour.
    mirrored: vec3f,
    roughness: f32,
}

fn scene_answer(surface: sf_Surface) -> SceneAnswer {
    let metallic = clamp(surface.metallic, 0.0, 1.0);
    let reflectivity = clamp(surface.reflectivity, 0.0, 1.0);
    let color = clamp(surface.color, vec3f(0.0), vec3f(1.0));
    let mirrored = max(mix(vec3f(0.04), color, metallic), reflectivity * mix(vec3f(1.0), color, metallic));
    let roughness = clamp(surface.roughness * (1.0 - 0.6 * reflectivity), 0.06, 1.0);
    return SceneAnswer(color * (1.0 - metallic) * (1.0 - 0.9 * reflectivity), mirrored, roughness);
}

// Cook and Torrance's model with the distribution GGX and Smith's shadowing in the form that correlates both sides (Walter et al. 2007;
// Heitz 2014) and Schlick's Fresnel term (1994); the square of roughness is the width (Burley 2012). Times the cosine; `l` points to
// the light, `v` to the eye.
fn scene_reflect(answer: SceneAnswer, n: vec3f, v: vec3f, l: vec3f) -> vec3f {
    let nl = max(dot(n, l), 0.0);
    let nv = max(dot(n, v), 1e-3);
    let sum = l + v;
    let h = sum / max(length(sum), 1e-6);
    let nh = max(dot(n, h), 0.0);
    let vh = clamp(dot(v, h), 0.0, 1.0);
    let width = answer.roughness * answer.roughness;
    let squared = width * width;
    // 1 - nh², without its cancellation.
    let across = cross(n, h);
    let below = nh * nh * squared + dot(across, across);
    let distribution = squared / (SCENE_PI * below * below);
    let smith = nl * sqrt(nv * nv * (1.0 - squared) + squared) + nv * sqrt(nl * nl * (1.0 - squared) + squared);
    let visible = 0.5 / max(smith, 1e-6);
    let fresnel = answer.mirrored + (1.0 - answer.mirrored) * pow(max(1.0 - vh, 1e-6), 5.0);
    return (fresnel * (distribution * visible) + (1.0 - fresnel) * answer.diffuse / SCENE_PI) * nl;
}

// How much of the surroundings is mirrored, by angle and roughness: Karis, "Physically Based Shading on Mobile" (2014).
fn scene_mirror_share(mirrored: vec3f, roughness: f32, nv: f32) -> vec3f {
    let r = roughness * vec4f(-1.0, -0.0275, -0.572, 0.022) + vec4f(1.0, 0.0425, 1.04, -0.04);
    let a = min(r.x * r.x, exp2(-9.28 * nv)) * r.x + r.y;
    return mirrored * (r.z - 1.04 * a) + (1.04 * a + r.w);
}

// What leaves a surface toward the eye, but for what it mirrors of its surroundings.
struct SceneLocal {
    light: vec3f,
    // The share of its surroundings that it mirrors.
    share: vec3f,
    // How much of the sky's light arrives.
    occlusion: f32,
}

// `direction` goes from the eye to the surface at `p`, `t` is how far that is.
fn scene_local(p: vec3f, n: vec3f, direction: vec3f, t: f32, answer: SceneAnswer, emission: vec3f) -> SceneLocal {
    let v = -direction;
    let nv = clamp(dot(n, v), 1e-3, 1.0);
    let off = scene_off(p, t);
    let occlusion = scene_occlusion(p, n);
    let share = scene_mirror_share(answer.mirrored, answer.roughness, nv);
    var light = emission + occlusion * (1.0 - share) * answer.diffuse * scene_matte(n);
    for (var i = 0u; i < scene_lights; i += 1u) {
        let lamp = scene.lights[i];
        // Of a lamp its place is known, of a sun the direction alone.
        let placed = lamp.position > 0u;
        let way = select(lamp.vector, lamp.vector - p, placed);
        let apart = max(length(way), 1e-9);
        let l = select(way, way / apart, placed);
        if dot(n, l) > 0.0 {
            let lit = scene_lit(i, p, n, l, off, select(4.0 * scene.extent, apart, placed));
            light += lit * lamp.radiance / select(1.0, apart * apart, placed) * scene_reflect(answer, n, v, l);
        }
    }
    return SceneLocal(light, share, occlusion);
}

// How soft a light's shadow is where it is so far away: `softness` of `SceneLight`.
fn scene_softness(light: u32, far: f32) -> f32 {
    let lamp = scene.lights[light];
    return lamp.softness * select(1.0, far, lamp.position == 2u);
}

// How far off a surface rays start that leave it: half a pixel, or what rounding takes.
fn scene_off(p: vec3f, t: f32) -> f32 {
    return max(0.5 * scene.footprint * t, 12e-6 * (length(p - scene.rounding * scene.center) + scene.unit));
}

// How much of a surface is lost in the air: near the ends of the scene it goes over into the sky, so that an endless plane has no rim.
fn scene_lost(p: vec3f, t: f32) -> f32 {
    let far = scene_smooth(0.5, 1.0, t / scene.max_distance);
    let out = scene_smooth(0.85, 1.0, length(p - scene.center) / scene.extent);
    return max(far, out);
}

// Light from so far away as it arrives through the fog.
fn scene_fogged(light: vec3f, way: f32) -> vec3f {
    return mix(scene.fog, light, scene_clear(way));
}

// The sky as it is seen where nothing else is.
fn scene_behind(direction: vec3f) -> vec3f {
    return scene_fogged(scene_sky(direction), scene.max_distance);
}

// The light of a surface as the eye sees it through the air.
fn scene_haze(light: vec3f, p: vec3f, direction: vec3f, t: f32) -> vec3f {
    return scene_fogged(mix(light, scene_sky(direction), scene_lost(p, t)), t);
}
