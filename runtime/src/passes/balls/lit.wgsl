// How much of a light arrives past the field and past the balls: 1 all, 0 nothing. Stands after cast.wgsl.

@group(3) @binding(1) var<storage, read> ball_bounds: array<u32, 6>;
@group(3) @binding(2) var ball_map: texture_depth_2d;

// The share of nine places of the map around one of which it is not behind a ball.
fn ball_lit(origin: vec3f, direction: vec3f) -> f32 {
    // Only one light has a map.
    if ball_light.balls == 0u || dot(direction, ball_light.along) > -0.99999 {
        return 1.0;
    }
    let low = vec3f(ball_number(ball_bounds[0]), ball_number(ball_bounds[1]), ball_number(ball_bounds[2]));
    let high = vec3f(ball_number(ball_bounds[3]), ball_number(ball_bounds[4]), ball_number(ball_bounds[5]));
    let size = max(high - low, vec3f(1e-9));
    let at = (ball_axes(origin - scene.center) - low) / size;
    if any(at.xy < vec2f(0.0)) || any(at.xy > vec2f(1.0)) || at.z < 0.0 {
        return 1.0;
    }
    let pixels = vec2f(textureDimensions(ball_map));
    let place = vec2f(at.x, 1.0 - at.y) * pixels - 0.5;
    // What the width of two of its pixels hides.
    let slack = 2.0 * max(size.x / pixels.x, size.y / pixels.y) / size.z;
    let first = floor(place);
    let part = place - first;
    var lit = 0.0;
    for (var y = -1; y <= 2; y++) {
        for (var x = -1; x <= 2; x++) {
            let cell = clamp(vec2i(first) + vec2i(x, y), vec2i(0), vec2i(pixels) - 1);
            let depth = textureLoad(ball_map, cell, 0);
            // Where no ball is the map has its far end, beyond which the field may go on.
            let free = select(0.0, 1.0, at.z - slack <= depth || depth >= 1.0);
            // A box of three pixels about the place itself.
            let across = select(select(1.0, part.x, x == 2), 1.0 - part.x, x == -1);
            let above = select(select(1.0, part.y, y == 2), 1.0 - part.y, y == -1);
            lit += free * across * above;
        }
    }
    return lit / 9.0;
}

fn scene_lit(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32, softness: f32) -> f32 {
    if softness < 0.0 {
        return 1.0;
    }
    let lit = ball_lit(origin, direction);
    if lit <= 0.0 {
        return 0.0;
    }
    return lit * sf_shadow(origin, direction, t_min, t_max, softness);
}
