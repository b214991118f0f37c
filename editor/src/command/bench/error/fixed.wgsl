// The rest of a tracer: equal steps until the field is no longer above zero.
  let stride = (span.y - span.x) / 256.0;
  for (var step = 1u; step <= 257u; step++) {
    if sf_field(origin + direction * t) <= 0.0 {
      return sf_Hit(t, true, step);
    }
    t += stride;
  }
  return sf_Hit(t, false, 257u);
}
