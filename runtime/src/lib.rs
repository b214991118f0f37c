//! Draws what the compiler emits, with wgpu, and swaps it while it runs. Knows no syntax.

#![doc = include_str!("../README.md")]

mod copied_block;
pub mod explain;
pub mod film;
pub mod frame;
pub mod gpu;
pub mod headless;
pub mod images;
pub mod live;
pub mod mesh;
mod module;
pub mod passes;
pub mod physics;
mod readback;
mod sheets;
pub mod stage;
pub mod tighten;
pub mod view;

pub use frame::Picture;
pub use gpu::{Gpu, NoAdapter, Stats};
pub use live::LiveScene;
pub use passes::evaluate::evaluate;
pub use passes::scene::ViewMode;
pub use physics::Physics;
pub use stage::Stage;
pub use view::{Showing, View};
