//! Area, volume, centre and pieces by meshes that become finer.
//!
//! Vertices of a mesh stand on the surface, so what it measures is off by the square of its cells, and by chance. A line through what some meshes say over
//! that square tells what would be measured without cells (Richardson's extrapolation, by least squares); how far they are from the line tells the error.

use super::known::{FINE, Known, Piece, Settings};
use crate::compiled::{Compiled, Live};
use crate::contour::{self, Detail, Mesh, Refused, Shell, contour, longest};
use crate::vector::{Vec3, add, length, scale, sub};

/// Cells along the longest side of the meshes.
const CELLS: [u32; 10] = [64, 76, 90, 107, 128, 152, 181, 215, 256, 304];
/// Meshes that make the line.
const LINE: usize = 5;
/// So many times the standard deviation of the line's end is the error: by Student's distribution of three degrees of freedom, 99 in a hundred are less.
const SURE: f64 = 5.84;
/// A part of what the finest mesh is corrected by counts as error at least.
const LEAST: f64 = 0.02;

/// What the surface says.
pub(super) struct Surface {
    pub volume: Known,
    pub area: Known,
    pub centre: [Known; 3],
    pub pieces: Vec<Piece>,
    pub settled: bool,
    pub cell: f64,
    /// How far the finest mesh was found to be from the surface.
    pub deviation: f64,
    pub cells: Vec<u32>,
    /// The outermost corners of the finest mesh, lower and upper by axis, and the ways into the solid there, a cell long.
    pub outer: Vec<[Vec3; 2]>,
}

/// What hangs together, as one mesh has it.
#[derive(Clone, Copy)]
struct Body {
    volume: f64,
    area: f64,
    moment: Vec3,
    euler: i64,
    cavities: usize,
    bounds: [Vec3; 2],
}

/// A mesh, measured.
struct Look {
    cell: f64,
    cells: u32,
    deviation: f64,
    bodies: Vec<Body>,
    outer: Vec<[Vec3; 2]>,
}

impl Look {
    fn of(mesh: &Mesh) -> Self {
        Self { cell: mesh.cell, cells: mesh.cells, deviation: mesh.deviation, bodies: bodies(mesh), outer: outer(mesh) }
    }

    fn volume(&self) -> f64 {
        self.bodies.iter().map(|body| body.volume).sum()
    }

    fn area(&self) -> f64 {
        self.bodies.iter().map(|body| body.area).sum()
    }

    fn centre(&self) -> Vec3 {
        let moment = self.bodies.iter().fold([0.0; 3], |sum, body| add(sum, body.moment));
        scale(moment, 1.0 / self.volume())
    }
}

