//! The thinnest wall and the narrowest gap.
//!
//! A wall is where a way straight into the solid, perpendicular to the surface, comes out at a place that faces the other way, to within 30 degrees. Its
//! thickness is the length of that way. A gap is the same through the air, so the inside of a cavity, a hole and a groove are gaps too. What the way
//! meets at a slant, as beside an edge, is neither.
//!
//! Ways begin at the middles of a mesh's triangles, put onto the surface. [`Prover::first_hit`] follows each no farther than the shortest way so far, so
//! most of them end soon. From the shortest ones the beginning is moved along the surface, by less and less, as long as the way becomes shorter (a
//! pattern search: Hooke and Jeeves 1961, "Direct search solution of numerical and statistical problems"). That the field keeps its sign along the way is
//! proven, so the thinnest wall is no thicker than what is said. That none is thinner is estimated.

use super::known::Known;
use crate::certify::{Box3, Hit, Prover, Truth};
use crate::compiled::{Compiled, Live};
use crate::contour::{self, Detail, Mesh, Refused, contour, longest};
use crate::graph::interval::Interval;
use crate::spread::spread;
use crate::vector::{Vec3, add, along, cross, dot, length, scale};

/// Cells along the longest side of the mesh, and the triangles of it from which ways begin at most.
const CELLS: u32 = 128;
const MOST: usize = 16_000;
/// Triangles of one task.
const SHARE: usize = 250;
/// The shortest ways of so many tasks are made shorter.
const TRIED: usize = 12;
/// The cosine of the angle to within which the two ends face each other.
const FACING: f64 = 0.866_025;
/// Segments that are looked at for each way.
const BUDGET: usize = 4000;
/// As parts of the longest side: how far from the surface a way begins, how near the beginning is to the surface, and the last step by which it is moved.
const BEGIN: f64 = 1e-6;
const NEAR: f64 = 1e-10;
const LAST: f64 = 1e-5;
/// Ways that are tried from one beginning at most.
const STEPS: usize = 600;

/// A way straight across a wall or a gap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Across {
    /// How long it is. What is proven: the least of all is no longer than this one.
    pub length: Known,
    /// Where it begins, perpendicular to the surface, and where it ends.
    pub ends: [Vec3; 2],
}

/// The thinnest wall and the narrowest gap; none where there is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Walls {
    /// Through the solid.
    pub wall: Option<Across>,
    /// Through the air.
    pub gap: Option<Across>,
    /// The cells of the mesh: a wall or a gap that is smaller may be missed.
    pub cell: f64,
}

impl Walls {
    /// With so much more error of each length.
    pub(super) fn rounded(self, by: f64) -> Self {
        let more = |across: Across| Across { length: across.length.rounded(by), ..across };
        Self { wall: self.wall.map(more), gap: self.gap.map(more), ..self }
    }
}

/// What is followed: through what, in which box, how large that is.
#[derive(Clone, Copy)]
struct Search {
    solid: bool,
    whole: Box3,
    size: f64,
}

/// A way.
#[derive(Clone, Copy)]
struct Way {
    from: Vec3,
    direction: Vec3,
    long: f64,
}

/// The place and the field's slope, of length one, where a point is put onto the surface; none where it has no slope that is sure.
fn on_surface(prover: &mut Prover<'_>, mut point: Vec3, size: f64) -> Option<(Vec3, Vec3)> {
    for _ in 0..6 {
        let over = prover.over(point.map(Interval::point));
        let slope = over.gradient.map(Interval::middle);
        let steep = length(slope);
        let sure = over.gradient.iter().all(|side| side.is_finite() && side.width() <= 0.1 * steep);
        if !sure || steep <= 0.0 {
            return None;
        }
        let off = over.value.middle() / steep;
        if off.abs() <= NEAR * size {
            return Some((point, scale(slope, 1.0 / steep)));
        }
        point = along(point, slope, -off / steep);
    }
    None
}

impl Search {
    /// The way from a place near the surface, where it is shorter than `far` and ends at a place that faces its beginning.
    fn way(self, prover: &mut Prover<'_>, near: Vec3, far: f64) -> Option<Way> {
        let (from, out) = on_surface(prover, near, self.size)?;
        let direction = if self.solid { scale(out, -1.0) } else { out };
        let begin = BEGIN * self.size;
        if far <= begin || (prover.value(along(from, direction, begin)) < 0.0) != self.solid {
            return None;
        }
        let Hit::Hit(long) = prover.first_hit(from, direction, begin, far, BUDGET) else { return None };
        let end = along(from, direction, long);
        let inside = end.iter().zip(&self.whole).all(|(c, side)| side.contains(*c));
        let (_, out) = on_surface(prover, end, self.size).filter(|_| inside)?;
        let facing = if self.solid { dot(out, direction) } else { -dot(out, direction) };
        (facing >= FACING).then_some(Way { from, direction, long })
    }

