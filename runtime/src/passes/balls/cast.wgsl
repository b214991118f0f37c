// The shadows of balls: a map of their depths seen from a light that is infinitely far. Its frame is the box that holds all balls, along the
// light's own axes.

struct BallLight {
    // The axes of the map, in the scene's space; `along` is how the light travels.
    across: vec3f,
    // 0: there is no shadow to look up.
    balls: u32,
    above: vec3f,
    padding_a: f32,
    along: vec3f,
    padding_b: f32,
}

@group(3) @binding(0) var<uniform> ball_light: BallLight;

// Whole numbers in the order of the numbers that they stand for.
fn ball_order(x: f32) -> u32 {
    let bits = bitcast<u32>(x);
    return select(bits | 0x80000000u, ~bits, (bits & 0x80000000u) != 0u);
}

fn ball_number(order: u32) -> f32 {
    return bitcast<f32>(select(~order, order & 0x7fffffffu, (order & 0x80000000u) != 0u));
}

// A place in the light's axes.
fn ball_axes(p: vec3f) -> vec3f {
    return vec3f(dot(p, ball_light.across), dot(p, ball_light.above), dot(p, ball_light.along));
}
