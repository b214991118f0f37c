//! The panels. Each reads the session and pushes commands.

mod assist;
pub mod balls;
pub mod cursor;
mod history;
pub mod icons;
pub mod legend;
pub mod lines;
pub mod measures;
pub mod notes;
pub mod parameters;
pub mod picked;
pub mod picture;
pub mod problems;
pub mod questions;
mod ray;
mod renaming;
pub mod search;
pub mod source;
pub mod status;
pub mod toolbar;
