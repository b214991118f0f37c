//! Why there is no module.

use crate::graph::{Function, ShapeId};
use std::fmt;

/// Why there is no module. The compiler itself is at fault, or the prefix.
#[derive(Clone, Debug, PartialEq)]
pub enum EmitError {
    /// The prefix can't start a name of WGSL.
    Prefix(String),
    /// Uniforms shall be variables of their own, and nothing stands before their names.
    Unnamed,
    /// A function that is called has no formula.
    NoFormula(ShapeId, Function),
    /// A shape's function needs itself.
    Cycle(ShapeId),
    /// A component that is no parameter's.
    NoParameter(u32),
    /// A variable that nothing binds.
    Unbound(u32),
    /// A formula that is not a surface's reads the normal.
    NormalOutsideSurface,
}

impl fmt::Display for EmitError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            EmitError::Prefix(prefix) => write!(
                f,
                "`{prefix}` can't start the names of a module: take letters, digits and `_`, a letter first, and no WGSL keyword"
            ),
            EmitError::Unnamed => f.write_str("uniforms as variables of their own need a prefix before their names"),
            EmitError::NoFormula(shape, function) => {
                write!(f, "shape {} is asked for its {function:?} and has no formula for it", shape.0)
            }
            EmitError::Cycle(shape) => write!(f, "shape {} is made of itself", shape.0),
            EmitError::NoParameter(i) => write!(f, "no parameter has the component {i}"),
            EmitError::Unbound(v) => write!(f, "nothing binds variable {v}"),
            EmitError::NormalOutsideSurface => {
                f.write_str("only a material may read the normal")
            }
        }
    }
}

impl std::error::Error for EmitError {}
