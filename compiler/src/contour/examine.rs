//! A mesh examined: whether it is closed, and what it measures.

use super::{Mesh, at};
use crate::vector::{Vec3, cross, dot, length, sub};

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
        let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        for v in &self.vertices {
            let [low, high] = bounds;
            bounds = [[0, 1, 2].map(|i| at(low, i).min(at(*v, i))), [0, 1, 2].map(|i| at(high, i).max(at(*v, i)))];
        }
        let (mut volume, mut area) = (0.0, 0.0);
        for triangle in &self.triangles {
            // About a corner of the box, so that little cancels.
            let [a, b, c] = self.corners(triangle).map(|p| sub(p, bounds[0]));
            volume += dot(a, cross(b, c)) / 6.0;
            area += 0.5 * length(cross(sub(b, a), sub(c, a)));
        }
        let euler = self.vertices.len() as i64 - self.triangles.len() as i64 / 2;
        Examined { pieces: self.pieces(), euler, volume, area, bounds }
    }

    /// How many pieces hang together.
    fn pieces(&self) -> usize {
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
        pieces
    }
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
