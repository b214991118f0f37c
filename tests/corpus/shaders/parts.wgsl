// A struct with an id, and an array that is read by a number.
struct Part { distance: f32, kind: u32 }

fn nearer(a: Part, b: Part) -> Part {
    if a.distance < b.distance { return a; }
    return b;
}

fn part(p: vec3f, i: i32) -> Part {
    var centers = array<vec3f, 3>(vec3f(0.0), vec3f(1.0, 0.2, 0.0), vec3f(-0.8, 0.1, 0.4));
    let q = p - centers[i];
    return Part(select(length(q) - 0.4, max(abs(q.x), max(abs(q.y), abs(q.z))) - 0.3, (i & 1) == 1), u32(i));
}

fn map(p: vec3f) -> vec2f {
    var all = Part(p.y + 0.5, 9u);
    for (var i = 0; i < 3; i++) {
        all = nearer(all, part(p, i));
    }
    return vec2f(all.distance, f32(all.kind));
}
