// The sky as two colours over a dark ground.

// The share of the sky's light that a matte surface gets: less than all of it, so that lights model the shapes.
const SCENE_FILL: f32 = 0.48;

// How much of the way from horizon to zenith the sky has gone at a height -1..1: flat at the horizon, so that it is soft.
fn scene_height(y: f32) -> f32 {
    let s = max(y, 0.0);
    return 1.2 * s * s / (s * s + 0.2);
}

// The sky's radiance.
fn scene_sky(direction: vec3f) -> vec3f {
    return mix(scene.horizon, scene.zenith, scene_height(direction.y));
}

// The mean of sky and ground over the half of all directions about one, weighted toward it.
fn scene_around(direction: vec3f) -> vec3f {
    let above = scene_smooth(-0.8, 0.8, direction.y);
    let sky = mix(scene.horizon, scene.zenith, 0.25 + 0.5 * above);
    return mix(scene.ground, sky, above);
}

// What a matte surface sees of it.
fn scene_matte(n: vec3f) -> vec3f {
    return SCENE_FILL * scene_around(n);
}

// What a mirror of some roughness sees in a direction, where nothing is known of what stands there.
fn scene_sky_mirror(direction: vec3f, roughness: f32) -> vec3f {
    let width = 0.1 + 0.7 * roughness;
    let above = scene_smooth(-width, 0.6 * width, direction.y);
    let sharp = mix(scene.ground, scene_sky(direction), above);
    return mix(sharp, scene_around(direction), roughness);
}

// The same where it is known that nothing stands there.
fn scene_sky_beyond(direction: vec3f, roughness: f32) -> vec3f {
    return scene_sky(direction);
}
