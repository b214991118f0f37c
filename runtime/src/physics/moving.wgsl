// A field that changes: the module's functions read `sf_uniforms`, which is here either what is now or what was before this part of the
// step. The difference of the distances is how far the surface moved.

fn begin() {
    sf_uniforms = field_now;
}

fn distance_before(p: vec3f) -> f32 {
    sf_uniforms = field_before;
    let d = sf_distance(p);
    sf_uniforms = field_now;
    return d;
}

// The speed of the surface along its normal; what jumps does not push.
fn surface_speed(foot: vec3f, r: f32) -> f32 {
    if law.moves != 1u {
        return 0.0;
    }
    let moved = distance_before(foot);
    return select(moved / law.h, 0.0, abs(moved) > 0.5 * r);
}

// Whether a ball that sleeps goes on: nothing near it moves.
fn stays(ball: Ball) -> bool {
    if law.moves != 1u {
        return law.moves != 2u;
    }
    let before = distance_before(ball.p);
    let now = sf_distance(ball.p);
    return min(now, before) > 1.1 * ball.r || abs(now - before) <= 1e-5 * ball.r;
}
