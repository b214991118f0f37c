// The function begins; layers and relief follow.
fn scene_met(p: vec3f, n: vec3f, t: f32) -> SceneMet {
    var surface = sf_surface(p, n);
    let layers = sf_layers(p, n);
    var rise = vec3f(0.0);
