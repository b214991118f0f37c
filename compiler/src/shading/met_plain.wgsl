// Nothing lies on the surface but what its formulas say.

fn scene_met(p: vec3f, n: vec3f, t: f32) -> SceneMet {
    return SceneMet(sf_surface(p, n), n);
}
