//! The value of an expression.

use super::loops::{Joined, LIST_LIMIT};
use super::elsewhere::{color, instead, is_of_point, ours};
use super::load::{ItemRef, Resolution};
use super::value::Value;
use super::{Elaborated, Elaborator, Env, Stop};
use crate::diagnostic::{Code, Diagnostic};
use crate::graph::kernel::Op;
use crate::graph::{Exactness, Leaf, NodeId, Shape, ShapeId, WORLD};
use crate::source::Span;
use crate::syntax::words::nearest;
use crate::syntax::ast::{Expr, ExprKind, FunctionKind, ItemKind};
use std::rc::Rc;
use std::sync::Arc;

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
            ExprKind::Angle(number, unit) => Ok(Value::number(self.graph.constant(unit.radians(*number)))),
            ExprKind::Length(value, unit) => self.written_with(*value, *unit, expr.span),
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
            let value = value.clone();
            self.note_axis(&value, span);
            return Ok(value);
        }
        let modules = self.modules;
        let meaning = modules.resolve(env.module, name);
        match &meaning {
            Resolution::Items(items) if !self.modules.is_prelude(items.first().map_or(0, |i| i.module)) => {
                let value = self.item_value(items, span, env)?;
                self.note_axis(&value, span);
                return Ok(value);
            }
            Resolution::Ambiguous(paths) => return Err(self.ambiguous(name, paths, span)),
            _ => {}
        }
        if let Some(value) = self.built_in_name(name, span, env) {
            return value;
        }
        match meaning {
            Resolution::Items(items) => self.item_value(items, span, env),
            _ => Err(self.unknown_name(name, false, span, env)),
        }
    }

    /// Notes where the name of a unit vector stands: `x` and what is called otherwise, as by `let side = x`.
    fn note_axis(&mut self, value: &Value, span: Span) {
        let Value::Vector(v) = value else { return };
        let unit = |n: &NodeId| self.graph.as_constant(*n).is_some_and(|c| c == 0.0 || c == 1.0);
        let ones = || v.iter().filter(|n| self.graph.as_constant(**n) == Some(1.0)).count();
        if v.len() == 3 && v.iter().all(unit) && ones() == 1 {
            self.axes.insert(span);
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
                        "`p` exists in `field`, `warp`, `blend` and `material`, and in arguments that are declared `field`: declare what reads it as `field f = …`, and write `f` here; a `fn` takes what it needs as an argument",
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
            "x" | "y" | "z" => {
                self.axes.insert(span);
                axis(self, ["x", "y", "z"].iter().position(|axis| *axis == name).unwrap_or(0))
            }
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
            ItemKind::Param { .. } => {
                self.called.insert(item);
                self.parameter(item)
            }
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

    /// Whether what a name stands for is called, or else is not, as far as the language says.
    fn fits_here(&self, name: &str, is_called: bool, env: &Env) -> bool {
        let modules = self.modules;
        let Resolution::Items(items) = modules.resolve(env.module, name) else { return is_called == super::builtin::is_function(name) };
        let mut declared = items.iter().map(|item| (item, modules.item(*item).map(|i| &i.kind)));
        declared.any(|(item, kind)| match kind {
            _ if !modules.is_prelude(item.module) => true,
            Some(ItemKind::Function(f)) => is_called || f.parameters.iter().all(|p| p.default.is_some()),
            _ => true,
        })
    }

    /// Says that a name is not known, and which one may have been meant where it is called or is not.
    pub fn unknown_name(&mut self, name: &str, is_called: bool, span: Span, env: &Env) -> Stop {
        if self.is_known(Code::UnknownName, span) || self.modules.lacks(env.module, name) {
            return Stop;
        }
        if let Some((file, why)) = self.modules.left_out(env.module, name) {
            return self.unsaid(name, file, why, span);
        }
        let mut candidates: Vec<&str> = self.modules.visible(env.module);
        candidates.extend(super::builtin::NAMES);
        let mut locals = Vec::new();
        let mut scope = env.scope.as_ref();
        while let Some(s) = scope {
            locals.push(s.name.clone());
            scope = s.outer.as_ref();
        }
        // A single letter is near to whatever has two.
        let is_word = name.chars().nth(1).is_some();
        let near = ours(name, &candidates)
            .or_else(|| {
                let built_in = super::builtin::FUNCTIONS.iter().copied();
                let fitting = candidates.into_iter().chain(built_in).filter(|known| self.fits_here(known, is_called, env));
                nearest(name, fitting.chain(locals.iter().map(|n| &**n))).filter(|_| is_word)
            })
            .map(str::to_owned);
        let is_plain = instead(name).is_none() && color(name).is_none() && !is_of_point(name);
        let meant = near.clone().filter(|_| is_plain);
        let help = match (instead(name), near) {
            (Some(instead), _) => instead.to_owned(),
            _ if let Some(color) = color(name) => format!("write a colour as `{color}`, a material of it as `swatch({color})`"),
            (None, Some(near)) if is_of_point(name) => {
                format!("did you mean `{near}`? Of a point `q` it is `{near}(…).at(q)`, and sizes are whole ones, not half")
            }
            (None, Some(near)) => format!("did you mean `{near}`?"),
            (None, None) => format!("declare it, for example `let {name} = …` or `shape {name} = …`"),
        };
        let mut said = Diagnostic::new(Code::UnknownName, span, format!("nothing is named `{name}`"), help).write_if(span, meant);
        if let (None, Some(color), false) = (instead(name), color(name), is_called) {
            said = said.write(span, color).write(span, format!("swatch({color})"));
        }
        self.report(said)
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
    pub(super) fn list_of(&mut self, values: Vec<Value>, places: &[Span], span: Span) -> Elaborated<Value> {
        if let Some((first, rest)) = values.split_first() {
            for (i, value) in rest.iter().enumerate() {
                if !first.is_like(value, &self.graph) {
                    let (wanted, found) = (first.describe(&self.graph), value.describe(&self.graph));
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

    fn index(&mut self, list: &Expr, index: &Expr, span: Span, env: &Env) -> Elaborated<Value> {
        let values = self.expression(list, env);
        let at = self.expression(index, env);
        let (values, at) = (values?, at?);
        let items: Rc<[Value]> = match &values {
            Value::List(items) => items.clone(),
            Value::Vector(v) => v.iter().map(|n| Value::number(*n)).collect(),
            Value::Matrix(n, cells) => {
                cells.chunks(usize::from(*n)).map(|c| Value::Vector(c.into())).collect()
            }
            other => {
                let found = other.describe(&self.graph);
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
