//! Facts about the graph: ranges, regions, Lipschitz constants.
//!
//! Everything here holds for the whole range of every parameter and for any time. From the ground up: boxes and duals, tapes and what the rules read in
//! them, [`Facts`] that keep what was found, ranges and derivatives, constants and regions, searches.

mod account;
pub mod analysis_cache;
mod branches;
pub mod chain;
pub mod constant;
pub mod domain;
pub mod derivative;
pub mod dual;
mod duals;
mod facts;
pub mod formula;
mod hc4_projections;
mod matrix;
mod outlines;
pub(crate) mod products;
mod ranges;
pub mod region;
mod remembered;
mod rigid_transform;
pub mod rules;
pub mod search;
mod slopes;
pub mod tape;
pub mod unbounded_blame;

pub use analysis_cache::Sampled;
pub use domain::{Box3, Domain, Key, Pinned, call_domain, cell_ranges, leaf_range};
pub use dual::{Constant, leaf_dual};
pub use facts::Facts;
pub use rigid_transform::Placed;
pub use rules::noise_cells::has_cells;
