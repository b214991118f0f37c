//! The WGSL that does not depend on the scene: helpers of the kernel, and the functions that trace, shade and touch.
//!
//! `sf_` stands for the prefix of the module. A helper is emitted where something calls it. The tracing functions stand in
//! `compiler/src/reference` once more, in 64 bits; the two are kept step for step alike.

use crate::emit::rounding::with_rounding;
use crate::emit::shadow;
use crate::emit::tracer::{Tracer, Ways};
use crate::graph::kernel::Op;
use crate::interface::{Export, Rounding};
use std::borrow::Cow;
use std::sync::OnceLock;

/// Text that a module may hold.
pub struct Piece {
    /// Its name after the prefix.
    pub name: &'static str,
    /// The text, ended by a line's end.
    pub text: &'static str,
}

/// What is nearer to zero is not divided by as it is: the quotient might leave the range of 32 bits.
pub const LEAST_DIVISOR: f64 = 9e-31;

/// Helpers, in the order in which they are emitted. The place is the helper's bit in [`Helpers`].
pub const HELPERS: [Piece; 16] = [
    Piece { name: "square", text: "\
fn sf_square(a: f32) -> f32 {
  return a * a;
}
" },
    // The smallest denominators count as zero too: the quotient would leave the range of 32 bits.
    Piece { name: "div", text: "\
// a / b, and 0 where b is 0.
fn sf_div(a: f32, b: f32) -> f32 {
  let none = abs(b) < 1e-28;
  return select(a / select(b, 1.0, none), 0.0, none);
}
" },
    Piece { name: "div_all", text: "\
// a / b, and 0 where b is 0.
fn sf_div_all(a: vec3f, b: f32) -> vec3f {
  let none = abs(b) < 1e-28;
  return select(a / select(b, 1.0, none), vec3f(0.0), none);
}
" },
    Piece { name: "pow", text: "\
// a to the power b; a counts as at least 0, the result as at most 1e30.
fn sf_pow(a: f32, b: f32) -> f32 {
  let power = exp2(min(b * log2(max(a, 1e-37)), 99.65784));
  return select(power, select(0.0, 1.0, b == 0.0), a < 1e-37);
}
" },
    Piece { name: "atan_of", text: "\
// The angle of the point (b, a), and 0 at the origin.
fn sf_atan_of(a: f32, b: f32) -> f32 {
  return atan2(a, select(b, 1.0, (a == 0.0) & (b == 0.0)));
}
" },
    // Its two turns are written out: as a loop in hundreds of inlined copies, Mesa took minutes to unroll it.
    Piece { name: "hash", text: "\
// A number in 0..1 made of four whole numbers, the same on every machine.
fn sf_hash(a: f32, b: f32, c: f32, d: f32) -> f32 {
  let limit = vec4f(2147483520.0);
  var v = bitcast<vec4u>(vec4i(clamp(round(vec4f(a, b, c, d)), -limit, limit)));
  v = v * 1664525u + 1013904223u;
  v.x += v.y * v.w;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  v.w += v.y * v.z;
  v = v ^ (v >> vec4u(16u));
  v.x += v.y * v.w;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  v.w += v.y * v.z;
  v = v ^ (v >> vec4u(16u));
  return f32((v.x ^ v.w) >> 8u) / 16777216.0;
}
" },
    Piece { name: "clip", text: "\
// The part of a ray between t_min and t_max that lies within the extent; empty where x > y.
fn sf_clip(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32) -> vec2f {
  let start = origin + sf_uniforms.origin;
  let middle = -dot(start, direction);
  let nearest = start + direction * middle;
  let rest = sf_extent * sf_extent - dot(nearest, nearest);
  let reach = sqrt(max(rest, 0.0));
  return select(vec2f(max(t_min, middle - reach), min(t_max, middle + reach)), vec2f(1.0, 0.0), rest < 0.0);
}
" },
    // An axis along which a ray hardly moves cuts nothing off between its two sides, and all beyond them.
    Piece { name: "within", text: "\
// The part of a span of a ray that lies within the box about all that is solid, but for planes; empty where x > y.
fn sf_within(origin: vec3f, direction: vec3f, span: vec2f) -> vec2f {
  let start = origin + sf_uniforms.origin;
  let rounding = vec3f(1e-6 * (length(start) + UNIT));
  let moved = select(direction, vec3f(1e-12), abs(direction) < vec3f(1e-12));
  let one = (sf_region_low - rounding - start) / moved;
  let other = (sf_region_high + rounding - start) / moved;
  let enter = min(one, other);
  let leave = max(one, other);
  return vec2f(max(span.x, max(max(enter.x, enter.y), enter.z)), min(span.y, min(min(leave.x, leave.y), leave.z)));
}
" },
    // Nothing on the span is further than the box's farthest corner, so a cone about it is no wider there than the margin.
    Piece { name: "beside", text: "\
// The part of a span of a ray that lies within the same box, or so near to it that what is solid can stand in a cone about the ray.
fn sf_beside(origin: vec3f, direction: vec3f, span: vec2f, sharpness: f32) -> vec2f {
  let start = origin + sf_uniforms.origin;
  let far = length(max(abs(sf_region_low - start), abs(sf_region_high - start)));
  let margin = vec3f(far / sharpness + 1e-6 * (length(start) + UNIT));
  let moved = select(direction, vec3f(1e-12), abs(direction) < vec3f(1e-12));
  let one = (sf_region_low - margin - start) / moved;
  let other = (sf_region_high + margin - start) / moved;
  let enter = min(one, other);
  let leave = max(one, other);
  return vec2f(max(span.x, max(max(enter.x, enter.y), enter.z)), min(span.y, min(min(leave.x, leave.y), leave.z)));
}
" },
    Piece { name: "away", text: "\
// How far the solid of a union is at least, beyond the box about its own; within, 0.
fn sf_away(row: u32, p: vec3f) -> f32 {
  let q = abs(p - sf_table[row].xyz);
  let far = length(max(q - sf_table[row + 1u].xyz, vec3f(0.0)));
  return select(far, 0.0, all(q <= sf_table[row + 2u].xyz));
}
" },
    Piece { name: "span", text: "\
// Where the list of what matters near p begins and ends, of the union whose head stands there: boxes about a center, each twice as wide as
// the one before, are cut into cells, and beyond the last one everything matters.
fn sf_span(head: u32, p: vec3f) -> vec2u {
  let center = vec3f(bitcast<f32>(sf_lists[head + 4u]), bitcast<f32>(sf_lists[head + 5u]), bitcast<f32>(sf_lists[head + 6u]));
  let scale = vec3f(bitcast<f32>(sf_lists[head + 7u]), bitcast<f32>(sf_lists[head + 8u]), bitcast<f32>(sf_lists[head + 9u]));
  let at = (p - center) * scale;
  let far = max(max(abs(at.x), abs(at.y)), abs(at.z));
  // The binary exponent, rounded up.
  let level = ((bitcast<u32>(clamp(far, 1.0, 1e9)) + 8388607u) >> 23u) - 127u;
  if level >= sf_lists[head + 2u] {
    return vec2u(sf_lists[head], sf_lists[head + 1u]);
  }
  var counts = vec3u(sf_lists[head + 10u], sf_lists[head + 11u], sf_lists[head + 12u]);
  var first = sf_lists[head + 3u];
  if level > 0u {
    let outer = sf_lists[head + 13u];
    first += counts.x * counts.y * counts.z + (level - 1u) * outer * outer * outer;
    counts = vec3u(outer);
  }
  let place = max((at * bitcast<f32>((127u - level) << 23u) * 0.5 + 0.5) * vec3f(counts), vec3f(0.0));
  let cell = min(vec3u(place), counts - 1u);
  let index = sf_lists[head + 14u] + 2u * (first + (cell.z * counts.y + cell.y) * counts.x + cell.x);
  return vec2u(sf_lists[index], sf_lists[index + 1u]);
}
" },
    // The twin of `Grid::find` in `sampled/grid.rs`.
    Piece { name: "samples", text: "\
// The samples about a point of a grid, x first: those of the lower z and those of the higher; where between them it lies, from 0 to 1; and one over
// their distance. Beyond the grid's box its nearest place counts.
struct sf_Samples {
  low: vec4f,
  high: vec4f,
  at: vec3f,
  scale: f32,
}

fn sf_samples(grid: f32, p: vec3f) -> sf_Samples {
  let head = sf_grid_head(grid);
  let origin = vec3f(bitcast<f32>(sf_lists[head]), bitcast<f32>(sf_lists[head + 1u]), bitcast<f32>(sf_lists[head + 2u]));
  let bricks = vec3u(sf_lists[head + 4u], sf_lists[head + 5u], sf_lists[head + 6u]);
  var scale = bitcast<f32>(sf_lists[head + 3u]);
  let cells = clamp((p - origin) * scale, vec3f(0.0), vec3f(bricks) * 8.0);
  let cell = min(vec3u(cells), bricks * 8u - 1u);
  let brick = cell >> vec3u(3u);
  let fine = sf_lists[sf_lists[head + 8u] + (brick.z * bricks.y + brick.y) * bricks.x + brick.x];
  // A brick without samples of its own is one cell.
  var row = bricks.x + 1u;
  var layer = row * (bricks.y + 1u);
  var first = sf_lists[head + 7u] + brick.z * layer + brick.y * row + brick.x;
  var at = cells * 0.125 - vec3f(brick);
  if fine == 0u {
    scale *= 0.125;
  } else {
    row = 9u;
    layer = 81u;
    let inner = cell & vec3u(7u);
    first = sf_lists[head + 9u] + (fine - 1u) * 729u + inner.z * layer + inner.y * row + inner.x;
    at = cells - vec3f(cell);
  }
  let next = first + layer;
  let low = vec4u(sf_lists[first], sf_lists[first + 1u], sf_lists[first + row], sf_lists[first + row + 1u]);
  let high = vec4u(sf_lists[next], sf_lists[next + 1u], sf_lists[next + row], sf_lists[next + row + 1u]);
  return sf_Samples(bitcast<vec4f>(low), bitcast<vec4f>(high), at, scale);
}
" },
    Piece { name: "sampled", text: "\
// The value of a grid at a point.
fn sf_sampled(grid: f32, x: f32, y: f32, z: f32) -> f32 {
  let s = sf_samples(grid, vec3f(x, y, z));
  let plane = mix(s.low, s.high, s.at.z);
  let line = mix(plane.xy, plane.zw, s.at.y);
  return mix(line.x, line.y, s.at.x);
}
" },
    Piece { name: "sampled_slope", text: "\
// How fast it changes along each axis, within a cell.
fn sf_sampled_slope(grid: f32, x: f32, y: f32, z: f32) -> vec3f {
  let s = sf_samples(grid, vec3f(x, y, z));
  let plane = mix(s.low, s.high, s.at.z);
  let line = mix(plane.xy, plane.zw, s.at.y);
  let up = plane.zw - plane.xy;
  let deep = s.high - s.low;
  let across = mix(deep.xy, deep.zw, s.at.y);
  return s.scale * vec3f(line.y - line.x, mix(up.x, up.y, s.at.x), mix(across.x, across.y, s.at.x));
}
" },
    // The twin of `Outline::at` and `Curve::nearest` in `outline/`.
    Piece { name: "outlined", text: "\
// The signed distance to an outline, and how it changes along x and y. A piece of the outline is a curve a + 2 b t + c t².
fn sf_outlined(outline: f32, x: f32, y: f32) -> vec3f {
  let head = sf_outline_head(outline);
  let low = vec2f(bitcast<f32>(sf_lists[head]), bitcast<f32>(sf_lists[head + 1u]));
  let high = vec2f(bitcast<f32>(sf_lists[head + 2u]), bitcast<f32>(sf_lists[head + 3u]));
  let counts = vec2u(sf_lists[head + 5u], sf_lists[head + 6u]);
  let q = clamp(vec2f(x, y), low, high);
  let cell = min(vec2u((q - low) * bitcast<f32>(sf_lists[head + 4u])), counts - 1u);
  let first = sf_lists[head + 8u] + sf_lists[sf_lists[head + 7u] + cell.y * counts.x + cell.x];
  let end = first + sf_lists[first];
  let places = sf_lists[head + 9u];
  var best = 1e30;
  var away = vec2f(1.0, 0.0);
  var along = vec2f(0.0, 1.0);
  // Where the direction of the joint stands if an end of a piece is nearest.
  var joint = 0u;
  for (var i = first; i < end; i += 1u) {
    // Pieces that follow each other.
    let run = sf_lists[i + 1u];
    let begin = places + 6u * (run >> 8u);
    let stop = begin + 6u * (run & 255u);
    var start = vec2f(bitcast<f32>(sf_lists[begin]), bitcast<f32>(sf_lists[begin + 1u])) - q;
    for (var at = begin; at < stop; at += 6u) {
      let middle = vec2f(bitcast<f32>(sf_lists[at + 2u]), bitcast<f32>(sf_lists[at + 3u])) - q;
      let last = vec2f(bitcast<f32>(sf_lists[at + 6u]), bitcast<f32>(sf_lists[at + 7u])) - q;
      let b = middle - start;
      let c = last - middle - b;
      let chord = last - start;
      var t = clamp(-dot(start, chord) / max(dot(chord, chord), 1e-30), 0.0, 1.0);
      for (var round = 0u; round < 3u; round += 1u) {
        let r = start + (2.0 * b + c * t) * t;
        let d = b + c * t;
        let speed = dot(d, d);
        // Near the centre of curvature the way hardly changes.
        let slope = max(max(2.0 * speed + dot(r, c), 0.25 * speed), 1e-30);
        t = clamp(t - dot(r, d) / slope, 0.0, 1.0);
      }
      var to = start + (2.0 * b + c * t) * t;
      var squared = dot(to, to);
      if dot(start, start) < squared {
        t = 0.0;
        to = start;
        squared = dot(start, start);
      }
      if dot(last, last) < squared {
        t = 1.0;
        to = last;
        squared = dot(last, last);
      }
      if squared < best {
        best = squared;
        away = -to;
        along = b + c * t;
        joint = select(select(0u, at + 10u, t > 0.99999), at + 4u, t < 1e-5);
      }
      start = last;
    }
  }
  if joint != 0u {
    along = vec2f(bitcast<f32>(sf_lists[joint]), bitcast<f32>(sf_lists[joint + 1u]));
  }
  let way = sqrt(best);
  let side = select(1.0, -1.0, along.x * away.y > along.y * away.x);
  // On the outline itself, straight out of the fill.
  let out = vec2f(along.y, -along.x) / max(length(along), 1e-30);
  let gradient = select(out, away * (side / max(way, 1e-30)), way > 1e-12);
  // Beyond the cells, a right angle at their wall.
  let beyond = vec2f(x, y) - q;
  if all(beyond == vec2f(0.0)) {
    return vec3f(side * way, gradient);
  }
  let value = length(vec3f(way, beyond));
  let least = vec2f(bitcast<f32>(sf_lists[head + 10u]), bitcast<f32>(sf_lists[head + 11u]));
  let to_region = vec2f(x, y) - clamp(vec2f(x, y), least, vec2f(bitcast<f32>(sf_lists[head + 12u]), bitcast<f32>(sf_lists[head + 13u])));
  let region = length(to_region);
  if region > value {
    return vec3f(region, to_region / region);
  }
  return vec3f(value, (select(vec2f(0.0), gradient * (side * way), beyond == vec2f(0.0)) + beyond) / value);
}
" },
    // The twins of `Bow::away`, `Face::away` and `Figure::at` in `figure/`.
    Piece { name: "figured", text: "\
// From the nearest place of a straight piece or an arc to a point. It is given by its middle, the directions away from the centre and along it, one over the radius, its end
// about the middle, and sine and cosine of half of its angle.
fn sf_bow(at: u32, p: vec3f) -> vec3f {
  let off = p - vec3f(bitcast<f32>(sf_lists[at]), bitcast<f32>(sf_lists[at + 1u]), bitcast<f32>(sf_lists[at + 2u]));
  let out = vec3f(bitcast<f32>(sf_lists[at + 3u]), bitcast<f32>(sf_lists[at + 4u]), bitcast<f32>(sf_lists[at + 5u]));
  let forth = vec3f(bitcast<f32>(sf_lists[at + 6u]), bitcast<f32>(sf_lists[at + 7u]), bitcast<f32>(sf_lists[at + 8u]));
  let bend = bitcast<f32>(sf_lists[at + 9u]);
  let across = cross(out, forth);
  let x = dot(off, out);
  let y = dot(off, forth);
  let z = dot(off, across);
  let past = vec2f(x - bitcast<f32>(sf_lists[at + 10u]), abs(y) - bitcast<f32>(sf_lists[at + 11u]));
  if past.y * bitcast<f32>(sf_lists[at + 13u]) - past.x * bitcast<f32>(sf_lists[at + 12u]) > 0.0 {
    return out * past.x + forth * select(past.y, -past.y, y < 0.0) + across * z;
  }
  // How much farther from the centre than the circle.
  let rise = bend * (x * x + y * y) + 2.0 * x;
  let from_centre = sqrt(max(1.0 + bend * rise, 0.0));
  let beyond = rise / (1.0 + from_centre);
  let to = select(vec2f(1.0, 0.0), vec2f(1.0 + bend * x, bend * y) / max(from_centre, 1e-12), from_centre > 1e-12);
  return out * (beyond * to.x) + forth * (beyond * to.y) + across * z;
}

// From the nearest place of a triangle to a point, and where the direction stands that is out there; of its inside, none.
fn sf_face(at: u32, p: vec3f) -> vec4f {
  let a = vec3f(bitcast<f32>(sf_lists[at]), bitcast<f32>(sf_lists[at + 1u]), bitcast<f32>(sf_lists[at + 2u]));
  let ab = vec3f(bitcast<f32>(sf_lists[at + 3u]), bitcast<f32>(sf_lists[at + 4u]), bitcast<f32>(sf_lists[at + 5u])) - a;
  let ac = vec3f(bitcast<f32>(sf_lists[at + 6u]), bitcast<f32>(sf_lists[at + 7u]), bitcast<f32>(sf_lists[at + 8u])) - a;
  let ap = p - a;
  let ab_ap = dot(ab, ap);
  let ac_ap = dot(ac, ap);
  if ab_ap <= 0.0 && ac_ap <= 0.0 {
    return vec4f(ap, 18.0);
  }
  let bp = ap - ab;
  let ab_bp = dot(ab, bp);
  let ac_bp = dot(ac, bp);
  if ab_bp >= 0.0 && ac_bp <= ab_bp {
    return vec4f(bp, 21.0);
  }
  let cp = ap - ac;
  let ab_cp = dot(ab, cp);
  let ac_cp = dot(ac, cp);
  if ac_cp >= 0.0 && ab_cp <= ac_cp {
    return vec4f(cp, 24.0);
  }
  if ab_ap * ac_bp - ab_bp * ac_ap <= 0.0 && ab_ap >= 0.0 && ab_bp <= 0.0 {
    return vec4f(ap - ab * (ab_ap / max(ab_ap - ab_bp, 1e-30)), 9.0);
  }
  if ab_cp * ac_ap - ab_ap * ac_cp <= 0.0 && ac_ap >= 0.0 && ac_cp <= 0.0 {
    return vec4f(ap - ac * (ac_ap / max(ac_ap - ac_cp, 1e-30)), 15.0);
  }
  if ab_bp * ac_cp - ab_cp * ac_bp <= 0.0 && ac_bp >= ab_bp && ab_cp >= ac_cp {
    return vec4f(bp - (ac - ab) * ((ac_bp - ab_bp) / max(ac_bp - ab_bp + ab_cp - ac_cp, 1e-30)), 12.0);
  }
  let normal = cross(ab, ac);
  return vec4f(normal * (dot(ap, normal) / max(dot(normal, normal), 1e-30)), 0.0);
}

// The distance to a figure, below zero inside of a closed one, and how it changes along each axis.
fn sf_figured(figure: f32, x: f32, y: f32, z: f32) -> vec4f {
  let head = sf_figure_head(figure);
  let boxes = sf_lists[head];
  let count = sf_lists[head + 1u];
  let pieces = sf_lists[head + 2u];
  let closed = sf_lists[head + 3u] == 1u;
  let p = vec3f(x, y, z);
  var best = 1e30;
  var away = vec3f(0.0, 1.0, 0.0);
  var out = vec3f(0.0);
  var i = 0u;
  while i < count {
    let at = boxes + 8u * i;
    let low = vec3f(bitcast<f32>(sf_lists[at]), bitcast<f32>(sf_lists[at + 1u]), bitcast<f32>(sf_lists[at + 2u]));
    let high = vec3f(bitcast<f32>(sf_lists[at + 3u]), bitcast<f32>(sf_lists[at + 4u]), bitcast<f32>(sf_lists[at + 5u]));
    let beyond = max(max(low - p, p - high), vec3f(0.0));
    let near = dot(beyond, beyond) < best;
    let first = sf_lists[at + 6u];
    let many = sf_lists[at + 7u];
    i = select(i + 1u, first, many == 0u && !near);
    if near {
      for (var piece = first; piece < first + many; piece += 1u) {
        if closed {
          let place = pieces + 27u * piece;
          let found = sf_face(place, p);
          let squared = dot(found.xyz, found.xyz);
          if squared < best {
            best = squared;
            away = found.xyz;
            let side = place + u32(found.w);
            out = vec3f(bitcast<f32>(sf_lists[side]), bitcast<f32>(sf_lists[side + 1u]), bitcast<f32>(sf_lists[side + 2u]));
            if side == place {
              let b = vec3f(bitcast<f32>(sf_lists[place + 3u]), bitcast<f32>(sf_lists[place + 4u]), bitcast<f32>(sf_lists[place + 5u]));
              let c = vec3f(bitcast<f32>(sf_lists[place + 6u]), bitcast<f32>(sf_lists[place + 7u]), bitcast<f32>(sf_lists[place + 8u]));
              out = cross(b - out, c - out);
            }
          }
        } else {
          let found = sf_bow(pieces + 14u * piece, p);
          let squared = dot(found, found);
          if squared < best {
            best = squared;
            away = found;
          }
        }
      }
    }
  }
  let way = sqrt(best);
  let side = select(1.0, -1.0, dot(out, away) < 0.0);
  let straight = select(vec3f(0.0, 1.0, 0.0), out / max(length(out), 1e-30), dot(out, out) > 0.0);
  return vec4f(side * way, select(straight, away * (side / max(way, 1e-30)), way > 1e-12));
}
" },
];

/// The helper that reads outlines.
pub const OUTLINES: &str = "outlined";

/// The helper that reads figures.
pub const FIGURES: &str = "figured";

/// The helper that reads grids.
pub const GRIDS: &str = "samples";

/// Which helpers a module needs.
#[derive(Clone, Copy, Debug, Default)]
pub struct Helpers(u32);

impl Helpers {
    /// Takes a helper by its name; what isn't one is left alone.
    pub fn need(&mut self, name: &str) {
        if name.starts_with("sampled") {
            self.need(GRIDS);
        }
        if let Some(bit) = HELPERS.iter().position(|h| h.name == name) {
            self.0 |= 1 << bit;
        }
    }

    /// The helpers taken, in their order.
    pub fn pieces(self) -> impl Iterator<Item = &'static Piece> {
        HELPERS.iter().enumerate().filter(move |(bit, _)| self.0 >> bit & 1 == 1).map(|(_, p)| p)
    }
}

/// The helper that the text of an operation calls.
pub fn helper_of(op: Op) -> Option<&'static str> {
    let name = op.row().wgsl.strip_prefix("sf_")?;
    name.split('(').next()
}

/// The arguments and the result of an exported function, as WGSL.
pub fn signature(export: Export) -> &'static str {
    match export {
        Export::Field => "sf_field(p: vec3f) -> f32",
        Export::Bound => "sf_bound(p: vec3f) -> f32",
        Export::Distance => "sf_distance(p: vec3f) -> f32",
        Export::Gradient => "sf_gradient(p: vec3f) -> vec4f",
        Export::Trace => {
            "sf_trace(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32, footprint: f32) -> sf_Hit"
        }
        Export::Shadow => {
            "sf_shadow(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32, softness: f32) -> f32"
        }
        Export::Collision => "sf_collision(center: vec3f, radius: f32) -> sf_Contact",
        Export::Occlusion => "sf_occlusion(p: vec3f, normal: vec3f) -> f32",
        Export::Surface => "sf_surface(p: vec3f, normal: vec3f) -> sf_Surface",
    }
}

/// What an exported function is for, in one line.
pub fn purpose(export: Export) -> &'static str {
    match export {
        Export::Field => "What the formulas say: negative inside, zero on the surface.",
        Export::Bound => "How far a ray may step from p without passing the surface.",
        Export::Distance => "The distance to the surface, as light and contact want it: an estimate.",
        Export::Gradient => "The gradient of the field, and the field as w.",
        Export::Trace => {
            "First hit along a ray (direction of length one); footprint is a pixel's width at distance one."
        }
        Export::Shadow => "How much light comes along a ray: 1 lit, 0 dark. A softness of 0 is a sharp edge, more is sharper.",
        Export::Collision => "How deep a ball is in the solid, and which way is out.",
        Export::Occlusion => "How open the surroundings of a surface are: 1 open, 0 closed.",
        Export::Surface => "How the surface answers light; colours are linear.",
    }
}

/// The functions that an exported function calls.
pub fn needs(export: Export) -> &'static [Export] {
    match export {
        Export::Field | Export::Bound | Export::Distance | Export::Gradient | Export::Surface => &[],
        Export::Trace | Export::Shadow => &[Export::Bound, Export::Distance],
        Export::Collision => &[Export::Bound, Export::Distance, Export::Gradient],
        Export::Occlusion => &[Export::Distance],
    }
}

/// The struct that an exported function gives.
pub fn structure(export: Export) -> Option<&'static str> {
    match export {
        Export::Trace => Some("\
// How far along a ray it meets anything, or its end where it meets nothing, or where its looks were spent; whether it does; how many looks it took. A
// ray that starts inside meets what is there.
struct sf_Hit {
  t: f32,
  hit: bool,
  steps: u32,
}
"),
        Export::Collision => Some("\
struct sf_Contact {
  normal: vec3f,
  depth: f32,
}
"),
        Export::Surface => Some("\
struct sf_Surface {
  color: vec3f,
  emission: vec3f,
  roughness: f32,
  metallic: f32,
  reflectivity: f32,
}
"),
        _ => None,
    }
}

/// Text of the library under the prefix of a module.
pub fn prefixed<'t>(text: &'t str, prefix: &str) -> Cow<'t, str> {
    if prefix == "sf_" { Cow::Borrowed(text) } else { Cow::Owned(text.replace("sf_", prefix)) }
}

/// Names of structs, which nothing else may take.
pub const STRUCTURES: [&str; 5] = ["Hit", "Contact", "Surface", "Passage", "Samples"];

/// The texts of `sf_trace` and `sf_shadow` by [`Ways`], each made when it is first asked for.
static FOLLOW: [OnceLock<[String; 2]>; 32] = [const { OnceLock::new() }; 32];

/// The text of an exported function that is the same for every scene with the same ways.
pub fn function(export: Export, ways: Ways, rounding: Rounding) -> Option<Cow<'static, str>> {
    let place = [ways.one, ways.planes, ways.region, ways.loose, ways.lamps].iter().fold(0, |place, way| 2 * place + usize::from(*way));
    match export {
        Export::Trace | Export::Shadow => {
            let [trace, shadow] = FOLLOW.get(place)?.get_or_init(|| [Tracer::DEFAULT.text(ways), shadow::text(ways)]);
            Some(with_rounding(if export == Export::Trace { trace } else { shadow }, rounding).into())
        }
        Export::Collision => Some(COLLISION.into()),
        Export::Occlusion => Some(OCCLUSION.into()),
        _ => None,
    }
}

const COLLISION: &str = "\
fn sf_collision(center: vec3f, radius: f32) -> sf_Contact {
  if sf_bound(center) >= radius {
    return sf_Contact(vec3f(0.0), 0.0);
  }
  let gradient = sf_gradient(center).xyz;
  let steepness = length(gradient);
  var normal = vec3f(0.0, 1.0, 0.0);
  if steepness > 0.0 {
    normal = gradient / steepness;
  }
  return sf_Contact(normal, max(radius - sf_distance(center), 0.0));
}
";

// Five looks along the normal (Evans 2006, Quilez), the nearest counting most. At a height h above the edge of a wedge that opens by a, the
// distance is -h cos a, and the edge sees (1 - cos a) / 2 of the sky, weighted by the cosine: so half of what is missing of the height is the
// share that is hidden. Nothing is left early: a reach of zero has no strength.
const OCCLUSION: &str = "\
fn sf_occlusion(p: vec3f, normal: vec3f) -> f32 {
  let reach = max(sf_uniforms.occlusion_reach, 1e-12);
  let strength = select(0.0, sf_uniforms.occlusion_strength, sf_uniforms.occlusion_reach > 0.0);
  var sum = 0.0;
  var weight = 1.0;
  for (var i = 1; i <= 5; i++) {
    let height = reach * f32(i) / 5.0;
    let free = clamp(sf_distance(p + normal * height), -height, height);
    sum += weight * (height - free) / height;
    weight *= 0.5;
  }
  // The weights add up to 31 / 16.
  return clamp(1.0 - strength * sum / 3.875, 0.0, 1.0);
}
";

/// A fragment function that looks at the scene, for modules that trace and have a gradient; in GLSL, where a fragment's y goes up.
pub const ENTRY_TRACE: &str = "\
@fragment
fn sf_fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
  let eye = vec3f(4.0, 3.0, 6.0);
  let forward = normalize(-eye);
  let right = normalize(cross(forward, vec3f(0.0, 1.0, 0.0)));
  let up = cross(right, forward);
  let at = (position.xy - vec2f(320.0, 180.0)) / 360.0;
  let direction = normalize(forward + 0.73 * (at.x * right + at.y * up));
  let start = eye - sf_uniforms.origin;
  let hit = sf_trace(start, direction, 0.0, 1000.0, 0.002);
  if !hit.hit {
    return vec4f(mix(vec3f(0.8, 0.86, 0.91), vec3f(0.24, 0.39, 0.63), max(direction.y, 0.0)), 1.0);
  }
  let slope = sf_gradient(start + direction * hit.t).xyz;
  let normal = slope / max(length(slope), 1e-20);
  return vec4f(vec3f(0.2 + 0.8 * max(dot(normal, normalize(vec3f(1.0, 2.0, 1.0))), 0.0)), 1.0);
}
";

/// A fragment function that shows `VALUE` on the plane z = 0.
pub const ENTRY_SLICE: &str = "\
@fragment
fn sf_fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
  let p = vec3f((position.xy - vec2f(320.0, 180.0)) / 90.0, 0.0);
  let value = VALUE;
  return vec4f(vec3f(0.5 + 0.25 * value), 1.0);
}
";
