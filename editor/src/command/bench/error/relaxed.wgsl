// The rest of a tracer: steps of the bound times OMEGA as long as the spheres overlap (Keinert 2014).
  var omega = OMEGA;
  var radius = 0.0;
  var stride = 0.0;
  for (var step = 1u; step <= 1024u; step++) {
    let p = origin + direction * t;
    let tolerance = max(0.5 * footprint * t, 4e-7 * (length(p) + 1.0));
    let free = sf_bound(p);
    if stride > radius && stride > radius + free {
      t += radius - stride;
      stride = radius;
      omega = 1.0;
      continue;
    }
    if free <= tolerance {
      if sf_distance(p) <= tolerance {
        return sf_Hit(t, true, step);
      }
    }
    if t >= span.y {
      return sf_Hit(t, false, step);
    }
    radius = max(free, 0.5 * tolerance);
    stride = min(omega * radius, span.y - t);
    t += stride;
  }
  return sf_Hit(t, false, 1024u);
}
