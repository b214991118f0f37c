//! Where a drawing is solid in its own plane, whatever moves and turns it.
//!
//! Of a drawing that turns by an angle of which only a range is known, its coordinates may be anything, and the formula says next to nothing of where in
//! the scene it is solid. In its own plane it is where it is; from there the way back through the turn alone is short.

use crate::analysis::{Box3, Domain, Facts};
use crate::graph::interval::Interval;
use crate::graph::{Graph, NodeId};
use std::collections::VecDeque;

/// How many parts are looked at, down to which part of what is found first.
const PARTS: usize = 1500;
const SMALLEST: f64 = 1.0 / 64.0;
/// How many steps of formulas that may cost.
const STEPS: u64 = 4_000_000;

impl Facts {
    /// The part of a finite region of its own plane in which an exact drawing is at most `level`: parts are dropped in which the value at the middle is
    /// more than the way to the corners, large ones first.
    pub(in crate::analysis) fn drawn(&mut self, graph: &Graph, drawing: NodeId, domain: &Domain, region: Box3, level: f64) -> Box3 {
        let tape = self.tape(graph, drawing);
        let (mut open, mut kept) = (VecDeque::from([region]), Box3::EMPTY);
        let mut smallest = 0.0;
        let first = self.account.ran;
        for looked in 0.. {
            let Some(part) = open.pop_front() else { break };
            if kept.hull(&part) == kept {
                continue;
            }
            let (u, v) = (part.axis(0), part.axis(1));
            let reach = 0.5 * u.width().hypot(v.width()) * (1.0 + 1e-9);
            let middle = Box3([u, v, part.axis(2)].map(|side| Interval::point(side.middle())));
            let value = self.ranges_of(graph, &tape, &domain.at(middle)).last().copied().unwrap_or(Interval::ALL);
            if value.lo > level + reach {
                continue;
            }
            if value.hi <= level {
                kept = kept.hull(&middle);
                smallest = SMALLEST * kept.size();
            }
            if looked >= PARTS || self.account.ran - first > STEPS || part.size() <= smallest {
                kept = kept.hull(&part);
                continue;
            }
            let halves = |i: Interval| [Interval::new(i.lo, i.middle()), Interval::new(i.middle(), i.hi)];
            open.extend(halves(u).into_iter().flat_map(|u| halves(v).map(|v| part.with_axis(0, u).with_axis(1, v))));
        }
        kept
    }
}
