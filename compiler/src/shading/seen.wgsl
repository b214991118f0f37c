// How much of a light is seen past the field. Of one whose disc is looked at place by place each picture looks at its own.
fn scene_seen(light: u32, p: vec3f, n: vec3f, l: vec3f, off: f32, far: f32) -> f32 {
    let softness = scene_softness(light, far);
    let across = sf_across(l);
    let place = scene.part.x * across + scene.part.y * cross(l, across);
    let aside = select(vec3f(0.0), place / max(softness, 1e-9), softness > 0.0);
    let end = scene_end(light, l, far, select(off, 1.25 * far / max(softness, 1e-9), (softness > 0.0) & (scene.part.z > 0.0)));
    // Of a light that throws no shadow the ray ends before it begins.
    let reach = select(end * sqrt(1.0 + dot(aside, aside)), -1.0, softness < 0.0);
    return sf_shadow(p + off * n, normalize(l + aside), off, reach, softness * scene.part.z);
}
