//! Flat faces of shapes, and what is known of them.

use crate::analysis::Box3;
use crate::graph::ShapeId;
use std::rc::Rc;

/// Numbers that differ by less, as a share of their size, differ by rounding: constants have 32 bits.
pub const ROUNDING: f64 = 2e-7;

/// A flat face across an axis: all of the solid lies where the coordinate times `outward`, which is 1 or -1, is at most `at`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Face {
    pub axis: usize,
    pub outward: f64,
    pub at: f64,
    /// All of it lies in here.
    pub within: Box3,
}

impl Face {
    /// Whether both lie in one plane, but for rounding, and their solids on the same side of it.
    pub fn is_flush_with(&self, other: &Face) -> bool {
        let near = ROUNDING * (1.0 + self.at.abs());
        self.axis == other.axis && self.outward == other.outward && (self.at - other.at).abs() <= near
    }

    /// How far another face of the same plane is away from it.
    pub fn gap(&self, other: &Face) -> f64 {
        let apart = |axis: usize| {
            let (a, b) = (self.within.axis(axis), other.within.axis(axis));
            (b.lo - a.hi).max(a.lo - b.hi).max(0.0)
        };
        (0..3).filter(|axis| *axis != self.axis).map(apart).fold(0.0, f64::hypot)
    }

    /// How far a box reaches in the direction in which the face looks.
    pub fn end(&self, of: &Box3) -> f64 {
        let side = of.axis(self.axis);
        if self.outward > 0.0 { side.hi } else { -side.lo }
    }
}

/// What is known of a shape's faces.
#[derive(Clone, Debug)]
pub struct Faces {
    pub flat: Rc<[Face]>,
    /// All of it lies in here, but for what a blend adds.
    pub region: Box3,
    /// The same without its cuts.
    pub uncut: ShapeId,
    /// Where it was cut off.
    pub cuts: Rc<[Face]>,
    /// Whether it is a blend of two.
    pub joined: bool,
    /// How many cuts stand within others.
    pub within: usize,
}
