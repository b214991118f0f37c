//! A convex part of space as a prism, and how far the farthest of its points can be from triangles.
//!
//! The distance from one triangle is a convex function, so over a convex part it is largest at a corner. A prism that lies over several
//! triangles is cut along their edges, until each part is near to one.

use crate::certify::{Box3, Slab};
use crate::graph::interval::Interval;
use crate::sampled::{Boxes, Part, Triangle};
use crate::vector::{Vec3, along, cross, dot, length, scale, sub};
use smallvec::SmallVec;

/// Parts in which a prism is cut at most.
const PARTS: usize = 32;
/// What is no wider than this part of its distance is not cut where no side of a triangle goes through it.
const WIDE: f64 = 0.25;
/// Distances are larger by this part of the largest coordinate, for rounding.
pub(super) const ROUNDED: f64 = 1e-12;
/// A triangle whose height is less than this part of its longest side is taken for its sides alone: its normal has lost too many digits.
const NEEDLE: f64 = 1e-4;
/// The pairs of corners of a box that are its edges, by the bits of their axes.
const EDGES: [(usize, usize); 12] = [(0, 1), (2, 3), (4, 5), (6, 7), (0, 2), (1, 3), (4, 6), (5, 7), (0, 4), (1, 5), (2, 6), (3, 7)];

type Outline = SmallVec<[[f64; 2]; 16]>;

/// A part of a prism, the triangle that is nearest to its middle, how far the part is from that at most, and where.
struct Piece {
    outline: Outline,
    triangle: u32,
    far: f64,
    there: [f64; 2],
}

fn far(pieces: &[Piece], index: usize) -> f64 {
    pieces.get(index).map_or(0.0, |piece| piece.far)
}

/// What lies over a convex outline in a plane, between two heights.
pub(super) struct Prism {
    from: Vec3,
    /// Two axes in the plane, and that across it.
    axes: [Vec3; 3],
    outline: Outline,
    heights: [f64; 2],
}

