//! The surface of a scene as triangles: closed, oriented, each edge in exactly two of them, sharp edges kept.
//!
//! The method is a dual one. Space is cut into cubic cells; those that the proven bound says to be empty are never looked at
//! (`descend.rs`), so time and memory go with the surface. In a cell the crossings of its edges are joined along its faces to loops, as
//! marching cubes do, and each loop is one vertex: dual marching cubes (Nielson 2004, "Dual Marching Cubes"). A face whose corners
//! alternate in sign is decided by the field at its saddle point (after Nielson and Hamann 1991, "The asymptotic decider"), so that both
//! of its cells see it alike (`cells.rs`). Around each edge that changes sign stands a polygon of four vertices, one from each cell about it.
//!
//! A loop is a disc, so the polygons make a closed surface. One thing is left by which an edge could be in four triangles: two cells may be
//! joined twice through an alternating face (Zint, Grosso and Gürtler 2022, "Topologically correct and manifold dual surfaces"; the
//! same is what manifold dual contouring looks for: Schaefer, Ju and Warren 2007). There each of the two gets a vertex of its own on the
//! face, so they are two edges (`join.rs`).
//!
//! A vertex stands where the tangent planes at the loop's crossings meet best, within its cell (Ju, Losasso, Schaefer and Warren 2002,
//! "Dual contouring of Hermite data"; `place.rs`). Where the surface is smooth it is moved onto it.
//!
//! [`certify`] proves how far a mesh and the surface are from each other (`certificate.rs`).

mod asked;
mod cells;
mod certificate;
mod cover;
mod descend;
mod deviation;
mod examine;
mod field;
mod join;
mod mesh;
mod near;
mod place;
mod prism;

pub use asked::Way;
pub use certificate::{Certificate, certify};
pub use examine::{Examined, Shell};
pub use mesh::{MOST_VERTICES, Mesh, Refused};
use mesh::{Grid, at};

use crate::compiled::{Compiled, Live};
use crate::vector::{Vec3, add, scale, sub};
use field::Field;

/// The most cells along the longest side.
pub const MOST_CELLS: u32 = 4096;
/// Cells along the longest side with which a tolerance is tried first.
const FIRST: u32 = 32;
/// Cells along the longest side of a loose box with which a close one is found.
const CLOSE: u32 = 48;
/// So many triangles are asked how far they are from the surface, where no tolerance is given.
const ASKED: usize = 20_000;

/// How fine a mesh is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Detail {
    /// So many cells along the longest side of what is solid.
    Cells(u32),
    /// As many as it takes so that no triangle is found farther from the surface than this.
    Tolerance(f64),
}

/// How a mesh is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// How fine it is.
    pub detail: Detail,
    /// Whether edges and corners stay sharp.
    pub sharp: bool,
    /// Least and greatest corner of a box at which the solid is cut off; without one, what has no end is refused.
    pub within: Option<[Vec3; 2]>,
}

impl std::fmt::Display for Refused {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Endless => write!(f, "what is solid has no end that is known"),
            Self::Beyond(extent) => write!(f, "nothing is known of the scene farther than {extent} from the origin along any axis"),
            Self::Empty => write!(f, "it has no surface there"),
            Self::TooMany(cells) => write!(f, "with {cells} cells along its longest side it has more than {MOST_VERTICES} vertices"),
            Self::Farther(found, cells) => {
                write!(f, "with {cells} cells along its longest side some triangle is still {found:.3e} from the surface")
            }
            Self::Torn(edges) => write!(f, "{edges} edges are not in two triangles: the field is not the same number wherever it is asked"),
            Self::Long(why) => write!(f, "{why}"),
        }
    }
}

impl std::error::Error for Refused {}

impl Grid {
    /// Cells about a box, with room on all sides. Nothing in a scene lies where these walls are: numbers that people write do not.
    fn about([low, high]: [Vec3; 2], cells: u32) -> Self {
        /// Parts of a cell.
        const ROOM: [f64; 3] = [1.618_034, std::f64::consts::SQRT_2, 1.732_051];
        let side = longest([low, high]);
        let cell = side / f64::from(cells.max(1));
        let [x, y, z] = sub(high, low);
        let count = |side: f64, room: f64| ((side / cell + 2.0 * room).ceil() as u32).max(1);
        Self { low: sub(low, scale(ROOM, cell)), cell, counts: [count(x, ROOM[0]), count(y, ROOM[1]), count(z, ROOM[2])] }
    }

