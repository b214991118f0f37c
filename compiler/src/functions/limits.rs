//! The numbers that several rules of the functions go by.

/// Boxes that one constant may cost.
pub(super) const BUDGET: usize = 192;
/// How far a ray steps across a jump, for each unit of the size of what jumps: more than 32 bits can lose.
pub(super) const HAIR: f64 = 4e-6;
/// How far a ray steps across a jump at most.
pub(crate) const LONGEST_HAIR: f64 = 25.0 * HAIR;
/// A formula that is steeper than this has no bound that is of any use.
pub(super) const STEEPEST: f64 = 1e4;
/// A constant over all space up to here is not worth a region.
pub(super) const GENTLE: f64 = 1.2;
/// A formula of more steps than this is given a region only where much is gained.
pub(super) const LONG: usize = 150;
/// So far out lies whatever is solid anywhere.
pub(super) const ANYWHERE: f64 = 1e30;
/// So many parts of a union are asked whether they have a width.
pub(super) const MOST_PARTS: usize = 256;
/// Points at which a formula is looked at where nothing is proven.
pub(super) const SAMPLES: usize = 4096;
/// A constant up to here counts as one.
pub(super) const UNIT: f64 = 1.0 + 1e-6;
