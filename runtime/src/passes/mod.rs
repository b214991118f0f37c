//! The fixed passes: each one a `.wgsl` file beside its Rust file, put after an emitted module, whose functions it calls.

mod balls;
pub mod evaluate;
mod pipeline;
pub mod rays;
pub mod scene;
mod surroundings;

pub use balls::BallsPipeline;
pub use pipeline::ScenePipeline;
