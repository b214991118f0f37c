// The field in a map: a ray of the light for each of its pixels. Stands after an emitted module and cast.wgsl.

override side: f32;

@vertex
fn map_vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.5, 1.0);
}

@fragment
fn map_fragment(@builtin(position) position: vec4f) -> @builtin(frag_depth) f32 {
    let light = shadow_lights[shadow_view.light];
    let at = vec2f(position.x, side - position.y) / side;
    if light.position == 1u {
        let aside = SHADOW_BORDER * (2.0 * at - 1.0);
        let direction = normalize(shadow_view.along + aside.x * shadow_view.across + aside.y * shadow_view.above);
        let hit = sf_trace(light.center, direction, SHADOW_NEAR, light.far, 1.0 / side);
        return select(1.0, shadow_depth(hit.t * direction), hit.hit);
    }
    let low = shadow_low(shadow_view.light);
    let size = shadow_size(shadow_view.light);
    let start = low.xy + at * size.xy;
    let origin = light.center + start.x * light.across + start.y * light.above + low.z * light.along;
    // A quarter of the map's pixel at the far end.
    let hit = sf_trace(origin, light.along, 0.0, size.z, 0.25 * min(size.x, size.y) / (side * size.z));
    return select(1.0, clamp(hit.t / size.z, 0.0, 1.0), hit.hit);
}
