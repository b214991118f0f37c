// What stands around a map in a demo: a hundred steps of FACTOR, a normal from four looks, a soft shadow, occlusion from five looks.

fn demo_trace(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32, footprint: f32) -> sf_Hit {
  var t = t_min;
  for (var i = 0u; i < 100u; i++) {
    let h = map(origin + direction * t);
    if h < 0.001 * t {
      return sf_Hit(t, true, i + 1u);
    }
    t += FACTOR * h;
    if t > t_max {
      break;
    }
  }
  return sf_Hit(t_max, false, 100u);
}

fn demo_normal(p: vec3f) -> vec3f {
  let e = vec2f(0.0005, -0.0005);
  return normalize(e.xyy * map(p + e.xyy) + e.yyx * map(p + e.yyx) + e.yxy * map(p + e.yxy) + e.xxx * map(p + e.xxx));
}

fn demo_shadow(p: vec3f, to_light: vec3f) -> f32 {
  var lit = 1.0;
  var t = 0.02;
  for (var i = 0u; i < 50u; i++) {
    let h = map(p + to_light * t);
    lit = min(lit, SOFTNESS * h / t);
    t += clamp(FACTOR * h, 0.01, 0.5);
    if lit < 0.002 || t > 15.0 {
      break;
    }
  }
  lit = clamp(lit, 0.0, 1.0);
  return lit * lit * (3.0 - 2.0 * lit);
}

fn demo_occlusion(p: vec3f, n: vec3f) -> f32 {
  var sum = 0.0;
  var weight = 1.0;
  for (var i = 1u; i <= 5u; i++) {
    let height = REACH * f32(i) / 5.0;
    sum += weight * (height - map(p + n * height)) / height;
    weight *= 0.5;
  }
  return clamp(1.0 - sum / 1.9375, 0.0, 1.0);
}

fn lit(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32, footprint: f32) -> sf_Hit {
  let hit = demo_trace(origin, direction, t_min, t_max, footprint);
  if !hit.hit {
    return hit;
  }
  let p = origin + direction * hit.t;
  let n = demo_normal(p);
  let to_light = -normalize(SUN);
  var light = 0.2 * demo_occlusion(p, n);
  let facing = dot(n, to_light);
  if facing > 0.0 {
    light += 0.8 * facing * demo_shadow(p + n * 0.002, to_light);
  }
  return sf_Hit(hit.t, true, u32(255.0 * light));
}
