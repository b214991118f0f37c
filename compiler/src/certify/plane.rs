//! Where the field can be zero in a box: between two planes; and its sign all over a triangle.
//!
//! By the mean-value form the field at `p` in a box is `f(m) + g (p - m)`, with `g` among the gradients over the box. With `h` the middle of
//! these, it is `f(m) + h (p - m)` but for the half of their widths times the way from `m`. So what is zero lies between two planes across `h`,
//! whose distance falls with the square of the box where the surface is smooth (the affine form of Moore, Kearfott and Cloud, § 6.4).
//!
//! A triangle has a domain of its own, in which every step is bounded between the triangle's corners and not over the box about them: however
//! it is tilted, a linear function is known on it exactly.

use super::code::Code;
use super::forward::{self, Domain, Slot};
use super::jumps::{self, Guard};
use super::step::Step;
use super::{Box3, Prover, SHORT, SLOPES, ball, joined, side};
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use smallvec::SmallVec;
use std::sync::Arc;

/// Branches of the field that are looked at where its gradients are not alike.
const BRANCHES: usize = 8;
/// So often a place is parted at a kink or a jump before it is no more.
const KINKS: usize = 5;
/// Steps of which is told where the field is zero, at most.
const IMPLIED: usize = 8;
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

impl Slab {
    /// How far the planes are from each other.
    pub fn thickness(&self) -> f64 {
        self.heights[1] - self.heights[0]
    }
}

/// What is known of a box.
#[derive(Clone, Debug)]
pub enum Look {
    /// The field has none of the values in it.
    Nothing,
    /// The field jumps there; these pieces have all of the values.
    Parted(Vec<Place>),
    /// Only what is in this box can have the values.
    Held(Box<Held>),
}

/// What of a box can have the values.
#[derive(Clone, Debug)]
pub struct Held {
    /// The box.
    pub place: Place,
    /// It lies in all of these.
    pub slabs: SmallVec<[Slab; 4]>,
    /// The box in two, cut across the axis along which not knowing the gradient costs most.
    pub halves: [Box3; 2],
    /// Whether the field has a kink there that [`Prover::sides`] can part.
    pub kink: bool,
}

impl Prover<'_> {
    /// A box, with a shorter code for it.
    pub fn place(&mut self, range: Box3) -> Place {
        let code = self.truth.point.clone();
        let (_, code) = self.narrowed(code, &range);
        Place { range, code, guards: Vec::new() }
    }

    /// A box within a place, with a shorter code for it.
    pub fn place_in(&mut self, place: &Place, range: Box3) -> Place {
        let (_, code) = self.narrowed(place.code.clone(), &range);
        Place { range, code, guards: place.guards.clone() }
    }

    /// The field at a point of a place in 64 bits, not rounded outward.
    pub fn value_in(&mut self, place: &Place, at: [f64; 3]) -> f64 {
        self.work += place.code.steps.len() as u64;
        place.code.value(&at, &mut self.values)
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
        let known = !whole.jump && gradient.iter().all(|g| !g.is_empty() && g.is_finite());
        let left = if known { domain.holding(whole.centre, &gradient, target) } else { Some(range) };
        let Some(left) = left else { return Look::Nothing };
        let mut slabs = SmallVec::new();
        let mut kink = false;
        if known {
            slabs.extend(slab(&domain, &left, whole.centre, &gradient, target));
            if loose(&gradient) {
                kink = guards.len() < KINKS;
                slabs.extend(implied(&code, &self.slots, target).into_iter().filter_map(|(step, target)| {
                    let slot = self.slots.get(step as usize)?;
                    let known = !slot.jump && slot.gradient.iter().all(|g| !g.is_empty() && g.is_finite());
                    if known { slab(&domain, &left, slot.centre, &slot.gradient, target) } else { None }
                }));
            }
        }
        if !guards.is_empty() {
            self.work += SLOPES * guards.iter().map(|guard| guard.steps() as u64).sum::<u64>();
        }
        for guard in &guards {
            let (value, within) = guard.value(&domain, &mut self.slots);
            if !value.jump && value.gradient.iter().all(|g| !g.is_empty() && g.is_finite()) {
                slabs.extend(slab(&domain, &left, value.centre, &value.gradient, within));
            }
        }
        let code = shorter.map_or(code, Arc::new);
        let halves = ball::halves(&left, &gradient);
        Look::Held(Box::new(Held { place: Place { range: left, code, guards }, slabs, halves, kink }))
    }

    /// Both sides of a kink of the field in a box that is held; none where there is none.
    pub fn sides(&mut self, place: &Place) -> Option<[Place; 2]> {
        self.work += SLOPES * place.code.steps.len() as u64;
        forward::full(&place.code, &Domain::new(place.range, None), &mut self.slots);
        let sides = jumps::at_kink(&place.code, &self.slots, &mut self.live)?;
        Some(sides.map(|(code, guard)| {
            let guards = place.guards.iter().cloned().chain([Arc::new(guard)]).collect();
            Place { range: place.range, code: Arc::new(code), guards }
        }))
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

/// Other steps, and between which numbers each lies where the last step's value is one of `target`.
fn implied(code: &Code, slots: &[Slot<3>], target: Interval) -> SmallVec<[(u32, Interval); 4]> {
    let mut found: SmallVec<[(u32, Interval); 4]> = SmallVec::new();
    let mut open: SmallVec<[(u32, Interval); 4]> = SmallVec::new();
    open.push(((code.steps.len() as u32).saturating_sub(1), target));
    while let Some((step, target)) = open.pop() {
        let Some(Step::Op(op, [a, b, c, d])) = code.steps.get(step as usize).copied() else {
            if let Some(Step::Form(_, [value, ..])) = code.steps.get(step as usize) {
                open.push((*value, target));
            }
            continue;
        };
        let range = |step: u32| slots.get(step as usize).map_or(Interval::ALL, |slot| slot.range);
        let mut all: SmallVec<[(u32, Interval); 4]> = SmallVec::new();
        let about = Interval { lo: -target.hi, hi: target.hi };
        match op {
            Op::Neg => all.push((a, target.neg())),
            Op::Add if range(b).is_point() => all.push((a, target.sub(range(b)))),
            Op::Add if range(a).is_point() => all.push((b, target.sub(range(a)))),
            Op::Sub if range(b).is_point() => all.push((a, target.add(range(b)))),
            Op::Sub if range(a).is_point() => all.push((b, range(a).sub(target))),
            Op::Mul if range(b).is_point() && range(b).lo != 0.0 => all.push((a, target.div(range(b)))),
            Op::Mul if range(a).is_point() && range(a).lo != 0.0 => all.push((b, target.div(range(a)))),
            Op::Max => all.extend([a, b].map(|step| (step, Interval { lo: f64::NEG_INFINITY, hi: target.hi }))),
            Op::Min => all.extend([a, b].map(|step| (step, Interval { lo: target.lo, hi: f64::INFINITY }))),
            Op::Abs => all.push((a, about)),
            Op::Length2 | Op::Length3 | Op::Length4 => all.extend([a, b, c, d].into_iter().take(usize::from(op.row().arity)).map(|step| (step, about))),
            _ => {}
        }
        all.retain(|(_, target)| target.lo.is_finite() || target.hi.is_finite());
        if found.len() + open.len() + all.len() > IMPLIED {
            break;
        }
        found.extend(all.iter().copied());
        open.extend(all);
    }
    found
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
