//! Loops: `for` and what it joins, `let` and what it iterates.

use super::value::Value;
use super::{Elaborated, Elaborator, Env, Stop};
use crate::diagnostic::{Code, Diagnostic};
use crate::graph::kernel::Op;
use crate::graph::{NodeId, ShapeId, FAR};
use crate::source::Span;
use crate::syntax::ast::{BinaryOp, Expr, ExprKind, Fold, FoldKind, For, Iterate, Let};

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
pub(super) const LIST_LIMIT: usize = 200_000;

/// Most turns of one loop.
const TURN_LIMIT: f64 = 100_000.0;

impl Elaborator<'_> {
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
        let again = turns.updates.iter().enumerate().find(|(i, (name, _))| turns.updates.iter().take(*i).any(|(earlier, _)| earlier.text == name.text));
        if let Some((_, (name, _))) = again {
            let name = (&name.text, name.span);
            return Err(self.error(
                Code::TwiceDeclared,
                name.1,
                format!("`{}` is given two new values in one turn, and all of them are made of the old ones", name.0),
                format!("give what is in between a name of its own, after the `{{`: `let folded = abs({0}); {0} = 2 * folded`", name.0),
            ));
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
                        let found = other.describe(&self.graph);
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
            let found = range.describe(&self.graph);
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

    /// What a repetition repeats, as a shape. Where it is a solid, and the head repeats drawings, the head is wrong.
    pub(super) fn repeated(&mut self, body: &Value, dimensions: u8, each: &For, head: &str) -> Elaborated<ShapeId> {
        if let (Value::Shape(id), 2) = (body, dimensions)
            && self.graph.dimensions(*id) == 3
        {
            let help = format!("write `{head}` for solids");
            let error = Diagnostic::new(Code::TypeMismatch, each.source.span, "this repeats drawings, and the body is a solid", help);
            return Err(self.report(error.label(each.body.span, "a solid")));
        }
        self.to_shape(body, dimensions, each.body.span)
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
                    "the cells of a repetition have no order in which to join their copies",
                    "leave out `by`, or use a range and place the copies yourself",
                ));
            }
            let mut given = Vec::new();
            for arg in args {
                given.push((self.expression(&arg.value, env)?, arg.value.span));
            }
            return if name == "grid" {
                self.grid(each, &given, span, env)
            } else {
                self.polar(each, &given, span, env)
            };
        }
        let source = match &each.source.kind {
            ExprKind::Range(..) => None,
            _ => match self.expression(&each.source, env)? {
                Value::List(items) => Some((items.to_vec(), None)),
                Value::Range(_) => None,
                other => {
                    let found = other.describe(&self.graph);
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
                            let found = other.describe(&self.graph);
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
                let node = self.graph.balanced(Op::Min, &numbers, FAR);
                Ok(Value::number(node))
            }
            Joined::By(fold) => {
                let mut total: Option<Value> = None;
                // Whether the fold is a union of its two and nothing else, once that is seen.
                let mut unites = None;
                for (body, present) in bodies {
                    let Some(before) = total else {
                        // The first stands even where a live count is zero: there is nothing to fold it with.
                        total = Some(body);
                        continue;
                    };
                    if let (Some(present), Some(true)) = (present, unites) {
                        // A union with nothing is what was there before.
                        let body = self.select(present, &body, &Value::Nothing, span, env)?;
                        total = Some(self.fold(&fold, &before, &body, env)?);
                        continue;
                    }
                    let after = self.fold(&fold, &before, &body, env)?;
                    if let (None, Value::Shape(after), Value::Shape(a), Value::Shape(b)) = (unites, &after, &before, &body) {
                        unites = Some(self.graph.is_union_of(self.uncut(*after), [self.uncut(*a), *b]));
                    }
                    total = Some(match present {
                        Some(present) => self.select_folded(present, &after, &before, span, env)?,
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

    /// What is folded where a condition holds, else what was before. The fold's formula stands under the choice itself, so that both sides ask for what
    /// was before by one call: as a shape of its own the fold would ask for it anew, and each turn would double all that is before it.
    fn select_folded(&mut self, present: NodeId, after: &Value, before: &Value, span: Span, env: &Env) -> Elaborated<Value> {
        if let (Value::Shape(after), Value::Shape(before)) = (after, before)
            && let Some(folded) = self.graph.shape(*after)
            && folded.material.is_none()
            && folded.paints.is_empty()
            && folded.variables.is_empty()
        {
            let (dimensions, value) = (folded.dimensions, folded.value);
            let point = self.graph.point();
            let before = self.graph.field(*before, point);
            let value = self.graph.op(Op::Select, &[present, value, before]);
            return Ok(Value::Shape(self.make_shape(dimensions, value, span)));
        }
        self.select(present, after, before, span, env)
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
}
