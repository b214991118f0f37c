//! What the end-to-end tests share.

pub mod mutations;
pub mod programs;
