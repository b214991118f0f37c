// The scene as a picture: where it is seen from, and what each pixel of a triangle over the target shows. `scene_gather` says what surrounds the scene
// at this moment; it stands after this.

var<private> scene: SceneUniforms;

// Colour, and the depth of the surface between the planes `near` and `far`: 0 at the first and 1 at the second; 1 and 0 where they are exchanged.
struct SceneFragment {
    @location(0) color: vec4f,
    @builtin(frag_depth) depth: f32,
}

// Takes the view and what surrounds the scene from the uniforms.
fn scene_look() {
    let to = sf_uniforms.view_look_at - sf_uniforms.view_eye;
    let far = length(to);
    let forward = select(vec3f(0.0, 0.0, -1.0), to / max(far, 1e-20), far > 1e-9);
    let upward = sf_uniforms.view_up / max(length(sf_uniforms.view_up), 1e-20);
    let side = cross(forward, upward);
    // Who looks along the way up has x to the right, or z.
    let spare = select(vec3f(0.0, 0.0, 1.0), vec3f(1.0, 0.0, 0.0), abs(forward.x) < 0.9);
    let across = select(spare - dot(spare, forward) * forward, side, length(side) > 1e-6);
    scene.eye = sf_uniforms.view_eye - sf_uniforms.origin;
    scene.forward = forward;
    scene.right = normalize(across);
    scene.up = cross(scene.right, forward);
    scene.center = -sf_uniforms.origin;
    scene.corner = sf_uniforms.view_corner;
    scene.size = sf_uniforms.view_size;
    scene.aspect = sf_uniforms.view_size.x / max(sf_uniforms.view_size.y, 1.0);
    PROJECTION
    scene.footprint = 2.0 * scene.tan_half_fov / max(sf_uniforms.view_size.y, 1.0);
    scene.part = vec3f(0.0, 0.0, 1.0);
    scene_gather();
}

// The colour at a place of the target, in pixels from its upper left corner, and the depth there.
fn scene_picture(position: vec2f) -> SceneFragment {
    scene_look();
    let direction = scene_direction(position);
    let pixel = scene_pixel(scene_start(position), direction, 0.0, scene.max_distance);
    let ahead = pixel.t * dot(direction, scene.forward);
    let near = sf_uniforms.view_near;
    let far = sf_uniforms.view_far;
    let depth = DEPTH;
    let seen = pixel.t >= 0.0;
    return SceneFragment(scene_target(pixel.color, seen, position), select(select(0.0, 1.0, far > near), clamp(depth, 0.0, 1.0), seen));
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> SceneFragment {
    return scene_picture(position.xy);
}
