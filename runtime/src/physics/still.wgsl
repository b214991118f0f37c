// A field that does not change: nothing pushes.

fn begin() {
}

fn surface_speed(foot: vec3f, r: f32) -> f32 {
    return 0.0;
}

fn stays(ball: Ball) -> bool {
    return law.moves != 2u;
}
