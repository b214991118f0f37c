//! The tree that the parser makes. Every node has its place; what could not be read is a hole.

use crate::source::Span;
use crate::unit::Unit;
use std::sync::Arc;

/// A name with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Name {
    /// The text.
    pub text: Arc<str>,
    /// Where it stands.
    pub span: Span,
}

/// An expression with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Expr {
    /// What it is.
    pub kind: ExprKind,
    /// Where it stands.
    pub span: Span,
}

/// The kinds of expressions.
#[derive(Clone, Debug, PartialEq)]
pub enum ExprKind {
    /// A place where an expression was expected and none could be read; a diagnostic says so.
    Hole,
    /// `true`, `false`.
    Bool(bool),
    /// `6`: a number without a point or exponent.
    Int(i64),
    /// `0.5`, `1e-3`.
    Float(f64),
    /// `45deg`, `0.5turn`, `0.1rad`: the number as written, and its unit.
    Angle(f64, AngleUnit),
    /// `10mm`, `2.5in`: the number as written, and its unit.
    Length(f64, Unit),
    /// `#rrggbb` or `#rgb`, as sRGB bytes.
    Color([u8; 3]),
    /// `"text"`, escapes resolved.
    Str(String),
    /// `name` or `sky.dusk` where `sky` is the name of an import (the parser reads the latter as [`ExprKind::Dot`]).
    Name(String),
    /// `(a, b)`, `(a, b, c)`, `(a, b, c, d)`: a vector.
    Vector(Vec<Expr>),
    /// `(a)`.
    Paren(Box<Expr>),
    /// `[a, b]`.
    List(Vec<Expr>),
    /// `-a`, `!a`.
    Unary(UnaryOp, Box<Expr>),
    /// A chain of operators of one level, from the left: `a + b - c` is `first a, rest [(+, b), (-, c)]`.
    /// So a union of ten thousand is one node and not ten thousand deep.
    Chain(Box<Expr>, Vec<(BinaryOp, Span, Expr)>),
    /// `callee(arguments)`; the callee is a name or a dot on the name of an import.
    Call(Box<Expr>, Vec<Argument>),
    /// `receiver.name` (`arguments` is none) or `receiver.name(arguments)`.
    Dot(Box<Expr>, Name, Option<Vec<Argument>>),
    /// `a[i]`.
    Index(Box<Expr>, Box<Expr>),
    /// `for pattern in source by fold { body }`.
    For(Box<For>),
    /// `if condition { a } else { b }`; `else if` is an `If` in `otherwise`.
    If(Box<Expr>, Box<Expr>, Option<Box<Expr>>),
    /// `{ let a = 1; value }`.
    Block(Vec<Let>, Box<Expr>),
    /// `a..b`.
    Range(Box<Expr>, Box<Expr>),
}

/// Units of angles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AngleUnit {
    /// Degrees.
    Deg,
    /// Whole turns.
    Turn,
    /// Radians.
    Rad,
}

impl AngleUnit {
    /// As it is written.
    pub fn name(self) -> &'static str {
        match self {
            AngleUnit::Deg => "deg",
            AngleUnit::Turn => "turn",
            AngleUnit::Rad => "rad",
        }
    }

    /// So many of it, in radians.
    pub fn radians(self, value: f64) -> f64 {
        match self {
            AngleUnit::Deg => value.to_radians(),
            AngleUnit::Turn => value * std::f64::consts::TAU,
            AngleUnit::Rad => value,
        }
    }
}

/// Operators before their operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnaryOp {
    /// `-`: the negative of a number.
    Neg,
    /// `!`: the complement of a shape, the opposite of a condition.
    Not,
}

/// Operators between operands, tightest first: `* / %`, `&`, `+ -`, `|`, comparisons, `&&`, `||`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BinaryOp {
    /// `*`
    Mul,
    /// `/`
    Div,
    /// `%`
    Rem,
    /// `&`
    Intersect,
    /// `+`
    Add,
    /// `-`
    Sub,
    /// `|`
    Union,
    /// `==`
    Eq,
    /// `!=`
    Ne,
    /// `<`
    Lt,
    /// `<=`
    Le,
    /// `>`
    Gt,
    /// `>=`
    Ge,
    /// `&&`
    And,
    /// `||`
    Or,
}

/// `value` or `name: value` in a call.
#[derive(Clone, Debug, PartialEq)]
pub struct Argument {
    /// The name before the colon.
    pub name: Option<Name>,
    /// The value.
    pub value: Expr,
}

