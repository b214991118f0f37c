//! The function that follows a ray: its text, with each of its parts by a number that can be changed or switched off.

use crate::emit::rounding::with_rounding;
use crate::interface::Rounding;

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
    /// A ray goes straight to where the line through its last two looks is zero (but for what rounding may be), if at most so many widths of
    /// a pixel on its way are then proven empty by neither look. There must be the surface, else it goes back; and the hit is where the line is
    /// zero then, looked at once more where that is not [`Tracer::FINE`]. 0 leaves all this away: the hit is where the ray stopped.
    pub leap: f64,
    /// Looks at most.
    pub budget: u32,
}

/// What a ray is told of a scene beside its bound.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ways {
    /// Whether the bound is the estimate of the distance: of the whole scene, or where planes are met apart of everything else.
    pub one: bool,
    /// Whether planes are met apart: `sf_ahead` says where, and `sf_rest_bound` is followed.
    pub planes: bool,
    /// Whether `sf_within` knows a box about all that is solid, but planes that are met apart.
    pub region: bool,
    /// Whether the estimate of the distance may be much less than it: beside a face that an intersection cuts away, or where it is the field over its
    /// gradient.
    pub loose: bool,
    /// Whether a light has a place: a shadow's ray may end near something.
    pub lamps: bool,
}

impl Default for Tracer {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Tracer {
    /// What modules hold.
    pub const DEFAULT: Self = Self { factor: 1.0, relaxation: 0.3, tolerance: 1.0 / 128.0, leap: 0.5, budget: 1024 };
    /// By how much the tolerance has grown when the budget is spent, in widths of a pixel. It grows by the square of the looks: those that
    /// most rays take leave it as it is.
    pub const TIRED: f64 = 0.5;
    /// The slope at which a step is longest.
    pub const STEEPEST: f64 = 0.75;
    /// A ray leaps where the bound fell so evenly over the last two steps that, as they differ, it would land at most this share of the
    /// tolerance beside the surface.
    pub const EVEN: f64 = 0.0625;
    /// A leap falls short of the line's zero by so many times what the bound would fall more on its way if it fell faster as over the last two
    /// steps, so that it ends outside.
    pub const FASTER: f64 = 4.0;
    /// No hit is further from where the ray stopped, in widths of a pixel.
    pub const ASIDE: f64 = 0.4;
    /// Where the line's zero is further than this from where the ray stopped, in widths of a pixel, the ray looks there, and the hit is where
    /// the line through that look is zero: the first line may come from a look far away, and a normal turns fast on what is small.
    pub const FINE: f64 = 1.0 / 64.0;
    /// The bound counts as falling at least so fast along a ray, so that what is ahead is finite.
    pub const FLATTEST: f64 = 1e-4;

    /// The function `sf_trace` for a scene with these ways, whose module rounds so.
    pub fn wgsl(&self, ways: Ways, rounding: Rounding) -> String {
        with_rounding(&self.text(ways), rounding)
    }

