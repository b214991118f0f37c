//! One function of a shader: what its statements do, one after another, to what its variables hold.

use super::formula::{self, Unsaid, and, choose, not};
use super::program::{Body, Ex, Id, Loop, Made, MadeResult, Step};
use super::turns;
use super::value::{self, Value};
use super::failure::Failure;
use super::file::{File, compose};
use naga::proc::TypeResolution;
use naga::{Block, Expression, Handle, Span, Statement, TypeInner, UnaryOperator};
use super::read::Read;
use rustc_hash::{FxHashMap, FxHashSet};
use std::collections::BTreeMap;

/// Steps of one function, at most.
const MOST_STEPS: usize = 5_000;
/// How deep statements nest, those that follow a branch that may end elsewhere counted in.
const DEEPEST: usize = 200;
const NO_LOOP: &str = "write a loop whose turns can be counted: `for (int i = 0; i < 64; i++)`; `break` may end it sooner";

/// The expressions of a value: the names of the members on the way to each, and its type.
type Leaves = Vec<(String, &'static str)>;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Root {
    Local(usize),
    Argument(u32),
    Global(usize),
}

enum Access {
    At(usize),
    Of(Ex),
}

#[derive(Clone)]
struct State {
    roots: BTreeMap<Root, Value>,
    /// Whether the loop was left.
    broke: Ex,
    /// Whether the function was.
    returned: Ex,
    result: Option<Value>,
}

/// What follows when a block has ended.
enum Next<'m, 'n> {
    Nothing,
    Then(&'m [Statement], &'m [Span], &'n Next<'m, 'n>),
    /// A `switch` ends.
    Case(&'n Next<'m, 'n>),
    /// A turn of a loop ends.
    Turn,
}

struct Function<'m> {
    file: &'m File<'m>,
    function: &'m naga::Function,
    info: &'m naga::valid::FunctionInfo,
    names: Vec<String>,
    known: FxHashMap<Id, f64>,
    whole: Vec<bool>,
    /// What expressions came to. Each path evaluates what it reads anew, so that it never sees another path's.
    done: FxHashMap<Handle<Expression>, Value>,
    arguments: Vec<Value>,
    turns: Vec<(&'m Block, Option<Handle<Expression>>)>,
    /// How deep statements nest here.
    depth: usize,
    /// Nothing gets a name: there is no room for it.
    plain: bool,
    steps: usize,
    span: Span,
}

/// Translates every function of a file, in an order in which each is known before it is called.
pub fn translate_all(read: &Read) -> File<'_> {
    let mut file = File::new(read);
    let mut taken = FxHashSet::default();
    for (handle, function) in read.module.functions.iter() {
        let name = function.name.clone().unwrap_or_default();
        let unique = (1..).map(|n| if n == 1 { name.clone() } else { format!("{name}_{n}") }).find(|name| !taken.contains(name)).unwrap_or_default();
        taken.insert(unique.clone());
        let made = translate(&file, handle, &unique);
        if let Ok(made) = &made {
            taken.extend(made.results.iter().map(|made| made.name.clone()));
        }
        file.made.insert(handle, made);
    }
    file
}

/// Translates a function.
fn translate<'m>(file: &'m File<'m>, handle: Handle<naga::Function>, name: &str) -> Result<Made, Failure> {
    let function = file.read.module.functions.try_get(handle).map_err(|_| Failure::nowhere())?;
    let mut made = Function {
        file,
        function,
        info: &file.read.info[handle],
        names: Vec::new(),
        known: FxHashMap::default(),
        whole: Vec::new(),
        done: FxHashMap::default(),
        arguments: Vec::new(),
        turns: Vec::new(),
        depth: 0,
        plain: false,
        steps: 0,
        span: file.read.module.functions.get_span(handle),
    };
    made.whole(name)
}

impl<'m> Function<'m> {
    fn whole(&mut self, name: &str) -> Result<Made, Failure> {
        let module = &self.file.read.module;
        let mut parameters = Vec::new();
        let mut state = State { roots: BTreeMap::new(), broke: Ex::Bool(false), returned: Ex::Bool(false), result: None };
        for (i, argument) in self.function.arguments.iter().enumerate() {
            let ty = module.types.get_handle(argument.ty).map_err(|_| Failure::nowhere())?;
            let (inner, is_pointer) = match &ty.inner {
                &TypeInner::Pointer { base, .. } => (&module.types.get_handle(base).map_err(|_| Failure::nowhere())?.inner, true),
                inner => (inner, false),
            };
            let base = argument.name.clone().unwrap_or_else(|| format!("a{i}"));
            let zero = value::zero(module, inner).ok_or_else(|| self.fail(self.span, format!("the argument `{base}` is of a type that the language has not"), TYPES))?;
            let mut leaves = value::names(module, inner).into_iter();
            let value = zero.map(&mut |_, _| {
                let (leaf, ty) = leaves.next().unwrap_or((String::new(), "float"));
                let id = self.name(&joined(&base, &leaf), ty == "int");
                parameters.push((id, ty));
                Ex::Id(id)
            });
            if is_pointer {
                state.roots.insert(Root::Argument(i as u32), value.clone());
            }
            self.arguments.push(value);
        }
        for (handle, local) in self.function.local_variables.iter() {
            let zero = self.zero(local.ty, self.function.local_variables.get_span(handle))?;
            let value = match local.init {
                Some(init) => self.value(init, &mut state, &mut Vec::new())?,
                None => zero,
            };
            state.roots.insert(Root::Local(handle.index()), value);
        }
        let mut steps = Vec::new();
        let body: &'m Block = &self.function.body;
        self.run(body, self.spans_of(body), &Next::Nothing, &mut state, &mut steps)?;
        // One for each expression that comes out.
        let mut results = Vec::new();
        let mut outs: Vec<(String, Value, Leaves)> = Vec::new();
        let mut own = 0;
        if let Some(result) = &self.function.result {
            let inner = &module.types.get_handle(result.ty).map_err(|_| Failure::nowhere())?.inner;
            let zero = self.zero(result.ty, self.span)?;
            let leaves = value::names(module, inner);
            own = leaves.len();
            outs.push((String::new(), state.result.clone().unwrap_or(zero), leaves));
        }
        let mut written = Vec::new();
        for (i, argument) in self.function.arguments.iter().enumerate() {
            let Some(value) = state.roots.get(&Root::Argument(i as u32)) else { continue };
            if self.arguments.get(i) == Some(value) {
                continue;
            }
            let leaves = value::names(module, &self.pointee(argument.ty));
            written.push((i, leaves.len()));
            outs.push((argument.name.clone().unwrap_or_else(|| format!("a{i}")), value.clone(), leaves));
        }
        let count: usize = outs.iter().map(|(_, _, leaves)| leaves.len()).sum();
        for (argument, value, leaves) in outs {
            for (ex, (leaf, ty)) in value.leaves().into_iter().zip(leaves) {
                let name = if count == 1 { name.to_owned() } else { joined(&joined(name, &argument), &leaf) };
                results.push(MadeResult { name, ty, body: Body { steps: steps.clone(), value: ex.clone() } });
            }
        }
        for made in &mut results {
            super::tidy::tidy(&mut made.body, &mut self.names);
            let mut unknown = None;
            super::program::each_of(&made.body.steps, &mut |ex| note_unknown(ex, &mut unknown));
            made.body.value.each(&mut |ex| note_unknown(ex, &mut unknown));
            if let Some(global) = unknown {
                let words = format!("`{global}` holds what a function wrote before, and a formula has no before");
                return Err(self.fail(self.span, words, "give it to the function as an argument"));
            }
        }
        Ok(Made { names: std::mem::take(&mut self.names), parameters, results, written, own })
    }

