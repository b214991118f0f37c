//! How one kind of value becomes another.

use crate::diagnostic::Code;
use crate::graph::kernel::Op;
use crate::graph::{Function, Node, NodeId, NodeList, ShapeId};
use crate::program::value::{Value, points, together, type_words, vector_words};
use crate::program::{Elaborated, Elaborator, Env};
use crate::source::Span;
use crate::syntax::ast::Type;

impl Elaborator<'_> {
    /// A constant number.
    pub fn constant(&mut self, value: f64) -> Value {
        Value::Number(self.graph.constant(value), value.fract() == 0.0)
    }

    /// Whether a value can stand where the type is wanted.
    pub fn fits(&self, value: &Value, ty: &Type) -> bool {
        match (value, ty) {
            (Value::Number(..), Type::Float | Type::Int | Type::Field) => true,
            (Value::Number(..), Type::Vec(_) | Type::Color) => true,
            (Value::Bool(_), Type::Bool) => true,
            (Value::Vector(v), Type::Vec(n)) => v.len() == usize::from(*n),
            (Value::Vector(v), Type::Color) => v.len() == 3,
            (Value::Matrix(n, _), Type::Mat(m)) => n == m,
            (Value::Text(_), Type::Str) => true,
            (Value::List(_), Type::List(_)) => true,
            (Value::Shape(id), Type::Shape) => self.graph.dimensions(*id) == 3,
            (Value::Shape(id), Type::Shape2) => self.graph.dimensions(*id) == 2,
            (Value::Shape(_), Type::Field | Type::Float) => true,
            (Value::Nothing, Type::Shape | Type::Shape2) => true,
            (Value::Material(_), Type::Material) => true,
            (Value::Curve(_), Type::Curve) => true,
            _ => false,
        }
    }

    /// The value as one of the type, or an error at `span`. `env` gives the `p` at which a shape becomes a number.
    pub fn coerce(
        &mut self,
        value: Value,
        ty: &Type,
        span: Span,
        env: &Env,
    ) -> Elaborated<Value> {
        match (&value, ty) {
            (Value::Number(node, whole), Type::Int) => {
                if *whole {
                    return Ok(value);
                }
                match self.graph.as_constant(*node) {
                    Some(c) if c.fract() != 0.0 => Err(self.error(
                        Code::TypeMismatch,
                        span,
                        format!("a whole number is needed here, and this is {c}"),
                        format!("write {}", c.round()),
                    )),
                    // A slider that is not said to be whole stands between whole numbers too.
                    None if !self.graph.reads_point(*node) => Ok(Value::Number(self.graph.op(Op::Round, &[*node]), true)),
                    _ => Ok(Value::Number(*node, true)),
                }
            }
            (Value::Number(..), Type::Float | Type::Field) => Ok(value),
            (Value::Number(node, _), Type::Vec(n)) => {
                Ok(Value::Vector(NodeList::of(*node, usize::from(*n))))
            }
            (Value::Number(node, _), Type::Color) => Ok(Value::Vector(NodeList::of(*node, 3))),
            (Value::Shape(_) | Value::Nothing, Type::Field | Type::Float) => {
                self.to_number(&value, span, env).map(Value::number)
            }
            _ if self.is_axis_of_a_drawing(&value, ty, span) => self.to_vector(&value, 2, span).map(Value::Vector),
            (Value::Nothing, Type::Shape) => self.to_shape(&value, 3, span).map(Value::Shape),
            (Value::Nothing, Type::Shape2) => self.to_shape(&value, 2, span).map(Value::Shape),
            // One number would be a point on the diagonal, which nobody means who writes a list of coordinates.
            (Value::List(items), Type::List(inner)) if let (Type::Vec(n), true) = (&**inner, items.iter().any(|v| matches!(v, Value::Number(..)))) => {
                Err(self.error(
                    Code::TypeMismatch,
                    span,
                    "a list of points is needed here, and there is a single number in this one",
                    format!("put each point's {n} numbers in parentheses: `{}`", points(*n)),
                ))
            }
            (Value::List(items), Type::List(inner)) => {
                let items: Vec<Value> = items
                    .iter()
                    .map(|v| self.coerce(v.clone(), inner, span, env))
                    .collect::<Elaborated<_>>()?;
                Ok(Value::List(items.into()))
            }
            _ if self.fits(&value, ty) => Ok(value),
            _ => {
                let found = value.describe(&self.graph);
                let help = match (&value, ty) {
                    (Value::Vector(_), Type::Float | Type::Int | Type::Field) => self.instead_of_vector(span).to_owned(),
                    (Value::List(_) | Value::Vector(_), Type::Vec(n)) => format!("write `{}`", vector_words(usize::from(*n))),
                    (Value::List(_), Type::Color) => "write `(red, green, blue)`, or `#d4af37`".to_owned(),
                    (Value::Number(node, _), Type::Shape) => {
                        self.instead_of_number(*node).to_owned()
                    }
                    (Value::Shape(id), Type::Shape) if self.graph.dimensions(*id) == 2 => {
                        "make a solid of the drawing with `.extrude(height)` or `.revolve()`".to_owned()
                    }
                    (Value::Shape(_), Type::Shape2) => "a drawing is flat, as `circle(1)`; a solid is made longer with `.elongate((0, 1, 0))` or `.stretch(1, 2, 1)`".to_owned(),
                    (Value::Bool(_), Type::Float | Type::Int) => {
                        "write a number, or `if condition { 1 } else { 0 }`".to_owned()
                    }
                    (Value::Shape(_), Type::Vec(_)) => "write a vector, as `(1, 0, 0)`; a shape that is moved stands before the dot, `shape.translate(v)`".to_owned(),
                    (Value::List(_), Type::Curve) => "make a curve of the points: `polyline([…])`, or `catmull_rom([…])`".to_owned(),
                    _ => format!("write {}", type_words(ty)),
                };
                Err(self.error(
                    Code::TypeMismatch,
                    span,
                    format!("{} is needed here, and this is {found}", type_words(ty)),
                    help,
                ))
            }
        }
    }

    /// A number: itself, or the field of a shape at the `p` of `env`.
    pub fn to_number(&mut self, value: &Value, span: Span, env: &Env) -> Elaborated<NodeId> {
        match value {
            Value::Number(node, _) => Ok(*node),
            Value::Nothing => Ok(self.graph.constant(crate::graph::FAR)),
            Value::Shape(id) => {
                let Some(point) = env.point.clone() else {
                    return Err(self.error(
                        Code::TypeMismatch,
                        span,
                        "a number is needed here, and this is a shape",
                        "a shape is a number only inside a formula, where there is a `p`",
                    ));
                };
                let point = self.fit_point(&point, *id, span)?;
                Ok(self.graph.field(*id, point))
            }
            other => {
                let found = other.describe(&self.graph);
                let help = match other {
                    Value::Vector(_) => self.instead_of_vector(span),
                    Value::Bool(_) => "write `if condition { 1 } else { 0 }`",
                    Value::Text(_) => "write a number; choices are values or names without quotes, `param style = hex in [hex, square]` with `shape hex = …`",
                    _ => "write a number",
                };
                Err(self.error(
                    Code::TypeMismatch,
                    span,
                    format!("a number is needed here, and this is {found}"),
                    help,
                ))
            }
        }
    }

    /// A point as a call of the shape wants it: three coordinates, the last zero for a drawing.
    pub fn fit_point(
        &mut self,
        point: &[NodeId],
        shape: ShapeId,
        span: Span,
    ) -> Elaborated<[NodeId; 3]> {
        let zero = self.graph.constant(0.0);
        match (self.graph.dimensions(shape), point) {
            (3, [x, y, z]) => Ok([*x, *y, *z]),
            (2, [x, y]) => Ok([*x, *y, zero]),
            (n, _) => Err(self.error(
                Code::TypeMismatch,
                span,
                format!("this shape has {n} dimensions, and the point has {}", point.len()),
                if n == 2 {
                    "ask for it at a point of the plane, for example `s.at(p.xy)`, or make a solid of it with `.extrude(height)` or `.revolve()`"
                } else {
                    "ask for it at a point of space, for example `s.at((q.x, 0, q.y))`"
                },
            )),
        }
    }

    /// What to write where a number is needed and a vector stands.
    fn instead_of_vector(&self, span: Span) -> &'static str {
        match self.names_an_axis(span) {
            true => "`x`, `y` and `z` are unit vectors, for what has an axis; the coordinates of a point are `p.x`, `p.y` and `p.z`",
            false => "take one component with `.x`, or its `length(…)`",
        }
    }

    /// Whether `x`, `y` or `z` stands in a place.
    pub(super) fn names_an_axis(&self, span: Span) -> bool {
        self.axes.iter().any(|axis| axis.file == span.file && span.start <= axis.start && axis.end <= span.end)
    }

    /// Whether a direction made of `x`, `y` and `z` stands where a drawing wants one: there it is of two components.
    pub(super) fn is_axis_of_a_drawing(&self, value: &Value, ty: &Type, span: Span) -> bool {
        matches!((value, ty), (Value::Vector(v), Type::Vec(2)) if v.len() == 3) && self.names_an_axis(span)
    }

    /// What to write where a shape is needed and a number stands.
    pub(super) fn instead_of_number(&self, node: NodeId) -> &'static str {
        match self.graph.node(node) {
            Node::Constant(_) => "write a shape, as `sphere(1)` or `box(1)`; `cubed` is the third power of a number",
            Node::Call(_, Function::Field, _) => "`.at(point)` is the number that the shape's formula gives there; a shape is moved by `.translate(1, 2, 3)`",
            _ => "declare the formula with `field name = …`, and write its name here",
        }
    }

    /// A shape of so many dimensions.
    pub fn to_shape(&mut self, value: &Value, dimensions: u8, span: Span) -> Elaborated<ShapeId> {
        match value {
            Value::Shape(id) if self.graph.dimensions(*id) == dimensions => Ok(*id),
            Value::Nothing => {
                let far = self.graph.constant(crate::graph::FAR);
                Ok(self.make_shape(dimensions, far, span))
            }
            other => {
                let found = other.describe(&self.graph);
                let help = match other {
                    Value::Shape(_) if dimensions == 3 => {
                        "make a solid of the drawing with `.extrude(height)` or `.revolve()`"
                    }
                    Value::Shape(_) => "only drawings can stand here",
                    Value::Number(node, _) => {
                        self.instead_of_number(*node)
                    }
                    Value::List(_) => "shapes are joined with `a | b`; of a list all are drawn with `for s in [a, b] { s }`",
                    _ => "write a shape, for example `sphere(1)`",
                };
                let wanted = if dimensions == 3 { "a shape" } else { "a drawing (shape2)" };
                Err(self.error(
                    Code::TypeMismatch,
                    span,
                    format!("{wanted} is needed here, and this is {found}"),
                    help,
                ))
            }
        }
    }

    /// A constant number, or an error that says that it must be known while compiling.
    pub fn to_constant(&mut self, value: &Value, span: Span) -> Elaborated<f64> {
        match value {
            Value::Number(node, _) => match self.graph.as_constant(*node) {
                Some(c) => Ok(c),
                None => Err(self.error(
                    Code::NotConstant,
                    span,
                    "this must be known while compiling, and it depends on something live",
                    "write a number, or a `let` of numbers",
                )),
            },
            other => {
                let found = other.describe(&self.graph);
                Err(self.error(
                    Code::TypeMismatch,
                    span,
                    format!("a number is needed here, and this is {found}"),
                    "write a number",
                ))
            }
        }
    }

    /// The components of a number or vector as a vector of length `n`.
    pub fn to_vector(&mut self, value: &Value, n: usize, span: Span) -> Elaborated<NodeList> {
        match value {
            Value::Number(node, _) => Ok(NodeList::of(*node, n)),
            Value::Vector(v) if v.len() == n => Ok(v.clone()),
            Value::Vector(v) if n == 2 && let &[x, y, z] = &**v && self.names_an_axis(span) => match self.graph.as_constant(z) {
                Some(0.0) => Ok([x, y].into()),
                _ => Err(self.error(Code::TypeMismatch, span, "a drawing has no z", "its axes are `x` and `y`; make a solid of it first, with `.extrude(height)`")),
            },
            other => {
                let found = other.describe(&self.graph);
                Err(self.error(
                    Code::TypeMismatch,
                    span,
                    format!("a vec{n} is needed here, and this is {found}"),
                    format!("write `{}`", vector_words(n)),
                ))
            }
        }
    }

    /// Applies an operation of two numbers to numbers or vectors, component by component.
    pub fn componentwise(
        &mut self,
        a: &Value,
        b: &Value,
        span: Span,
        mut f: impl FnMut(&mut Self, NodeId, NodeId) -> NodeId,
    ) -> Elaborated<Value> {
        match (a, b) {
            (Value::Number(x, wx), Value::Number(y, wy)) => {
                let node = f(self, *x, *y);
                self.locate(node, span);
                Ok(Value::Number(node, *wx && *wy))
            }
            (Value::Vector(x), Value::Number(y, _)) => {
                Ok(Value::Vector(x.iter().map(|x| f(self, *x, *y)).collect()))
            }
            (Value::Number(x, _), Value::Vector(y)) => {
                Ok(Value::Vector(y.iter().map(|y| f(self, *x, *y)).collect()))
            }
            (Value::Vector(x), Value::Vector(y)) if x.len() == y.len() => {
                Ok(Value::Vector(x.iter().zip(y.iter()).map(|(x, y)| f(self, *x, *y)).collect()))
            }
            (Value::Vector(x), Value::Vector(y)) if matches!((x.len(), y.len()), (2, 3) | (3, 2)) && self.names_an_axis(span) => {
                let (x, y) = (self.to_vector(a, 2, span)?, self.to_vector(b, 2, span)?);
                self.componentwise(&Value::Vector(x), &Value::Vector(y), span, f)
            }
            _ => {
                let (left, right) = (a.describe(&self.graph), b.describe(&self.graph));
                let help = together(a, b);
                Err(self.error(
                    Code::TypeMismatch,
                    span,
                    format!("{left} and {right} do not go together here"),
                    help,
                ))
            }
        }
    }

    /// Applies an operation of one number to a number or each component of a vector.
    pub fn each(
        &mut self,
        a: &Value,
        span: Span,
        op: Op,
    ) -> Elaborated<Value> {
        match a {
            Value::Number(x, whole) => {
                let whole = *whole && matches!(op, Op::Neg | Op::Abs | Op::Sign)
                    || matches!(op, Op::Floor | Op::Ceil | Op::Round | Op::Trunc);
                let node = self.graph.op(op, &[*x]);
                self.locate(node, span);
                Ok(Value::Number(node, whole))
            }
            Value::Vector(v) => {
                Ok(Value::Vector(v.iter().map(|x| self.graph.op(op, &[*x])).collect()))
            }
            other => {
                let found = other.describe(&self.graph);
                Err(self.error(
                    Code::TypeMismatch,
                    span,
                    format!("a number or a vector is needed here, and this is {found}"),
                    "write a number",
                ))
            }
        }
    }
}
