// Folds by absolute values, turned by what is given from outside.
struct Uniforms {
    time: f32,
    bend: f32,
}
@group(0) @binding(0) var<uniform> u: Uniforms;

const TURNS = 5;

fn turn(a: f32) -> mat2x2f {
    return mat2x2f(cos(a), sin(a), -sin(a), cos(a));
}

fn map(point: vec3f) -> f32 {
    var p = point;
    var scale = 1.0;
    for (var i = 0; i < TURNS; i++) {
        p = abs(p) - vec3f(0.5, 0.3, 0.4) / scale;
        let q = turn(0.5 + 0.2 * u.time) * p.xz;
        p = vec3f(q.x, p.y, q.y);
        scale *= 1.4;
    }
    return length(p) - 0.3 / scale;
}
