// Balls in a map: a square for each, on which the light's ray meets the sphere. Stands after cast.wgsl and the ball's struct.

@group(2) @binding(0) var<storage, read> balls: array<Ball>;

struct MapVertex {
    @builtin(position) position: vec4f,
    // From the light's centre to the square.
    @location(0) way: vec3f,
    @location(1) @interpolate(flat) index: u32,
}

@vertex
fn map_vertex(@builtin(vertex_index) vertex: u32, @builtin(instance_index) index: u32) -> MapVertex {
    let ball = balls[index];
    let light = shadow_lights[shadow_view.light];
    let way = ball.p - light.scene_center;
    let far = length(way);
    let nothing = MapVertex(vec4f(0.0, 0.0, 0.0, 1.0), vec3f(0.0), index);
    // A ball that is gone, or that the light is in.
    if (ball.word & GONE) != 0u || (light.position == 1u && far <= 1.0001 * ball.r) {
        return nothing;
    }
    let corner = vec2f(f32((0x32u >> vertex) & 1u), f32((0x2cu >> vertex) & 1u)) * 2.0 - 1.0;
    var aside = shadow_view.across;
    var above = shadow_view.above;
    var reach = ball.r;
    if light.position == 1u {
        // The cone of the rays that touch the sphere, cut at its centre.
        let toward = way / far;
        reach = ball.r * far / sqrt(far * far - ball.r * ball.r);
        aside = normalize(cross(toward, select(above, aside, abs(dot(toward, above)) > 0.9)));
        above = cross(aside, toward);
    }
    let p = way + 1.001 * reach * (corner.x * aside + corner.y * above);
    return MapVertex(shadow_project(p), p, index);
}

@fragment
fn map_fragment(in: MapVertex) -> @builtin(frag_depth) f32 {
    let ball = balls[in.index];
    let light = shadow_lights[shadow_view.light];
    let way = ball.p - light.scene_center;
    var direction = light.along;
    var start = in.way - dot(in.way, direction) * direction;
    if light.position == 1u {
        direction = normalize(in.way);
        start = vec3f(0.0);
    }
    let along = dot(way - start, direction);
    let aside = way - start - along * direction;
    let rest = ball.r * ball.r - dot(aside, aside);
    if rest < 0.0 {
        discard;
    }
    return shadow_depth(start + (along - sqrt(rest)) * direction);
}
