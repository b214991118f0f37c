// Light that is scattered on its way through the eye: halves of the picture, each blurred, spread over it again. Nothing is lost by it. Stands
// after a tone curve. The twin is `bloom` in compiler/src/reference/film.rs.

struct Glow {
    // Of the picture, which may be a part of its texture.
    size: vec2f,
    // How much of the light is scattered.
    share: f32,
    padding: f32,
}

@group(0) @binding(0) var glow_from: texture_2d<f32>;
@group(0) @binding(1) var glow_onto: texture_2d<f32>;
@group(0) @binding(2) var<uniform> glow: Glow;

// How much of a half is what its own half is spread to.
const GLOW_SPREAD: f32 = 0.75;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

// A pixel; beyond the edges the nearest one.
fn glow_at(texture: texture_2d<f32>, at: vec2i) -> vec3f {
    let size = min(vec2i(textureDimensions(texture)), vec2i(glow.size));
    return textureLoad(texture, clamp(at, vec2i(0), size - 1), 0).rgb;
}

// Half of the picture: four pixels by four, by one, three, three and one eighth.
@fragment
fn half(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let first = 2 * vec2i(position.xy) - 1;
    var sum = vec3f(0.0);
    for (var y = 0; y < 4; y += 1) {
        for (var x = 0; x < 4; x += 1) {
            let weight = select(1.0, 3.0, x == 1 || x == 2) * select(1.0, 3.0, y == 1 || y == 2) / 64.0;
            sum += weight * glow_at(glow_from, first + vec2i(x, y));
        }
    }
    return vec4f(sum, 1.0);
}

// What a half is where twice as many pixels are.
fn glow_doubled(at: vec2i) -> vec3f {
    let near = at / 2;
    let far = near + select(vec2i(-1), vec2i(1), (at & vec2i(1)) == vec2i(1));
    let beside = glow_at(glow_from, vec2i(far.x, near.y)) + glow_at(glow_from, vec2i(near.x, far.y));
    return 0.5625 * glow_at(glow_from, near) + 0.1875 * beside + 0.0625 * glow_at(glow_from, far);
}

@fragment
fn spread(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let at = vec2i(position.xy);
    return vec4f(mix(glow_at(glow_onto, at), glow_doubled(at), GLOW_SPREAD), 1.0);
}

// The picture with what is scattered over it, through the tone curve; linear.
@fragment
fn develop(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let at = vec2i(position.xy);
    return vec4f(scene_film(mix(glow_at(glow_onto, at), glow_doubled(at), glow.share)), 1.0);
}
