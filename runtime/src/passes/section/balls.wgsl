// Balls in a picture that is cut open.

// Whether nothing stays of a ball that a ray meets and leaves at these ways.
fn ball_is_removed(start: vec3f, direction: vec3f, meets: f32, leaves: f32) -> bool {
    let span = scene_span(start, direction, scene.max_distance);
    return (meets > span.y) | (leaves <= span.x);
}

// Where the ray meets what stays of it: the ball, or the plane.
fn ball_begin(start: vec3f, direction: vec3f, t: f32) -> f32 {
    return max(t, scene_span(start, direction, scene.max_distance).x);
}

// What is seen there.
fn ball_cut(start: vec3f, n: vec3f, direction: vec3f, t: f32, look: BallLook) -> vec3f {
    let begin = ball_begin(start, direction, t);
    if begin > t {
        return scene_cut(look.color, start + begin * direction, begin);
    }
    return ball_color(start + t * direction, n, direction, t, look);
}
