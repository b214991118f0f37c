//! What a walk over the graph computes with.

use crate::graph::interval::Interval;
use crate::graph::kernel::{self, Op};
use crate::graph::{Claim, Graph, NodeId};

/// Values and the operations of the kernel on them. One walk ([`Graph::evaluate`]) serves them all.
pub trait Algebra {
    /// What is computed.
    type Value: Clone;
    /// A constant.
    fn constant(&mut self, value: f64) -> Self::Value;
    /// An operation of the kernel. `args` has as many values as the operation takes.
    fn op(&mut self, op: Op, args: &[Self::Value]) -> Self::Value;
    /// A value with what is known of it; `of` are the values that the claim speaks of.
    fn claim(
        &mut self,
        graph: &Graph,
        value: Self::Value,
        claim: &Claim,
        of: &[Self::Value],
    ) -> Self::Value {
        let _ = (graph, claim, of);
        value
    }
}

/// Real numbers, in 64 bits.
#[derive(Clone, Copy, Debug, Default)]
pub struct Reals;

impl Algebra for Reals {
    type Value = f64;
    fn constant(&mut self, value: f64) -> f64 {
        value
    }
    fn op(&mut self, op: Op, args: &[f64]) -> f64 {
        kernel::value(op, args)
    }
}

/// Intervals that hold every value.
#[derive(Clone, Copy, Debug, Default)]
pub struct Intervals;

impl Algebra for Intervals {
    type Value = Interval;
    fn constant(&mut self, value: f64) -> Interval {
        Interval::point(value)
    }
    fn op(&mut self, op: Op, args: &[Interval]) -> Interval {
        kernel::interval(op, args)
    }
    fn claim(&mut self, _: &Graph, value: Interval, claim: &Claim, _: &[Interval]) -> Interval {
        claim.within(value)
    }
}

impl Algebra for Graph {
    type Value = NodeId;
    fn constant(&mut self, value: f64) -> NodeId {
        Graph::constant(self, value)
    }
    fn op(&mut self, op: Op, args: &[NodeId]) -> NodeId {
        Graph::op(self, op, args)
    }
}
