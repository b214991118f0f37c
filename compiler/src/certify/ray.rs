//! Where a ray meets the surface first.

use super::code::Code;
use super::forward::{self, Domain};
use super::jumps;
use super::{BRANCHES, Prover, SHORT, joined};
use crate::graph::interval::Interval;
use std::sync::Arc;

/// What a ray meets first. `t` counts lengths of the ray's direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Hit {
    /// The field changes its sign here, to within 1e-10·max(1, t, |p|) (1e-12·max(1, t) where it is monotone there, up to the
    /// rounding of 64 bits), and nowhere before.
    Hit(f64),
    /// The field keeps its sign all along.
    Miss,
    /// Nothing before; here the field comes so close to zero that 64 bits can't tell whether it changes its sign.
    Ambiguous(f64),
    /// The budget of boxes was used up; nothing before.
    Exhausted(f64),
}

/// Pieces that are looked at where a segment holds jumps.
const PIECES: usize = 64;
/// A segment that is shorter than this, times the largest coordinate, is short: a kink in it is worth the work…
const SHORT_WAY: f64 = 1e-3;
/// …every so many halvings: they are a hundred times cheaper, and mostly leave the kink behind.
const APART: u32 = 4;
/// Segments of a ray that was halved less often than this are judged by natural intervals alone: slopes say little over a long way.
const COARSE: u32 = 6;
/// A ray is cut so far before and after the border of a cell of noise or of a repetition, times the largest coordinate: on both sides the
/// field does not jump then, and slopes say much.
const BESIDE: f64 = 1e-7;
/// A segment is cut at so many borders at once, of the coarsest cells first.
const CUTS: usize = 3;

