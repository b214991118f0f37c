//! A hierarchy of boxes about triangles, and three searches through it: the closest point, the winding number, what a line crosses.
//!
//! It is our own: of the crates, `obvhs` has boxes of 32 bits and no closest point, `bvh` and `parry3d` bring a library of linear algebra
//! each and neither starts from a distance that a neighbour knows, nor keeps sums for each box, which the winding number needs.

// Indices come from the hierarchy's own counts: each is of a box or a triangle that was put in.
#![allow(clippy::indexing_slicing)]

use super::triangle::{Part, Triangle};
use crate::vector::{Vec3, add, cross, dot, length, scale, sub};
use rayon::prelude::*;
use smallvec::SmallVec;

/// The most triangles of a box that is not parted, where a cut costs more than it saves.
const LEAF: usize = 4;
/// Places at which a cut is tried.
const BINS: usize = 16;
/// Boxes that lie deeper are cut in halves of equal number, so that no search needs a deep stack.
const DEEP: usize = 40;
/// A box is seen as one dipole from further than so many of its radii.
const FAR: f64 = 2.5;

/// Boxes that are still to be looked at.
type Stack<T> = SmallVec<[T; 96]>;

/// Least and greatest corner.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub low: Vec3,
    pub high: Vec3,
}

impl Bounds {
    pub const EMPTY: Self = Self { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };

    pub fn with(self, p: Vec3) -> Self {
        Self { low: [0, 1, 2].map(|i| self.low[i].min(p[i])), high: [0, 1, 2].map(|i| self.high[i].max(p[i])) }
    }

    pub fn of(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::with)
    }

    pub fn size(&self) -> Vec3 {
        sub(self.high, self.low)
    }

    fn area(&self) -> f64 {
        let [x, y, z] = self.size();
        if x < 0.0 { 0.0 } else { x * y + y * z + z * x }
    }

    fn join(self, other: Self) -> Self {
        self.with(other.low).with(other.high)
    }

    /// The squared distance of a point; zero within.
    #[inline]
    fn squared(&self, p: Vec3) -> f64 {
        let [x, y, z] = [0, 1, 2].map(|i| (self.low[i] - p[i]).max(p[i] - self.high[i]).max(0.0));
        x * x + y * y + z * z
    }

    fn meets(&self, other: &Self) -> bool {
        (0..3).all(|i| self.low[i] <= other.high[i] && other.low[i] <= self.high[i])
    }

    /// Whether a ray meets it; `inverse` is one over each component of its direction.
    fn hit(&self, p: Vec3, inverse: Vec3) -> bool {
        let mut reach = [0.0f64, f64::INFINITY];
        for i in 0..3 {
            let (a, b) = ((self.low[i] - p[i]) * inverse[i], (self.high[i] - p[i]) * inverse[i]);
            reach = [reach[0].max(a.min(b)), reach[1].min(a.max(b))];
        }
        reach[0] <= reach[1]
    }
}

/// A box: of triangles where it has a count, of two boxes else.
#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Bounds,
    first: u32,
    count: u32,
}

/// What a box is from afar: its whole area as a vector, at the mean of its places.
#[derive(Clone, Copy, Debug)]
struct Dipole {
    middle: Vec3,
    area: Vec3,
    /// No place of the box is further from the middle.
    radius: f64,
}

/// A disc about triangles, as thick as they are uneven: of a smooth surface that runs across the axes it is far thinner than a box.
#[derive(Clone, Copy, Debug)]
struct Disc {
    middle: Vec3,
    /// Of length one.
    axis: Vec3,
    /// Of places along the axis.
    heights: [f64; 2],
    /// Of places from the axis.
    radius: f64,
}

impl Disc {
    /// All of space.
    const ALL: Self = Self { middle: [0.0; 3], axis: [0.0; 3], heights: [0.0; 2], radius: f64::INFINITY };

    fn of(triangles: &[Triangle], dipole: &Dipole) -> Self {
        let whole = length(dipole.area);
        if whole == 0.0 {
            return Self::ALL;
        }
        let (middle, axis) = (dipole.middle, scale(dipole.area, 1.0 / whole));
        let (mut low, mut high, mut wide) = (f64::INFINITY, f64::NEG_INFINITY, 0.0f64);
        for corner in triangles.iter().flat_map(|t| t.corners) {
            let q = sub(corner, middle);
            let height = dot(q, axis);
            (low, high) = (low.min(height), high.max(height));
            wide = wide.max(length(sub(q, scale(axis, height))));
        }
        // For what is lost in rounding.
        let more = 1e-12 * (dipole.radius + length(middle));
        Self { middle, axis, heights: [low - more, high + more], radius: wide + more }
    }

