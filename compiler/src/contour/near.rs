//! From the mesh to the surface: triangle by triangle.
//!
//! A triangle is moved out along the normals of its corners, and in. If the field is surely above zero on one of the two and below on the other,
//! each of its points has a sign change on the way between them, which is no longer than it was moved. A triangle of which this can't be shown
//! is cut in four. What is small beside the distance is near to the surface if its middle is: if the field has both signs in a ball about it.

use super::asked::{Asked, Way};
use super::prism::ROUNDED;
use crate::certify::{Distance, Place, Prover};
use crate::graph::interval::Interval;
use crate::spread::spread;
use crate::vector::{Vec3, add, along, length, scale, sub};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Triangles that one task looks at; they lie side by side.
const SHARE: usize = 64;
/// How often a triangle is cut in four.
const DEEPEST: u32 = 5;
/// Of a patch that was cut so often, and is within the tolerance by the signs about its middle, no more is asked.
const SMALL: u32 = 3;
/// So many times as far it may be each time it is cut.
const WIDER: f64 = 1.5;
/// Times that the sign is asked for all over some part of a triangle.
const TRIES: usize = 300;
/// Boxes by which the distance of a part's middle is told, while it can still be cut.
const SOON: usize = 100;
/// The same at the end.
const BOXES: usize = 1000;
/// How close that distance is told, relative.
const CLOSE: f64 = 0.02;
/// Parts of a triangle of which neither is proven, before all of it is given up.
const ASKED: usize = 4;
/// Times the tolerance, and cells, at which is looked for a surface that is not within the tolerance.
const FARTHEST: f64 = 64.0;

/// Ways to the corners and to the middles of the faces of a cube.
const AROUND: [Vec3; 14] = super::deviation::AROUND;

/// A part of a triangle, with the ways out at its corners, none longer than 1.
#[derive(Clone, Copy)]
struct Patch {
    corners: [Vec3; 3],
    ways: [Vec3; 3],
    depth: u32,
}

/// What is proven of the way from the mesh to the surface.
pub(super) fn near(asked: &Asked, progress: &(dyn Fn(f64) + Sync)) -> Way {
    let shares: Vec<&[u32]> = asked.boxes.order.chunks(SHARE).collect();
    let done = AtomicUsize::new(0);
    let found = spread(shares.len(), &|| asked.truth.prover(), &|prover, i| {
        let patches: Vec<Patch> = shares.get(i).iter().flat_map(|share| share.iter()).filter_map(|t| patch(asked, *t)).collect();
        let sides = patches.iter().map(|patch| patch.sides(2.0 * asked.tolerance)).fold([Interval::EMPTY; 3], |mut all, sides| {
            all.iter_mut().zip(sides).for_each(|(all, side)| *all = all.hull(side));
            all
        });
        let (place, whole) = (prover.place(sides), prover.place([Interval::ALL; 3]));
        let way = patches.into_iter().map(|patch| {
            let sides = patch.sides(2.0 * asked.tolerance);
            Looks { asked, place: prover.place_in(&place, sides), whole: &whole }.settled(prover, patch)
        });
        let way = way.fold(Way::NOTHING, Way::and);
        progress((done.fetch_add(1, Relaxed) + 1) as f64 / shares.len() as f64);
        way
    });
    found.into_iter().fold(Way::NOTHING, Way::and)
}

/// A triangle of the mesh with the surface's directions at its corners; its own where the mesh has none.
fn patch(asked: &Asked, triangle: u32) -> Option<Patch> {
    let mesh = asked.mesh;
    let ids = mesh.triangles.get(triangle as usize)?;
    let corners = mesh.corners(ids);
    let [a, b, c] = corners;
    let own = crate::vector::unit(crate::vector::cross(sub(b, a), sub(c, a))).unwrap_or([0.0; 3]);
    let ways = ids.map(|v| {
        let normal = mesh.normals.get(v as usize).and_then(|n| crate::vector::unit(n.map(f64::from)));
        // A hair less than 1, so that rounding makes none longer.
        scale(normal.unwrap_or(own), 1.0 - 1e-12)
    });
    Some(Patch { corners, ways, depth: 0 })
}

struct Looks<'a> {
    asked: &'a Asked<'a>,
    /// About the triangle and what is within twice the tolerance.
    place: Place,
    whole: &'a Place,
}

