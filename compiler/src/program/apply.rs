//! What comes of a call: a declared function with values for its parameters.

use crate::prelude::is_of_numbers;
use crate::program::load::ItemRef;
use crate::program::value::{Bound, Value};
use crate::program::{Elaborated, Elaborator, Env, Stop};
use crate::diagnostic::Code;
use crate::graph::{Claim, ClaimGroup, Function, Leaf, Made, Node, NodeId, NodeList, ShapeId, ValueRange};
use crate::source::Span;
use crate::syntax::ast::{self, ClaimKind, ExprKind, FunctionKind, ItemKind, Parameter, Type};
use smallvec::{SmallVec, smallvec};

impl Elaborator<'_> {
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
            && !modules.comes_along(item.module)
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
                .find_map(|b| if let Value::Shape(id) = b.value { Some(self.graph.dimensions(id)) } else { None })
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
        let mut values = Vec::with_capacity(args.len());
        let mut places = Vec::with_capacity(args.len());
        for (parameter, arg) in function.parameters.iter().zip(args) {
            let value = match (arg, &parameter.default) {
                (Some(bound), _) => {
                    places.push((bound.span, bound.parts));
                    bound.value
                }
                (None, Some(default)) => {
                    let is_field = matches!(parameter.ty, Some((Type::Field, _)));
                    let place = if is_field { env.at(point.clone()) } else { env.clone() };
                    let value = self.expression(default, &place)?;
                    places.push((span, Vec::new()));
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
                let found = values.get(i).map(|v| v.describe(&self.graph)).unwrap_or_default();
                let help = match values.get(i) {
                    Some(Value::Number(node, _)) => self.instead_of_number(*node),
                    _ => "write a shape",
                };
                return Err(self.error(
                    Code::TypeMismatch,
                    at,
                    format!("a shape is needed here, and this is {found}"),
                    help,
                ));
            }
        }
        // The value depends on the arguments alone, unless it is a formula over the caller's point.
        let memo_key = (function.kind != FunctionKind::Blend || any_shape)
            .then(|| (item, receiver.clone(), values.clone()));
        if let Some(key) = &memo_key
            && let Some(known) = self.memo.get(key)
        {
            let known = known.clone();
            // It is one shape for all calls that say the same, and stands where each of them does; a person's own shape stands where it is declared.
            let is_declared = matches!(function.kind, FunctionKind::Shape | FunctionKind::Shape2) && !modules.is_prelude(item.module);
            if let (Some(Value::Shape(id)), false) = (&known, is_declared) {
                self.graph.note_place(*id, self.place(span));
            }
            return known.ok_or(Stop);
        }
        // In a formula an argument may vary with `p`; then the formula stands there itself, not a shape.
        let varies = in_formula.is_some()
            && matches!(function.kind, FunctionKind::Field | FunctionKind::Field2)
            && function.parameters.iter().zip(&values).any(|(p, v)| {
                !matches!(p.ty, Some((Type::Field, _))) && self.value_depends_on_point(v)
            });
        let value = self.deeper(span, |e| match function.kind {
            FunctionKind::Fn => {
                let value = e.value_of(item, function, &values, &env)?;
                let value = e.claimed_value(value, (item, function), &values, &env);
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
                let node = e.claimed(node, (item, function), &values, &env);
                let exact = matches!(&function.claim, Some(c) if c.kind == ClaimKind::Exact);
                let name = (!modules.is_prelude(item.module) || is_of_numbers(&function.name.text)).then(|| function.name.text.clone());
                let shape = e.formula_shape(node, dimensions, name, exact, span);
                if let Some((reach, is_fixed)) = e.reach(item, function, &values) {
                    e.facts.know_reach(&e.graph, node, (reach, is_fixed), usize::from(dimensions));
                }
                Ok(Value::Shape(shape))
            }
            FunctionKind::Warp | FunctionKind::Warp2 => {
                e.apply_warp(function, receiver.clone(), &env, point.clone(), span)
            }
            FunctionKind::Blend if any_shape => {
                let mut here = env.at(point.clone());
                let mut numbers = values.clone();
                let flush = e.flush(item, function, &values);
                for (number, operand) in numbers.iter_mut().zip(flush.iter().flat_map(|flush| flush.operands)) {
                    *number = Value::Shape(operand);
                }
                for (parameter, value) in function.parameters.iter().zip(numbers.iter_mut()).take(operand_count) {
                    let number = e.to_number(value, span, &here)?;
                    *value = Value::number(number);
                    here = here.and(&parameter.name.text, value.clone());
                }
                let value = e.expression(&function.body, &here)?;
                let node = e.to_number(&value, function.body.span, &here)?;
                let node = e.claimed(node, (item, function), &numbers, &here);
                let shape = e.formula_shape(node, dimensions, None, false, span);
                Ok(Value::Shape(match flush {
                    Some(flush) => e.cut_flush(shape, flush, span),
                    None => shape,
                }))
            }
            FunctionKind::Blend => {
                let here = env.at(point.clone());
                let value = e.expression(&function.body, &here)?;
                let value = Value::number(e.to_number(&value, function.body.span, &here)?);
                Ok(e.claimed_value(value, (item, function), &values, &here))
            }
        });
        if let (Ok(made), true) = (&value, modules.is_prelude(item.module)) {
            self.note_balls(&function.name.text, &values, made);
        }
        // What is wrong with a person's function is said once; what the prelude can't take is said where it is called.
        let said = !(self.trial || self.endless || self.full || modules.is_prelude(item.module));
        if let (Some(key), false) = (memo_key, varies)
            && (value.is_ok() || said)
        {
            self.memo.insert(key, value.clone().ok());
        }
        value
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
        if let Value::Number(..) = moved {
            let found = moved.describe(&self.graph);
            return Err(self.error(
                Code::TypeMismatch,
                function.body.span,
                format!("a warp says where a point comes from, a vec{n}, and this is {found}"),
                if n == 3 { "write all components, as `(p.x, p.y + 0.1 * sin(p.x), p.z)`" } else { "write both components, as `(p.x, p.y + 0.1 * sin(p.x))`" },
            ));
        }
        let moved = self.to_vector(&moved, n, function.body.span)?;
        match receiver {
            Some(Value::Vector(_)) => Ok(Value::Vector(moved)),
            Some(Value::Nothing) => Ok(Value::Nothing),
            Some(Value::Shape(id)) if usize::from(self.graph.dimensions(id)) == n => {
                let at = self.fit_point(&moved, id, span)?;
                let value = self.graph.field(id, at);
                self.locate(value, span);
                Ok(Value::Shape(self.make_shape(n as u8, value, span)))
            }
            Some(other) => {
                let found = other.describe(&self.graph);
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
        of: (ItemRef, &ast::Function),
        args: &[Value],
        env: &Env,
    ) -> Value {
        match value {
            Value::Number(node, whole) if of.1.claim.is_some() => {
                Value::Number(self.claimed(node, of, args, env), whole)
            }
            other => other,
        }
    }

    /// The value of a function. What it makes of numbers, if that is a long formula, is one in which they stand as they are, so that it can be a
    /// function of the module too.
    fn value_of(&mut self, item: ItemRef, function: &ast::Function, args: &[Value], env: &Env) -> Elaborated<Value> {
        let Some(numbers) = numbers_of(args) else { return self.expression(&function.body, env) };
        if !self.long.contains(&item) {
            let value = self.expression(&function.body, env)?;
            if !self.is_long(&value, &numbers) {
                return Ok(value);
            }
            self.long.insert(item);
        }
        let apart = self.graph.stand_apart(&numbers);
        // What was made of these numbers before may be made of what is inside them.
        let memo = std::mem::take(&mut self.memo);
        let value = self.expression(&function.body, env);
        self.memo = memo;
        self.graph.stand_no_more(apart);
        let value = value?;
        if let Value::Number(node, _) = value
            && self.is_long(&value, &numbers)
        {
            self.graph.note_result(node, Made { by: function.name.text.clone(), of: NodeList::from(&numbers[..]) });
        }
        Ok(value)
    }

    /// Whether what was made of some numbers is a long formula, as far as is seen: what was made since the newest of them is as much as it may be.
    fn is_long(&self, value: &Value, numbers: &[NodeId]) -> bool {
        let (Value::Number(node, _), Some(newest)) = (value, numbers.iter().map(|n| n.0).max()) else { return false };
        self.graph.is_long((newest.saturating_add(1)..node.0.saturating_add(1)).map(NodeId))
    }

    /// A value with what its declaration claims of it.
    fn claimed(&mut self, node: NodeId, (item, function): (ItemRef, &ast::Function), args: &[Value], env: &Env) -> NodeId {
        let Some(claim) = &function.claim else { return node };
        if self.graph.as_constant(node).is_some() {
            return node;
        }
        // The shape itself says that it is exact.
        let ClaimKind::Lipschitz(formula, range) = &claim.kind else { return node };
        let mut nodes: SmallVec<[NodeId; 8]> = smallvec![node];
        let mut groups: SmallVec<[ClaimGroup; 8]> = SmallVec::new();
        let mut claim_env = Env::top(env.module);
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
                    let count = (nodes.len() - before) as u32;
                    if self.takes_bounds(item, parameter) { ClaimGroup::Bounds(count) } else { ClaimGroup::Values(count) }
                }
                _ => ClaimGroup::Values(0),
            });
            let constant = self.graph.leaf(Leaf::Variable(i as u32));
            claim_env = claim_env.and_argument(&parameter.name.text, Value::number(constant), value.clone());
        }
        let Ok(Value::Number(formula, _)) = self.expression(formula, &claim_env) else { return node };
        let range = range.as_ref().and_then(|range| {
            let ExprKind::Range(least, largest) = &range.kind else { return None };
            let mut end = |e: &ast::Expr| {
                let value = self.expression(e, &Env::top(env.module)).ok()?;
                self.to_constant(&value, e.span).ok()
            };
            Some(ValueRange::new(end(least)?, end(largest)?))
        });
        let of = NodeList::from(&nodes[..]);
        self.graph.intern(Node::Claim(of, Claim::Lipschitz(formula, groups[..].into(), range)))
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
}

/// All numbers among values; none where a value is made of something else.
fn numbers_of(values: &[Value]) -> Option<Vec<NodeId>> {
    let mut numbers = Vec::new();
    for value in values {
        match value {
            Value::Number(n, _) | Value::Bool(n) => numbers.push(*n),
            Value::Vector(v) | Value::Matrix(_, v) => numbers.extend(v.iter().copied()),
            _ => return None,
        }
    }
    Some(numbers)
}

/// Whether a parameter of a blend is one of the distances that it combines.
pub fn is_operand(p: &Parameter) -> bool {
    p.ty.is_none() && p.default.is_none() && matches!(&*p.name.text, "a" | "b" | "c" | "d")
}
