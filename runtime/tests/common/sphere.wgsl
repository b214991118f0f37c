// A sphere about the origin, as the emitter would write it, by hand.

struct sf_Uniforms {
  origin: vec3f,
  radius: f32,
}

@group(0) @binding(0) var<uniform> sf_uniforms: sf_Uniforms;

struct sf_Hit {
  t: f32,
  hit: bool,
  steps: u32,
}

struct sf_Surface {
  color: vec3f,
  emission: vec3f,
  roughness: f32,
  metallic: f32,
  reflectivity: f32,
}

fn sf_field(p: vec3f) -> f32 {
  return length(p + sf_uniforms.origin) - sf_uniforms.radius;
}

fn sf_bound(p: vec3f) -> f32 {
  return sf_field(p);
}

fn sf_distance(p: vec3f) -> f32 {
  return sf_field(p);
}

fn sf_gradient(p: vec3f) -> vec4f {
  let q = p + sf_uniforms.origin;
  return vec4f(q / max(length(q), 1e-20), sf_field(p));
}

fn sf_trace(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32, footprint: f32) -> sf_Hit {
  var t = t_min;
  for (var step = 1u; step <= 512u; step++) {
    let free = sf_bound(origin + direction * t);
    if free <= 1e-5 {
      return sf_Hit(t, true, step);
    }
    t += free;
    if t > t_max {
      return sf_Hit(t_max, false, step);
    }
  }
  return sf_Hit(t, false, 512u);
}

fn sf_shadow(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32, softness: f32) -> f32 {
  return select(1.0, 0.0, sf_trace(origin, direction, t_min, t_max, 0.0).hit);
}

fn sf_occlusion(p: vec3f, normal: vec3f) -> f32 {
  return 1.0;
}

fn sf_surface(p: vec3f, normal: vec3f) -> sf_Surface {
  return sf_Surface(vec3f(0.8, 0.3, 0.1), vec3f(0.0), 0.5, 0.0, 0.0);
}

fn sf_across(n: vec3f) -> vec3f {
  return normalize(cross(n, select(vec3f(0.0, 1.0, 0.0), vec3f(1.0, 0.0, 0.0), abs(n.x) < 0.7)));
}
