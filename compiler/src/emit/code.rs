//! What an expression of a function is, and what it reads from outside.

use crate::emit::error::EmitError;
use crate::emit::plan::TargetId;
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use smallvec::SmallVec;

/// Index of an expression in a [`Body`](crate::emit::body::Body). Arguments have smaller indices.
pub type ExprId = u32;

/// What an expression is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Code {
    /// A number, by its bits.
    Constant(u64),
    /// The point, a vector of so many components.
    Point(u8),
    /// The point of the scene, as an argument.
    World,
    /// The point of the scene, in a function that has it as a local.
    Scene,
    /// The normal.
    Normal,
    /// An argument for a variable of the shape: its place among them.
    Variable(u32),
    /// A field of the uniform block: its number among the candidates, and its components.
    Uniform(u32, u8),
    /// What depends on parameters and time alone: a field of [`Formulas`](crate::emit::formulas::Formulas), and its components.
    Computed(u32, u8),
    /// An operation of the kernel. `Length2` and its kin take one vector.
    Op(Op),
    /// What one call of the operation's helper gives: so many components, of which operations are made.
    Whole(Op, u8),
    /// A function of the module: the point, then numbers.
    Call(TargetId),
    /// A loop that calls a function of the module so often. For each argument one that is the same in all calls, or where its bit in the last is set one for each.
    Batch(TargetId, u32, u32),
    /// What a loop found in one of its turns.
    Item(u32),
    /// A component of a vector.
    Component(u8),
    /// Components of a vector in any order: so many, four bits each.
    Swizzle(u8, u16),
    /// A vector of numbers.
    Vector(u8),
    /// An operation on each component of a vector; arguments that are numbers count for each.
    VectorOp(Op, u8),
    /// A vector of one number.
    Splat(u8),
    /// The surface's struct from its fields.
    Surface,
    /// The struct of what lies on it from its fields.
    Layers(u32),
    /// The struct of where a point lies in its part from its fields.
    Carry,
    /// The struct of what surrounds the scene from its fields.
    Around,
    /// The value so far of a union, or its gradient and value: so many components.
    Value(u8),
    /// The value of a union that was set aside.
    Aside(u8),
    /// A piece of a table's row: four numbers.
    Row(u32),
}

impl Code {
    /// A number that is mostly different for different codes.
    pub(super) fn key(self) -> u64 {
        let (kind, detail) = match self {
            Code::Constant(bits) => return bits,
            Code::Point(n) => (1, u64::from(n)),
            Code::World => (2, 0),
            Code::Scene => (3, 0),
            Code::Normal => (4, 0),
            Code::Variable(i) => (5, u64::from(i)),
            Code::Uniform(i, _) => (6, u64::from(i)),
            Code::Op(op) => (7, op as u64),
            Code::Call(target) => (8, u64::from(target)),
            Code::Component(i) => (9, u64::from(i)),
            Code::Swizzle(_, order) => (10, u64::from(order)),
            Code::Vector(n) => (11, u64::from(n)),
            Code::VectorOp(op, _) => (12, op as u64),
            Code::Splat(n) => (13, u64::from(n)),
            Code::Surface => (14, 0),
            Code::Layers(which) => (15, u64::from(which)),
            Code::Carry => (19, 0),
            Code::Around => (23, 0),
            Code::Value(n) => (18, u64::from(n)),
            Code::Aside(n) => (16, u64::from(n)),
            Code::Row(piece) => (17, u64::from(piece)),
            Code::Computed(field, _) => (20, u64::from(field)),
            Code::Batch(target, ..) => (21, u64::from(target)),
            Code::Item(i) => (22, u64::from(i)),
            Code::Whole(op, _) => (24, op as u64),
        };
        kind << 40 | detail
    }
}

/// Some expressions, mostly few.
pub type Exprs = SmallVec<[ExprId; 12]>;

/// Finds the uniform field and component that a leaf reads.
pub trait Outside {
    /// Number of the field, its components, and the component that is meant.
    fn uniform(&self, read: Read) -> Result<(u32, u8, u8), EmitError>;
    /// All values of a component of a field.
    fn range(&self, field: u32, component: u8) -> Interval;
}

/// What is read from outside.
#[derive(Clone, Copy, Debug)]
pub enum Read {
    /// Seconds.
    Time,
    /// A component of a parameter.
    Parameter(u32),
    /// A factor.
    Factor(u32),
}
