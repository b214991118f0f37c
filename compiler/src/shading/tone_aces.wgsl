// The filmic curve fitted to the Academy's reference transform: Narkowicz, "ACES Filmic Tone Mapping Curve" (2016).

// What light is multiplied by before it.
const SCENE_FILM_SPEED: f32 = 0.8;

fn scene_film(linear: vec3f) -> vec3f {
    let c = SCENE_FILM_SPEED * linear;
    return clamp(c * (2.51 * c + 0.03) / (c * (2.43 * c + 0.59) + 0.14), vec3f(0.0), vec3f(1.0));
}
