//! Expressions as a person would write them: what is used twice or has a name stands in a `let`, the rest is nested while short.

mod batch;
mod compose;
mod ranges;
mod sums;

use super::arms::{self, Arm, Arms, BlockId};
use super::body::{Body, Code, ExprId};
use super::library::Helpers;
use super::names::{Scope, identifier, split_axis};
use super::plan::{Group, Plans, TargetId};
use super::table::Tables;
use super::uniforms::Candidates;
use crate::interface::Rounding;
use crate::graph::{Graph, NodeId};
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::simplify::Terms;
use rustc_hash::FxHashMap;
pub use sums::unit;
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
    /// What rounding grows with: so far the axes of which the point of the scene is read as it is, and not only as the way from a place far out.
    pub rounding: Rounding,
    /// The largest number that is added to another, as it counts in the result, and the sum's place in the graph.
    pub sums: (f64, Option<NodeId>),
    /// The same of each function of a shape that is written.
    pub called: FxHashMap<TargetId, (f64, Option<NodeId>)>,
    /// The unions that are tables.
    pub tables: &'a Tables,
    /// What the function that is written calls [`crate::graph::Leaf::Normal`].
    pub facing: &'static str,
}

impl Context<'_> {
    /// How many operations a function is written in: what is a loop itself is as long as one of its turns.
    fn written(&self, target: TargetId) -> usize {
        let operations = self.operations.get(&target).copied().unwrap_or(0);
        let turns = self.plans.get(target).and_then(|t| self.plans.table(t)).map_or(1, |table| table.entries.len());
        operations / turns.max(1)
    }

    /// Whether a function that is written reads a table.
    pub fn has_tables(&self) -> bool {
        self.functions.keys().filter_map(|id| self.plans.get(*id)).any(|t| self.plans.table(t).is_some_and(|table| table.turns.is_none()))
    }
}

