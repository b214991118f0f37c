// Surfaces mirror the sky alone.

// The light that leaves a surface at `p` toward the eye. `direction` goes from the eye to it, `t` is how far that is.
fn scene_shade(p: vec3f, n: vec3f, direction: vec3f, t: f32, surface: sf_Surface) -> vec3f {
    let answer = scene_answer(surface);
    let here = scene_local(p, n, direction, t, answer, surface.emission);
    let mirrored = scene_fogged(scene_mirror(reflect(direction, n), answer.roughness), scene.max_distance - t);
    return here.light + here.occlusion * here.share * mirrored;
}
