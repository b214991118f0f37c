// Khronos PBR Neutral (Khronos, 2024): colours of what is lit well stay what they are.
fn scene_film(linear: vec3f) -> vec3f {
    let start = 0.8 - 0.04;
    let least = min(linear.x, min(linear.y, linear.z));
    let color = linear - select(0.04, least - 6.25 * least * least, least < 0.08);
    let peak = max(color.x, max(color.y, color.z));
    if peak < start {
        return max(color, vec3f(0.0));
    }
    let d = 1.0 - start;
    let lower = 1.0 - d * d / (peak + d - start);
    let share = 1.0 - 1.0 / (0.15 * (peak - lower) + 1.0);
    return clamp(mix(color * (lower / peak), vec3f(lower), share), vec3f(0.0), vec3f(1.0));
}