    /// The squared distance of a point, or less.
    #[inline]
    fn squared(&self, p: Vec3) -> f64 {
        let q = sub(p, self.middle);
        let height = dot(q, self.axis);
        let above = (self.heights[0] - height).max(height - self.heights[1]).max(0.0);
        let beside = ((dot(q, q) - height * height).max(0.0).sqrt() - self.radius).max(0.0);
        // Less by what the difference of squares may have lost.
        (above * above + beside * beside) * (1.0 - 1e-9)
    }
}

/// Discs are made about so many triangles at most: about more they are no thinner than boxes, and take long to make.
const MOST_ON_DISC: u32 = 4096;

/// The point of all triangles that is closest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Near {
    /// The squared distance.
    pub squared: f64,
    /// Where it is.
    pub point: Vec3,
    /// On which triangle, in the hierarchy's own order: a start for a search nearby.
    pub triangle: u32,
    /// On which part of that.
    pub part: Part,
}

#[derive(Clone, Debug)]
pub(crate) struct Boxes {
    nodes: Vec<Node>,
    /// As many as nodes.
    dipoles: Vec<Dipole>,
    /// As many as nodes.
    discs: Vec<Disc>,
    /// In the order of the boxes.
    pub triangles: Vec<Triangle>,
    /// Of each triangle its number in the order in which it was given.
    pub order: Vec<u32>,
}

impl Boxes {
    /// The hierarchy of triangles, of which there is at least one: cuts of the least expected cost (the surface area heuristic in bins; Wald,
    /// "On fast Construction of SAH-based Bounding Volume Hierarchies", 2007).
    pub fn new(given: &[Triangle]) -> Self {
        let items: Vec<(Bounds, Vec3)> = given.iter().map(|t| Bounds::of(t.corners)).map(|b| (b, scale(add(b.low, b.high), 0.5))).collect();
        let mut order: Vec<u32> = (0..given.len() as u32).collect();
        let mut nodes = vec![Node { bounds: Bounds::EMPTY, first: 0, count: given.len() as u32 }];
        let mut open = vec![(0, 0)];
        while let Some((at, depth)) = open.pop() {
            let Node { first, count, .. } = nodes[at];
            let range = first as usize..(first + count) as usize;
            let of = |i: &u32| items[*i as usize];
            let bounds = order[range.clone()].iter().fold(Bounds::EMPTY, |sum, i| sum.join(of(i).0));
            nodes[at].bounds = bounds;
            let Some(left) = cut(&mut order[range], &of, &bounds, depth) else { continue };
            let child = nodes.len() as u32;
            nodes[at] = Node { bounds, first: child, count: 0 };
            nodes.push(Node { bounds, first, count: left as u32 });
            nodes.push(Node { bounds, first: first + left as u32, count: count - left as u32 });
            open.extend([(child as usize, depth + 1), (child as usize + 1, depth + 1)]);
        }
        let triangles = order.iter().map(|i| given[*i as usize]).collect();
        let mut boxes = Self { nodes, dipoles: Vec::new(), discs: Vec::new(), triangles, order };
        boxes.sum();
        boxes
    }

    pub(super) fn bounds(&self) -> Bounds {
        self.nodes[0].bounds
    }

    /// Sums up what the boxes are from afar. To be done again where triangles were turned over.
    pub fn sum(&mut self) {
        let none = Dipole { middle: [0.0; 3], area: [0.0; 3], radius: 0.0 };
        self.dipoles = vec![none; self.nodes.len()];
        let mut weights = vec![0.0; self.nodes.len()];
        let mut ranges = vec![[0; 2]; self.nodes.len()];
        // Boxes stand after those that hold them.
        for (at, node) in self.nodes.iter().enumerate().rev() {
            let (mut area, mut moment, mut weight) = ([0.0; 3], [0.0; 3], 0.0);
            let mut put = |a: Vec3, at: Vec3, w: f64| {
                (area, moment, weight) = (add(area, a), add(moment, scale(at, w)), weight + w);
            };
            if node.count > 0 {
                for triangle in self.leaf(node) {
                    put(triangle.area(), triangle.middle(), length(triangle.area()));
                }
                ranges[at] = [node.first, node.first + node.count];
            } else {
                let first = node.first as usize;
                for child in [first, first + 1] {
                    put(self.dipoles[child].area, self.dipoles[child].middle, weights[child]);
                }
                ranges[at] = [ranges[first][0], ranges[first + 1][1]];
            }
            let bounds = &node.bounds;
            let middle = if weight > 0.0 { scale(moment, 1.0 / weight) } else { scale(add(bounds.low, bounds.high), 0.5) };
            let radius = length([0, 1, 2].map(|i| (middle[i] - bounds.low[i]).max(bounds.high[i] - middle[i])));
            self.dipoles[at] = Dipole { middle, area, radius };
            weights[at] = weight;
        }
        let disc = |(dipole, [from, to]): (&Dipole, [u32; 2])| {
            if to - from > MOST_ON_DISC { Disc::ALL } else { Disc::of(&self.triangles[from as usize..to as usize], dipole) }
        };
        self.discs = self.dipoles.par_iter().zip(ranges).map(disc).collect();
    }

