//! The function that follows a ray: its text, with each of its parts by a number that can be changed or switched off.

use std::fmt::Write;

/// How a ray is followed. [`Tracer::default`] is what modules hold, and what the picture in 64 bits does; others are for measuring what a
/// part is worth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tracer {
    /// What the bound is multiplied by before it is used. Above 1 nothing is proven.
    pub factor: f64,
    /// How fast the slope along the ray is learnt, by which a step is made longer (Bálint and Valasek, "Automatic Step Size Relaxation in
    /// Sphere Tracing", 2023), 0 to 1; 0 takes whole bounds only.
    pub relaxation: f64,
    /// How near is near enough, in widths of a pixel there. Nearer costs little: the steps shrink geometrically. As the budget is spent it
    /// grows by [`Tracer::TIRED`], so that a ray that hardly gets on ends at the surface and not in a hole.
    pub tolerance: f64,
    /// Looks at most.
    pub budget: u32,
}

impl Default for Tracer {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Tracer {
    /// What modules hold.
    pub const DEFAULT: Self = Self { factor: 1.0, relaxation: 0.3, tolerance: 1.0 / 32.0, budget: 1024 };
    /// By how much the tolerance has grown when the budget is spent, in widths of a pixel.
    pub const TIRED: f64 = 0.5;
    /// The slope at which a step is longest.
    pub const STEEPEST: f64 = 0.75;

    /// The function `sf_trace`, which calls `sf_clip`, `sf_bound` and, unless that is the bound itself (`one`), `sf_distance`.
    pub fn wgsl(&self, one: bool) -> String {
        let Self { factor, relaxation, tolerance, budget } = *self;
        let times = if factor == 1.0 { String::new() } else { format!("{factor:?} * ") };
        let relaxed = relaxation > 0.0;
        let tired = Self::TIRED / f64::from(budget);
        let mut text = "\
fn sf_trace(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32, footprint: f32) -> sf_Hit {
  let span = sf_clip(origin, direction, t_min, t_max);
  if span.x > span.y {
    return sf_Hit(t_max, false, 0u);
  }
  // Rounding grows with coordinates, and they are no larger than this and the way.
  let size = length(origin + sf_uniforms.origin) + 1.0;
  var t = span.x;
"
        .to_owned();
        if relaxed {
            text.push_str(
                "  // The last sphere known to be empty, the step from its centre, and how the bound changes along the ray.
  var radius = 0.0;
  var stride = 0.0;
  var slope = -1.0;
",
            );
        }
        let _ = writeln!(
            text,
            "  for (var step = 1u; step <= {budget}u; step++) {{
    let p = origin + direction * t;
    let tolerance = max(({tolerance:?} + {tired:?} * f32(step)) * footprint * t, 4e-7 * (size + t));
    let free = {times}sf_bound(p);"
        );
        if relaxed {
            text.push_str(
                "    // A gap between two spheres may hold a surface: back to the end of the first.
    if stride > radius && stride > radius + free {
      t += radius - stride;
      stride = radius;
      slope = -1.0;
      continue;
    }
",
            );
        }
        text.push_str(match one {
            true => "    if free <= tolerance {\n      return sf_Hit(t, true, step);\n    }\n",
            false => "    if free <= tolerance {\n      if sf_distance(p) <= tolerance {\n        return sf_Hit(t, true, step);\n      }\n    }\n",
        });
        text.push_str(
            "    // The end itself is looked at before it counts as a miss.
    if t >= span.y {
      return sf_Hit(t, false, step);
    }
",
        );
        if relaxed {
            let _ = writeln!(
                text,
                "    if stride > 0.0 {{
      slope = clamp(mix(slope, (free - radius) / stride, {relaxation:?}), -1.0, {:?});
    }}
    radius = max(free, 0.5 * tolerance);
    stride = min(radius * 2.0 / (1.0 - slope), span.y - t);
    t += stride;",
                Self::STEEPEST
            );
        } else {
            text.push_str("    t = min(t + max(free, 0.5 * tolerance), span.y);\n");
        }
        let _ = writeln!(text, "  }}\n  return sf_Hit(t, false, {budget}u);\n}}");
        text
    }
}