impl Prover<'_> {
    /// The first place with `near < t < far` where the field along `origin + t direction` changes its sign: for a ray that begins outside
    /// the first place at which it enters the solid, for one that begins inside the first at which it leaves it. A ray whose field is zero
    /// at `near` is ambiguous there. Looks at `budget` segments at most.
    pub fn first_hit(&mut self, origin: [f64; 3], direction: [f64; 3], near: f64, far: f64, budget: usize) -> Hit {
        let mut code = self.truth.ray.clone();
        code.aim(origin, direction);
        let mut open = vec![(near, far, Arc::new(code), 0u32)];
        let mut left = budget;
        while let Some((lo, hi, code, halved)) = open.pop() {
            if left == 0 {
                return Hit::Exhausted(lo);
            }
            left -= 1;
            self.boxes += 1;
            let range = [Interval { lo, hi }];
            // A little off the middle, so that no cut falls on what is laid out in round numbers.
            let cut = lo + 0.493 * (hi - lo);
            let code = if code.steps.len() > SHORT {
                let (value, code) = self.narrowed(code, &range);
                if !value.contains(0.0) {
                    continue;
                }
                if halved < COARSE {
                    open.extend([(cut, hi, code.clone(), halved + 1), (lo, cut, code, halved + 1)]);
                    continue;
                }
                code
            } else {
                code
            };
            let domain = Domain::new(range, None);
            let [middle] = domain.middle;
            let whole = forward::full(&code, &domain, &mut self.ray_slots);
            if !whole.range.contains(0.0) {
                continue;
            }
            let scale = size(origin, direction, lo).max(1.0);
            if whole.jump {
                let parts = self.between_borders(&code, middle, (lo, hi), BESIDE * scale);
                if parts.len() > 1 {
                    open.extend(parts.into_iter().map(|(lo, hi)| (lo, hi, code.clone(), halved + 1)));
                    continue;
                }
                if jumps::kept(&code, &domain, &mut self.ray_slots, &mut self.ranges, &mut self.live, &mut { PIECES }) != 0 {
                    continue;
                }
                forward::full(&code, &domain, &mut self.ray_slots);
            }
            let slots = &self.ray_slots;
            let code = code.shorter(|i| slots.get(i).map_or(Interval::ALL, |s| s.range), &mut self.room).map_or(code, Arc::new);
            let narrow = hi - lo <= 1e-10 * scale;
            let ends = (self.sign(&code, [lo]), self.sign(&code, [hi]));
            let apart = hi - lo <= SHORT_WAY * scale && halved.is_multiple_of(APART);
            if narrow || self.monotone(&code, range, apart) {
                match ends {
                    (0, _) | (_, 0) if narrow => return Hit::Ambiguous(0.5 * (lo + hi)),
                    (0, _) | (_, 0) => {}
                    (before, after) if before != after => return Hit::Hit(self.crossing(&code, lo, hi, before)),
                    _ if narrow => return Hit::Ambiguous(0.5 * (lo + hi)),
                    _ => continue,
                }
            }
            open.extend([(cut, hi, code.clone(), halved + 1), (lo, cut, code, halved + 1)]);
        }
        Hit::Miss
    }

    /// A segment cut at borders at which the field may jump, with a hair `beside` each on both sides: the parts between them and the hairs, the
    /// farthest first. What is known of each step over the segment stands in `ray_slots`.
    fn between_borders(&self, code: &Code, middle: f64, (lo, hi): (f64, f64), beside: f64) -> Vec<(f64, f64)> {
        let inside = Interval { lo: lo + 2.0 * beside, hi: hi - 2.0 * beside };
        let mut borders = jumps::borders(code, &self.ray_slots, middle, inside);
        borders.truncate(CUTS);
        borders.sort_unstable_by(f64::total_cmp);
        let mut parts = Vec::new();
        let mut end = hi;
        while let Some(last) = borders.pop() {
            let mut first = last;
            while let Some(next) = borders.pop_if(|next| *next >= first - 3.0 * beside) {
                first = next;
            }
            parts.extend([(last + beside, end), (first - beside, last + beside)]);
            end = first - beside;
        }
        parts.push((lo, end));
        parts
    }

    /// Whether the field surely rises, or surely falls, all along a segment. `apart`: each side of its kinks is taken by itself.
    fn monotone(&mut self, code: &Code, range: [Interval; 1], apart: bool) -> bool {
        let whole = forward::full(code, &Domain::new(range, None), &mut self.ray_slots);
        let turns = |[slope]: [Interval; 1]| slope.is_empty() || slope.contains(0.0);
        if whole.jump || !turns(whole.gradient) {
            return !whole.jump;
        }
        if !apart {
            return false;
        }
        let mut pieces = None;
        self.ray_branches.each(code, &self.ray_slots, BRANCHES, |piece| {
            pieces = Some(joined(pieces, piece));
            true
        });
        pieces.is_some_and(|all| !all.jump && !turns(all.gradient))
    }

    /// Where the field changes its sign between two ends, to within 1e-12·max(1, t): bisection and false position in turn.
    fn crossing(&mut self, code: &Code, mut lo: f64, mut hi: f64, before: i8) -> f64 {
        let side = f64::from(before);
        let mut at_lo = side * code.value(&[lo], &mut self.values);
        let mut at_hi = side * code.value(&[hi], &mut self.values);
        for round in 0..200 {
            let close = 1e-12 * lo.abs().max(1.0);
            if hi - lo <= close {
                break;
            }
            let secant = lo + (hi - lo) * (at_lo / (at_lo - at_hi));
            let middle = 0.5 * (lo + hi);
            // The secant's guess is tried from both sides, so that both ends close in.
            let guess = match round % 3 {
                0 => secant - 0.4 * close,
                1 => secant + 0.4 * close,
                _ => middle,
            };
            let at = if guess > lo && guess < hi { guess } else { middle };
            let value = side * code.value(&[at], &mut self.values);
            if value > 0.0 {
                (lo, at_lo) = (at, value);
            } else {
                (hi, at_hi) = (at, value);
            }
        }
        0.5 * (lo + hi)
    }
}

/// The largest of the parameter and the coordinates of the point there.
fn size(origin: [f64; 3], direction: [f64; 3], t: f64) -> f64 {
    origin.iter().zip(direction).map(|(o, d)| (o + t * d).abs()).fold(t.abs(), f64::max)
}
