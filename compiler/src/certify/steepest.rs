//! How steep the field is at most.

use super::code::Code;
use super::forward::{self, Domain};
use super::{BRANCHES, Box3, Prover, ball};
use crate::graph::interval::Interval;
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::sync::Arc;

/// The supremum of the gradient's norm over a box, between two ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steepest {
    /// No gradient is larger.
    pub at_most: f64,
    /// The gradient is this large at `at`.
    pub at_least: f64,
    /// Where.
    pub at: [f64; 3],
    /// Boxes that were looked at.
    pub boxes: usize,
    /// Whether the field may jump in the box: the numbers speak of its pieces.
    pub jump: bool,
}

/// A box with a bound of its gradients. The greatest is the steepest.
struct Part {
    norm: f64,
    range: Box3,
    code: Arc<Code>,
    jump: bool,
}

impl PartialEq for Part {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Part {}

impl PartialOrd for Part {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Part {
    fn cmp(&self, other: &Self) -> Ordering {
        self.norm.total_cmp(&other.norm)
    }
}

impl Prover<'_> {
    /// How large the field's gradient is at most in a box, kinks branch by branch. Stops when the upper end is at most `ratio` (above 1)
    /// times the lower, or after `budget` boxes. The upper end is loose for smooth blends, whose gradient
    /// mixes those of their operands: its excess falls only with the width of the boxes.
    pub fn steepest(&mut self, range: Box3, ratio: f64, budget: usize) -> Steepest {
        let root = self.truth.point.clone();
        let mut found = Steepest { at_most: 0.0, at_least: 0.0, at: range.map(Interval::middle), boxes: 0, jump: false };
        let mut parts = BinaryHeap::new();
        let first = self.part(range, root, &mut found);
        parts.push(first);
        while let Some(part) = parts.peek() {
            if part.norm <= found.at_least * ratio || found.boxes >= budget {
                break;
            }
            let Some(part) = parts.pop() else { break };
            let axis = (0..3).max_by(|&i, &j| width(&part.range, i).total_cmp(&width(&part.range, j))).unwrap_or(0);
            if width(&part.range, axis) <= 1e-12 * part.range.iter().map(|x| x.magnitude()).fold(1e-300, f64::max) {
                // No narrower box can be told apart: its bound stands.
                parts.push(part);
                break;
            }
            for half in ball::cut(&part.range, axis) {
                let mut half = self.part(half, part.code.clone(), &mut found);
                // A part of a box is no steeper than the box.
                half.norm = half.norm.min(part.norm);
                parts.push(half);
            }
        }
        found.at_most = parts.peek().map_or(0.0, |p| p.norm).max(found.at_least);
        found.jump = parts.iter().any(|p| p.jump);
        found
    }

    fn part(&mut self, range: Box3, code: Arc<Code>, found: &mut Steepest) -> Part {
        self.boxes += 1;
        found.boxes += 1;
        let (_, code) = self.narrowed(code, &range);
        let domain = Domain::new(range, None);
        let whole = forward::full(&code, &domain, &mut self.slots);
        let (mut norm, mut jump, mut any) = (0.0, false, false);
        self.branches.each(&code, &self.slots, BRANCHES, |piece| {
            norm = f64::max(norm, piece.norm);
            jump |= piece.jump;
            any = true;
            true
        });
        if !any {
            (norm, jump) = (whole.norm, whole.jump);
        }
        let slots = &self.slots;
        let code = code.shorter(|i| slots.get(i).map_or(Interval::ALL, |s| s.range), &mut self.room).map_or(code, Arc::new);
        // Somewhere in the box where no symmetry puts a kink.
        let mut at = domain.middle;
        at.iter_mut().zip(&range).zip([0.0131, 0.0077, -0.0113]).for_each(|((x, side), part)| *x += part * side.width());
        let here = forward::full(&code, &Domain::new(at.map(Interval::point), None), &mut self.slots);
        let least = here.gradient.iter().map(|g| g.mignitude() * g.mignitude()).sum::<f64>().sqrt() * (1.0 - 4.0 * f64::EPSILON);
        if !here.jump && least > found.at_least {
            (found.at_least, found.at) = (least, at);
        }
        Part { norm: norm.min(whole.norm), range, code, jump }
    }
}

fn width(range: &Box3, axis: usize) -> f64 {
    range.get(axis).map_or(0.0, |x| x.width())
}
