// Scene: tests/hand/twisted_column.sdf
const SUN = vec3f(-1.0, -1.6, -0.8);
const SOFTNESS = 12.0;
const REACH = 0.5;
const FACTOR = 0.7;

fn brick(p: vec3f, half: vec3f) -> f32 {
  let d = abs(p) - half;
  return length(max(d, vec3f(0.0))) + min(max(d.x, max(d.y, d.z)), 0.0);
}

fn map(p: vec3f) -> f32 {
  let y = p.y - 1.4;
  let s = sin(1.6 * y);
  let c = cos(1.6 * y);
  let column = brick(vec3f(c * p.x - s * p.z, y, s * p.x + c * p.z), vec3f(0.4, 1.15, 0.4)) - 0.05;
  return min(p.y, min(column, brick(p - vec3f(0.0, 0.1, 0.0), vec3f(0.7, 0.1, 0.7))));
}
