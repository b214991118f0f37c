//! What was found of formulas over domains, so that each is looked for once.

use super::cell::OneCell;
use super::level_and_curvature_bounds::Uneven;
use super::{Cut, Narrowed, Treatment};
use crate::analysis::domain::Key;
use crate::graph::{NodeId, ShapeId};
use rustc_hash::FxHashMap;
use std::rc::Rc;

/// By formula and domain.
#[derive(Default)]
pub(super) struct Found {
    pub treatments: FxHashMap<(ShapeId, NodeId, Key, bool), Option<Treatment>>,
    pub capped: FxHashMap<(NodeId, Key), Option<(NodeId, Treatment)>>,
    pub regions: FxHashMap<(NodeId, Key, bool), Option<Narrowed>>,
    pub cuts: FxHashMap<(NodeId, Key), Option<Cut>>,
    /// A formula of cells in one of them.
    pub cells: FxHashMap<(NodeId, Key), Option<Rc<OneCell>>>,
    /// What is left of an intersection of which one operand cuts nothing off.
    pub absorbed: FxHashMap<(NodeId, Key), Option<NodeId>>,
    pub rough: FxHashMap<(NodeId, Key), f64>,
    pub unevens: FxHashMap<(NodeId, Key), Option<Rc<Uneven>>>,
    /// How high a formula jumps by an operation.
    pub heights: FxHashMap<(NodeId, NodeId, Key), f64>,
    /// Whether both sides of an operation's jump agree in a formula wherever one looks, with at most so many operations.
    pub agreements: FxHashMap<(NodeId, NodeId, Key, u64), Option<bool>>,
    /// How steep a formula is at most places.
    pub slopes: FxHashMap<(NodeId, Key), f64>,
    /// How many operations it cost to look whether jumps agree.
    pub looked: u64,
    /// How many shapes within each other are looked at just now.
    pub deep: u32,
    /// How many steps of formulas it has cost to tell which parts of intersections cut nothing off.
    pub absorbing: u64,
    /// How many minima were looked at that jump as their operands do.
    pub vain_groups: usize,
}
