// Rays followed by the function that stands for TRACE; `looks` stays zero unless it counts.

struct Ray {
    origin: vec3f,
    t_min: f32,
    direction: vec3f,
    t_max: f32,
}

// `looks`: how often each function was evaluated that a tracer may call.
struct Traced {
    t: f32,
    hit: u32,
    steps: u32,
    looks: array<u32, 6>,
}

struct Settings {
    footprint: f32,
}

@group(1) @binding(0) var<storage, read> rays: array<Ray>;
@group(1) @binding(1) var<storage, read_write> answers: array<Traced>;
@group(2) @binding(0) var<uniform> settings: Settings;

var<private> looks: array<u32, 6>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let at = id.y * groups.x * 8u + id.x;
    if at >= arrayLength(&rays) {
        return;
    }
    let ray = rays[at];
    let hit = TRACE(ray.origin, ray.direction, ray.t_min, ray.t_max, settings.footprint);
    answers[at] = Traced(hit.t, u32(hit.hit), hit.steps, looks);
}
