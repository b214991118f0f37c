//! The text of `sf_shadow`: how much of a light's disc is seen along a ray, told by a few rays. Its twin in 64 bits is
//! `compiler/src/reference/shadow.rs`.
//!
//! A light of softness k is a disc under the half-angle atan(1/k). One ray goes to its middle. Where that is free, what it passes most narrowly
//! is taken for a straight edge, at the least angle between ray and surface: the share of a disc beside an edge is a formula. Where it is not free, four
//! more go to places near the disc's rim, and tell in the same way how much is seen there. So a shadow has both halves of its penumbra, and only rays
//! within it cost more.
//!
//! An estimate of the distance may be less than the distance: a face that an intersection cuts away still counts in its formula. Where a scene has
//! such ([`Ways::loose`]), the narrowest passage of a ray counts if the surface is where the estimate and the gradient say; else the four rays tell.

use super::tracer::Ways;

/// How far from the middle of a disc of radius one the four rays aim.
pub const RIM: f64 = 0.9;

/// A passage of less than this part of the half-angle is none: the ray ends. That of the ray to the middle, and of the others.
pub const MET: f64 = 0.04;
pub const MET_ASIDE: f64 = 0.1;

/// Looks of a ray that goes aside; where they are spent it counts as dark.
pub const MOST_ASIDE: u32 = 64;

/// The slope of an estimate is found over so large a part of it.
pub const STEP: f64 = 0.05;

/// A surface is where an estimate says if there no more than this part of the estimate is left.
pub const LEFT: f64 = 0.2;

/// What is so far behind a light counts as so many times as much farther from the ray.
pub const BEHIND: f64 = 4.0;

/// How the share of a disc on one side of a line grows with its distance a from the middle: a (c₀ + a² (c₁ + c₂ a²)), from a half.
pub const SHARE: [f64; 3] = [0.6365, -0.1016, -0.0349];

/// The function `sf_shadow` and what it calls.
pub fn text(ways: Ways) -> String {
    let passage = if ways.one { passage_of_one(ways.lamps) } else { passage(ways.lamps) };
    let passage = passage + &end(ways);
    let span = "sf_clip(origin, direction, t_min, t_max)";
    let beside = if ways.region { "  span = sf_beside(origin, direction, span, sharpness);\n" } else { "" };
    let planes = "  let plane = span.x + sf_ahead(origin + direction * span.x, direction);
  let blocked = plane <= span.y;
  // A plane is passed most narrowly at the ray's end.
  let passed = min(1.0, sharpness * sf_planes(origin + direction * span.y) / max(span.y, 1e-6 * UNIT));
  lit = select(select(passed, 1.0, span.x > span.y), 0.0, blocked);\n";
    let planes = if ways.planes { planes } else { "" };
    // The bound is the distance.
    let passage = if ways.one { passage.replace("sf_distance(", "sf_bound(") } else { passage };
    let passage = match ways.planes {
        true => passage.replace("sf_bound(", "sf_rest_bound(").replace("sf_distance(", "sf_rest_distance("),
        false => passage,
    };
    let passage: String = match ways.loose {
        true => passage,
        // Where it passes most narrowly is of no use.
        false => passage.split_inclusive('\n').filter(|line| !line.contains("nearest")).collect(),
    };
    // What a plane hides ends at it.
    let passage = passage.replace("BEGIN", if ways.planes { "select(span.x, plane, blocked)" } else { "span.x" });
    let quarters = match ways.loose {
        true => "max(seen, select(0.0, dot(vec4f(0.25), select(vec4f(0.0), vec4f(1.0), around > vec4f(0.0))), middle < 0.0))",
        false => "seen",
    };
    let quarters_say = if ways.loose { "  // What seems to hide a part of it is not there: each of the others that sees is a quarter.\n" } else { "" };
    format!(
        "\
fn sf_shadow(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32, softness: f32) -> f32 {{
  let sharpness = select(1e18, softness, softness > 0.0);
  let rim = {RIM:?} / sharpness;
  let stretch = sqrt(1.0 + rim * rim);
  var aside = vec3f(0.0);
  var middle = 0.0;
  var around = vec4f(0.0);
  var deeper = 0.0;
  var hidden = softness <= 0.0;
  // The ray to the middle; a look behind what it meets; the others.
  for (var turn = 0u; (turn < 6u) & (middle <= 0.0) & ((turn == 0u) | !hidden); turn++) {{
    let longer = select(1.0, stretch, turn > 1u);
    let least = select({MET:?}, {MET_ASIDE:?}, turn > 1u);
    let most = select(select(288u, {MOST_ASIDE}u, turn > 1u), 1u, turn == 1u);
    let passed = sf_passage(origin, (direction + aside) / longer, select(t_min, deeper, turn == 1u), t_max * longer, sharpness, least, most);
    middle = select(middle, passed.lit, turn == 0u);
    // What fills the cone hides all of the light.
    let wide = 1.1 * passed.t / sharpness;
    deeper = passed.t + wide;
    hidden = hidden | ((turn == 1u) & (passed.free <= -wide));
    around = vec4f(around.yzw, passed.lit);
    aside = select(select(cross(direction, aside), rim * sf_across(direction), turn == 1u), vec3f(0.0), turn == 0u);
  }}
  // Of two places that face each other the one that sees more, and the other. Where one of each pair sees, both tell how far off an edge is;
  // where both of a pair do, what hides the middle is narrow.
  let more = max(around.xy, around.zw);
  let both = vec4f(more, min(around.xy, around.zw));
  let sides = select(vec4f(0.0), sf_shares(both - {RIM:?}), both > vec4f(0.0));
  let apart = more.x - more.y;
  let edge = 0.5 * (more.x + more.y - sqrt(max({:?} - apart * apart, 0.0)));
  let best = select(max(more.x, more.y) - {RIM:?}, edge, min(more.x, more.y) > 0.0);
  let seen = sf_shares(vec4f(select(min(best, 0.0), middle, middle > 0.0))).x;
{quarters_say}  let some = select(0.0, max({quarters}, min(max(sides.x + sides.z, sides.y + sides.w), 1.0)), (max(more.x, more.y) > 0.0) & !hidden);
  return select(some, seen, middle > 0.0);
}}

