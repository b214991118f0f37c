//! The texts of the standard library.

use crate::source::Span;

/// The standard library: name and text of each of its files.
pub const PRELUDE: &[(&str, &str)] = &[
    ("<prelude>/numbers.sdf", include_str!("../prelude/numbers.sdf")),
    ("<prelude>/primitives.sdf", include_str!("../prelude/primitives.sdf")),
    ("<prelude>/drawings.sdf", include_str!("../prelude/drawings.sdf")),
    ("<prelude>/curves.sdf", include_str!("../prelude/curves.sdf")),
    ("<prelude>/blends.sdf", include_str!("../prelude/blends.sdf")),
    ("<prelude>/placement.sdf", include_str!("../prelude/placement.sdf")),
    ("<prelude>/warps.sdf", include_str!("../prelude/warps.sdf")),
    ("<prelude>/noise.sdf", include_str!("../prelude/noise.sdf")),
];

/// Whether a place is in the prelude, whose texts come first.
pub fn in_prelude(span: Span) -> bool {
    (span.file.0 as usize) < PRELUDE.len()
}
