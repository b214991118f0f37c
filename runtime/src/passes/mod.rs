//! The fixed passes: each one a `.wgsl` file beside its Rust file, put after an emitted module, whose functions it calls.

mod balls;
mod bloom;
mod capture;
mod cones;
pub mod layers;
pub mod evaluate;
mod meshes;
mod pipeline;
pub mod rays;
pub mod scene;
mod section;
mod shadows;
mod surroundings;

pub use balls::BallsPipeline;
pub(crate) use bloom::Bloom;
pub use meshes::MeshesPipeline;
pub use pipeline::ScenePipeline;
