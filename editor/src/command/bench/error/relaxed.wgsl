// The rest of a tracer: steps of the bound times OMEGA as long as the spheres overlap (Keinert 2014). The distance is asked between two
// loops, as ours asks it.
  var omega = OMEGA;
  var radius = 0.0;
  var stride = 0.0;
  var step = 1u;
  var near = false;
  var refused = false;
  var close = 0.0;
  while step <= 1024u {
    for (; step <= 1024u; step++) {
      let p = origin + direction * t;
      let tolerance = max(TOLERANCE * footprint * t, 4e-7 * (length(p) + 1.0));
      let free = sf_bound(p);
      let gap = stride > max(radius, radius + free);
      near = free <= tolerance && !refused && !gap;
      refused = false;
      if near {
        close = tolerance;
        break;
      }
      if gap {
        t += radius - stride;
        stride = radius;
        omega = 1.0;
        continue;
      }
      if t >= span.y {
        return sf_Hit(t, false, step);
      }
      radius = max(free, 0.5 * tolerance);
      stride = min(omega * radius, span.y - t);
      t += stride;
    }
    if near && sf_distance(origin + direction * t) <= close {
      return sf_Hit(t, true, step);
    }
    refused = true;
  }
  return sf_Hit(t, false, 1024u);
}
