// The air is clear.
fn scene_clear(way: f32) -> f32 {
    return 1.0;
}
