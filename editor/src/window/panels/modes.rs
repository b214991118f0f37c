//! The views by name: what a picture may show.

use surefoot_runtime::ViewMode;

/// What the picture may show, with words for each.
pub const MODES: [(ViewMode, &str, &str); 4] = [
    (ViewMode::Shaded, "Shaded", "the scene in its light"),
    (ViewMode::Normals, "Normals", "the surface's normals, as colours"),
    (ViewMode::Steps, "Steps", "how many steps a ray takes: dark is few"),
    (ViewMode::Depth, "Depth", "how far the surface is"),
];
/// The same, those that stand in a list.
pub const MORE: [(ViewMode, &str, &str); 8] = [
    (ViewMode::Operations, "Operations", "how many operations a ray takes: dark is few"),
    (ViewMode::Gradient, "Gradient", "how steep the field is at the surface"),
    (ViewMode::Factor, "Factor", "what of the distance a ray may go right above the surface"),
    (ViewMode::Occlusion, "Occlusion", "how much of the sky's light arrives"),
    (ViewMode::Shadow, "Shadow", "how much of the lights arrives"),
    (ViewMode::Slice(0), "Slice x", "a plane through the field, square to x"),
    (ViewMode::Slice(1), "Slice y", "a plane through the field, square to y"),
    (ViewMode::Slice(2), "Slice z", "a plane through the field, square to z"),
];
