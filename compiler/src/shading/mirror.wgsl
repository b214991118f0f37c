// The sky is all that surfaces mirror without a ray.

// What a mirror of some roughness sees in a direction, where nothing is known of what stands there.
fn scene_mirror(direction: vec3f, roughness: f32) -> vec3f {
    return scene_sky_mirror(direction, roughness);
}

// The same where it is known that the field does not stand there.
fn scene_beyond(direction: vec3f, roughness: f32) -> vec3f {
    return scene_sky_beyond(direction, roughness);
}
