//! Expressions as a person would write them: what is used twice or has a name stands in a `let`, the rest is nested while short.

use super::arms::{Arms, BlockId};
use super::body::{Body, Code, ExprId};
use super::library::{Helpers, helper_of};
use super::names::{Scope, identifier};
use super::plan::{Plans, TargetId, split_axis};
use super::table::Tables;
use super::uniforms::Candidates;
use crate::graph::Graph;
use crate::graph::interval::Interval;
use crate::graph::kernel::{self, Op, Terms};
use rustc_hash::FxHashMap;
use std::fmt::Write;
use std::ops::Range;

/// What writing a function needs to know of the module.
pub struct Context<'a> {
    /// The graph, for names.
    pub graph: &'a Graph,
    /// The functions of shapes.
    pub plans: &'a Plans<'a>,
    /// Name of each function that stands alone, by target.
    pub functions: FxHashMap<TargetId, String>,
    /// Operations in one call of each, as far as they are written.
    pub operations: FxHashMap<TargetId, usize>,
    /// Names of the module.
    pub module: Scope,
    /// Before every name of the module.
    pub prefix: &'a str,
    /// Name of the uniform block's variable.
    pub uniform_name: String,
    /// Live values; those that are read are marked.
    pub uniforms: Candidates,
    /// Helpers; those that are called are marked.
    pub helpers: Helpers,
    /// Texts of numbers, by their bits: most stand in several functions.
    pub numbers: FxHashMap<u32, String>,
    /// Room that each function is written with.
    pub room: Room,
    /// Whether the point of the scene is read as it is, and not only as the way from a place far out.
    pub reads_scene: bool,
    /// The unions that are tables.
    pub tables: &'a Tables,
}

impl Context<'_> {
    /// Whether a function that is written reads a table.
    pub fn has_tables(&self) -> bool {
        self.functions.keys().filter_map(|id| self.plans.get(*id)).any(|t| self.plans.table(t).is_some())
    }
}

/// What is written of a function so far. It is kept for the next one's sake, empty.
#[derive(Debug, Default)]
pub struct Room {
    scratch: String,
    states: Vec<State>,
    ranges: Vec<Interval>,
    order: Vec<ExprId>,
    stack: Vec<(ExprId, usize)>,
    locals: Scope,
}

/// What is known of an expression while its function is written.
#[derive(Clone, Copy, Debug, Default)]
struct State {
    text: Text,
    /// How often it is used.
    uses: u32,
    /// Whether it can't be negative, however it is rounded.
    not_negative: bool,
    /// Whether it is a vector of which components are read.
    taken_apart: bool,
    /// Whether it is a root, or the least or largest of roots that nothing else reads.
    rooted: bool,
    /// Whether its square is written instead, of which another one takes the root.
    squared: bool,
    /// Whether its range matters: something below a division is made of it.
    ranged: bool,
}

/// Text of an expression, in the scratch of its writer.
#[derive(Clone, Copy, Debug, Default)]
struct Text {
    start: u32,
    length: u32,
    /// How strongly it binds: 9 for names and calls.
    strength: u8,
    /// Whether it is as short as it can be: a name, a number.
    atom: bool,
}

impl Text {
    fn range(self) -> Range<usize> {
        self.start as usize..(self.start + self.length) as usize
    }
}

/// From a place further out than this the way is taken from the module's origin first, of which no digit is lost: near the eye both are near it,
/// and the point of the scene is not.
pub const FAR_OUT: f64 = 64.0;

/// A nested expression longer than this is split.
const LONGEST: u32 = 78;

/// What is no longer than this is not split from what it stands in.
const SHORTEST: u32 = 12;

struct Writer<'c, 'a> {
    context: &'c mut Context<'a>,
    body: &'c Body,
    out: &'c mut String,
    scratch: String,
    states: Vec<State>,
    /// All values, where a division needs to know; else empty.
    ranges: Vec<Interval>,
    locals: Scope,
    operations: usize,
    /// What is computed in which branch, and which one is being written, so far in.
    arms: Arms,
    block: BlockId,
    depth: usize,
}

