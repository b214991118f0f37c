//! Calls: what is called, by a name, through an import or after a dot.

use super::bind::written_out;
use super::many::joins_two;
use super::builtin::is_function;
use super::elsewhere::{color, instead, ours};
use super::load::{is_of_prelude, ItemRef, Resolution};
use super::overload::at_a_point;
use super::value::Value;
use super::{Elaborated, Elaborator, Env, Stop};
use crate::diagnostic::{Code, Diagnostic};
use crate::graph::NodeId;
use crate::graph::kernel::KERNEL;
use crate::source::Span;
use crate::syntax::ast::{self, Argument, Expr, ExprKind, FunctionKind, ItemKind, Name};
use crate::syntax::words::{DECLARATIONS, nearest};

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
                    None => Err(self.unknown_name(alias_name, false, alias.span, env)),
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
        let near = nearest(&name.text, candidates.iter().copied());
        let help = match near {
            Some(near) => format!("did you mean `{alias}.{near}`?"),
            None => format!("`{}` declares: {}", modules.path(module), candidates.join(", ")),
        };
        let message = format!("`{}` declares no `{}`", modules.path(module), name.text);
        self.report(Diagnostic::new(Code::UnknownMember, name.span, message, help).write_if(name.span, near))
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
                let names = super::builtin::argument_names(name, args.len());
                let first = match (known.first(), args.first()) {
                    (Some((value, _)), _) => value.clone(),
                    (None, Some(arg)) if arg.name.is_none() => {
                        self.expression(&arg.value, env)?
                    }
                    (None, Some(_)) if args.iter().all(|a| a.name.as_ref().is_some_and(|n| names.contains(&&*n.text))) => {
                        return self.call_built_in(name, known, args, span, env);
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
                // `round(d, 0.1)` of a distance is what it is of a shape.
                let too_many = KERNEL.iter().any(|row| row.name == name && known.len() + args.len() > usize::from(row.arity));
                if matches!(first, Value::Shape(_) | Value::Nothing) || too_many {
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
                let told = self.filled_in(name, &known, args, env);
                match known.first().cloned() {
                    _ if let Some(help) = told && !self.is_known(Code::UnknownName, at) => {
                        Err(self.error(Code::UnknownName, at, format!("nothing is named `{name}`"), help))
                    }
                    Some((receiver, _)) => Err(self.unknown_method(&receiver, name, at, env)),
                    None if super::builtin::NAMES.contains(&name) => Err(self.error(
                        Code::TypeMismatch,
                        at,
                        format!("`{name}` is no function, so it can't be called"),
                        format!("write `{name}` alone"),
                    )),
                    None => Err(self.unknown_name(name, true, at, env)),
                }
            }
        }
    }

    /// Whether a name is a function's: built in, of the prelude or declared.
    fn is_called(&self, name: &str, env: &Env) -> bool {
        let is_function = |item: &ItemRef| matches!(self.modules.item(*item).map(|i| &i.kind), Some(ItemKind::Function(_)));
        match self.modules.resolve(env.module, name) {
            Resolution::Items(items) => items.iter().any(is_function),
            _ => super::builtin::is_function(name),
        }
    }

    fn unknown_method(&mut self, receiver: &Value, name: &str, at: Span, env: &Env) -> Stop {
        if self.modules.lacks(env.module, name) {
            return Stop;
        }
        let found = receiver.describe(&self.graph);
        let candidates: Vec<&str> = self
            .modules
            .visible(env.module)
            .into_iter()
            .chain(super::builtin::FUNCTIONS.iter().copied())
            .collect();
        let mut meant = None;
        let help = match ours(name, &candidates).or_else(|| nearest(name, candidates)) {
            _ if let Some(instead) = instead(name) => instead.to_owned(),
            _ if let (Value::Shape(_), Some(color)) = (receiver, color(name)) => format!("write `.material(swatch({color}))`"),
            Some(near) => {
                meant = Some(near.to_owned());
                format!("did you mean `.{near}(…)`?")
            }
            None => "any `shape`, `warp` or `blend` that takes this first can stand after the dot".into(),
        };
        let message = format!("{found} has no `{name}`");
        self.report(Diagnostic::new(Code::UnknownMember, at, message, help).write_if(at, meant))
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
            && let Some(value) = env.argument(of)
        {
            return Ok(value.clone());
        }
        if name == "shader" {
            return self.shader(args, span, env);
        }
        let names = super::builtin::argument_names(name, known.len() + args.len());
        let mut values: Vec<Option<(Value, Span)>> = known.into_iter().map(Some).collect();
        let mut failed = false;
        for arg in args.iter().filter(|a| a.name.is_none()).chain(args.iter().filter(|a| a.name.is_some())) {
            let place = match &arg.name {
                None => Some(values.len()),
                Some(label) => {
                    let place = names.iter().position(|n| *n == &*label.text).filter(|&i| !matches!(values.get(i), Some(Some(_))));
                    if place.is_none() {
                        let help = match names {
                            [] => "leave the name out".to_owned(),
                            names => format!("write `{name}({})`, or leave the name out", names.join(", ")),
                        };
                        let what = if names.contains(&&*label.text) {
                            format!("`{}` has a value already", label.text)
                        } else {
                            format!("`{name}` has no argument named `{}`", label.text)
                        };
                        self.error(Code::UnknownArgument, label.span, what, help);
                        failed = true;
                    }
                    place
                }
            };
            match (self.expression(&arg.value, env), place) {
                (Ok(value), Some(place)) => {
                    values.resize(values.len().max(place + 1), None);
                    if let Some(slot) = values.get_mut(place) {
                        *slot = Some((value, arg.value.span));
                    }
                }
                _ => failed = true,
            }
        }
        if failed {
            return Err(Stop);
        }
        for (at, default) in super::builtin::defaults(name).iter().enumerate() {
            values.resize(values.len().max(at + 1), None);
            if let (Some(slot @ None), Some(default)) = (values.get_mut(at), default) {
                let value = match default {
                    super::builtin::Usual::Number(number) => self.constant(*number),
                    super::builtin::Usual::Words(words) => Value::Text((*words).into()),
                };
                *slot = Some((value, span));
            }
        }
        // A place that is left out shows as too few.
        let values: Vec<(Value, Span)> = values.into_iter().map_while(|value| value).collect();
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
            let message = format!("`{axis}` is the unit vector along {axis}, so `{axis}.{}` is a constant", name.text);
            let help = format!("write `p.{}` for the point's coordinate", name.text);
            return Err(self.report(Diagnostic::new(Code::UnknownMember, span, message, help).write(span, format!("p.{}", name.text))));
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
            if let (Value::Curve(line), "length") = (&value, &*name.text) {
                let length = line.length();
                return Ok(self.constant(length));
            }
            if let (Value::List(_), "length" | "len" | "size") = (&value, &*name.text) {
                let message = format!("a list has no `{}`", name.text);
                let said = Diagnostic::new(Code::UnknownMember, name.span, message, "write `.count`, how many it has");
                return Err(self.report(said.write(name.span, "count")));
            }
            if let Value::Number(..) | Value::Bool(_) | Value::Text(_) | Value::Matrix(..) = &value
                && !self.is_called(&name.text, env)
            {
                let found = value.describe(&self.graph);
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

    pub(super) fn call_items_with(
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
            ItemKind::Function(function) if joins_two(function) && known.len() < 2 => self.join_all(item, function, known, args, span, env),
            ItemKind::Function(function) => self.call_function(item, function, known, args, span, env),
            ItemKind::Material { parameters, .. } => {
                let name = declared_name(declared);
                let hides = is_of_prelude(&name) || is_function(&name);
                if parameters.is_empty() && !hides && !(known.is_empty() && args.is_empty()) {
                    return Err(self.error(Code::TypeMismatch, span, format!("`{name}` is a material that takes nothing"), format!("write `.material({name})` behind a shape")));
                }
                let bound = self.bind(parameters, known, args, span, env, &env.clone(), &name)?;
                let bound: Vec<Option<Value>> = bound.into_iter().map(|b| b.map(|b| b.value)).collect();
                self.make_material(item, &bound, span).map(Value::Material)
            }
            _ => {
                let value = self.item_value(&[item], span, env)?;
                let name = declared_name(declared);
                // That no value is called so is said where it is declared.
                if DECLARATIONS.contains(&&*name) {
                    return Err(Stop);
                }
                let found = value.describe(&self.graph);
                let is_ours = modules.visible(modules.prelude()).contains(&&*name) || is_function(&name);
                let hides = !modules.is_prelude(item.module) && is_ours;
                let help = match hides {
                    true => format!("it hides the `{name}` of the language: give it another name"),
                    false => format!("write `{name}` alone"),
                };
                Err(self.error(Code::TypeMismatch, span, format!("`{name}` is {found}, so it can't be called"), help))
            }
        }
    }

    pub(super) fn call_function(
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
                Some((Value::Shape(id), _)) => own_space(self.graph.dimensions(*id), self),
                _ => env.clone(),
            },
            FunctionKind::Blend => match known.first() {
                Some((Value::Shape(id), _)) => own_space(self.graph.dimensions(*id), self),
                _ => env.clone(),
            },
            FunctionKind::Fn | FunctionKind::Shape | FunctionKind::Shape2 => env.clone(),
        };
        let sees_point = matches!(function.kind, FunctionKind::Field | FunctionKind::Field2);
        if sees_point && known.is_empty() && args.is_empty() && function.parameters.first().is_some_and(|p| &*p.name.text == "p") {
            let name = &function.name.text;
            return Err(self.error(
                Code::MissingArgument,
                span,
                format!("`{name}` is said to take `p`, and sees it anyway"),
                format!("take `p` out where it is declared: `{} {name} = …`", if function.kind == FunctionKind::Field { "field" } else { "field2" }),
            ));
        }
        self.takes_no_point(function, &known, args, env)?;
        let bound =
            self.bind(&function.parameters, known, args, span, env, &formula_env, &function.name.text)?;
        self.apply(item, receiver.map(|(v, _)| v), bound, span, Some(env))
    }

    /// Who comes from GLSL gives a shape the point first.
    fn takes_no_point(&mut self, function: &ast::Function, known: &[(Value, Span)], args: &[Argument], env: &Env) -> Elaborated<()> {
        let makes_shape = matches!(function.kind, FunctionKind::Shape | FunctionKind::Shape2 | FunctionKind::Field | FunctionKind::Field2);
        let written: Vec<&Argument> = args.iter().filter(|a| a.name.is_none()).collect();
        let given = known.len() + written.len();
        let is_one_too_many = given > function.parameters.len() && written_out(&function.parameters, args, given).is_none();
        if !makes_shape || env.point.is_none() || !is_one_too_many {
            return Ok(());
        }
        let (first, at) = match (known.first(), written.first()) {
            (Some((value, at)), _) => (value.clone(), *at),
            (None, Some(arg)) => (self.expression(&arg.value, env)?, arg.value.span),
            (None, None) => return Ok(()),
        };
        // A vector of numbers may be a size.
        let Value::Vector(parts) = first else { return Ok(()) };
        if parts.iter().all(|part| self.graph.as_constant(*part).is_some()) {
            return Ok(());
        }
        let name = &function.name.text;
        Err(self.error(Code::TypeMismatch, at, format!("`{name}` takes no point"), at_a_point(function)))
    }

    /// Runs `inside` for a declaration; where it comes with the language and a user calls it, what goes wrong inside is reported at the call.
    pub(super) fn for_user<T>(&mut self, item: ItemRef, call: Span, inside: impl FnOnce(&mut Self) -> T) -> T {
        let before = self.outside;
        if !self.modules.comes_along(item.module) {
            self.outside = None;
        } else if !crate::prelude::in_prelude(call) {
            self.outside = Some(call);
        }
        let result = inside(self);
        self.outside = before;
        result
    }
}

fn declared_name(item: &ast::Item) -> String {
    super::load::item_name(item).map(|n| n.text.to_string()).unwrap_or_default()
}
