//! Operators between values: numbers, vectors, matrices, shapes, conditions.

use super::value::{together, Value};
use super::{Elaborated, Elaborator, Env, Stop};
use crate::diagnostic::{Code, Diagnostic};
use crate::graph::kernel::Op;
use crate::graph::{FAR, Function, Node, NodeId, ShapeId};
use crate::source::Span;
use crate::syntax::ast::{BinaryOp, Expr, Type, UnaryOp};

impl Elaborator<'_> {
    /// The shape of which this one is the complement, if that is all it is.
    fn complemented(&self, id: ShapeId, point: &[NodeId]) -> Option<ShapeId> {
        let shape = self.graph.shape(id).filter(|shape| shape.variables.is_empty())?;
        let Node::Op(Op::Neg, of) = self.graph.node(shape.value) else { return None };
        match self.graph.node(*of.first()?) {
            Node::Call(inner, Function::Field, at) if point.starts_with(at) => Some(*inner),
            _ => None,
        }
    }

    pub(super) fn unary(&mut self, op: UnaryOp, inner: &Expr, span: Span, env: &Env) -> Elaborated<Value> {
        let value = self.expression(inner, env)?;
        match (op, &value) {
            (UnaryOp::Neg, Value::Number(..) | Value::Vector(_)) => self.each(&value, span, Op::Neg),
            (UnaryOp::Neg, Value::Matrix(n, cells)) => {
                let cells = cells.iter().map(|c| self.graph.op(Op::Neg, &[*c])).collect();
                Ok(Value::Matrix(*n, cells))
            }
            (UnaryOp::Neg, Value::Shape(_)) if env.point.is_some() => {
                let number = self.to_number(&value, inner.span, env)?;
                Ok(Value::number(self.graph.op(Op::Neg, &[number])))
            }
            (UnaryOp::Not, Value::Bool(c)) => Ok(Value::Bool(self.graph.op(Op::Not, &[*c]))),
            (UnaryOp::Not, Value::Shape(id)) => {
                let point = self.graph.point();
                // The complement of a complement is the shape.
                if let Some(shape) = self.complemented(*id, &point) {
                    return Ok(Value::Shape(shape));
                }
                let field = self.graph.field(*id, point);
                let value = self.graph.op(Op::Neg, &[field]);
                let dimensions = self.graph.dimensions(*id);
                Ok(Value::Shape(self.make_shape(dimensions, value, span)))
            }
            (UnaryOp::Not, Value::Nothing) => {
                let value = self.graph.constant(-FAR);
                Ok(Value::Shape(self.make_shape(3, value, span)))
            }
            (UnaryOp::Neg, Value::Shape(_)) => Err(self.error(
                Code::TypeMismatch,
                span,
                "`-` needs a number or a vector, and this is a shape",
                "what is left of `b` without `a` is `b - a`; the complement of a shape is written `!s`",
            )),
            (UnaryOp::Neg, other) => {
                let found = other.describe(&self.graph);
                Err(self.error(
                    Code::TypeMismatch,
                    span,
                    format!("`-` needs a number or a vector, and this is {found}"),
                    "write a number",
                ))
            }
            (UnaryOp::Not, other) => {
                let found = other.describe(&self.graph);
                Err(self.error(
                    Code::TypeMismatch,
                    span,
                    format!("`!` needs a condition or a shape, and this is {found}"),
                    "the negative of a number is written `-a`",
                ))
            }
        }
    }

    pub(super) fn chain(
        &mut self,
        first: &Expr,
        rest: &[(BinaryOp, Span, Expr)],
        env: &Env,
    ) -> Elaborated<Value> {
        let mut ok = true;
        let mut sum = self.expression(first, env);
        let mut span = first.span;
        // A long union is one balanced tree, so that its depth stays small.
        let mut pending: Vec<ShapeId> = Vec::new();
        for (op, op_span, right) in rest {
            let value = self.expression(right, env);
            let whole = span.to(right.span);
            ok &= value.is_ok();
            let (Ok(left), Ok(right_value)) = (&sum, &value) else {
                if sum.is_ok() && value.is_err() {
                    // Go on with what is known, to find the errors behind it.
                    span = whole;
                    continue;
                }
                sum = value;
                span = right.span;
                ok = false;
                continue;
            };
            if *op == BinaryOp::Union
                && let (Value::Shape(a), Value::Shape(b)) = (left, right_value)
                && self.graph.dimensions(*a) == self.graph.dimensions(*b)
            {
                if pending.is_empty() {
                    pending.push(*a);
                }
                pending.push(*b);
                span = whole;
                continue;
            }
            let left = if pending.is_empty() {
                left.clone()
            } else {
                Value::Shape(self.union(&std::mem::take(&mut pending), span))
            };
            sum = self.binary(*op, &left, right_value, (span, *op_span, right.span), env);
            ok &= sum.is_ok();
            span = whole;
        }
        if !pending.is_empty() {
            sum = Ok(Value::Shape(self.union(&pending, span)));
        }
        if ok { sum } else { Err(Stop) }
    }

    /// The union of shapes of one number of dimensions.
    pub fn union(&mut self, shapes: &[ShapeId], span: Span) -> ShapeId {
        let dimensions = shapes.first().map_or(3, |s| self.graph.dimensions(*s));
        let point = self.graph.point();
        let fields: Vec<NodeId> = shapes.iter().map(|s| self.graph.field(*s, point)).collect();
        let value = self.graph.balanced(Op::Min, &fields, FAR);
        self.make_shape(dimensions, value, span)
    }

    pub(super) fn binary(
        &mut self,
        op: BinaryOp,
        a: &Value,
        b: &Value,
        spans: (Span, Span, Span),
        env: &Env,
    ) -> Elaborated<Value> {
        let span = spans.0.to(spans.2);
        let (mut a, mut b) = (a.clone(), b.clone());
        let is_shape = |v: &Value| matches!(v, Value::Shape(_) | Value::Nothing);
        // In a formula a shape that meets a number is its field.
        let both_shapes = is_shape(&a) && is_shape(&b);
        if matches!(op, BinaryOp::Union | BinaryOp::Intersect)
            || op == BinaryOp::Sub && both_shapes
        {
            if both_shapes {
                return self.combine(op, &a, &b, spans);
            }
            if op != BinaryOp::Sub {
                let found = if is_shape(&a) { b.describe(&self.graph) } else { a.describe(&self.graph) };
                let at = if is_shape(&a) { spans.2 } else { spans.0 };
                let help = match (&a, &b) {
                    (Value::Bool(_), _) | (_, Value::Bool(_)) => {
                        "conditions are joined by `&&` and `||`"
                    }
                    (Value::Number(node, _), Value::Shape(_)) | (Value::Shape(_), Value::Number(node, _)) => self.instead_of_number(*node),
                    _ => "`|` and `&` join shapes; numbers have `min(a, b)` and `max(a, b)`",
                };
                return Err(self.error(
                    Code::TypeMismatch,
                    at,
                    format!("a shape is needed here, and this is {found}"),
                    help,
                ));
            }
        }
        if env.point.is_some() {
            if is_shape(&a) {
                a = Value::number(self.to_number(&a, spans.0, env)?);
            }
            if is_shape(&b) {
                b = Value::number(self.to_number(&b, spans.2, env)?);
            }
        }
        let arithmetic =
            matches!(op, BinaryOp::Add | BinaryOp::Sub | BinaryOp::Mul | BinaryOp::Div | BinaryOp::Rem);
        if let (Value::Vector(x), Value::Vector(y)) = (&a, &b)
            && arithmetic
            && (x.len() == 2 && self.is_axis_of_a_drawing(&b, &Type::Vec(2), spans.2) || y.len() == 2 && self.is_axis_of_a_drawing(&a, &Type::Vec(2), spans.0))
        {
            (a, b) = (Value::Vector(self.to_vector(&a, 2, spans.0)?), Value::Vector(self.to_vector(&b, 2, spans.2)?));
        }
        if arithmetic && !computes(op, &a, &b) {
            let (left, right) = (a.describe(&self.graph), b.describe(&self.graph));
            let error = Diagnostic::new(
                Code::TypeMismatch,
                spans.1,
                format!("{left} and {right} do not go together here"),
                together(&a, &b),
            );
            return Err(self.report(error.label(spans.0, left).label(spans.2, right)));
        }
        let divides = |e: &Self, n: &NodeId| e.graph.as_constant(*n) == Some(0.0);
        let by_zero = match &b {
            Value::Number(divisor, _) => divides(self, divisor),
            Value::Vector(v) => v.iter().any(|n| divides(self, n)),
            _ => false,
        };
        if by_zero && matches!(op, BinaryOp::Div | BinaryOp::Rem) {
            return Err(self.error(
                Code::BadValue,
                spans.2,
                "this divides by zero",
                "write a divisor that is not zero",
            ));
        }
        match op {
            BinaryOp::Add | BinaryOp::Sub => {
                let kernel = if op == BinaryOp::Add { Op::Add } else { Op::Sub };
                if let (Value::Matrix(n, x), Value::Matrix(m, y)) = (&a, &b)
                    && n == m
                {
                    let cells =
                        x.iter().zip(y.iter()).map(|(x, y)| self.graph.op(kernel, &[*x, *y]));
                    return Ok(Value::Matrix(*n, cells.collect()));
                }
                self.componentwise(&a, &b, span, |e, x, y| e.graph.op(kernel, &[x, y]))
            }
            BinaryOp::Mul => self.multiply(&a, &b, span),
            BinaryOp::Div => {
                if let (Value::Matrix(n, m), Value::Number(divisor, _)) = (&a, &b) {
                    let cells = m.iter().map(|c| self.graph.op(Op::Div, &[*c, *divisor]));
                    return Ok(Value::Matrix(*n, cells.collect()));
                }
                let value =
                    self.componentwise(&a, &b, span, |e, x, y| e.graph.op(Op::Div, &[x, y]))?;
                // `/` never rounds.
                Ok(match value {
                    Value::Number(node, _) => Value::Number(
                        node,
                        self.graph.as_constant(node).is_some_and(|c| c.fract() == 0.0),
                    ),
                    other => other,
                })
            }
            BinaryOp::Rem => self.componentwise(&a, &b, span, |e, x, y| {
                let quotient = e.graph.op(Op::Div, &[x, y]);
                let whole = e.graph.op(Op::Floor, &[quotient]);
                let product = e.graph.op(Op::Mul, &[y, whole]);
                e.graph.op(Op::Sub, &[x, product])
            }),
            BinaryOp::Lt | BinaryOp::Le | BinaryOp::Gt | BinaryOp::Ge | BinaryOp::Eq | BinaryOp::Ne => {
                self.compare(op, &a, &b, spans, env)
            }
            BinaryOp::And | BinaryOp::Or => match (&a, &b) {
                (Value::Bool(x), Value::Bool(y)) => {
                    let kernel = if op == BinaryOp::And { Op::And } else { Op::Or };
                    Ok(Value::Bool(self.graph.op(kernel, &[*x, *y])))
                }
                (Value::Bool(_), other) | (other, _) => {
                    let found = other.describe(&self.graph);
                    let at = if matches!(a, Value::Bool(_)) { spans.2 } else { spans.0 };
                    let instead = match (other, op) {
                        (Value::Shape(_), BinaryOp::And) => "what two shapes share is `a & b`, with one sign",
                        (Value::Shape(_), _) => "two shapes are joined by `a | b`, with one bar",
                        _ => "compare it with something, for example `a > 0`",
                    };
                    Err(self.error(
                        Code::TypeMismatch,
                        at,
                        format!("a condition is needed here, and this is {found}"),
                        instead,
                    ))
                }
            },
            BinaryOp::Union | BinaryOp::Intersect => Err(Stop),
        }
    }

    /// Union, intersection and difference of shapes.
    fn combine(
        &mut self,
        op: BinaryOp,
        a: &Value,
        b: &Value,
        spans: (Span, Span, Span),
    ) -> Elaborated<Value> {
        let span = spans.0.to(spans.2);
        let dimensions = match (a, b) {
            (Value::Shape(id), _) | (_, Value::Shape(id)) => self.graph.dimensions(*id),
            _ => return Ok(Value::Nothing),
        };
        if let (Value::Shape(x), Value::Shape(y)) = (a, b)
            && self.graph.dimensions(*x) != self.graph.dimensions(*y)
        {
            let is_plane = [spans.0, spans.2].into_iter().any(|at| self.sources.text(at).starts_with("plane("));
            let help = match is_plane {
                true => "of a drawing a `plane` has a normal of two numbers: `plane((1, 0))`; or make a solid of the drawing with `.extrude(height)`",
                false => "make a solid of the drawing with `.extrude(height)` or `.revolve()`",
            };
            let error = Diagnostic::new(Code::TypeMismatch, spans.1, "a drawing and a solid do not go together", help);
            return Err(self.report(error.label(spans.0, a.describe(&self.graph)).label(spans.2, b.describe(&self.graph))));
        }
        let a = self.to_shape(a, dimensions, span)?;
        let b = self.to_shape(b, dimensions, span)?;
        let point = self.graph.point();
        let (x, y) = (self.graph.field(a, point), self.graph.field(b, point));
        let value = match op {
            BinaryOp::Union => self.graph.op(Op::Min, &[x, y]),
            BinaryOp::Intersect => self.graph.op(Op::Max, &[x, y]),
            _ => {
                let cut = self.graph.op(Op::Neg, &[y]);
                self.graph.op(Op::Max, &[x, cut])
            }
        };
        Ok(Value::Shape(self.make_shape(dimensions, value, span)))
    }

    fn multiply(&mut self, a: &Value, b: &Value, span: Span) -> Elaborated<Value> {
        let cell = |m: &[NodeId], n: u8, row: usize, column: usize| {
            m.get(column * usize::from(n) + row).copied()
        };
        match (a, b) {
            (Value::Matrix(n, m), Value::Number(s, _)) | (Value::Number(s, _), Value::Matrix(n, m)) => {
                let cells = m.iter().map(|c| self.graph.op(Op::Mul, &[*c, *s])).collect();
                Ok(Value::Matrix(*n, cells))
            }
            (Value::Matrix(n, m), Value::Vector(v)) if v.len() == usize::from(*n) => {
                let rows = (0..v.len()).map(|row| {
                    let terms: Vec<NodeId> = v
                        .iter()
                        .enumerate()
                        .filter_map(|(column, x)| cell(m, *n, row, column).map(|c| (c, *x)))
                        .map(|(c, x)| self.graph.op(Op::Mul, &[c, x]))
                        .collect();
                    self.sum(&terms)
                });
                Ok(Value::Vector(rows.collect()))
            }
            (Value::Vector(v), Value::Matrix(n, m)) if v.len() == usize::from(*n) => {
                let columns = (0..v.len()).map(|column| {
                    let terms: Vec<NodeId> = v
                        .iter()
                        .enumerate()
                        .filter_map(|(row, x)| cell(m, *n, row, column).map(|c| (c, *x)))
                        .map(|(c, x)| self.graph.op(Op::Mul, &[c, x]))
                        .collect();
                    self.sum(&terms)
                });
                Ok(Value::Vector(columns.collect()))
            }
            (Value::Matrix(n, x), Value::Matrix(m, y)) if n == m => {
                let size = usize::from(*n);
                let mut cells = Vec::new();
                for column in 0..size {
                    for row in 0..size {
                        let terms: Vec<NodeId> = (0..size)
                            .filter_map(|k| Some((cell(x, *n, row, k)?, cell(y, *n, k, column)?)))
                            .map(|(a, b)| self.graph.op(Op::Mul, &[a, b]))
                            .collect();
                        cells.push(self.sum(&terms));
                    }
                }
                Ok(Value::Matrix(*n, cells.into()))
            }
            _ => self.componentwise(a, b, span, |e, x, y| e.graph.op(Op::Mul, &[x, y])),
        }
    }

    /// The sum of nodes.
    pub fn sum(&mut self, terms: &[NodeId]) -> NodeId {
        let mut total = self.graph.constant(0.0);
        for &term in terms {
            total = self.graph.op(Op::Add, &[total, term]);
        }
        total
    }

    fn compare(
        &mut self,
        op: BinaryOp,
        a: &Value,
        b: &Value,
        spans: (Span, Span, Span),
        env: &Env,
    ) -> Elaborated<Value> {
        let (x, y) = match (a, b) {
            (Value::Bool(x), Value::Bool(y)) if matches!(op, BinaryOp::Eq | BinaryOp::Ne) => (*x, *y),
            (Value::Vector(x), Value::Vector(y))
                if x.len() == y.len() && matches!(op, BinaryOp::Eq | BinaryOp::Ne) =>
            {
                let mut all = self.graph.constant(1.0);
                for (x, y) in x.iter().zip(y.iter()) {
                    let same = self.graph.op(Op::Eq, &[*x, *y]);
                    all = self.graph.op(Op::And, &[all, same]);
                }
                let node = if op == BinaryOp::Eq { all } else { self.graph.op(Op::Not, &[all]) };
                return Ok(Value::Bool(node));
            }
            (Value::Bool(_), _) | (_, Value::Bool(_)) => {
                return Err(self.error(
                    Code::TypeMismatch,
                    spans.1,
                    "a condition can be compared with another for equality only, and not with a number",
                    "join conditions with `&&` and `||`",
                ));
            }
            _ => {
                (self.to_number(a, spans.0, env)?, self.to_number(b, spans.2, env)?)
            }
        };
        // Conditions compare as numbers 0 and 1.
        let (x, y) = match (a, b) {
            (Value::Bool(_), Value::Bool(_)) => {
                let (zero, one) = (self.graph.constant(0.0), self.graph.constant(1.0));
                (
                    self.graph.op(Op::Select, &[x, one, zero]),
                    self.graph.op(Op::Select, &[y, one, zero]),
                )
            }
            _ => (x, y),
        };
        let node = match op {
            BinaryOp::Lt => self.graph.op(Op::Lt, &[x, y]),
            BinaryOp::Le => self.graph.op(Op::Le, &[x, y]),
            BinaryOp::Gt => self.graph.op(Op::Lt, &[y, x]),
            BinaryOp::Ge => self.graph.op(Op::Le, &[y, x]),
            BinaryOp::Eq => self.graph.op(Op::Eq, &[x, y]),
            _ => {
                let same = self.graph.op(Op::Eq, &[x, y]);
                self.graph.op(Op::Not, &[same])
            }
        };
        self.locate(node, spans.0.to(spans.2));
        Ok(Value::Bool(node))
    }
}

/// Whether an operator of arithmetic takes two values.
fn computes(op: BinaryOp, a: &Value, b: &Value) -> bool {
    match (a, b) {
        (Value::Number(..), Value::Number(..) | Value::Vector(_))
        | (Value::Vector(_), Value::Number(..)) => true,
        (Value::Vector(x), Value::Vector(y)) => x.len() == y.len(),
        (Value::Matrix(n, _), Value::Matrix(m, _)) => {
            n == m && matches!(op, BinaryOp::Add | BinaryOp::Sub | BinaryOp::Mul)
        }
        (Value::Matrix(n, _), Value::Vector(v)) | (Value::Vector(v), Value::Matrix(n, _)) => {
            op == BinaryOp::Mul && v.len() == usize::from(*n)
        }
        (Value::Matrix(..), Value::Number(..)) => matches!(op, BinaryOp::Mul | BinaryOp::Div),
        (Value::Number(..), Value::Matrix(..)) => op == BinaryOp::Mul,
        _ => false,
    }
}
