// What throws shadows is drawn into one map. Stands after base.wgsl and box.wgsl.

struct ShadowView {
    // The axes of this map.
    across: vec3f,
    light: u32,
    above: vec3f,
    padding_a: u32,
    along: vec3f,
    padding_b: u32,
}

@group(3) @binding(2) var<uniform> shadow_view: ShadowView;

// Nearer to a light with a place than this nothing throws a shadow.
const SHADOW_NEAR: f32 = 0.005;

// A way from the light's centre, as the rasteriser wants it; depths are the fragments' own.
fn shadow_project(way: vec3f) -> vec4f {
    let at = shadow_axes(way, shadow_view.across, shadow_view.above, shadow_view.along);
    if shadow_lights[shadow_view.light].position == 1u {
        return vec4f(at.xy / SHADOW_BORDER, SHADOW_NEAR, at.z);
    }
    let share = (at - shadow_low(shadow_view.light)) / shadow_size(shadow_view.light);
    return vec4f(share.xy * 2.0 - 1.0, 0.5, 1.0);
}

// The depth of a way from the light's centre: along the axis of the map.
fn shadow_depth(way: vec3f) -> f32 {
    let light = shadow_lights[shadow_view.light];
    if light.position == 1u {
        return clamp(dot(way, shadow_view.along) / light.far, 0.0, 1.0);
    }
    return clamp((dot(way, light.along) - shadow_low(shadow_view.light).z) / shadow_size(shadow_view.light).z, 0.0, 1.0);
}