/// What is written of a function so far. It is kept for the next one's sake, empty.
#[derive(Debug, Default)]
pub struct Room {
    scratch: String,
    states: Vec<State>,
    ranges: Vec<Interval>,
    order: Vec<ExprId>,
    stack: Vec<(ExprId, u32, usize)>,
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

/// What a function holds at all.
#[derive(Debug, Default)]
struct Seen {
    /// The point of the scene.
    scene: bool,
    /// A least or a largest value.
    extremum: bool,
    /// The arms of choices that may be worth a branch.
    dear: Vec<Arm>,
}

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
    /// The results of each loop of calls.
    results: Vec<(ExprId, Vec<Text>)>,
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
    let root = batch::find(context, body, root, out).map_or(root, |batches| body.batch(&batches, root));
    let Room { scratch, mut states, mut ranges, mut order, mut stack, mut locals } = std::mem::take(&mut context.room);
    for name in arguments {
        locals.reserve(name);
    }
    let count = body.len();
    let divides = body.divides();
    states.resize(count, State::default());
    ranges.resize(if divides { count } else { 0 }, Interval::ALL);
    let (arms, results) = (Arms::default(), Vec::new());
    let mut writer = Writer { context, body, out, scratch, states, ranges, locals, operations: 0, arms, block: 0, depth: 1, results };
    let Seen { scene, extremum, dear } = writer.order(root, &mut order, &mut stack);
    if writer.body.components(root) == 1 {
        let sum = writer.largest_sum(&order, root);
        if sum.0 > writer.context.sums.0 {
            writer.context.sums = sum;
        }
    }
    if divides {
        writer.want_ranges(&order);
    }
    writer.part(dear, &mut order);
    if extremum {
        writer.mark_squares(&order);
    }
    for &id in order.iter().filter(|_| scene) {
        let (code, args) = (writer.body.code(id), writer.body.arguments(id));
        if matches!(code, Code::Component(_) | Code::Swizzle(..)) || writer.is_far_out(code, args) {
            continue;
        }
        for &arg in args {
            let Some((count, order)) = writer.of_scene(arg) else { continue };
            for (axis, read) in (0..).zip(&mut writer.context.rounding.reads_scene) {
                *read |= count == 0 || (0..count).any(|i| order >> (4 * i) & 3 == axis);
            }
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
    /// Finds which branch each expression is computed in. `order` goes branch by branch then; in each, arguments first as before.
    fn part(&mut self, mut dear: Vec<Arm>, order: &mut [ExprId]) {
        dear.sort_unstable();
        let arms = Arms::find(self.body, order, &dear, |id| self.cost(id));
        if arms.any() {
            order.sort_by_key(|&id| arms.place(id));
        }
        self.arms = arms;
    }

    /// What the root needs, arguments first, into `order`; and how often each is used, and what is there at all.
    fn order(&mut self, root: ExprId, order: &mut Vec<ExprId>, stack: &mut Vec<(ExprId, u32, usize)>) -> Seen {
        let mut seen = Seen::default();
        // Operations of all that is in order.
        let mut total = 0;
        stack.push((root, 0, 0));
        if let Some(state) = self.states.get_mut(root as usize) {
            state.uses = 1;
        }
        while let Some((id, at, before)) = stack.last_mut() {
            let (id, before, args) = (*id, *before, self.body.arguments(*id));
            // The next argument that is met for the first time.
            let next = loop {
                let Some(&next) = args.get(*at as usize) else { break None };
                *at += 1;
                let Some(state) = self.states.get_mut(next as usize) else { continue };
                state.uses += 1;
                if state.uses == 1 {
                    break Some(next);
                }
            };
            match next {
                Some(next) => stack.push((next, 0, total)),
                None => {
                    self.note(id, args, &mut seen);
                    order.push(id);
                    stack.pop();
                    total += self.cost(id);
                    // What only an arm needs was met on the way to it, if on no way before.
                    if total - before >= arms::LEAST
                        && let Some((user, at, _)) = stack.last()
                        && *at > 1
                        && arms::is_choice(self.body, *user)
                    {
                        seen.dear.push((*user, *at as u8 - 1));
                    }
                }
            }
        }
        seen
    }

    /// Notes what an expression is.
    fn note(&mut self, id: ExprId, args: &[ExprId], seen: &mut Seen) {
        match self.body.code(id) {
            Code::Component(_) | Code::Swizzle(..) => {
                let vector = args.first().and_then(|&a| self.states.get_mut(a as usize));
                vector.into_iter().for_each(|state| state.taken_apart = true);
            }
            Code::Scene => seen.scene = true,
            Code::Op(Op::Min | Op::Max) => seen.extremum = true,
            Code::Op(Op::Sqrt | Op::Length2 | Op::Length3 | Op::Length4) => {
                self.states.get_mut(id as usize).into_iter().for_each(|state| state.rooted = true);
            }
            _ => {}
        }
    }

    /// Operations of an expression, without its arguments.
    fn cost(&self, id: ExprId) -> usize {
        match self.body.code(id) {
            Code::Call(target) => self.context.operations.get(&target).copied().unwrap_or(0),
            Code::Batch(target, count, _) => count as usize * self.context.operations.get(&target).copied().unwrap_or(0),
            Code::VectorOp(_, count) => usize::from(count),
            Code::Op(_) => 1,
            _ => 0,
        }
    }

    /// Finds where the least or the largest of roots is the root of the least or largest square: one root is computed for all of them.
    fn mark_squares(&mut self, order: &[ExprId]) {
        for &id in order {
            if !matches!(self.body.code(id), Code::Op(Op::Min | Op::Max)) {
                continue;
            }
            let args = self.body.arguments(id);
            let alone = |a: &ExprId| self.states.get(*a as usize).is_some_and(|s| s.rooted && s.uses == 1) && self.body.named(*a).is_none();
            if !args.iter().all(alone) {
                continue;
            }
            self.states.get_mut(id as usize).into_iter().for_each(|state| state.rooted = true);
            for &arg in args {
                self.states.get_mut(arg as usize).into_iter().for_each(|state| state.squared = true);
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
        if !self.arms.any() {
            return order.iter().for_each(|&id| self.expression(id, root == Some(id)));
        }
        let place = |id: &ExprId| self.arms.place(*id);
        let (start, end) = (order.partition_point(|id| place(id) < block), order.partition_point(|id| place(id) <= block));
        let around = std::mem::replace(&mut self.block, block);
        for &id in order.get(start..end).unwrap_or(&[]) {
            let branches = if arms::is_choice(self.body, id) { [1, 2].map(|arm| self.arms.branch(id, arm)) } else { [None, None] };
            match branches {
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
        if let Code::Batch(target, count, moving) = code {
            return self.batch(id, (target, count, moving), args);
        }
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
                    | Code::Item(_)
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
            None => return self.local(self.usual_name(id)),
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
                Some(t) if t.group == Group::Gradient => "g",
                _ => "d",
            },
            Code::Vector(_) | Code::VectorOp(..) | Code::Splat(_) => "v",
            _ => "a",
        }
    }
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
