//! Where a shape stands that is called at a moved and turned point.

use super::Box3;
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::{Graph, Leaf, Node, NodeId};
use crate::vector::{along, scale};

/// No coordinate of a point that is only moved and turned is a longer formula.
const MOST_OPENED: usize = 64;
/// How far from one and from zero the products of a matrix's rows may be by rounding.
const ROUNDED: f64 = 1e-9;

/// An isometry of space: a point p of the one space is `turn p + shift` of the other.
pub struct Placed {
    turn: [[f64; 3]; 3],
    shift: [f64; 3],
}

impl Placed {
    /// What a point is of the own space's, where its coordinates are that moved and turned by numbers.
    pub fn of(graph: &Graph, point: &[NodeId]) -> Option<Self> {
        let mut placed = Self { turn: [[0.0; 3]; 3], shift: [0.0; 3] };
        let mut left = MOST_OPENED;
        for (i, (row, shift)) in placed.turn.iter_mut().zip(&mut placed.shift).enumerate() {
            [row[0], row[1], row[2], *shift] = affine(graph, *point.get(i)?, &mut left)?;
        }
        let dot = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let turn = &placed.turn;
        let is_unit = |(i, a): (usize, &[f64; 3])| turn.iter().enumerate().all(|(j, b)| (dot(a, b) - f64::from(u8::from(i == j))).abs() < ROUNDED);
        turn.iter().enumerate().all(is_unit).then_some(placed)
    }

    /// The farthest that it moves a point along an axis, but for its turn.
    pub fn farthest(&self) -> f64 {
        self.shift.into_iter().fold(0.0, |far, shift| far.max(shift.abs()))
    }

    /// Whether it does more than move.
    pub fn turns(&self) -> bool {
        (0..3).any(|i| self.turn.get(i).and_then(|row| row.get(i)) != Some(&1.0))
    }

    /// The point of the own space that is moved to one of the other.
    pub fn back_to(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let [a, b, c] = self.shift;
        let [first, second, third] = self.turn;
        along(along(scale(first, x - a), second, y - b), third, z - c)
    }

    /// The box in the own space that holds a box of the other.
    pub fn back(&self, own: Box3) -> Box3 {
        if own.is_empty() {
            return own;
        }
        let moved = |j: usize| own.axis(j).sub(Interval::point(self.shift.get(j).copied().unwrap_or(0.0)));
        (0..3).fold(own, |back, i| {
            let column = self.turn.iter().map(|row| row.get(i).copied().unwrap_or(0.0));
            let parts = column.enumerate().filter(|(_, by)| *by != 0.0);
            let side = parts.fold(Interval::ZERO, |sum, (j, by)| {
                sum.add(if by == 1.0 { moved(j) } else { moved(j).mul(Interval::point(by)).grow(2.0 * ROUNDED * moved(j).magnitude()) })
            });
            back.with_axis(i, side)
        })
    }
}

/// The coefficients of the coordinates, and what is added, of a number that is a sum of multiples of them.
fn affine(graph: &Graph, node: NodeId, left: &mut usize) -> Option<[f64; 4]> {
    *left = left.checked_sub(1)?;
    let sum = |a: [f64; 4], b: [f64; 4], by: f64| std::array::from_fn(|i| a.get(i).zip(b.get(i)).map_or(0.0, |(a, b)| a + by * b));
    let times = |a: [f64; 4], by: f64| a.map(|c| c * by);
    let known = match graph.node(node) {
        Node::Constant(bits) => [0.0, 0.0, 0.0, f64::from_bits(*bits)],
        Node::Leaf(Leaf::P(i)) => {
            let mut one = [0.0; 4];
            *one.get_mut(usize::from(*i)).filter(|_| *i < 3)? = 1.0;
            one
        }
        Node::Op(op, args) => {
            let mut part = |i: usize| affine(graph, *args.get(i)?, left);
            let number = |i: usize| graph.as_constant(*args.get(i)?);
            match op {
                Op::Add => sum(part(0)?, part(1)?, 1.0),
                Op::Sub => sum(part(0)?, part(1)?, -1.0),
                Op::Neg => times(part(0)?, -1.0),
                Op::Mul => match (number(0), number(1)) {
                    (Some(by), _) => times(part(1)?, by),
                    (_, by) => times(part(0)?, by?),
                },
                Op::TurnU => sum(times(part(0)?, number(2)?.cos()), part(1)?, -number(2)?.sin()),
                Op::TurnV => sum(times(part(0)?, number(2)?.sin()), part(1)?, number(2)?.cos()),
                _ => return None,
            }
        }
        _ => return None,
    };
    known.iter().all(|c| c.is_finite()).then_some(known)
}

impl Graph {
    /// Whether no shape is asked at one point of its own for all points of a region, as far as that is told at once: wherever one is called the point is
    /// only moved and turned.
    pub fn spreads(&self) -> bool {
        self.calls().all(|args| Placed::of(self, args).is_some())
    }
}
