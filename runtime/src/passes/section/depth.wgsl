// What is cut shows how far the plane is, in the greys of the field.
fn scene_cut(color: vec3f, p: vec3f, t: f32) -> vec3f {
    let share = clamp(t / scene.max_distance, 0.0, 1.0);
    return vec3f(1.0 - log2(1.0 + 63.0 * share) / 6.0);
}
