//! The polygons: one around each edge that changes sign, from the vertices of the cells about it, cut into triangles.

use super::Grid;
use super::cells::{Edge, Patches};
use super::field::Field;
use crate::vector::{Vec3, cross, dot, length, mix, sub, unit};
use crate::spread::spread;
use rustc_hash::FxHashMap;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Patches that one task joins.
const SHARE: usize = 64;
/// So far from the surface, in cells, either way of cutting a polygon is as good.
const NEAR: f64 = 2e-3;
/// A way of cutting must come so much nearer to be the better one whatever its angles are.
const NEARER: f64 = 0.9;

/// A fold by its cell, axis and pair.
type FoldKey = ([u32; 3], usize, usize);

/// A corner of a polygon: a vertex of a cell, or one on a face.
#[derive(Clone, Copy)]
enum Corner {
    Vertex(u32),
    Fold(FoldKey),
}

/// What one task made.
#[derive(Default)]
struct Part {
    triangles: Vec<[u32; 3]>,
    /// Polygons with more than four corners, and their edges.
    large: Vec<(Edge, Vec<Corner>)>,
}

/// Vertices, their normals, and triangles.
pub(super) type Joined = (Vec<Vec3>, Vec<[f32; 3]>, Vec<[u32; 3]>);

/// Joins the vertices of patches.
pub(super) fn join(field: &Field, grid: &Grid, patches: &Patches, progress: &(dyn Fn(f64) + Sync)) -> Joined {
    let all = || patches.all.iter().flat_map(|patch| &patch.vertices);
    let mut points: Vec<Vec3> = all().map(|v| v.point).collect();
    let mut normals: Vec<[f32; 3]> = all().map(|v| v.normal.map(|c| c as f32)).collect();
    let mut before = 0;
    let firsts: Vec<u32> = patches.all.iter().map(|patch| {
        let first = before;
        before += patch.vertices.len() as u32;
        first
    }).collect();
    let tasks = patches.all.len().div_ceil(SHARE);
    let done = AtomicUsize::new(0);
    let parts = spread(tasks, &|| (), &|(), i| {
        let edges = patches.all.iter().skip(i * SHARE).take(SHARE).flat_map(|patch| &patch.edges);
        let part = joined(field, edges, patches, &firsts, &points);
        progress((done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / tasks as f64);
        part
    });
    let folds = patches.all.iter().flat_map(|patch| &patch.folds);
    let folds: FxHashMap<FoldKey, (Vec3, Vec3)> = folds.map(|f| ((f.cell, f.axis, f.pair), (f.point, f.normal))).collect();
    let mut numbers: FxHashMap<FoldKey, u32> = FxHashMap::default();
    let mut triangles = Vec::new();
    for part in parts {
        triangles.extend(part.triangles);
        for (edge, corners) in part.large {
            let mut add = |point: Vec3, normal: [f32; 3]| {
                points.push(point);
                normals.push(normal);
                points.len() as u32 - 1
            };
            let ring: Vec<u32> = corners.into_iter().filter_map(|corner| match corner {
                Corner::Vertex(v) => Some(v),
                Corner::Fold(key) => {
                    let (point, normal) = folds.get(&key)?;
                    Some(*numbers.entry(key).or_insert_with(|| add(*point, normal.map(|c| c as f32))))
                }
            }).collect();
            let mut to = edge.cell;
            to.iter_mut().skip(edge.axis).take(1).for_each(|c| *c += 1);
            let way = [0, 1, 2].map(|i| if i == edge.axis { if edge.leaves { 1.0 } else { -1.0 } } else { 0.0 });
            let middle = add(mix(grid.corner(edge.cell), grid.corner(to), f64::from(edge.part)), way);
            let next = ring.iter().cycle().skip(1);
            triangles.extend(ring.iter().zip(next).map(|(a, b)| [*a, *b, middle]));
        }
    }
    (points, normals, triangles)
}

/// The polygons about some edges.
fn joined<'a>(field: &Field, edges: impl Iterator<Item = &'a Edge>, patches: &Patches, firsts: &[u32], points: &[Vec3]) -> Part {
    let mut part = Part::default();
    let mut quads: Vec<([u32; 4], f64)> = Vec::new();
    for edge in edges {
        let Some(corners) = ring(edge, patches, firsts) else { continue };
        match corners.as_slice() {
            &[Corner::Vertex(a), Corner::Vertex(b), Corner::Vertex(c), Corner::Vertex(d)] => quads.push(([a, b, c, d], f64::from(edge.rise))),
            _ => part.large.push((*edge, corners)),
        }
    }
    let point = |v: u32| points.get(v as usize).copied().unwrap_or_default();
    let middles: Vec<Vec3> = quads.iter().flat_map(|([a, b, c, d], _)| [mix(point(*a), point(*c), 0.5), mix(point(*b), point(*d), 0.5)]).collect();
    if middles.is_empty() {
        return part;
    }
    let far = field.near(middles.iter().copied(), 0.0).eyes().values(&middles);
    for (([a, b, c, d], rise), far) in quads.iter().zip(far.chunks(2)) {
        let off = |i: usize| far.get(i).map_or(0.0, |f| f.abs()) / rise.max(1e-300);
        let ways = [[[*a, *b, *c], [*a, *c, *d]], [[*b, *c, *d], [*b, *d, *a]]];
        let by_distance = off(0).max(off(1)) > NEAR && off(0).min(off(1)) < NEARER * off(0).max(off(1));
        let second = if by_distance { off(1) < off(0) } else { shape(ways[1].map(|t| t.map(point))) > shape(ways[0].map(|t| t.map(point))) };
        part.triangles.extend(if second { ways[1] } else { ways[0] });
    }
    part
}

