//! What the end-to-end tests share.

pub mod clock;
pub mod mutations;
pub mod programs;
pub mod scenes;
pub mod solids;
