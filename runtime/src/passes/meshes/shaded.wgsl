// A mesh in the scene's light, with the field's shadows and corners.
fn mesh_color(p: vec3f, n: vec3f, facet: vec3f, direction: vec3f, t: f32) -> vec3f {
    let met = mesh_met(n, t);
    return scene_develop(scene_haze(scene_shade(p, met.normal, direction, t, met.surface), p, direction, t));
}