impl Looks<'_> {
    fn settled(&self, prover: &mut Prover<'_>, triangle: Patch) -> Way {
        let asked = self.asked;
        let middle = triangle.middle();
        let rounding = 2.0 * ROUNDED * size(middle);
        // What is lost by rounding counts, too.
        let most = asked.tolerance - rounding;
        let mut open = vec![triangle];
        let mut way = Way { parts: 1, at: middle, ..Way::NOTHING };
        // Tries so far, and parts of which neither is proven.
        let (mut tries, mut failed) = (0, 0);
        while let Some(patch) = open.pop() {
            // What is cut often is hard to tell, and is allowed to be farther.
            let shift = (asked.fine * WIDER.powi(patch.depth as i32)).min(most);
            tries += 1;
            let last = patch.depth == DEEPEST || tries >= TRIES;
            let found = if self.between(prover, &patch, shift) {
                shift + rounding
            } else {
                let mut found = if patch.depth > 0 { self.about(prover, &patch, asked.tolerance) } else { f64::INFINITY };
                // Less of what is small tells no more than is known of the whole.
                let enough = if patch.depth >= SMALL { asked.tolerance } else { way.proven };
                if found > asked.tolerance && (patch.depth == SMALL || last) {
                    found = found.min(self.distance(prover, &patch, if last { BOXES } else { SOON }, &mut way));
                }
                if found > enough && !last && way.wrong.is_none() {
                    open.extend(patch.quarters());
                    continue;
                }
                found
            };
            if found > way.proven {
                (way.proven, way.at) = (found, patch.middle());
            }
            failed += usize::from(found > asked.tolerance);
            if way.wrong.is_some() || failed >= ASKED {
                break;
            }
        }
        if way.proven > asked.tolerance {
            // What is known of the whole is all that is known, then.
            way.proven = self.about(prover, &triangle, FARTHEST * asked.tolerance.max(asked.mesh.cell));
            if way.wrong.is_some() {
                way.farther = 1;
            } else if way.proven > asked.tolerance {
                (way.undecided, way.wrong) = (1, Some(way.at));
            }
        }
        way
    }

    /// The most that any point of a patch is away from the surface; infinite if that is not known. Keeps the middle where it is proven to be
    /// farther than the tolerance.
    fn distance(&self, prover: &mut Prover<'_>, patch: &Patch, boxes: usize, way: &mut Way) -> f64 {
        let middle = patch.middle();
        if self.asked.near_wall(middle) {
            return f64::INFINITY;
        }
        let Distance { at_least, at_most, .. } = prover.distance(middle, self.asked.tolerance, CLOSE, boxes);
        if at_least >= self.asked.tolerance {
            (way.at_least, way.wrong) = (self.asked.tolerance, Some(middle));
        }
        patch.all(at_most)
    }

    /// Whether the field is surely above zero all over a patch that is moved out, and below where it is moved in.
    fn between(&self, prover: &mut Prover<'_>, patch: &Patch, shift: f64) -> bool {
        self.side(prover, patch.moved(shift)) == 1 && self.side(prover, patch.moved(-shift)) == -1
    }

    /// The sign of the field, cut off at the room, all over a triangle; 0 if it is not known.
    fn side(&self, prover: &mut Prover<'_>, corners: [Vec3; 3]) -> i8 {
        if self.outside(&corners) {
            return 1;
        }
        let place = if self.asked.holds(&self.place, &corners) { &self.place } else { self.whole };
        match prover.side_of_triangle(place, corners) {
            -1 if !self.asked.inside(&corners) => 0,
            side => side,
        }
    }

    /// Whether all points are beyond one wall at which the solid is cut off.
    fn outside(&self, points: &[Vec3]) -> bool {
        self.asked.cut && self.asked.beyond_a_wall(points)
    }

    /// The same by the signs of the field at a few places about the middle. Infinite if it would be more than `most`.
    fn about(&self, prover: &mut Prover<'_>, patch: &Patch, most: f64) -> f64 {
        let middle = patch.middle();
        let own = crate::vector::unit(add(patch.ways[0], add(patch.ways[1], patch.ways[2]))).unwrap_or([0.0; 3]);
        let least = (0.25 * patch.reach()).max(0.5 * self.asked.fine);
        let mut seen = [false; 2];
        let mut radius = 0.0;
        while patch.all(radius) <= most {
            for way in [own, scale(own, -1.0)].into_iter().chain(AROUND).take(if radius == 0.0 { 1 } else { 2 + AROUND.len() }) {
                match self.point(prover, along(middle, way, radius), seen) {
                    1 => seen[0] = true,
                    -1 => seen[1] = true,
                    _ => {}
                }
                if seen == [true; 2] {
                    return patch.all(radius);
                }
            }
            radius = (1.25 * radius).max(least);
        }
        f64::INFINITY
    }

    /// The sign of the field, cut off at the room, at a point; 0 if it is not sure, or was seen before.
    fn point(&self, prover: &mut Prover<'_>, at: Vec3, seen: [bool; 2]) -> i8 {
        if self.outside(&[at]) {
            return 1;
        }
        let place = if self.asked.holds(&self.place, &[at]) { &self.place } else { self.whole };
        let about = prover.value_in(place, at);
        let [above, below] = seen;
        if (about > 0.0 && above) || (about <= 0.0 && below) {
            return 0;
        }
        match prover.side_of_point(place, at) {
            -1 if !self.asked.inside(&[at]) => 0,
            side => side,
        }
    }
}