/// Meshes of more and more cells, until the area is known as well as lengths shall be, or until one of them would be too large.
pub(super) fn surface(
    compiled: &Compiled,
    live: &Live,
    asked: &Settings,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Surface, Refused> {
    let mut looks: Vec<Look> = Vec::new();
    let mut done = 0.0;
    for cells in CELLS {
        let share = (1.0 - done) / LINE as f64;
        let settings = contour::Settings { detail: Detail::Cells(cells), sharp: true, within: asked.within };
        let mesh = match contour(compiled, live, &settings, &|part| progress(done + share * part)) {
            Ok(mesh) => mesh,
            Err(Refused::TooMany(_)) if !looks.is_empty() => break,
            Err(why) => return Err(why),
        };
        done += share;
        let size = longest(mesh.examine().bounds);
        looks.push(Look::of(&mesh));
        if let Some(line) = looks.last_chunk::<LINE>() {
            // As much as another surface so far away would have, of a ball.
            let area = leads(line.each_ref().map(|look| (look.cell, look.area())));
            let tolerance = asked.tolerance.unwrap_or(FINE * size);
            if area.error <= 4.0 * tolerance * area.value / size {
                break;
            }
        }
    }
    found(&looks).ok_or(Refused::Empty)
}

fn found(looks: &[Look]) -> Option<Surface> {
    let last = looks.last()?;
    let line = looks.last_chunk::<LINE>();
    let known = |of: &dyn Fn(&Look) -> f64, scale: f64| match line {
        Some(line) => leads(line.each_ref().map(|look| (look.cell, of(look)))),
        // Too few meshes: a shell as thick as the last one's triangles are off.
        None => Known::estimated(of(last), last.deviation * scale),
    };
    let area = known(&Look::area, last.area() / last.cell);
    let volume = known(&Look::volume, last.area());
    let centre = [0, 1, 2].map(|axis| known(&|look: &Look| at(look.centre(), axis), 1.0));
    let same = |look: &Look| look.bodies.len() == last.bodies.len() && euler(look) == euler(last);
    let mut pieces: Vec<Piece> = last.bodies.iter().map(|body| piece(body, line, last)).collect();
    pieces.sort_by(|a, b| b.volume.value.total_cmp(&a.volume.value));
    let settled = looks.iter().all(same);
    Some(Surface { volume, area, centre, pieces, settled, cell: last.cell, deviation: last.deviation, cells: looks.iter().map(|look| look.cells).collect(), outer: last.outer.clone() })
}

fn euler(look: &Look) -> Vec<i64> {
    let mut all: Vec<i64> = look.bodies.iter().map(|body| body.euler).collect();
    all.sort_unstable();
    all
}

/// Where what meshes say leads without cells, by the size of a cell and what is measured with it. A line over the square of the cells, in which
/// smaller cells count more.
fn leads(looks: [(f64, f64); LINE]) -> Known {
    let last = looks[LINE - 1];
    let points = looks.map(|(cell, value)| ((cell / last.0).powi(2), value - last.1));
    // Both what is off and its chance go with the square.
    let weight = |x: f64| 1.0 / (x * x);
    let sum = |of: &dyn Fn(f64, f64) -> f64| points.iter().map(|(x, y)| weight(*x) * of(*x, *y)).sum::<f64>();
    let (w, x, y, xx, xy) = (sum(&|_, _| 1.0), sum(&|x, _| x), sum(&|_, y| y), sum(&|x, _| x * x), sum(&|x, y| x * y));
    let spread = w * xx - x * x;
    let (end, slope) = ((xx * y - x * xy) / spread, (w * xy - x * y) / spread);
    let off = sum(&|x, y| (y - end - slope * x).powi(2)) / (LINE - 2) as f64;
    let error = (SURE * (off * xx / spread).sqrt()).max(LEAST * end.abs());
    Known::estimated(last.1 + end, error)
}

/// One body: by the same of the other meshes too, where each has one there.
fn piece(body: &Body, line: Option<&[Look; LINE]>, last: &Look) -> Piece {
    let middle = |body: &Body| scale(body.moment, 1.0 / body.volume);
    let side = longest(body.bounds);
    let like = |look: &Look| {
        let near = |other: &&Body| length(sub(middle(other), middle(body))) < look.cell && (longest(other.bounds) - side).abs() < 2.0 * look.cell;
        let mut near = look.bodies.iter().filter(near);
        near.next().filter(|_| near.next().is_none()).map(|other| (look.cell, *other))
    };
    let same = line.and_then(|line| <[(f64, Body); LINE]>::try_from(line.iter().filter_map(like).collect::<Vec<_>>()).ok());
    let (volume, area) = match same {
        Some(same) => (leads(same.map(|(cell, body)| (cell, body.volume))), leads(same.map(|(cell, body)| (cell, body.area)))),
        None => (Known::estimated(body.volume, body.area * last.deviation), Known::estimated(body.area, body.area * last.deviation / last.cell)),
    };
    Piece { volume, area, euler: body.euler, cavities: body.cavities, bounds: body.bounds }
}

/// The outermost corner on each side, and the way inward there, a cell long.
fn outer(mesh: &Mesh) -> Vec<[Vec3; 2]> {
    let corners = || mesh.vertices.iter().zip(&mesh.normals);
    let out = |axis: usize, sign: f64| corners().max_by(|(a, _), (b, _)| (sign * at(**a, axis)).total_cmp(&(sign * at(**b, axis))));
    let sides = (0..3).flat_map(|axis| [-1.0, 1.0].map(|sign| out(axis, sign)));
    sides.flatten().map(|(place, normal)| [*place, scale(normal.map(f64::from), -mesh.cell)]).collect()
}

fn at(of: Vec3, axis: usize) -> f64 {
    of.get(axis).copied().unwrap_or(0.0)
}

/// The solids of a mesh: each surface that faces outward, with those inside of it that face inward.
fn bodies(mesh: &Mesh) -> Vec<Body> {
    let (outer, inner): (Vec<Shell>, Vec<Shell>) = mesh.shells().into_iter().partition(|shell| shell.volume > 0.0);
    let body = |shell: &Shell| Body { volume: shell.volume, area: shell.area, moment: shell.moment, euler: shell.euler, cavities: 0, bounds: shell.bounds };
    let mut bodies: Vec<Body> = outer.iter().map(body).collect();
    for cavity in &inner {
        let point = cavity.triangles.first().map(|t| mesh.corners(t)[0]).unwrap_or_default();
        let about = |shell: &Shell| {
            let holds = shell.bounds[0].iter().zip(point).all(|(low, c)| *low <= c) && shell.bounds[1].iter().zip(point).all(|(high, c)| c <= *high);
            holds && shell.volume + cavity.volume > 0.0 && mesh.winding(shell, point) != 0
        };
        // The smallest that holds it.
        let holder = outer.iter().zip(&mut bodies).filter(|(shell, _)| about(shell)).min_by(|(a, _), (b, _)| a.volume.total_cmp(&b.volume));
        match holder {
            Some((_, body)) => {
                body.volume += cavity.volume;
                body.area += cavity.area;
                body.moment = add(body.moment, cavity.moment);
                body.euler += cavity.euler;
                body.cavities += 1;
            }
            None => bodies.push(body(cavity)),
        }
    }
    bodies
}
