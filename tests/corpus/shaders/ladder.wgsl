// A loop with its step in `continuing`.
fn rung(p: vec3f, y: f32) -> f32 {
    let q = vec3f(p.x, p.y - y, p.z);
    return length(vec2f(max(abs(q.x) - 0.5, 0.0), length(q.yz))) - 0.05;
}

fn map(p: vec3f) -> f32 {
    var best = 1e9;
    var y = -0.9;
    loop {
        if y > 1.0 { break; }
        best = min(best, rung(p, y));
        continuing { y += 0.3; }
    }
    let rail = vec3f(abs(p.x) - 0.5, max(abs(p.y) - 1.2, 0.0), p.z);
    return min(best, length(rail) - 0.07);
}
