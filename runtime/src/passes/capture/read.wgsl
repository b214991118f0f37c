// The scene as it was drawn from one place stands for what surfaces mirror without a ray.

// Light; and 1 where it is the field's.
@group(1) @binding(13) var scene_capture: texture_cube<f32>;
@group(1) @binding(14) var scene_capture_sampler: sampler;

fn scene_captured(direction: vec3f, roughness: f32) -> vec4f {
    let last = f32(textureNumLevels(scene_capture) - 1u);
    let level = clamp((roughness - SCENE_POLISHED) / (1.0 - SCENE_POLISHED), 0.0, 1.0) * last;
    return textureSampleLevel(scene_capture, scene_capture_sampler, direction, level);
}

// What a mirror of some roughness sees in a direction, where nothing is known of what stands there.
fn scene_mirror(direction: vec3f, roughness: f32) -> vec3f {
    return scene_captured(direction, roughness).rgb;
}

// The same where it is known that the field does not stand there: meshes, balls, the sky.
fn scene_beyond(direction: vec3f, roughness: f32) -> vec3f {
    let seen = scene_captured(direction, roughness);
    return mix(seen.rgb, scene_sky_beyond(direction, roughness), seen.a);
}
