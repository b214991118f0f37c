//! The texts that come with the language: the prelude, which every scene has, and the parts, which a scene imports.

use crate::source::{FileId, Span};

/// The prelude: name and text of each of its files.
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

/// The parts: name and text of each file that `import "std/NAME.sdf"` brings.
pub const PARTS: &[(&str, &str)] = &[
    ("<std>/threads.sdf", include_str!("../std/threads.sdf")),
    ("<std>/gears.sdf", include_str!("../std/gears.sdf")),
    ("<std>/fasteners.sdf", include_str!("../std/fasteners.sdf")),
    ("<std>/profiles.sdf", include_str!("../std/profiles.sdf")),
    ("<std>/noise.sdf", include_str!("../std/noise.sdf")),
    ("<std>/fractals.sdf", include_str!("../std/fractals.sdf")),
    ("<std>/plants.sdf", include_str!("../std/plants.sdf")),
];

/// The part of a path that is imported, `std/NAME.sdf`: its text and its name. None where the path names no part.
pub fn part(path: &str) -> Option<(FileId, &'static str)> {
    let wanted = path.strip_prefix("std/")?;
    let at = PARTS.iter().position(|(name, _)| name.strip_prefix("<std>/") == Some(wanted))?;
    Some((FileId((PRELUDE.len() + at) as u32), PARTS.get(at)?.0))
}

/// Whether a place is in a text that comes with the language: those come first, the prelude before the parts.
pub fn in_prelude(span: Span) -> bool {
    (span.file.0 as usize) < PRELUDE.len() + PARTS.len()
}

/// Whether a text is one of the prelude.
pub fn is_prelude(file: FileId) -> bool {
    (file.0 as usize) < PRELUDE.len()
}

/// Whether a field of the prelude is meant as a number that varies, and not as a shape.
pub fn is_of_numbers(name: &str) -> bool {
    name == "only_in"
}