    /// The function `sf_trace`, which calls `sf_clip`, `sf_bound` and, unless that is the bound itself, `sf_distance`. The distance
    /// is asked for outside of the loop over bounds, and hits are found there: a machine that leads several rays in step computes what stands
    /// inside for all of them. For the same reason little goes from one turn of the loop to the next, and nothing is computed under a condition.
    ///
    /// That a ray has hit is set where it leaves, though `arrived` says the same: llvmpipe (Mesa 22.3) goes on computing what stands in the
    /// inner loop for rays that have left the outer one, where `t` is that of the hit by then, and whatever both ends of the outer loop would
    /// return as it stands comes from there. A ray missed what it had met, because its neighbours looked on.
    pub(super) fn text(&self, ways: Ways) -> String {
        let Self { leap, budget, .. } = *self;
        let Ways { one, planes, region, .. } = ways;
        let (aside, fine) = (Self::ASIDE, Self::FINE);
        let indented = |lines: &[String], by: &str| -> String { lines.iter().map(|l| format!("{by}{l}\n")).collect() };
        let (look, go_on) = (self.look(one), self.go_on());
        let (mut state, mut sure, mut hit) = ("", "false", vec!["hit = true;".to_owned(), "break;".to_owned()]);
        if leap > 0.0 {
            state = "  // How the bound changed over the step before, how far the surface seems to be, whether the last step was a leap to it, and whether
  // it was the last of all.
  var before = -1.0;
  var ahead = 0.0;
  var leapt = false;
  var last = false;\n";
            sure = "last";
            hit = vec![
                format!("let most = select({aside:?} * pixel, abs(stride), last);"),
                "let on = clamp(t + clamp(ahead, -min(most, abs(stride)), most), span.x, span.y) - t;".to_owned(),
                "t += on;".to_owned(),
                format!("if last | (step >= {budget}u) | (abs(on) <= {fine:?} * pixel) {{"),
                "  hit = true;".to_owned(),
                "  break;".to_owned(),
                "}".to_owned(),
                "// The line may come from a look far away: one more, where it says.".to_owned(),
                "last = true;".to_owned(),
                "stride = on;".to_owned(),
                "seen = free;".to_owned(),
            ];
        }
        let (more, arrival) = if one {
            ("", "    if !arrived {\n      break;\n    }\n".to_owned() + &indented(&hit, "    "))
        } else {
            let end = format!("      if (step >= {budget}u) | (!gap & (t >= span.y)) {{\n        break;\n      }}\n");
            let asked = if leap > 0.0 { "arrived & !last" } else { "arrived" };
            let near = format!("    var near = {sure};\n    if {asked} {{\n      near = sf_distance(origin + direction * t) <= tolerance;\n    }}\n");
            let more = "  var change = -1.0;\n  var fall = 1.0;\n  var gap = false;\n  var tolerance = 0.0;\n";
            (more, format!("{near}    if near {{\n{}    }} else {{\n{end}{}    }}\n", indented(&hit, "      "), indented(&go_on, "      ")))
        };
        let search = format!(
            "  // What the last look found.
  var arrived = false;
  var free = 0.0;
  var pixel = 0.0;
{more}  loop {{
    loop {{
{}      // The end itself is looked at before it counts as a miss.
      if (step >= {budget}u) | arrived | (!gap & (t >= span.y)) {{
        break;
      }}
{}    }}
{arrival}  }}\n",
            indented(&look, "      "),
            indented(&go_on, "      "),
        );
        let clip = "sf_clip(origin, direction, t_min, t_max)";
        let missed = "  return sf_Hit(select(t, t_max, !hit & (t >= span.y)), hit, step);\n";
        let (head, end) = match (planes, region) {
            (false, false) => (format!("  let span = {clip};\n"), missed.to_owned()),
            (false, true) => (format!("  let span = sf_within(origin, direction, {clip});\n"), missed.to_owned()),
            (true, _) => {
                let span = "vec2f(whole.x, min(whole.y, plane))";
                let span = if region { format!("sf_within(origin, direction, {span})") } else { span.to_owned() };
                let head = format!(
                    "  let whole = {clip};\n  // The first plane ends the search for everything else.
  let plane = whole.x + sf_ahead(origin + direction * whole.x, direction);
  let flat = plane <= whole.y;
  let span = {span};\n"
                );
                let end = "  let passed = !hit & (t >= span.y);\n  return sf_Hit(select(t, select(t_max, plane, flat), passed), hit | (passed & flat), step);\n";
                (head, end.to_owned())
            }
        };
        let text = format!(
            "\
fn sf_trace(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32, footprint: f32) -> sf_Hit {{
{head}  // Rounding grows with coordinates, and they are no larger than this and the way.
  let size = length(COORDINATES) + UNIT;
  var t = span.x;
  var step = 0u;
  var hit = false;
  // The last sphere known to be empty, the bound at its centre, the step from there, and how the bound changes along the ray as far as that
  // is learnt.
  var radius = 0.0;
  var seen = 0.0;
  var stride = 0.0;
  var slope = -1.0;
{state}  if span.x <= span.y {{
{}  }}
{end}}}
",
            search.lines().map(|line| format!("  {line}\n")).collect::<String>()
        );
        match planes {
            true => text.replace("sf_bound(", "sf_rest_bound(").replace("sf_distance(", "sf_rest_distance("),
            false => text,
        }
    }

    /// The lines of a look at `t`, which say whether the ray may have arrived. `one`: they name what is asked of it
    /// within the loop alone; else all that they find has its names already.
    fn look(&self, one: bool) -> Vec<String> {
        let Self { factor, tolerance, leap, budget, .. } = *self;
        let flattest = Self::FLATTEST;
        let once = if one { "let " } else { "" };
        let times = if factor == 1.0 { String::new() } else { format!("{factor:?} * ") };
        let tired = Self::TIRED / f64::from(budget).powi(2);
        let mut lines = vec![
            "step += 1u;".to_owned(),
            "let rounding = 4e-7 * (size + t);".to_owned(),
            "pixel = footprint * t;".to_owned(),
            format!("{once}tolerance = max(({tolerance:?} + {tired:?} * f32(step) * f32(step)) * pixel, rounding);"),
            format!("free = {times}sf_bound(origin + direction * t);"),
            format!("{once}change = select(-1.0, (free - seen) / select(stride, 1.0, stride == 0.0), stride != 0.0);"),
            "// A gap between two spheres may hold a surface.".to_owned(),
            format!("{once}gap = stride > max(radius, radius + free);"),
        ];
        if leap > 0.0 {
            lines.extend([
                "// How far it is to where the bound is all but zero, if it goes on as it did: on the surface itself a gradient may vanish.".to_owned(),
                format!("{once}fall = 1.0 / max(-change, {flattest:?});"),
                "ahead = (free - rounding) * fall;".to_owned(),
                "arrived = last | ((free <= tolerance) & (!gap | (leapt & (free >= 0.0))));".to_owned(),
            ]);
        } else {
            lines.push("arrived = (free <= tolerance) & !gap;".to_owned());
        }
        lines
    }

    /// The lines of the step after a look: on, or back to the end of the last sphere where there is a gap.
    fn go_on(&self) -> Vec<String> {
        let Self { relaxation, leap, .. } = *self;
        let (steepest, even, faster) = (Self::STEEPEST, Self::EVEN, Self::FASTER);
        let mut lines = vec![
            format!("let learnt = clamp(mix(slope, change, {relaxation:?}), -1.0, {steepest:?});"),
            "let reach = max(free, 0.5 * tolerance);".to_owned(),
        ];
        if leap > 0.0 {
            lines.extend([
                "let far = reach * 2.0 / (1.0 - learnt);".to_owned(),
                "// As the bound falls faster and faster, the surface is nearer than the line says.".to_owned(),
                format!("let leap = ahead * (1.0 - {faster:?} * max(before - change, 0.0) * fall);"),
                "// What a leap leaves unproven of the ray is no longer than this.".to_owned(),
                format!("let close = ahead - free <= {leap:?} * pixel;"),
                format!("leapt = !gap & (leap > far) & close & (abs(change - before) * ahead <= {even:?} * tolerance);"),
                "let on = min(select(far, leap, leapt), span.y - t);".to_owned(),
                "before = select(change, before, gap);".to_owned(),
            ]);
        } else {
            lines.push("let on = min(reach * 2.0 / (1.0 - learnt), span.y - t);".to_owned());
        }
        lines.extend(
            [
                "// Back to the end of the last sphere where there was a gap.",
                "t += select(on, radius - stride, gap);",
                "stride = select(on, radius, gap);",
                "radius = select(reach, radius, gap);",
                "seen = select(free, seen, gap);",
                "slope = select(learnt, -1.0, gap);",
            ]
            .map(str::to_owned),
        );
        lines
    }
}
