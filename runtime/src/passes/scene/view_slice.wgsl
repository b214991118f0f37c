// A plane through the field: where it is solid its lines and hatching, elsewhere its lines over what is behind; nothing is before it. The constant
// `scene_axis` says which axis it is square to. `isolines_color` of compiler/src/reference/shade.rs is the twin of `scene_isolines`.
override scene_axis: u32;

fn scene_isolines(value: f32, slope: f32, across: f32) -> vec3f {
    let spacing = scene.spacing;
    let steep = max(slope, 1e-6 * spacing);
    let ground = select(vec3f(0.42, 0.62, 0.82), vec3f(0.95, 0.62, 0.28), value < 0.0);
    let deep = 1.0 / (1.0 + 0.12 * abs(value) / spacing);
    let hatched = select(1.0, 0.78, (value < 0.0) & (fract(5.0 * across / spacing) < 0.3));
    let nearest = value - spacing * round(value / spacing);
    let clear = clamp(0.25 * spacing / steep - 0.5, 0.0, 1.0);
    let line = clear * clamp(1.2 - abs(nearest) / steep, 0.0, 1.0);
    let surface = clamp(1.8 - abs(value) / steep, 0.0, 1.0);
    return mix(ground * deep * hatched * (1.0 - 0.45 * line), vec3f(1.0), surface);
}

// How far along a ray the plane is, negative where it is behind the eye.
fn scene_plane(start: vec3f, direction: vec3f) -> f32 {
    let ahead = direction[scene_axis];
    let flat = abs(ahead) < 1e-6;
    return select((scene.slice + scene.center[scene_axis] - start[scene_axis]) / select(ahead, 1.0, flat), -1.0, flat);
}

fn scene_pixel(start: vec3f, direction: vec3f, begin: f32, reach: f32) -> ScenePixel {
    let plane = scene_plane(start, direction);
    let cuts = (plane > 0.0) & (plane < reach) & (length(start + plane * direction - scene.center) < scene.extent);
    var behind = ScenePixel(vec3f(0.12), -1.0);
    let hit = sf_trace(start, direction, select(begin, plane, cuts), reach, scene.footprint);
    if hit.hit {
        let n = scene_normal(start + hit.t * direction, direction);
        behind = ScenePixel(vec3f(0.25 + 0.55 * clamp(-dot(n, direction), 0.0, 1.0)), hit.t);
    }
    if !cuts {
        return behind;
    }
    let p = start + plane * direction;
    // How the field changes over a pixel, along the plane.
    let gradient = sf_gradient(p);
    let normal = vec3f(vec3u(0u, 1u, 2u) == vec3u(scene_axis));
    let slope = length(gradient.xyz * (1.0 - normal)) * scene.footprint * plane;
    let color = scene_isolines(gradient.w, slope, dot(p - scene.center, 1.0 - normal));
    return ScenePixel(mix(behind.color, color, select(0.55, 1.0, gradient.w < 0.0)), plane);
}
