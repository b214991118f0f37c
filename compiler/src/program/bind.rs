//! How arguments meet parameters: by place or name, one by one or a vector at once, and within what the documentation requires.

use crate::program::apply::is_operand;
use crate::program::blocks::short;
use crate::program::builtin::is_function;
use crate::program::load::{ItemRef, Modules, is_of_prelude, prelude_items};
use crate::program::value::{Bound, Value, points, type_words};
use crate::program::{Elaborated, Elaborator, Env, Stop};
use crate::prelude::{in_prelude, is_of_numbers};
use crate::diagnostic::{Code, Diagnostic};
use crate::graph::kernel::Op;
use crate::graph::{NodeId, ShapeId};
use crate::source::Span;
use crate::syntax::ast::{self, Argument, Expr, ExprKind, FunctionKind, ItemKind, Parameter, Type, UnaryOp};
use crate::syntax::words::nearest;
use smallvec::{SmallVec, smallvec};
use std::sync::LazyLock;

/// A condition on an argument, from a `Requires:` line of the documentation of an item of the prelude or of a part.
#[derive(Clone, Debug)]
pub struct Requirement {
    pub(super) parameter: String,
    relation: String,
    bound: f64,
}

impl Requirement {
    /// Whether a number meets it.
    pub(super) fn holds(&self, c: f64) -> bool {
        match self.relation.as_str() {
            ">=" => c >= self.bound,
            ">" => c > self.bound,
            "<=" => c <= self.bound,
            "<" => c < self.bound,
            "!=" => c != self.bound,
            _ => true,
        }
    }

    /// `at least 0`.
    pub(super) fn words(&self) -> String {
        let relation = match self.relation.as_str() {
            ">=" => "at least",
            ">" => "greater than",
            "<=" => "at most",
            "<" => "less than",
            _ => "other than",
        };
        format!("{relation} {}", self.bound)
    }
}

/// The conditions of each item of the prelude, read once as its texts are.
static REQUIREMENTS: LazyLock<Vec<Vec<Requirement>>> = LazyLock::new(|| {
    let docs = prelude_items().iter().map(|i| i.doc.as_deref().unwrap_or(""));
    docs.map(parse_requirements).collect()
});

/// The parameters of which the greatest is as far as each item of the prelude reaches from the origin, from a `Reach:` line of its documentation.
static REACHES: LazyLock<Vec<Vec<&'static str>>> = LazyLock::new(|| listed("Reach:"));

/// The shapes of which bounds will do for each item of the prelude, from a `Bounds:` line of its documentation: its value grows with theirs, and where
/// theirs are of the same signs it is too.
static BOUNDS: LazyLock<Vec<Vec<&'static str>>> = LazyLock::new(|| listed("Bounds:"));

/// The reach of each blend of the prelude that is cut off where faces of both its operands lie in one plane, from a `Flush:` line of its documentation.
static FLUSH: LazyLock<Vec<Vec<&'static str>>> = LazyLock::new(|| listed("Flush:"));

/// The parameter by which a blend reaches, where it is cut off at planes in which faces of both its operands lie.
pub(super) fn flush_by(modules: &Modules, item: ItemRef) -> Option<&'static str> {
    FLUSH.get(item.item).filter(|_| modules.is_prelude(item.module))?.first().copied()
}

/// The names that a line of each prelude item's documentation lists.
fn listed(line: &str) -> Vec<Vec<&'static str>> {
    let list = |doc: &'static str| doc.lines().find_map(|l| l.trim().strip_prefix(line)).unwrap_or("");
    let docs = prelude_items().iter().map(|i| i.doc.as_deref().unwrap_or(""));
    docs.map(|doc| list(doc).split(',').map(str::trim).filter(|name| !name.is_empty()).collect()).collect()
}

/// Where a live value must be above a limit, it is kept so far above it.
const LEAST: f64 = 1e-5;

