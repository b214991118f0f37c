// Rays that come from one point.

// Where the ray through a point of the target begins.
fn scene_start(position: vec2f) -> vec3f {
    return scene.eye;
}

// The direction through a point of the target.
fn scene_direction(position: vec2f) -> vec3f {
    let at = (position - scene.corner) / scene.size * 2.0 - 1.0;
    let across = at.x * scene.aspect * scene.tan_half_fov;
    let down = at.y * scene.tan_half_fov;
    return normalize(scene.forward + across * scene.right - down * scene.up);
}

// A place seen from the eye, seen from where its ray begins.
fn scene_way(way: vec3f) -> vec3f {
    return way;
}

// A place seen from the eye, as the rasteriser wants it: divided, its depth is 1 at the near plane and 0 at infinity. A viewport stands at whole
// pixels, since OpenGL knows no others; what the picture's corner has beyond them is added here.
fn scene_project(way: vec3f) -> vec4f {
    let ahead = dot(way, scene.forward);
    let aside = 2.0 * fract(scene.corner) / scene.size * ahead;
    let across = dot(way, scene.right) / (scene.aspect * scene.tan_half_fov);
    return vec4f(across + aside.x, dot(way, scene.up) / scene.tan_half_fov - aside.y, scene.near, ahead);
}

// The depth of what is so far ahead.
fn scene_depth(ahead: f32) -> f32 {
    return clamp(scene.near / max(ahead, scene.near), 0.0, 1.0);
}

// How far ahead what has this depth is.
fn scene_ahead(depth: f32) -> f32 {
    return scene.near / depth;
}
