//! What is nearest of many pieces: a hierarchy of boxes in the order in which it is walked, so that no stack is needed.

use super::bow::{BOW, Bow};
use super::face::{FACE, Face};
use crate::kept::{Data, HEAD, Known};
use crate::vector::{Vec3, add, dot, length, scale, sub, unit};
use std::collections::BTreeMap;

/// Pieces of a box that is not divided.
const FEW: usize = 3;
/// Words of a box on a device.
const NODE: usize = 8;

/// A box of the hierarchy.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Node {
    low: Vec3,
    high: Vec3,
    /// Which box is next where nothing in this one can be nearest. Of a box that is not divided: its first piece.
    next: u32,
    /// Its pieces; none of a box that is divided, which stands before the boxes in it.
    pieces: u32,
}

/// What a figure is made of.
#[derive(Clone, Debug, PartialEq)]
enum Pieces {
    Bows(Vec<Bow>),
    Faces(Vec<Face>),
}

/// Curves, of which the way to the nearest is told, or a closed surface, with the way below zero inside.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    pieces: Pieces,
    nodes: Vec<Node>,
    content: u64,
}

/// What is nearest to a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// The distance.
    pub value: f64,
    /// How it changes along each axis.
    pub gradient: Vec3,
}

impl Figure {
    /// Of curves; none where there are none.
    pub fn of_bows(bows: &[Bow]) -> Option<Self> {
        let (nodes, order) = boxes(&bows.iter().map(Bow::bounds).collect::<Vec<_>>())?;
        Some(Self::hashed(Pieces::Bows(order.into_iter().filter_map(|i| bows.get(i).copied()).collect()), nodes))
    }

    /// Of a closed surface; none where there is none.
    pub fn of_faces(faces: &[Face]) -> Option<Self> {
        let (nodes, order) = boxes(&faces.iter().map(Face::bounds).collect::<Vec<_>>())?;
        Some(Self::hashed(Pieces::Faces(order.into_iter().filter_map(|i| faces.get(i).copied()).collect()), nodes))
    }

    fn hashed(pieces: Pieces, nodes: Vec<Node>) -> Self {
        let mut figure = Self { pieces, nodes, content: 0 };
        let mix = |hash: u64, number: f64| (hash.rotate_left(23) ^ number.to_bits()).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let hash = figure.numbers().into_iter().fold(0x51_7c_c1_b7_27_22_0a_95, mix);
        figure.content = (hash ^ hash >> 32).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        figure
    }

    fn numbers(&self) -> Vec<f64> {
        match &self.pieces {
            Pieces::Bows(bows) => bows.iter().flat_map(Bow::numbers).collect(),
            Pieces::Faces(faces) => faces.iter().flat_map(Face::numbers).collect(),
        }
    }

    /// What is nearest to a place. The twin of `sf_figured` in `emit/library.rs`.
    pub fn at(&self, p: Vec3) -> Found {
        let mut best = (f64::INFINITY, [0.0, 1.0, 0.0], [0.0; 3]);
        let mut i = 0;
        while let Some(node) = self.nodes.get(i) {
            let beyond = beyond(p, p, [node.low, node.high]);
            let is_near = dot(beyond, beyond) < best.0;
            i = if node.pieces == 0 && !is_near { node.next as usize } else { i + 1 };
            if node.pieces == 0 || !is_near {
                continue;
            }
            let of = node.next as usize..(node.next + node.pieces) as usize;
            let mut take = |away: Vec3, out: Vec3| {
                let squared = dot(away, away);
                if squared < best.0 {
                    best = (squared, away, out);
                }
            };
            match &self.pieces {
                Pieces::Bows(bows) => bows.get(of).unwrap_or_default().iter().for_each(|bow| take(bow.away(p), [0.0; 3])),
                Pieces::Faces(faces) => faces.get(of).unwrap_or_default().iter().map(|face| face.away(p)).for_each(|(away, out)| take(away, out)),
            }
        }
        let (squared, away, out) = best;
        let way = squared.sqrt();
        let side = if dot(out, away) < 0.0 { -1.0 } else { 1.0 };
        // On the surface itself, straight out of it; on a curve, somewhere.
        let gradient = if way > 1e-12 { scale(away, side / way) } else { unit(out).unwrap_or([0.0, 1.0, 0.0]) };
        Found { value: side * way, gradient }
    }

    /// Least and greatest corner of a box that holds it.
    pub fn bounds(&self) -> [Vec3; 2] {
        self.nodes.first().map_or([[0.0; 3]; 2], |node| [node.low, node.high])
    }

    /// Whether it has an inside.
    pub fn is_solid(&self) -> bool {
        matches!(self.pieces, Pieces::Faces(_))
    }

