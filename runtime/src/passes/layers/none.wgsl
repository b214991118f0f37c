// Nothing lies on the surface but what its formulas say.

// How a place answers light, and which way it seems to face.
struct SceneMet {
    surface: sf_Surface,
    normal: vec3f,
}

fn scene_met(p: vec3f, n: vec3f, t: f32) -> SceneMet {
    return SceneMet(sf_surface(p, n), n);
}
