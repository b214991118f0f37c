//! Calls: which declaration is meant, how arguments meet parameters, and what comes of it.

use super::elsewhere::ours;
use super::expression::kind_words;
use super::load::{ItemRef, Resolution};
use super::texture::Texture;
use super::value::{type_words, Value};
use super::{Elaborated, Elaborator, Env, Stop};
use crate::diagnostic::Code;
use crate::graph::kernel::Op;
use crate::graph::{Claim, ClaimGroup, Exactness, Function, Leaf, Material, MaterialId, Node, NodeId, NodeList, Shape, ShapeId};
use crate::source::Span;
use crate::syntax::ast::{
    self, Argument, ClaimKind, Expr, ExprKind, FunctionKind, ItemKind, Name, Parameter, Type,
};
use crate::syntax::words::nearest;
use std::rc::Rc;
use std::sync::Arc;

/// A condition on an argument, from a `Requires:` line of its documentation.
#[derive(Clone, Debug)]
pub struct Requirement {
    parameter: String,
    relation: String,
    bound: f64,
}

/// Where a live value must be above a limit, it is kept so far above it.
const LEAST: f64 = 1e-5;

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

/// An argument before it has a value, or with one.
enum Given<'a> {
    Written(&'a Expr),
    Known(Value, Span),
    /// Numbers written out where one vector is wanted.
    Group(Vec<&'a Expr>),
    KnownGroup(Vec<Value>, Span),
}

impl Elaborator<'_> {
    /// `callee(args)`.
    pub fn call_expression(
        &mut self,
        callee: &Expr,
        args: &[Argument],
        span: Span,
        env: &Env,
    ) -> Elaborated<Value> {
        self.call_with_receiver(callee, None, args, span, env)
    }

    /// A call with values that stand before the written arguments.
    pub fn call_with(
        &mut self,
        callee: &Expr,
        before: &[Value],
        args: &[Argument],
        span: Span,
        env: &Env,
    ) -> Elaborated<Value> {
        let known: Vec<(Value, Span)> = before.iter().map(|v| (v.clone(), span)).collect();
        self.call_resolved(callee, known, args, span, env)
    }

    fn call_with_receiver(
        &mut self,
        callee: &Expr,
        receiver: Option<(Value, Span)>,
        args: &[Argument],
        span: Span,
        env: &Env,
    ) -> Elaborated<Value> {
        self.call_resolved(callee, receiver.into_iter().collect(), args, span, env)
    }

    fn call_resolved(
        &mut self,
        callee: &Expr,
        known: Vec<(Value, Span)>,
        args: &[Argument],
        span: Span,
        env: &Env,
    ) -> Elaborated<Value> {
        match &callee.kind {
            ExprKind::Name(name) => {
                self.call_name(name, callee.span, known, args, span, env)
            }
            ExprKind::Dot(alias, name, None) => match &alias.kind {
                ExprKind::Name(alias_name) => match self.modules.alias(env.module, alias_name) {
                    Some(module) => self.call_in(module, alias_name, name, known, args, span, env),
                    None => Err(self.unknown_name(alias_name, alias.span, env)),
                },
                _ => Err(self.not_callable(callee.span)),
            },
            ExprKind::Hole => Err(Stop),
            _ => Err(self.not_callable(callee.span)),
        }
    }

    fn not_callable(&mut self, span: Span) -> Stop {
        self.error(
            Code::TypeMismatch,
            span,
            "this is not a function, so it can't be called",
            "write the name of a function before the parentheses",
        )
    }

    /// A call of a name in the text behind an import's name.
    #[allow(clippy::too_many_arguments)]
    fn call_in(
        &mut self,
        module: usize,
        alias: &str,
        name: &Name,
        known: Vec<(Value, Span)>,
        args: &[Argument],
        span: Span,
        env: &Env,
    ) -> Elaborated<Value> {
        let modules = self.modules;
        let items = modules.own(module, &name.text);
        if items.is_empty() {
            return Err(self.unknown_in(module, alias, name));
        }
        self.call_items_with(items.get(..1).unwrap_or(&[]), known, args, span, env)
    }

    fn unknown_in(&mut self, module: usize, alias: &str, name: &Name) -> Stop {
        let modules = self.modules;
        let candidates: Vec<&str> = modules
            .items(module)
            .filter_map(|(_, i)| super::load::item_name(i))
            .map(|n| &*n.text)
            .collect();
        let help = match nearest(&name.text, candidates.iter().copied()) {
            Some(near) => format!("did you mean `{alias}.{near}`?"),
            None => format!("`{}` declares: {}", modules.path(module), candidates.join(", ")),
        };
        self.error(
            Code::UnknownMember,
            name.span,
            format!("`{}` declares no `{}`", modules.path(module), name.text),
            help,
        )
    }

    /// A call of the name that stands at `at`.
    fn call_name(
        &mut self,
        name: &str,
        at: Span,
        known: Vec<(Value, Span)>,
        args: &[Argument],
        span: Span,
        env: &Env,
    ) -> Elaborated<Value> {
        let built_in = super::builtin::is_function(name);
        let modules = self.modules;
        match modules.resolve(env.module, name) {
            Resolution::Items(items) => {
                let own = !self.modules.is_prelude(items.first().map_or(0, |i| i.module))
                    || self.modules.is_prelude(env.module) && !built_in;
                if own || !built_in {
                    return self.call_items_with(items, known, args, span, env);
                }
                // Both the kernel and the prelude know the name: the first argument decides.
                let first = match (known.first(), args.first()) {
                    (Some((value, _)), _) => value.clone(),
                    (None, Some(arg)) if arg.name.is_none() => {
                        self.expression(&arg.value, env)?
                    }
                    _ => return self.call_items_with(items, known, args, span, env),
                };
                let mut known = known;
                let mut args = args;
                if known.is_empty()
                    && let Some((arg, rest)) = args.split_first()
                {
                    known.push((first.clone(), arg.value.span));
                    args = rest;
                }
                if matches!(first, Value::Shape(_) | Value::Nothing) {
                    return self.call_items_with(items, known, args, span, env);
                }
                self.call_built_in(name, known, args, span, env)
            }
            Resolution::Ambiguous(paths) => Err(self.ambiguous(name, &paths, at)),
            Resolution::Unknown if built_in => {
                self.call_built_in(name, known, args, span, env)
            }
            Resolution::Unknown => {
                for arg in args {
                    // Errors in the arguments are worth knowing too, where they can be judged.
                    if env.point.is_some() {
                        let _ = self.expression(&arg.value, env);
                    }
                }
                match known.first().cloned() {
                    Some((receiver, _)) => Err(self.unknown_method(&receiver, name, at, env)),
                    None if super::builtin::NAMES.contains(&name) => Err(self.error(
                        Code::TypeMismatch,
                        at,
                        format!("`{name}` is no function, so it can't be called"),
                        format!("write `{name}` alone"),
                    )),
                    None => Err(self.unknown_name(name, at, env)),
                }
            }
        }
    }

    fn unknown_method(&mut self, receiver: &Value, name: &str, at: Span, env: &Env) -> Stop {
        let found = receiver.describe(self);
        let candidates: Vec<&str> = self
            .modules
            .visible(env.module)
            .into_iter()
            .chain(super::builtin::FUNCTIONS.iter().copied())
            .collect();
        let help = match ours(name, &candidates).or_else(|| nearest(name, candidates)) {
            Some(near) => format!("did you mean `.{near}(…)`?"),
            None => "any `shape`, `warp` or `blend` that takes this first can stand after the dot".into(),
        };
        self.error(
            Code::UnknownMember,
            at,
            format!("{found} has no `{}`", name),
            help,
        )
    }

    fn call_built_in(
        &mut self,
        name: &str,
        known: Vec<(Value, Span)>,
        args: &[Argument],
        span: Span,
        env: &Env,
    ) -> Elaborated<Value> {
        // In a claim: the value of an argument, where its name alone is its constant.
        if name == "value"
            && let [Argument { value: Expr { kind: ExprKind::Name(of), .. }, .. }] = args
            && let Some(value) = env.local(&format!("value:{of}"))
        {
            return Ok(value.clone());
        }
        let mut values = known;
        let mut failed = false;
        for arg in args {
            if let Some(label) = &arg.name
                && !(&*label.text == "seed" && name.starts_with("hash"))
            {
                self.error(
                    Code::UnknownArgument,
                    label.span,
                    format!("`{name}` has no argument named `{}`", label.text),
                    "leave the name out",
                );
                failed = true;
            }
            match self.expression(&arg.value, env) {
                Ok(value) => values.push((value, arg.value.span)),
                Err(Stop) => failed = true,
            }
        }
        if failed {
            return Err(Stop);
        }
        self.built_in(name, &values, span, env)
    }

    /// `receiver.name` and `receiver.name(args)`.
    pub fn dot(
        &mut self,
        receiver: &Expr,
        name: &Name,
        args: Option<&[Argument]>,
        span: Span,
        env: &Env,
    ) -> Elaborated<Value> {
        // `sky.dusk`: a name behind an import's name.
        if let ExprKind::Name(alias) = &receiver.kind
            && env.local(alias).is_none()
            && let Some(module) = self.modules.alias(env.module, alias)
        {
            let modules = self.modules;
            let items = modules.own(module, &name.text);
            if items.is_empty() {
                return Err(self.unknown_in(module, alias, name));
            }
            return match args {
                Some(args) => self.call_items_with(items.get(..1).unwrap_or(&[]), Vec::new(), args, span, env),
                None => self.item_value(items.get(..1).unwrap_or(&[]), span, env),
            };
        }
        // `s.sky.arch(2)`: a function behind an import's name, after a dot.
        if let ExprKind::Dot(inner, alias, None) = &receiver.kind
            && let Some(module) = self.modules.alias(env.module, &alias.text)
            && !matches!(&inner.kind, ExprKind::Name(n) if self.modules.alias(env.module, n).is_some())
        {
            let value = self.expression(inner, env)?;
            let call = Span { start: alias.span.start, ..span };
            return self.call_in(
                module,
                &alias.text,
                name,
                vec![(value, inner.span)],
                args.unwrap_or(&[]),
                call,
                env,
            );
        }
        // `x.y` where `p.x` was meant: a component of a unit vector is never wanted.
        if let ExprKind::Name(axis) = &receiver.kind
            && matches!(axis.as_str(), "x" | "y" | "z")
            && env.local(axis).is_none()
            && args.is_none()
            && matches!(&*name.text, "x" | "y" | "z")
            && matches!(self.modules.resolve(env.module, axis), Resolution::Unknown)
        {
            return Err(self.error(
                Code::UnknownMember,
                span,
                format!("`{axis}` is the unit vector along {axis}, so `{axis}.{}` is a constant", name.text),
                format!("write `p.{}` for the point's coordinate", name.text),
            ));
        }
        let value = self.expression(receiver, env)?;
        if args.is_none() {
            if let Value::Vector(v) = &value
                && let Some(picked) = self.swizzle(v, name)
            {
                return picked;
            }
            if let (Value::List(items), "count") = (&value, &*name.text) {
                return Ok(self.constant(items.len() as f64));
            }
            if let Value::Number(..) | Value::Bool(_) | Value::Text(_) | Value::Matrix(..) = &value {
                let found = value.describe(self);
                let help = if matches!(value, Value::Number(..)) && name.text.len() == 1 {
                    "a number has no components; use it as it is"
                } else {
                    "leave the dot and what follows out"
                };
                return Err(self.error(
                    Code::UnknownMember,
                    name.span,
                    format!("{found} has no `{}`", name.text),
                    help,
                ));
            }
        }
        // What goes wrong with the call has its place behind the dot.
        let call = Span { start: name.span.start, ..span };
        self.call_name(&name.text, name.span, vec![(value, receiver.span)], args.unwrap_or(&[]), call, env)
    }

    fn swizzle(&mut self, v: &[NodeId], name: &Name) -> Option<Elaborated<Value>> {
        let letters = &*name.text;
        let sets = ["xyzw", "rgba"];
        let set = sets.iter().find(|s| letters.chars().all(|c| s.contains(c)))?;
        if letters.is_empty() || letters.len() > 4 {
            return None;
        }
        let mut picked = Vec::new();
        for letter in letters.chars() {
            let Some(&node) = set.find(letter).and_then(|i| v.get(i)) else {
                return Some(Err(self.error(
                    Code::UnknownMember,
                    name.span,
                    format!("a vec{} has no `{letter}`", v.len()),
                    format!("its components are {}", &set.get(..v.len()).unwrap_or(set)),
                )));
            };
            picked.push(node);
        }
        Some(Ok(match *picked {
            [one] => Value::number(one),
            _ => Value::Vector(picked.into()),
        }))
    }

    /// A call of declarations of one name, none, or one value before the written arguments.
    pub fn call_items(
        &mut self,
        items: &[ItemRef],
        receiver: Option<(Value, Span)>,
        args: &[Argument],
        span: Span,
        env: &Env,
    ) -> Elaborated<Value> {
        self.call_items_with(items, receiver.into_iter().collect(), args, span, env)
    }

    fn call_items_with(
        &mut self,
        items: &[ItemRef],
        mut known: Vec<(Value, Span)>,
        mut args: &[Argument],
        span: Span,
        env: &Env,
    ) -> Elaborated<Value> {
        let mut chosen = items.first().copied();
        if items.len() > 1 {
            if known.is_empty()
                && let Some((arg, rest)) = args.split_first()
                && arg.name.is_none()
            {
                known.push((self.expression(&arg.value, env)?, arg.value.span));
                args = rest;
            }
            chosen = self.overload(items, &known, args, span, env)?;
        }
        let Some(item) = chosen else { return Err(Stop) };
        let modules = self.modules;
        let Some(declared) = modules.item(item) else { return Err(Stop) };
        match &declared.kind {
            ItemKind::Function(function) => self.call_function(item, function, known, args, span, env),
            ItemKind::Material { parameters, .. } => {
                let bound = self.bind(parameters, known, args, span, env, &env.clone(), &declared_name(declared))?;
                let bound: Vec<Option<Value>> = bound.into_iter().map(|b| b.map(|b| b.value)).collect();
                self.make_material(item, &bound, span).map(Value::Material)
            }
            _ => {
                let value = self.item_value(&[item], span, env)?;
                let found = value.describe(self);
                let name = declared_name(declared);
                Err(self.error(
                    Code::TypeMismatch,
                    span,
                    format!("`{name}` is {found}, so it can't be called"),
                    format!("write `{name}` alone"),
                ))
            }
        }
    }

    /// Which of several declarations of one name (all of the prelude) a call means: by its first argument, then by their number.
    fn overload(
        &mut self,
        items: &[ItemRef],
        known: &[(Value, Span)],
        args: &[Argument],
        span: Span,
        env: &Env,
    ) -> Elaborated<Option<ItemRef>> {
        let modules = self.modules;
        let functions: Vec<(ItemRef, &ast::Function)> = items
            .iter()
            .filter_map(|&item| match modules.item(item).map(|i| &i.kind) {
                Some(ItemKind::Function(f)) => Some((item, f)),
                _ => None,
            })
            .collect();
        let positional = known.len() + args.iter().filter(|a| a.name.is_none()).count();
        // Where the first argument is the same for several, the second may tell them apart.
        let second_types: Vec<_> = functions.iter().filter_map(|(_, f)| second_type(f)).collect();
        let differ = second_types.windows(2).any(|w| w.first() != w.last());
        let second = match args.first() {
            Some(arg) if known.len() == 1 && arg.name.is_none() && differ => {
                match &arg.value.kind {
                    ExprKind::Call(..) | ExprKind::Vector(_) | ExprKind::Name(_) => {
                        let errors = self.diagnostics.len();
                        let value = self.expression(&arg.value, env).ok();
                        if value.is_none() && !self.full && !self.endless {
                            // It is said when the argument is evaluated in its place.
                            self.diagnostics.truncate(errors);
                            self.lets.retain(|_, value| !matches!(value, Some(Err(Stop))));
                        }
                        value
                    }
                    _ => None,
                }
            }
            _ => None,
        };
        let mut best: Option<((u32, usize), ItemRef)> = None;
        for (order, (item, f)) in functions.iter().enumerate() {
            let first_fits = match known.first() {
                Some((value, _)) => self.first_fits(f, value),
                None => 1,
            };
            if first_fits == 0 {
                continue;
            }
            let implied = usize::from(matches!(f.kind, FunctionKind::Warp | FunctionKind::Warp2));
            let takes = f.parameters.len() + implied;
            let needs = implied + f.parameters.iter().filter(|p| p.default.is_none()).count();
            let named = args.len() - args.iter().filter(|a| a.name.is_none()).count();
            let names_known = args
                .iter()
                .filter_map(|a| a.name.as_ref())
                .all(|n| f.parameters.iter().any(|p| p.name.text == n.text));
            let exact = positional <= takes && positional + named >= needs;
            let grouped = positional > takes
                && vector_parameter(f).is_some_and(|(_, n)| {
                    positional + 1 >= n && (needs..=takes).contains(&(positional + 1 - n))
                });
            let second_fits = match (&second, second_type(f)) {
                (Some(value), Some(ty)) => self.fits(value, ty),
                _ => true,
            };
            let score = 16 * u32::from(exact || grouped)
                + 8 * u32::from(second_fits)
                + 2 * u32::from(names_known)
                + first_fits.min(1)
                + if exact { first_fits } else { 0 };
            if best.is_none_or(|((s, _), _)| score > s) {
                best = Some(((score, order), *item));
            }
        }
        if best.is_none() {
            let found = known.first().map(|(v, _)| v.describe(self)).unwrap_or_default();
            let at = known.first().map_or(span, |(_, s)| *s);
            let name = functions.first().map(|(_, f)| f.name.text.clone()).unwrap_or_default();
            let wanted: Vec<String> = functions.iter().map(|(_, f)| signature(f)).collect();
            return Err(self.error(
                Code::TypeMismatch,
                at,
                format!("no `{name}` takes {found} first"),
                format!("there is {}", wanted.join(", ")),
            ));
        }
        Ok(best.map(|(_, item)| item))
    }

    /// How well a value fits the first parameter: 0 not, 1 by conversion, 2 as it is.
    fn first_fits(&self, f: &ast::Function, value: &Value) -> u32 {
        match f.kind {
            FunctionKind::Warp => match value {
                Value::Shape(id) if self.dimensions(*id) == 3 => 2,
                Value::Vector(v) if v.len() == 3 => 2,
                Value::Nothing => 1,
                _ => 0,
            },
            FunctionKind::Warp2 => match value {
                Value::Shape(id) if self.dimensions(*id) == 2 => 2,
                Value::Vector(v) if v.len() == 2 => 2,
                _ => 0,
            },
            _ => match f.parameters.first() {
                None => 0,
                Some(p) if f.kind == FunctionKind::Blend && is_operand(p) => match value {
                    Value::Shape(_) | Value::Nothing => 2,
                    Value::Number(..) => 1,
                    _ => 0,
                },
                Some(p) => match &p.ty {
                    Some((ty, _)) => match (self.fits(value, ty), value, ty) {
                        (false, ..) => 0,
                        (true, Value::Number(..), Type::Vec(_) | Type::Color) => 1,
                        (true, Value::Shape(_), Type::Float | Type::Field) => 1,
                        _ => 2,
                    },
                    None => match value {
                        Value::Shape(_) | Value::Nothing if f.kind == FunctionKind::Fn => 1,
                        _ => 2,
                    },
                },
            },
        }
    }

    fn call_function(
        &mut self,
        item: ItemRef,
        function: &ast::Function,
        mut known: Vec<(Value, Span)>,
        mut args: &[Argument],
        span: Span,
        env: &Env,
    ) -> Elaborated<Value> {
        let is_warp = matches!(function.kind, FunctionKind::Warp | FunctionKind::Warp2);
        let mut receiver = None;
        if is_warp {
            // The shape or the point stands first.
            if known.is_empty() {
                match args.split_first() {
                    Some((arg, rest)) if arg.name.is_none() => {
                        known.push((self.expression(&arg.value, env)?, arg.value.span));
                        args = rest;
                    }
                    _ => {
                        let name = &function.name.text;
                        return Err(self.error(
                            Code::MissingArgument,
                            span,
                            format!("`{name}` needs a shape, or a point"),
                            format!("write `s.{name}(…)`, or `{name}(q, …)` in a formula"),
                        ));
                    }
                }
            }
            receiver = Some(known.remove(0));
        } else if function.kind == FunctionKind::Blend
            && known.is_empty()
            && let Some((arg, rest)) = args.split_first()
            && arg.name.is_none()
        {
            known.push((self.expression(&arg.value, env)?, arg.value.span));
            args = rest;
        }
        // A formula makes a space of its own where it makes a shape; else it sees the caller's `p`.
        let own_space = |dimensions: u8, e: &mut Self| {
            let point = e.graph.point();
            env.at(Some(point.into_iter().take(usize::from(dimensions)).collect()))
        };
        let formula_env = match function.kind {
            FunctionKind::Field => own_space(3, self),
            FunctionKind::Field2 => own_space(2, self),
            FunctionKind::Warp | FunctionKind::Warp2 => match &receiver {
                Some((Value::Shape(id), _)) => own_space(self.dimensions(*id), self),
                _ => env.clone(),
            },
            FunctionKind::Blend => match known.first() {
                Some((Value::Shape(id), _)) => own_space(self.dimensions(*id), self),
                _ => env.clone(),
            },
            FunctionKind::Fn | FunctionKind::Shape | FunctionKind::Shape2 => env.clone(),
        };
        let bound =
            self.bind(&function.parameters, known, args, span, env, &formula_env, &function.name.text)?;
        self.apply(item, receiver.map(|(v, _)| v), bound, span, Some(env))
    }

    /// Runs `inside` for a declaration; where it is the prelude's and a user calls it, what goes wrong inside is reported at the call.
    fn for_user<T>(&mut self, item: ItemRef, call: Span, inside: impl FnOnce(&mut Self) -> T) -> T {
        let before = self.outside;
        if !self.modules.is_prelude(item.module) {
            self.outside = None;
        } else if !super::load::in_prelude(call) {
            self.outside = Some(call);
        }
        let result = inside(self);
        self.outside = before;
        result
    }

    /// A value for each parameter and where it stands, `None` where its default stands.
    #[allow(clippy::too_many_arguments)]
    fn bind(
        &mut self,
        parameters: &[Parameter],
        known: Vec<(Value, Span)>,
        args: &[Argument],
        span: Span,
        env: &Env,
        formula_env: &Env,
        name: &str,
    ) -> Elaborated<Vec<Option<Bound>>> {
        let mut positional: Vec<Given> = known.into_iter().map(|(v, s)| Given::Known(v, s)).collect();
        positional.extend(args.iter().filter(|a| a.name.is_none()).map(|a| Given::Written(&a.value)));
        let given = positional.len();
        if given > parameters.len()
            && let Some((at, n)) = vector_index(parameters)
            && given + 1 >= n
            && given + 1 - n <= parameters.len()
            && at + n <= given
        {
            // One vector's components are written out.
            let group: Vec<Given> = positional.drain(at..at + n).collect();
            let all_written = group.iter().all(|g| matches!(g, Given::Written(_)));
            let joined = if all_written {
                Given::Group(
                    group
                        .into_iter()
                        .filter_map(|g| if let Given::Written(e) = g { Some(e) } else { None })
                        .collect(),
                )
            } else {
                let mut values = Vec::new();
                for g in group {
                    match g {
                        Given::Known(v, _) => values.push(v),
                        Given::Written(e) => values.push(self.expression(e, env)?),
                        _ => {}
                    }
                }
                Given::KnownGroup(values, span)
            };
            positional.insert(at, joined);
        }
        let mut slots: Vec<Option<Given>> = parameters.iter().map(|_| None).collect();
        let mut failed = false;
        for (i, value) in positional.into_iter().enumerate() {
            match slots.get_mut(i) {
                Some(slot) => *slot = Some(value),
                None => {
                    let at = match value {
                        Given::Written(e) => e.span,
                        Given::Known(_, s) => s,
                        _ => span,
                    };
                    let takes = parameters.len();
                    let list: Vec<&str> = parameters.iter().map(|p| &*p.name.text).collect();
                    self.error(
                        Code::ExtraArgument,
                        at,
                        format!("`{name}` takes {takes} argument{}, and here are {given}", if takes == 1 { "" } else { "s" }),
                        if takes == 0 { format!("write `{name}`") } else { format!("write `{name}({})`", list.join(", ")) },
                    );
                    failed = true;
                    break;
                }
            }
        }
        for arg in args {
            let Some(label) = &arg.name else { continue };
            let Some(at) = parameters.iter().position(|p| p.name.text == label.text) else {
                let names: Vec<&str> = parameters.iter().map(|p| &*p.name.text).collect();
                let help = match nearest(&label.text, names.iter().copied()) {
                    Some(near) => format!("did you mean `{near}`?"),
                    None => format!("its arguments are {}", names.join(", ")),
                };
                self.error(
                    Code::UnknownArgument,
                    label.span,
                    format!("`{name}` has no argument named `{}`", label.text),
                    help,
                );
                failed = true;
                continue;
            };
            match slots.get_mut(at) {
                Some(slot @ None) => *slot = Some(Given::Written(&arg.value)),
                _ => {
                    self.error(
                        Code::UnknownArgument,
                        label.span,
                        format!("`{}` is given twice", label.text),
                        "leave one of the two out",
                    );
                    failed = true;
                }
            }
        }
        let mut bound = Vec::new();
        for (slot, parameter) in slots.into_iter().zip(parameters) {
            let is_field = matches!(parameter.ty, Some((Type::Field, _)));
            let place = if is_field { formula_env } else { env };
            let parts: Vec<Span> = match &slot {
                Some(Given::Written(Expr { kind: ExprKind::Vector(items), .. })) => {
                    items.iter().map(|i| i.span).collect()
                }
                Some(Given::Group(items)) => items.iter().map(|i| i.span).collect(),
                _ => Vec::new(),
            };
            let value = match slot {
                None if parameter.default.is_some() => {
                    bound.push(None);
                    continue;
                }
                None => {
                    if failed {
                        continue;
                    }
                    let wanted = parameter.ty.as_ref().map(|(t, _)| format!(", {}", type_words(t)));
                    self.error(
                        Code::MissingArgument,
                        span,
                        format!(
                            "`{name}` needs `{}`{}",
                            parameter.name.text,
                            wanted.unwrap_or_default()
                        ),
                        format!(
                            "write `{name}({})`",
                            parameters.iter().map(|p| &*p.name.text).collect::<Vec<_>>().join(", ")
                        ),
                    );
                    failed = true;
                    continue;
                }
                Some(Given::Known(value, at)) => Ok((value, at)),
                Some(Given::Written(expr)) => self.expression(expr, place).map(|v| (v, expr.span)),
                Some(Given::Group(exprs)) => {
                    let whole = match (exprs.first(), exprs.last()) {
                        (Some(a), Some(b)) => a.span.to(b.span),
                        _ => span,
                    };
                    let mut cells = Ok(Vec::new());
                    for e in exprs {
                        let cell = self
                            .expression(e, place)
                            .and_then(|v| self.to_number(&v, e.span, place));
                        match (&mut cells, cell) {
                            (Ok(cells), Ok(cell)) => cells.push(cell),
                            _ => cells = Err(Stop),
                        }
                    }
                    cells.map(|c| (Value::Vector(c.into()), whole))
                }
                Some(Given::KnownGroup(values, at)) => {
                    let cells: Elaborated<Vec<NodeId>> =
                        values.iter().map(|v| self.to_number(v, at, place)).collect();
                    cells.map(|c| (Value::Vector(c.into()), at))
                }
            };
            let at = value.as_ref().map_or(span, |(_, at)| *at);
            let typed = value.and_then(|(value, at)| match &parameter.ty {
                Some((ty, _)) => self.coerce(value, ty, at, place),
                None => match (&parameter.default, &value) {
                    // Without a type the default's kind is wanted.
                    (Some(default), Value::Text(_) | Value::Material(_) | Value::Bool(_) | Value::List(_)) => {
                        let kind = self.expression(default, &Env::top(env.module));
                        match kind {
                            Ok(k) if std::mem::discriminant(&k) != std::mem::discriminant(&value) => {
                                let (wanted, found) = (k.describe(self), value.describe(self));
                                Err(self.error(
                                    Code::TypeMismatch,
                                    at,
                                    format!("{wanted} is needed here, and this is {found}"),
                                    format!("write {wanted}"),
                                ))
                            }
                            _ => Ok(value),
                        }
                    }
                    _ => Ok(value),
                },
            });
            match typed {
                Ok(value) => bound.push(Some(Bound { value, span: at, parts })),
                Err(Stop) => failed = true,
            }
        }
        if failed { Err(Stop) } else { Ok(bound) }
    }

    /// Applies a declared function to values. `caller` is where the call stands, if it stands anywhere.
    pub fn apply(
        &mut self,
        item: ItemRef,
        receiver: Option<Value>,
        args: Vec<Option<Bound>>,
        span: Span,
        caller: Option<&Env>,
    ) -> Elaborated<Value> {
        self.called.insert(item);
        self.for_user(item, span, |e| e.apply_here(item, receiver, args, span, caller))
    }

    fn apply_here(
        &mut self,
        item: ItemRef,
        receiver: Option<Value>,
        args: Vec<Option<Bound>>,
        span: Span,
        caller: Option<&Env>,
    ) -> Elaborated<Value> {
        let modules = self.modules;
        let Some(declared) = modules.item(item) else { return Err(Stop) };
        let ItemKind::Function(function) = &declared.kind else { return Err(Stop) };
        if let Some(claim) = &function.claim
            && !modules.is_prelude(item.module)
        {
            self.error(
                Code::PreludeOnly,
                claim.span,
                "only the prelude can claim a constant",
                "leave it out: the compiler finds the constant of this formula by itself",
            );
        }
        self.step(span)?;
        // Defaults may use the parameters before them.
        let mut env = Env::top(item.module);
        let in_formula = caller.and_then(|c| c.point.clone());
        let shape_operand = |b: &Bound| matches!(b.value, Value::Shape(_) | Value::Nothing);
        let operand_count = function.parameters.iter().take_while(|p| is_operand(p)).count();
        let any_shape = args.iter().take(operand_count).flatten().any(shape_operand);
        let dimensions = match function.kind {
            FunctionKind::Field | FunctionKind::Warp | FunctionKind::Shape | FunctionKind::Fn => 3,
            FunctionKind::Field2 | FunctionKind::Warp2 | FunctionKind::Shape2 => 2,
            FunctionKind::Blend => args
                .iter()
                .take(operand_count)
                .flatten()
                .find_map(|b| if let Value::Shape(id) = b.value { Some(self.dimensions(id)) } else { None })
                .unwrap_or(3),
        };
        let leaf_point: NodeList = {
            let point = self.graph.point();
            point.into_iter().take(usize::from(dimensions)).collect()
        };
        let point: Option<NodeList> = match function.kind {
            FunctionKind::Field | FunctionKind::Field2 => Some(leaf_point.clone()),
            FunctionKind::Warp | FunctionKind::Warp2 => match &receiver {
                Some(Value::Vector(v)) => Some(v.clone()),
                _ => Some(leaf_point.clone()),
            },
            FunctionKind::Blend if any_shape => Some(leaf_point.clone()),
            FunctionKind::Blend => in_formula.clone(),
            FunctionKind::Fn | FunctionKind::Shape | FunctionKind::Shape2 => None,
        };
        let mut values = Vec::new();
        let mut places = Vec::new();
        for (parameter, arg) in function.parameters.iter().zip(args) {
            places.push(match &arg {
                Some(bound) => (bound.span, bound.parts.clone()),
                None => (span, Vec::new()),
            });
            let value = match (arg, &parameter.default) {
                (Some(bound), _) => bound.value,
                (None, Some(default)) => {
                    let is_field = matches!(parameter.ty, Some((Type::Field, _)));
                    let place = if is_field { env.at(point.clone()) } else { env.clone() };
                    let value = self.expression(default, &place)?;
                    match &parameter.ty {
                        Some((ty, _)) => self.coerce(value, ty, default.span, &place)?,
                        None => value,
                    }
                }
                (None, None) => return Err(Stop),
            };
            values.push(value.clone());
            env = env.and(&parameter.name.text, value);
        }
        for (at, kept) in self.require(item, function, &values, &places)? {
            if let (Some(parameter), Some(value)) = (function.parameters.get(at), values.get_mut(at)) {
                *value = kept.clone();
                env = env.and(&parameter.name.text, kept);
            }
        }
        // Outside of formulas a number among shapes has no point at which it would be one of them.
        if function.kind == FunctionKind::Blend && any_shape && in_formula.is_none() && caller.is_some() {
            let number = values.iter().take(operand_count).position(|v| matches!(v, Value::Number(..)));
            if let Some(i) = number {
                let at = places.get(i).map_or(span, |(at, _)| *at);
                let found = values.get(i).map(|v| v.describe(self)).unwrap_or_default();
                return Err(self.error(
                    Code::TypeMismatch,
                    at,
                    format!("a shape is needed here, and this is {found}"),
                    "declare the formula with `field`, and write its name here",
                ));
            }
        }
        // The value depends on the arguments alone, unless it is a formula over the caller's point.
        let memo_key = (function.kind != FunctionKind::Blend || any_shape)
            .then(|| (item, receiver.clone(), values.clone()));
        if let Some(key) = &memo_key
            && let Some(value) = self.memo.get(key)
        {
            return Ok(value.clone());
        }
        // In a formula an argument may vary with `p`; then the formula stands there itself, not a shape.
        let varies = in_formula.is_some()
            && matches!(function.kind, FunctionKind::Field | FunctionKind::Field2)
            && function.parameters.iter().zip(&values).any(|(p, v)| {
                !matches!(p.ty, Some((Type::Field, _))) && self.value_depends_on_point(v)
            });
        let value = self.deeper(span, |e| match function.kind {
            FunctionKind::Fn => {
                let value = e.expression(&function.body, &env)?;
                let value = e.claimed_value(value, function, &values, &env);
                e.hint(&value, &function.name.text);
                Ok(value)
            }
            FunctionKind::Shape | FunctionKind::Shape2 => {
                let value = e.expression(&function.body, &env)?;
                let id = e.to_shape(&value, dimensions, function.body.span)?;
                Ok(Value::Shape(if modules.is_prelude(item.module) {
                    id
                } else {
                    e.name_shape(id, &function.name.text, function.name.span)
                }))
            }
            FunctionKind::Field | FunctionKind::Field2 if varies => {
                let here = env.at(in_formula.clone());
                let value = e.expression(&function.body, &here)?;
                let node = e.to_number(&value, function.body.span, &here)?;
                e.hint(&Value::number(node), &function.name.text);
                Ok(Value::number(node))
            }
            FunctionKind::Field | FunctionKind::Field2 => {
                let here = env.at(point.clone());
                let value = e.expression(&function.body, &here)?;
                let node = e.to_number(&value, function.body.span, &here)?;
                let node = e.claimed(node, function, &values, &env);
                let exact = matches!(&function.claim, Some(c) if c.kind == ClaimKind::Exact);
                let name = (!modules.is_prelude(item.module)).then(|| function.name.text.clone());
                Ok(Value::Shape(e.formula_shape(node, dimensions, name, exact, span)))
            }
            FunctionKind::Warp | FunctionKind::Warp2 => {
                e.apply_warp(function, receiver.clone(), &env, point.clone(), span)
            }
            FunctionKind::Blend if any_shape => {
                let mut here = env.at(point.clone());
                let mut numbers = values.clone();
                for (parameter, value) in function.parameters.iter().zip(numbers.iter_mut()).take(operand_count) {
                    let number = e.to_number(value, span, &here)?;
                    *value = Value::number(number);
                    here = here.and(&parameter.name.text, value.clone());
                }
                let value = e.expression(&function.body, &here)?;
                let node = e.to_number(&value, function.body.span, &here)?;
                let node = e.claimed(node, function, &numbers, &here);
                Ok(Value::Shape(e.formula_shape(node, dimensions, None, false, span)))
            }
            FunctionKind::Blend => {
                let here = env.at(point.clone());
                let value = e.expression(&function.body, &here)?;
                let value = Value::number(e.to_number(&value, function.body.span, &here)?);
                Ok(e.claimed_value(value, function, &values, &here))
            }
        })?;
        if let (Some(key), false) = (memo_key, varies) {
            self.memo.insert(key, value.clone());
        }
        Ok(value)
    }

    fn apply_warp(
        &mut self,
        function: &ast::Function,
        receiver: Option<Value>,
        env: &Env,
        point: Option<NodeList>,
        span: Span,
    ) -> Elaborated<Value> {
        let n = if function.kind == FunctionKind::Warp { 3 } else { 2 };
        let here = env.at(point);
        let name = &function.name.text;
        let moved = self.expression(&function.body, &here)?;
        let moved = self.to_vector(&moved, n, function.body.span)?;
        match receiver {
            Some(Value::Vector(_)) => Ok(Value::Vector(moved)),
            Some(Value::Nothing) => Ok(Value::Nothing),
            Some(Value::Shape(id)) if usize::from(self.dimensions(id)) == n => {
                let at = self.fit_point(&moved, id, span)?;
                let value = self.graph.field(id, at);
                self.locate(value, span);
                Ok(Value::Shape(self.make_shape(n as u8, value, span)))
            }
            Some(other) => {
                let found = other.describe(self);
                Err(self.error(
                    Code::TypeMismatch,
                    span,
                    format!("`{name}` moves points of {n} dimensions, and this is {found}"),
                    if n == 3 { "write a shape before the dot" } else { "write a drawing before the dot" },
                ))
            }
            None => Err(Stop),
        }
    }

    fn value_depends_on_point(&self, value: &Value) -> bool {
        match value {
            Value::Number(n, _) | Value::Bool(n) => self.graph.reads_point(*n),
            Value::Vector(v) | Value::Matrix(_, v) => v.iter().any(|n| self.graph.reads_point(*n)),
            Value::List(items) => items.iter().any(|i| self.value_depends_on_point(i)),
            _ => false,
        }
    }

    fn claimed_value(
        &mut self,
        value: Value,
        function: &ast::Function,
        args: &[Value],
        env: &Env,
    ) -> Value {
        match value {
            Value::Number(node, whole) if function.claim.is_some() => {
                Value::Number(self.claimed(node, function, args, env), whole)
            }
            other => other,
        }
    }

    /// A value with what its declaration claims of it.
    fn claimed(&mut self, node: NodeId, function: &ast::Function, args: &[Value], env: &Env) -> NodeId {
        let Some(claim) = &function.claim else { return node };
        if self.graph.as_constant(node).is_some() {
            return node;
        }
        let mut nodes = vec![node];
        let mut groups = Vec::new();
        let mut claim_env = Env::top(env.module);
        let one = self.graph.constant(1.0);
        let formula = match &claim.kind {
            ClaimKind::Exact => one,
            ClaimKind::Lipschitz(formula) => {
                for (i, (parameter, value)) in function.parameters.iter().zip(args).enumerate() {
                    let before = nodes.len();
                    groups.push(match value {
                        Value::Number(n, _) => {
                            nodes.push(*n);
                            ClaimGroup::Vector(1)
                        }
                        Value::Vector(v) => {
                            nodes.extend(v.iter().copied());
                            ClaimGroup::Vector(v.len() as u8)
                        }
                        Value::Shape(id) => {
                            let calls = self.calls_of(node, *id);
                            nodes.extend(calls);
                            ClaimGroup::Values((nodes.len() - before) as u32)
                        }
                        _ => ClaimGroup::Values(0),
                    });
                    let constant = self.graph.leaf(Leaf::Variable(i as u32));
                    claim_env = claim_env.and(&parameter.name.text, Value::number(constant));
                    let name = format!("value:{}", parameter.name.text).into();
                    claim_env = claim_env.and(&name, value.clone());
                }
                match self.expression(formula, &claim_env) {
                    Ok(Value::Number(formula, _)) => formula,
                    _ => return node,
                }
            }
        };
        if matches!(claim.kind, ClaimKind::Exact) {
            // The shape itself says that it is exact.
            return node;
        }
        self.graph.intern(Node::Claim(nodes.into(), Claim::Lipschitz(formula, groups.into())))
    }

    fn calls_of(&self, node: NodeId, shape: ShapeId) -> Vec<NodeId> {
        self.graph
            .reachable(&[node])
            .into_iter()
            .filter(|&id| {
                matches!(self.graph.node(id), Node::Call(s, Function::Field, _) if *s == shape)
            })
            .collect()
    }

    /// Reports constant arguments that the documentation rules out. Answers what becomes of those that are not constant and might be ruled
    /// out at some values, by the index of their parameter: they are kept within what is allowed.
    fn require(
        &mut self,
        item: ItemRef,
        function: &ast::Function,
        values: &[Value],
        places: &[(Span, Vec<Span>)],
    ) -> Elaborated<Vec<(usize, Value)>> {
        let mut kept = Vec::new();
        if !self.modules.is_prelude(item.module) {
            return Ok(kept);
        }
        let requirements = match self.requirements.get(&item) {
            Some(known) => known.clone(),
            None => {
                let doc = self.modules.item(item).and_then(|i| i.doc.as_deref()).unwrap_or("");
                let parsed: Rc<[Requirement]> = parse_requirements(doc).into();
                self.requirements.insert(item, parsed.clone());
                parsed
            }
        };
        for requirement in requirements.iter() {
            let (wanted, of_count) = match requirement.parameter.strip_suffix(".count") {
                Some(list) => (list, true),
                None => (requirement.parameter.as_str(), false),
            };
            let Some(at) = function.parameters.iter().position(|p| *p.name.text == *wanted) else {
                continue;
            };
            let Some((span, parts)) = places.get(at) else { continue };
            let nodes: Vec<NodeId> = match values.get(at) {
                Some(Value::Number(n, _)) => vec![*n],
                Some(Value::Vector(v)) => v.to_vec(),
                Some(Value::List(items)) if of_count => {
                    vec![self.graph.constant(items.len() as f64)]
                }
                _ => continue,
            };
            // A vector that may not be zero may have components that are.
            let constants: Vec<f64> =
                nodes.iter().filter_map(|n| self.graph.as_constant(*n)).collect();
            let holds = |c: f64| match requirement.relation.as_str() {
                ">=" => c >= requirement.bound,
                ">" => c > requirement.bound,
                "<=" => c <= requirement.bound,
                "<" => c < requirement.bound,
                "!=" => c != requirement.bound,
                _ => true,
            };
            let broken = if requirement.relation == "!=" {
                constants.len() == nodes.len() && !constants.iter().any(|&c| holds(c))
            } else {
                constants.iter().any(|&c| !holds(c))
            };
            if broken {
                let bad = constants.iter().copied().find(|&c| !holds(c)).unwrap_or(0.0);
                let part = if requirement.relation != "!=" && parts.len() == nodes.len() {
                    let bad = |n: &NodeId| self.graph.as_constant(*n).is_some_and(|c| !holds(c));
                    nodes.iter().position(bad).and_then(|i| parts.get(i))
                } else {
                    None
                };
                let span = *part.unwrap_or(span);
                let (name, parameter) = (&function.name.text, &requirement.parameter);
                return Err(self.error(
                    Code::BadValue,
                    span,
                    format!("the `{parameter}` of `{name}` is {bad}"),
                    format!(
                        "write one that is {} {}",
                        match requirement.relation.as_str() {
                            ">=" => "at least",
                            ">" => "greater than",
                            "<=" => "at most",
                            "<" => "less than",
                            _ => "other than",
                        },
                        requirement.bound
                    ),
                ));
            }
            let limit = match requirement.relation.as_str() {
                ">=" => (Op::Max, requirement.bound),
                ">" => (Op::Max, requirement.bound + LEAST),
                "<=" => (Op::Min, requirement.bound),
                "<" => (Op::Min, requirement.bound - LEAST),
                _ => continue,
            };
            let within: Vec<NodeId> = nodes.iter().map(|n| self.keep_within(*n, limit)).collect();
            if within != nodes {
                kept.extend(match (values.get(at), within.first()) {
                    (Some(Value::Number(_, kind)), Some(n)) => Some((at, Value::Number(*n, *kind))),
                    (Some(Value::Vector(_)), _) => Some((at, Value::Vector(within.into()))),
                    _ => None,
                });
            }
        }
        Ok(kept)
    }

    /// A number that is not constant, kept on one side of a limit: `Max` keeps it at or above.
    fn keep_within(&mut self, node: NodeId, (op, limit): (Op, f64)) -> NodeId {
        let range = self.facts.live_range(&self.graph, node);
        let inside = if op == Op::Max { range.lo >= limit } else { range.hi <= limit };
        if inside || self.graph.as_constant(node).is_some() {
            return node;
        }
        let limit = self.graph.constant(limit);
        self.graph.op(op, &[node, limit])
    }

    /// A material of a declaration and its arguments.
    pub fn make_material(
        &mut self,
        item: ItemRef,
        args: &[Option<Value>],
        span: Span,
    ) -> Elaborated<MaterialId> {
        self.called.insert(item);
        self.for_user(item, span, |e| e.deeper(span, |e| e.material_of(item, args, span)))
    }

    fn material_of(
        &mut self,
        item: ItemRef,
        args: &[Option<Value>],
        span: Span,
    ) -> Elaborated<MaterialId> {
        let modules = self.modules;
        let Some(declared) = modules.item(item) else { return Err(Stop) };
        let ItemKind::Material { name, parameters, lets, entries } = &declared.kind else {
            return Err(Stop);
        };
        let mut env = Env::top(item.module);
        for (i, parameter) in parameters.iter().enumerate() {
            let value = match (args.get(i).cloned().flatten(), &parameter.default) {
                (Some(value), _) => value,
                (None, Some(default)) => {
                    let value = self.expression(default, &env)?;
                    match &parameter.ty {
                        Some((ty, _)) => self.coerce(value, ty, default.span, &env)?,
                        None => value,
                    }
                }
                (None, None) => {
                    return Err(self.error(
                        Code::MissingArgument,
                        span,
                        format!("`{}` needs `{}`", name.text, parameter.name.text),
                        format!("write `{}(…)` with it", name.text),
                    ));
                }
            };
            env = env.and(&parameter.name.text, value);
        }
        let point = self.graph.point();
        env = Env { point: Some(point.into()), normal: true, ..env };
        let env = self.bind_lets(lets, &env)?;
        let default = self.default_material();
        let Some(mut material) = self.graph.materials.get(default.0 as usize).cloned() else {
            return Err(Stop);
        };
        material.name = name.text.clone();
        const KEYS: [&str; 11] = [
            "color", "roughness", "metallic", "reflectivity", "emission", "bump", "bump_height", "texture",
            "texture_scale", "texture_sharpness", "solid",
        ];
        let mut texture = Texture::new(self);
        let mut failed = false;
        for entry in entries {
            let key = &*entry.key.text;
            if !KEYS.contains(&key) {
                let help = match nearest(key, KEYS) {
                    Some(near) => format!("did you mean `{near}`?"),
                    None => format!("the keys of a material are {}", KEYS.join(", ")),
                };
                self.error(
                    Code::UnknownKey,
                    entry.key.span,
                    format!("a material has no `{key}`"),
                    help,
                );
                failed = true;
                continue;
            }
            let Ok(value) = self.expression(&entry.value, &env) else {
                failed = true;
                continue;
            };
            let at = entry.value.span;
            if texture.takes(key, &value) {
                failed |= texture.put(self, key, value, at, &env).is_err();
                continue;
            }
            let done = match key {
                "color" | "emission" => self.coerce(value, &Type::Color, at, &env).map(|v| {
                    if let Value::Vector(v) = v
                        && let [r, g, b] = *v
                    {
                        if key == "color" {
                            material.color = [r, g, b];
                        } else {
                            material.emission = [r, g, b];
                        }
                    }
                }),
                "roughness" | "metallic" | "reflectivity" => {
                    self.to_number(&value, at, &env).and_then(|n| {
                        if let Some(c) = self.graph.as_constant(n)
                            && !(0.0..=1.0).contains(&c)
                        {
                            return Err(self.error(
                                Code::BadValue,
                                at,
                                format!("`{key}` is {c}"),
                                "write a number from 0 to 1",
                            ));
                        }
                        match key {
                            "roughness" => material.roughness = n,
                            "metallic" => material.metallic = n,
                            _ => material.reflectivity = n,
                        }
                        Ok(())
                    })
                }
                "solid" => self.coerce(value, &Type::Bool, at, &env).and_then(|v| {
                    if let Value::Bool(node) = v {
                        match self.graph.as_constant(node) {
                            Some(c) => material.solid = c != 0.0,
                            None => {
                                return Err(self.error(
                                    Code::NotConstant,
                                    at,
                                    "`solid` must be known while compiling",
                                    "write `on` or `off`",
                                ));
                            }
                        }
                    }
                    Ok(())
                }),
                _ => texture.put(self, key, value, at, &env),
            };
            failed |= done.is_err();
        }
        if failed {
            return Err(Stop);
        }
        texture.lay_on(self, &mut material);
        Ok(self.graph.add_material(material))
    }

    /// What a shape without a material looks like.
    pub fn default_material(&mut self) -> MaterialId {
        let grey = self.graph.constant(0.55);
        let zero = self.graph.constant(0.0);
        let roughness = self.graph.constant(0.6);
        self.graph.add_material(Material {
            name: "default".into(),
            color: [grey; 3],
            emission: [zero; 3],
            roughness,
            metallic: zero,
            reflectivity: zero,
            relief: None,
            images: Arc::default(),
            solid: true,
        })
    }

    /// A shape with a material, or painted with one where `mask` is negative.
    pub fn with_material(
        &mut self,
        shape: ShapeId,
        mask: Option<ShapeId>,
        material: MaterialId,
        span: Span,
    ) -> Value {
        let dimensions = self.dimensions(shape);
        let point = self.graph.point();
        let value = self.graph.field(shape, point);
        let (own, paints) = match mask {
            None => (Some(material), Arc::default()),
            Some(mask) => (None, [(mask, material)].into()),
        };
        Value::Shape(self.graph.add_shape(Shape {
            name: None,
            dimensions,
            value,
            variables: Arc::default(),
            exactness: Exactness::Formula,
            material: own,
            paints,
            span: self.place(span),
        }))
    }
}

