// Fog, which thins what comes through it by its density for each unit of the way.

// How much of the light of what is so far away arrives.
fn scene_clear(way: f32) -> f32 {
    return exp(-scene.density * max(way, 0.0));
}
