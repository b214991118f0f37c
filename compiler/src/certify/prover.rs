//! What is certified, and how far a search for it goes.

use super::code::{Code, Room};
use super::forward::Slot;
use super::pieces::{Branches, Piece};
use crate::graph::interval::Interval;
use std::sync::Arc;

/// A box: an interval for each axis.
pub type Box3 = [Interval; 3];

/// The field of a scene at fixed live values.
#[derive(Clone, Debug)]
pub struct Truth {
    pub(super) point: Arc<Code>,
    pub(super) ray: Code,
}

/// What is known of the field over a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Over {
    /// Holds every value.
    pub value: Interval,
    /// Holds the gradient of every piece, component by component.
    pub gradient: [Interval; 3],
    /// At least the norm of every gradient.
    pub norm: f64,
    /// Whether the field may jump in the box; between its jumps the gradient is that of the pieces.
    pub jump: bool,
}

/// Answers questions of one field. One for each thread: it holds the room in which it computes.
#[derive(Clone, Debug)]
pub struct Prover<'t> {
    pub(super) truth: &'t Truth,
    pub(super) boxes: u64,
    /// Operations that were computed, and how many may be.
    pub(super) work: u64,
    pub(super) most: u64,
    pub(super) room: Room,
    pub(super) values: Vec<f64>,
    pub(super) ranges: Vec<Interval>,
    pub(super) slots: Vec<Slot<3>>,
    pub(super) ray_slots: Vec<Slot<1>>,
    pub(super) branches: Branches<3>,
    pub(super) ray_branches: Branches<1>,
    pub(super) live: Vec<bool>,
}

/// A code that is shorter than this is not made shorter over natural intervals before its full evaluation.
pub(super) const SHORT: usize = 24;

/// What an operation over a box costs, beside one of many points at once.
pub const NATURAL: u64 = 8;

/// The same with its slopes.
pub const SLOPES: u64 = 40;

/// Branches that are looked at in one box.
pub(super) const BRANCHES: usize = 64;

/// 1 or -1 where all values are above or below zero, else 0.
pub(super) fn side(values: Interval) -> i8 {
    i8::from(values.lo > 0.0) - i8::from(values.hi < 0.0)
}

/// The hull of pieces.
pub(super) fn joined<const D: usize>(all: Option<Piece<D>>, piece: Piece<D>) -> Piece<D> {
    let Some(mut all) = all else { return piece };
    all.gradient.iter_mut().zip(piece.gradient).for_each(|(a, b)| *a = a.hull(b));
    Piece { gradient: all.gradient, norm: all.norm.max(piece.norm), jump: all.jump | piece.jump }
}
