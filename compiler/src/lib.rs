//! From the text of a signed distance field to proven WGSL.

pub mod analysis;
pub mod cells;
pub mod certify;
pub mod compiled;
pub mod diagnostic;
pub mod emit;
pub mod evaluate;
pub mod factors;
pub mod followed;
mod frame;
pub mod functions;
pub mod graph;
mod home;
pub mod images;
pub mod loader;
pub mod mesh;
pub mod outlook;
pub mod physics;
pub mod pipeline;
pub mod program;
pub mod prelude;
pub mod random;
pub mod reference;
pub mod reference_text;
pub mod skipped;
pub mod solid;
pub mod source;
mod spread;
pub mod srgb;
pub mod syntax;
pub mod vector;
pub mod verify;

pub use compiled::{Compiled, Export, Frame, Live, Loader, MemoryLoader, Module, Options, Outcome};
pub use analysis::memory::Memory;
pub use pipeline::{compile, compile_observed, compile_remembering, Stage};
