// A ball in the scene's light, with the field's shadows and corners.
fn ball_color(p: vec3f, n: vec3f, direction: vec3f, t: f32, look: BallLook) -> vec3f {
    let surface = sf_Surface(look.color, look.emission, look.roughness, look.metallic, look.reflectivity);
    return scene_develop(scene_haze(scene_shade(p, n, direction, t, surface), p, direction, t));
}
