//! Where the field can be zero in a box: between two planes; and its sign all over a triangle.
//!
//! By the mean-value form the field at `p` in a box is `f(m) + g (p - m)`, with `g` among the gradients over the box. With `h` the middle of
//! these, it is `f(m) + h (p - m)` but for the half of their widths times the way from `m`. So what is zero lies between two planes across `h`,
//! whose distance falls with the square of the box where the surface is smooth (the affine form of Moore, Kearfott and Cloud, § 6.4).
//!
//! A triangle has a domain of its own, in which every step is bounded between the triangle's corners and not over the box about them: however
//! it is tilted, a linear function is known on it exactly.

use super::code::Code;
use super::forward::{self, Domain};
use super::jumps::{self, Guard};
use super::{Box3, Prover, SHORT, SLOPES, ball, joined, side};
use crate::graph::interval::Interval;
use std::sync::Arc;

/// Branches of the field that are looked at where its gradients are not alike.
const BRANCHES: usize = 8;
/// Pieces of a triangle on which the field jumps.
const PIECES: usize = 16;
/// The planes are moved apart by this part of the box, for the rounding of whoever computes with them.
const SLACK: f64 = 1e-9;

/// A box with the field's code for it.
#[derive(Clone, Debug)]
pub struct Place {
    /// The box.
    pub range: Box3,
    code: Arc<Code>,
    /// The pieces to which the code belongs: outside of them it says nothing.
    guards: Vec<Arc<Guard>>,
}

impl Place {
    /// Another box within this one.
    pub fn within(&self, range: Box3) -> Self {
        Self { range, ..self.clone() }
    }
}

/// What lies between two planes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slab {
    /// A point from which heights are counted.
    pub from: [f64; 3],
    /// Across both planes, of length one.
    pub normal: [f64; 3],
    /// The planes' heights along the normal; infinite where there is none on a side.
    pub heights: [f64; 2],
}

/// What is known of a box.
#[derive(Clone, Debug)]
pub enum Look {
    /// The field has none of the values in it.
    Nothing,
    /// The field jumps there; these pieces have all of the values.
    Parted(Vec<Place>),
    /// Only what is in this box, and between the planes if they are known, can have the values. Last the box in two halves, cut across the axis
    /// along which not knowing the gradient costs most.
    Held(Place, Option<Slab>, [Box3; 2]),
}

