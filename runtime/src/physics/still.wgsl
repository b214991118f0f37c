// A field that does not change: nothing pushes.

fn begin() {
}

fn surface_velocity(foot: vec3f, n: vec3f, r: f32) -> vec3f {
    return vec3f(0.0);
}

fn stays(ball: Ball) -> bool {
    return law.moves != ANOTHER;
}
