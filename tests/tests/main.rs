//! The end-to-end tests, in one program: it is linked once, and all cores always have a test to run.
//!
//! Tests that count memory, measure time or change what surrounds them are programs of their own: `Cargo.toml` names them.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]

mod balls;
mod capture;
mod common;
mod corpus;
mod draw;
mod figures;
mod house;
mod imports;
mod looks;
mod mesh_fields;
mod mesh_materials;
mod meshes;
mod names;
mod neighbours;
mod numbers;
mod opengl;
mod operations;
mod outlines;
mod pictures;
mod random;
mod sampled;
mod section;
mod shaders;
mod shadows;
mod still;
mod textures;
mod unions;
mod verify;
