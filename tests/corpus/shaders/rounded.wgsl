// A smooth minimum of a rounded box and a ball.
fn round_box(p: vec3f, b: vec3f, r: f32) -> f32 {
    let q = abs(p) - b + r;
    return length(max(q, vec3f(0.0))) + min(max(q.x, max(q.y, q.z)), 0.0) - r;
}

fn smooth_min(a: f32, b: f32, k: f32) -> f32 {
    let h = max(k - abs(a - b), 0.0) / k;
    return min(a, b) - h * h * k * 0.25;
}

fn map(p: vec3f) -> f32 {
    return smooth_min(round_box(p, vec3f(0.7, 0.4, 0.5), 0.1), length(p - vec3f(0.5, 0.6, 0.0)) - 0.4, 0.3);
}
