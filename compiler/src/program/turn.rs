//! A vector turned about an axis.

use super::value::Value;
use super::{Elaborated, Elaborator};
use crate::diagnostic::Code;
use crate::graph::NodeId;
use crate::graph::kernel::Op;
use crate::reference::vector::{add, cross, scale, unit};
use crate::source::Span;

impl Elaborator<'_> {
    /// A vector turned about an axis through the origin by the right-hand rule.
    pub fn turn_about(
        &mut self,
        [a, b, c]: [NodeId; 3],
        axis: [NodeId; 3],
        angle: NodeId,
        span: Span,
    ) -> Elaborated<Value> {
        let constants = axis.map(|n| self.graph.as_constant(n));
        if let [Some(i), Some(j), Some(k)] = constants {
            let length = (i * i + j * j + k * k).sqrt();
            if length == 0.0 {
                return Err(self.error(
                    Code::BadValue,
                    span,
                    "an axis of length zero has no direction",
                    "write `x`, `y`, `z` or another vector that is not zero",
                ));
            }
            let along = [i / length, j / length, k / length];
            // Along x, y or z: a turn of the plane of the other two.
            let plane = match along.map(|c| c.abs() > 1.0 - 1e-12) {
                [true, ..] => Some((0, along[0])),
                [_, true, _] => Some((1, along[1])),
                [_, _, true] => Some((2, along[2])),
                _ => None,
            };
            if let Some((along, sign)) = plane {
                let angle = if sign < 0.0 { self.graph.op(Op::Neg, &[angle]) } else { angle };
                let mut turn = |u: NodeId, v: NodeId| {
                    (
                        self.graph.op(Op::TurnU, &[u, v, angle]),
                        self.graph.op(Op::TurnV, &[u, v, angle]),
                    )
                };
                let cells = match along {
                    0 => {
                        let (y, z) = turn(b, c);
                        [a, y, z]
                    }
                    1 => {
                        let (z, x) = turn(c, a);
                        [x, b, z]
                    }
                    _ => {
                        let (x, y) = turn(a, b);
                        [x, y, c]
                    }
                };
                return Ok(Value::Vector(cells.into()));
            }
            return Ok(Value::Vector(self.turn_about_slanted([a, b, c], along, angle).into()));
        }
        // Rodrigues' formula: v cos t + (k × v) sin t + k (k·v)(1 - cos t).
        let length = self.length(&axis, span);
        let k = axis.map(|n| self.graph.op(Op::Div, &[n, length]));
        let cos = self.graph.op(Op::Cos, &[angle]);
        let sin = self.graph.op(Op::Sin, &[angle]);
        let one = self.graph.constant(1.0);
        let rest = self.graph.op(Op::Sub, &[one, cos]);
        let v = [a, b, c];
        let dots: Vec<NodeId> =
            k.iter().zip(v).map(|(k, v)| self.graph.op(Op::Mul, &[*k, v])).collect();
        let along = self.sum(&dots);
        let along = self.graph.op(Op::Mul, &[along, rest]);
        let [k0, k1, k2] = k;
        let crossed = {
            let mut minor = |p: NodeId, q: NodeId, r: NodeId, s: NodeId| {
                let x = self.graph.op(Op::Mul, &[p, q]);
                let y = self.graph.op(Op::Mul, &[r, s]);
                self.graph.op(Op::Sub, &[x, y])
            };
            [minor(k1, c, k2, b), minor(k2, a, k0, c), minor(k0, b, k1, a)]
        };
        let cells = (0..3)
            .filter_map(|i| Some((*v.get(i)?, *crossed.get(i)?, *k.get(i)?)))
            .map(|(v, crossed, k)| {
                let first = self.graph.op(Op::Mul, &[v, cos]);
                let second = self.graph.op(Op::Mul, &[crossed, sin]);
                let third = self.graph.op(Op::Mul, &[k, along]);
                self.sum(&[first, second, third])
            })
            .collect();
        Ok(Value::Vector(cells))
    }

    /// A vector turned about a unit vector: in the plane across that, so that it is seen to keep lengths, or as a matrix of numbers where the angle
    /// is one.
    fn turn_about_slanted(&mut self, v: [NodeId; 3], axis: [f64; 3], angle: NodeId) -> [NodeId; 3] {
        let [x, y, z] = axis.map(f64::abs);
        let sideways = if x <= y && x <= z {
            [1.0, 0.0, 0.0]
        } else if y <= z {
            [0.0, 1.0, 0.0]
        } else {
            [0.0, 0.0, 1.0]
        };
        let first = unit(cross(axis, sideways)).unwrap_or([1.0, 0.0, 0.0]);
        let second = cross(axis, first);
        if let Some(angle) = self.graph.as_constant(angle) {
            let (sin, cos) = angle.sin_cos();
            let turned = |[f, s, a]: [f64; 3]| {
                add(add(scale(first, f * cos - s * sin), scale(second, f * sin + s * cos)), scale(axis, a))
            };
            let rows = transposed(transposed([first, second, axis]).map(turned));
            return rows.map(|row| self.along(row, v));
        }
        let [u, w, height] = [first, second, axis].map(|direction| self.along(direction, v));
        let turned = [self.graph.op(Op::TurnU, &[u, w, angle]), self.graph.op(Op::TurnV, &[u, w, angle]), height];
        transposed([first, second, axis]).map(|row| self.along(row, turned))
    }

    /// The sum of three numbers times factors.
    fn along(&mut self, factors: [f64; 3], v: [NodeId; 3]) -> NodeId {
        let parts: Vec<NodeId> = factors
            .into_iter()
            .zip(v)
            .map(|(factor, v)| {
                let factor = self.graph.constant(factor);
                self.graph.op(Op::Mul, &[factor, v])
            })
            .collect();
        self.sum(&parts)
    }
}

/// A matrix with its rows as columns.
fn transposed([[a, b, c], [d, e, f], [g, h, i]]: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    [[a, d, g], [b, e, h], [c, f, i]]
}
