//! What a solid measures at one moment: its box, volume, area, centre of mass and pieces, and what a line meets of it, each with its error.
//!
//! The box, the volume, the centre of mass and the ways along a line are proven, by intervals of the field alone (`extent.rs`, `volume.rs`,
//! `line.rs`). Walls and gaps are proven from above (`walls.rs`). The area is estimated: meshes of the surface become finer, and their areas lead to the one without cells (`surface.rs`). The same is
//! done for volume and centre of mass, and counts where it says more than what is proven within the work that is allowed; it is held within that then.

mod clip;
mod extent;
mod known;
mod line;
mod surface;
mod volume;
mod walls;

pub use known::{Known, Piece, Settings};
pub use line::{Line, Way};
pub use walls::{Across, Walls};

use crate::certify::Truth;
use crate::compiled::{Compiled, Live};
use crate::contour::{self, Refused};
use crate::graph::interval::Interval;
use crate::vector::Vec3;
use known::FINE;

/// Operations of the field once every call is replaced by its formula.
const LARGEST: usize = 4_000_000;
/// What a number of a scene is rounded by, in 32 bits, relative.
const ROUNDED: f64 = 1.0 / (1 << 24) as f64;

/// What a solid measures.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Least and greatest corner of its box.
    pub bounds: [[Known; 3]; 2],
    /// Its volume.
    pub volume: Known,
    /// The area of its surface.
    pub area: Known,
    /// Its centre of mass, where it is the same stuff all over.
    pub centre: [Known; 3],
    /// What hangs together, the largest first.
    pub pieces: Vec<Piece>,
    /// Whether meshes of all cells have the same pieces and Euler numbers.
    pub settled: bool,
    /// The cells of the finest mesh: what is smaller may be missing among the pieces.
    pub cell: f64,
    /// Cells along the longest side, of all meshes.
    pub cells: Vec<u32>,
    /// What the line meets.
    pub line: Option<Line>,
    /// The thinnest wall and the narrowest gap, where they are asked for.
    pub walls: Option<Walls>,
    /// What lengths shall be known to.
    pub tolerance: f64,
}

/// A box that holds what is solid at this moment, of a scene that has no end that is known at all times and for all values of its parameters.
pub fn ends_now(compiled: &Compiled, live: &Live) -> Option<[Vec3; 2]> {
    if compiled.bounds().is_some() {
        return None;
    }
    ends(compiled, &Truth::new(compiled, live, LARGEST).ok()?)
}

fn ends(compiled: &Compiled, truth: &Truth) -> Option<[Vec3; 2]> {
    let extent = compiled.blocks.extent;
    if compiled.bounds().is_some() {
        return None;
    }
    let sides = extent::extent(truth, [Interval::new(-extent, extent); 3], &[])?;
    let [low, high] = [sides.map(|[low, _]| low.lo), sides.map(|[_, high]| high.hi)];
    let beside = 1e-3 * contour::longest([low, high]);
    let held = [low.map(|c| c - beside), high.map(|c| c + beside)];
    held.iter().flatten().all(|c| c.abs() < extent).then_some(held)
}

/// Measures the solid of a scene at one moment. `progress` hears the part that is done.
pub fn measure(compiled: &Compiled, live: &Live, settings: &Settings, progress: &(dyn Fn(f64) + Sync)) -> Result<Measured, Refused> {
    let truth = Truth::new(compiled, live, LARGEST).map_err(Refused::Long)?;
    let within = settings.within.or_else(|| ends(compiled, &truth));
    let settings = &Settings { within, ..*settings };
    let room = contour::room(compiled, settings.within)?;
    // What ends at the box's walls may stand out by what its numbers are rounded.
    let beside = if settings.within.is_some() { 0.0 } else { 4.0 * ROUNDED * room.iter().flatten().fold(0.0, |size: f64, c| size.max(c.abs())) };
    let [low, high] = room;
    let whole = [Interval::new(low[0], high[0]), Interval::new(low[1], high[1]), Interval::new(low[2], high[2])].map(|side| side.grow(beside));
    let walls = match settings.walls {
        true => Some(walls::walls(compiled, live, (&truth, whole), settings.within, &|part| progress(0.4 * part))?),
        false => None,
    };
    let before = if settings.walls { 0.4 } else { 0.0 };
    let progress = |part: f64| progress(before + (1.0 - before) * part);
    let surface = surface::surface(compiled, live, settings, &|part| progress(0.4 * part))?;
    let sides = extent::extent(&truth, whole, &surface.outer).ok_or(Refused::Empty)?;
    progress(0.45);
    // What of the box may hold the solid.
    let held = sides.map(|[low, high]| Interval::new(low.lo, high.hi));
    let longest = contour::longest([held.map(|side| side.lo), held.map(|side| side.hi)]);
    let tolerance = settings.tolerance.unwrap_or(FINE * longest);
    let enough = tolerance * surface.area.value;
    let filled = volume::volume(&truth, held, enough, &|part| progress(0.45 + 0.55 * part));
    let line = settings.line.map(|ends| line::line(&truth, ends, whole));
    let size = held.iter().fold(0.0, |size: f64, side| size.max(side.magnitude()));
    let (by, area) = (ROUNDED * size, surface.area.value);
    // A solid point was found at the inner end, most probably one of the outermost.
    let side = |proven: Interval, found: f64| Known::proven(proven).or(Known::estimated(found, surface.deviation), tolerance).rounded(by);
    let bounds = [sides.map(|[low, _]| side(low, low.hi)), sides.map(|[_, high]| side(high, high.lo))];
    let mut estimated = surface.centre.into_iter();
    let centre = filled.centre.map(|c| {
        let known = Known::proven(c);
        estimated.next().map_or(known, |other| known.or(other, tolerance)).rounded(by)
    });
    let volume = Known::proven(filled.volume).or(surface.volume, enough).rounded(by * area);
    let mut pieces = surface.pieces;
    if let [piece] = pieces.as_mut_slice() {
        piece.volume = volume;
    }
    Ok(Measured {
        bounds,
        volume,
        area: surface.area.rounded(4.0 * by * area / longest),
        centre,
        pieces,
        settled: surface.settled,
        cell: surface.cell,
        cells: surface.cells,
        line,
        walls: walls.map(|walls| walls.rounded(2.0 * by)),
        tolerance,
    })
}