/// Writes the lines that compute `root` and give it back. `arguments` are names that the function's arguments have.
/// The answer: how many operations of the kernel that takes.
pub fn write(
    context: &mut Context,
    body: &mut Body,
    root: ExprId,
    arguments: &[&str],
    out: &mut String,
) -> usize {
    let root = body.share(context.graph, context.plans, root);
    let Room { scratch, mut states, mut ranges, mut order, mut stack, mut locals } = std::mem::take(&mut context.room);
    for name in arguments {
        locals.reserve(name);
    }
    let count = body.len();
    let divides = (0..count as u32).any(|e| {
        body.code(e) == Code::Op(Op::Div)
            && body.arguments(e).get(1).is_some_and(|&b| body.as_constant(b).is_none())
    });
    states.resize(count, State::default());
    ranges.resize(if divides { count } else { 0 }, Interval::ALL);
    let mut writer = Writer { context, body, out, scratch, states, ranges, locals, operations: 0, arms: Arms::default(), block: 0, depth: 1 };
    writer.order(root, &mut order, &mut stack);
    if divides {
        writer.want_ranges(&order);
    }
    let arms = Arms::find(writer.body, &order, |id| match writer.body.code(id) {
        Code::Call(target) => writer.context.operations.get(&target).copied().unwrap_or(0),
        Code::VectorOp(_, count) => usize::from(count),
        Code::Op(_) => 1,
        _ => 0,
    });
    // Branch by branch; in each, arguments first as before.
    if arms.any() {
        order.sort_by_key(|&id| arms.place(id));
    }
    writer.arms = arms;
    let mut has_scene = false;
    for &id in &order {
        match writer.body.code(id) {
            Code::Component(_) | Code::Swizzle(..) => {
                let vector = writer.argument(id, 0);
                if let Some(state) = writer.states.get_mut(vector as usize) {
                    state.taken_apart = true;
                }
            }
            Code::Scene => has_scene = true,
            _ => {}
        }
    }
    writer.mark_squares(&order);
    for &id in order.iter().filter(|_| has_scene) {
        let code = writer.body.code(id);
        let reads = writer.body.arguments(id).iter().any(|&a| writer.of_scene(a).is_some());
        if reads && !matches!(code, Code::Component(_) | Code::Swizzle(..)) && !writer.is_far_out(code, writer.body.arguments(id)) {
            writer.context.reads_scene = true;
        }
    }
    writer.block(0, &order, Some(root));
    let result = writer.text(root);
    let Writer { mut scratch, mut states, mut ranges, mut locals, operations, out, .. } = writer;
    out.push_str("  return ");
    out.push_str(scratch.get(result.range()).unwrap_or("0.0"));
    out.push_str(";\n");
    scratch.clear();
    states.clear();
    ranges.clear();
    order.clear();
    locals.clear();
    context.room = Room { scratch, states, ranges, order, stack, locals };
    operations
}

impl Writer<'_, '_> {
    /// What the root needs, arguments first, into `order`; and how often each is used.
    fn order(&mut self, root: ExprId, order: &mut Vec<ExprId>, stack: &mut Vec<(ExprId, usize)>) {
        stack.push((root, 0));
        if let Some(state) = self.states.get_mut(root as usize) {
            state.uses = 1;
        }
        while let Some((id, at)) = stack.last_mut() {
            match self.body.arguments(*id).get(*at) {
                None => {
                    order.push(*id);
                    stack.pop();
                }
                Some(&next) => {
                    *at += 1;
                    if let Some(state) = self.states.get_mut(next as usize) {
                        state.uses += 1;
                        if state.uses == 1 {
                            stack.push((next, 0));
                        }
                    }
                }
            }
        }
    }

    /// Finds where the least or the largest of roots is the root of the least or largest square: one root is computed for all of them.
    fn mark_squares(&mut self, order: &[ExprId]) {
        let is_extremum = |code| matches!(code, Code::Op(Op::Min | Op::Max));
        for &id in order {
            let code = self.body.code(id);
            let alone = |a: ExprId| self.state(a).rooted && self.state(a).uses == 1 && self.body.named(a).is_none();
            let rooted = match code {
                Code::Op(Op::Sqrt | Op::Length2 | Op::Length3 | Op::Length4) => true,
                _ => is_extremum(code) && self.body.arguments(id).iter().all(|a| alone(*a)),
            };
            if let Some(state) = self.states.get_mut(id as usize) {
                state.rooted = rooted;
            }
        }
        for &id in order.iter().filter(|id| is_extremum(self.body.code(**id))) {
            let rooted = self.state(id).rooted;
            for &arg in self.body.arguments(id).iter().filter(|_| rooted) {
                if let Some(state) = self.states.get_mut(arg as usize) {
                    state.squared = true;
                }
            }
        }
    }

