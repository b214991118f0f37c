// A mesh in the scene's light, with the field's shadows and corners.
fn mesh_color(p: vec3f, n: vec3f, facet: vec3f, direction: vec3f, t: f32, place: MeshPlace) -> vec3f {
    let surface = sf_Surface(place.color, place.emission, place.roughness, place.metallic, place.reflectivity);
    return scene_develop(scene_haze(scene_shade(p, n, direction, t, surface), p, direction, t));
}
