// sf_gradient at many points: four numbers each.

@group(1) @binding(0) var<storage, read> points: array<vec4f>;
@group(1) @binding(1) var<storage, read_write> answers: array<vec4f>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x < arrayLength(&points)) { answers[id.x] = sf_gradient(points[id.x].xyz); }
}
