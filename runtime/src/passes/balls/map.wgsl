// Draws the map: a disc for each ball, as deep as its side toward the light. Stands after cast.wgsl and the ball's struct.

@group(3) @binding(1) var<storage, read> ball_bounds: array<u32, 6>;
@group(2) @binding(0) var<storage, read> balls: array<Ball>;

struct MapVertex {
    @builtin(position) position: vec4f,
    @location(0) corner: vec2f,
    @location(1) @interpolate(flat) middle: f32,
    @location(2) @interpolate(flat) radius: f32,
}

@vertex
fn map_vertex(@builtin(vertex_index) vertex: u32, @builtin(instance_index) index: u32) -> MapVertex {
    let ball = balls[index];
    if (ball.word & GONE) != 0u {
        return MapVertex(vec4f(0.0, 0.0, 0.0, 1.0), vec2f(0.0), 0.0, 0.0);
    }
    let low = vec3f(ball_number(ball_bounds[0]), ball_number(ball_bounds[1]), ball_number(ball_bounds[2]));
    let high = vec3f(ball_number(ball_bounds[3]), ball_number(ball_bounds[4]), ball_number(ball_bounds[5]));
    let size = max(high - low, vec3f(1e-9));
    let corner = vec2f(f32((0x32u >> vertex) & 1u), f32((0x2cu >> vertex) & 1u)) * 2.0 - 1.0;
    let at = (ball_axes(ball.p) - low) / size;
    let place = (at.xy + corner * ball.r / size.xy) * 2.0 - 1.0;
    return MapVertex(vec4f(place, 0.5, 1.0), corner, at.z, ball.r / size.z);
}

@fragment
fn map_fragment(in: MapVertex) -> @builtin(frag_depth) f32 {
    let rest = 1.0 - dot(in.corner, in.corner);
    if rest < 0.0 {
        discard;
    }
    return clamp(in.middle - in.radius * sqrt(rest), 0.0, 1.0);
}
