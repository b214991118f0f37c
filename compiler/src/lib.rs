//! From the text of a signed distance field to proven WGSL.

#![doc = include_str!("../README.md")]

pub mod ablation;
pub mod analysis;
pub mod blocks;
pub mod by_hand;
pub mod camera;
pub mod cells;
pub mod certify;
pub mod compiled;
pub mod contour;
pub mod diagnostic;
pub mod emit;
pub mod evaluate;
pub mod factors;
pub mod figure;
pub mod followed;
pub mod frame;
pub mod functions;
pub mod graph;
mod home;
pub mod images;
pub mod interface;
pub mod kept;
pub mod language_service;
pub mod live;
pub mod loader;
pub mod measure;
pub mod mesh;
pub mod outline;
pub mod outlook;
pub mod physics;
pub mod pick;
pub mod pipeline;
pub mod program;
pub mod prelude;
pub mod random;
pub mod reference;
pub mod rules;
pub mod reference_text;
pub mod sampled;
pub mod shading;
pub mod shader;
pub mod section;
pub mod skipped;
pub mod solid;
pub mod source;
mod spread;
pub mod srgb;
pub mod syntax;
pub mod unit;
pub mod vector;
pub mod verify;

pub use compiled::{Compiled, Export, Frame, Live, Loader, MemoryLoader, Module, Options, Outcome};
pub use analysis::analysis_cache::Memory;
pub use pipeline::{compile, compile_observed, compile_remembering, Stage};
