//! Blends of two that are given many.

use super::bind::is_of_two;
use super::load::ItemRef;
use super::value::Value;
use super::{Elaborated, Elaborator, Env};
use crate::source::Span;
use crate::syntax::ast::{self, Argument, FunctionKind, Name};

impl Elaborator<'_> {
    /// A blend of two that is given more of them, or a list: they are joined in their order, as `for s in [a, b, c] by name(k) { s }` joins them.
    pub(super) fn join_all(
        &mut self,
        item: ItemRef,
        function: &ast::Function,
        mut given: Vec<(Value, Span)>,
        mut args: &[Argument],
        span: Span,
        env: &Env,
    ) -> Elaborated<Value> {
        let is_named = |name: &Name| args.iter().filter_map(|a| a.name.as_ref()).any(|n| n.text == name.text);
        let others: Vec<bool> = function.parameters.iter().skip(2).filter(|p| !is_named(&p.name)).map(|p| p.default.is_none()).collect();
        let positional = given.len() + args.iter().filter(|a| a.name.is_none()).count();
        // Numbers do not say which of them are distances: what is one too many is.
        let numbers = positional.saturating_sub(others.len());
        let shapes = positional.saturating_sub(others.iter().filter(|needed| **needed).count());
        let mut operands = Vec::new();
        let mut rest = Vec::new();
        for at in 0..shapes {
            if at == given.len() {
                match args.split_first() {
                    Some((arg, after)) if arg.name.is_none() => {
                        given.push((self.expression(&arg.value, env)?, arg.value.span));
                        args = after;
                    }
                    _ => break,
                }
            }
            match given.get(at) {
                Some((Value::List(items), at)) => operands.extend(items.iter().map(|item| (item.clone(), *at))),
                Some(one @ (Value::Shape(_) | Value::Nothing, _)) => operands.push(one.clone()),
                Some(one) if at < numbers.max(2) && (at < 2 || env.point.is_some()) => operands.push(one.clone()),
                other => {
                    rest.extend(other.cloned());
                    break;
                }
            }
        }
        let is_list = given.iter().any(|(value, _)| matches!(value, Value::List(_)));
        if operands.len() < 3 && !is_list {
            return self.call_function(item, function, given, args, span, env);
        }
        let mut operands = operands.into_iter();
        let Some(mut total) = operands.next() else { return Ok(Value::Nothing) };
        for next in operands {
            self.step(span)?;
            let known: Vec<_> = [total, next].into_iter().chain(rest.iter().cloned()).collect();
            total = (self.call_function(item, function, known, args, span, env)?, span);
        }
        Ok(total.0)
    }
}

/// Whether it is a blend of two that is one of many too. A mix is between two.
pub fn joins_two(function: &ast::Function) -> bool {
    function.kind == FunctionKind::Blend && is_of_two(&function.parameters) && &*function.name.text != "mix"
}