/// An argument before it has a value, or with one.
enum Given<'a> {
    Written(&'a Expr),
    Known(Value, Span),
    /// Numbers written out where one vector is wanted.
    Group(Vec<&'a Expr>),
    KnownGroup(Vec<Value>, Span),
}

impl Elaborator<'_> {
    /// A value for each parameter and where it stands, `None` where its default stands.
    #[allow(clippy::too_many_arguments)]
    pub(super) fn bind(
        &mut self,
        parameters: &[Parameter],
        known: Vec<(Value, Span)>,
        args: &[Argument],
        span: Span,
        env: &Env,
        formula_env: &Env,
        name: &str,
    ) -> Elaborated<Vec<Option<Bound>>> {
        // What stands before a dot is not counted by who reads.
        let joins = known.len() > 1;
        let hidden = usize::from(known.first().is_some_and(|(_, at)| at.start <= span.start)).min(parameters.len());
        let mut positional: SmallVec<[Given; 4]> = known.into_iter().map(|(v, s)| Given::Known(v, s)).collect();
        positional.extend(args.iter().filter(|a| a.name.is_none()).map(|a| Given::Written(&a.value)));
        let given = positional.len();
        if let Some((at, n)) = written_out(parameters, args, given) {
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
        // Points that stand one by one, where a list of them is needed.
        if let (Some(Parameter { ty: Some((Type::List(inner), _)), .. }), [Given::Written(first @ Expr { kind: ExprKind::Vector(_), .. }), rest @ ..]) =
            (parameters.first(), positional.as_slice())
        {
            let last = rest.iter().rev().find_map(|g| if let Given::Written(e) = g { Some(e.span) } else { None });
            let list = if let Type::Vec(n) = **inner { points(n) } else { "[a, b, c]".to_owned() };
            return Err(self.error(
                Code::TypeMismatch,
                first.span.to(last.unwrap_or(first.span)),
                "a list is needed here, and its items stand without brackets",
                format!("write `{name}({list})`"),
            ));
        }
        let mut slots: SmallVec<[Option<Given>; 4]> = parameters.iter().map(|_| None).collect();
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
                    let (takes, given) = (parameters.len() - hidden, given - hidden);
                    let has_axis = parameters.iter().any(|p| &*p.name.text == "axis" || matches!(p.ty, Some((Type::Vec(3), _))));
                    let axis = args.iter().find(|a| matches!(&a.value.kind, ExprKind::Name(name) if matches!(&**name, "x" | "y" | "z")));
                    if let (Some(axis), false) = (axis, has_axis) {
                        let help = format!("write `{}`", written(name, parameters, hidden, true));
                        return Err(self.error(Code::ExtraArgument, axis.value.span, format!("`{name}` has no axis here"), help));
                    }
                    let hides = (is_of_prelude(name) || is_function(name)) && parameters.iter().all(|p| !in_prelude(p.name.span));
                    self.error(
                        Code::ExtraArgument,
                        at,
                        match is_of_two(parameters) {
                            true => format!("this is one argument too many for `{name}`"),
                            false => format!("`{name}` takes {takes} argument{}, and here are {given}", if takes == 1 { "" } else { "s" }),
                        },
                        match takes {
                            _ if hides => format!("the language's own `{name}` is hidden by what the scene calls so: give that another name"),
                            0 => format!("write `{name}`"),
                            _ if name == "box" && given == 2 => "write `box(x, y, z)`; with round edges it is `rounded_box(size, radius)`".to_owned(),
                            _ if name == "scale" => "write `.scale(2)`, the same along all axes, or `.stretch(1, 2, 1)`".to_owned(),
                            _ if is_of_two(parameters) => of_many(name, parameters),
                            _ => format!("write `{}`", written(name, parameters, hidden, true)),
                        },
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
                let begun = || {
                    let mut begun = names.iter().copied().filter(|name| name.starts_with(&*label.text));
                    begun.next().filter(|_| begun.next().is_none())
                };
                let near = nearest(&label.text, names.iter().copied()).or_else(begun);
                let help = match near {
                    Some(near) => format!("did you mean `{near}: …`?"),
                    None if matches!(&*label.text, "center" | "centered" | "centre") => "leave it out: shapes stand around the origin".to_owned(),
                    None if matches!((&*label.text, names.as_slice()), ("x" | "y" | "z", ["v"])) => "write all three in order, as in `(1, 0, 0)`, without names".to_owned(),
                    None if names.is_empty() => "it has no arguments".to_owned(),
                    None => format!("its arguments are {}", names.join(", ")),
                };
                let message = format!("`{name}` has no argument named `{}`", label.text);
                self.report(Diagnostic::new(Code::UnknownArgument, label.span, message, help).write_if(label.span, near));
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
        let mut bound = Vec::with_capacity(parameters.len());
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
                        match is_of_two(parameters) && (joins || matches!(&*parameter.name.text, "a" | "b")) {
                            true => of_many(name, parameters),
                            false if name == "rotate" => "write the axis, then the angle: `.rotate(y, 45deg)`".to_owned(),
                            false => format!("write `{}`", written(name, parameters, hidden, false)),
                        },
                    );
                    failed = true;
                    continue;
                }
                Some(Given::Known(value, at)) => Ok((value, at)),
                Some(Given::Written(expr)) => {
                    if &*parameter.name.text == "angle" {
                        self.warn_of_degrees(expr);
                    }
                    self.expression(expr, place).map(|v| (v, expr.span))
                }
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
            let is_solid = is_field && &*parameter.name.text == "k" && is_of_two(parameters) && matches!(&value, Ok((Value::Shape(id), _)) if !self.is_declared_field(*id));
            let after_axis = parameters.iter().take_while(|p| p.name.text != parameter.name.text).any(|p| &*p.name.text == "axis");
            let typed = value.and_then(|(value, at)| match &parameter.ty {
                Some(_) if is_solid => {
                    let found = value.describe(&self.graph);
                    Err(self.error(Code::MissingArgument, at, format!("`{name}` needs `k`, a number, and this is {found}"), of_many(name, parameters)))
                }
                Some((ty, _)) if after_axis && matches!(value, Value::Vector(_)) && !self.fits(&value, ty) && !self.is_axis_of_a_drawing(&value, ty, at) => {
                    let found = value.describe(&self.graph);
                    let help = format!("the axis stands first: write `{}`", written(name, parameters, hidden, false));
                    Err(self.error(Code::TypeMismatch, at, format!("{} is needed here, and this is {found}", type_words(ty)), help))
                }
                Some((Type::Float | Type::Int, _)) if matches!(value, Value::Vector(_)) && self.names_an_axis(at) && !parameters.iter().any(|p| matches!(p.ty, Some((Type::Vec(3), _)))) => {
                    let needed: Vec<_> = parameters.iter().take_while(|p| p.default.is_none()).cloned().collect();
                    let help = format!("`{name}` has no axis: write `{}`", written(name, &needed, hidden, false));
                    Err(self.error(Code::TypeMismatch, at, format!("a number is needed here, and this is {}", value.describe(&self.graph)), help))
                }
                Some((Type::Float, _)) if !self.names_an_axis(at) && let Some(help) = in_one_vector(&value, name, parameters, hidden) => {
                    let found = value.describe(&self.graph);
                    Err(self.error(Code::TypeMismatch, at, format!("{} is needed here, and this is {found}", type_words(&Type::Float)), help))
                }
                Some((ty, _)) => self.coerce(value, ty, at, place),
                None => match (&parameter.default, &value) {
                    // Without a type the default's kind is wanted.
                    (Some(default), Value::Text(_) | Value::Material(_) | Value::Bool(_) | Value::List(_)) => {
                        let kind = self.expression(default, &Env::top(env.module));
                        match kind {
                            Ok(k) if std::mem::discriminant(&k) != std::mem::discriminant(&value) => {
                                let (wanted, found) = (k.describe(&self.graph), value.describe(&self.graph));
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

    /// Warns of an angle of more than a whole turn that is a bare number: it is in radians, and was hardly meant so.
    fn warn_of_degrees(&mut self, expr: &Expr) {
        let angle = match &expr.kind {
            ExprKind::Unary(UnaryOp::Neg, inner) => written_number(inner).map(|n| -n),
            _ => written_number(expr),
        };
        if let Some(angle) = angle.filter(|a| a.abs() > std::f64::consts::TAU) {
            let turns = angle / std::f64::consts::TAU;
            let message = format!("a bare angle is in radians: {} is {:.2} turns", short(angle), turns);
            let [degrees, radians] = ["deg", "rad"].map(|unit| format!("{}{unit}", short(angle)));
            let help = format!("for degrees write `{degrees}`; for radians `{radians}`");
            self.report(Diagnostic::new(Code::BareAngle, expr.span, message, help).write(expr.span, degrees).write(expr.span, radians));
        }
    }

    /// Whether an item of the prelude may be made of bounds of a shape that it takes.
    pub(super) fn takes_bounds(&self, item: ItemRef, parameter: &Parameter) -> bool {
        self.modules.is_prelude(item.module) && BOUNDS.get(item.item).is_some_and(|names| names.iter().any(|name| *parameter.name.text == **name))
    }

    /// How far from the origin a shape of the prelude reaches at most, where its documentation says so; and whether it is the same at all times.
    pub(super) fn reach(&mut self, item: ItemRef, function: &ast::Function, values: &[Value]) -> Option<(f64, bool)> {
        let names = REACHES.get(item.item).filter(|names| self.modules.is_prelude(item.module) && !names.is_empty())?;
        let mut farthest: f64 = 0.0;
        for name in names {
            let at = function.parameters.iter().position(|p| *p.name.text == **name)?;
            let Some(Value::Number(node, _)) = values.get(at) else { return None };
            farthest = farthest.max(self.facts.live_range(&self.graph, *node).hi);
        }
        let is_fixed = values.iter().all(|value| matches!(value, Value::Number(n, _) if self.graph.as_constant(*n).is_some()));
        farthest.is_finite().then_some((farthest, is_fixed))
    }

    /// Reports constant arguments that the documentation rules out. Answers what becomes of those that are not constant and might be ruled
    /// out at some values, by the index of their parameter: they are kept within what is allowed.
    pub(super) fn require(
        &mut self,
        item: ItemRef,
        function: &ast::Function,
        values: &[Value],
        places: &[(Span, Vec<Span>)],
    ) -> Elaborated<Vec<(usize, Value)>> {
        let mut kept = Vec::new();
        let of_part: Vec<Requirement>;
        let requirements: &[Requirement] = if self.modules.is_prelude(item.module) {
            REQUIREMENTS.get(item.item).map_or(&[], |all| all)
        } else if self.modules.comes_along(item.module) {
            of_part = self.modules.item(item).and_then(|item| item.doc.as_deref()).map_or_else(Vec::new, parse_requirements);
            &of_part
        } else {
            return Ok(kept);
        };
        for requirement in requirements {
            let (wanted, of_count) = match requirement.parameter.strip_suffix(".count") {
                Some(list) => (list, true),
                None => (requirement.parameter.as_str(), false),
            };
            let Some(at) = function.parameters.iter().position(|p| *p.name.text == *wanted) else {
                continue;
            };
            let Some((span, parts)) = places.get(at) else { continue };
            let value = kept.iter().rev().find(|(kept, _)| *kept == at).map(|(_, value)| value).or(values.get(at));
            let nodes: SmallVec<[NodeId; 4]> = match value {
                Some(Value::Number(n, _)) => smallvec![*n],
                Some(Value::Vector(v)) => v.iter().copied().collect(),
                Some(Value::List(items)) if of_count => {
                    smallvec![self.graph.constant(items.len() as f64)]
                }
                _ => continue,
            };
            // A vector that may not be zero may have components that are.
            let constants: SmallVec<[f64; 4]> =
                nodes.iter().filter_map(|n| self.graph.as_constant(*n)).collect();
            let holds = |c: f64| requirement.holds(c);
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
                        "write one that is {}", requirement.words()
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
            let within: SmallVec<[NodeId; 4]> = nodes.iter().map(|n| self.keep_within(*n, limit)).collect();
            if within != nodes {
                self.warn_of_reach(&function.name.text, requirement, &nodes, *span);
                kept.extend(match (values.get(at), within.first()) {
                    (Some(Value::Number(_, kind)), Some(n)) => Some((at, Value::Number(*n, *kind))),
                    (Some(Value::Vector(_)), _) => Some((at, Value::Vector(within.iter().copied().collect()))),
                    _ => None,
                });
            }
        }
        Ok(kept)
    }

    /// Whether a shape may stand for a number that varies from place to place: a person declared it as a formula, or the prelude says that it is one.
    fn is_declared_field(&self, id: ShapeId) -> bool {
        let Some(name) = self.graph.shape(id).and_then(|s| s.name.clone()) else { return false };
        if is_of_numbers(&name) {
            return true;
        }
        let is_field = |item: &ast::Item| matches!(&item.kind, ItemKind::Function(f) if matches!(f.kind, FunctionKind::Field | FunctionKind::Field2) && *f.name.text == *name);
        let modules = self.modules;
        modules.with_parameters().into_iter().flat_map(|module| modules.items(module)).any(|(_, item)| is_field(item))
    }

    /// A number that is not constant, kept on one side of a limit: `Max` keeps it at or above.
    fn keep_within(&mut self, node: NodeId, (op, limit): (Op, f64)) -> NodeId {
        if self.graph.as_constant(node).is_some() {
            return node;
        }
        let range = self.facts.live_range(&self.graph, node);
        let inside = if op == Op::Max { range.lo >= limit } else { range.hi <= limit };
        if inside {
            return node;
        }
        let limit = self.graph.constant(limit);
        self.graph.op(op, &[node, limit])
    }
}

/// What to write where a vector stands for the numbers that a function takes one after the other.
fn in_one_vector(value: &Value, name: &str, parameters: &[Parameter], hidden: usize) -> Option<String> {
    let Value::Vector(cells) = value else { return None };
    match name {
        "scale" => Some("`scale` is the same along all axes; by so much along each it is `.stretch(1, 2, 1)`".to_owned()),
        _ if (2..=parameters.len() - hidden).contains(&cells.len()) => {
            Some(format!("its numbers stand one after the other: write `{}`", written(name, parameters, hidden, false)))
        }
        _ => None,
    }
}

/// Which parameter is given as its components, and how many these are, where so many arguments stand without a name.
pub(super) fn written_out(parameters: &[Parameter], args: &[Argument], given: usize) -> Option<(usize, usize)> {
    let named = args.iter().filter(|a| a.name.is_some()).count();
    let fits = |(at, n): &(usize, usize)| given + 1 >= *n && given + 1 - *n <= parameters.len() && *at + *n <= given;
    vector_index(parameters, args).filter(|found| given + named > parameters.len() && fits(found))
}

/// The one parameter that is a vector, and its number of components. What `args` name is given apart.
pub(super) fn vector_index(parameters: &[Parameter], args: &[Argument]) -> Option<(usize, usize)> {
    let mut found = None;
    let is_named = |p: &Parameter| args.iter().filter_map(|a| a.name.as_ref()).any(|name| name.text == p.name.text);
    for (i, p) in parameters.iter().enumerate().filter(|(_, p)| !is_named(p)) {
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

/// Whether it joins two shapes: its first parameters are `a` and `b`.
pub(super) fn is_of_two(parameters: &[Parameter]) -> bool {
    parameters.iter().take_while(|p| is_operand(p)).map(|p| &*p.name.text).eq(["a", "b"])
}

/// A call as advice: what stands before the dot is left out, and a vector may be written out.
fn written(name: &str, parameters: &[Parameter], hidden: usize, by_components: bool) -> String {
    let mut list: Vec<&str> = parameters.iter().map(|p| &*p.name.text).collect();
    if let Some((at, n)) = vector_index(parameters, &[]).filter(|_| by_components) {
        list.splice(at..=at, ["x", "y", "z", "w"].into_iter().take(n));
    }
    let dot = if hidden > 0 { "." } else { "" };
    format!("{dot}{name}({})", list.get(hidden..).unwrap_or(&[]).join(", "))
}

/// How something that joins two shapes is called, and with more of them.
fn of_many(name: &str, parameters: &[Parameter]) -> String {
    let rest: String = parameters.iter().skip(2).map(|p| format!(", {}", p.name.text)).collect();
    let folded = match rest.strip_prefix(", ") {
        Some(rest) => format!(" or `for s in [a, b, c] by {name}({rest}) {{ s }}`"),
        None => String::new(),
    };
    let sign = match name {
        "union" => " or `a | b | c`",
        "intersection" => " or `a & b & c`",
        "difference" => " or `a - b - c`",
        "mix" => return format!("write `{name}(a, b{rest})`"),
        _ => "",
    };
    format!("write `{name}(a, b{rest})`; of more, `{name}(a, b, c{rest})`{folded}{sign}")
}

/// The number that an expression is, where it is one without a unit.
fn written_number(expr: &Expr) -> Option<f64> {
    match expr.kind {
        ExprKind::Int(n) => Some(n as f64),
        ExprKind::Float(n) => Some(n),
        _ => None,
    }
}
