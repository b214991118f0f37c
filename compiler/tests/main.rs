//! The tests of the compiler, in one program: it is linked once, and both cores always have a test to run.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]

mod ablation;
mod absorbed;
mod ahead;
mod balls;
mod certificate;
mod certify;
mod common;
mod computed;
mod contour;
mod corpus;
mod cost;
mod distance;
mod emitted;
mod factors;
mod figures;
mod gaps;
mod goldens;
mod holes;
mod looks;
mod measure;
mod outlines;
mod parts;
mod pick;
mod prelude;
mod ranges;
mod reference;
mod refused;
mod rules;
mod scene_pass;
mod shaders;
mod sound;
mod tightness;
mod verify;
mod wgsl;