    /// The shortest way from some triangles.
    fn shortest(self, prover: &mut Prover<'_>, mesh: &Mesh, triangles: &[[u32; 3]]) -> Option<Way> {
        let mut best: Option<Way> = None;
        for triangle in triangles {
            let [a, b, c] = mesh.corners(triangle);
            let middle = scale(add(a, add(b, c)), 1.0 / 3.0);
            // One that is as long is no shorter.
            let far = best.map_or(2.0 * self.size, |best| best.long * (1.0 - 1e-9));
            best = self.way(prover, middle, far).or(best);
        }
        best
    }

    /// A way made shorter by moving its beginning along the surface, and the last step.
    fn shortened(self, prover: &mut Prover<'_>, mut way: Way, mut step: f64) -> (Way, f64) {
        let last = LAST * self.size;
        let mut tried = 0;
        while step > last && tried < STEPS {
            let n = way.direction;
            let side = if n.iter().take(1).all(|c| c.abs() < 0.6) { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
            let u = cross(n, side);
            let u = scale(u, 1.0 / length(u));
            let v = cross(n, u);
            let shorter = (0..8).find_map(|i| {
                tried += 1;
                let (sin, cos) = (f64::from(i) * std::f64::consts::FRAC_PI_4).sin_cos();
                let beside = along(along(way.from, u, step * cos), v, step * sin);
                self.way(prover, beside, way.long * (1.0 - 1e-9))
            });
            match shorter {
                Some(shorter) => way = shorter,
                None => step *= 0.5,
            }
        }
        (way, step)
    }

    fn search(self, truth: &Truth, mesh: &Mesh, triangles: &[[u32; 3]], spacing: f64, progress: &(dyn Fn(f64) + Sync)) -> Option<Across> {
        let shares: Vec<&[[u32; 3]]> = triangles.chunks(SHARE).collect();
        let done = std::sync::atomic::AtomicUsize::new(0);
        let found = spread(shares.len(), &|| truth.prover(), &|prover, i| {
            let best = shares.get(i).and_then(|share| self.shortest(prover, mesh, share));
            let done = done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
            progress(0.8 * done as f64 / shares.len() as f64);
            best
        });
        let mut found: Vec<Way> = found.into_iter().flatten().collect();
        found.sort_by(|a, b| a.long.total_cmp(&b.long));
        found.truncate(TRIED);
        let shortened = spread(found.len(), &|| truth.prover(), &|prover, i| found.get(i).map(|way| self.shortened(prover, *way, spacing)));
        progress(1.0);
        let (way, step) = shortened.into_iter().flatten().min_by(|(a, _), (b, _)| a.long.total_cmp(&b.long))?;
        let proven = Interval::new(0.0, way.long + 2.0 * NEAR * self.size);
        let length = Known { proven, ..Known::estimated(way.long, step) };
        Some(Across { length, ends: [way.from, along(way.from, way.direction, way.long)] })
    }
}

/// The walls and gaps within a box; ways that leave it are none.
pub(super) fn walls(
    compiled: &Compiled,
    live: &Live,
    (truth, whole): (&Truth, Box3),
    within: Option<[Vec3; 2]>,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Walls, Refused> {
    let settings = contour::Settings { detail: Detail::Cells(CELLS), sharp: true, within };
    let mesh = contour(compiled, live, &settings, &|part| progress(0.2 * part))?;
    let every = mesh.triangles.len().div_ceil(MOST).max(1);
    let triangles: Vec<[u32; 3]> = mesh.triangles.iter().step_by(every).copied().collect();
    let examined = mesh.examine();
    let spacing = (examined.area / triangles.len().max(1) as f64).sqrt();
    let size = longest(examined.bounds);
    let search = |solid: bool, from: f64| {
        let search = Search { solid, whole, size };
        search.search(truth, &mesh, &triangles, spacing, &|part| progress(from + 0.4 * part))
    };
    Ok(Walls { wall: search(true, 0.2), gap: search(false, 0.6), cell: mesh.cell })
}
