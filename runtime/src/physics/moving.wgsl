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

// The velocity of the surface; what jumps does not push.
fn surface_velocity(foot: vec3f, n: vec3f, r: f32) -> vec3f {
    if law.moves == STILL || law.moves == ANOTHER {
        return vec3f(0.0);
    }
    let moved = distance_before(foot);
    let way = carried(foot);
    let aside = way - n * dot(way, n);
    let most = select(0.5, 4.0, law.moves == BY_TIME) * r;
    return (select(aside, vec3f(0.0), length(aside) > most) + n * select(moved, 0.0, abs(moved) > most)) / law.h;
}

// Whether a ball that sleeps goes on: nothing near it moves.
fn stays(ball: Ball) -> bool {
    if law.moves == STILL || law.moves == ANOTHER {
        return law.moves == STILL;
    }
    let before = distance_before(ball.p);
    let now = sf_distance(ball.p);
    let still = 1e-5 * ball.r;
    return min(now, before) > 1.1 * ball.r || (abs(now - before) <= still && length(carried(ball.p)) <= still);
}
