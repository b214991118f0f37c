//! A mesh examined: whether it is closed, and what it measures.

use super::{Mesh, at};
use crate::vector::{Vec3, add, along, cross, dot, length, sub};
use rustc_hash::FxHashMap;

/// What a closed mesh measures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Examined {
    /// Pieces of surface that hang together.
    pub pieces: usize,
    /// Vertices less edges plus triangles: 2 for each ball, 0 for each torus.
    pub euler: i64,
    /// The volume inside; above zero where the triangles face outward.
    pub volume: f64,
    /// The area of all triangles.
    pub area: f64,
    /// Least and greatest corner of its box.
    pub bounds: [Vec3; 2],
}

/// A closed surface that hangs together.
#[derive(Clone, Debug, PartialEq)]
pub struct Shell {
    /// Its triangles, by the mesh's corners.
    pub triangles: Vec<[u32; 3]>,
    /// The volume inside; below zero where the triangles face inward, as around a cavity.
    pub volume: f64,
    /// The area of its triangles.
    pub area: f64,
    /// The integral of the place over the volume inside.
    pub moment: Vec3,
    /// Vertices less edges plus triangles.
    pub euler: i64,
    /// Least and greatest corner of its box.
    pub bounds: [Vec3; 2],
}

impl Mesh {
    /// How many edges are not in exactly two triangles which go along it in opposite directions; zero where the mesh is closed and oriented.
    pub fn torn_edges(&self) -> usize {
        // Each edge by its lesser and greater corner, and the direction.
        let sides = |t: &[u32; 3]| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])];
        let key = |(a, b): (u32, u32)| (u64::from(a.min(b)) << 32 | u64::from(a.max(b)), a > b);
        let mut edges: Vec<(u64, bool)> = self.triangles.iter().flat_map(sides).map(key).collect();
        edges.sort_unstable();
        edges.chunk_by(|a, b| a.0 == b.0).filter(|same| !matches!(same, [(_, false), (_, true)])).count()
    }

    /// The points of a triangle.
    pub fn corners(&self, triangle: &[u32; 3]) -> [Vec3; 3] {
        triangle.map(|v| self.vertices.get(v as usize).copied().unwrap_or_default())
    }

    /// What the mesh measures, if it is closed.
    pub fn examine(&self) -> Examined {
        let bounds = boxed(self.vertices.iter().copied());
        let (mut volume, mut area) = (0.0, 0.0);
        for triangle in &self.triangles {
            // About a corner of the box, so that little cancels.
            let [a, b, c] = self.corners(triangle).map(|p| sub(p, bounds[0]));
            volume += dot(a, cross(b, c)) / 6.0;
            area += 0.5 * length(cross(sub(b, a), sub(c, a)));
        }
        let euler = self.vertices.len() as i64 - self.triangles.len() as i64 / 2;
        Examined { pieces: self.labelled().1, euler, volume, area, bounds }
    }

    /// The surfaces that hang together, each by itself.
    pub fn shells(&self) -> Vec<Shell> {
        let (mut above, pieces) = self.labelled();
        let mut index: FxHashMap<u32, usize> = FxHashMap::default();
        let mut parts: Vec<(Vec<[u32; 3]>, Vec<Vec3>)> = vec![Default::default(); pieces];
        for (vertex, place) in self.vertices.iter().enumerate() {
            let next = index.len();
            let which = *index.entry(top(&mut above, vertex as u32)).or_insert(next);
            parts.iter_mut().skip(which).take(1).for_each(|part| part.1.push(*place));
        }
        for triangle in &self.triangles {
            let which = index.get(&top(&mut above, triangle[0])).copied().unwrap_or(0);
            parts.iter_mut().skip(which).take(1).for_each(|part| part.0.push(*triangle));
        }
        parts.into_iter().map(|(triangles, vertices)| {
            let bounds = boxed(vertices.iter().copied());
            let [origin, _] = bounds;
            let (mut volume, mut area, mut moment) = (0.0, 0.0, [0.0; 3]);
            for triangle in &triangles {
                let [a, b, c] = self.corners(triangle).map(|p| sub(p, origin));
                let part = dot(a, cross(b, c)) / 6.0;
                volume += part;
                area += 0.5 * length(cross(sub(b, a), sub(c, a)));
                // The middle of a tetrahedron is the mean of its corners, one of which is the origin.
                moment = along(moment, add(a, add(b, c)), 0.25 * part);
            }
            let euler = vertices.len() as i64 - triangles.len() as i64 / 2;
            Shell { triangles, volume, area, moment: along(moment, origin, volume), euler, bounds }
        }).collect()
    }

    /// How often a closed surface winds about a point: 1 inside of one that faces outward, 0 outside. The sum of solid angles
    /// (van Oosterom and Strackee 1983, "The solid angle of a plane triangle").
    pub fn winding(&self, shell: &Shell, point: Vec3) -> i64 {
        let mut angle = 0.0;
        for triangle in &shell.triangles {
            let [a, b, c] = self.corners(triangle).map(|p| sub(p, point));
            let (x, y, z) = (length(a), length(b), length(c));
            angle += 2.0 * dot(a, cross(b, c)).atan2(x * y * z + dot(a, b) * z + dot(b, c) * x + dot(c, a) * y);
        }
        (angle / (4.0 * std::f64::consts::PI)).round() as i64
    }

    /// For each vertex one nearer to that which stands for all that hangs together with it, and how many pieces there are.
    fn labelled(&self) -> (Vec<u32>, usize) {
        let mut above: Vec<u32> = (0..self.vertices.len() as u32).collect();
        let mut pieces = above.len();
        for [a, b, c] in &self.triangles {
            for (one, other) in [(*a, *b), (*b, *c)] {
                let (one, other) = (top(&mut above, one), top(&mut above, other));
                if one != other {
                    pieces -= 1;
                    above.iter_mut().skip(one as usize).take(1).for_each(|v| *v = other);
                }
            }
        }
        (above, pieces)
    }
}

/// Least and greatest corner of the box about some points.
fn boxed(points: impl Iterator<Item = Vec3>) -> [Vec3; 2] {
    points.fold([[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]], |[low, high], p| {
        [[0, 1, 2].map(|i| at(low, i).min(at(p, i))), [0, 1, 2].map(|i| at(high, i).max(at(p, i)))]
    })
}

/// The vertex that stands for all that hangs together with one; what is on the way gets nearer to it.
fn top(above: &mut [u32], mut vertex: u32) -> u32 {
    loop {
        let next = above.get(vertex as usize).copied().unwrap_or(vertex);
        let beyond = above.get(next as usize).copied().unwrap_or(next);
        if next == vertex {
            return vertex;
        }
        if let Some(slot) = above.get_mut(vertex as usize) {
            *slot = beyond;
        }
        vertex = beyond;
    }
}