    /// Marks what is below a division, and what that is made of. `order` has arguments first.
    fn want_ranges(&mut self, order: &[ExprId]) {
        for &id in order.iter().rev() {
            let args = self.body.arguments(id);
            let wanted = match self.body.code(id) {
                _ if self.state(id).ranged => args,
                Code::Op(Op::Div) | Code::VectorOp(Op::Div, _) => args.get(1..).unwrap_or(&[]),
                _ => &[],
            };
            for &arg in wanted {
                if let Some(state) = self.states.get_mut(arg as usize) {
                    state.ranged = true;
                }
            }
        }
    }

    fn state(&self, id: ExprId) -> State {
        self.states.get(id as usize).copied().unwrap_or_default()
    }

    fn text(&self, id: ExprId) -> Text {
        self.state(id).text
    }

    /// The bytes of a text.
    fn written(&self, text: Text) -> &str {
        self.scratch.get(text.range()).unwrap_or("0.0")
    }

    fn as_number(&self, id: ExprId) -> Option<f64> {
        self.body.as_constant(id)
    }

    fn argument(&self, id: ExprId, i: usize) -> ExprId {
        self.body.arguments(id).get(i).copied().unwrap_or(id)
    }

    /// Writes the expressions of a block.
    fn block(&mut self, block: BlockId, order: &[ExprId], root: Option<ExprId>) {
        let place = |id: &ExprId| self.arms.place(*id);
        let (start, end) = (order.partition_point(|id| place(id) < block), order.partition_point(|id| place(id) <= block));
        let around = std::mem::replace(&mut self.block, block);
        for &id in order.get(start..end).unwrap_or(&[]) {
            match [1, 2].map(|arm| self.arms.branch(id, arm)) {
                [None, None] => self.expression(id, root == Some(id)),
                branches => self.choice(id, branches, order),
            }
        }
        self.block = around;
    }

    /// Writes a choice of which an arm is worth a branch.
    fn choice(&mut self, id: ExprId, [first, second]: [Option<BlockId>; 2], order: &[ExprId]) {
        let &[condition, a, b] = self.body.arguments(id) else { return };
        self.learn(id, self.body.code(id), &[condition, a, b]);
        self.operations += usize::from(self.body.components(id));
        let name = self.fresh(id);
        let start = self.scratch.len();
        match (first, second) {
            (Some(_), Some(_)) => {
                self.scratch.extend_from_within(name.range());
                self.put(": ");
                self.put(vector_type(self.body.components(id)));
            }
            _ => self.assign(name, if first.is_some() { b } else { a }),
        }
        self.line("var ", start, ";");
        let start = self.scratch.len();
        if first.is_none() {
            self.put("!");
        }
        self.put_condition(condition, if first.is_none() { 9 } else { 0 });
        self.line("if ", start, " {");
        for (i, (arm, branch)) in [(a, first), (b, second)].into_iter().filter_map(|(arm, branch)| Some((arm, branch?))).enumerate() {
            if i > 0 {
                self.line("} else {", self.scratch.len(), "");
            }
            self.depth += 1;
            self.block(branch, order, None);
            let start = self.scratch.len();
            self.assign(name, arm);
            self.line("", start, ";");
            self.depth -= 1;
        }
        self.line("}", self.scratch.len(), "");
        if let Some(state) = self.states.get_mut(id as usize) {
            state.text = name;
        }
    }

    /// `name = value` into the scratch.
    fn assign(&mut self, name: Text, value: ExprId) {
        self.scratch.extend_from_within(name.range());
        self.put(" = ");
        self.put_number(value, 0);
    }

    /// A line with what the scratch holds from `start` on in its midst.
    fn line(&mut self, before: &str, start: usize, after: &str) {
        (0..self.depth).for_each(|_| self.out.push_str("  "));
        self.out.push_str(before);
        self.out.push_str(self.scratch.get(start..).unwrap_or_default());
        self.out.push_str(after);
        self.out.push('\n');
    }

