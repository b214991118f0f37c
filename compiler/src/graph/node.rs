//! A node of the graph, and what is known of its value.

use crate::graph::id::{NodeId, ShapeId};
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::list::NodeList;
use std::sync::Arc;

/// Stands for "no solid here": farther than anything, yet finite in 32 bits.
pub const FAR: f64 = 1e9;

/// Any time that a person may wait for, and what came before, in seconds.
pub const ANY_TIME: Interval = Interval { lo: -1e7, hi: 1e7 };

/// What a node reads from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Leaf {
    /// Component of the point in the own space of the shape: 0, 1, 2.
    P(u8),
    /// Component of the surface's normal in the scene's space, in materials; of a ray's direction in what is asked along a ray.
    Normal(u8),
    /// Seconds.
    Time,
    /// A component of a parameter: an index into [`Graph::parameters`](crate::graph::Graph::parameters).
    Parameter(u32),
    /// A number that a repetition or the caller binds: `cell`, or the point of the scene ([`WORLD`]).
    Variable(u32),
}

/// Variables 0, 1, 2 are the point of the scene; a scene's root binds them to its `p`.
pub const WORLD: u32 = 0;
/// The first variable that is free to be bound by a repetition.
pub const FIRST_VARIABLE: u32 = 3;

/// Which function of a shape is called.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Function {
    /// What the formulas say.
    Field,
    /// How far a ray may step.
    Bound,
    /// The estimate of the distance that light and contact use.
    Distance,
    /// Component 0, 1, 2 of the field's gradient.
    Gradient(u8),
}

/// A number, or a condition.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Node {
    /// A constant, as its bits, so that it can be hashed. Never NaN or infinite.
    Constant(u64),
    /// Read from outside.
    Leaf(Leaf),
    /// An operation of the kernel.
    Op(Op, NodeList),
    /// A function of a shape at a point: three coordinates (two of a drawing, then zero), then one value for
    /// each of the shape's variables.
    Call(ShapeId, Function, NodeList),
    /// The value of the first node, with what is known of it and can't be seen from its formula; the
    /// others are what the claim speaks of.
    Claim(NodeList, Claim),
    /// How far a field may be trusted, as a multiple: the reciprocal of a Lipschitz factor. An index into [`Graph::factors`](crate::graph::Graph::factors).
    Factor(u32),
}

/// What is known of a value.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Claim {
    /// Its Lipschitz constant is at most the value of this formula, in which `Variable(i)` stands for
    /// the constant of the `i`-th group of the claim's other nodes; and its range, where that is known. From the prelude.
    Lipschitz(NodeId, Arc<[ClaimGroup]>, Option<ValueRange>),
    /// The jumps inside (of a cell's index) cancel: the value is continuous.
    Continuous,
}

/// All values that a formula can have: the bits of both ends, so that it can be hashed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ValueRange([u64; 2]);

impl ValueRange {
    /// From the least to the largest.
    pub fn new(least: f64, largest: f64) -> Self {
        Self([least, largest].map(f64::to_bits))
    }

    /// The same as an interval.
    pub fn interval(self) -> Interval {
        let [least, largest] = self.0.map(f64::from_bits);
        Interval::new(least, largest)
    }
}

/// So many nodes of a claim that stand for one argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ClaimGroup {
    /// Components of a vector (or one number): the constant is that of the vector.
    Vector(u8),
    /// Values of a shape at several points: the constant is the largest.
    Values(u32),
    /// The same of a shape of which bounds will do: the claim's value grows with them, and has the same sign for values of the same signs.
    Bounds(u32),
}

impl Claim {
    /// What of an interval of its values is left by what it knows of them.
    pub fn within(&self, value: Interval) -> Interval {
        match self {
            Claim::Lipschitz(_, _, Some(range)) => {
                let common = value.intersect(range.interval());
                if common.is_empty() { value } else { common }
            }
            _ => value,
        }
    }

    /// The name of the claim in printed graphs.
    pub fn name(&self) -> &'static str {
        match self {
            Claim::Lipschitz(..) => "lipschitz",
            Claim::Continuous => "continuous",
        }
    }
}

/// A parameter's component that a formula can read.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterComponent {
    /// Which parameter of the program.
    pub parameter: u32,
    /// Which of its components.
    pub component: u8,
    /// Its value at the start.
    pub default: f64,
    /// Least value.
    pub min: f64,
    /// Greatest value.
    pub max: f64,
    /// Whether its values are whole numbers.
    pub whole: bool,
}
