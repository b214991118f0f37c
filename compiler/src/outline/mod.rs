//! Drawings with an outline of curves: letters, paths, logos. Plain data in, plain data out.
//!
//! [`boundary`] makes of closed contours what bounds the region that they fill; [`Outline`] answers how far a place is from it and on which side.

mod cells;
mod clean;
mod curve;
mod path;
mod svg;
mod text;

pub use cells::{Nearest, Outline};
pub use clean::{Fill, MOST_CURVES, Piece, boundary};
pub use curve::{Curve, Vec2};
pub use path::{contours, path};
pub use svg::{Logo, MOST_SVG, Refused, svg};
pub use text::{Align, Typesetting, typeset};
