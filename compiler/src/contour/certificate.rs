//! What intervals prove of a mesh: how far it is from the surface at most, and the surface from it.
//!
//! The surface is where the field of the scene, cut off at the box that the mesh is cut off at, changes its sign. One direction covers space
//! with cells and shows of each that all of the surface in it is near to triangles (`cover.rs`); so no piece of surface was missed that is
//! not near to the mesh all over. The other shows of each triangle that the field has different signs beside it (`near.rs`).
//!
//! Each part of either has a number that its distance does not exceed, so the largest of them is proven of the whole. Work is counted and
//! not timed, and a part that would take more is undecided: its number may be larger than what was asked for.

use super::asked::{Asked, Way};
use super::{Mesh, cover, near};
use crate::certify::Truth;
use crate::compiled::{Compiled, Live};
use crate::evaluate::TooLarge;
use crate::graph::interval::Interval;
use crate::sampled::{Boxes, Triangle};
use crate::vector::Vec3;

/// Operations of the field once every call is replaced by its formula.
const LARGEST: usize = 4_000_000;
/// What is tried to be proven first: this part of a cell, or the tolerance if that is less.
const FINE: f64 = 1.0 / 32.0;

/// What is proven of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Certificate {
    /// What was asked for.
    pub tolerance: f64,
    /// From the surface to the mesh, cell by cell.
    pub to_mesh: Way,
    /// From the mesh to the surface, triangle by triangle.
    pub to_surface: Way,
}

impl Certificate {
    /// Whether the tolerance is proven of all of both.
    pub fn holds(&self) -> bool {
        self.to_mesh.holds() && self.to_surface.holds()
    }
}

/// Proves what can be proven of the mesh of a scene at one moment. `within` is the box at which it is cut off, where there is one; else the surface is
/// looked for in the scene's whole extent. `tolerance` is above zero. `progress` hears the part that is done.
pub fn certify(
    compiled: &Compiled,
    live: &Live,
    mesh: &Mesh,
    within: Option<[Vec3; 2]>,
    tolerance: f64,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Certificate, TooLarge> {
    let truth = Truth::new(compiled, live, LARGEST)?;
    let triangles: Vec<Triangle> = mesh.triangles.iter().map(|t| Triangle::new(mesh.corners(t))).collect();
    let boxes = Boxes::new(&triangles);
    drop(triangles);
    let extent = compiled.blocks.extent;
    let [low, high] = within.unwrap_or([[-extent; 3], [extent; 3]]);
    let room = [Interval::new(low[0], high[0]), Interval::new(low[1], high[1]), Interval::new(low[2], high[2])];
    let fine = (FINE * mesh.cell).min(tolerance);
    let asked = Asked { truth: &truth, boxes: &boxes, mesh, room, cut: within.is_some(), tolerance, fine };
    let to_surface = near::near(&asked, &|part| progress(0.5 * part));
    let to_mesh = cover::cover(&asked, &|part| progress(0.5 + 0.5 * part));
    Ok(Certificate { tolerance, to_mesh, to_surface })
}