// The share of a disc of radius one on one side of a straight line, which is so far from its middle: (a √(1 - a²) + asin a) / π + 1/2, to within 0.004.
fn sf_shares(a: vec4f) -> vec4f {{
  let b = clamp(a, vec4f(-1.0), vec4f(1.0));
  return 0.5 + b * ({:?} + b * b * ({:?} + {:?} * b * b));
}}

// A direction square to one: Duff et al., Building an Orthonormal Basis, Revisited (2017).
fn sf_across(n: vec3f) -> vec3f {{
  let side = select(-1.0, 1.0, n.z >= 0.0);
  let a = n.x / (side + n.z);
  return vec3f(1.0 - side * n.x * a, -side * n.y * a, -side * n.x);
}}

// How narrowly a ray passes a surface: the angle, in half-angles of the light, at most 1; 0 where the ray meets it. Where the ray ended, and the
// bound there.
struct sf_Passage {{
  lit: f32,
  t: f32,
  free: f32,
}}

fn sf_passage(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32, sharpness: f32, least: f32, most: u32) -> sf_Passage {{
  var span = {span};
  let size = length(COORDINATES) + UNIT;
  var lit = 1.0;
{planes}{beside}{passage}}}
",
        2.0 * RIM * RIM,
        SHARE[0],
        SHARE[1],
        SHARE[2]
    )
}

// As the bound grows along the ray by s, the next look is free / (1 - s) away, where it is as much again: whatever stands beside the ray, outside of
// both spheres, is then no nearer to it between the looks than 0.86 of the smaller one's radius, as between two looks at the same distance without a
// slope. So nothing of a penumbra is lost, and a ray that leaves a plane is gone in half of the looks. Where the bound is less than was to be
// expected, the ray goes back to the end of the first sphere.
//
// Rays that come in flat may need more looks than there are: then they go on by guesses, and are dark where one lies inside.
fn passage_of_one(lamps: bool) -> String {
    let (behind, free, next) = (behind("    let ", lamps), farther("free", lamps), next("    ", lamps));
    format!(
        "  var t = BEGIN;
  // The last sphere known to be empty, and the step from its centre.
  var radius = 1e18;
  var stride = 1.0;
  var seen = t;
  var free = 0.0;
  var nearest = -1.0;
  for (var step = 0u; (step < most) & (t <= span.y) & (lit >= least); step++) {{
    let tolerance = 2e-6 * (size + t);
    free = sf_bound(origin + direction * t);
    // Out of looks it goes on by guesses, until one is inside.
    let spent = step >= 256u;
{behind}    let share = sharpness * {free} / max(t, tolerance);
    nearest = select(nearest, t, share < lit);
    lit = select(min(lit, share), 0.0, free <= select(tolerance, 0.0, spent));
{next}    let back = (stride > radius) & (free < 0.75 * stride);
    seen = t;
    t = select(select(next, t + radius - stride, back), t + max(free, 2e-3 * (size + t)), spent);
    stride = select(next - seen, radius, back);
    radius = select(free, radius, back);
  }}
"
    )
}

