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

    /// The function `sf_trace`, which calls `sf_clip`, `sf_bound` and, unless that is the bound itself (`one`), `sf_distance`. The distance
    /// is asked for outside of the loop over bounds: a machine that leads several rays in step computes what stands inside for all of them.
    pub fn wgsl(&self, one: bool) -> String {
        let Self { factor, relaxation, tolerance, budget } = *self;
        let times = if factor == 1.0 { String::new() } else { format!("{factor:?} * ") };
        let relaxed = relaxation > 0.0;
        let tired = Self::TIRED / f64::from(budget);
        // The lines of the loop, further in where a loop stands around it.
        let mut lines: Vec<String> = Vec::new();
        let mut line = |text: &str| lines.push(text.to_owned());
        if relaxed {
            line("if back {");
            line("  // A gap between two spheres may hold a surface: back to the end of the first.");
            line("  t += radius - stride;");
            line("  stride = radius;");
            line("  slope = -1.0;");
            line("} else {");
            line("  if stride > 0.0 {");
            line(&format!("    slope = clamp(mix(slope, (free - radius) / stride, {relaxation:?}), -1.0, {:?});", Self::STEEPEST));
            line("  }");
            line("  radius = max(free, 0.5 * tolerance);");
            line("  stride = min(radius * 2.0 / (1.0 - slope), span.y - t);");
            line("  t += stride;");
            line("}");
        } else {
            line("t = min(t + max(free, 0.5 * tolerance), span.y);");
        }
        line("step += 1u;");
        line("let p = origin + direction * t;");
        line(&format!("tolerance = max(({tolerance:?} + {tired:?} * f32(step)) * footprint * t, 4e-7 * (size + t));"));
        line(&format!("free = {times}sf_bound(p);"));
        let ends = "free <= tolerance || t >= span.y";
        let arrived = if relaxed { "!back && free <= tolerance" } else { "free <= tolerance" };
        line("// The end itself is looked at before it counts as a miss.");
        if relaxed {
            line("back = stride > radius && stride > radius + free;");
            line(&format!("if step >= {budget}u || (!back && ({ends})) {{"));
        } else {
            line(&format!("if step >= {budget}u || {ends} {{"));
        }
        line("  break;");
        line("}");
        let mut text = "\
fn sf_trace(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32, footprint: f32) -> sf_Hit {
  let span = sf_clip(origin, direction, t_min, t_max);
  if span.x > span.y {
    return sf_Hit(t_max, false, 0u);
  }
  // Rounding grows with coordinates, and they are no larger than this and the way.
  let size = length(origin + sf_uniforms.origin) + 1.0;
  var t = span.x;
  var step = 0u;
  var free = 0.0;
  var tolerance = 0.0;
"
        .to_owned();
        if relaxed {
            text.push_str(
                "  // The last sphere known to be empty, the step from its centre, how the bound changes along the ray, and whether it must go back.
  var radius = 0.0;
  var stride = 0.0;
  var slope = -1.0;
  var back = false;
",
            );
        }
        let indent = if one { "  " } else { "    " };
        let looped: String = lines.iter().map(|l| format!("{indent}  {l}\n")).collect();
        let looped = format!("{indent}loop {{\n{looped}{indent}}}\n");
        let _ = match one {
            true => write!(text, "{looped}  return sf_Hit(t, {arrived}, step);\n}}\n"),
            false => write!(
                text,
                "  while step < {budget}u {{
{looped}    if {arrived} {{
      if sf_distance(origin + direction * t) <= tolerance {{
        return sf_Hit(t, true, step);
      }}
    }}
    if t >= span.y {{
      break;
    }}
  }}
  return sf_Hit(t, false, step);
}}
"
            ),
        };
        text
    }
}
