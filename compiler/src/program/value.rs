//! What an expression is while compiling, and how one kind of value becomes another.

use crate::figure::Line;
use crate::graph::{Graph, MaterialId, NodeId, NodeList, ShapeId};
use crate::source::Span;
use crate::syntax::ast::Type;
use std::rc::Rc;

/// A symbolic value.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Value {
    /// A number; whether it is known to be whole.
    Number(NodeId, bool),
    /// A condition.
    Bool(NodeId),
    /// Two to four numbers.
    Vector(NodeList),
    /// So many columns and rows, column by column.
    Matrix(u8, NodeList),
    /// A text.
    Text(Rc<str>),
    /// A list.
    List(Rc<[Value]>),
    /// A solid or a drawing.
    Shape(ShapeId),
    /// A material.
    Material(MaterialId),
    /// A curve in space.
    Curve(Rc<Line>),
    /// From and to.
    Range(Rc<(Value, Value)>),
    /// The empty shape, of either number of dimensions.
    Nothing,
}

impl Value {
    /// A number.
    pub fn number(node: NodeId) -> Self {
        Value::Number(node, false)
    }

    /// How many values it holds, those of lists within lists counted, up to `limit`.
    pub fn size(&self, limit: usize) -> usize {
        let Value::List(items) = self else { return 1 };
        let mut total = 1;
        for item in items.iter() {
            if total >= limit {
                break;
            }
            total += item.size(limit - total);
        }
        total.min(limit)
    }

    /// Whether it is a number where there is a `p`.
    pub fn is_field(&self) -> bool {
        matches!(self, Value::Number(..) | Value::Shape(_) | Value::Nothing)
    }

    /// Whether one can stand where the other does: in a list, or in another branch.
    pub fn is_like(&self, other: &Value, graph: &Graph) -> bool {
        match (self, other) {
            (Value::Vector(a), Value::Vector(b)) => a.len() == b.len(),
            (Value::Number(..), Value::Vector(_)) | (Value::Vector(_), Value::Number(..)) => true,
            (Value::Matrix(a, _), Value::Matrix(b, _)) => a == b,
            (Value::Shape(a), Value::Shape(b)) => graph.dimensions(*a) == graph.dimensions(*b),
            (Value::Nothing, Value::Shape(_)) | (Value::Shape(_), Value::Nothing) => true,
            _ => std::mem::discriminant(self) == std::mem::discriminant(other),
        }
    }

    /// Its kind in words.
    pub fn describe(&self, graph: &Graph) -> String {
        match self {
            Value::Number(_, true) => "a whole number".into(),
            Value::Number(..) => "a number".into(),
            Value::Bool(_) => "a condition".into(),
            Value::Vector(v) => format!("a vec{}", v.len()),
            Value::Matrix(n, _) => format!("a mat{n}"),
            Value::Text(_) => "a text".into(),
            Value::List(_) => "a list".into(),
            Value::Shape(id) => match graph.dimensions(*id) {
                2 => "a drawing (shape2)".into(),
                _ => "a shape".into(),
            },
            Value::Material(_) => "a material".into(),
            Value::Curve(_) => "a curve".into(),
            Value::Range(_) => "a range".into(),
            Value::Nothing => "the empty shape".into(),
        }
    }
}

/// A value that was given for a parameter.
#[derive(Clone)]
pub struct Bound {
    /// It.
    pub value: Value,
    /// Where it stands.
    pub span: Span,
    /// Where each component stands, for a vector whose components are written out.
    pub parts: Vec<Span>,
}

/// What to write where two values do not go together.
pub fn together(a: &Value, b: &Value) -> &'static str {
    match (a, b) {
        (Value::Vector(_), Value::Vector(_)) => {
            "both vectors must have the same number of components"
        }
        (Value::Shape(_), _) | (_, Value::Shape(_)) => {
            "shapes are combined with `|`, `&` and `-`, made larger with `.scale(2)`, thicker with `.round(r)`, moved with `.translate(v)`; a formula of two shapes is a `blend`: `blend name(a, b, k: float) = …`"
        }
        (Value::List(_), _) | (_, Value::List(_)) => "a vector is written in parentheses, `(1, 2, 3)`; of a list take one, `list[0]`, or go over it with `for`",
        _ => "this works on numbers and vectors",
    }
}

/// How a vector of `n` numbers is written.
pub(super) fn vector_words(n: usize) -> &'static str {
    ["", "", "(x, y)", "(x, y, z)", "(x, y, z, w)"].get(n).unwrap_or(&"")
}

/// How a list of points of `n` numbers is written.
pub(super) fn points(n: u8) -> String {
    let point = |one: u8| format!("({})", (1..=n).map(|i| if i == one { "1" } else { "0" }).collect::<Vec<_>>().join(", "));
    format!("[{}, {}, {}]", point(0), point(1), point(2))
}

/// A type in words.
pub fn type_words(ty: &Type) -> String {
    match ty {
        Type::Bool => "a condition (bool)".into(),
        Type::Int => "a whole number (int)".into(),
        Type::Float => "a number (float)".into(),
        Type::Vec(n) => format!("a vec{n}"),
        Type::Mat(n) => format!("a mat{n}"),
        Type::Color => "a colour".into(),
        Type::Shape => "a shape".into(),
        Type::Shape2 => "a drawing (shape2)".into(),
        Type::Material => "a material".into(),
        Type::Curve => "a curve".into(),
        Type::Field => "a number or a formula in `p`".into(),
        Type::List(inner) => format!("a list of which each is {}", type_words(inner)),
        Type::Str => "a text".into(),
    }
}
