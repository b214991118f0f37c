//! A vector turned about an axis.

use super::value::Value;
use super::{Elaborated, Elaborator};
use crate::diagnostic::Code;
use crate::graph::NodeId;
use crate::graph::kernel::Op;
use crate::vector::{add, cross, scale, unit};
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
                [true, ..] => Some(([1, 2], along[0])),
                [_, true, _] => Some(([2, 0], along[1])),
                [_, _, true] => Some(([0, 1], along[2])),
                _ => None,
            };
            if let Some((across, sign)) = plane {
                let angle = if sign < 0.0 { self.graph.op(Op::Neg, &[angle]) } else { angle };
                return Ok(Value::Vector(self.turn_plane([a, b, c], across, angle).into()));
            }
            return Ok(Value::Vector(self.turn_about_slanted([a, b, c], along, angle).into()));
        }
        if !axis.iter().any(|&n| self.graph.reads_point(n)) {
            return Ok(Value::Vector(self.turn_about_live([a, b, c], axis, angle).into()));
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

    /// A vector turned in the plane of two of its coordinates, from the first towards the second.
    fn turn_plane(&mut self, mut v: [NodeId; 3], plane: [usize; 2], angle: NodeId) -> [NodeId; 3] {
        if let [Some(a), Some(b)] = plane.map(|k| v.get(k).copied()) {
            let turned = [Op::TurnU, Op::TurnV].map(|op| self.graph.op(op, &[a, b, angle]));
            for (k, cell) in plane.into_iter().zip(turned) {
                if let Some(slot) = v.get_mut(k) {
                    *slot = cell;
                }
            }
        }
        v
    }

    /// A vector turned about an axis that is the same wherever the point is, though no number: it is turned so that the axis is a
    /// coordinate's, about that, and back, each of which is seen to keep lengths. About an axis of length zero it is turned somehow.
    fn turn_about_live(&mut self, v: [NodeId; 3], axis: [NodeId; 3], angle: NodeId) -> [NodeId; 3] {
        let [x, y, z] = axis;
        // Within a plane of two coordinates one turn does.
        for (across, [i, j]) in [(x, [1, 2]), (y, [2, 0]), (z, [0, 1])] {
            if let (Some(0.0), Some(&a), Some(&b)) = (self.graph.as_constant(across), axis.get(i), axis.get(j)) {
                let aside = self.graph.op(Op::Atan2, &[b, a]);
                let v = self.turn_plane(v, [j, i], aside);
                let v = self.turn_plane(v, [j, 3 - i - j], angle);
                return self.turn_plane(v, [i, j], aside);
            }
        }
        let around = self.graph.op(Op::Atan2, &[y, x]);
        let out = self.graph.op(Op::Length2, &[x, y]);
        let down = self.graph.op(Op::Atan2, &[out, z]);
        let v = self.turn_plane(v, [1, 0], around);
        let v = self.turn_plane(v, [0, 2], down);
        let v = self.turn_plane(v, [0, 1], angle);
        let v = self.turn_plane(v, [2, 0], down);
        self.turn_plane(v, [0, 1], around)
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
