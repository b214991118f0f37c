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
    /// How near is near enough, in halves of a pixel's width there.
    pub tolerance: f64,
    /// Looks at most.
    pub budget: u32,
    /// Whether a hit is moved to where the secant finds the zero.
    pub polish: bool,
}

impl Default for Tracer {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Tracer {
    /// What modules hold.
    pub const DEFAULT: Self = Self { factor: 1.0, relaxation: 0.3, tolerance: 1.0, budget: 1024, polish: true };
    /// The slope at which a step is longest.
    pub const STEEPEST: f64 = 0.75;

    /// How far outside of the surface a polished hit lies, and how exactly, in tolerances: the gradient there is that of the outer side,
    /// which turns at an edge where that of the surface itself jumps.
    pub const REST: f64 = 0.05;
    /// See [`Self::REST`].
    pub const EXACT: f64 = 0.02;
    /// Looks of the secant rule at most.
    pub const LOOKS: u32 = 4;

    /// The function `sf_polish`, which calls `sf_distance`: the secant rule. Its steps are short, so that none leads through a thin part.
    pub fn polish_wgsl() -> String {
        format!(
            "\
// The place along a ray a little before the surface, from one at which it is `near`; `fall` says how fast the distance falls.
fn sf_polish(origin: vec3f, direction: vec3f, start: f32, near: f32, fall: f32, tolerance: f32) -> f32 {{
  let rest = {:?} * tolerance;
  let whole = max(near - rest, 0.0);
  var t = start;
  var value = near - rest;
  var stride = whole / clamp(fall, 0.5, 1.0);
  for (var i = 0; i < {} && abs(value) > {:?} * tolerance && stride != 0.0; i++) {{
    let there = sf_distance(origin + direction * (t + stride)) - rest;
    if abs(there) >= abs(value) {{
      // A ray that only passes by stays where it is nearest.
      if stride <= whole {{
        break;
      }}
      stride = whole;
      continue;
    }}
    let next = clamp(there * stride / (value - there), -tolerance, tolerance);
    t += stride;
    value = there;
    stride = next;
  }}
  return t;
}}
",
            Self::REST,
            Self::LOOKS,
            Self::EXACT
        )
    }

    /// The function `sf_trace`, which calls `sf_clip`, `sf_bound`, `sf_distance`, and `sf_polish`.
    pub fn wgsl(&self) -> String {
        let Self { factor, relaxation, tolerance, budget, polish } = *self;
        let times = if factor == 1.0 { String::new() } else { format!("{factor:?} * ") };
        let relaxed = relaxation > 0.0;
        let mut text = "\
fn sf_trace(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32, footprint: f32) -> sf_Hit {
  let span = sf_clip(origin, direction, t_min, t_max);
  if span.x > span.y {
    return sf_Hit(t_max, false, 0u);
  }
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
        text.push_str("  var free = 0.0;\n  var near = 0.0;\n  var tolerance = 0.0;\n  var step = 1u;\n");
        let half = 0.5 * tolerance;
        let _ = writeln!(
            text,
            "  for (; step <= {budget}u; step++) {{
    let p = origin + direction * t;
    tolerance = max({half:?} * footprint * t, 4e-7 * (length(p + sf_uniforms.origin) + 1.0));
    free = {times}sf_bound(p);"
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
        // What is done at a hit comes after the loop, when the rays beside this one are there too.
        text.push_str(
            "    if free <= tolerance {
      near = sf_distance(p);
      if near <= tolerance {
        break;
      }
    }
    // The end itself is looked at before it counts as a miss.
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
        let _ = writeln!(text, "  }}\n  if step > {budget}u {{\n    return sf_Hit(t, false, {budget}u);\n  }}");
        if !polish {
            text.push_str("  return sf_Hit(t, true, step);\n}\n");
            return text;
        }
        // The bound falls slower than the distance, by the factor in it.
        text.push_str(match relaxed {
            true => "  let fall = (radius - free) / max(stride, tolerance) * near / max(free, 1e-20);\n",
            false => "  let fall = 1.0;\n",
        });
        text.push_str("  return sf_Hit(sf_polish(origin, direction, t, near, fall, tolerance), true, step);\n}\n");
        text
    }
}