/// `for index in source by fold { body }`.
#[derive(Clone, Debug, PartialEq)]
pub struct For {
    /// The name that the body sees.
    pub index: Name,
    /// A range, a list, `grid(…)` or `polar(…)`.
    pub source: Expr,
    /// How the bodies are joined.
    pub by: Option<Fold>,
    /// What is made many times.
    pub body: Expr,
}

/// What stands after `by`.
#[derive(Clone, Debug, PartialEq)]
pub struct Fold {
    /// Where it stands.
    pub span: Span,
    /// What it is.
    pub kind: FoldKind,
}

/// `by +`, `by *`, or `by smooth_union(0.03)` and `by min`.
#[derive(Clone, Debug, PartialEq)]
pub enum FoldKind {
    /// `+` or `*`.
    Operator(BinaryOp),
    /// A name (or a dot on an import's name) with the arguments that follow the two operands.
    Call(Expr, Vec<Argument>),
}

/// `let a = 1` or `let q = p, s = 1 for i in 0..n while c { let t = q; q = 2 * t, s = 2 * s }`.
#[derive(Clone, Debug, PartialEq)]
pub struct Let {
    /// Where it stands.
    pub span: Span,
    /// The names and their (first) values; exactly one where there is no loop.
    pub bindings: Vec<(Name, Expr)>,
    /// The loop that replaces them, all together, each turn.
    pub iterate: Option<Box<Iterate>>,
    /// `///` before it.
    pub doc: Option<String>,
}

/// The loop of an iterating `let`.
#[derive(Clone, Debug, PartialEq)]
pub struct Iterate {
    /// The turn's number.
    pub index: Name,
    /// The range of turns.
    pub source: Expr,
    /// Ends the loop before the first turn at which it is false.
    pub condition: Option<Expr>,
    /// Names for the body.
    pub lets: Vec<Let>,
    /// `name = value`, all computed from the old values.
    pub updates: Vec<(Name, Expr)>,
}

/// A type as written after a colon, or in a diagnostic.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Type {
    /// `bool`
    Bool,
    /// `int`
    Int,
    /// `float`
    Float,
    /// `vec2`, `vec3`, `vec4`
    Vec(u8),
    /// `mat2`, `mat3`, `mat4`
    Mat(u8),
    /// `color`
    Color,
    /// `shape`
    Shape,
    /// `shape2`
    Shape2,
    /// `material`
    Material,
    /// `curve`: a curve in space
    Curve,
    /// `field`: a formula in `p`
    Field,
    /// `[T]`
    List(Box<Type>),
    /// A string; it can't be written as a type, but a value can be one.
    Str,
}

impl Type {
    /// As it is written: `vec3`, `[float]`. A string is no type that can be written, and is called `text`.
    pub fn name(&self) -> String {
        match self {
            Type::Bool => "bool".to_owned(),
            Type::Int => "int".to_owned(),
            Type::Float => "float".to_owned(),
            Type::Vec(n) => format!("vec{n}"),
            Type::Mat(n) => format!("mat{n}"),
            Type::Color => "color".to_owned(),
            Type::Shape => "shape".to_owned(),
            Type::Shape2 => "shape2".to_owned(),
            Type::Material => "material".to_owned(),
            Type::Curve => "curve".to_owned(),
            Type::Field => "field".to_owned(),
            Type::List(inner) => format!("[{}]", inner.name()),
            Type::Str => "text".to_owned(),
        }
    }
}

/// A parameter of a declaration: `name`, `name: type`, `name: type = default`, `name = default`.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Its name.
    pub name: Name,
    /// Its type, where written. `a, b, k: field` gives the type to the last only.
    pub ty: Option<(Type, Span)>,
    /// Its value where the call gives none.
    pub default: Option<Expr>,
}

/// A file: its declarations in their order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct File {
    /// Declarations in the order of the text.
    pub items: Vec<Item>,
    /// A comment at the head of the file, `//!` lines joined.
    pub doc: Option<String>,
}

/// A declaration with its place and documentation.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// What it is.
    pub kind: ItemKind,
    /// From its first word to its last.
    pub span: Span,
    /// `///` lines before it, joined by newlines, without the marks.
    pub doc: Option<String>,
}

