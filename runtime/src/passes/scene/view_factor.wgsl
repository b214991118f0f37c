// What of the distance a ray may go right above the surface: grey where it is all of it, and darker and redder the less it is, black at an eighth. Asked
// four pixels above the surface, where in a corner another surface may be nearer, or that place within it.
fn scene_pixel(start: vec3f, direction: vec3f, begin: f32, reach: f32) -> ScenePixel {
    let hit = sf_trace(start, direction, begin, reach, scene.footprint);
    if !hit.hit {
        return ScenePixel(vec3f(0.12), -1.0);
    }
    let p = start + hit.t * direction;
    let high = 4.0 * scene.footprint * hit.t;
    let above = p + high * scene_normal(p, direction);
    let far = max(min(high, abs(sf_distance(above))), 1e-3 * high);
    let part = clamp(1.0 + log2(max(abs(sf_bound(above)) / far, 1e-6)) / 3.0, 0.0, 1.0);
    return ScenePixel(vec3f(0.85) * vec3f(sqrt(part), part, part * part), hit.t);
}
