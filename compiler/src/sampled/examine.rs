//! What is wrong with a mesh: its corners are joined, its edges counted, its triangles turned to face one way.

// Indices are of corners and triangles, and each was held against their number first.
#![allow(clippy::indexing_slicing)]

use super::triangle::Triangle;
use crate::vector::{Vec3, cross, dot, length, sub};
use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};

/// A triangle is a needle where its least height is below this share of its longest side.
const NEEDLE: f64 = 1e-3;
/// The most triangles of a mesh: half a kilobyte for each is taken while it is examined.
pub const MOST_TRIANGLES: usize = 4_000_000;
/// No edge, no triangle.
const NONE: u32 = u32::MAX;
/// Coordinates beyond would overflow in products of six of them.
const FARTHEST: f64 = 1e15;

/// What was found in a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Findings {
    /// Corners at different places that are part of a triangle.
    pub vertices: usize,
    /// Triangles as given.
    pub triangles: usize,
    /// Triangles of the same three corners as an earlier one, whichever way they face. They are left out.
    pub duplicates: usize,
    /// Triangles two of whose corners are at one place, or that have no area.
    pub flat: usize,
    /// Triangles with area whose least height is below a thousandth of their longest side.
    pub needles: usize,
    /// Edges of one triangle: where the mesh is open.
    pub open_edges: usize,
    /// Edges of more than two triangles.
    pub branching_edges: usize,
    /// Triangles that face the other way than most of the area that is joined to them by edges. They are turned.
    pub turned: usize,
    /// Edges at which turning does not help, as of a Möbius strip.
    pub one_sided_edges: usize,
    /// Corners at which parts of the surface meet that share no edge there.
    pub pinched: usize,
    /// Edges that go through a triangle.
    pub crossing_edges: usize,
    /// Parts that are joined by edges.
    pub shells: usize,
    /// Shells whose inside lies where their triangles face. They are turned, where the mesh has no open edge.
    pub inside_out: usize,
    /// Shells that are not the boundary between outside and inside, as a shell within another that faces the same way.
    pub overlapping: usize,
    /// The volume inside, where there is no open edge: in units of the file, cubed. What lies in several shells counts as often.
    pub volume: Option<f64>,
}

impl Findings {
    /// Whether each edge is of two triangles that face alike.
    pub fn is_closed(&self) -> bool {
        self.open_edges == 0 && self.branching_edges == 0 && self.one_sided_edges == 0
    }

    /// Whether the side of the nearest triangle is the side of the mesh.
    pub fn is_oriented(&self) -> bool {
        self.is_closed() && self.pinched == 0 && self.crossing_edges == 0 && self.overlapping == 0 && self.flat == 0
    }
}

/// A mesh whose corners are joined.
#[derive(Clone, Debug, Default)]
pub(super) struct Joined {
    pub corners: Vec<Vec3>,
    /// Without duplicates, turned to face one way. Those without area are among them.
    pub triangles: Vec<[u32; 3]>,
    /// Of each triangle its shell; none of those that have only two corners.
    pub shell: Vec<u32>,
    /// Each edge once.
    pub edges: Vec<[u32; 2]>,
    pub findings: Findings,
}

/// Joins corners at one place and examines what comes of it. What can't be a mesh is an error with its place.
pub(super) fn examine(positions: &[Vec3], triangles: &[[u32; 3]]) -> Result<Joined, String> {
    if triangles.is_empty() {
        return Err("it has no triangles".to_owned());
    }
    if triangles.len() > MOST_TRIANGLES || positions.len() > 3 * MOST_TRIANGLES {
        let (vertices, triangles) = (positions.len(), triangles.len());
        return Err(format!("it has {vertices} vertices and {triangles} triangles, and {MOST_TRIANGLES} triangles are the most"));
    }
    if let Some(at) = positions.iter().flatten().position(|c| !c.is_finite() || c.abs() > FARTHEST) {
        return Err(format!("vertex {} is nowhere: a coordinate is not a number, or too large", at / 3 + 1));
    }
    let count = positions.len();
    if let Some(at) = triangles.iter().flatten().position(|i| *i as usize >= count) {
        let index = triangles[at / 3][at % 3];
        return Err(format!("triangle {} names vertex {}, and there are {count}", at / 3 + 1, u64::from(index) + 1));
    }
    let mut joined = join(positions, triangles);
    turn(&mut joined);
    Ok(joined)
}

fn join(positions: &[Vec3], triangles: &[[u32; 3]]) -> Joined {
    let mut findings = Findings { triangles: triangles.len(), ..Findings::default() };
    let mut corners: Vec<Vec3> = Vec::new();
    let mut known: FxHashMap<[u64; 3], u32> = FxHashMap::default();
    let mut place = vec![NONE; positions.len()];
    let mut seen: FxHashSet<[u32; 3]> = FxHashSet::default();
    let mut kept = Vec::with_capacity(triangles.len());
    for triangle in triangles {
        let joined = triangle.map(|i| {
            let place = &mut place[i as usize];
            if *place == NONE {
                // Zero has two signs and one place.
                let at = positions[i as usize].map(|c| c + 0.0);
                *place = *known.entry(at.map(f64::to_bits)).or_insert_with(|| {
                    corners.push(at);
                    corners.len() as u32 - 1
                });
            }
            *place
        });
        let mut sorted = joined;
        sorted.sort_unstable();
        if !seen.insert(sorted) {
            findings.duplicates += 1;
            continue;
        }
        kept.push(joined);
        let triangle = Triangle::new(joined.map(|i| corners[i as usize]));
        let [a, b, c] = triangle.corners;
        let longest = [sub(b, a), sub(c, b), sub(a, c)].map(|side| dot(side, side)).into_iter().fold(0.0, f64::max);
        if triangle.is_flat() {
            findings.flat += 1;
        } else if 2.0 * length(triangle.area()) < NEEDLE * longest {
            findings.needles += 1;
        }
    }
    findings.vertices = corners.len();
    Joined { corners, shell: vec![NONE; kept.len()], triangles: kept, edges: Vec::new(), findings }
}

