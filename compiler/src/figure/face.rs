//! A triangle of a closed surface, with what tells its sides apart.

use crate::sampled::{Findings, Sign, Surface};
use crate::vector::{Vec3, along, cross, dot, scale, sub, unit};

/// Numbers of a face on a device.
pub const FACE: usize = 27;

/// A triangle that is seen from the outside against the clock. Its neighbours have a part in which side a place is on: beside an edge the sum of both normals
/// there tells it, beside a corner that of all about it (Bærentzen and Aanæs, "Signed Distance Computation Using the Angle Weighted Pseudonormal", 2005).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Face {
    /// Its corners.
    pub corners: [Vec3; 3],
    /// The direction that is out at each edge, from the first corner on.
    pub edges: [Vec3; 3],
    /// The direction that is out at each corner.
    pub tips: [Vec3; 3],
}

impl Face {
    /// From the nearest place of it to a point, and the direction that is out there. The twin of `sf_face` in `emit/library.rs`: the regions of Ericson,
    /// "Real-Time Collision Detection", § 5.1.5.
    pub fn away(&self, p: Vec3) -> (Vec3, Vec3) {
        let [a, b, c] = self.corners;
        let (ab, ac, ap) = (sub(b, a), sub(c, a), sub(p, a));
        let (d1, d2) = (dot(ab, ap), dot(ac, ap));
        if d1 <= 0.0 && d2 <= 0.0 {
            return (ap, self.tips[0]);
        }
        let bp = sub(p, b);
        let (d3, d4) = (dot(ab, bp), dot(ac, bp));
        if d3 >= 0.0 && d4 <= d3 {
            return (bp, self.tips[1]);
        }
        let cp = sub(p, c);
        let (d5, d6) = (dot(ab, cp), dot(ac, cp));
        if d6 >= 0.0 && d5 <= d6 {
            return (cp, self.tips[2]);
        }
        let third = d1 * d4 - d3 * d2;
        if third <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
            return (along(ap, ab, -d1 / (d1 - d3)), self.edges[0]);
        }
        let second = d5 * d2 - d1 * d6;
        if second <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
            return (along(ap, ac, -d2 / (d2 - d6)), self.edges[2]);
        }
        let first = d3 * d6 - d5 * d4;
        if first <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
            return (along(bp, sub(c, b), -(d4 - d3) / ((d4 - d3) + (d5 - d6))), self.edges[1]);
        }
        let normal = cross(ab, ac);
        (scale(normal, dot(ap, normal) / dot(normal, normal)), normal)
    }

    /// Least and greatest corner of a box about it.
    pub fn bounds(&self) -> [Vec3; 2] {
        let [[a, b, c], [d, e, f], [g, h, i]] = self.corners;
        let of = |pick: fn(f64, f64) -> f64| [pick(pick(a, d), g), pick(pick(b, e), h), pick(pick(c, f), i)];
        [of(f64::min), of(f64::max)]
    }

    /// As a device reads it.
    pub(super) fn numbers(&self) -> impl Iterator<Item = f64> {
        [self.corners, self.edges, self.tips].into_iter().flatten().flatten()
    }
}

/// The faces of a closed surface, given by triangles in either direction. An error says where it is none.
pub fn closed(points: &[Vec3], triangles: &[[u32; 3]]) -> Result<Vec<Face>, String> {
    let surface = Surface::new(points, triangles, Sign::Pseudonormal)?;
    let Findings { duplicates, flat, open_edges, branching_edges, one_sided_edges, pinched, crossing_edges, overlapping, volume, .. } = surface.findings;
    let wrong = [
        (flat, "of its triangles have no area"),
        (duplicates, "of its triangles are there twice"),
        (open_edges, "of its edges belong to one face alone"),
        (branching_edges, "of its edges belong to more than two faces"),
        (one_sided_edges, "of its edges join faces that can't face the same way"),
        (crossing_edges, "of its edges go through a face"),
        (pinched, "of its corners join parts that share no edge there"),
        (overlapping, "of its parts lie within another that faces the same way"),
    ];
    match wrong.into_iter().find(|(count, _)| *count > 0) {
        Some((count, what)) => Err(format!("{count} {what}")),
        // So little is made by rounding.
        None if volume.is_some_and(|volume| volume <= 1e-12 * size(points).powi(3)) => Err("its faces lie in one plane, and enclose nothing".to_owned()),
        None => Ok(faces(&surface)),
    }
}

/// The longest side of the box about points.
fn size(points: &[Vec3]) -> f64 {
    let side = |i: usize| {
        let along = points.iter().filter_map(|p| p.get(i));
        let [low, high] = along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], c| [low.min(*c), high.max(*c)]);
        high - low
    };
    side(0).max(side(1)).max(side(2))
}

/// The faces of a convex hull.
pub(super) fn of_hull(points: &[Vec3], triangles: &[[u32; 3]]) -> Result<Vec<Face>, String> {
    Ok(faces(&Surface::of_hull(points, triangles)?))
}

fn faces(surface: &Surface) -> Vec<Face> {
    // Long directions would overflow in products of 32 bits.
    let unit = |v: Vec3| unit(v).unwrap_or_default();
    surface.sides().map(|(corners, edges, tips)| Face { corners, edges: edges.map(unit), tips: tips.map(unit) }).collect()
}