impl Prism {
    /// A prism that holds what of a box lies in all of some slabs: across the thinnest of them; across the box's shortest side where there are
    /// none. Nothing where they do not meet.
    pub fn new(range: &Box3, slabs: &[Slab]) -> Option<Self> {
        let corners: [Vec3; 8] = std::array::from_fn(|i| corner(range, i));
        let mut best: Option<(Slab, [f64; 2])> = None;
        for slab in slabs {
            let high = corners.iter().map(|p| dot(sub(*p, slab.from), slab.normal));
            let ends = high.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, top], h| [low.min(h), top.max(h)]);
            let heights = [slab.heights[0].max(ends[0]), slab.heights[1].min(ends[1])];
            // What these lines lose is less than what slabs are wider.
            if heights[0] > heights[1] {
                return None;
            }
            if best.is_none_or(|(_, other)| heights[1] - heights[0] < other[1] - other[0]) {
                best = Some((*slab, heights));
            }
        }
        let Some((slab, heights)) = best else { return Some(Self::whole(range)) };
        let axes = axes(slab.normal);
        let high = corners.map(|p| dot(sub(p, slab.from), slab.normal));
        let mut points: SmallVec<[Vec3; 32]> = SmallVec::new();
        points.extend(corners.iter().zip(high).filter(|(_, h)| heights[0] <= *h && *h <= heights[1]).map(|(p, _)| *p));
        for (i, j) in EDGES {
            let (Some(p), Some(q), Some(a), Some(b)) = (corners.get(i), corners.get(j), high.get(i), high.get(j)) else { continue };
            for plane in heights {
                if (a < &plane) != (b < &plane) {
                    points.push(along(*p, sub(*q, *p), ((plane - a) / (b - a)).clamp(0.0, 1.0)));
                }
            }
        }
        let outline = hull(points.iter().map(|p| flat(&axes, sub(*p, slab.from))).collect());
        let mut prism = Self { from: slab.from, axes, outline, heights };
        for other in slabs.iter().filter(|other| **other != slab) {
            prism.cut_off(other);
        }
        (!prism.outline.is_empty()).then_some(prism)
    }

    /// Takes away what lies outside of a slab at all heights.
    fn cut_off(&mut self, slab: &Slab) {
        let [x, y, z] = self.axes.map(|axis| dot(axis, slab.normal));
        let from = dot(sub(self.from, slab.from), slab.normal);
        let rise = self.heights.map(|h| z * h);
        let [low, top] = [rise[0].min(rise[1]), rise[0].max(rise[1])];
        if slab.heights[1].is_finite() {
            self.outline = clip(&self.outline, &[x, y, from + low - slab.heights[1]], 0.0);
        }
        if slab.heights[0].is_finite() {
            self.outline = clip(&self.outline, &[-x, -y, slab.heights[0] - from - top], 0.0);
        }
    }

    /// A box, across its shortest side.
    fn whole(range: &Box3) -> Self {
        let width = range.map(Interval::width);
        let shortest = (0..3).min_by(|&i, &j| of(&width, i).total_cmp(&of(&width, j))).unwrap_or(2);
        let axes = axes(std::array::from_fn(|i| f64::from(u8::from(i == shortest))));
        let from = range.map(Interval::middle);
        let corners = (0..8).map(|i| sub(corner(range, i), from));
        let ends = corners.clone().map(|p| dot(p, axes[2])).fold([f64::INFINITY, f64::NEG_INFINITY], |[low, top], h| [low.min(h), top.max(h)]);
        Self { from, axes, outline: hull(corners.map(|p| flat(&axes, p)).collect()), heights: ends }
    }

    /// How thick it is.
    pub fn thickness(&self) -> f64 {
        self.heights[1] - self.heights[0]
    }

    fn place(&self, [x, y]: [f64; 2], height: f64) -> Vec3 {
        let [u, v, n] = self.axes;
        along(along(along(self.from, u, x), v, y), n, height)
    }

    /// A number that no point's distance from the triangles exceeds, and the distance that some corner has: the two are near to each other, or the first
    /// is at most `enough`, unless the prism lies over too many triangles. `hint` is a triangle that may be near, and becomes one.
    pub fn farthest(&self, boxes: &Boxes, enough: f64, hint: &mut u32) -> (f64, f64) {
        let mut open: SmallVec<[Piece; 16]> = SmallVec::new();
        open.push(self.piece(boxes, self.outline.clone(), f64::INFINITY, hint));
        let mut most = 0.0_f64;
        for _ in 0..PARTS {
            // The worst first: what is left is no farther.
            let Some(worst) = (0..open.len()).max_by(|&i, &j| far(&open, i).total_cmp(&far(&open, j))) else { break };
            if far(&open, worst) <= enough.max(most) {
                break;
            }
            let piece = open.swap_remove(worst);
            let triangle = boxes.triangles.get(piece.triangle as usize);
            let parts = triangle.and_then(|triangle| self.cut(&piece.outline, triangle)).or_else(|| halved(&piece.outline, piece.there, WIDE * piece.far));
            match parts {
                Some(parts) => open.extend(parts.into_iter().filter(|part| !part.is_empty()).map(|part| self.piece(boxes, part, piece.far, hint))),
                None => {
                    most = piece.far;
                    open.push(piece);
                }
            }
        }
        let Some(worst) = open.into_iter().max_by(|a, b| a.far.total_cmp(&b.far)) else { return (0.0, 0.0) };
        if worst.far <= enough {
            return (worst.far, 0.0);
        }
        let corners = self.heights.map(|height| boxes.closest(self.place(worst.there, height), *hint).squared.sqrt());
        (worst.far, corners[0].max(corners[1]))
    }

    /// A part of it with the triangle that is nearest to its middle. It is no farther than `limit`.
    fn piece(&self, boxes: &Boxes, outline: Outline, limit: f64, hint: &mut u32) -> Piece {
        let middle = self.place(mean(&outline), 0.5 * (self.heights[0] + self.heights[1]));
        *hint = boxes.closest(middle, *hint).triangle;
        let (mut far, mut there) = (0.0, mean(&outline));
        for at in &outline {
            for height in self.heights {
                let distance = boxes.triangles.get(*hint as usize).map_or(f64::INFINITY, |triangle| no_farther(triangle, self.place(*at, height)));
                if distance > far {
                    (far, there) = (distance, *at);
                }
            }
        }
        Piece { outline, triangle: *hint, far: far.min(limit), there }
    }

    /// Cuts an outline along the side of a triangle beyond which it reaches farthest; none where no side goes through it.
    fn cut(&self, outline: &Outline, triangle: &Triangle) -> Option<[Outline; 2]> {
        let corners = triangle.corners.map(|p| flat(&self.axes, sub(p, self.from)));
        let [a, b, c] = corners;
        let twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        let size = outline.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
        let mut best: Option<(f64, [f64; 3])> = None;
        for (p, q) in [(a, b), (b, c), (c, a)] {
            let way = [q[0] - p[0], q[1] - p[1]];
            let long = way[0].hypot(way[1]);
            if long <= 1e-9 * size {
                continue;
            }
            // Above zero beyond the side.
            let turn = if twice > 0.0 { 1.0 } else { -1.0 } / long;
            let line = [way[1] * turn, -way[0] * turn, (way[0] * p[1] - way[1] * p[0]) * turn];
            let [least, most] = outline.iter().map(|at| beyond(&line, at)).fold([f64::INFINITY, f64::NEG_INFINITY], |[l, m], x| [l.min(x), m.max(x)]);
            let through = 1e-3 * size;
            if least < -through && most > through && best.is_none_or(|(far, _)| most > far) {
                best = Some((most, line));
            }
        }
        let (_, line) = best?;
        let more = 1e-9 * size;
        Some([clip(outline, &line, more), clip(outline, &line.map(|x| -x), more)])
    }
}