fn declared_name(item: &ast::Item) -> String {
    super::load::item_name(item).map(|n| n.text.to_string()).unwrap_or_default()
}

/// Whether a parameter of a blend is one of the distances that it combines.
pub fn is_operand(p: &Parameter) -> bool {
    p.ty.is_none() && p.default.is_none() && matches!(&*p.name.text, "a" | "b" | "c" | "d")
}

/// The one parameter that is a vector, and its number of components.
fn vector_index(parameters: &[Parameter]) -> Option<(usize, usize)> {
    let mut found = None;
    for (i, p) in parameters.iter().enumerate() {
        let n = match &p.ty {
            Some((Type::Vec(n), _)) => usize::from(*n),
            Some((Type::Color, _)) => 3,
            _ => continue,
        };
        if found.is_some() {
            return None;
        }
        found = Some((i, n));
    }
    found
}

fn vector_parameter(f: &ast::Function) -> Option<(usize, usize)> {
    vector_index(&f.parameters)
}

/// The declared type of what stands second in a call.
fn second_type(f: &ast::Function) -> Option<&Type> {
    let implied = usize::from(!matches!(f.kind, FunctionKind::Warp | FunctionKind::Warp2));
    f.parameters.get(implied).and_then(|p| p.ty.as_ref()).map(|(t, _)| t)
}

/// `box(size)`, as advice.
fn signature(f: &ast::Function) -> String {
    let names: Vec<&str> = f.parameters.iter().map(|p| &*p.name.text).collect();
    format!("{} {}({})", kind_words(f.kind), f.name.text, names.join(", "))
}

/// The conditions of `Requires: radius >= 0, height > 0`.
pub fn parse_requirements(doc: &str) -> Vec<Requirement> {
    let mut all = Vec::new();
    for line in doc.lines() {
        let Some(list) = line.trim().strip_prefix("Requires:") else { continue };
        for part in list.split(',') {
            let words: Vec<&str> = part.split_whitespace().collect();
            if let [parameter, relation, bound] = *words
                && let Ok(bound) = bound.trim_end_matches('.').parse::<f64>()
            {
                all.push(Requirement {
                    parameter: parameter.to_owned(),
                    relation: relation.to_owned(),
                    bound,
                });
            }
        }
    }
    all
}
