// Rays of any camera: from the eye or side by side, through the middle of a lens or another place of it.

// How far a point of the target lies off the picture's middle at distance one: to the right and up.
fn scene_aside(position: vec2f) -> vec2f {
    let at = (position - scene.corner) / scene.size * 2.0 - 1.0;
    return vec2f(at.x * scene.aspect, -at.y) * scene.tan_half_fov;
}

// The way of a ray for each unit ahead that lies so far off the middle.
fn scene_along(aside: vec2f) -> vec3f {
    let leant = aside + scene.lean;
    return scene.forward + leant.x * scene.right + leant.y * scene.up;
}

// Where the ray through a point of the target begins.
fn scene_start(position: vec2f) -> vec3f {
    let aside = scene.away * scene_aside(position);
    return scene.eye + aside.x * scene.right + aside.y * scene.up;
}

// The direction through a point of the target.
fn scene_direction(position: vec2f) -> vec3f {
    return normalize(scene_along(select(scene_aside(position), vec2f(0.0), scene.away > 0.0)));
}

// A place seen from the eye, seen from where its ray begins.
fn scene_way(way: vec3f) -> vec3f {
    return select(way, dot(way, scene.forward) * scene_along(vec2f(0.0)), scene.away > 0.0);
}

// A place seen from the eye, as the rasteriser wants it: divided, its depth is `scene_depth`. A viewport stands at whole pixels, since OpenGL
// knows no others; what the picture's corner has beyond them is added here.
fn scene_project(way: vec3f) -> vec4f {
    let ahead = dot(way, scene.forward);
    let parallel = scene.away > 0.0;
    // What the place is divided by, and how wide half of the picture is there for each unit of that.
    let by = select(ahead, 1.0, parallel);
    let half = scene.tan_half_fov * select(1.0, scene.away, parallel);
    let off = vec2f(dot(way, scene.right), dot(way, scene.up)) - ahead * scene.lean;
    let corner = 2.0 * fract(scene.corner) / scene.size * by;
    let depth = select(scene.near, 1.0 - ahead / scene.max_distance, parallel);
    return vec4f(off.x / (scene.aspect * half) + corner.x, off.y / half - corner.y, depth, by);
}

// The depth of what is so far ahead.
fn scene_depth(ahead: f32) -> f32 {
    let parallel = 1.0 - ahead / scene.max_distance;
    return clamp(select(scene.near / max(ahead, scene.near), parallel, scene.away > 0.0), 0.0, 1.0);
}

// How far ahead what has this depth is.
fn scene_ahead(depth: f32) -> f32 {
    return select(scene.near / depth, (1.0 - depth) * scene.max_distance, scene.away > 0.0);
}
