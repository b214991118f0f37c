// How far the rays of a tile of pixels are proven to meet nothing: one march for all of them, by the bound less how far they are apart. So much of the
// way no ray has to look at.

// The circle in which the rays of a tile are at each place of their way grows as this.
struct SceneCone {
    origin: vec3f,
    direction: vec3f,
    // How wide it is where the rays begin, and how much wider for each unit of their way.
    wide: f32,
    spread: f32,
}

// The cone of the square of the target with this upper left corner.
fn scene_cone(low: vec2f) -> SceneCone {
    let middle = low + 0.5 * SCENE_TILE;
    var cone = SceneCone(scene_start(middle), scene_direction(middle), 0.0, 0.0);
    for (var i = 0u; i < 4u; i += 1u) {
        let corner = low + SCENE_TILE * vec2f(vec2u(i & 1u, i >> 1u));
        cone.wide = max(cone.wide, length(scene_start(corner) - cone.origin));
        cone.spread = max(cone.spread, length(scene_direction(corner) - cone.direction));
    }
    return cone;
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4u {
    let cone = scene_cone(SCENE_TILE * floor(position.xy) + floor(scene.corner));
    var t = 0.0;
    for (var look = 0u; look < SCENE_LOOKS; look += 1u) {
        let p = cone.origin + t * cone.direction;
        let rounding = 1e-6 * (length(p - scene.rounding * scene.center) + t + scene.unit);
        // Beyond the extent there is nothing, and nothing is proven of the bound.
        let outside = length(p - scene.center) - scene.extent;
        let free = select(scene_free(p), outside, outside > 0.0);
        // As far along as all rays are within the sphere that is empty.
        let next = (t + free - cone.wide - rounding) / (1.0 + cone.spread);
        let on = next - t;
        t = clamp(next, t, scene.max_distance);
        // What is left of the sphere is little.
        if on <= 0.5 * (cone.wide + cone.spread * t) || t >= scene.max_distance {
            break;
        }
    }
    return vec4u(bitcast<u32>(t), 0u, 0u, 0u);
}
