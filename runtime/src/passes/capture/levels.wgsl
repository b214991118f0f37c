// What was captured, blurred: for each roughness a level. One triangle over a face; the number of the instance says which face and level.

@group(0) @binding(0) var capture: texture_cube<f32>;
@group(0) @binding(1) var capture_sampler: sampler;
// The level before, as six layers.
@group(0) @binding(2) var capture_faces: texture_2d_array<f32>;

struct CaptureVertex {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) face: u32,
    @location(1) @interpolate(flat) level: u32,
}

@vertex
fn level_vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) which: u32) -> CaptureVertex {
    let corner = vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
    return CaptureVertex(corner, which % 6u, which / 6u);
}

// The mean of four pixels of the level before.
@fragment
fn half_fragment(in: CaptureVertex) -> @location(0) vec4f {
    let first = 2 * vec2i(in.position.xy);
    let face = in.face;
    let above = textureLoad(capture_faces, first, face, 0) + textureLoad(capture_faces, first + vec2i(1, 0), face, 0);
    let below = textureLoad(capture_faces, first + vec2i(0, 1), face, 0) + textureLoad(capture_faces, first + vec2i(1, 1), face, 0);
    return 0.25 * (above + below);
}

// The direction of a place on a face, -1 to 1 to the right and down: the tables of Vulkan (16.5.4).
fn capture_direction(face: u32, at: vec2f) -> vec3f {
    switch face {
        case 0u: { return vec3f(1.0, -at.y, -at.x); }
        case 1u: { return vec3f(-1.0, -at.y, at.x); }
        case 2u: { return vec3f(at.x, 1.0, at.y); }
        case 3u: { return vec3f(at.x, -1.0, -at.y); }
        case 4u: { return vec3f(at.x, -at.y, 1.0); }
        default: { return vec3f(-at.x, -at.y, -1.0); }
    }
}

const CAPTURE_PI: f32 = 3.14159265;
const CAPTURE_POLISHED: f32 = 0.06;
// Sides of the most blurred level.
const CAPTURE_SMALLEST: f32 = 8.0;

// The mean about a direction as a surface of the level's roughness mirrors it when it is seen head-on. The twin is `blurred` in
// compiler/src/images/cube.rs: GGX (Walter et al. 2007) by Hammersley's points, each as blurred as they are apart (Křivánek and Colbert,
// "Real-time Shading with Filtered Importance Sampling", 2008).
@fragment
fn blur_fragment(in: CaptureVertex) -> @location(0) vec4f {
    let whole = f32(textureDimensions(capture).x);
    let levels = log2(whole / CAPTURE_SMALLEST);
    let roughness = CAPTURE_POLISHED + (1.0 - CAPTURE_POLISHED) * f32(in.level) / levels;
    let side = whole / exp2(f32(in.level));
    let axis = normalize(capture_direction(in.face, 2.0 * in.position.xy / side - 1.0));
    let helper = select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(axis.y) < 0.9);
    let right = normalize(cross(helper, axis));
    let up = cross(axis, right);
    let count = clamp(u32(4096.0 / side), 32u, 128u);
    let width2 = pow(roughness, 4.0);
    let texel = 4.0 * CAPTURE_PI / (6.0 * whole * whole);
    var sum = vec4f(0.0);
    var weights = 0.0;
    for (var i = 0u; i < count; i += 1u) {
        let around = 2.0 * CAPTURE_PI * (f32(i) + 0.5) / f32(count);
        let share = f32(reverseBits(i)) / 4294967296.0 + 0.5 / f32(count);
        let cos2 = (1.0 - share) / (1.0 + (width2 - 1.0) * share);
        let lean = sqrt(max(1.0 - cos2, 0.0));
        let toward = 2.0 * sqrt(cos2) * vec3f(lean * cos(around), lean * sin(around), sqrt(cos2)) - vec3f(0.0, 0.0, 1.0);
        if toward.z > 0.0 {
            let below = cos2 * (width2 - 1.0) + 1.0;
            let density = 0.25 * width2 / (CAPTURE_PI * below * below);
            let level = max(0.5 * log2(1.0 / (f32(count) * density * texel)), 0.0);
            let direction = toward.x * right + toward.y * up + toward.z * axis;
            sum += toward.z * textureSampleLevel(capture, capture_sampler, direction, level);
            weights += toward.z;
        }
    }
    return sum / max(weights, 1e-9);
}
