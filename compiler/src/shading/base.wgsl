// What all that shades reads. Stands after an emitted module; what draws declares `scene`, a `SceneUniforms`, and the constants `scene_lights`, how many of
// the lights there are, and `scene_bounces`, how often a mirrored ray is followed at most.
// The constants and formulas of light are those of compiler/src/reference/shade.rs: what changes here changes there.

struct SceneLight {
    // The direction toward the light, of length one; or where it is.
    vector: vec3f,
    // 0 where `vector` is a direction, 1 where it is a position, 2 where it is that of a lamp whose softness is so at a distance of one, and
    // farther away sharper.
    position: u32,
    radiance: vec3f,
    // Below 0: throws no shadow; 0: a hard one; above: a soft one, sharper the larger it is.
    softness: f32,
}

struct SceneUniforms {
    // Where the eye is, in the space of the module's `p`.
    eye: vec3f,
    // A picture's half height at distance one.
    tan_half_fov: f32,
    right: vec3f,
    // Width over height.
    aspect: f32,
    up: vec3f,
    // A pixel's width at distance one.
    footprint: f32,
    forward: vec3f,
    // What light is multiplied by.
    exposure: f32,
    // The scene's origin, in the space of the module's `p`.
    center: vec3f,
    // Radius about it beyond which nothing is drawn.
    extent: f32,
    zenith: vec3f,
    max_distance: f32,
    horizon: vec3f,
    // A mirrored ray is followed at most so often.
    reflections: u32,
    // What the ground throws back of the light from above.
    ground: vec3f,
    // Distance of the plane at which the depth that is written is 1.
    near: f32,
    // The picture's upper left corner on the target, and its size, in pixels.
    corner: vec2f,
    size: vec2f,
    // Along each axis 1 where rounding grows with the distance from the scene's middle, 0 where with that from the eye alone.
    rounding: vec3f,
    // How far the target is where rays go side by side, 0 where they come from the eye.
    away: f32,
    // What fog scatters toward the eye, and how much of a unit's way it takes.
    fog: vec3f,
    density: f32,
    // How far rays lean for each unit ahead, to the right and up: as a place of the lens has it.
    lean: vec2f,
    // The length that rounding grows with beside coordinates.
    unit: f32,
    // Where along its axis the plane of a slice is, in the scene.
    slice: f32,
    // What this picture of a film looks at of a light's disc: a place, on a disc of radius one; and how many times as sharp, 0 for a sharp edge.
    part: vec3f,
    // The value of the field from one line of a slice to the next.
    spacing: f32,
    lights: array<SceneLight, 16>,
}

const SCENE_PI: f32 = 3.14159265;

// What a ray from the eye finds: the colour as a screen wants it (sRGB-encoded), and how far the surface is; below 0: none.
struct ScenePixel {
    color: vec3f,
    t: f32,
}

// The surface's normal; a gradient that vanishes answers with the direction to the eye.
fn scene_normal(p: vec3f, direction: vec3f) -> vec3f {
    let gradient = sf_gradient(p).xyz;
    let size = length(gradient);
    return select(-direction, gradient / max(size, 1e-12), size > 1e-12);
}

fn scene_smooth(low: f32, high: f32, x: f32) -> f32 {
    let s = clamp((x - low) / (high - low), 0.0, 1.0);
    return s * s * (3.0 - 2.0 * s);
}

// Linear to sRGB (IEC 61966-2-1).
fn scene_encode(linear: vec3f) -> vec3f {
    let c = clamp(linear, vec3f(0.0), vec3f(1.0));
    return select(1.055 * pow(max(c, vec3f(1e-6)), vec3f(1.0 / 2.4)) - 0.055, 12.92 * c, c <= vec3f(0.0031308));
}
