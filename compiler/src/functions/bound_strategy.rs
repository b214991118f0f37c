//! What a formula needs in order to be a bound.

use crate::analysis::search::Target;
use crate::analysis::{Box3, Domain};
use crate::graph::Proof;

/// How a formula becomes a bound.
#[derive(Clone, Copy, Debug)]
pub(super) struct BoundStrategy {
    pub(super) constant: f64,
    pub(super) jumps: bool,
    /// The formula is trusted only here; beyond it the distance to this box is the bound.
    pub(super) region: Option<(Box3, f64)>,
    pub(super) proof: Proof,
    pub(super) over: Over,
}

impl BoundStrategy {
    /// Where its constant holds, of a formula in a domain.
    pub(super) fn holds_in(&self, domain: &Domain) -> Domain {
        match self.region {
            Some((region, reach)) => domain.at(region.grow(reach)),
            None if self.over == Over::Space => domain.at(Box3::ALL),
            None => domain.clone(),
        }
    }
}

/// Over what a constant was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Over {
    Space,
    Region,
    /// One cell of what goes by cells.
    Cell,
}

/// A constant, how it is known, and of what over which domain.
pub(super) struct Known {
    pub(super) lipschitz: f64,
    pub(super) proof: Proof,
    pub(super) search: Option<(Target, Domain)>,
}
