//! Triangles that were examined: how far a point is from them, and on which side.

// Indices are of triangles and corners that were examined.
#![allow(clippy::indexing_slicing)]

use super::boxes::Boxes;
pub use super::boxes::Near;
use super::examine::{Findings, Joined, examine, volume};
use super::triangle::{Part, Triangle};
use crate::vector::{Vec3, add, cross, dot, length, scale, sub};
use rayon::prelude::*;
use rustc_hash::FxHashMap;

/// Ways of a ray that counts what it crosses, none along an axis or a diagonal; the most of them decide, should one graze an edge.
const RAYS: [Vec3; 3] = [[0.843_21, 0.417_53, 0.338_67], [-0.312_49, 0.871_35, -0.378_71], [0.231_47, -0.356_12, 0.905_33]];

/// How the side of a point is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sign {
    /// By pseudonormals where that is right, by the winding number else.
    #[default]
    Auto,
    /// By the angle-weighted normals of the closest face, edge or corner (Bærentzen and Aanæs, "Signed Distance Computation Using the Angle
    /// Weighted Pseudonormal", 2005): right where the mesh is closed, faces one way and does not cross itself.
    Pseudonormal,
    /// Inside is where triangles wind about the point by a half or more, in either direction (Jacobson, Kavan and Sorkine-Hornung, "Robust
    /// Inside-Outside Segmentation using Generalized Winding Numbers", 2013): right where it is closed, and sensible where it is open.
    Winding,
    /// Inside is from where a ray crosses an odd number of triangles: for what is closed and faces in any direction.
    Parity,
}

impl Sign {
    /// As a person writes it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Pseudonormal => "pseudonormal",
            Self::Winding => "winding",
            Self::Parity => "parity",
        }
    }
}

/// Triangles in a hierarchy of boxes.
#[derive(Clone, Debug)]
pub struct Surface {
    boxes: Boxes,
    /// What was found.
    pub findings: Findings,
    /// How sides are found: never [`Sign::Auto`].
    pub sign: Sign,
    /// Of each triangle its corners.
    corners: Vec<[u32; 3]>,
    /// Of each triangle the sums of the normals that meet at its sides; none where they are not needed.
    edge_normals: Vec<[Vec3; 3]>,
    /// Of each corner the sum of the normals about it, each times its angle there; none where they are not needed.
    corner_normals: Vec<Vec3>,
}

impl Surface {
    /// Examines triangles, given by corners that are seen from the outside against the clock. What is no mesh is an error with its place.
    pub fn new(positions: &[Vec3], triangles: &[[u32; 3]], sign: Sign) -> Result<Self, String> {
        let Joined { corners: places, triangles, shell, edges, findings } = examine(positions, triangles)?;
        let given: Vec<Triangle> = triangles.iter().map(|t| Triangle::new(t.map(|i| places[i as usize]))).collect();
        let boxes = Boxes::new(&given);
        drop(given);
        if boxes.bounds().size().iter().all(|s| *s == 0.0) {
            return Err("all of it is at one place".to_owned());
        }
        let corners: Vec<[u32; 3]> = boxes.order.iter().map(|i| triangles[*i as usize]).collect();
        let shell: Vec<u32> = boxes.order.iter().map(|i| shell[*i as usize]).collect();
        let mut surface = Self { boxes, findings, sign, corners, edge_normals: Vec::new(), corner_normals: Vec::new() };
        let pierces = |[a, b]: &&[u32; 2]| {
            let apart = |t: u32| !surface.corners[t as usize].iter().any(|i| i == a || i == b);
            surface.boxes.pierced(places[*a as usize], places[*b as usize], apart)
        };
        surface.findings.crossing_edges = edges.par_iter().filter(pierces).count();
        if surface.findings.is_closed() {
            surface.face_out(&shell);
        }
        surface.sign = match sign {
            Sign::Auto if surface.findings.is_oriented() => Sign::Pseudonormal,
            Sign::Auto => Sign::Winding,
            asked => asked,
        };
        if surface.sign == Sign::Pseudonormal {
            surface.sum_normals(places.len());
        }
        Ok(surface)
    }

    /// The surface of a convex hull, whose triangles face out. They may be so narrow that whether they cross is not decided in 64 bits.
    pub fn of_hull(positions: &[Vec3], triangles: &[[u32; 3]]) -> Result<Self, String> {
        let Joined { corners: places, triangles, findings, .. } = examine(positions, triangles)?;
        let given: Vec<Triangle> = triangles.iter().map(|t| Triangle::new(t.map(|i| places[i as usize]))).collect();
        let boxes = Boxes::new(&given);
        let corners: Vec<[u32; 3]> = boxes.order.iter().map(|i| triangles[*i as usize]).collect();
        let mut surface = Self { boxes, findings, sign: Sign::Pseudonormal, corners, edge_normals: Vec::new(), corner_normals: Vec::new() };
        surface.sum_normals(places.len());
        Ok(surface)
    }

    /// Of each triangle its corners, and the sums of the normals at its edges, from the first corner on, and at its corners. Of what sides are found by
    /// pseudonormals.
    pub fn sides(&self) -> impl Iterator<Item = ([Vec3; 3], [Vec3; 3], [Vec3; 3])> {
        let tips = |ids: &[u32; 3]| ids.map(|i| self.corner_normals.get(i as usize).copied().unwrap_or_default());
        self.boxes.triangles.iter().zip(&self.edge_normals).zip(&self.corners).map(move |((triangle, edges), ids)| (triangle.corners, *edges, tips(ids)))
    }

