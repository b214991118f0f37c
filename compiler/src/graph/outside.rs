//! How far a point lies outside of slabs, as nodes.

use super::interval::Interval;
use super::kernel::Op;
use super::{Graph, NodeId};

impl Graph {
    /// How far the point lies beyond each slab, of an axis and its side: 0 within. A side without an end is left out.
    pub fn beyond(&mut self, slabs: impl IntoIterator<Item = (usize, Interval)>) -> Vec<NodeId> {
        let (point, zero) = (self.point(), self.constant(0.0));
        let mut ways = Vec::new();
        for (axis, side) in slabs {
            let Some(&coordinate) = point.get(axis).filter(|_| side.is_finite()) else { continue };
            let middle = self.constant(side.middle());
            let half = self.constant((side.hi - side.middle()).max(side.middle() - side.lo));
            let from = self.op(Op::Sub, &[coordinate, middle]);
            let from = self.op(Op::Abs, &[from]);
            let way = self.op(Op::Sub, &[from, half]);
            ways.push(self.op(Op::Max, &[way, zero]));
        }
        ways
    }

    /// The length of up to three ways at right angles that are nowhere negative. None of none.
    pub fn together(&mut self, ways: &[NodeId]) -> Option<NodeId> {
        match ways {
            [] => None,
            [way] => Some(*way),
            [_, _] => Some(self.op(Op::Length2, ways)),
            _ => Some(self.op(Op::Length3, ways)),
        }
    }
}
