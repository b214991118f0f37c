// The film: linear light becomes a screen's colour. Stands after the tone curve.

// Linear light to a screen's colour.
fn scene_develop(light: vec3f) -> vec3f {
    return scene_encode(scene_film(max(light, vec3f(0.0)) * scene.exposure));
}
