// Scene: examples/csg.sdf
const SUN = vec3f(-1.0, -1.6, -0.8);
const SOFTNESS = 12.0;
const REACH = 0.5;
const FACTOR = 1.0;

fn cube(p: vec3f, half: f32) -> f32 {
  let d = abs(p) - half;
  return length(max(d, vec3f(0.0))) + min(max(d.x, max(d.y, d.z)), 0.0);
}

fn rod(r: f32, along: f32, radius: f32, half: f32) -> f32 {
  let d = vec2f(r - radius, abs(along) - half);
  return length(max(d, vec2f(0.0))) + min(max(d.x, d.y), 0.0);
}

fn map(p: vec3f) -> f32 {
  let q = p - vec3f(0.0, 1.15, -0.2);
  let body = max(cube(q, 0.95), length(q) - 1.25);
  let drills = min(length(q.xz), min(length(q.xy), length(q.yz))) - 0.42;
  let h = max(0.02 - abs(body + drills), 0.0);
  var d = max(body, -drills) + h * h / 0.08;
  d = min(d, cube(p - vec3f(-1.9, 0.28, 0.9), 0.275));
  d = min(d, length(p - vec3f(-1.15, 0.36, 1.45)) - 0.36);
  let c = p - vec3f(1.75, 0.31, 1.0);
  d = min(d, rod(length(c.xz), c.y, 0.0588, 0.28));
  d = min(d, min(rod(length(c.xy), c.z, 0.0588, 0.28), rod(length(c.yz), c.x, 0.0588, 0.28)));
  let wall = p.z + 4.0;
  let k = max(2.5 - abs(p.y - wall), 0.0);
  return min(d, min(p.y, wall) - k * k / 10.0);
}
