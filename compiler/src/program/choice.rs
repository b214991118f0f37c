//! `if`: one of two values, or what lies between.

use super::value::Value;
use super::{Elaborated, Elaborator, Env};
use crate::diagnostic::{Code, Diagnostic};
use crate::graph::kernel::Op;
use crate::graph::{Material, MaterialId, MaterialImage, NodeId};
use crate::source::Span;
use crate::syntax::ast::{Expr, ExprKind};

impl Elaborator<'_> {
    /// `if condition { a } else { b }` between values of one kind.
    pub fn select(
        &mut self,
        condition: NodeId,
        a: &Value,
        b: &Value,
        span: Span,
        env: &Env,
    ) -> Elaborated<Value> {
        match (a, b) {
            (Value::Number(x, wx), Value::Number(y, wy)) => {
                let node = self.graph.op(Op::Select, &[condition, *x, *y]);
                self.locate(node, span);
                Ok(Value::Number(node, *wx && *wy))
            }
            (Value::Bool(x), Value::Bool(y)) => {
                let both = self.graph.op(Op::And, &[condition, *x]);
                let not = self.graph.op(Op::Not, &[condition]);
                let other = self.graph.op(Op::And, &[not, *y]);
                Ok(Value::Bool(self.graph.op(Op::Or, &[both, other])))
            }
            (Value::Vector(_), Value::Vector(_) | Value::Number(..)) | (Value::Number(..), Value::Vector(_)) => {
                self.componentwise(a, b, span, |e, x, y| e.graph.op(Op::Select, &[condition, x, y]))
            }
            (Value::Matrix(n, x), Value::Matrix(m, y)) if n == m => {
                let cells = x
                    .iter()
                    .zip(y.iter())
                    .map(|(x, y)| self.graph.op(Op::Select, &[condition, *x, *y]));
                Ok(Value::Matrix(*n, cells.collect()))
            }
            (Value::List(x), Value::List(y)) if x.len() == y.len() => {
                let items = x
                    .iter()
                    .zip(y.iter())
                    .map(|(x, y)| self.select(condition, x, y, span, env))
                    .collect::<Elaborated<Vec<_>>>()?;
                Ok(Value::List(items.into()))
            }
            (Value::Nothing, Value::Nothing) => Ok(Value::Nothing),
            (Value::Shape(_) | Value::Nothing, Value::Shape(_) | Value::Nothing) => {
                let dimensions = match (a, b) {
                    (Value::Shape(id), _) | (_, Value::Shape(id)) => self.graph.dimensions(*id),
                    _ => 3,
                };
                let x = self.to_shape(a, dimensions, span)?;
                let y = self.to_shape(b, dimensions, span)?;
                let point = self.graph.point();
                let (x, y) = (self.graph.field(x, point), self.graph.field(y, point));
                let value = self.graph.op(Op::Select, &[condition, x, y]);
                if self.graph.reads_point(condition) {
                    return Err(self.error(
                        Code::TypeMismatch,
                        span,
                        "which shape stands here can't depend on the point",
                        "choose by parameters, `time` or the index of a `for`; in a formula choose between distances, `if p.x > 0 { a.at(p) } else { b.at(p) }`",
                    ));
                }
                Ok(Value::Shape(self.make_shape(dimensions, value, span)))
            }
            (Value::Material(x), Value::Material(y)) => {
                Ok(Value::Material(self.mix_materials(condition, *x, *y)))
            }
            (Value::Shape(_), Value::Number(..)) | (Value::Number(..), Value::Shape(_)) => {
                let x = self.to_number(a, span, env)?;
                let y = self.to_number(b, span, env)?;
                Ok(Value::number(self.graph.op(Op::Select, &[condition, x, y])))
            }
            _ => {
                let (left, right) = (a.describe(&self.graph), b.describe(&self.graph));
                Err(self.error(
                    Code::TypeMismatch,
                    span,
                    format!("one branch is {left} and the other is {right}"),
                    "give both branches the same kind of value",
                ))
            }
        }
    }

    fn mix_materials(&mut self, condition: NodeId, x: MaterialId, y: MaterialId) -> MaterialId {
        let (Some(x), Some(y)) = (
            self.graph.materials.get(x.0 as usize).cloned(),
            self.graph.materials.get(y.0 as usize).cloned(),
        ) else {
            return x;
        };
        let zero = self.graph.constant(0.0);
        let mut pick = |a: NodeId, b: NodeId| self.graph.op(Op::Select, &[condition, a, b]);
        let glass = match (x.glass, y.glass) {
            (None, None) => None,
            (a, b) => {
                let index = b.or(a).map_or(zero, |[_, index]| index);
                let ([t, i], [u, j]) = (a.unwrap_or([zero, index]), b.unwrap_or([zero, index]));
                Some([pick(t, u), pick(i, j)])
            }
        };
        let relief = match (x.relief, y.relief) {
            (None, None) => None,
            (a, b) => Some(pick(a.unwrap_or(zero), b.unwrap_or(zero))),
        };
        let mut images: Vec<_> = Vec::new();
        for (image, first) in x.images.iter().map(|i| (i, true)).chain(y.images.iter().map(|i| (i, false))) {
            let weight = image.weight.map(|w| if first { pick(w, zero) } else { pick(zero, w) });
            images.push(MaterialImage { weight, ..image.clone() });
        }
        let mut three = |a: [NodeId; 3], b: [NodeId; 3]| {
            let ([a0, a1, a2], [b0, b1, b2]) = (a, b);
            [pick(a0, b0), pick(a1, b1), pick(a2, b2)]
        };
        let material = Material {
            name: format!("{} or {}", x.name, y.name).into(),
            glass,
            relief,
            images: images.into(),
            color: three(x.color, y.color),
            emission: three(x.emission, y.emission),
            roughness: pick(x.roughness, y.roughness),
            metallic: pick(x.metallic, y.metallic),
            reflectivity: pick(x.reflectivity, y.reflectivity),
            solid: x.solid || y.solid,
        };
        self.graph.add_material(material)
    }

    pub(super) fn choice(
        &mut self,
        condition: &Expr,
        then: &Expr,
        otherwise: Option<&Expr>,
        span: Span,
        env: &Env,
    ) -> Elaborated<Value> {
        let node = match self.expression(condition, env)? {
            Value::Bool(node) => node,
            other => {
                let found = other.describe(&self.graph);
                return Err(self.error(
                    Code::TypeMismatch,
                    condition.span,
                    format!("`if` needs a condition, and this is {found}"),
                    "compare it with something, for example `a > 0`",
                ));
            }
        };
        if let Some(constant) = self.graph.as_constant(node) {
            // Decided while compiling: the other branch is not entered, so calls can end here.
            return match (constant != 0.0, otherwise) {
                (true, _) => self.expression(then, env),
                (false, Some(otherwise)) => self.expression(otherwise, env),
                (false, None) => Ok(Value::Nothing),
            };
        }
        let a = self.expression(then, env);
        let b = match otherwise {
            Some(otherwise) => self.expression(otherwise, env),
            None => Ok(Value::Nothing),
        };
        let (a, b) = (a?, b?);
        if otherwise.is_none() && !matches!(a, Value::Shape(_) | Value::Nothing) {
            return Err(self.error(
                Code::TypeMismatch,
                span,
                "this `if` has no `else`, so it has no value where the condition is false",
                "write `else { … }`; only between shapes is a missing one the empty shape",
            ));
        }
        if let Some(other) = otherwise
            && !a.is_like(&b, &self.graph)
            && !(env.point.is_some() && a.is_field() && b.is_field())
        {
            let (left, right) = (a.describe(&self.graph), b.describe(&self.graph));
            let error = Diagnostic::new(
                Code::TypeMismatch,
                result_of(other),
                format!("one branch is {left} and the other is {right}"),
                "give both branches the same kind of value",
            );
            return Err(self.report(error.label(result_of(then), left)));
        }
        self.select(node, &a, &b, span, env)
    }
}

/// The expression that gives the value of a block.
fn result_of(expr: &Expr) -> Span {
    match &expr.kind {
        ExprKind::Block(_, value) => result_of(value),
        _ => expr.span,
    }
}
