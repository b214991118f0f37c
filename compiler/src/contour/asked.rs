//! What a certificate asks of each direction, and what is proven of one.

use super::Mesh;
use crate::certify::{Box3, Truth};
use crate::sampled::Boxes;
use crate::vector::Vec3;

/// What is proven of one direction: from all of one thing, the surface or the mesh, to the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Way {
    /// No point is farther from the other than this; infinite where nothing is known of some part.
    pub proven: f64,
    /// The part of which no less is known lies here.
    pub at: Vec3,
    /// How many parts there are: cells through which the surface may go, or triangles.
    pub parts: usize,
    /// Parts for which neither the tolerance is proven nor that they are farther.
    pub undecided: usize,
    /// Parts of which some point is proven to be farther than the tolerance.
    pub farther: usize,
    /// Some point is proven to be as far as this.
    pub at_least: f64,
    /// It lies here; where no part is proven to be farther, the middle of some undecided one.
    pub wrong: Option<Vec3>,
}

impl Way {
    pub(super) const NOTHING: Self =
        Self { proven: 0.0, at: [0.0; 3], parts: 0, undecided: 0, farther: 0, at_least: 0.0, wrong: None };

    /// What is known of two sets of parts together.
    pub(super) fn and(self, other: Self) -> Self {
        let far = if other.proven > self.proven { &other } else { &self };
        let wrong = match (self.farther, other.farther) {
            (0, 0) => self.wrong.or(other.wrong),
            _ if self.at_least >= other.at_least => self.wrong,
            _ => other.wrong,
        };
        Self {
            proven: far.proven,
            at: far.at,
            parts: self.parts + other.parts,
            undecided: self.undecided + other.undecided,
            farther: self.farther + other.farther,
            at_least: self.at_least.max(other.at_least),
            wrong,
        }
    }

    /// Whether all parts are proven to be within the tolerance.
    pub fn holds(&self) -> bool {
        self.undecided == 0 && self.farther == 0
    }
}

/// What both directions need.
pub(super) struct Asked<'a> {
    pub truth: &'a Truth,
    pub boxes: &'a Boxes,
    pub mesh: &'a Mesh,
    /// Where the surface is looked for.
    pub room: Box3,
    /// Whether the solid is cut off at the walls of the room.
    pub cut: bool,
    pub tolerance: f64,
    /// Less than this is not tried to be proven.
    pub fine: f64,
}