    /// The least corner of a cell.
    fn corner(&self, at: [u32; 3]) -> Vec3 {
        add(self.low, scale(at.map(f64::from), self.cell))
    }
}

/// The longest side of a box.
pub(crate) fn longest([low, high]: [Vec3; 2]) -> f64 {
    sub(high, low).into_iter().fold(0.0, f64::max)
}

/// A box that holds all that is solid, or the one at which that is cut off.
pub(crate) fn room(compiled: &Compiled, within: Option<[Vec3; 2]>) -> Result<[Vec3; 2], Refused> {
    let extent = compiled.blocks.extent;
    let room = match within {
        Some(within) if within.iter().flatten().any(|c| c.abs() > extent) => return Err(Refused::Beyond(extent)),
        Some(within) => within,
        None => compiled.bounds().ok_or(Refused::Endless)?,
    };
    if longest(room) > 0.0 { Ok(room) } else { Err(Refused::Empty) }
}

/// The mesh of a scene's surface at one moment. `progress` hears the part that is done; with a tolerance, of each try.
pub fn contour(compiled: &Compiled, live: &Live, settings: &Settings, progress: &(dyn Fn(f64) + Sync)) -> Result<Mesh, Refused> {
    let room = room(compiled, settings.within)?;
    // A box that holds the solid cuts nothing off, and is kept at some way from it.
    let cut = if settings.within.is_some() { room } else { grown(room, longest(room) / f64::from(CLOSE)) };
    let field = Field::new(compiled, live, cut).map_err(Refused::Long)?;
    let close = descend::close_box(&field, &Grid::about(room, CLOSE))?;
    let close = [[0, 1, 2].map(|i| at(close[0], i).max(at(room[0], i))), [0, 1, 2].map(|i| at(close[1], i).min(at(room[1], i)))];
    let mut mesh = match settings.detail {
        Detail::Cells(cells) => {
            let mesh = with_cells(&field, close, settings, cells, progress)?;
            let every = mesh.triangles.len().div_ceil(ASKED).max(1);
            let deviation = deviation::deviation(&field, &mesh, every);
            Mesh { deviation, ..mesh }
        }
        Detail::Tolerance(most) => within_tolerance(&field, close, settings, most, progress)?,
    };
    mesh.colors = field.colors(compiled, live, &mesh).map_err(Refused::Long)?;
    Ok(mesh)
}

/// Finer and finer, until no triangle is found too far from the surface. The error falls with the square of the cells where all is smooth.
fn within_tolerance(field: &Field, close: [Vec3; 2], settings: &Settings, most: f64, progress: &(dyn Fn(f64) + Sync)) -> Result<Mesh, Refused> {
    let mut cells = FIRST;
    loop {
        let mesh = with_cells(field, close, settings, cells, progress)?;
        let found = deviation::deviation(field, &mesh, 1);
        if found <= most {
            return Ok(Mesh { deviation: found, ..mesh });
        }
        if cells >= MOST_CELLS {
            return Err(Refused::Farther(found, cells));
        }
        let finer = (1.1 * (found / most).sqrt()).clamp(1.3, 3.0);
        cells = ((f64::from(cells) * finer).ceil() as u32).min(MOST_CELLS);
    }
}

fn with_cells(field: &Field, close: [Vec3; 2], settings: &Settings, cells: u32, progress: &(dyn Fn(f64) + Sync)) -> Result<Mesh, Refused> {
    let cells = cells.clamp(2, MOST_CELLS);
    let grid = Grid::about(close, cells);
    let bricks = descend::descend(field, &grid)?.ok_or(Refused::TooMany(cells))?;
    progress(0.05);
    let patches = cells::patches(field, &grid, bricks, settings.sharp, &|part| progress(0.05 + 0.75 * part));
    let patches = patches.ok_or(Refused::TooMany(cells))?;
    let (vertices, normals, triangles) = join::join(field, &grid, &patches, &|part| progress(0.8 + 0.15 * part));
    if triangles.is_empty() {
        return Err(Refused::Empty);
    }
    let mesh = Mesh { vertices, normals, triangles, cell: grid.cell, cells, ..Mesh::default() };
    match mesh.torn_edges() {
        0 => Ok(mesh),
        torn => Err(Refused::Torn(torn)),
    }
}

fn grown([low, high]: [Vec3; 2], by: f64) -> [Vec3; 2] {
    [low.map(|c| c - by), high.map(|c| c + by)]
}

