//! From the graph of a scene to the functions that a module holds: field, bound, distance, gradient, surface.

use crate::graph::{Function, NodeId, ShapeId};
use rustc_hash::FxHashMap;

/// The formulas of every function of every shape that the root's functions call.
#[derive(Clone, Debug, Default)]
pub struct Functions {
    /// Formula by shape and function, in the shape's own space: it reads `p`, the shape's variables, parameters, time, factors,
    /// and calls functions of other shapes. `Gradient(0..=2)` are present together or not at all.
    pub formulas: FxHashMap<(ShapeId, Function), NodeId>,
    /// The root's surface, in the scene's space: it reads `p`, `Normal`, and calls fields.
    pub surface: Surface,
}

/// How the surface at a point answers light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Surface {
    /// Linear colour.
    pub color: [NodeId; 3],
    /// Light of its own, linear.
    pub emission: [NodeId; 3],
    /// 0 to 1.
    pub roughness: NodeId,
    /// 0 to 1.
    pub metallic: NodeId,
    /// 0 to 1.
    pub reflectivity: NodeId,
}