    /// Writes an expression into the scratch, and as a `let` where that is better.
    fn expression(&mut self, id: ExprId, is_root: bool) {
        let (code, args) = (self.body.code(id), self.body.arguments(id));
        self.learn(id, code, args);
        self.shorten(id, code, args);
        let start = self.scratch.len() as u32;
        let strength = self.compose(id, code, args);
        let text = Text {
            start,
            length: self.scratch.len() as u32 - start,
            strength,
            atom: matches!(
                code,
                Code::Constant(_)
                    | Code::Point(_)
                    | Code::World
                    | Code::Scene
                    | Code::Normal
                    | Code::Variable(_)
                    | Code::Uniform(..)
                    | Code::Computed(..)
                    | Code::Value(_)
                    | Code::Aside(_)
                    | Code::Row(_)
                    | Code::Component(_)
                    | Code::Swizzle(..)
            ),
        };
        if let Some(state) = self.states.get_mut(id as usize) {
            state.text = text;
        }
        if text.atom || is_root {
            return;
        }
        let light = matches!(code, Code::Op(Op::Neg) | Code::Splat(_));
        // What is longer may get a name later, in a branch that others don't see.
        let short = light && text.length <= SHORTEST && args.first().is_some_and(|&a| self.text(a).atom);
        let named = self.body.named(id).is_some();
        // Components are taken of names only.
        let State { uses, taken_apart, .. } = self.state(id);
        let whole = matches!(code, Code::Call(_) | Code::VectorOp(..)) && taken_apart;
        if uses > 1 && !short || named || whole {
            self.bind(id);
        }
    }

    /// Moves the longest arguments into `let`s until the expression fits on a line.
    fn shorten(&mut self, id: ExprId, code: Code, args: &[ExprId]) {
        // The square of a vector, or of its length, has no helper: it is written as a product of names.
        let of = args.first().filter(|of| !self.text(**of).atom);
        let squares = match code {
            Code::VectorOp(Op::Square, _) => true,
            Code::Op(Op::Length2 | Op::Length3 | Op::Length4) => self.state(id).squared,
            _ => false,
        };
        if let (true, Some(&of)) = (squares, of) {
            self.bind(of);
        }
        loop {
            let (mut total, mut longest, mut which) = (0, SHORTEST, None);
            for &arg in args {
                let text = self.text(arg);
                total += text.length + 2;
                if !text.atom && text.length > longest {
                    (longest, which) = (text.length, Some(arg));
                }
            }
            match which {
                Some(arg) if total > LONGEST => self.bind(arg),
                _ => return,
            }
        }
    }

    /// Gives an expression a name.
    fn bind(&mut self, id: ExprId) {
        let text = self.text(id);
        let name = self.fresh(id);
        let start = self.scratch.len();
        self.scratch.extend_from_within(name.range());
        self.put(" = ");
        self.scratch.extend_from_within(text.range());
        self.line("let ", start, ";");
        if let Some(state) = self.states.get_mut(id as usize) {
            state.text = name;
        }
    }

    /// A name for an expression that is not taken yet.
    fn fresh(&mut self, id: ExprId) -> Text {
        let source = self.body.named(id).and_then(|n| self.context.graph.node_name(n));
        // A vector is named after its first component.
        let is_vector = matches!(self.body.code(id), Code::VectorOp(..) | Code::Vector(_));
        let source = match source.filter(|_| is_vector).and_then(split_axis) {
            Some((vector, _)) => Some(vector),
            None => source,
        };
        let start = self.scratch.len();
        let prefix = self.context.prefix;
        let module = Some(&self.context.module);
        match source {
            Some(source) => {
                let name = identifier(source);
                // Names of the module start with its prefix.
                let outer = module.filter(|_| name.starts_with(prefix));
                self.locals.write(&name, outer, &mut self.scratch);
            }
            None if prefix.is_empty() => {
                let name = self.usual_name(id);
                self.locals.write(name, module, &mut self.scratch);
            }
            None => {
                let name = self.usual_name(id);
                self.locals.write_plain(name, &mut self.scratch);
            }
        }
        Text { start: start as u32, length: (self.scratch.len() - start) as u32, strength: 9, atom: true }
    }

