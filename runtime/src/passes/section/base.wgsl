// A plane that cuts the picture open: what lies above it is taken away from what rays from the eye see. Its place is `scene.slice`. The twin is
// compiler/src/section.rs.

// What it is square to: an axis, or 3 for the direction in which the camera looks.
override scene_across: u32;
// Whether what lies beyond the place stays, and not what lies before it.
override scene_keeps_above: bool;

// Out of what stays, into what is taken away.
fn scene_section_normal() -> vec3f {
    let along = select(vec3f(vec3u(0u, 1u, 2u) == vec3u(scene_across)), scene.forward, scene_across > 2u);
    return select(along, -along, scene_keeps_above);
}

// How far a point is on the side that is taken away.
fn scene_section_height(p: vec3f) -> f32 {
    return dot(p - scene.center, scene_section_normal()) - select(scene.slice, -scene.slice, scene_keeps_above);
}

// The part of a ray up to `reach` that stays; where nothing of it does, its end is before its beginning.
fn scene_span(start: vec3f, direction: vec3f, reach: f32) -> vec2f {
    let height = scene_section_height(start);
    let rise = dot(scene_section_normal(), direction);
    let removed = height > 0.0;
    let parallel = abs(rise) < 1e-9;
    let plane = -height / select(rise, 1.0, parallel);
    let span = select(vec2f(0.0, select(reach, min(reach, plane), rise > 0.0)), vec2f(plane, reach), removed);
    return select(select(span, vec2f(0.0, reach), parallel), vec2f(1.0, -1.0), removed & (parallel | (rise > 0.0)));
}

// Which part of the colour of what is cut is left in its stripes.
fn scene_stripes(p: vec3f) -> f32 {
    let across = select(vec3f(vec3u(0u, 1u, 2u) != vec3u(scene_across)), scene.right + scene.up, scene_across > 2u);
    return select(1.0, 0.7, fract(5.0 * dot(p - scene.center, across) / scene.spacing) < 0.3);
}