/// An outline cut in two through its middle, across the way to one of its corners; none where that is not so far.
fn halved(outline: &Outline, corner: [f64; 2], least: f64) -> Option<[Outline; 2]> {
    let middle = mean(outline);
    let way = [corner[0] - middle[0], corner[1] - middle[1]];
    let long = way[0].hypot(way[1]);
    if long <= least {
        return None;
    }
    let [x, y] = way.map(|c| c / long);
    let line = [x, y, -(x * middle[0] + y * middle[1])];
    Some([clip(outline, &line, 1e-9 * long), clip(outline, &line.map(|c| -c), 1e-9 * long)])
}

/// How far a point is beyond a line.
fn beyond(line: &[f64; 3], at: &[f64; 2]) -> f64 {
    line[0] * at[0] + line[1] * at[1] + line[2]
}

/// What of an outline is no farther beyond a line than `more` (Sutherland and Hodgman, "Reentrant polygon clipping", 1974).
fn clip(outline: &Outline, line: &[f64; 3], more: f64) -> Outline {
    let mut left = Outline::new();
    let Some(mut before) = outline.last().copied() else { return left };
    let mut from = beyond(line, &before) - more;
    for at in outline {
        let to = beyond(line, at) - more;
        if (from > 0.0) != (to > 0.0) {
            let part = from / (from - to);
            left.push([before[0] + part * (at[0] - before[0]), before[1] + part * (at[1] - before[1])]);
        }
        if to <= 0.0 {
            left.push(*at);
        }
        (before, from) = (*at, to);
    }
    left
}

fn of(v: &Vec3, axis: usize) -> f64 {
    v.get(axis).copied().unwrap_or(0.0)
}

/// A corner of a box, by the bits of its axes.
fn corner(range: &Box3, index: usize) -> Vec3 {
    let mut axis = 0;
    range.map(|side| {
        axis += 1;
        if index >> (axis - 1) & 1 == 1 { side.hi } else { side.lo }
    })
}

/// Two axes at right angles to a third, and that.
fn axes(n: Vec3) -> [Vec3; 3] {
    let least = (0..3).min_by(|&i, &j| of(&n, i).abs().total_cmp(&of(&n, j).abs())).unwrap_or(0);
    let other: Vec3 = std::array::from_fn(|i| f64::from(u8::from(i == least)));
    let u = cross(n, other);
    let u = scale(u, 1.0 / length(u));
    [u, cross(n, u), n]
}

fn flat([u, v, _]: &[Vec3; 3], p: Vec3) -> [f64; 2] {
    [dot(p, *u), dot(p, *v)]
}

fn mean(outline: &Outline) -> [f64; 2] {
    let sum = outline.iter().fold([0.0; 2], |[x, y], at| [x + at[0], y + at[1]]);
    sum.map(|x| x / outline.len().max(1) as f64)
}

