//! Expressions as a person would write them: what is used twice or has a name stands in a `let`, the rest is nested while short.

mod batch;
mod compose;
mod ranges;
mod sums;
mod writer;

pub use sums::unit;
pub use writer::{Context, Room};

use crate::emit::arms::{self, Arm, Arms, BlockId};
use crate::emit::body::Body;
use crate::emit::code::{Code, ExprId};
use crate::emit::names::{identifier, split_axis, vector_type};
use crate::emit::plan::Group;
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::simplify::Terms;
use writer::{Seen, State, Text, Writer};

/// A nested expression longer than this is split.
const LONGEST: u32 = 78;

/// What is no longer than this is not split from what it stands in.
const SHORTEST: u32 = 12;

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
    writer.note_place(root);
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
            Code::Op(_) | Code::Whole(..) => 1,
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
        self.note_place(id);
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
            self.note_place(arm);
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

    /// Notes for which shapes the next line is: those of an expression, and of all that is written within it.
    fn note_place(&mut self, id: ExprId) {
        let (at, mut stack, mut last) = (self.out.len(), vec![id], None);
        while let Some(id) = stack.pop() {
            let shape = self.body.of(id);
            if let Some(shape) = shape.filter(|_| shape != last) {
                self.context.places.push((at, shape));
                last = Some(shape);
            }
            stack.extend(self.body.arguments(id).iter().filter(|arg| {
                let text = self.text(**arg);
                !text.atom && text.length > 0
            }));
        }
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
        let whole = matches!(code, Code::Call(_) | Code::Whole(..) | Code::VectorOp(..)) && taken_apart;
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
        self.note_place(id);
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
            Code::Whole(..) => "found",
            Code::Vector(_) | Code::VectorOp(..) | Code::Splat(_) => "v",
            _ => "a",
        }
    }
}