    fn leaf(&self, node: &Node) -> &[Triangle] {
        &self.triangles[node.first as usize..(node.first + node.count) as usize]
    }

    /// The closest point. A triangle that may be near, `hint`, makes the search short; none leaves the answer as it is but where two are equally close.
    pub fn closest(&self, p: Vec3, hint: u32) -> Near {
        let begin = self.triangles.get(hint as usize).and_then(|t| t.closer(p, f64::INFINITY));
        let mut best = match begin {
            Some((squared, point, part)) => Near { squared, point, triangle: hint, part },
            None => Near { squared: f64::INFINITY, point: p, triangle: 0, part: Part::Face },
        };
        let mut stack: Stack<(u32, f64)> = SmallVec::new();
        let mut at = 0u32;
        loop {
            let node = &self.nodes[at as usize];
            if self.discs[at as usize].squared(p) >= best.squared {
                // None of its triangles is closer, though its box is.
            } else if node.count > 0 {
                for (i, triangle) in self.leaf(node).iter().enumerate() {
                    if let Some((squared, point, part)) = triangle.closer(p, best.squared) {
                        best = Near { squared, point, triangle: node.first + i as u32, part };
                    }
                }
            } else {
                let [a, b] = [node.first, node.first + 1].map(|child| (child, self.nodes[child as usize].bounds.squared(p)));
                let (near, far) = if a.1 <= b.1 { (a, b) } else { (b, a) };
                if near.1 < best.squared {
                    if far.1 < best.squared {
                        stack.push(far);
                    }
                    at = near.0;
                    continue;
                }
            }
            at = loop {
                match stack.pop() {
                    Some((next, squared)) if squared < best.squared => break next,
                    Some(_) => {}
                    None => return best,
                }
            };
        }
    }

    /// How often the triangles wind about a point: the generalized winding number (Jacobson, Kavan and Sorkine-Hornung, 2013), where what is far is
    /// seen as one dipole a box (Barill and others, "Fast Winding Numbers for Soups and Clouds", 2018). `without` leaves one triangle out.
    pub fn winding(&self, p: Vec3, without: Option<u32>) -> f64 {
        let mut sum = 0.0;
        let mut stack: Stack<u32> = SmallVec::new();
        stack.push(0);
        while let Some(at) = stack.pop() {
            let (node, dipole) = (&self.nodes[at as usize], &self.dipoles[at as usize]);
            let away = sub(dipole.middle, p);
            let squared = dot(away, away);
            if squared > FAR * FAR * dipole.radius * dipole.radius {
                sum += dot(dipole.area, away) / (squared * squared.sqrt());
            } else if node.count == 0 {
                stack.extend([node.first, node.first + 1]);
            } else {
                for (i, triangle) in self.leaf(node).iter().enumerate() {
                    if without != Some(node.first + i as u32) {
                        sum += triangle.solid_angle(p);
                    }
                }
            }
        }
        sum / (4.0 * std::f64::consts::PI)
    }

    /// Whether a ray crosses an odd number of triangles.
    pub fn odd(&self, p: Vec3, direction: Vec3) -> bool {
        let inverse = direction.map(|c| 1.0 / c);
        let mut odd = false;
        let mut stack: Stack<u32> = SmallVec::new();
        stack.push(0);
        while let Some(at) = stack.pop() {
            let node = &self.nodes[at as usize];
            if !node.bounds.hit(p, inverse) {
                continue;
            }
            if node.count == 0 {
                stack.extend([node.first, node.first + 1]);
            } else {
                odd ^= self.leaf(node).iter().filter(|t| crossed(t, p, direction)).count() % 2 == 1;
            }
        }
        odd
    }

