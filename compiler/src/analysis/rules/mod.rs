//! Rules that look at a formula more closely than step by step: a file a rule or a family. Their table is [`crate::rules`].

pub mod algebraic_enclosures;
pub mod angle_periodicity;
pub mod blend_sublevel_set;
pub mod claims;
pub mod continuous_select;
pub mod isometry;
pub mod isometry_chain;
pub mod jacobian_norm;
pub mod multilinear;
pub mod noise_cells;
pub mod normalized_vector;
pub mod period;
pub mod polar;
pub mod polar_rotation;
pub mod polytope;
pub mod radial;
pub mod rotated_distance;
pub mod soft;
pub mod sum_terms;
