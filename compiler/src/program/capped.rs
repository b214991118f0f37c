//! The value of a repetition where it may be only a cap.

use crate::graph::NodeId;
use crate::source::Span;

/// The value of a repetition that does not look at all copies.
pub(super) struct Capped {
    /// The lesser of the next two.
    pub value: NodeId,
    /// The least of the copies that are looked at.
    pub nearest: NodeId,
    /// What any other copy is at least.
    pub cap: NodeId,
    /// The least value of the cap.
    pub least: f64,
    /// Where a person wrote it.
    pub place: Span,
}
