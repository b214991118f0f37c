//! Figures in space: curves of straight pieces and arcs, and closed surfaces of triangles, each with the way to what is nearest of it.
//!
//! [`line`] makes chains of arcs of what a person writes, [`face`] closes a surface, [`hull`] finds the hull of points and [`balls`] that of balls; [`tree`] finds
//! what is nearest. The kernel's operation `Figured` reads a [`Figure`] by its number. Plain data in, plain data out.

mod balls;
mod bow;
mod face;
mod hull;
mod line;
mod polygon;
mod tree;

pub use balls::{Ball, Part, parts};
pub use bow::{Bow, turn};
pub use face::{Face, closed};
pub use hull::{MOST_POINTS, hull};
pub use line::{Frame, Line, MOST_BOWS, Stretch};
pub use polygon::triangles;
pub use tree::{Figure, Found};