/// The kinds of declarations.
#[derive(Clone, Debug, PartialEq)]
pub enum ItemKind {
    /// `import "path" as name`
    Import {
        /// The path as written.
        path: String,
        /// Its place.
        path_span: Span,
        /// The name that it stands behind.
        alias: Option<Name>,
    },
    /// `param name: type = value in domain "description"`
    Param {
        /// Its name.
        name: Name,
        /// Its type, where written.
        ty: Option<(Type, Span)>,
        /// Its value at the start.
        value: Expr,
        /// A range or a list of choices.
        domain: Option<Expr>,
        /// What a person should know of it.
        description: Option<String>,
    },
    /// `let name = value` at the top of a file.
    Let(Let),
    /// `field`, `field2`, `warp`, `warp2`, `blend`, `fn`, `shape`, `shape2` with its formula or value.
    Function(Function),
    /// `material name(parameters) { let …; key: value }`
    Material {
        /// Its name.
        name: Name,
        /// Its parameters.
        parameters: Vec<Parameter>,
        /// Names for the entries.
        lets: Vec<Let>,
        /// `key: value`.
        entries: Vec<Entry>,
    },
    /// `scene = shape`
    Scene(Expr),
    /// `camera`, `light`, `environment`, `render`, `physics`, `balls`, `mesh` with their entries.
    Block {
        /// Which.
        kind: BlockKind,
        /// The word itself.
        kind_span: Span,
        /// Its name, where it has one.
        name: Option<Name>,
        /// `mesh name "file"`: the file.
        file: Option<(String, Span)>,
        /// `key: value`.
        entries: Vec<Entry>,
    },
}

impl Expr {
    /// What a choice is called in a list of choices. None where it is no name and no plain value.
    pub fn label(&self) -> Option<String> {
        Some(match &self.kind {
            ExprKind::Name(name) => name.clone(),
            ExprKind::Int(i) => i.to_string(),
            ExprKind::Float(f) => f.to_string(),
            ExprKind::Angle(value, unit) => format!("{value}{}", unit.name()),
            ExprKind::Length(value, unit) => format!("{value}{}", unit.name()),
            ExprKind::Color([r, g, b]) => format!("#{r:02x}{g:02x}{b:02x}"),
            ExprKind::Vector(parts) => format!("({})", parts.iter().map(Expr::label).collect::<Option<Vec<_>>>()?.join(", ")),
            ExprKind::Paren(inner) => inner.label()?,
            ExprKind::Str(s) => s.clone(),
            ExprKind::Bool(b) => b.to_string(),
            ExprKind::Unary(UnaryOp::Neg, inner) => format!("-{}", inner.label()?),
            ExprKind::Dot(inner, name, None) => format!("{}.{}", inner.label()?, name.text),
            _ => return None,
        })
    }
}

/// `key: value` in a block.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// The key.
    pub key: Name,
    /// The value.
    pub value: Expr,
}

/// Blocks of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum BlockKind {
    /// `camera`
    Camera,
    /// `light`
    Light,
    /// `environment`
    Environment,
    /// `render`
    Render,
    /// `physics`
    Physics,
    /// `balls`
    Balls,
    /// `mesh`
    Mesh,
}

/// What declares a function of the language.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum FunctionKind {
    /// A formula in `p: vec3` that makes a shape.
    Field,
    /// A formula in `p: vec2` that makes a drawing.
    Field2,
    /// Where a point falls in the shape's own space, `p: vec3`.
    Warp,
    /// The same in two dimensions.
    Warp2,
    /// A combination of distances.
    Blend,
    /// A formula over numbers, without `p`.
    Fn,
    /// A shape made of shapes.
    Shape,
    /// A drawing made of drawings.
    Shape2,
}

/// A declared function.
#[derive(Clone, Debug, PartialEq)]
pub struct Function {
    /// What declares it.
    pub kind: FunctionKind,
    /// Its name.
    pub name: Name,
    /// Its parameters.
    pub parameters: Vec<Parameter>,
    /// What is known of its constant (prelude only): `field sphere(radius) exact = …`, `blend smooth_union(a, b, k) lipschitz max(a, b) = …`.
    pub claim: Option<Claim>,
    /// The value.
    pub body: Expr,
}

/// What a formula of the prelude is known to be.
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// Where it stands.
    pub span: Span,
    /// What it says.
    pub kind: ClaimKind,
}

/// The kinds of claims.
#[derive(Clone, Debug, PartialEq)]
pub enum ClaimKind {
    /// The value is the signed distance itself.
    Exact,
    /// The formula gives the constant; in it a parameter's name stands for the constant of that argument. Then the range of all values, if it is
    /// known.
    Lipschitz(Expr, Option<Expr>),
}