// The same with a distance of its own, which is looked at where the bound says that it can matter: outside of the loop over bounds, as in
// `Tracer::text`.
fn passage(lamps: bool) -> String {
    let (declared, behind) = (if lamps { "    var behind = 0.0;\n" } else { "" }, behind("      ", lamps));
    let (distance, next) = (farther("distance", lamps), next("      ", lamps));
    format!(
        "  var t = BEGIN;
  var step = 0u;
  // Where it was looked last, and what was found there.
  var seen = t;
  var free = 0.0;
  var tolerance = 0.0;
  // The last sphere known to be empty, and the step from its centre.
  var radius = 1e18;
  var stride = 1.0;
  var nearest = -1.0;
  while (step < most) & (t <= span.y) & (lit >= least) {{
    var near = false;
{declared}    while (step < most) & (t <= span.y) & !near {{
      tolerance = 2e-6 * (size + t);
      free = sf_bound(origin + direction * t);
{behind}      near = (free <= tolerance) | (sharpness * free < lit * max(t, tolerance)) | (step >= 256u);
{next}      let back = (stride > radius) & (free < 0.75 * stride);
      seen = t;
      t = select(next, t + radius - stride, back);
      stride = select(next - seen, radius, back);
      radius = select(free, radius, back);
      step += 1u;
    }}
    if near {{
      let distance = sf_distance(origin + direction * seen);
      let share = sharpness * {distance} / max(seen, tolerance);
      nearest = select(nearest, seen, share < lit);
      // Out of looks it goes on by guesses, until one is inside.
      let spent = step > 256u;
      // Where the bound is much less, between two looks so near to each other it is hardly less.
      let nearer = !spent & (t > seen) & (share < 1.25 * lit) & (distance > 1.5 * free);
      stride = select(stride, min(stride, max(0.4 * distance, tolerance)), nearer);
      t = select(select(t, seen + stride, nearer), seen + max(distance, 2e-3 * (size + seen)), spent);
      lit = select(min(lit, share), 0.0, free <= select(tolerance, 0.0, spent));
    }}
  }}
"
    )
}

// How far behind the light is what the last step came nearer to. Of a light without a place nothing is.
fn behind(indent: &str, lamps: bool) -> String {
    let comment = indent.trim_end_matches("let ");
    match lamps {
        true => format!(
            "{comment}// What the slope over the last step says to be behind the light hides less of it.
{indent}behind = max(free * (radius - free) / stride - (t_max - t), 0.0);\n"
        ),
        false => String::new(),
    }
}

// A distance, larger where it is of something behind the light.
fn farther(distance: &str, lamps: bool) -> String {
    if lamps { format!("({distance} + {BEHIND:?} * behind)") } else { distance.to_owned() }
}

// Where to look next.
fn next(indent: &str, lamps: bool) -> String {
    let by_slope = "// On by the slope over the last step, but not beyond the end without a look at it; or back.";
    let on = "let on = free * stride / clamp(stride + radius - free, 0.25 * stride, stride);";
    match lamps {
        true => format!(
            "{indent}{by_slope} A light near which something can be is
{indent}// looked at, and half of its radius and the whole before it.
{indent}{on}
{indent}let left = (t_max - t) * sharpness / t_max;
{indent}let stop = t_max * (1.0 - 0.5 * clamp(ceil(2.0 * left - 0.01) - 1.0, 0.0, 2.0) / sharpness);
{indent}let lamp = (t < t_max) & (free * sharpness / t_max - left < lit);
{indent}let next = max(select(t + free, min(t + free, stop), lamp), min(t + on, select(span.y, min(span.y, stop), lamp)));\n"
        ),
        false => format!("{indent}{by_slope}\n{indent}{on}\n{indent}let next = max(t + free, min(t + on, span.y));\n"),
    }
}

// What comes of a passage. Where it may be of a face that is not there: whether the surface is where the narrowest look says.
fn end(ways: Ways) -> String {
    let mut text = "  lit = select(lit, 0.0, (lit < least) | ((most < 288u) & (t <= span.y)));\n".to_owned();
    if ways.loose {
        let plane = if ways.planes { " | (sf_planes(at) <= lit * nearest / sharpness)" } else { "" };
        text += &format!(
            "  let at = origin + direction * nearest;
  var known = (lit <= 0.0) | (nearest < 0.0){plane};
  var beside = vec3f(0.0);
  var slope = vec3f(0.0);
  var distance = 0.0;
  // The estimate there, how it changes along each axis, and what is left of it at the place of which it tells.
  for (var look = 0u; (look < 5u) & !known; look++) {{
    let found = sf_distance(at + beside);
    slope += select(vec3f(0.0), vec3f(found - distance), vec3u(1u, 2u, 3u) == vec3u(look));
    distance = select(distance, found, look == 0u);
    let foot = -slope * (distance / max(length(slope), 1e-12));
    let axis = select(vec3f(0.0), vec3f({STEP:?} * distance), vec3u(0u, 1u, 2u) == vec3u(look));
    known = (look == 4u) & (found <= {LEFT:?} * distance) & (dot(at + beside - origin, direction) > 0.0);
    beside = select(axis, foot, look == 3u);
  }}
  lit = select(select(1.0, -1.0, most == 288u), lit, known);\n"
        );
    }
    text + "  return sf_Passage(lit, seen, free);\n"
}