/// The side of a triangle from one corner on: its ends.
fn ends(triangles: &[[u32; 3]], side: u32) -> [u32; 2] {
    let (t, k) = (side as usize / 3, side as usize % 3);
    [triangles[t][k], triangles[t][(k + 1) % 3]]
}

/// What has only two corners is no surface.
fn is_surface([a, b, c]: &[u32; 3]) -> bool {
    a != b && b != c && c != a
}

/// Finds edges, shells and which way triangles face, and turns those that face against the most.
fn turn(joined: &mut Joined) {
    let (triangles, findings) = (&joined.triangles, &mut joined.findings);
    // Sides by their ends: those of one edge stand together.
    let of = |t: usize| (0..3u32).map(move |k| 3 * t as u32 + k);
    let mut sides: Vec<(u64, u32)> = (0..triangles.len())
        .filter(|t| is_surface(&triangles[*t]))
        .flat_map(of)
        .map(|side| {
            let [a, b] = ends(triangles, side).map(u64::from);
            (a.min(b) << 32 | a.max(b), side)
        })
        .collect();
    sides.par_sort_unstable();
    let mut across = vec![NONE; 3 * triangles.len()];
    for edge in sides.chunk_by(|a, b| a.0 == b.0) {
        joined.edges.extend(edge.first().map(|(_, side)| ends(triangles, *side)));
        match edge {
            [_] => findings.open_edges += 1,
            [(_, a), (_, b)] => (across[*a as usize], across[*b as usize]) = (*b, *a),
            _ => findings.branching_edges += 1,
        }
    }
    // Each shell from one of its triangles on, with the way in which each faces beside that one.
    let mut over = vec![false; triangles.len()];
    let area = |t: usize| length(Triangle::new(triangles[t].map(|i| joined.corners[i as usize])).area());
    for start in 0..triangles.len() {
        if joined.shell[start] != NONE || !is_surface(&triangles[start]) {
            continue;
        }
        let shell = findings.shells as u32;
        findings.shells += 1;
        joined.shell[start] = shell;
        let mut reached = vec![start];
        let mut balance = 0.0;
        let mut next = 0;
        while let Some(&t) = reached.get(next) {
            next += 1;
            balance += if over[t] { -area(t) } else { area(t) };
            for side in of(t) {
                let other = across[side as usize];
                if other == NONE {
                    continue;
                }
                // Two face alike where the edge that they share runs one way in one and the other way in the other.
                let alike = ends(triangles, side)[0] == ends(triangles, other)[1];
                let (o, wanted) = (other as usize / 3, over[t] == alike);
                if joined.shell[o] == NONE {
                    (joined.shell[o], over[o]) = (shell, wanted);
                    reached.push(o);
                } else if over[o] != wanted && side < other {
                    findings.one_sided_edges += 1;
                }
            }
        }
        if balance < 0.0 {
            reached.iter().for_each(|t| over[*t] = !over[*t]);
        }
    }
    findings.turned = over.iter().filter(|o| **o).count();
    findings.pinched = pinched(triangles, &across, joined.corners.len());
    for (triangle, over) in joined.triangles.iter_mut().zip(over) {
        if over {
            triangle.swap(1, 2);
        }
    }
}

/// How many corners have triangles about them that are not all joined by edges at that corner.
fn pinched(triangles: &[[u32; 3]], across: &[u32], corners: usize) -> usize {
    // Corners of triangles, each with another of its fan; the last of a row stands for itself.
    let mut fan: Vec<u32> = (0..across.len() as u32).collect();
    fn last(fan: &mut [u32], mut at: u32) -> u32 {
        while fan[at as usize] != at {
            let next = fan[at as usize];
            fan[at as usize] = fan[next as usize];
            at = next;
        }
        at
    }
    for (side, other) in across.iter().enumerate() {
        let side = side as u32;
        if *other == NONE || *other < side {
            continue;
        }
        let after = |side: u32| side - side % 3 + (side % 3 + 1) % 3;
        let [mut a, mut b] = [*other, after(*other)];
        if ends(triangles, side)[0] != ends(triangles, a)[0] {
            (a, b) = (b, a);
        }
        for (mine, theirs) in [(side, a), (after(side), b)] {
            let (mine, theirs) = (last(&mut fan, mine), last(&mut fan, theirs));
            fan[mine as usize] = theirs;
        }
    }
    let mut fans = vec![0u32; corners];
    for (t, triangle) in triangles.iter().enumerate().filter(|(_, t)| is_surface(t)) {
        for (k, corner) in triangle.iter().enumerate() {
            fans[*corner as usize] += u32::from(fan[3 * t + k] == (3 * t + k) as u32);
        }
    }
    fans.iter().filter(|count| **count > 1).count()
}

/// The volume that a triangle spans with a point, above zero where it faces away from that.
pub(super) fn volume(triangle: &Triangle, from: Vec3) -> f64 {
    let [a, b, c] = triangle.corners.map(|corner| sub(corner, from));
    dot(a, cross(b, c)) / 6.0
}