    /// The name that a person would take for a value without one.
    fn usual_name(&self, id: ExprId) -> &'static str {
        match self.body.code(id) {
            Code::Op(op) => match op {
                Op::Cos => "c",
                Op::Sin => "s",
                Op::Min | Op::Max => "d",
                Op::Length2 | Op::Length3 | Op::Length4 => "r",
                Op::Floor | Op::Ceil | Op::Trunc | Op::Round => "n",
                Op::Atan | Op::Atan2 | Op::Asin | Op::Acos => "angle",
                Op::Lt | Op::Le | Op::Eq | Op::And | Op::Or | Op::Not => "is",
                Op::Hash => "h",
                _ => "a",
            },
            Code::Call(target) => match self.context.plans.get(target) {
                Some(t) if t.group == super::plan::Group::Gradient => "g",
                _ => "d",
            },
            Code::Vector(_) | Code::VectorOp(..) | Code::Splat(_) => "v",
            _ => "a",
        }
    }

    /// Notes what is known of an expression's value.
    fn learn(&mut self, id: ExprId, code: Code, args: &[ExprId]) {
        let known = |a: ExprId| self.state(a).not_negative;
        let not_negative = match code {
            Code::Constant(bits) => f64::from_bits(bits) >= 0.0,
            Code::Uniform(index, 1) => {
                let field = self.context.uniforms.get(index);
                field.and_then(|f| f.ranges.first()).is_some_and(|r| r.lo >= 0.0)
            }
            Code::Computed(field, 1) => self.computed_range(field, 0).lo >= 0.0,
            Code::Op(op) => match op {
                Op::Square | Op::Abs | Op::Sqrt | Op::Exp | Op::Pow | Op::Hash => true,
                Op::Length2 | Op::Length3 | Op::Length4 => true,
                Op::Max => args.iter().any(|&a| known(a)),
                Op::Min | Op::Add | Op::Mul | Op::Div => args.iter().all(|&a| known(a)),
                Op::Select => args.iter().skip(1).all(|&a| known(a)),
                _ => false,
            },
            _ => false,
        };
        if let Some(state) = self.states.get_mut(id as usize) {
            state.not_negative = not_negative;
        }
        if self.state(id).ranged {
            let range = self.range(id);
            if let Some(slot) = self.ranges.get_mut(id as usize) {
                *slot = range;
            }
        }
    }

    fn computed_range(&self, field: u32, i: u8) -> Interval {
        self.body.formulas.as_ref().map_or(Interval::ALL, |f| f.range(field, i))
    }

    fn known_range(&self, id: ExprId) -> Interval {
        self.ranges.get(id as usize).copied().unwrap_or(Interval::ALL)
    }

    fn range(&self, id: ExprId) -> Interval {
        let args = self.body.arguments(id);
        let of = |args: &[ExprId], op: Op| {
            let mut all = [Interval::ALL; 4];
            for (slot, &arg) in all.iter_mut().zip(args) {
                *slot = self.known_range(arg);
            }
            kernel::interval(op, all.get(..args.len().min(4)).unwrap_or(&[]))
        };
        let field = |id: ExprId, i: usize| match self.body.code(id) {
            Code::Uniform(index, _) => {
                let field = self.context.uniforms.get(index);
                field.and_then(|f| f.ranges.get(i)).copied().unwrap_or(Interval::ALL)
            }
            Code::Computed(field, _) => self.computed_range(field, i as u8),
            _ => Interval::ALL,
        };
        match self.body.code(id) {
            Code::Constant(bits) => Interval::point(f64::from_bits(bits)),
            Code::Uniform(_, 1) | Code::Computed(_, 1) => field(id, 0),
            Code::Component(i) => field(self.argument(id, 0), usize::from(i)),
            Code::Op(op @ (Op::Length2 | Op::Length3 | Op::Length4)) => {
                let vector = self.argument(id, 0);
                match self.body.code(vector) {
                    Code::Vector(_) => of(self.body.arguments(vector), op),
                    _ => Interval::new(0.0, f64::INFINITY),
                }
            }
            Code::Op(op) => of(args, op),
            _ => Interval::ALL,
        }
    }

    /// Whether a value is so far from zero, rounding counted, that one may divide by it. `max(d, 1e-30)` is.
    fn is_safe_below(&self, id: ExprId) -> bool {
        if let Some(c) = self.as_number(id) {
            return c.abs() >= 9e-31;
        }
        let range = self.known_range(id);
        let least = range.mignitude();
        let of_sum = matches!(self.body.code(id), Code::Op(Op::Add | Op::Sub));
        let cancels = of_sum
            && self.body.arguments(id).iter().any(|&a| {
                // Numbers of one sign can't cancel.
                let arg = self.known_range(a);
                arg.lo < 0.0 && least < 1e-4 * arg.magnitude()
            });
        least >= 9e-31 && !cancels && !range.is_empty()
    }

    fn put(&mut self, text: &str) {
        self.scratch.push_str(text);
    }

    /// The name of a field of the uniform block.
    fn put_uniform(&mut self, index: u32) {
        self.context.uniforms.mark(index);
        self.scratch.push_str(&self.context.uniform_name);
        self.scratch.push('.');
        if let Some(field) = self.context.uniforms.get(index) {
            self.scratch.push_str(&field.name);
        }
    }

    /// An argument's text, in parentheses where it binds less than `least`.
    fn put_argument(&mut self, id: ExprId, least: u8) {
        let text = self.text(id);
        let parentheses = text.strength < least;
        if parentheses {
            self.scratch.push('(');
        }
        self.scratch.extend_from_within(text.range());
        if parentheses {
            self.scratch.push(')');
        }
    }

    /// An argument as a condition.
    fn put_condition(&mut self, id: ExprId, least: u8) {
        if self.body.is_condition(id) {
            return self.put_argument(id, least);
        }
        match self.as_number(id) {
            Some(c) => self.put(if c != 0.0 { "true" } else { "false" }),
            None => {
                self.put(if least > 4 { "(" } else { "" });
                self.put_argument(id, 6);
                self.put(if least > 4 { " != 0.0)" } else { " != 0.0" });
            }
        }
    }

    /// An argument as a number.
    fn put_number(&mut self, id: ExprId, least: u8) {
        if self.body.is_condition(id) {
            self.put("select(0.0, 1.0, ");
            self.put_argument(id, 0);
            self.put(")");
        } else {
            self.put_argument(id, least);
        }
    }

    /// Writes an expression; the answer is how strongly it binds.
    fn compose(&mut self, id: ExprId, code: Code, args: &[ExprId]) -> u8 {
        let first = args.first().copied().unwrap_or(id);
        match code {
            Code::Constant(bits) => {
                let value = f64::from_bits(bits) as f32;
                // What 32 bits can't hold in full is zero to many a GPU.
                let value = if value.is_normal() { value } else { 0.0 };
                let text = self.context.numbers.entry(value.to_bits()).or_insert_with(|| format!("{value:?}"));
                self.scratch.push_str(text);
                if value < 0.0 { 8 } else { 9 }
            }
            Code::Point(_) => {
                self.put("p");
                9
            }
            Code::World => {
                self.put("world");
                9
            }
            Code::Scene => {
                self.put("q");
                9
            }
            Code::Normal => {
                self.put("normal");
                9
            }
            Code::Variable(i) => {
                let _ = write!(self.scratch, "k{i}");
                9
            }
            Code::Uniform(index, _) => {
                self.put_uniform(index);
                9
            }
            Code::Computed(field, _) => {
                if let Some(formulas) = &self.body.formulas {
                    let name = self.body.named(id).and_then(|n| self.context.graph.node_name(n));
                    let index = self.context.uniforms.computed(formulas, field, name);
                    self.put_uniform(index);
                }
                9
            }
            Code::Value(_) => {
                self.put("d");
                9
            }
            Code::Aside(_) => {
                self.put("aside");
                9
            }
            Code::Row(piece) => {
                let _ = write!(self.scratch, "r{piece}");
                9
            }
            Code::Component(i) => {
                self.put_argument(first, 9);
                self.put(component_name(i));
                9
            }
            Code::Swizzle(count, order) => {
                self.put_argument(first, 9);
                self.put_components(count, order);
                9
            }
            Code::Vector(count) => {
                self.put(vector_type(count));
                self.list(args)
            }
            Code::VectorOp(op, count) => {
                self.operations += usize::from(count);
                self.operation(id, op, args)
            }
            Code::Splat(count) => {
                self.put(vector_type(count));
                self.list(args)
            }
            Code::Surface | Code::Carry => {
                self.scratch.push_str(self.context.prefix);
                self.put(if code == Code::Carry { "Carry" } else { "Surface" });
                self.list(args)
            }
            Code::Layers(which) => {
                self.scratch.push_str(self.context.prefix);
                self.put(&super::layers::layers_name(which));
                self.list(args)
            }
            Code::Call(target) => {
                self.operations += self.context.operations.get(&target).copied().unwrap_or(0);
                if let Some(name) = self.context.functions.get(&target) {
                    self.scratch.push_str(name);
                }
                self.list(args)
            }
            Code::Op(op) => {
                self.operations += 1;
                self.operation(id, op, args)
            }
        }
    }

    /// The arguments in parentheses.
    fn list(&mut self, args: &[ExprId]) -> u8 {
        for (i, &arg) in args.iter().enumerate() {
            self.put(if i == 0 { "(" } else { ", " });
            self.put_number(arg, 0);
        }
        self.put(")");
        9
    }

    /// Of the scene's point, and of a component of it, what stands after its name.
    fn of_scene(&self, id: ExprId) -> Option<(u8, u16)> {
        let inside = || self.body.code(self.argument(id, 0)) == Code::Scene;
        match self.body.code(id) {
            Code::Scene => Some((0, 0)),
            Code::Component(i) if inside() => Some((1, u16::from(i))),
            Code::Swizzle(count, order) if inside() => Some((count, order)),
            _ => None,
        }
    }

    /// Components in some order, four bits each, after a dot; nothing where there are none.
    fn put_components(&mut self, count: u8, order: u16) {
        for i in 0..count {
            let name = component_name((order >> (4 * i) & 3) as u8);
            self.put(if i == 0 { name } else { name.trim_start_matches('.') });
        }
    }

    /// Whether an expression is the way of the scene's point from a place that is far out.
    fn is_far_out(&self, code: Code, args: &[ExprId]) -> bool {
        let (Code::Op(op) | Code::VectorOp(op, _), &[a, b]) = (code, args) else { return false };
        let far = |id: ExprId| self.as_number(id).is_some_and(|c| c.abs() > FAR_OUT);
        let constant = |id: ExprId| self.as_number(id).is_some();
        let place = match self.body.code(b) {
            Code::Vector(_) => {
                let parts = self.body.arguments(b);
                parts.iter().all(|p| constant(*p)) && parts.iter().any(|p| far(*p))
            }
            _ => far(b),
        };
        matches!(op, Op::Add | Op::Sub) && place && self.of_scene(a).is_some()
    }

    /// `a op b` for the four operators of numbers.
    fn infix(&mut self, code: Code, op: Op, args: &[ExprId]) -> u8 {
        let &[mut a, mut b] = args else { return 0 };
        if let Some((count, order)) = self.of_scene(a).filter(|_| self.is_far_out(code, args)) {
            self.put("p");
            self.put_components(count, order);
            self.put(" + (");
            self.scratch.push_str(&self.context.uniform_name);
            self.put(".origin");
            self.put_components(count, order);
            self.put(if op == Op::Add { " + " } else { " - " });
            self.put_number(b, 9);
            self.put(")");
            return 6;
        }
        if op == Op::Mul && self.as_number(b).is_some_and(|c| c < 0.0) {
            (a, b) = (b, a);
        }
        let (sign, strength) = match op {
            Op::Add => (" + ", 6),
            Op::Sub => (" - ", 6),
            Op::Mul => (" * ", 7),
            _ => (" / ", 7),
        };
        self.put_number(a, strength);
        let text = self.text(b);
        let negative = self.written(text).starts_with('-');
        match (op, negative, self.as_number(b)) {
            // a + -1.0 is a - 1.0, to the last bit.
            (Op::Add | Op::Sub, true, Some(_)) => {
                self.put(if op == Op::Add { " - " } else { " + " });
                let Range { start, end } = text.range();
                self.scratch.extend_from_within(start + 1..end);
            }
            _ => {
                self.put(sign);
                self.put_number(b, if negative { 9 } else { strength + 1 });
            }
        }
        strength
    }

    fn operation(&mut self, id: ExprId, op: Op, args: &[ExprId]) -> u8 {
        let row = op.row();
        let argument = |i: usize| args.get(i).copied().unwrap_or(id);
        let a = argument(0);
        match op {
            Op::Add | Op::Sub | Op::Mul => return self.infix(self.body.code(id), op, args),
            Op::Div if self.is_safe_below(argument(1)) => return self.infix(self.body.code(id), op, args),
            Op::Div if self.body.components(id) == 3 => {
                self.context.helpers.need("div3");
                self.scratch.push_str(self.context.prefix);
                self.put("div3");
                return self.list(args);
            }
            Op::Square if self.text(a).atom => {
                self.put_number(a, 8);
                self.put(" * ");
                self.put_number(a, 9);
                return 7;
            }
            Op::Sqrt if self.state(id).squared => {
                if self.state(a).not_negative {
                    self.put_number(a, 0);
                    return self.text(a).strength;
                }
                self.put("max(");
                self.put_number(a, 0);
                self.put(", 0.0)");
                return 9;
            }
            Op::Length2 | Op::Length3 | Op::Length4 if self.state(id).squared => {
                self.put("dot(");
                self.put_argument(a, 0);
                self.put(", ");
                self.put_argument(a, 0);
                self.put(")");
                return 9;
            }
            Op::Min | Op::Max if self.state(id).rooted => {
                let whole = !self.state(id).squared;
                self.put(if whole { "sqrt(" } else { "" });
                self.put(if op == Op::Min { "min" } else { "max" });
                self.list(args);
                self.put(if whole { ")" } else { "" });
                return 9;
            }
            Op::Sqrt if self.state(a).not_negative => {
                self.put("sqrt(");
                self.put_number(a, 0);
                self.put(")");
                return 9;
            }
            Op::Length2 | Op::Length3 | Op::Length4 => {
                self.put("length(");
                self.put_argument(a, 0);
                self.put(")");
                return 9;
            }
            Op::And | Op::Or => {
                // Of && and || only the same may stand beside each other, and only on the left.
                let b = argument(1);
                let same = self.body.code(a) == Code::Op(op) && self.text(a).strength == row.strength;
                self.put_condition(a, if same { row.strength } else { 3 });
                self.put(if op == Op::And { " && " } else { " || " });
                self.put_condition(b, 3);
                return row.strength;
            }
            _ => {}
        }
        if let Some(helper) = helper_of(op) {
            self.context.helpers.need(helper);
        }
        let mut rest = row.wgsl;
        if let Some(helper) = rest.strip_prefix("sf_") {
            self.scratch.push_str(self.context.prefix);
            rest = helper;
        }
        // Inside parentheses anything may stand, beside an operator only what binds more.
        let least = if row.strength == 9 { 0 } else { row.strength + 1 };
        while let Some((before, i, after)) = next_argument(rest) {
            self.put(before);
            let arg = argument(i);
            match op {
                Op::Not => self.put_condition(arg, least),
                Op::Select if i == 0 => self.put_condition(arg, least),
                _ => self.put_number(arg, least),
            }
            rest = after;
        }
        self.put(rest);
        row.strength
    }
}

/// Splits a pattern of the kernel table at its first `{0}`: what stands before, the argument's number (one digit), what follows.
fn next_argument(pattern: &str) -> Option<(&str, usize, &str)> {
    let bytes = pattern.as_bytes();
    let at = bytes.iter().position(|&b| b == b'{')?;
    let digit = bytes.get(at + 1)?;
    Some((pattern.get(..at)?, usize::from(digit.wrapping_sub(b'0')), pattern.get(at + 3..)?))
}

/// What stands after a vector for one of its components.
pub fn component_name(i: u8) -> &'static str {
    match i {
        0 => ".x",
        1 => ".y",
        2 => ".z",
        _ => ".w",
    }
}

/// The type of a vector of 32-bit floats.
pub fn vector_type(components: u8) -> &'static str {
    match components {
        0 | 1 => "f32",
        2 => "vec2f",
        3 => "vec3f",
        _ => "vec4f",
    }
}
