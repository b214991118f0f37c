// What a mesh is made of whose material is the same everywhere.
fn mesh_plain(n: vec3f) -> SceneMet {
    let place = mesh_place;
    return SceneMet(sf_Surface(place.color, place.emission, place.roughness, place.metallic, place.reflectivity), n);
}
