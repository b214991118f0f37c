// How far what is solid at a point went in this part of the step, where it moves as a whole: the shortest way along which the coordinates in
// the space of the part grow by as much as they were more.
fn carried(p: vec3f) -> vec3f {
    let now = sf_carry(p);
    sf_uniforms = field_before;
    let growth = sf_carry(p).point - now.point;
    sf_uniforms = field_now;
    let trace = dot(now.x, now.x) + dot(now.y, now.y) + dot(now.z, now.z);
    let a = now.x * now.x.x + now.y * now.y.x + now.z * now.z.x + vec3f(1e-6 * trace + 1e-30, 0.0, 0.0);
    let b = now.x * now.x.y + now.y * now.y.y + now.z * now.z.y + vec3f(0.0, 1e-6 * trace + 1e-30, 0.0);
    let c = now.x * now.x.z + now.y * now.y.z + now.z * now.z.z + vec3f(0.0, 0.0, 1e-6 * trace + 1e-30);
    let right = now.x * growth.x + now.y * growth.y + now.z * growth.z;
    let whole = dot(a, cross(b, c));
    // Coordinates that hardly grow anywhere say nothing.
    if whole < 1e-30 {
        return vec3f(0.0);
    }
    return vec3f(dot(cross(b, c), right), dot(cross(c, a), right), dot(cross(a, b), right)) / whole;
}