impl Asked<'_> {
    /// Whether all points are in the box of a place.
    fn holds(&self, place: &Place, points: &[Vec3]) -> bool {
        points.iter().all(|p| place.range.iter().zip(p).all(|(side, x)| side.contains(*x)))
    }

    /// Whether all points are surely within the room, or nothing is cut off.
    fn inside(&self, points: &[Vec3]) -> bool {
        !self.cut || points.iter().all(|p| self.room.iter().zip(p).all(|(side, x)| side.lo < *x && *x < side.hi))
    }

    /// Whether all points are beyond the same wall of the room.
    fn beyond_a_wall(&self, points: &[Vec3]) -> bool {
        self.room.iter().enumerate().any(|(axis, side)| {
            let at = |p: &Vec3| p.get(axis).copied().unwrap_or(0.0);
            points.iter().all(|p| at(p) < side.lo) || points.iter().all(|p| at(p) > side.hi)
        })
    }

    /// Whether a wall at which the solid is cut off is before a point or within the tolerance of it.
    fn near_wall(&self, p: Vec3) -> bool {
        self.cut && self.room.iter().zip(p).any(|(side, x)| x - side.lo <= self.tolerance || side.hi - x <= self.tolerance)
    }
}

impl Patch {
    fn middle(&self) -> Vec3 {
        let [a, b, c] = self.corners;
        scale(add(a, add(b, c)), 1.0 / 3.0)
    }

    /// The box about it and what is no farther from it.
    fn sides(&self, farther: f64) -> [Interval; 3] {
        std::array::from_fn(|axis| {
            let corners = self.corners.iter().map(|p| p.get(axis).copied().unwrap_or(0.0));
            corners.fold(Interval::EMPTY, |all, x| all.hull(Interval::point(x))).grow(farther)
        })
    }

    /// How far its points are from the middle at most.
    fn reach(&self) -> f64 {
        let middle = self.middle();
        self.corners.iter().map(|p| length(sub(*p, middle))).fold(0.0, f64::max)
    }

    /// A number that no point is farther from the surface than, if the middle is no farther than `alone`.
    fn all(&self, alone: f64) -> f64 {
        (alone + self.reach()) * (1.0 + 1e-9) + ROUNDED * size(self.middle())
    }

    fn moved(&self, by: f64) -> [Vec3; 3] {
        std::array::from_fn(|i| match (self.corners.get(i), self.ways.get(i)) {
            (Some(p), Some(way)) => along(*p, *way, by),
            _ => [0.0; 3],
        })
    }

    /// By the middles of the sides. The ways out are those of the whole patch there.
    fn quarters(&self) -> [Self; 4] {
        let half = |p: Vec3, q: Vec3| scale(add(p, q), 0.5);
        let [a, b, c] = self.corners;
        let [u, v, w] = self.ways;
        let (ab, bc, ca) = (half(a, b), half(b, c), half(c, a));
        let (uv, vw, wu) = (half(u, v), half(v, w), half(w, u));
        let depth = self.depth + 1;
        [
            Self { corners: [a, ab, ca], ways: [u, uv, wu], depth },
            Self { corners: [ab, b, bc], ways: [uv, v, vw], depth },
            Self { corners: [ca, bc, c], ways: [wu, vw, w], depth },
            Self { corners: [ab, bc, ca], ways: [uv, vw, wu], depth },
        ]
    }
}

/// The largest coordinate.
fn size(p: Vec3) -> f64 {
    p.iter().fold(0.0, |m: f64, c| m.max(c.abs()))
}
