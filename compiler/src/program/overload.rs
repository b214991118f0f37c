//! Which of several declarations of one name a call means.

use super::apply::is_operand;
use super::bind::vector_index;
use super::expression::kind_words;
use super::load::ItemRef;
use super::value::Value;
use super::{Elaborated, Elaborator, Env, Stop};
use crate::diagnostic::Code;
use crate::source::Span;
use crate::syntax::ast::{self, Argument, ExprKind, FunctionKind, ItemKind, Name, Parameter, Type};

impl Elaborator<'_> {
    /// Which of several declarations of one name (all of the prelude) a call means: by its first argument, then by their number.
    pub(super) fn overload(
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
            Some(arg) if known.len() == 1 && differ && arg.name.as_ref().is_none_or(|n| functions.iter().any(|(_, f)| is_called(second(f), n))) => {
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
        // What is named as the first that a declaration takes tells as much.
        let is_first = |a: &&Argument| a.name.as_ref().is_some_and(|n| functions.iter().any(|(_, f)| is_called(f.parameters.first(), n)));
        let named_first = match args.iter().find(is_first) {
            Some(arg) if positional == 0 => Some((&arg.name, self.expression(&arg.value, env)?)),
            _ => None,
        };
        let mut best: Option<((u32, usize), ItemRef)> = None;
        for (order, (item, f)) in functions.iter().enumerate() {
            let first_fits = match (known.first(), &named_first) {
                (Some((value, _)), _) => self.first_fits(f, value),
                (None, Some((Some(name), value))) if is_called(f.parameters.first(), name) => self.first_fits(f, value),
                (None, _) => 1,
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
            let grouped = positional + named > takes
                && vector_index(&f.parameters, args).is_some_and(|(_, n)| {
                    positional + 1 >= n && positional + 1 - n <= takes && positional + 1 - n + named >= needs
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
            let found = known.first().map(|(v, _)| v.describe(&self.graph)).unwrap_or_default();
            let at = known.first().map_or(span, |(_, s)| *s);
            let name = functions.first().map(|(_, f)| f.name.text.clone()).unwrap_or_default();
            let wanted: Vec<String> = functions.iter().map(|(_, f)| signature(f)).collect();
            let at_point = match (known.first(), functions.first()) {
                (Some((Value::Vector(_), _)), Some((_, f))) if env.point.is_some() => Some(at_a_point(f)),
                _ => None,
            };
            let of_shape = functions.iter().all(|(_, f)| matches!(f.kind, FunctionKind::Warp | FunctionKind::Warp2));
            let help = at_point.unwrap_or_else(|| match functions.first() {
                Some((_, f)) if of_shape => {
                    let rest: Vec<&str> = f.parameters.iter().map(|p| &*p.name.text).collect();
                    format!("the shape stands first: write `shape.{name}({})`", rest.join(", "))
                }
                _ => format!("there is {}", wanted.join(", ")),
            });
            return Err(self.error(Code::TypeMismatch, at, format!("no `{name}` takes {found} first"), help));
        }
        Ok(best.map(|(_, item)| item))
    }

    /// How well a value fits the first parameter: 0 not, 1 by conversion, 2 as it is.
    fn first_fits(&self, f: &ast::Function, value: &Value) -> u32 {
        match f.kind {
            FunctionKind::Warp => match value {
                Value::Shape(id) if self.graph.dimensions(*id) == 3 => 2,
                Value::Vector(v) if v.len() == 3 => 2,
                Value::Nothing => 1,
                _ => 0,
            },
            FunctionKind::Warp2 => match value {
                Value::Shape(id) if self.graph.dimensions(*id) == 2 => 2,
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
}

/// What stands second in a call.
fn second(f: &ast::Function) -> Option<&Parameter> {
    let implied = usize::from(!matches!(f.kind, FunctionKind::Warp | FunctionKind::Warp2));
    f.parameters.get(implied)
}

/// Its declared type.
fn second_type(f: &ast::Function) -> Option<&Type> {
    second(f).and_then(|p| p.ty.as_ref()).map(|(t, _)| t)
}

fn is_called(parameter: Option<&Parameter>, name: &Name) -> bool {
    parameter.is_some_and(|p| p.name.text == name.text)
}

/// How the distance of a shape at a point is written, for who gives it the point first.
pub(super) fn at_a_point(f: &ast::Function) -> String {
    let names: Vec<&str> = f.parameters.iter().map(|p| &*p.name.text).collect();
    let (before, names) = match (f.parameters.first().and_then(|p| p.ty.as_ref()), names.split_first()) {
        (Some((Type::Shape | Type::Shape2, _)), Some((s, rest))) => (format!("{s}."), rest),
        _ => (String::new(), &names[..]),
    };
    format!("it makes a shape; the distance of that at a point is `{before}{}({}).at(p)`", f.name.text, names.join(", "))
}

/// `box(size)`, as advice.
fn signature(f: &ast::Function) -> String {
    let names: Vec<&str> = f.parameters.iter().map(|p| &*p.name.text).collect();
    format!("{} {}({})", kind_words(f.kind), f.name.text, names.join(", "))
}
