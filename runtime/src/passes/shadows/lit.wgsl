// How much of a light arrives past the field and past what is in the light's maps: 1 all, 0 nothing. Stands after base.wgsl and box.wgsl.

@group(3) @binding(2) var shadow_maps: texture_2d_array<f32>;

// How many pixels of a map a shadow may begin too late: what the edges of flat sides and the steps of rays need.
const SHADOW_SLACK: f32 = 0.75;
// A surface that the light grazes is taken as if it were no steeper than this.
const SHADOW_STEEP: f32 = 12.0;

// What a light's maps say of a place: how much arrives, and whether they know it.
struct ShadowSaid {
    lit: f32,
    known: bool,
}

// The share of nine pixels of a map about one at which a flat surface is not behind what the map has. The surface is `depth` deep at `place`,
// in pixels, and `slope` deeper with each pixel to the right and down.
fn shadow_share(layer: i32, place: vec2f, depth: f32, slope: vec2f, slack: f32) -> f32 {
    let pixels = vec2i(textureDimensions(shadow_maps));
    let first = floor(place - 0.5);
    let part = place - 0.5 - first;
    var lit = 0.0;
    for (var y = -1; y <= 2; y++) {
        for (var x = -1; x <= 2; x++) {
            let cell = vec2i(first) + vec2i(x, y);
            let found = textureLoad(shadow_maps, clamp(cell, vec2i(0), pixels - 1), layer, 0).x;
            let here = depth + dot(slope, vec2f(cell) + 0.5 - place);
            // Where nothing is the map has its far end, beyond which the field may go on.
            let free = select(0.0, 1.0, here - slack <= found || found >= 1.0);
            // A box of three pixels about the place itself.
            let across = select(select(1.0, part.x, x == 2), 1.0 - part.x, x == -1);
            let above = select(select(1.0, part.y, y == 2), 1.0 - part.y, y == -1);
            lit += free * across * above;
        }
    }
    return lit / 9.0;
}

fn shadow_bounded(slope: vec2f, most: f32) -> vec2f {
    return slope * min(1.0, most / max(length(slope), 1e-12));
}

fn shadow_said(index: u32, p: vec3f, n: vec3f) -> ShadowSaid {
    let light = shadow_lights[index];
    if light.first < 0 {
        return ShadowSaid(1.0, false);
    }
    let pixels = f32(textureDimensions(shadow_maps).x);
    let way = p - light.center;
    if light.position == 1u {
        // The side of the cube: as the host has them, +x, -x, +y, -y, +z, -z.
        let size = abs(way);
        var axis = 2;
        if size.x >= size.y && size.x >= size.z {
            axis = 0;
        } else if size.y >= size.z {
            axis = 1;
        }
        let sign = select(-1.0, 1.0, way[axis] > 0.0);
        var along = vec3f(0.0);
        along[axis] = sign;
        var above = vec3f(0.0);
        above[(axis + 1) % 3] = 1.0;
        let across = cross(along, above);
        let at = shadow_axes(way, across, above, along);
        let aside = at.xy / (SHADOW_BORDER * max(at.z, 1e-9));
        let place = vec2f(0.5 + 0.5 * aside.x, 0.5 - 0.5 * aside.y) * pixels;
        let step = 2.0 * SHADOW_BORDER * at.z / pixels;
        let facing = min(dot(n, way) / at.z, -1e-3);
        let slope = step * shadow_bounded(vec2f(-dot(n, across), dot(n, above)) / facing, SHADOW_STEEP);
        let layer = light.first + 2 * axis + select(1, 0, sign > 0.0);
        return ShadowSaid(shadow_share(layer, place, at.z / light.far, slope / light.far, SHADOW_SLACK * step / light.far), true);
    }
    let low = shadow_low(index);
    let size = shadow_size(index);
    let at = (shadow_axes(way, light.across, light.above, light.along) - low) / size;
    if any(at.xy < vec2f(0.0)) || any(at.xy > vec2f(1.0)) || at.z < 0.0 {
        return ShadowSaid(1.0, false);
    }
    let place = vec2f(at.x, 1.0 - at.y) * pixels;
    let step = size.xy / pixels;
    let turned = shadow_axes(n, light.across, light.above, light.along);
    // How much deeper a flat surface is to the right, and down in the map.
    let slope = shadow_bounded(vec2f(-turned.x, turned.y) / min(turned.z, -1e-3), SHADOW_STEEP) * step;
    return ShadowSaid(shadow_share(light.first, place, at.z, slope / size.z, SHADOW_SLACK * max(step.x, step.y) / size.z), true);
}

// `light` is the light's number, `l` points to it, `off` is how far a ray starts from the surface.
fn scene_lit(light: u32, p: vec3f, n: vec3f, l: vec3f, off: f32, far: f32) -> f32 {
    let place = select(p, scene_round, all(p == scene_flat));
    let said = shadow_said(light, place, n);
    if said.lit <= 0.0 || (said.known && shadow_lights[light].field == 1u) {
        return said.lit;
    }
    return said.lit * scene_seen(light, place, n, l, off, far);
}