    // ---- Names, types and errors ----

    fn name(&mut self, base: &str, whole: bool) -> Id {
        self.names.push(base.to_owned());
        self.whole.push(whole);
        self.names.len() as Id - 1
    }

    fn fail(&self, span: Span, message: String, help: &str) -> Failure {
        let span = if span.is_defined() { span } else { self.span };
        Failure { range: self.file.read.place(span), message, help: help.to_owned() }
    }

    fn unsaid(&self, handle: Handle<Expression>) -> impl Fn(Unsaid) -> Failure + '_ {
        let span = self.span_of(handle);
        move |(message, help)| self.fail(span, message, help)
    }

    /// Where an expression stands; of one that naga made itself, where what it is made of does.
    fn span_of(&self, handle: Handle<Expression>) -> Span {
        let span = self.function.expressions.get_span(handle);
        if span.is_defined() {
            return span;
        }
        match self.function.expressions.try_get(handle) {
            Ok(Expression::Unary { expr: of, .. } | Expression::As { expr: of, .. } | Expression::Derivative { expr: of, .. }) => self.span_of(*of),
            Ok(Expression::Math { arg: of, .. } | Expression::Binary { left: of, .. } | Expression::Relational { argument: of, .. }) => self.span_of(*of),
            _ => span,
        }
    }

    fn zero(&self, ty: Handle<naga::Type>, span: Span) -> Result<Value, Failure> {
        let module = &self.file.read.module;
        let ty = module.types.get_handle(ty).map_err(|_| Failure::nowhere())?;
        value::zero(module, &ty.inner).ok_or_else(|| self.fail(span, "this is of a type that the language has not".to_owned(), TYPES))
    }

    fn inner(&self, handle: Handle<Expression>) -> &TypeInner {
        match &self.info[handle].ty {
            TypeResolution::Handle(ty) => &self.file.read.module.types[*ty].inner,
            TypeResolution::Value(inner) => inner,
        }
    }

    fn is_pointer(&self, handle: Handle<Expression>) -> bool {
        matches!(self.inner(handle), TypeInner::Pointer { .. } | TypeInner::ValuePointer { .. })
    }

    fn pointee(&self, ty: Handle<naga::Type>) -> TypeInner {
        let types = &self.file.read.module.types;
        match &types[ty].inner {
            &TypeInner::Pointer { base, .. } => types[base].inner.clone(),
            inner => inner.clone(),
        }
    }

    fn root_type(&self, root: Root) -> TypeInner {
        let module = &self.file.read.module;
        match root {
            Root::Local(i) => self.function.local_variables.iter().nth(i).map(|(_, local)| module.types[local.ty].inner.clone()),
            Root::Argument(i) => self.function.arguments.get(i as usize).map(|argument| self.pointee(argument.ty)),
            Root::Global(i) => module.global_variables.iter().nth(i).map(|(_, global)| module.types[global.ty].inner.clone()),
        }
        .unwrap_or(TypeInner::Scalar(naga::Scalar::F32))
    }

    /// The name of a variable, empty where it has none.
    fn root_name(&self, root: Root) -> String {
        let module = &self.file.read.module;
        match root {
            Root::Local(i) => self.function.local_variables.iter().nth(i).and_then(|(_, local)| local.name.clone()),
            Root::Argument(i) => self.function.arguments.get(i as usize).and_then(|argument| argument.name.clone()),
            Root::Global(i) => module.global_variables.iter().nth(i).and_then(|(_, global)| global.name.clone()),
        }
        .filter(|name| name != "local")
        .unwrap_or_default()
    }

    /// The names of a variable's expressions, and whether each is a whole number.
    fn leaf_names(&self, root: Root) -> Vec<(String, bool)> {
        let base = self.root_name(root);
        let leaves = value::names(&self.file.read.module, &self.root_type(root));
        leaves.into_iter().map(|(leaf, ty)| (if base.is_empty() { String::new() } else { joined(&base, &leaf) }, ty == "int")).collect()
    }

    fn step(&mut self, step: Step, out: &mut Vec<Step>) -> Result<(), Failure> {
        self.steps += 1;
        if self.steps > MOST_STEPS {
            return Err(self.fail(self.span, "this function is too long".to_owned(), "leave it out, or split it into several"));
        }
        if let Step::Let(id, Ex::Number(value)) = &step {
            self.known.insert(*id, *value);
        }
        out.push(step);
        Ok(())
    }

    // ---- Statements ----

    fn run(&mut self, block: &'m [Statement], spans: &'m [Span], next: &Next<'m, '_>, state: &mut State, out: &mut Vec<Step>) -> Result<(), Failure> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(self.fail(self.span, "the branches of this function nest too deep".to_owned(), "leave it out, or split it into several"));
        }
        let ran = self.run_here(block, spans, next, state, out);
        self.depth -= 1;
        ran
    }

    fn run_here(&mut self, block: &'m [Statement], spans: &'m [Span], next: &Next<'m, '_>, state: &mut State, out: &mut Vec<Step>) -> Result<(), Failure> {
        for (i, statement) in block.iter().enumerate() {
            let span = spans.get(i).copied().unwrap_or_default();
            let rest = || (block.get(i + 1..).unwrap_or_default(), spans.get(i + 1..).unwrap_or_default());
            match statement {
                Statement::Emit(range) => {
                    for handle in range.clone() {
                        if self.is_pointer(handle) {
                            continue;
                        }
                        let value = self.compute(handle, state, out)?;
                        let is_used_often = self.info[handle].ref_count > 1 && !self.plain;
                        let value = if is_used_often { self.named(&value, out)? } else { value };
                        self.done.insert(handle, value);
                    }
                }
                Statement::Block(inner) => {
                    let inner_spans = self.spans_of(inner);
                    if escapes(inner) {
                        let (rest, rest_spans) = rest();
                        return self.run(inner, inner_spans, &Next::Then(rest, rest_spans, next), state, out);
                    }
                    self.run(inner, inner_spans, &Next::Nothing, state, out)?;
                }
                Statement::If { condition, accept, reject } => {
                    let condition = self.condition(*condition, state, out)?;
                    let escapes = escapes(accept) || escapes(reject);
                    self.settle_all(state, out)?;
                    let (rest, rest_spans) = rest();
                    let after = if escapes { Next::Then(rest, rest_spans, next) } else { Next::Nothing };
                    let (mut yes, mut no) = (Vec::new(), Vec::new());
                    let mut other = state.clone();
                    self.run(accept, self.spans_of(accept), &after, state, &mut yes)?;
                    self.run(reject, self.spans_of(reject), &after, &mut other, &mut no)?;
                    self.merge(condition, state, other, yes, no, out)?;
                    if escapes {
                        return Ok(());
                    }
                }
                Statement::Switch { selector, cases } => {
                    let (chain, escapes) = self.switch(*selector, cases, span, state, out)?;
                    let (rest, rest_spans) = rest();
                    let after = if escapes { Next::Then(rest, rest_spans, next) } else { Next::Nothing };
                    self.cases(&chain, &after, state, out)?;
                    if escapes {
                        return Ok(());
                    }
                }
                Statement::Loop { body, continuing, break_if } => {
                    let may_return = returns(body) || returns(continuing);
                    let outer = std::mem::replace(&mut state.broke, Ex::Bool(false));
                    self.run_loop(body, continuing, *break_if, span, state, out)?;
                    state.broke = outer;
                    if may_return && state.returned != Ex::Bool(false) {
                        // What follows is for those that have not returned.
                        let (rest, rest_spans) = rest();
                        let condition = state.returned.clone();
                        let mut other = state.clone();
                        let mut no = Vec::new();
                        state.returned = Ex::Bool(true);
                        other.returned = Ex::Bool(false);
                        self.run(rest, rest_spans, next, &mut other, &mut no)?;
                        return self.merge(condition, state, other, Vec::new(), no, out);
                    }
                }
                Statement::Break => {
                    let mut after = next;
                    while let Next::Then(_, _, outer) = after {
                        after = outer;
                    }
                    if let Next::Case(after) = after {
                        return self.run(&[], &[], after, state, out);
                    }
                    state.broke = Ex::Bool(true);
                    return Ok(());
                }
                Statement::Continue => return self.turn(state, out),
                Statement::Return { value } => {
                    if let Some(value) = value {
                        state.result = Some(self.value(*value, state, out)?);
                    }
                    state.returned = Ex::Bool(true);
                    return Ok(());
                }
                Statement::Store { pointer, value } => {
                    let new = self.value(*value, state, out)?;
                    self.store(*pointer, new, state, out)?;
                }
                Statement::Call { function, arguments, result } => self.call(*function, arguments, *result, span, state, out)?,
                Statement::Kill => {
                    return Err(self.fail(span, "`discard` can't be said: a formula has a value everywhere".to_owned(), "leave the function out"));
                }
                _ => return Err(self.fail(span, "this can't be said in a formula".to_owned(), "leave the function out")),
            }
        }
        match next {
            Next::Nothing => Ok(()),
            Next::Then(rest, spans, after) => self.run(rest, spans, after, state, out),
            Next::Case(after) => self.run(&[], &[], after, state, out),
            Next::Turn => self.turn(state, out),
        }
    }

    /// What a loop does between two turns.
    fn turn(&mut self, state: &mut State, out: &mut Vec<Step>) -> Result<(), Failure> {
        let Some((continuing, break_if)) = self.turns.last().copied() else { return Ok(()) };
        self.run(continuing, self.spans_of(continuing), &Next::Nothing, state, out)?;
        if let Some(condition) = break_if {
            state.broke = self.condition(condition, state, out)?;
        }
        Ok(())
    }

    fn spans_of(&self, block: &'m Block) -> &'m [Span] {
        self.file.spans.get(&(std::ptr::from_ref(block) as usize)).map_or(&[], |spans| spans.as_slice())
    }

    fn condition(&mut self, handle: Handle<Expression>, state: &mut State, out: &mut Vec<Step>) -> Result<Ex, Failure> {
        let value = self.value(handle, state, out)?;
        value.one().ok_or_else(|| self.unsaid(handle)(("several conditions are none".to_owned(), "write `all(…)` or `any(…)`")))
    }

    /// Joins what both sides of a condition came to.
    fn merge(&mut self, condition: Ex, state: &mut State, other: State, yes: Vec<Step>, no: Vec<Step>, out: &mut Vec<Step>) -> Result<(), Failure> {
        let mut outs = Vec::new();
        for (root, value) in std::mem::take(&mut state.roots) {
            let theirs = other.roots.get(&root).unwrap_or(&value).clone();
            let names = self.leaf_names(root);
            let value = self.joined(&value, &theirs, &names, &mut outs);
            state.roots.insert(root, value);
        }
        let flag = |f: &mut Self, a: &Ex, b: &Ex, name: &str, outs: &mut Vec<_>| {
            if a == b {
                return a.clone();
            }
            let id = f.name(name, false);
            outs.push((id, a.clone(), b.clone()));
            Ex::Id(id)
        };
        state.broke = flag(self, &state.broke, &other.broke, "stopped", &mut outs);
        state.returned = flag(self, &state.returned, &other.returned, "returned", &mut outs);
        state.result = match (state.result.take(), other.result) {
            (Some(a), Some(b)) => Some(self.joined(&a, &b, &[], &mut outs)),
            (a, b) => a.or(b),
        };
        if outs.is_empty() {
            return Ok(());
        }
        match condition {
            Ex::Bool(known) => {
                for step in if known { yes } else { no } {
                    self.step(step, out)?;
                }
                for (id, a, b) in outs {
                    self.step(Step::Let(id, if known { a } else { b }), out)?;
                }
                Ok(())
            }
            condition => self.step(Step::Branch { condition, yes, no, outs }, out),
        }
    }

    fn joined(&mut self, a: &Value, b: &Value, names: &[(String, bool)], outs: &mut Vec<(Id, Ex, Ex)>) -> Value {
        let others: Vec<Ex> = b.leaves().into_iter().cloned().collect();
        let mut leaf = 0;
        a.map(&mut |ex, _| {
            let theirs = others.get(leaf).cloned().unwrap_or_else(|| ex.clone());
            let (name, whole) = names.get(leaf).cloned().unwrap_or_default();
            leaf += 1;
            if *ex == theirs {
                return theirs;
            }
            let id = self.name(&name, whole);
            outs.push((id, ex.clone(), theirs));
            Ex::Id(id)
        })
    }

    /// A value whose longer expressions have names.
    fn named(&mut self, value: &Value, out: &mut Vec<Step>) -> Result<Value, Failure> {
        let mut steps = Vec::new();
        let value = value.map(&mut |ex, _| {
            if ex.is_short() {
                return ex.clone();
            }
            let id = self.name("", false);
            steps.push(Step::Let(id, ex.clone()));
            Ex::Id(id)
        });
        for step in steps {
            self.step(step, out)?;
        }
        Ok(value)
    }

    /// Gives what a variable holds its name.
    fn settle(&mut self, root: Root, state: &mut State, out: &mut Vec<Step>) -> Result<(), Failure> {
        if self.plain {
            return Ok(());
        }
        let Some(value) = state.roots.get(&root).cloned() else { return Ok(()) };
        let names = self.leaf_names(root);
        let (mut leaf, mut steps) = (0, Vec::new());
        let settled = value.map(&mut |ex, _| {
            let (name, whole) = names.get(leaf).cloned().unwrap_or_default();
            leaf += 1;
            let is_named = matches!(ex, Ex::Id(_) | Ex::Global(_) | Ex::Unknown(_)) || name.is_empty() && ex.is_short();
            if is_named {
                return ex.clone();
            }
            let id = self.name(&name, whole);
            steps.push(Step::Let(id, ex.clone()));
            Ex::Id(id)
        });
        state.roots.insert(root, settled);
        for step in steps {
            self.step(step, out)?;
        }
        Ok(())
    }

    /// The same for all variables whose values are long: they would be written on both sides of a condition.
    fn settle_all(&mut self, state: &mut State, out: &mut Vec<Step>) -> Result<(), Failure> {
        let is_long = |ex: &&Ex| match ex {
            Ex::Vector(all) => !all.iter().all(Ex::is_short),
            ex => !ex.is_short(),
        };
        let long: Vec<Root> = state.roots.iter().filter(|(_, value)| value.leaves().iter().any(is_long)).map(|(root, _)| *root).collect();
        long.into_iter().try_for_each(|root| self.settle(root, state, out))
    }

    // ---- Loops ----

    fn run_loop(&mut self, body: &'m Block, continuing: &'m Block, break_if: Option<Handle<Expression>>, span: Span, state: &mut State, out: &mut Vec<Step>) -> Result<(), Failure> {
        let mut roots = Vec::new();
        self.stored(body, &mut roots);
        self.stored(continuing, &mut roots);
        roots.sort_unstable();
        roots.dedup();
        let may_return = returns(body);
        let mut first: Vec<Ex> = Vec::new();
        let mut ids: Vec<Id> = Vec::new();
        for root in &roots {
            self.entry(*root, state);
            let names = self.leaf_names(*root);
            let Some(value) = state.roots.get(root).cloned() else { continue };
            let mut leaf = 0;
            let head = value.map(&mut |ex, _| {
                let (name, whole) = names.get(leaf).cloned().unwrap_or_default();
                leaf += 1;
                first.push(ex.clone());
                let id = self.name(&name, whole);
                ids.push(id);
                Ex::Id(id)
            });
            state.roots.insert(*root, head);
        }
        let mut flag = |f: &mut Self, name: &str, at: Ex| {
            let id = f.name(name, false);
            first.push(at);
            ids.push(id);
            id
        };
        let broke = flag(self, "stopped", Ex::Bool(false));
        let returned = may_return.then(|| flag(self, "returned", state.returned.clone()));
        if may_return && let Some(result) = &self.function.result {
            let zero = self.zero(result.ty, span)?;
            let before = state.result.clone().unwrap_or(zero);
            let before: Vec<Ex> = before.leaves().into_iter().cloned().collect();
            let mut leaf = 0;
            let shape = self.zero(result.ty, span)?;
            let head = shape.map(&mut |_, _| {
                first.push(before.get(leaf).cloned().unwrap_or(Ex::Number(0.0)));
                leaf += 1;
                let id = self.name("result", false);
                ids.push(id);
                Ex::Id(id)
            });
            state.result = Some(head);
        }
        let head = state.clone();
        let index = self.name("", true);
        // What it asks before each turn.
        let (asked, begins) = self.asked(body, state)?;
        let mut steps = Vec::new();
        (state.broke, state.returned) = (Ex::Bool(false), Ex::Bool(false));
        self.turns.push((continuing, break_if));
        let rest = body.get(begins..).unwrap_or_default();
        let rest_spans = self.spans_of(body).get(begins..).unwrap_or_default();
        let ran = self.run(rest, rest_spans, &Next::Turn, state, &mut steps);
        self.turns.pop();
        ran?;
        let mut next: Vec<Ex> = roots.iter().filter_map(|root| state.roots.get(root)).flat_map(Value::leaves).cloned().collect();
        next.push(state.broke.clone());
        if may_return {
            next.push(state.returned.clone());
            if let (Some(_), Some(result)) = (&self.function.result, &state.result) {
                next.extend(result.leaves().into_iter().cloned());
            }
        }
        let is_left = next.get(ids.iter().position(|id| *id == broke).unwrap_or(usize::MAX)).is_some_and(|ex| *ex != Ex::Bool(false));
        let mut condition = asked;
        if is_left {
            condition = and(condition, not(Ex::Id(broke)));
        }
        if let Some(returned) = returned {
            condition = and(condition, not(Ex::Id(returned)));
        }
        let turns: Vec<(Id, Ex, Ex)> = ids.into_iter().zip(first).zip(next).map(|((id, first), next)| (id, first, next)).collect();
        let flags: Vec<Id> = [broke].into_iter().chain(returned).collect();
        let counted = turns::count(index, &flags, condition, steps, turns, &self.known, &self.whole).map_err(|why| self.fail(span, why, NO_LOOP))?;
        if let Some(name) = counted.1.and_then(|id| self.names.get(id as usize).cloned())
            && let Some(slot) = self.names.get_mut(index as usize)
        {
            *slot = name;
        }
        // A loop that begins with `break` never turns.
        let counted: Loop = counted.0;
        *state = head;
        state.broke = Ex::Bool(false);
        state.returned = returned.map_or(Ex::Bool(false), Ex::Id);
        self.step(Step::Loop(counted), out)
    }

    /// What a loop asks before it does anything, and where what it does begins. For a loop that asks nothing it is always true.
    fn asked(&mut self, body: &'m Block, state: &mut State) -> Result<(Ex, usize), Failure> {
        let mut at = 0;
        while matches!(body.get(at), Some(Statement::Emit(_))) {
            at += 1;
        }
        let only_breaks = |block: &Block| matches!(**block, [Statement::Break]);
        let Some(Statement::If { condition, accept, reject }) = body.get(at) else { return Ok((Ex::Bool(true), 0)) };
        let goes_on = match (only_breaks(accept) && reject.is_empty(), only_breaks(reject) && accept.is_empty()) {
            (true, _) => false,
            (_, true) => true,
            _ => return Ok((Ex::Bool(true), 0)),
        };
        let before = std::mem::replace(&mut self.plain, true);
        let mut none = Vec::new();
        let ran = self.run(body.get(..at).unwrap_or_default(), &[], &Next::Nothing, state, &mut none);
        let condition = ran.and_then(|()| self.condition(*condition, state, &mut none));
        self.plain = before;
        let condition = condition?;
        Ok((if goes_on { condition } else { not(condition) }, at + 1))
    }

    /// The variables that a block writes.
    fn stored(&self, block: &Block, roots: &mut Vec<Root>) {
        for statement in block.iter() {
            match statement {
                Statement::Store { pointer, .. } => roots.extend(self.root(*pointer)),
                Statement::Call { arguments, .. } => roots.extend(arguments.iter().filter(|handle| self.is_pointer(**handle)).filter_map(|handle| self.root(*handle))),
                Statement::Block(inner) => self.stored(inner, roots),
                Statement::If { accept, reject, .. } => [accept, reject].into_iter().for_each(|block| self.stored(block, roots)),
                Statement::Switch { cases, .. } => cases.iter().for_each(|case| self.stored(&case.body, roots)),
                Statement::Loop { body, continuing, .. } => [body, continuing].into_iter().for_each(|block| self.stored(block, roots)),
                _ => {}
            }
        }
    }

    // ---- Choices among several ----

    /// The cases of a `switch`, each with the condition under which it runs, the one for all others last; and whether any ends elsewhere than after it.
    fn switch(&mut self, selector: Handle<Expression>, cases: &'m [naga::SwitchCase], span: Span, state: &mut State, out: &mut Vec<Step>) -> Result<(Vec<Case<'m>>, bool), Failure> {
        let value = self.value(selector, state, out)?;
        let selector = self.named(&value, out)?.one().unwrap_or(Ex::Number(0.0));
        let (mut chain, mut conditions, mut others, mut ends_elsewhere) = (Vec::new(), Vec::new(), None, false);
        for case in cases {
            let number = match case.value {
                naga::SwitchValue::I32(value) => Some(f64::from(value)),
                naga::SwitchValue::U32(value) => Some(f64::from(value)),
                naga::SwitchValue::Default => None,
            };
            conditions.push(number.map_or(Ex::Bool(true), |number| formula::binary("==", selector.clone(), Ex::Number(number))));
            if case.fall_through && case.body.iter().all(|statement| matches!(statement, Statement::Emit(_))) {
                continue;
            }
            if case.fall_through && !ends(&case.body) {
                return Err(self.fail(span, "a case of this `switch` goes on into the next".to_owned(), "end each case with `break`, or write `if` and `else`"));
            }
            let (body, spans) = (&*case.body, self.spans_of(&case.body));
            ends_elsewhere |= leaves(body, true);
            match conditions.drain(..).reduce(formula::or) {
                Some(Ex::Bool(true)) => others = Some((Ex::Bool(true), body, spans)),
                Some(condition) => chain.push((condition, body, spans)),
                None => {}
            }
        }
        chain.extend(others);
        Ok((chain, ends_elsewhere))
    }

    fn cases(&mut self, chain: &[Case<'m>], next: &Next<'m, '_>, state: &mut State, out: &mut Vec<Step>) -> Result<(), Failure> {
        let Some(((condition, block, spans), rest)) = chain.split_first() else { return self.run(&[], &[], next, state, out) };
        self.settle_all(state, out)?;
        let (mut yes, mut no) = (Vec::new(), Vec::new());
        let mut other = state.clone();
        self.run(block, spans, &Next::Case(next), state, &mut yes)?;
        if *condition == Ex::Bool(true) {
            return yes.into_iter().try_for_each(|step| self.step(step, out));
        }
        self.cases(rest, next, &mut other, &mut no)?;
        self.merge(condition.clone(), state, other, yes, no, out)
    }

    // ---- Variables ----

    /// The variable that a pointer leads to.
    fn root(&self, handle: Handle<Expression>) -> Option<Root> {
        match self.function.expressions.try_get(handle).ok()? {
            Expression::LocalVariable(local) => Some(Root::Local(local.index())),
            Expression::FunctionArgument(i) => Some(Root::Argument(*i)),
            Expression::GlobalVariable(global) => Some(Root::Global(global.index())),
            Expression::Access { base, .. } | Expression::AccessIndex { base, .. } => self.root(*base),
            _ => None,
        }
    }

    fn place(&mut self, handle: Handle<Expression>, state: &mut State, out: &mut Vec<Step>) -> Result<(Root, Vec<Access>), Failure> {
        match self.function.expressions.try_get(handle) {
            Ok(Expression::Access { base, index }) => {
                let (root, mut path) = self.place(*base, state, out)?;
                let index = self.value(*index, state, out)?.one().unwrap_or(Ex::Number(0.0));
                path.push(self.at(index));
                Ok((root, path))
            }
            Ok(Expression::AccessIndex { base, index }) => {
                let (root, mut path) = self.place(*base, state, out)?;
                path.push(Access::At(*index as usize));
                Ok((root, path))
            }
            _ => {
                let root = self.root(handle).ok_or_else(|| self.unsaid(handle)(("this can't be written to".to_owned(), "leave the function out")))?;
                Ok((root, Vec::new()))
            }
        }
    }

    fn at(&self, index: Ex) -> Access {
        let known = match &index {
            Ex::Number(value) => Some(*value),
            Ex::Id(id) => self.known.get(id).copied(),
            _ => None,
        };
        match known {
            Some(value) if value >= 0.0 => Access::At(value as usize),
            _ => Access::Of(index),
        }
    }

    /// What a variable of the file holds at first.
    fn entry(&mut self, root: Root, state: &mut State) {
        let Root::Global(i) = root else { return };
        if state.roots.contains_key(&root) {
            return;
        }
        if let Some(value) = self.file.globals.get(i).cloned().flatten() {
            state.roots.insert(root, value);
        }
    }

    fn read(&mut self, handle: Handle<Expression>, state: &mut State, out: &mut Vec<Step>) -> Result<Value, Failure> {
        let (root, path) = self.place(handle, state, out)?;
        self.entry(root, state);
        self.settle(root, state, out)?;
        let lacking = |f: &Self| f.unsaid(handle)((format!("`{}` is nothing that a formula can read", f.root_name(root)), "what a shader gets from outside is `iTime`, and uniforms of numbers and vectors"));
        let Some(mut value) = state.roots.get(&root).cloned() else { return Err(lacking(self)) };
        let mut inner = self.root_type(root);
        for access in path {
            let (element, index) = match access {
                Access::At(i) => (value.element(i, &inner), i),
                Access::Of(ex) => (value.pick(&ex, &inner), 0),
            };
            value = element.ok_or_else(|| lacking(self))?;
            inner = self.child(&inner, index);
        }
        Ok(value)
    }

    fn child(&self, inner: &TypeInner, index: usize) -> TypeInner {
        let types = &self.file.read.module.types;
        match inner {
            TypeInner::Vector { scalar, .. } => TypeInner::Scalar(*scalar),
            TypeInner::Matrix { rows, scalar, .. } => TypeInner::Vector { size: *rows, scalar: *scalar },
            TypeInner::Array { base, .. } => types[*base].inner.clone(),
            TypeInner::Struct { members, .. } => members.get(index).map_or_else(|| inner.clone(), |member| types[member.ty].inner.clone()),
            inner => inner.clone(),
        }
    }

    fn store(&mut self, pointer: Handle<Expression>, new: Value, state: &mut State, out: &mut Vec<Step>) -> Result<(), Failure> {
        let (root, path) = self.place(pointer, state, out)?;
        self.entry(root, state);
        let lacking = |f: &Self| f.unsaid(pointer)(("this can't be written to".to_owned(), "leave the function out"));
        let Some(old) = state.roots.get(&root).cloned() else { return Err(lacking(self)) };
        let value = self.set(&old, &self.root_type(root), &path, &new).ok_or_else(|| lacking(self))?;
        state.roots.insert(root, value);
        Ok(())
    }

    fn set(&self, old: &Value, inner: &TypeInner, path: &[Access], new: &Value) -> Option<Value> {
        let Some((access, rest)) = path.split_first() else { return Some(new.clone()) };
        match access {
            Access::At(i) => {
                let child = self.set(&old.element(*i, inner)?, &self.child(inner, *i), rest, new)?;
                old.with(*i, child, inner)
            }
            Access::Of(index) => {
                let count = match (old, inner) {
                    (Value::Many(all), _) => all.len(),
                    (_, TypeInner::Vector { size, .. }) => *size as usize,
                    (_, TypeInner::Matrix { columns, .. }) => *columns as usize,
                    _ => return None,
                };
                let mut value = old.clone();
                for i in 0..count {
                    let before = old.element(i, inner)?;
                    let after = self.set(&before, &self.child(inner, i), rest, new)?;
                    let after: Vec<Ex> = after.leaves().into_iter().cloned().collect();
                    let mut leaf = 0;
                    let chosen = before.map(&mut |ex, _| {
                        let after = after.get(leaf).cloned().unwrap_or_else(|| ex.clone());
                        leaf += 1;
                        choose(formula::binary("==", index.clone(), Ex::Number(i as f64)), after, ex.clone())
                    });
                    value = value.with(i, chosen, inner)?;
                }
                Some(value)
            }
        }
    }

    // ---- Calls ----

    fn call(&mut self, function: Handle<naga::Function>, arguments: &[Handle<Expression>], result: Option<Handle<Expression>>, span: Span, state: &mut State, out: &mut Vec<Step>) -> Result<(), Failure> {
        let made = match self.file.made.get(&function) {
            Some(Ok(made)) => made,
            Some(Err(why)) => return Err(why.clone()),
            None => return Err(self.fail(span, "this function is called before it is known".to_owned(), "declare it earlier")),
        };
        let mut given = Vec::new();
        for argument in arguments {
            let value = if self.is_pointer(*argument) { self.read(*argument, state, out)? } else { self.value(*argument, state, out)? };
            given.extend(value.leaves().into_iter().cloned());
        }
        if made.results.len() > 1 {
            // Several functions get them.
            let value = Value::Many(given.into_iter().map(Value::One).collect());
            given = self.named(&value, out)?.leaves().into_iter().cloned().collect();
        }
        let mut values = made.results.iter().map(|made| Ex::Call(made.name.clone(), given.clone()));
        if let Some(result) = result {
            let zero = value::zero(&self.file.read.module, self.inner(result)).ok_or_else(|| self.fail(span, "this is of a type that the language has not".to_owned(), TYPES))?;
            let own: Vec<Ex> = values.by_ref().take(made.own).collect();
            let mut leaf = 0;
            let value = zero.map(&mut |zero, _| {
                leaf += 1;
                own.get(leaf - 1).cloned().unwrap_or_else(|| zero.clone())
            });
            let is_used_often = self.info[result].ref_count > 1 && !self.plain;
            let value = if is_used_often { self.named(&value, out)? } else { value };
            self.done.insert(result, value);
        }
        for (argument, count) in &made.written {
            let leaves: Vec<Ex> = values.by_ref().take(*count).collect();
            let Some(pointer) = arguments.get(*argument) else { continue };
            let old = self.read(*pointer, state, out)?;
            let mut leaf = 0;
            let new = old.map(&mut |ex, _| {
                leaf += 1;
                leaves.get(leaf - 1).cloned().unwrap_or_else(|| ex.clone())
            });
            self.store(*pointer, new, state, out)?;
        }
        Ok(())
    }

    // ---- Expressions ----

    fn value(&mut self, handle: Handle<Expression>, state: &mut State, out: &mut Vec<Step>) -> Result<Value, Failure> {
        if let Some(known) = self.done.get(&handle) {
            return Ok(known.clone());
        }
        self.compute(handle, state, out)
    }

    fn ex(&mut self, handle: Handle<Expression>, state: &mut State, out: &mut Vec<Step>) -> Result<Ex, Failure> {
        let value = self.value(handle, state, out)?;
        value.one().ok_or_else(|| self.unsaid(handle)(("a number or vector is needed here".to_owned(), "write it for each member")))
    }

    fn compute(&mut self, handle: Handle<Expression>, state: &mut State, out: &mut Vec<Step>) -> Result<Value, Failure> {
        let function = self.function;
        let expression = function.expressions.try_get(handle).map_err(|_| Failure::nowhere())?;
        Ok(match expression {
            Expression::Literal(literal) => Value::One(formula::literal(*literal).map_err(self.unsaid(handle))?),
            Expression::Constant(constant) => self.file.constant(*constant).ok_or_else(|| self.unsaid(handle)(("this constant can't be said".to_owned(), "write it out")))?,
            Expression::ZeroValue(ty) => self.zero(*ty, function.expressions.get_span(handle))?,
            Expression::Compose { ty, components } => {
                let mut values = Vec::new();
                for component in components {
                    values.push(self.value(*component, state, out)?);
                }
                let inner = self.pointee(*ty);
                compose(&inner, values).ok_or_else(|| self.unsaid(handle)(("this is of a type that the language has not".to_owned(), TYPES)))?
            }
            Expression::Access { base, index } => {
                let value = self.value(*base, state, out)?;
                let index = self.value(*index, state, out)?.one().unwrap_or(Ex::Number(0.0));
                let inner = self.inner(*base).clone();
                let element = match self.at(index) {
                    Access::At(i) => value.element(i, &inner),
                    Access::Of(ex) => value.pick(&ex, &inner),
                };
                element.ok_or_else(|| self.unsaid(handle)(("this has no such element".to_owned(), "write another index")))?
            }
            Expression::AccessIndex { base, index } => {
                let value = self.value(*base, state, out)?;
                let element = value.element(*index as usize, self.inner(*base));
                element.ok_or_else(|| self.unsaid(handle)(("this has no such element".to_owned(), "write another index")))?
            }
            Expression::Splat { size, value } => match self.value(*value, state, out)? {
                Value::One(ex) if self.inner(*value).scalar_kind() == Some(naga::ScalarKind::Bool) => Value::Many(vec![Value::One(ex); *size as usize]),
                Value::One(ex) => Value::One(Ex::Call(format!("vec{}", *size as usize), vec![ex])),
                many => many,
            },
            Expression::Swizzle { size, vector, pattern } => {
                let places: Vec<usize> = pattern.iter().take(*size as usize).map(|component| *component as usize).collect();
                match self.value(*vector, state, out)? {
                    Value::One(ex) => Value::One(super::program::part_of(ex, &places.iter().filter_map(|i| value::letter(*i)).collect::<String>())),
                    Value::Many(all) => Value::Many(places.iter().filter_map(|i| all.get(*i).cloned()).collect()),
                }
            }
            Expression::FunctionArgument(i) => self.arguments.get(*i as usize).cloned().ok_or_else(Failure::nowhere)?,
            Expression::Load { pointer } => self.read(*pointer, state, out)?,
            Expression::Unary { op, expr } => {
                let value = self.value(*expr, state, out)?;
                match op {
                    UnaryOperator::LogicalNot => value.map(&mut |ex, _| not(ex.clone())),
                    UnaryOperator::Negate => value.map(&mut |ex, _| match ex {
                        Ex::Number(value) => Ex::Number(-value),
                        ex => Ex::Unary('-', Box::new(ex.clone())),
                    }),
                    UnaryOperator::BitwiseNot => return Err(self.unsaid(handle)(("operations on bits can't be said".to_owned(), formula::BITS))),
                }
            }
            Expression::Binary { op, left, right } => {
                if let Some((x, y)) = self.modulo(*op, *left, *right) {
                    let (x, y) = (self.ex(x, state, out)?, self.ex(y, state, out)?);
                    return Ok(Value::One(formula::binary("%", x, y)));
                }
                let (a, b) = (self.value(*left, state, out)?, self.value(*right, state, out)?);
                // Of a vector and a number, and of a matrix and anything, the operation is that of floating-point numbers.
                formula::operate(*op, a, b, self.inner(*left)).map_err(self.unsaid(handle))?
            }
            Expression::Select { condition, accept, reject } => {
                let (a, b) = (self.value(*accept, state, out)?, self.value(*reject, state, out)?);
                match (self.value(*condition, state, out)?, a, b) {
                    (Value::One(condition), a, b) => {
                        let others: Vec<Ex> = b.leaves().into_iter().cloned().collect();
                        let mut leaf = 0;
                        a.map(&mut |ex, _| {
                            leaf += 1;
                            choose(condition.clone(), ex.clone(), others.get(leaf - 1).cloned().unwrap_or_else(|| ex.clone()))
                        })
                    }
                    (Value::Many(conditions), Value::One(a), Value::One(b)) => {
                        let of = |ex: &Ex, i: usize| super::program::part_of(ex.clone(), value::letter(i).unwrap_or("x"));
                        let parts = conditions.into_iter().filter_map(Value::one).enumerate().map(|(i, condition)| choose(condition, of(&a, i), of(&b, i)));
                        Value::One(Ex::Vector(parts.collect()))
                    }
                    _ => return Err(self.unsaid(handle)(("this choice can't be said".to_owned(), "write `if` and `else`"))),
                }
            }
            Expression::Relational { fun, argument } => {
                let value = self.value(*argument, state, out)?;
                Value::One(match fun {
                    naga::RelationalFunction::All => formula::gather(&value, true),
                    naga::RelationalFunction::Any => formula::gather(&value, false),
                    // No number is infinite here, and none is no number.
                    _ => Ex::Bool(false),
                })
            }
            Expression::Math { fun, arg, arg1, arg2, arg3 } => {
                let mut arguments = Vec::new();
                for argument in [Some(*arg), *arg1, *arg2, *arg3].into_iter().flatten() {
                    arguments.push(self.ex(argument, state, out)?);
                }
                let whole = !matches!(self.inner(*arg).scalar_kind(), Some(naga::ScalarKind::Float | naga::ScalarKind::AbstractFloat));
                Value::One(formula::math(*fun, arguments, whole).map_err(self.unsaid(handle))?)
            }
            Expression::As { expr, kind, convert } => {
                let value = self.value(*expr, state, out)?;
                if convert.is_none() && self.inner(*expr).scalar_kind() != Some(*kind) {
                    return Err(self.unsaid(handle)(("the bits of a number can't be said".to_owned(), formula::BITS)));
                }
                formula::convert(value, self.inner(*expr), *kind).map_err(self.unsaid(handle))?
            }
            Expression::ImageSample { .. } | Expression::ImageLoad { .. } | Expression::ImageQuery { .. } => {
                return Err(self.unsaid(handle)(("a formula reads no textures".to_owned(), "write `value_noise`, `perlin` or `fbm` in its place, or leave the function out")));
            }
            Expression::Derivative { .. } => {
                return Err(self.unsaid(handle)(("a formula knows nothing of the pixels beside: it has no derivatives".to_owned(), "leave the function out")));
            }
            _ => return Err(self.unsaid(handle)(("this can't be said in a formula".to_owned(), "leave the function out"))),
        })
    }

    /// `x - floor(x / y) * y` is `mod(x, y)`, which is how naga reads it.
    fn modulo(&self, op: naga::BinaryOperator, left: Handle<Expression>, right: Handle<Expression>) -> Option<(Handle<Expression>, Handle<Expression>)> {
        use naga::BinaryOperator as B;
        let of = |handle| self.function.expressions.try_get(handle).ok();
        let Expression::Binary { op: B::Multiply, left: floor, right: y } = of(right)? else { return None };
        let is_floor = |handle| matches!(of(handle), Some(Expression::Math { fun: naga::MathFunction::Floor, .. }));
        let (floor, y) = if is_floor(*floor) { (floor, y) } else { (y, floor) };
        let Expression::Math { fun: naga::MathFunction::Floor, arg, .. } = of(*floor)? else { return None };
        let Expression::Binary { op: B::Divide, left: x, right: by } = of(*arg)? else { return None };
        (op == B::Subtract && *x == left && by == y).then_some((left, *y))
    }
}

const TYPES: &str = "the language has conditions, numbers, vectors of 2 to 4, square matrices, and in a shader structs and short arrays of them";

fn joined(base: &str, rest: &str) -> String {
    match (base, rest) {
        (base, "") => base.to_owned(),
        ("", rest) => rest.to_owned(),
        (base, rest) => format!("{base}_{rest}"),
    }
}

fn note_unknown(ex: &Ex, unknown: &mut Option<String>) {
    if let Ex::Unknown(name) = ex {
        unknown.get_or_insert_with(|| name.clone());
    }
}

/// A case: when it runs, what it does, and where that stands.
type Case<'m> = (Ex, &'m [Statement], &'m [Span]);

/// Whether a block may end other than at its end.
fn escapes(block: &[Statement]) -> bool {
    leaves(block, false)
}

/// The same; in a `switch` a `break` is an end of that.
fn leaves(block: &[Statement], in_switch: bool) -> bool {
    block.iter().any(|statement| match statement {
        Statement::Return { .. } | Statement::Continue => true,
        Statement::Break => !in_switch,
        Statement::Block(inner) => leaves(inner, in_switch),
        Statement::If { accept, reject, .. } => leaves(accept, in_switch) || leaves(reject, in_switch),
        Statement::Switch { cases, .. } => cases.iter().any(|case| leaves(&case.body, true)),
        // What returns from within is seen when the loop has ended.
        Statement::Loop { .. } => returns_from(statement),
        _ => false,
    })
}

/// Whether a block never goes on after its end.
fn ends(block: &[Statement]) -> bool {
    match block.last() {
        Some(Statement::Break | Statement::Continue | Statement::Return { .. }) => true,
        Some(Statement::Block(inner)) => ends(inner),
        Some(Statement::If { accept, reject, .. }) => ends(accept) && ends(reject),
        _ => false,
    }
}

fn returns_from(statement: &Statement) -> bool {
    match statement {
        Statement::Return { .. } => true,
        Statement::Block(inner) => returns(inner),
        Statement::If { accept, reject, .. } => returns(accept) || returns(reject),
        Statement::Switch { cases, .. } => cases.iter().any(|case| returns(&case.body)),
        Statement::Loop { body, continuing, .. } => returns(body) || returns(continuing),
        _ => false,
    }
}

fn returns(block: &[Statement]) -> bool {
    block.iter().any(returns_from)
}
