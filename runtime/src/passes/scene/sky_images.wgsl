// The sky from images. Its twin is compiler/src/images/cube.rs.

struct SceneHarmonics {
    // What a matte surface sees, by 1, y, z, x, xy, yz, 3z² - 1, xz, x² - y² of its normal.
    matte: array<vec4f, 9>,
    // Number of the most blurred level.
    last: f32,
    padding_a: f32,
    padding_b: vec2f,
}

@group(1) @binding(1) var scene_cube: texture_cube<f32>;
@group(1) @binding(2) var scene_cube_sampler: sampler;
@group(1) @binding(3) var<uniform> scene_harmonics: SceneHarmonics;

// The sky's radiance.
fn scene_sky(direction: vec3f) -> vec3f {
    return textureSampleLevel(scene_cube, scene_cube_sampler, direction, 0.0).rgb;
}

// What a matte surface sees of it.
fn scene_matte(n: vec3f) -> vec3f {
    var sum = scene_harmonics.matte[0] + scene_harmonics.matte[1] * n.y + scene_harmonics.matte[2] * n.z + scene_harmonics.matte[3] * n.x;
    sum += scene_harmonics.matte[4] * (n.x * n.y) + scene_harmonics.matte[5] * (n.y * n.z);
    sum += scene_harmonics.matte[6] * (3.0 * n.z * n.z - 1.0) + scene_harmonics.matte[7] * (n.x * n.z);
    sum += scene_harmonics.matte[8] * (n.x * n.x - n.y * n.y);
    return max(sum.rgb, vec3f(0.0));
}

// What a mirror of some roughness sees in a direction.
fn scene_sky_mirror(direction: vec3f, roughness: f32) -> vec3f {
    let level = clamp((roughness - SCENE_POLISHED) / (1.0 - SCENE_POLISHED), 0.0, 1.0) * scene_harmonics.last;
    return textureSampleLevel(scene_cube, scene_cube_sampler, direction, level).rgb;
}

// The same where it is known that nothing stands there.
fn scene_sky_beyond(direction: vec3f, roughness: f32) -> vec3f {
    return scene_sky_mirror(direction, roughness);
}
