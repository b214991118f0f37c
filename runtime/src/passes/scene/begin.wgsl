// Rays begin at the eye.
fn scene_begin(position: vec2f) -> f32 {
    return 0.0;
}
