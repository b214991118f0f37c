//! What was found of formulas over domains, so that each is looked for once.

use crate::analysis::domain::Key;
use crate::analysis::{Box3, Domain};
use crate::functions::bound_strategy::BoundStrategy;
use crate::functions::made::Layer;
use crate::functions::outline::Outlines;
use crate::graph::kernel::Op;
use crate::graph::{MaterialId, NodeId, ShapeId};
use rustc_hash::FxHashMap;
use std::rc::Rc;

/// By formula and domain.
#[derive(Default)]
pub(super) struct Found {
    pub strategies: FxHashMap<(ShapeId, NodeId, Key, bool), Option<BoundStrategy>>,
    pub capped: FxHashMap<(NodeId, Key), Option<(NodeId, BoundStrategy)>>,
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

/// The domain that the parts of a formula with a region need, the region, and how far beyond it the formula is trusted.
pub(super) type Narrowed = (Domain, Box3, f64);

/// An intersection of which one operand need only hold where the other is at most a level.
#[derive(Clone, Debug)]
pub(super) struct Cut {
    pub wild: NodeId,
    pub tame: NodeId,
    pub level: f64,
    /// Where that is.
    pub domain: Domain,
}

/// A formula and where it is looked at.
pub(super) type OneCell = (NodeId, Domain);

/// What is known of a formula that is gentle at its surface and steep elsewhere, beside its constant.
#[derive(Clone, Debug)]
pub(super) enum Uneven {
    /// How much its slope changes for each unit of the way at most.
    Curvature(f64),
    /// Where its slope jumps, changes at once, or nothing finite is known of how it changes.
    Levels(Levels),
}

/// Levels of a value, and how steep it is where it is at most that.
#[derive(Clone, Debug, Default)]
pub(super) struct Levels {
    /// Each level with that slope, the highest first. There may be none.
    pub up_to: Vec<(f64, f64)>,
    /// They hold where the value is no less than this, the other way round.
    pub down_to: f64,
}

impl Uneven {
    /// Whether nothing is known but that it is uneven.
    pub(super) fn is_unknown(&self) -> bool {
        matches!(self, Uneven::Levels(levels) if levels.up_to.is_empty())
    }

    /// How steep it is where it is gentlest, as far as its levels say; with its curvature that need not be known.
    pub(super) fn gentlest(&self) -> f64 {
        match self {
            Uneven::Curvature(_) => 0.0,
            Uneven::Levels(levels) => levels.up_to.iter().map(|(_, steep)| *steep).fold(f64::INFINITY, f64::min),
        }
    }
}

/// The trees of one operation in a graph.
#[derive(Debug, Default)]
pub(super) struct Trees {
    /// For each node, as far as they were looked at: how many operands has the tree of one operation that ends in it.
    pub operands: Vec<u32>,
    /// Whether that is a part of a larger tree.
    pub inner: Vec<bool>,
    /// What the shapes that stand for folds do, and with which others.
    pub shapes: FxHashMap<ShapeId, Fold>,
}

/// Formulas that become functions of their own, and trees of one operation, which become loops.
#[derive(Default)]
pub(super) struct Folds {
    /// Outlines of claims, as far as they were asked for.
    pub outlines: FxHashMap<NodeId, Outlines>,
    /// Their shapes, by formula and dimensions.
    pub outlined: FxHashMap<(NodeId, u8), ShapeId>,
    /// Trees of one operation, and the shapes that stand for them.
    pub trees: Trees,
    /// The variables that stand for numbers in them which do not move, and for those in which their parts differ.
    pub still: Vec<u32>,
}

/// A shape that is one operation over many others, all at its own point.
#[derive(Debug)]
pub(super) struct Fold {
    /// The operation: one that is the same in any order.
    pub op: Op,
    /// The others.
    pub operands: Vec<ShapeId>,
}

/// Gradients by the index of their node, as far as they are known.
pub(super) type Slopes = Vec<Option<[NodeId; 3]>>;

/// Gradients, and the jumps of shapes as light sees them.
#[derive(Default)]
pub(super) struct Gradients {
    /// Gradients of nodes by the point of their space, as far as they were asked for.
    pub slopes: Slopes,
    /// The jumps of shapes.
    pub walls: FxHashMap<ShapeId, Rc<Option<NearestJump>>>,
    /// Which shapes have any in or under them.
    pub walled: FxHashMap<ShapeId, bool>,
    /// What fields are by which such shapes are told apart.
    pub beside: FxHashMap<(NodeId, bool), NodeId>,
    /// The shape whose own gradient is being made.
    pub own: Option<ShapeId>,
}

/// The jump of a shape's field that is nearest to a place.
#[derive(Debug)]
pub(super) struct NearestJump {
    /// How steep it counts as: beside the wall, by how much it jumps over a short way; zero elsewhere.
    pub steep: NodeId,
    /// The numbers by which the field may jump, and 1 or -1 with the one by which it does, as it goes up or down across the wall.
    pub across: Vec<(NodeId, NodeId)>,
}

/// Materials of surfaces, by formula.
#[derive(Default)]
pub(super) struct Materials {
    pub surfaces: FxHashMap<NodeId, Option<Look>>,
    pub looks: FxHashMap<NodeId, Looks>,
    pub dresses: FxHashMap<NodeId, Dress>,
    /// How many shapes of several materials were looked at.
    pub looked: usize,
}

/// The materials of what a formula is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Dress {
    /// Nothing has a material.
    Bare,
    /// All of the surface has this one, which says the same everywhere.
    One(MaterialId),
    /// It depends on the point.
    Many,
}

/// The numbers of a surface, and the images on it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Look {
    /// Colour, emission, roughness, metallic, reflectivity; then the relief's slope.
    pub values: [NodeId; 12],
    /// How much light goes through, and the index of refraction, where any does.
    pub glass: Option<[NodeId; 2]>,
    pub layers: Rc<[Layer]>,
}

/// The looks of the shapes that a formula calls.
#[derive(Clone)]
pub(super) enum Looks {
    /// None of them has a material.
    None,
    /// All that have a material have this one.
    One(Look),
    /// They differ.
    Many,
}

impl Looks {
    pub fn and(self, other: Self) -> Self {
        match (self, other) {
            (Looks::None, looks) | (looks, Looks::None) => looks,
            (Looks::One(a), Looks::One(b)) if a == b => Looks::One(a),
            _ => Looks::Many,
        }
    }
}
