// What lies on meshes: by the coordinates that their files say, else from three sides.

// Slopes in a mesh's own space as slopes in the scene's.
fn mesh_slope(own: vec3f) -> vec3f {
    let place = mesh_place;
    let across = cross(place.y, place.z);
    let sum = own.x * across + own.y * cross(place.z, place.x) + own.z * cross(place.x, place.y);
    let volume = dot(place.x, across);
    return sum / select(volume, 1e-30, abs(volume) < 1e-30);
}