impl Prover<'_> {
    /// A box, with a shorter code for it.
    pub fn place(&mut self, range: Box3) -> Place {
        let code = self.truth.point.clone();
        let (_, code) = self.narrowed(code, &range);
        Place { range, code, guards: Vec::new() }
    }

    /// Where in a box the field can have a value of `target`. With `part` a field that jumps is looked at piece by piece.
    pub fn look(&mut self, place: Place, target: Interval, part: bool) -> Look {
        self.boxes += 1;
        let Place { mut range, code, mut guards } = place;
        if !guards.is_empty() {
            self.work += SLOPES * guards.iter().map(|guard| guard.steps() as u64).sum::<u64>();
            match jumps::within(&mut guards, &Domain::new(range, None), &mut self.slots) {
                Some(left) => range = left,
                None => return Look::Nothing,
            }
        }
        let code = if code.steps.len() > SHORT {
            let (value, code) = self.narrowed(code, &range);
            if value.intersect(target).is_empty() {
                return Look::Nothing;
            }
            code
        } else {
            code
        };
        self.work += SLOPES * code.steps.len() as u64;
        let domain = Domain::new(range, None);
        let whole = forward::full(&code, &domain, &mut self.slots);
        if whole.range.intersect(target).is_empty() {
            return Look::Nothing;
        }
        if whole.jump
            && part
            && let Some(pieces) = jumps::parted(&code, &self.slots, &mut self.live)
        {
            let placed = |(code, guard)| {
                let guards = guards.iter().cloned().chain([Arc::new(guard)]).collect();
                Place { range, code: Arc::new(code), guards }
            };
            return Look::Parted(pieces.into_iter().map(placed).collect());
        }
        let slots = &self.slots;
        let shorter = code.shorter(|i| slots.get(i).map_or(Interval::ALL, |s| s.range), &mut self.room);
        let mut gradient = whole.gradient;
        if !whole.jump && loose(&gradient) {
            let mut pieces = None;
            let looked = self.branches.each(&code, &self.slots, BRANCHES, |piece| {
                pieces = Some(joined(pieces, piece));
                true
            });
            self.work += SLOPES * looked;
            if let Some(piece) = pieces.filter(|piece| !piece.jump) {
                gradient.iter_mut().zip(piece.gradient).for_each(|(g, other)| *g = g.intersect(other));
            }
        }
        let code = shorter.map_or(code, Arc::new);
        // A gradient of no point is left by rounding only.
        if whole.jump || gradient.iter().any(|g| g.is_empty() || !g.is_finite()) {
            return Look::Held(Place { range, code, guards }, None, ball::halves(&range, &gradient));
        }
        let Some(left) = domain.holding(whole.centre, &gradient, target) else { return Look::Nothing };
        let slab = slab(&domain, &left, whole.centre, &gradient, target);
        Look::Held(Place { range: left, code, guards }, slab, ball::halves(&left, &gradient))
    }

    /// 1 or -1 where the field is above or below zero all over a triangle, else 0. `place` holds it and no jump parts it.
    pub fn side_of_triangle(&mut self, place: &Place, corners: [[f64; 3]; 3]) -> i8 {
        self.boxes += 1;
        let domain = Domain::triangle(corners);
        let code = if place.code.steps.len() > SHORT {
            let (value, code) = self.narrowed(place.code.clone(), &domain.range);
            if side(value) != 0 {
                return side(value);
            }
            code
        } else {
            place.code.clone()
        };
        self.work += SLOPES * code.steps.len() as u64;
        let whole = forward::full(&code, &domain, &mut self.slots);
        match side(whole.range) {
            0 if whole.jump => jumps::kept(&code, &domain, &mut self.slots, &mut self.ranges, &mut self.live, &mut { PIECES }),
            found => found,
        }
    }

    /// 1 or -1 where the field at a point of a place that no jump parts is surely above or below zero, else 0.
    pub fn side_of_point(&mut self, place: &Place, at: [f64; 3]) -> i8 {
        let code = place.code.clone();
        self.sign(&code, at)
    }
}

/// Whether gradients differ so much that more may be known of them.
fn loose(gradient: &[Interval; 3]) -> bool {
    let size = gradient.iter().map(|g| g.middle().abs()).fold(0.0, f64::max);
    gradient.iter().any(|g| g.width() > 0.5 * size)
}

/// The planes between which a function's values of `target` lie in a part of a domain; none where its gradient has no direction.
fn slab(domain: &Domain<3>, left: &Box3, centre: Interval, gradient: &[Interval; 3], target: Interval) -> Option<Slab> {
    let mut normal = gradient.map(Interval::middle);
    let size = normal.iter().map(|g| g * g).sum::<f64>().sqrt();
    let (mut off, mut scale, mut widest) = (0.0, 0.0, 0.0_f64);
    for ((g, side), m) in gradient.iter().zip(left).zip(&domain.middle) {
        let far = (side.hi - m).abs().max((m - side.lo).abs());
        off += (g.hi - g.middle()).max(g.middle() - g.lo) * far;
        scale += g.magnitude() * far;
        widest = widest.max(side.width());
    }
    // A gradient that may have any direction tells nothing.
    if size.is_nan() || size <= 1e-300 || off >= scale {
        return None;
    }
    normal.iter_mut().for_each(|g| *g /= size);
    // What these lines lose by rounding is far less.
    let off = off + SLACK * (size * widest) + 1e-14 * (scale + centre.magnitude());
    let heights = [(target.lo - centre.hi - off) / size, (target.hi - centre.lo + off) / size];
    (!heights.iter().any(|h| h.is_nan())).then_some(Slab { from: domain.middle, normal, heights })
}
