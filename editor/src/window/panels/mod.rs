//! The panels. Each reads the session and pushes commands.

mod advice;
mod assist;
pub mod balls;
pub mod cursor;
mod colors;
pub mod help;
mod history;
pub mod icons;
pub mod lines;
pub mod measures;
mod menus;
pub mod notes;
mod numbers;
pub mod parameters;
pub mod paths;
pub mod picked;
pub mod picture;
pub mod problems;
pub mod questions;
mod ray;
mod renaming;
pub mod search;
pub mod source;
pub mod start;
pub mod status;
mod tabs;
pub mod toolbar;
