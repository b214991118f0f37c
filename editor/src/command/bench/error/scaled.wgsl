// The rest of a tracer: steps of the field times SCALE.
  for (var step = 1u; step <= 1024u; step++) {
    let p = origin + direction * t;
    let tolerance = max(TOLERANCE * footprint * t, 4e-7 * (length(p) + 1.0));
    let free = SCALE * sf_field(p);
    if free <= SCALE * tolerance {
      return sf_Hit(t, true, step);
    }
    if t >= span.y {
      return sf_Hit(t, false, step);
    }
    t = min(t + max(free, 0.5 * SCALE * tolerance), span.y);
  }
  return sf_Hit(t, false, 1024u);
}