/// The convex hull, counterclockwise (Andrew, "Another efficient algorithm for convex hulls in two dimensions", 1979).
fn hull(mut points: SmallVec<[[f64; 2]; 32]>) -> Outline {
    points.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let half = |points: &mut dyn Iterator<Item = &[f64; 2]>| {
        let mut chain = Outline::new();
        for p in points {
            while let [.., a, b] = chain.as_slice() {
                if (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) > 0.0 {
                    break;
                }
                chain.pop();
            }
            chain.push(*p);
        }
        // The last is the first of the other half.
        if chain.len() > 1 {
            chain.pop();
        }
        chain
    };
    let mut all = half(&mut points.iter());
    all.extend(half(&mut points.iter().rev()));
    all
}

fn rounded(p: Vec3) -> f64 {
    ROUNDED * p.iter().fold(0.0, |m: f64, c| m.max(c.abs()))
}

/// A number that the distance of a point from a triangle does not exceed.
pub(super) fn no_farther(triangle: &Triangle, p: Vec3) -> f64 {
    let [a, b, c] = triangle.corners;
    let Some((squared, _, part)) = triangle.closer(p, f64::INFINITY) else { return f64::INFINITY };
    let distance = if part == Part::Face {
        let longest = [sub(b, a), sub(c, b), sub(a, c)].map(|side| dot(side, side)).into_iter().fold(0.0, f64::max);
        if 2.0 * length(triangle.area()) > NEEDLE * longest { squared.sqrt() + 1e-11 * length(sub(p, a)) } else { beside(triangle, p) }
    } else {
        squared.sqrt()
    };
    distance + rounded(p).max(rounded(a))
}

/// The distance from the sides of a triangle.
fn beside(triangle: &Triangle, p: Vec3) -> f64 {
    let [a, b, c] = triangle.corners;
    let side = |from: Vec3, to: Vec3| {
        let way = sub(to, from);
        let whole = dot(way, way);
        let part = if whole > 0.0 { (dot(sub(p, from), way) / whole).clamp(0.0, 1.0) } else { 0.0 };
        length(sub(p, along(from, way, part)))
    };
    side(a, b).min(side(b, c)).min(side(c, a))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    /// Of random boxes, slabs and triangles: no point that is in the box and the slab is farther from the triangles than is said.
    #[test]
    fn no_point_of_a_prism_is_farther_than_it_says() {
        let mut random = Random(11);
        let mut close = 0;
        for round in 0..400 {
            let triangles: Vec<Triangle> = (0..1 + round % 7).map(|_| Triangle::new([(); 3].map(|()| random.within(1.0)))).collect();
            let boxes = Boxes::new(&triangles);
            let (from, size) = (random.within(1.0), random.within(1.0).map(|c| 0.02 + 0.5 * c.abs()));
            let range: Box3 = std::array::from_fn(|i| Interval { lo: from[i], hi: from[i] + size[i] });
            let normal = crate::vector::unit(random.within(1.0)).unwrap();
            let slab = Slab { from: range.map(Interval::middle), normal, heights: [-0.1 * random.next(), 0.1 * random.next()] };
            let other = Slab { normal: crate::vector::unit(random.within(1.0)).unwrap(), heights: [-0.1 * random.next(), f64::INFINITY], ..slab };
            let slabs = [slab, other];
            let slabs = &slabs[..round % 3];
            let Some(prism) = Prism::new(&range, slabs) else { continue };
            let (most, _) = prism.farthest(&boxes, 0.0, &mut 0);
            let mut found = 0.0_f64;
            for _ in 0..300 {
                let at: Vec3 = std::array::from_fn(|i| range[i].lo + random.next() * size[i]);
                let inside = |slab: &Slab| (slab.heights[0]..slab.heights[1]).contains(&dot(sub(at, slab.from), slab.normal));
                if slabs.iter().all(inside) {
                    found = found.max(boxes.closest(at, 0).squared.sqrt());
                }
            }
            assert!(found <= most, "{round}: {found} is more than {most}");
            close += usize::from(found > 0.7 * most);
        }
        assert!(close > 250, "{close}");
    }
}
