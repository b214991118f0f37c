// The same light as in tests/hand/demo.wgsl, by the functions of the module.
fn lit(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32, footprint: f32) -> sf_Hit {
  let hit = sf_trace(origin, direction, t_min, t_max, footprint);
  if !hit.hit {
    return hit;
  }
  let p = origin + direction * hit.t;
  let n = normalize(sf_gradient(p).xyz);
  let to_light = -normalize(SUN);
  var light = 0.2 * sf_occlusion(p, n);
  let facing = dot(n, to_light);
  if facing > 0.0 {
    let off = max(0.5 * footprint * hit.t, 12e-6 * (length(p) + 1.0));
    light += 0.8 * facing * sf_shadow(p + n * off, to_light, off, 15.0, SOFTNESS);
  }
  return sf_Hit(hit.t, true, u32(255.0 * light));
}
