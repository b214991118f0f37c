// What the host adds to a module of Surefoot: a camera, a light, and one triangle over the picture.
// The module stands before this text and is not changed. `sf_` is its default prefix.

struct View {
    eye: vec3f,
    // Width of a pixel at distance one.
    pixel: f32,
    // Scaled so that 1 is half the height of the picture at distance one.
    right: vec3f,
    width: f32,
    up: vec3f,
    height: f32,
    forward: vec3f,
    max_distance: f32,
}

@group(1) @binding(0) var<uniform> view: View;

// Linear colours.
const sun_direction = vec3f(0.408, 0.816, 0.408);
const sun = vec3f(1.8, 1.6, 1.3);
const zenith = vec3f(0.24, 0.39, 0.63);
const horizon = vec3f(0.80, 0.86, 0.91);

fn sky(direction: vec3f) -> vec3f {
    return mix(horizon, zenith, max(direction.y, 0.0));
}

@vertex
fn corner(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

fn ray(position: vec2f) -> vec3f {
    let across = (2.0 * position.x - view.width) / view.height;
    let down = 2.0 * position.y / view.height - 1.0;
    return normalize(view.forward + across * view.right - down * view.up);
}

fn normal_at(p: vec3f) -> vec3f {
    let slope = sf_gradient(p).xyz;
    return slope / max(length(slope), 1e-20);
}

@fragment
fn picture(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let direction = ray(position.xy);
    var color = sky(direction);
    let hit = sf_trace(view.eye, direction, 0.0, view.max_distance, view.pixel);
    if hit.hit {
        let p = view.eye + hit.t * direction;
        let normal = normal_at(p);
        let surface = sf_surface(p, normal);
        // Away from the surface by a pixel, so that a shadow's ray does not meet where it starts.
        let start = p + normal * (view.pixel * hit.t + 1e-4);
        var light = sky(normal) * sf_occlusion(p, normal);
        let facing = dot(normal, sun_direction);
        if facing > 0.0 {
            light += sun * (facing * sf_shadow(start, sun_direction, 0.0, view.max_distance, 16.0));
        }
        color = surface.color * light + surface.emission;
        color = mix(color, sky(reflect(direction, normal)), surface.reflectivity);
    }
    // Linear light to sRGB.
    let lit = clamp(color, vec3f(0.0), vec3f(1.0));
    return vec4f(select(1.055 * pow(lit, vec3f(1.0 / 2.4)) - 0.055, 12.92 * lit, lit < vec3f(0.0031308)), 1.0);
}

// The normals alone, each component from -1..1 to 0..1.
@fragment
fn normals(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let direction = ray(position.xy);
    let hit = sf_trace(view.eye, direction, 0.0, view.max_distance, view.pixel);
    if !hit.hit {
        return vec4f(0.12, 0.12, 0.12, 1.0);
    }
    return vec4f(0.5 + 0.5 * normal_at(view.eye + hit.t * direction), 1.0);
}
