// How a place answers light, and which way it seems to face.
struct SceneMet {
    surface: sf_Surface,
    normal: vec3f,
}