/// How good two triangles are: the sine of their least angle, and less than zero where one is folded over the other.
fn shape(triangles: [[Vec3; 3]; 2]) -> f64 {
    let normals = triangles.map(|[a, b, c]| cross(sub(b, a), sub(c, a)));
    let sine = |[a, b, c]: [Vec3; 3], normal: Vec3| {
        let [x, y, z] = [length(sub(b, a)), length(sub(c, b)), length(sub(a, c))];
        // Twice the area over the product of two sides: the least angle lies between the longest ones.
        let product = (x * y).max(y * z).max(z * x);
        if product > 0.0 { length(normal) / product } else { 0.0 }
    };
    let [first, second] = normals.map(|n| unit(n).unwrap_or_default());
    let least = triangles.into_iter().zip(normals).map(|(t, n)| sine(t, n)).fold(1.0, f64::min);
    if dot(first, second) < 0.0 { dot(first, second) - 1.0 } else { least }
}

/// The corners of the polygon about an edge, counterclockwise as seen from outside; none where a cell is missing.
fn ring(edge: &Edge, patches: &Patches, firsts: &[u32]) -> Option<Vec<Corner>> {
    let a = edge.axis;
    let (b, c) = ((a + 1) % 3, (a + 2) % 3);
    // Whether the cell lies below the edge along the next axis and the one after, around the edge's direction.
    const ROUND: [(u32, u32); 4] = [(0, 0), (1, 0), (1, 1), (0, 1)];
    let cell = |(i, j): (u32, u32)| {
        let mut at = edge.cell;
        for (axis, below) in [(b, i), (c, j)] {
            let slot = at.get_mut(axis)?;
            *slot = slot.checked_sub(below)?;
        }
        Some((at, patches.cell(at)?, 4 * a + i as usize + 2 * j as usize))
    };
    let cells = [cell(ROUND[0])?, cell(ROUND[1])?, cell(ROUND[2])?, cell(ROUND[3])?];
    let mut corners = Vec::with_capacity(4);
    // Across which axis the next cell lies, and whether above.
    let next = [(b, false), (c, false), (b, true), (c, true)];
    for ((this, that), (axis, above)) in cells.iter().zip(cells.iter().cycle().skip(1)).zip(next) {
        let (patch, vertex) = this.1.vertex(this.2)?;
        corners.push(Corner::Vertex(firsts.get(patch)? + vertex));
        let (upper, lower) = if above { (that, this) } else { (this, that) };
        if upper.1.is_doubled(2 * axis) && lower.1.is_doubled(2 * axis + 1) {
            corners.push(Corner::Fold((upper.0, axis, upper.1.pair(2 * axis, upper.2))));
        }
    }
    if !edge.leaves {
        corners.reverse();
    }
    Some(corners)
}
