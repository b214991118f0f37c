//! The fixed passes: each one a `.wgsl` file beside its Rust file, put after an emitted module, whose functions it calls.

pub mod evaluate;
mod pipeline;
pub mod scene;

pub use pipeline::ScenePipeline;
