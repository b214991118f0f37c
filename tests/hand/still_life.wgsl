// Scene: examples/still_life.sdf
const SUN = vec3f(1.0, -0.9, -0.55);
const SOFTNESS = 10.0;
const REACH = 0.6;
const FACTOR = 1.0;

fn turn(v: vec2f, c: f32, s: f32) -> vec2f {
  return vec2f(c * v.x - s * v.y, s * v.x + c * v.y);
}

fn inside(d: vec2f) -> f32 {
  return length(max(d, vec2f(0.0))) + min(max(d.x, d.y), 0.0);
}

fn map(p: vec3f) -> f32 {
  var d = min(p.y, p.z + 3.2);
  // The cube.
  let cube = abs(vec3f(turn(p.xz - vec2f(-0.9, -0.7), 0.8829476, 0.4694716), p.y - 0.75)) - 0.75;
  d = min(d, length(max(cube, vec3f(0.0))) + min(max(cube.x, max(cube.y, cube.z)), 0.0));
  // The octahedron on it.
  var o = p - vec3f(-0.95, 1.8175, -0.75);
  let o1 = turn(o.xz, 0.6427876, 0.7660444);
  let o2 = turn(vec2f(o.y, o1.y), 0.5773522, 0.8164952);
  let o3 = turn(vec2f(o1.x, o2.y), 0.7071068, -0.7071068);
  d = min(d, (abs(o3.x) + abs(o2.x) + abs(o3.y) - 0.55) * 0.57735);
  // The cone.
  let cone = length(p.xz - vec2f(0.95, -1.0));
  d = min(d, max((2.1 * cone + 0.72 * (p.y - 2.1)) / 2.22, -p.y));
  d = min(d, length(p - vec3f(0.75, 0.55, 0.55)) - 0.55);
  // The prism, folded to a sixth.
  var h = abs(turn(p.zx - vec2f(-0.35, 2.05), 0.9848078, -0.1736482));
  h -= 2.0 * min(dot(vec2f(-0.8660254, 0.5), h), 0.0) * vec2f(-0.8660254, 0.5);
  d = min(d, inside(vec2f(length(h - vec2f(clamp(h.x, -0.25, 0.25), 0.4330127)) * sign(h.y - 0.4330127), abs(p.y - 0.65) - 0.65)));
  // The pyramid.
  let y = abs(turn(p.xz - vec2f(-1.15, 1.05), 0.9135454, -0.4067366));
  d = min(d, max((0.9 * max(y.x, y.y) + 0.475 * (p.y - 0.9)) / 1.0176566, -p.y));
  // The lying cylinder.
  let v = p - vec3f(-2.5, 0.35, 0.55);
  let along = (v.x + v.z) * 0.70710678;
  d = min(d, inside(vec2f(length(v - along * vec3f(0.70710678, 0.0, 0.70710678)) - 0.35, abs(along) - 0.5656854)));
  // The ring.
  let r1 = turn(p.xz, 0.8829476, 0.4694716) - vec2f(-0.05, 0.5);
  let r2 = turn(vec2f(p.y - 0.55, r1.y), 0.4694716, -0.8829476);
  d = min(d, length(vec2f(length(vec2f(r1.x, r2.y)) - 0.42, r2.x)) - 0.13);
  return min(d, length(p - vec3f(1.6, 0.16, 0.85)) - 0.16);
}
