//! A scene as it is drawn in 64 bits: its formulas, and what of it is shown.

use super::ahead::PlanesApart;
use super::march::Ray;
use crate::analysis::Box3;
use crate::evaluate::Tape;
use crate::functions::Surface;
use crate::images::Images;
use crate::interface::Rounding;

/// What a picture shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum View {
    /// The scene in its light.
    #[default]
    Shaded,
    /// The normals, each component from -1..1 to 0..1.
    Normals,
    /// How many steps a ray takes.
    Steps,
    /// How many operations a ray takes: on the GPU those that are done, in the branches and cells that it comes through; here all of a formula for each look.
    Operations,
    /// How far the surface is.
    Depth,
    /// How steep the field is at the surface.
    Gradient,
    /// What of the distance a ray may go right above the surface: where it is not all of it, a factor is at work.
    Factor,
    /// How much of the sky's light arrives.
    Occlusion,
    /// How much of the lights arrives.
    Shadow,
    /// A plane through the field, square to the axis of this number, at [`Live::slice`](crate::live::Live::slice); nothing is before it.
    Slice(u8),
}

/// A rectangle of a picture's pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Area {
    /// First column.
    pub left: u32,
    /// First row, from the top.
    pub top: u32,
    /// Number of columns.
    pub width: u32,
    /// Number of rows.
    pub height: u32,
}

/// What a ray met.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hit {
    /// How far along the ray; where it ended if it met nothing.
    pub t: f64,
    /// Whether it met the surface.
    pub hit: bool,
    /// How often it looked.
    pub steps: u32,
}

/// The most operations of a function at one point.
pub(super) const LIMIT: usize = 2_000_000;

/// Rays are led together in squares of so many pixels a side.
pub(super) const BLOCK: u32 = 32;

/// Bound and distance of what rays follow: of all, or where planes are met apart of everything else.
#[derive(Clone, Debug)]
pub(super) struct Rest {
    pub(super) bound: Tape,
    pub(super) distance: Tape,
    /// Both.
    pub(super) both: Tape,
}

/// A scene's functions at one moment, ready for any number of points.
#[derive(Clone, Debug)]
pub struct Reference {
    pub(super) field: Tape,
    pub(super) bound: Tape,
    pub(super) distance: Tape,
    /// What rays follow.
    pub(super) rest: Rest,
    pub(super) planes: Option<PlanesApart>,
    /// A box about all that is solid, but planes.
    pub(super) region: Option<Box3>,
    pub(super) gradient: Option<Tape>,
    pub(super) surface: Tape,
    /// What lies on the surface, where anything does: [`Surface::layer_nodes`].
    pub(super) layers: Option<(Surface, Tape)>,
    /// How much light goes through the surface, and the index of refraction, where any does.
    pub(super) glass: Option<Tape>,
    pub(super) images: Images,
    /// Whether the estimate of the distance may be much less than it ([`crate::emit::tracer::Ways::loose`]).
    pub(super) loose: bool,
    /// Whether a light has a place ([`crate::emit::tracer::Ways::lamps`]).
    pub(super) lamps: bool,
    /// What rounding of the module grows with.
    pub(super) rounding: Rounding,
}

/// The rays that met something, with their numbers.
pub(super) fn numbered<'a>(rays: &'a [Ray], hits: &'a [Hit]) -> Vec<(usize, &'a Ray, &'a Hit)> {
    let all = rays.iter().zip(hits).enumerate();
    all.filter_map(|(i, (ray, hit))| hit.hit.then_some((i, ray, hit))).collect()
}
