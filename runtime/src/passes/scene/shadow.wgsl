// How much of a light arrives: 1 all, 0 nothing.
fn scene_lit(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32, softness: f32) -> f32 {
    if softness < 0.0 {
        return 1.0;
    }
    return sf_shadow(origin, direction, t_min, t_max, softness);
}
