//! The value of an expression.

use super::elsewhere::ours;
use super::load::{ItemRef, Resolution};
use super::value::{together, Value};
use super::{Elaborated, Elaborator, Env, Stop};
use crate::diagnostic::{Code, Diagnostic};
use crate::graph::kernel::Op;
use crate::graph::{Exactness, Leaf, Material, MaterialId, MaterialImage, NodeId, Shape, ShapeId, FAR, WORLD};
use crate::source::Span;
use crate::syntax::words::nearest;
use crate::syntax::ast::{
    AngleUnit, BinaryOp, Expr, ExprKind, Fold, FoldKind, For, FunctionKind, ItemKind, Iterate, Let,
    UnaryOp,
};
use std::rc::Rc;
use std::sync::Arc;

/// How a `for` joins its bodies.
pub enum Joined {
    /// Shapes or numbers, by the smaller.
    Union,
    /// As written after `by`.
    By(Fold),
    /// A list of them.
    List,
}

/// Most elements of a list.
const LIST_LIMIT: usize = 200_000;

/// Most turns of one loop.
const TURN_LIMIT: f64 = 100_000.0;

impl Elaborator<'_> {
    /// The value of an expression.
    pub fn expression(&mut self, expr: &Expr, env: &Env) -> Elaborated<Value> {
        self.step(expr.span)?;
        if self.nesting >= super::NESTING_LIMIT {
            self.endless = self.depth > 0;
            return Err(self.error(
                Code::TooDeep,
                expr.span,
                "this unfolds deeper than the compiler follows",
                "split it with `let` or with shapes of their own",
            ));
        }
        self.nesting += 1;
        let value = self.expression_inside(expr, env);
        self.nesting -= 1;
        value
    }

    fn expression_inside(&mut self, expr: &Expr, env: &Env) -> Elaborated<Value> {
        match &expr.kind {
            // The parser has said what is wrong.
            ExprKind::Hole => Err(Stop),
            ExprKind::Bool(b) => {
                let node = self.graph.constant(if *b { 1.0 } else { 0.0 });
                Ok(Value::Bool(node))
            }
            ExprKind::Int(i) => Ok(Value::Number(self.graph.constant(*i as f64), true)),
            ExprKind::Float(f) => Ok(Value::number(self.graph.constant(*f))),
            ExprKind::Angle(number, unit) => {
                let radians = match unit {
                    AngleUnit::Deg => number.to_radians(),
                    AngleUnit::Turn => number * std::f64::consts::TAU,
                    AngleUnit::Rad => *number,
                };
                Ok(Value::number(self.graph.constant(radians)))
            }
            ExprKind::Color(bytes) => {
                let linear = bytes.map(|b| self.graph.constant(srgb_to_linear(b)));
                Ok(Value::Vector(linear.into()))
            }
            ExprKind::Str(text) => Ok(Value::Text(text.as_str().into())),
            ExprKind::Name(name) => self.name(name, expr.span, env),
            ExprKind::Paren(inner) => self.expression(inner, env),
            ExprKind::Vector(items) => self.vector(items, expr.span, env),
            ExprKind::List(items) => self.list(items, env),
            ExprKind::Unary(op, inner) => self.unary(*op, inner, expr.span, env),
            ExprKind::Chain(first, rest) => self.chain(first, rest, env),
            ExprKind::Call(callee, args) => self.call_expression(callee, args, expr.span, env),
            ExprKind::Dot(receiver, name, args) => {
                self.dot(receiver, name, args.as_deref(), expr.span, env)
            }
            ExprKind::Index(list, index) => self.index(list, index, expr.span, env),
            ExprKind::For(each) => {
                let joined = match &each.by {
                    Some(fold) => Joined::By(fold.clone()),
                    None => Joined::Union,
                };
                self.unfold(expr.span, |e| e.for_each(each, joined, expr.span, env))
            }
            ExprKind::If(condition, then, otherwise) => {
                self.choice(condition, then, otherwise.as_deref(), expr.span, env)
            }
            ExprKind::Block(lets, value) => {
                let env = self.bind_lets(lets, env)?;
                self.expression(value, &env)
            }
            ExprKind::Range(from, to) => {
                let from = self.expression(from, env);
                let to = self.expression(to, env);
                Ok(Value::Range(Rc::new((from?, to?))))
            }
        }
    }

    /// A name alone.
    fn name(&mut self, name: &str, span: Span, env: &Env) -> Elaborated<Value> {
        if let Some(value) = env.local(name) {
            return Ok(value.clone());
        }
        let modules = self.modules;
        let meaning = modules.resolve(env.module, name);
        match &meaning {
            Resolution::Items(items) if !self.modules.is_prelude(items.first().map_or(0, |i| i.module)) => {
                return self.item_value(items, span, env);
            }
            Resolution::Ambiguous(paths) => return Err(self.ambiguous(name, paths, span)),
            _ => {}
        }
        if let Some(value) = self.built_in_name(name, span, env) {
            return value;
        }
        match meaning {
            Resolution::Items(items) => self.item_value(items, span, env),
            _ => Err(self.unknown_name(name, span, env)),
        }
    }

    /// `p`, `time`, `x` and their kin.
    fn built_in_name(&mut self, name: &str, span: Span, env: &Env) -> Option<Elaborated<Value>> {
        let axis = |e: &mut Self, i: usize| {
            let cells = (0..3).map(|k| e.graph.constant(if k == i { 1.0 } else { 0.0 }));
            Value::Vector(cells.collect())
        };
        Some(Ok(match name {
            "p" => match &env.point {
                Some(point) => Value::Vector(point.clone()),
                None => {
                    return Some(Err(self.error(
                        Code::NoPoint,
                        span,
                        "there is no point `p` here",
                        "`p` exists in `field`, `warp`, `blend` and `material`, and in arguments that are declared `field`; a `fn` takes what it needs as an argument",
                    )));
                }
            },
            "world" => {
                if env.point.is_none() {
                    return Some(Err(self.error(
                        Code::NoPoint,
                        span,
                        "there is no point here, so `world` means nothing",
                        "`world` exists where `p` does: in formulas and materials",
                    )));
                }
                let cells = (0..3).map(|i| self.graph.leaf(Leaf::Variable(WORLD + i)));
                Value::Vector(cells.collect())
            }
            "normal" => {
                if !env.normal {
                    return Some(Err(self.error(
                        Code::NoPoint,
                        span,
                        "there is no `normal` here",
                        "`normal` exists in materials, where a surface has been found",
                    )));
                }
                let cells = (0..3).map(|i| self.graph.leaf(Leaf::Normal(i)));
                Value::Vector(cells.collect())
            }
            "time" => Value::number(self.graph.leaf(Leaf::Time)),
            "pi" => self.constant(std::f64::consts::PI),
            "tau" => self.constant(std::f64::consts::TAU),
            "x" => axis(self, 0),
            "y" => axis(self, 1),
            "z" => axis(self, 2),
            "nothing" => Value::Nothing,
            "on" => Value::Bool(self.graph.constant(1.0)),
            "off" => Value::Bool(self.graph.constant(0.0)),
            _ => return None,
        }))
    }

    /// The value of a declaration named without a call.
    pub fn item_value(&mut self, items: &[ItemRef], span: Span, env: &Env) -> Elaborated<Value> {
        let Some(&item) = items.first() else { return Err(Stop) };
        let Some(declared) = self.modules.item(item) else { return Err(Stop) };
        match &declared.kind {
            ItemKind::Param { .. } => self.parameter(item),
            ItemKind::Let(_) => self.top_let(item),
            ItemKind::Material { .. } => self.make_material(item, &[], span).map(Value::Material),
            // `()` may be left off.
            ItemKind::Function(_) => self.call_items(items, None, &[], span, env),
            _ => Err(Stop),
        }
    }

    /// A `let` at the top of a text.
    pub fn top_let(&mut self, item: ItemRef) -> Elaborated<Value> {
        let Some(declared) = self.modules.item(item) else { return Err(Stop) };
        match self.lets.get(&item) {
            Some(Some(value)) => return value.clone(),
            Some(None) => {
                return Err(self.error(
                    Code::EndlessCall,
                    declared.span,
                    "this `let` needs its own value",
                    "let it depend on other names only",
                ));
            }
            None => {}
        }
        self.lets.insert(item, None);
        self.called.insert(item);
        let value = match &declared.kind {
            ItemKind::Let(l) => {
                let env = Env::top(item.module);
                self.bind_lets(std::slice::from_ref(l), &env).and_then(|inner| {
                    l.bindings.first().and_then(|(n, _)| inner.local(&n.text).cloned()).ok_or(Stop)
                })
            }
            _ => Err(Stop),
        };
        self.lets.insert(item, Some(value.clone()));
        value
    }

    /// Says that a name is brought by several imports.
    pub fn ambiguous(&mut self, name: &str, paths: &[String], span: Span) -> Stop {
        let from = paths.join("` and `");
        let help = match paths.last() {
            Some(last) => format!("write `import \"{last}\" as other`, and then `other.{name}`"),
            None => String::new(),
        };
        self.error(Code::Ambiguous, span, format!("`{name}` comes from `{from}`"), help)
    }

    /// Says that a name is not known, and which one may have been meant.
    pub fn unknown_name(&mut self, name: &str, span: Span, env: &Env) -> Stop {
        let mut candidates: Vec<&str> = self.modules.visible(env.module);
        candidates.extend(super::builtin::NAMES);
        let mut locals = Vec::new();
        let mut scope = env.scope.as_ref();
        while let Some(s) = scope {
            locals.push(s.name.clone());
            scope = s.outer.as_ref();
        }
        let near = ours(name, &candidates)
            .or_else(|| nearest(name, candidates.into_iter().chain(locals.iter().map(|n| &**n))))
            .map(str::to_owned);
        let help = match near {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("declare it, for example `let {name} = …` or `shape {name} = …`"),
        };
        self.error(Code::UnknownName, span, format!("nothing is named `{name}`"), help)
    }

    fn vector(&mut self, items: &[Expr], span: Span, env: &Env) -> Elaborated<Value> {
        let values: Vec<Elaborated<Value>> =
            items.iter().map(|i| self.expression(i, env)).collect();
        let mut cells = Vec::new();
        for (value, item) in values.into_iter().zip(items) {
            match value? {
                Value::Vector(v) => cells.extend(v.iter().copied()),
                other => cells.push(self.to_number(&other, item.span, env)?),
            }
        }
        if !(2..=4).contains(&cells.len()) {
            return Err(self.error(
                Code::TypeMismatch,
                span,
                format!("a vector has two to four components, and this has {}", cells.len()),
                "write a list with `[` and `]` for more values",
            ));
        }
        Ok(Value::Vector(cells.into()))
    }

    fn list(&mut self, items: &[Expr], env: &Env) -> Elaborated<Value> {
        if let [Expr { kind: ExprKind::For(each), span }] = items
            && each.by.is_none()
        {
            return self.unfold(*span, |e| e.for_each(each, Joined::List, *span, env));
        }
        let values: Vec<Elaborated<Value>> =
            items.iter().map(|i| self.expression(i, env)).collect();
        let values = values.into_iter().collect::<Elaborated<Vec<_>>>()?;
        let places: Vec<Span> = items.iter().map(|i| i.span).collect();
        let whole = match (places.first(), places.last()) {
            (Some(first), Some(last)) => first.to(*last),
            _ => return Ok(Value::List([].into())),
        };
        self.list_of(values, &places, whole)
    }

    /// A list of values of one kind. A value without a place of its own stands at `span`.
    fn list_of(&mut self, values: Vec<Value>, places: &[Span], span: Span) -> Elaborated<Value> {
        if let Some((first, rest)) = values.split_first() {
            for (i, value) in rest.iter().enumerate() {
                if !first.is_like(value, self) {
                    let (wanted, found) = (first.describe(self), value.describe(self));
                    let at = places.get(i + 1).copied().unwrap_or(span);
                    let mut error = Diagnostic::new(
                        Code::TypeMismatch,
                        at,
                        format!("this is {found}, and the list begins with {wanted}"),
                        "let all elements of a list be of one kind",
                    );
                    if let Some(place) = places.first() {
                        error = error.label(*place, wanted);
                    }
                    return Err(self.report(error));
                }
            }
        }
        let list = Value::List(values.into());
        // Lists within lists share their elements, and may stand for more than memory holds.
        let size = list.size(LIST_LIMIT);
        if size >= LIST_LIMIT {
            return Err(self.error(
                Code::TooLarge,
                span,
                format!("this list has more than {LIST_LIMIT} elements, counting those of the lists within"),
                "use fewer elements",
            ));
        }
        self.steps_of(size / 16, span)?;
        Ok(list)
    }

    fn unary(&mut self, op: UnaryOp, inner: &Expr, span: Span, env: &Env) -> Elaborated<Value> {
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
                let field = self.graph.field(*id, point);
                let value = self.graph.op(Op::Neg, &[field]);
                let dimensions = self.dimensions(*id);
                Ok(Value::Shape(self.make_shape(dimensions, value, span)))
            }
            (UnaryOp::Not, Value::Nothing) => {
                let value = self.graph.constant(-FAR);
                Ok(Value::Shape(self.make_shape(3, value, span)))
            }
            (UnaryOp::Neg, other) => {
                let found = other.describe(self);
                Err(self.error(
                    Code::TypeMismatch,
                    span,
                    format!("`-` needs a number or a vector, and this is {found}"),
                    "the complement of a shape is written `!s`",
                ))
            }
            (UnaryOp::Not, other) => {
                let found = other.describe(self);
                Err(self.error(
                    Code::TypeMismatch,
                    span,
                    format!("`!` needs a condition or a shape, and this is {found}"),
                    "the negative of a number is written `-a`",
                ))
            }
        }
    }

    fn chain(
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
                && self.dimensions(*a) == self.dimensions(*b)
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
        let dimensions = shapes.first().map_or(3, |s| self.dimensions(*s));
        let point = self.graph.point();
        let fields: Vec<NodeId> = shapes.iter().map(|s| self.graph.field(*s, point)).collect();
        let value = self.balanced(Op::Min, &fields, FAR);
        self.make_shape(dimensions, value, span)
    }

    /// An associative operation over many nodes as a balanced tree.
    pub fn balanced(&mut self, op: Op, nodes: &[NodeId], neutral: f64) -> NodeId {
        match nodes {
            [] => self.graph.constant(neutral),
            [one] => *one,
            _ => {
                let (left, right) = nodes.split_at(nodes.len() / 2);
                let left = self.balanced(op, left, neutral);
                let right = self.balanced(op, right, neutral);
                self.graph.op(op, &[left, right])
            }
        }
    }

    fn binary(
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
                let found = if is_shape(&a) { b.describe(self) } else { a.describe(self) };
                let at = if is_shape(&a) { spans.2 } else { spans.0 };
                let help = match (&a, &b) {
                    (Value::Bool(_), _) | (_, Value::Bool(_)) => {
                        "conditions are joined by `&&` and `||`"
                    }
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
        if arithmetic && !computes(op, &a, &b) {
            let (left, right) = (a.describe(self), b.describe(self));
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
                    let found = other.describe(self);
                    let at = if matches!(a, Value::Bool(_)) { spans.2 } else { spans.0 };
                    Err(self.error(
                        Code::TypeMismatch,
                        at,
                        format!("a condition is needed here, and this is {found}"),
                        "compare it with something, for example `a > 0`",
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
            (Value::Shape(id), _) | (_, Value::Shape(id)) => self.dimensions(*id),
            _ => return Ok(Value::Nothing),
        };
        if let (Value::Shape(x), Value::Shape(y)) = (a, b)
            && self.dimensions(*x) != self.dimensions(*y)
        {
            let error = Diagnostic::new(
                Code::TypeMismatch,
                spans.1,
                "a drawing and a solid do not go together",
                "make a solid of the drawing with `.extrude(height)` or `.revolve()`",
            );
            return Err(self.report(error.label(spans.0, a.describe(self)).label(spans.2, b.describe(self))));
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

    fn index(&mut self, list: &Expr, index: &Expr, span: Span, env: &Env) -> Elaborated<Value> {
        let values = self.expression(list, env);
        let at = self.expression(index, env);
        let (values, at) = (values?, at?);
        let items: Vec<Value> = match &values {
            Value::List(items) => items.to_vec(),
            Value::Vector(v) => v.iter().map(|n| Value::number(*n)).collect(),
            Value::Matrix(n, cells) => {
                cells.chunks(usize::from(*n)).map(|c| Value::Vector(c.into())).collect()
            }
            other => {
                let found = other.describe(self);
                return Err(self.error(
                    Code::TypeMismatch,
                    list.span,
                    format!("only a list has elements, and this is {found}"),
                    "write a list, for example `[1, 2, 3][i]`",
                ));
            }
        };
        let node = self.to_number(&at, index.span, env)?;
        let length = items.len();
        if let Some(constant) = self.graph.as_constant(node) {
            let inside = constant >= 0.0 && constant < length as f64 && constant.fract() == 0.0;
            return match items.get(constant as usize) {
                Some(item) if inside => Ok(item.clone()),
                _ => Err(self.error(
                    Code::OutOfBounds,
                    index.span,
                    format!("there is no element {constant} in a list of {length}"),
                    match length {
                        0 => "the list is empty".to_owned(),
                        n => format!("elements are numbered from 0 to {}", n - 1),
                    },
                )),
            };
        }
        // A live index chooses at run time; beyond the ends it takes the nearest element.
        let Some(mut chosen) = items.first().cloned() else {
            return Err(self.error(Code::OutOfBounds, index.span, "the list is empty", "give it an element"));
        };
        let rounded = self.graph.op(Op::Round, &[node]);
        for (i, item) in items.iter().enumerate().skip(1) {
            let bound = self.graph.constant(i as f64);
            let reached = self.graph.op(Op::Le, &[bound, rounded]);
            chosen = self.select(reached, item, &chosen, span, env)?;
        }
        Ok(chosen)
    }

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
                    (Value::Shape(id), _) | (_, Value::Shape(id)) => self.dimensions(*id),
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
                        "choose by parameters, `time` or the index of a `for`; inside a formula choose between numbers",
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
                let (left, right) = (a.describe(self), b.describe(self));
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

    fn choice(
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
                let found = other.describe(self);
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
            && !a.is_like(&b, self)
            && !(env.point.is_some() && a.is_field() && b.is_field())
        {
            let (left, right) = (a.describe(self), b.describe(self));
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

    /// The environment with the names of `let`s.
    pub fn bind_lets(&mut self, lets: &[Let], env: &Env) -> Elaborated<Env> {
        let mut env = env.clone();
        let mut failed = false;
        for l in lets {
            if let Some(loop_) = &l.iterate {
                match self.unfold(l.span, |e| e.iterate(l, loop_, &env)) {
                    Ok(values) => {
                        for ((name, _), value) in l.bindings.iter().zip(values) {
                            self.hint(&value, &name.text);
                            env = env.and(&name.text, value);
                        }
                    }
                    Err(Stop) => failed = true,
                }
                continue;
            }
            for (name, value) in &l.bindings {
                match self.expression(value, &env) {
                    Ok(value) => {
                        self.hint(&value, &name.text);
                        env = env.and(&name.text, value);
                    }
                    Err(Stop) => failed = true,
                }
                if failed {
                    break;
                }
            }
            if failed {
                break;
            }
        }
        if failed { Err(Stop) } else { Ok(env) }
    }

    /// Gives the nodes of a value the name that it has in the source.
    pub fn hint(&mut self, value: &Value, name: &str) {
        match value {
            Value::Number(node, _) | Value::Bool(node) => self.graph.name_node(*node, name),
            Value::Vector(v) => {
                for (node, suffix) in v.iter().zip(["x", "y", "z", "w"]) {
                    if self.graph.node_name(*node).is_none() {
                        self.graph.name_node(*node, &format!("{name}_{suffix}"));
                    }
                }
            }
            _ => {}
        }
    }

    fn iterate(&mut self, l: &Let, turns: &Iterate, env: &Env) -> Elaborated<Vec<Value>> {
        let mut values = Vec::new();
        for (_, first) in &l.bindings {
            values.push(self.expression(first, env)?);
        }
        let (indices, live) = self.turns(&turns.source, env)?;
        let mut running = self.graph.constant(1.0);
        for (turn, index) in indices.into_iter().enumerate() {
            self.step(l.span)?;
            let mut inner = env.clone();
            for ((name, _), value) in l.bindings.iter().zip(&values) {
                inner = inner.and(&name.text, value.clone());
            }
            inner = inner.and(&turns.index.text, index);
            if let Some(limit) = live {
                let turn = self.graph.constant(turn as f64);
                let more = self.graph.op(Op::Lt, &[turn, limit]);
                running = self.graph.op(Op::And, &[running, more]);
            }
            if let Some(condition) = &turns.condition {
                match self.expression(condition, &inner)? {
                    Value::Bool(node) => running = self.graph.op(Op::And, &[running, node]),
                    other => {
                        let found = other.describe(self);
                        return Err(self.error(
                            Code::TypeMismatch,
                            condition.span,
                            format!("`while` needs a condition, and this is {found}"),
                            "compare it with something, for example `length(q) < 8`",
                        ));
                    }
                }
            }
            let state = self.graph.as_constant(running);
            if state == Some(0.0) {
                break;
            }
            let body = self.bind_lets(&turns.lets, &inner)?;
            let mut next = values.clone();
            for (name, update) in &turns.updates {
                let Some(slot) = l.bindings.iter().position(|(n, _)| n.text == name.text) else {
                    return Err(self.error(
                        Code::UnknownName,
                        name.span,
                        format!("`{}` is not one of the names that this loop replaces", name.text),
                        "name it after `let`, with its first value",
                    ));
                };
                let new = self.expression(update, &body)?;
                let new = match (&new, values.get(slot)) {
                    (Value::Number(..), Some(Value::Vector(v))) => {
                        Value::Vector(self.to_vector(&new, v.len(), update.span)?)
                    }
                    _ => new,
                };
                let new = match (state, values.get(slot)) {
                    (None, Some(old)) => self.select(running, &new, old, update.span, &body)?,
                    _ => new,
                };
                if let Some(cell) = next.get_mut(slot) {
                    *cell = new;
                }
            }
            values = next;
        }
        Ok(values)
    }

    /// The indices of a range; where its end is live, all that it may reach, and the live number of turns.
    fn turns(&mut self, source: &Expr, env: &Env) -> Elaborated<(Vec<Value>, Option<NodeId>)> {
        let range = self.expression(source, env)?;
        let Value::Range(range) = &range else {
            let found = range.describe(self);
            return Err(self.error(
                Code::TypeMismatch,
                source.span,
                format!("a range is needed here, and this is {found}"),
                "write `0..n`",
            ));
        };
        let from = self.to_constant(&range.0, source.span)?;
        let end = self.to_number(&range.1, source.span, env)?;
        let (last, live) = match self.graph.as_constant(end) {
            Some(last) => (last, None),
            None => {
                let reach = self.facts.live_range(&self.graph, end);
                if !reach.hi.is_finite() {
                    return Err(self.error(
                        Code::NotConstant,
                        source.span,
                        "the end of this range may be anything",
                        "let it depend on parameters with a range, or write a number",
                    ));
                }
                let start = self.graph.constant(from);
                (reach.hi, Some(self.graph.op(Op::Sub, &[end, start])))
            }
        };
        if live.is_none() && last < from {
            let help = if (last - from).abs() < 1e6 {
                format!("write the smaller end first; the end is left out: `{last}..{from}`")
            } else {
                "write the smaller end first".to_owned()
            };
            return Err(self.error(
                Code::BadValue,
                source.span,
                format!("the range {from}..{last} is empty"),
                help,
            ));
        }
        if last - from > TURN_LIMIT {
            return Err(self.error(
                Code::TooLarge,
                source.span,
                format!("this is {} turns, and at most {TURN_LIMIT} are made", (last - from).ceil()),
                "use fewer turns, or `grid` for many copies of one shape",
            ));
        }
        let count = (last - from).ceil().max(0.0) as usize;
        let indices = (0..count).map(|i| self.constant(from + i as f64)).collect();
        Ok((indices, live))
    }

    /// `for … { … }`.
    pub fn for_each(
        &mut self,
        each: &For,
        joined: Joined,
        span: Span,
        env: &Env,
    ) -> Elaborated<Value> {
        if let ExprKind::Call(callee, args) = &each.source.kind
            && let ExprKind::Name(name) = &callee.kind
            && matches!(name.as_str(), "grid" | "polar")
        {
            if let Joined::By(fold) = &joined {
                return Err(self.error(
                    Code::TypeMismatch,
                    fold.span,
                    "a repetition without end has no order in which to join its copies",
                    "leave out `by`, or use a range and place the copies yourself",
                ));
            }
            return if name == "grid" {
                self.grid(each, args, span, env)
            } else {
                self.polar(each, args, span, env)
            };
        }
        let source = match &each.source.kind {
            ExprKind::Range(..) => None,
            _ => match self.expression(&each.source, env)? {
                Value::List(items) => Some((items.to_vec(), None)),
                Value::Range(_) => None,
                other => {
                    let found = other.describe(self);
                    return Err(self.error(
                        Code::TypeMismatch,
                        each.source.span,
                        format!("`for` goes over a range or a list, and this is {found}"),
                        "write `0..n`, a list, `grid(size)` or `polar(axis, n)`",
                    ));
                }
            },
        };
        let (items, live) = match source {
            Some(items) => items,
            None => self.turns(&each.source, env)?,
        };
        if live.is_some() && matches!(joined, Joined::List) {
            return Err(self.error(
                Code::NotConstant,
                each.source.span,
                "the length of a list must be known while compiling",
                "write a number, or a `let` of numbers",
            ));
        }
        let mut bodies = Vec::new();
        for (turn, item) in items.into_iter().enumerate() {
            self.step(span)?;
            let inner = env.with(&each.index.text, item);
            let body = self.expression(&each.body, &inner)?;
            let present = live.map(|limit| {
                let turn = self.graph.constant(turn as f64);
                self.graph.op(Op::Lt, &[turn, limit])
            });
            bodies.push((body, present));
        }
        self.join(bodies, joined, span, each.body.span, env)
    }

    fn join(
        &mut self,
        bodies: Vec<(Value, Option<NodeId>)>,
        joined: Joined,
        span: Span,
        body_span: Span,
        env: &Env,
    ) -> Elaborated<Value> {
        match joined {
            Joined::List => {
                let values = bodies.into_iter().map(|(v, _)| v).collect();
                self.list_of(values, &[], body_span)
            }
            Joined::Union => {
                let shapes = bodies.iter().all(|(v, _)| matches!(v, Value::Shape(_) | Value::Nothing));
                if shapes {
                    let mut ids = Vec::new();
                    for (body, present) in bodies {
                        let body = match present {
                            Some(present) => {
                                self.select(present, &body, &Value::Nothing, span, env)?
                            }
                            None => body,
                        };
                        if let Value::Shape(id) = body {
                            ids.push(id);
                        }
                    }
                    return match ids.as_slice() {
                        [] => Ok(Value::Nothing),
                        _ => Ok(Value::Shape(self.union(&ids, span))),
                    };
                }
                let mut numbers = Vec::new();
                for (body, present) in &bodies {
                    let number = match body {
                        Value::Number(..) | Value::Shape(_) => {
                            self.to_number(body, body_span, env)?
                        }
                        other => {
                            let found = other.describe(self);
                            return Err(self.error(
                                Code::TypeMismatch,
                                body_span,
                                format!("the body of a `for` must be a shape or a number, and this is {found}"),
                                "put `[` and `]` around the `for` to make a list",
                            ));
                        }
                    };
                    let far = self.graph.constant(FAR);
                    numbers.push(match present {
                        Some(present) => self.graph.op(Op::Select, &[*present, number, far]),
                        None => number,
                    });
                }
                let node = self.balanced(Op::Min, &numbers, FAR);
                Ok(Value::number(node))
            }
            Joined::By(fold) => {
                let mut total: Option<Value> = None;
                for (body, present) in bodies {
                    let Some(before) = total else {
                        // The first stands even where a live count is zero: there is nothing to fold it with.
                        total = Some(body);
                        continue;
                    };
                    let after = self.fold(&fold, &before, &body, env)?;
                    total = Some(match present {
                        Some(present) => self.select(present, &after, &before, span, env)?,
                        None => after,
                    });
                }
                match (total, &fold.kind) {
                    (Some(total), _) => Ok(total),
                    (None, FoldKind::Operator(BinaryOp::Add)) => Ok(self.constant(0.0)),
                    (None, FoldKind::Operator(_)) => Ok(self.constant(1.0)),
                    (None, _) => Ok(Value::Nothing),
                }
            }
        }
    }

    fn fold(&mut self, fold: &Fold, before: &Value, body: &Value, env: &Env) -> Elaborated<Value> {
        match &fold.kind {
            FoldKind::Operator(op) => {
                self.binary(*op, before, body, (fold.span, fold.span, fold.span), env)
            }
            FoldKind::Call(callee, args) => {
                self.call_with(callee, &[before.clone(), body.clone()], args, fold.span, env)
            }
        }
    }

    /// The shape of a formula's value in a space of its own.
    pub fn formula_shape(
        &mut self,
        value: NodeId,
        dimensions: u8,
        name: Option<Arc<str>>,
        exact: bool,
        span: Span,
    ) -> ShapeId {
        self.locate(value, span);
        self.graph.add_shape(Shape {
            name,
            dimensions,
            value,
            variables: Arc::default(),
            exactness: if exact { Exactness::Exact } else { Exactness::Formula },
            material: None,
            paints: Arc::default(),
            span: self.place(span),
        })
    }

    /// Warns once at a place.
    pub fn warn(&mut self, code: Code, span: Span, message: impl Into<String>, help: impl Into<String>) {
        self.report(Diagnostic::new(code, span, message, help));
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

/// The expression that gives the value of a block.
fn result_of(expr: &Expr) -> Span {
    match &expr.kind {
        ExprKind::Block(_, value) => result_of(value),
        _ => expr.span,
    }
}

/// The value of a function's kind in words, for messages.
pub fn kind_words(kind: FunctionKind) -> &'static str {
    match kind {
        FunctionKind::Field => "field",
        FunctionKind::Field2 => "field2",
        FunctionKind::Warp => "warp",
        FunctionKind::Warp2 => "warp2",
        FunctionKind::Blend => "blend",
        FunctionKind::Fn => "fn",
        FunctionKind::Shape => "shape",
        FunctionKind::Shape2 => "shape2",
    }
}

/// A byte of sRGB as linear light (IEC 61966-2-1).
pub fn srgb_to_linear(byte: u8) -> f64 {
    let c = f64::from(byte) / 255.0;
    if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}
