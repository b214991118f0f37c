//! The convex hull of points.

use super::face::{Face, of_hull};
use crate::vector::Vec3;
use std::collections::BTreeSet;

/// The most points whose hull is found.
pub const MOST_POINTS: usize = 4_000;
/// Coordinates are counted in units of which the longest side of all has so many: products of three of them are exact.
const UNITS: f64 = (1u64 << 30) as f64;

type Place = [i64; 3];

/// The faces of the convex hull of points. Point by point is added: the faces that it sees are replaced by those that join it to their rim (Clarkson and Shor,
/// "Applications of random sampling in computational geometry, II", 1989, without its lists of conflicts). Which sees which is decided exactly. An error says why there is none.
pub fn hull(points: &[Vec3]) -> Result<Vec<Face>, String> {
    if points.len() > MOST_POINTS {
        return Err(format!("there are {}, and {MOST_POINTS} are the most", points.len()));
    }
    if let Some(at) = points.iter().position(|p| p.iter().any(|c| !c.is_finite() || c.abs() > 1e15)) {
        return Err(format!("point {at} is nowhere: a coordinate is not a number, or too large"));
    }
    let Some(first) = points.first() else { return Err("there are none".to_owned()) };
    let (mut low, mut high) = (*first, *first);
    for p in points {
        for ((low, high), c) in low.iter_mut().zip(&mut high).zip(p) {
            (*low, *high) = (low.min(*c), high.max(*c));
        }
    }
    let size = high.iter().zip(low).map(|(h, l)| h - l).fold(0.0, f64::max);
    if size == 0.0 {
        return Err("all of them are at one place".to_owned());
    }
    let unit = size / UNITS;
    let counted = |p: &Vec3| -> Place {
        let [[x, y, z], [a, b, c]] = [*p, low];
        [x - a, y - b, z - c].map(|c| (c / unit).round() as i64)
    };
    let places: Vec<Place> = points.iter().map(counted).collect::<BTreeSet<_>>().into_iter().collect();
    let faces = wrapped(&places)?;
    let back = |[x, y, z]: &Place| -> Vec3 {
        let [a, b, c] = low;
        [a + *x as f64 * unit, b + *y as f64 * unit, c + *z as f64 * unit]
    };
    let corners: Vec<Vec3> = places.iter().map(back).collect();
    of_hull(&corners, &faces)
}

/// Six times the volume of a tetrahedron, above zero where the fourth place sees the first three against the clock from outside.
fn volume(a: Place, b: Place, c: Place, d: Place) -> i128 {
    let off = |[x, y, z]: Place| -> [i128; 3] { [x - a[0], y - a[1], z - a[2]].map(i128::from) };
    let ([bx, by, bz], [cx, cy, cz], [dx, dy, dz]) = (off(b), off(c), off(d));
    dx * (by * cz - bz * cy) + dy * (bz * cx - bx * cz) + dz * (bx * cy - by * cx)
}

fn wrapped(places: &[Place]) -> Result<Vec<[u32; 3]>, String> {
    let place = |i: u32| places.get(i as usize).copied().unwrap_or_default();
    let flat = || "all of them lie in one plane".to_owned();
    let count = places.len() as u32;
    // Four that span a volume.
    let is_off_line = |a: u32, b: u32, c: u32| {
        let off = |p: Place| -> [i128; 3] { let o = place(a); [p[0] - o[0], p[1] - o[1], p[2] - o[2]].map(i128::from) };
        let ([x, y, z], [u, v, w]) = (off(place(b)), off(place(c)));
        y * w != z * v || z * u != x * w || x * v != y * u
    };
    let third = (2..count).find(|c| is_off_line(0, 1, *c)).ok_or_else(flat)?;
    let fourth = (2..count).find(|d| volume(place(0), place(1), place(third), place(*d)) != 0).ok_or_else(flat)?;
    let mut faces: Vec<[u32; 3]> = Vec::new();
    let four = [0, 1, third, fourth];
    for [a, b, c, d] in [[0, 1, 2, 3], [0, 1, 3, 2], [0, 2, 3, 1], [1, 2, 3, 0]] {
        let [a, b, c, d]: [u32; 4] = [a, b, c, d].map(|i: usize| four.get(i).copied().unwrap_or_default());
        // The other one is behind it.
        faces.push(if volume(place(a), place(b), place(c), place(d)) < 0 { [a, b, c] } else { [a, c, b] });
    }
    for p in (0..count).filter(|p| !four.contains(p)) {
        let at = place(p);
        let (seen, mut kept): (Vec<[u32; 3]>, Vec<[u32; 3]>) = faces.iter().partition(|[a, b, c]| volume(place(*a), place(*b), place(*c), at) > 0);
        // The rim: sides that the face on their other side is not seen with.
        let sides: BTreeSet<[u32; 2]> = seen.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
        kept.extend(sides.iter().filter(|[a, b]| !sides.contains(&[*b, *a])).map(|&[a, b]| [a, b, p]));
        faces = kept;
    }
    Ok(faces)
}