    /// Turns the shells of a closed mesh that face inside, and counts those that are no boundary.
    fn face_out(&mut self, shell: &[u32]) {
        let mut largest: Vec<(f64, u32)> = vec![(-1.0, 0); self.findings.shells];
        for (t, shell) in shell.iter().enumerate() {
            let area = length(self.boxes.triangles[t].area());
            if let Some(largest) = largest.get_mut(*shell as usize).filter(|largest| area > largest.0) {
                *largest = (area, t as u32);
            }
        }
        // On a triangle the others wind by the mean of both of its sides: a half, between outside and inside.
        let sides = |boxes: &Boxes| -> Vec<f64> {
            largest.par_iter().map(|(_, t)| boxes.winding(boxes.triangles[*t as usize].middle(), Some(*t))).collect()
        };
        let near = |a: f64, b: f64| (a - b).abs() < 0.25;
        let inside_out: Vec<bool> = sides(&self.boxes).iter().map(|w| near(*w, -0.5)).collect();
        self.findings.inside_out = inside_out.iter().filter(|i| **i).count();
        if self.findings.inside_out > 0 {
            for (t, shell) in shell.iter().enumerate() {
                if inside_out.get(*shell as usize) == Some(&true) {
                    self.corners[t].swap(1, 2);
                    self.boxes.triangles[t].corners.swap(1, 2);
                    self.boxes.triangles[t].normal = scale(self.boxes.triangles[t].normal, -1.0);
                }
            }
            self.boxes.sum();
        }
        self.findings.overlapping = sides(&self.boxes).iter().filter(|w| !near(**w, 0.5)).count();
        let from = self.boxes.bounds().low;
        self.findings.volume = Some(self.boxes.triangles.iter().map(|t| volume(t, from)).sum());
    }

    fn sum_normals(&mut self, corners: usize) {
        let mut edges: FxHashMap<[u32; 2], Vec3> = FxHashMap::default();
        self.corner_normals = vec![[0.0; 3]; corners];
        let key = |t: &[u32; 3], k: usize| [t[k].min(t[(k + 1) % 3]), t[k].max(t[(k + 1) % 3])];
        for (ids, triangle) in self.corners.iter().zip(&self.boxes.triangles) {
            for k in 0..3 {
                let edge = edges.entry(key(ids, k)).or_default();
                *edge = add(*edge, triangle.normal);
                let [p, q, r] = [0, 1, 2].map(|i| triangle.corners[(k + i) % 3]);
                let (a, b) = (sub(q, p), sub(r, p));
                // The angle between two vectors, also where it is small.
                let angle = length(cross(a, b)).atan2(dot(a, b));
                let corner = &mut self.corner_normals[ids[k] as usize];
                *corner = add(*corner, scale(triangle.normal, angle));
            }
        }
        let of = |ids: &[u32; 3]| [0, 1, 2].map(|k| edges.get(&key(ids, k)).copied().unwrap_or_default());
        self.edge_normals = self.corners.iter().map(of).collect();
    }

    /// Least and greatest corner of the box about it.
    pub fn bounds(&self) -> [Vec3; 2] {
        let bounds = self.boxes.bounds();
        [bounds.low, bounds.high]
    }

    /// Its triangles, in its own order.
    pub fn triangles(&self) -> &[Triangle] {
        &self.boxes.triangles
    }

    /// The closest of all places of the triangles. `hint` is a triangle that may be near; the answer is as close with any.
    pub fn closest(&self, p: Vec3, hint: u32) -> Near {
        self.boxes.closest(p, hint)
    }

    /// The distance of a point, below zero inside. `hint` is a triangle that may be near, and becomes the nearest: a start for the next point.
    pub fn signed(&self, p: Vec3, hint: &mut u32) -> f64 {
        let near = self.boxes.closest(p, *hint);
        *hint = near.triangle;
        let distance = near.squared.sqrt();
        if self.is_inside(p, &near) { -distance } else { distance }
    }

    fn is_inside(&self, p: Vec3, near: &Near) -> bool {
        let [low, high] = self.bounds();
        if (0..3).any(|i| p[i] < low[i] || p[i] > high[i]) {
            return false;
        }
        match self.sign {
            Sign::Pseudonormal => {
                let t = near.triangle as usize;
                let normal = match near.part {
                    Part::Face => self.boxes.triangles[t].normal,
                    Part::Edge(k) => self.edge_normals[t][k as usize],
                    Part::Corner(k) => self.corner_normals[self.corners[t][k as usize] as usize],
                };
                dot(sub(p, near.point), normal) < 0.0
            }
            Sign::Parity => RAYS.iter().filter(|ray| self.boxes.odd(p, **ray)).count() >= 2,
            Sign::Winding | Sign::Auto => self.boxes.winding(p, None).abs() >= 0.5,
        }
    }

    /// Distance and winding number by each triangle in turn: the truth for tests.
    pub fn plain(&self, p: Vec3) -> (f64, f64) {
        let triangles = &self.boxes.triangles;
        let squared = triangles.iter().filter_map(|t| t.closer(p, f64::INFINITY)).map(|(squared, ..)| squared).fold(f64::INFINITY, f64::min);
        let angle: f64 = triangles.iter().map(|t| t.solid_angle(p)).sum();
        (squared.sqrt(), angle / (4.0 * std::f64::consts::PI))
    }
}