    /// What the value lies between in a box of places: no farther from that in its middle than half of its diagonal, no less than the way to the box about the
    /// figure, and no more below zero than half of the shortest side of that.
    pub fn value_within(&self, low: Vec3, high: Vec3) -> [f64; 2] {
        let [from, to] = self.bounds();
        let away = length(beyond(low, high, [from, to]));
        let deepest = if self.is_solid() { 0.5 * sub(to, from).into_iter().fold(f64::INFINITY, f64::min) } else { 0.0 };
        let least = if away > 0.0 { away } else { -deepest };
        let size = length(sub(high, low));
        if !size.is_finite() {
            return [least, f64::INFINITY];
        }
        let value = self.at(scale(add(low, high), 0.5)).value;
        let off = 0.5 * size + 1e-12 * (value.abs() + self.size());
        [least.max(value - off).min(value), value + off]
    }

    /// The greatest coordinate of the box about it, without its sign.
    pub fn size(&self) -> f64 {
        self.bounds().iter().flatten().fold(0.0, |size: f64, c| size.max(c.abs()))
    }

    /// How many bytes it takes on a device.
    pub fn bytes(&self) -> usize {
        let pieces = match &self.pieces {
            Pieces::Bows(bows) => BOW * bows.len(),
            Pieces::Faces(faces) => FACE * faces.len(),
        };
        4 * (HEAD + NODE * self.nodes.len() + pieces)
    }
}

/// From the nearest place of a box to the nearest one of a box of places; zero along the axes on which they overlap.
fn beyond(low: Vec3, high: Vec3, [from, to]: [Vec3; 2]) -> Vec3 {
    let (over, under) = (sub(low, to), sub(from, high));
    let ([a, b, c], [d, e, f]) = (over, under);
    [a.max(d).max(0.0), b.max(e).max(0.0), c.max(f).max(0.0)]
}

/// The boxes about boxes, and the order of those; none where there are none.
fn boxes(bounds: &[[Vec3; 2]]) -> Option<(Vec<Node>, Vec<usize>)> {
    let mut order: Vec<usize> = (0..bounds.len()).collect();
    if order.is_empty() {
        return None;
    }
    let mut nodes = Vec::new();
    divide(bounds, &mut order, 0, &mut nodes);
    Some((nodes, order))
}

fn divide(bounds: &[[Vec3; 2]], order: &mut [usize], first: usize, nodes: &mut Vec<Node>) {
    let [low, high] = order.iter().filter_map(|i| bounds.get(*i)).copied().reduce(|[a, b], [c, d]| [both(a, c, f64::min), both(b, d, f64::max)]).unwrap_or_default();
    // Rounded outward, for 32 bits.
    let slack = 1e-6 * low.iter().chain(&high).fold(f64::MIN_POSITIVE, |size: f64, c| size.max(c.abs()));
    let at = nodes.len();
    nodes.push(Node { low: low.map(|c| c - slack), high: high.map(|c| c + slack), next: first as u32, pieces: order.len() as u32 });
    if order.len() <= FEW {
        return;
    }
    let middle = |i: &usize| bounds.get(*i).map_or([0.0; 3], |[low, high]| add(*low, *high));
    let [from, to] = order.iter().map(middle).map(|m| [m, m]).reduce(|[a, b], [c, d]| [both(a, c, f64::min), both(b, d, f64::max)]).unwrap_or_default();
    let sides = sub(to, from);
    let axis = (0..3).max_by(|i, j| f64::total_cmp(sides.get(*i).unwrap_or(&0.0), sides.get(*j).unwrap_or(&0.0))).unwrap_or(0);
    let along = |i: &usize| middle(i).get(axis).copied().unwrap_or(0.0);
    let half = order.len() / 2;
    order.select_nth_unstable_by(half, |i, j| along(i).total_cmp(&along(j)).then(i.cmp(j)));
    let (left, right) = order.split_at_mut(half);
    divide(bounds, left, first, nodes);
    divide(bounds, right, first + half, nodes);
    let next = nodes.len() as u32;
    if let Some(node) = nodes.get_mut(at) {
        (node.next, node.pieces) = (next, 0);
    }
}

fn both(a: Vec3, b: Vec3, of: fn(f64, f64) -> f64) -> Vec3 {
    let ([a, b, c], [d, e, f]) = (a, b);
    [of(a, d), of(b, e), of(c, f)]
}

static KNOWN: Known<Figure> = Known::new(BTreeMap::new());

impl Data for Figure {
    fn content(&self) -> u64 {
        self.content
    }

    /// Boxes, pieces.
    fn words(&self, at: u32) -> ([u32; HEAD], Vec<u32>) {
        let bits = |c: f64| (c as f32).to_bits();
        let boxes = self.nodes.len() as u32;
        let mut head = [0; HEAD];
        for (slot, word) in head.iter_mut().zip([at, boxes, at + NODE as u32 * boxes, u32::from(self.is_solid())]) {
            *slot = word;
        }
        let node = |node: &Node| {
            let ([a, b, c], [d, e, f]) = (node.low.map(bits), node.high.map(bits));
            [a, b, c, d, e, f, node.next, node.pieces]
        };
        (head, self.nodes.iter().flat_map(node).chain(self.numbers().into_iter().map(bits)).collect())
    }

    fn known() -> &'static Known<Self> {
        &KNOWN
    }
}
