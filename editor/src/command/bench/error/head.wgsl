// How each of the compared tracers begins: the part of the ray that is looked at.
fn traced(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32, footprint: f32) -> sf_Hit {
  let span = sf_clip(origin, direction, t_min, t_max);
  if span.x > span.y {
    return sf_Hit(t_max, false, 0u);
  }
  var t = span.x;
