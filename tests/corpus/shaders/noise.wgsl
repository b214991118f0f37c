// Value noise in three nested loops.
fn hash(p: vec3f) -> f32 {
    var q = fract(p * 0.1031);
    q += dot(q, q.zyx + 31.32);
    return fract((q.x + q.y) * q.z);
}

fn noise(p: vec3f) -> f32 {
    let i = floor(p);
    var f = fract(p);
    f = f * f * (3.0 - 2.0 * f);
    var sum = 0.0;
    for (var x = 0; x < 2; x++) {
        for (var y = 0; y < 2; y++) {
            for (var z = 0; z < 2; z++) {
                let o = vec3f(f32(x), f32(y), f32(z));
                let w = mix(1.0 - f, f, o);
                sum += w.x * w.y * w.z * hash(i + o);
            }
        }
    }
    return sum;
}

fn map(p: vec3f) -> f32 {
    return (length(p) - 0.9 + 0.15 * noise(5.0 * p)) * 0.7;
}
