// Balls in the picture: a square for each, turned to the eye, on which its ray meets the sphere itself; so outline and depth are exact.
// Stands after an emitted module, the sections of the scene that shade, and the ball's struct.

struct BallLook {
    color: vec3f,
    roughness: f32,
    emission: vec3f,
    metallic: f32,
    reflectivity: f32,
    // The speed from which on a ball is red; 0: it has this colour.
    red_at: f32,
    padding: vec2f,
}

@group(2) @binding(0) var<storage, read> balls: array<Ball>;
@group(2) @binding(1) var<storage, read> looks: array<BallLook>;

struct BallVertex {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) index: u32,
}

struct BallFragment {
    @location(0) color: vec4f,
    @builtin(frag_depth) depth: f32,
}

@vertex
fn ball_vertex(@builtin(vertex_index) vertex: u32, @builtin(instance_index) index: u32) -> BallVertex {
    let ball = balls[index];
    // From the eye to the centre.
    let centre = ball.p + scene.center - scene.eye;
    let way = scene_way(centre);
    let far = length(way);
    var out = BallVertex(vec4f(0.0, 0.0, 0.0, 1.0), index);
    // A ball that is gone, or that the eye is in, has no corner.
    if (ball.word & GONE) != 0u || far <= 1.0001 * ball.r {
        return out;
    }
    let toward = way / far;
    // The cone of the rays that touch the sphere, cut at its centre.
    let reach = ball.r * far / sqrt(far * far - ball.r * ball.r);
    let aside = normalize(cross(toward, select(scene.up, scene.right, abs(dot(toward, scene.up)) > 0.9)));
    let above = cross(aside, toward);
    let corner = vec2f(f32((0x32u >> vertex) & 1u), f32((0x2cu >> vertex) & 1u)) * 2.0 - 1.0;
    var p = scene_project(centre + 1.001 * reach * (corner.x * aside + corner.y * above));
    // The square may reach behind the near plane, and the ball before it.
    p.z = min(p.z, p.w);
    out.position = p;
    return out;
}

// Blue at rest, over white to red: Moreland, "Diverging Color Maps for Scientific Visualization" (2009), its ends and middle, linear.
fn color_of_speed(share: f32) -> vec3f {
    let slow = vec3f(0.0437, 0.0723, 0.5271);
    let middle = vec3f(0.7230, 0.7230, 0.7230);
    let fast = vec3f(0.4564, 0.0012, 0.0194);
    let s = clamp(share, 0.0, 1.0);
    return select(mix(middle, fast, 2.0 * s - 1.0), mix(slow, middle, 2.0 * s), s < 0.5);
}

@fragment
fn ball_fragment(in: BallVertex) -> BallFragment {
    let ball = balls[in.index];
    let direction = scene_direction(in.position.xy);
    let start = scene_start(in.position.xy);
    let way = ball.p + scene.center - start;
    let along = dot(way, direction);
    let aside = way - along * direction;
    let rest = ball.r * ball.r - dot(aside, aside);
    if rest < 0.0 {
        discard;
    }
    let half = sqrt(rest);
    let t = along - half;
    let n = normalize(-aside - half * direction);
    if t <= 0.0 || t > scene.max_distance {
        discard;
    }
    var look = looks[min(ball.word & 0xffffu, arrayLength(&looks) - 1u)];
    if look.red_at > 0.0 {
        look.color = color_of_speed(length(ball.v) / look.red_at);
    }
    let color = ball_color(start + t * direction, n, direction, t, look);
    let depth = scene_depth(t * dot(direction, scene.forward));
    return BallFragment(scene_target(color, false, in.position.xy), depth);
}
