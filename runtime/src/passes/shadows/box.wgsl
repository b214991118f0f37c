// The boxes of the lights that are infinitely far, to be read. Stands after base.wgsl.

@group(3) @binding(1) var<storage, read> shadow_boxes: array<u32, 96>;

// Least corner of a light's box, in its axes.
fn shadow_low(light: u32) -> vec3f {
    let i = 6u * light;
    return vec3f(shadow_number(shadow_boxes[i]), shadow_number(shadow_boxes[i + 1u]), shadow_number(shadow_boxes[i + 2u]));
}

// How large it is.
fn shadow_size(light: u32) -> vec3f {
    let i = 6u * light + 3u;
    let high = vec3f(shadow_number(shadow_boxes[i]), shadow_number(shadow_boxes[i + 1u]), shadow_number(shadow_boxes[i + 2u]));
    return max(high - shadow_low(light), vec3f(1e-9));
}
