// A pixel of a picture that is cut open: a ray begins at the plane, and where that is in the solid it meets the plane.
fn scene_pixel(start: vec3f, direction: vec3f, begin: f32, reach: f32) -> ScenePixel {
    let span = scene_span(start, direction, reach);
    let p = start + span.x * direction;
    if (span.x > 0.0) & (span.x <= span.y) & (length(p - scene.center) < scene.extent) {
        if sf_gradient(p).w < 0.0 {
            return ScenePixel(scene_cut(scene_cut_color(p), p, span.x), span.x);
        }
    }
    return scene_kept(start, direction, max(span.x, begin), span.y);
}
