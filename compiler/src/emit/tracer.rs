//! The function that follows a ray: its text, with each of its parts by a number that can be changed or switched off.

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
    /// Near a surface a ray goes straight to where the line through its last two looks is zero (but for what rounding may be), if that is at
    /// most so many widths of a pixel ahead. There must be the surface, else it goes back; and the hit is where the line is zero then. 0
    /// leaves both away: the hit is where the ray stopped.
    pub leap: f64,
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
    pub const DEFAULT: Self = Self { factor: 1.0, relaxation: 0.3, tolerance: 1.0 / 128.0, leap: 2.0, budget: 1024 };
    /// By how much the tolerance has grown when the budget is spent, in widths of a pixel.
    pub const TIRED: f64 = 0.5;
    /// The slope at which a step is longest.
    pub const STEEPEST: f64 = 0.75;
    /// A ray leaps where the bound is at most so many widths of a pixel. What stands in the gap that a leap leaves unproven is that near.
    pub const NEAR: f64 = 0.25;
    /// A ray leaps where the bound fell so evenly over the last two steps that, as they differ, it would land at most this share of the
    /// tolerance beside the surface.
    pub const EVEN: f64 = 0.25;
    /// A leap falls short of the line's zero by so many times what the bound would fall more on its way if it fell faster as over the last two
    /// steps, so that it ends outside.
    pub const FASTER: f64 = 2.0;
    /// No hit is further from where the ray stopped, in widths of a pixel.
    pub const ASIDE: f64 = 0.4;
    /// The bound counts as falling at least so fast along a ray, so that what is ahead is finite.
    pub const FLATTEST: f64 = 1e-4;

    /// The function `sf_trace`, which calls `sf_clip`, `sf_bound` and, unless that is the bound itself (`one`), `sf_distance`. The distance
    /// is asked for outside of the loop over bounds: a machine that leads several rays in step computes what stands inside for all of them.
    pub fn wgsl(&self, one: bool) -> String {
        let Self { factor, relaxation, tolerance, leap, budget } = *self;
        let (steepest, near, even, faster) = (Self::STEEPEST, Self::NEAR, Self::EVEN, Self::FASTER);
        let (aside, flattest) = (Self::ASIDE, Self::FLATTEST);
        let times = if factor == 1.0 { String::new() } else { format!("{factor:?} * ") };
        let tired = Self::TIRED / f64::from(budget);
        let leaps = leap > 0.0;
        // The lines of the loop, further in where a loop stands around it.
        let mut lines: Vec<String> = Vec::new();
        let mut line = |text: &str| lines.push(text.to_owned());
        line("if back {");
        line("  // A gap between two spheres may hold a surface: back to the end of the first.");
        line("  t += radius - stride;");
        line("  stride = radius;");
        line("  slope = -1.0;");
        if leaps {
            line("  leapt = false;");
        }
        line("} else {");
        line(&format!("  slope = clamp(mix(slope, change, {relaxation:?}), -1.0, {steepest:?});"));
        line("  radius = max(free, 0.5 * tolerance);");
        line("  stride = radius * 2.0 / (1.0 - slope);");
        if leaps {
            line("  // As the bound falls faster and faster, the surface is nearer than the line says.");
            line(&format!("  let leap = ahead * (1.0 - {faster:?} * max(before - change, 0.0) / max(-change, {flattest:?}));"));
            line(&format!("  let close = ahead <= {leap:?} * pixel && free <= {near:?} * pixel;"));
            line(&format!("  leapt = leap > stride && close && abs(change - before) * ahead <= {even:?} * tolerance;"));
            line("  before = change;");
            line("  stride = select(stride, leap, leapt);");
        }
        line("  stride = min(stride, span.y - t);");
        line("  t += stride;");
        line("}");
        line("step += 1u;");
        line("let p = origin + direction * t;");
        line("let rounding = 4e-7 * (size + t);");
        line("pixel = footprint * t;");
        line(&format!("tolerance = max(({tolerance:?} + {tired:?} * f32(step)) * pixel, rounding);"));
        line(&format!("free = {times}sf_bound(p);"));
        line("change = -1.0;");
        line("if stride > 0.0 {");
        line("  change = (free - radius) / stride;");
        line("}");
        line("back = stride > max(radius, radius + free);");
        if leaps {
            line("// How far it is to where the bound is all but zero, if it goes on as it did: on the surface itself a gradient may vanish.");
            line(&format!("ahead = (free - rounding) / max(-change, {flattest:?});"));
            line("arrived = free <= tolerance && (!back || (leapt && free >= 0.0));");
        } else {
            line("arrived = free <= tolerance && !back;");
        }
        line("// The end itself is looked at before it counts as a miss.");
        line(&format!("if step >= {budget}u || arrived || (!back && t >= span.y) {{"));
        line("  break;");
        line("}");
        let indent = if one { "  " } else { "    " };
        let looped: String = lines.iter().map(|l| format!("{indent}  {l}\n")).collect();
        let end = match leaps {
            true => format!("clamp(t + clamp(ahead, -{aside:?} * pixel, {aside:?} * pixel), span.x, span.y)"),
            false => "t".to_owned(),
        };
        let state = match leaps {
            true => "  // How the bound changed over the step before, how far the surface seems to be, and whether the last step was a leap to it.
  var before = -1.0;
  var ahead = 0.0;
  var leapt = false;\n",
            false => "",
        };
        let search = match one {
            true => format!("  loop {{\n{looped}  }}\n  if arrived {{\n    return sf_Hit({end}, true, step);\n  }}\n"),
            false => format!(
                "  while step < {budget}u {{
    loop {{
{looped}    }}
    if arrived {{
      if sf_distance(origin + direction * t) <= tolerance {{
        return sf_Hit({end}, true, step);
      }}
    }}
    if !back && t >= span.y {{
      break;
    }}
  }}\n"
            ),
        };
        format!(
            "\
fn sf_trace(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32, footprint: f32) -> sf_Hit {{
  let span = sf_clip(origin, direction, t_min, t_max);
  if span.x > span.y {{
    return sf_Hit(t_max, false, 0u);
  }}
  // Rounding grows with coordinates, and they are no larger than this and the way.
  let size = length(origin + sf_uniforms.origin) + 1.0;
  var t = span.x;
  var step = 0u;
  var free = 0.0;
  var tolerance = 0.0;
  var pixel = 0.0;
  var arrived = false;
  // The last sphere known to be empty, the step from its centre, how the bound changed over it, how it changes along the ray as far as that is
  // learnt, and whether the ray must go back.
  var radius = 0.0;
  var stride = 0.0;
  var change = -1.0;
  var slope = -1.0;
  var back = false;
{state}{search}  return sf_Hit(t, false, step);
}}
"
        )
    }
}