    /// Whether a line from `p` to `q` goes through a triangle of those that `counts` takes.
    pub fn pierced(&self, p: Vec3, q: Vec3, counts: impl Fn(u32) -> bool) -> bool {
        let line = Bounds::of([p, q]);
        let mut stack: Stack<u32> = SmallVec::new();
        stack.push(0);
        while let Some(at) = stack.pop() {
            let node = &self.nodes[at as usize];
            if !node.bounds.meets(&line) {
                continue;
            }
            if node.count == 0 {
                stack.extend([node.first, node.first + 1]);
                continue;
            }
            for (i, triangle) in self.leaf(node).iter().enumerate() {
                if counts(node.first + i as u32) && goes_through(triangle, p, q) {
                    return true;
                }
            }
        }
        false
    }
}

/// Parts triangles in two, and says how many are in the first part; none where they are better left together.
fn cut(order: &mut [u32], of: &impl Fn(&u32) -> (Bounds, Vec3), bounds: &Bounds, depth: usize) -> Option<usize> {
    let count = order.len();
    if count <= 1 {
        return None;
    }
    let middles = Bounds::of(order.iter().map(|i| of(i).1));
    let size = middles.size();
    let axis = [0, 1, 2].into_iter().fold(0, |widest, i| if size[i] > size[widest] { i } else { widest });
    let half = |order: &mut [u32]| {
        order.select_nth_unstable_by(count / 2, |a, b| of(a).1[axis].total_cmp(&of(b).1[axis]).then(a.cmp(b)));
        count / 2
    };
    if size[axis] <= 0.0 || depth >= DEEP {
        return (count > LEAF).then(|| half(order));
    }
    let bin = |i: &u32| (((of(i).1[axis] - middles.low[axis]) / size[axis] * BINS as f64) as usize).min(BINS - 1);
    let mut bins = [(Bounds::EMPTY, 0usize); BINS];
    for i in order.iter() {
        let (sum, number) = &mut bins[bin(i)];
        (*sum, *number) = (sum.join(of(i).0), *number + 1);
    }
    let mut after = [0.0; BINS];
    let (mut sum, mut number) = (Bounds::EMPTY, 0);
    for k in (1..BINS).rev() {
        (sum, number) = (sum.join(bins[k].0), number + bins[k].1);
        after[k] = sum.area() * number as f64;
    }
    let (mut sum, mut number) = (Bounds::EMPTY, 0);
    let mut best = (f64::INFINITY, 0);
    for k in 1..BINS {
        (sum, number) = (sum.join(bins[k - 1].0), number + bins[k - 1].1);
        let cost = sum.area() * number as f64 + after[k];
        if number > 0 && number < count && cost < best.0 {
            best = (cost, k);
        }
    }
    // To look at a box costs about as much as to look at a triangle.
    if count <= LEAF && best.0 + bounds.area() >= bounds.area() * count as f64 {
        return None;
    }
    if best.1 == 0 {
        return (count > LEAF).then(|| half(order));
    }
    // Those of the first part to the front.
    let mut left = 0;
    for i in 0..count {
        if bin(&order[i]) < best.1 {
            order.swap(i, left);
            left += 1;
        }
    }
    Some(left)
}

/// Whether a ray crosses a triangle (Möller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997).
fn crossed(triangle: &Triangle, p: Vec3, direction: Vec3) -> bool {
    let [a, b, c] = triangle.corners;
    let (ab, ac, ap) = (sub(b, a), sub(c, a), sub(p, a));
    let across = cross(direction, ac);
    let whole = dot(ab, across);
    if whole == 0.0 {
        return false;
    }
    let u = dot(ap, across) / whole;
    let turned = cross(ap, ab);
    let v = dot(direction, turned) / whole;
    u >= 0.0 && v >= 0.0 && u + v <= 1.0 && dot(ac, turned) / whole > 0.0
}

/// Whether a line from `p` to `q` goes through a triangle, and does not merely touch it.
fn goes_through(triangle: &Triangle, p: Vec3, q: Vec3) -> bool {
    let [a, b, c] = triangle.corners;
    let (from, to) = (dot(sub(p, a), triangle.normal), dot(sub(q, a), triangle.normal));
    let least = 1e-9 * length(sub(q, p));
    if triangle.is_flat() || from * to >= 0.0 || from.abs() <= least || to.abs() <= least {
        return false;
    }
    let x = add(p, scale(sub(q, p), from / (from - to)));
    [(a, b), (b, c), (c, a)].iter().all(|(from, to)| {
        let side = sub(*to, *from);
        dot(cross(side, sub(x, *from)), triangle.normal) > 1e-9 * dot(side, side)
    })
}
