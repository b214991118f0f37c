//! Calls of one function as a loop. In each turn all arguments that differ and all results move up by one: a list that is read at the turn's number would have to be
//! memory, and these need not.

use crate::emit::arms::Arms;
use crate::emit::body::Body;
use crate::emit::body::batch::Batch;
use crate::emit::code::ExprId;
use crate::emit::plan::{Group, TargetId};
use crate::emit::write::writer::{Context, Room, State, Text, Writer};
use std::fmt::Write;

/// The calls of a function that are loops, if there are any.
pub fn find(context: &mut Context, body: &Body, root: ExprId, out: &mut String) -> Option<Vec<Batch>> {
    if !body.may_batch(|target| context.written(target)) {
        return None;
    }
    let Room { scratch, mut states, mut order, mut stack, locals, .. } = Room::default();
    states.resize(body.len(), State::default());
    let (ranges, results, arms) = (Vec::new(), Vec::new(), Arms::default());
    let mut writer = Writer { context, body, out, scratch, states, ranges, locals, operations: 0, arms, block: 0, depth: 1, results };
    let seen = writer.order(root, &mut order, &mut stack);
    writer.part(seen.dear, &mut order);
    let operations = |target| writer.context.written(target);
    let batches = body.batches(&order, |id| writer.arms.place(id), operations);
    (!batches.is_empty()).then_some(batches)
}

/// An argument of the calls of a loop.
enum Given {
    /// It is the same in all of them.
    Same(ExprId),
    /// The variables of all of them; the first is that of the call at hand.
    Moving(Vec<Text>),
}

impl Writer<'_, '_> {
    /// Writes the loop that calls a function so many times. `args`: for each argument one that is the same for all, or where its bit in `moving` is set one for
    /// each call.
    pub(super) fn batch(&mut self, id: ExprId, (target, count, moving): (TargetId, u32, u32), mut args: &[ExprId]) {
        let plans = self.context.plans;
        let Some((target, name)) = plans.get(target).zip(self.context.functions.get(&target).cloned()) else { return };
        self.operations += self.cost(id);
        let mut given = Vec::new();
        for place in 0u32.. {
            let moves = moving.checked_shr(place).is_some_and(|rest| rest & 1 == 1);
            let Some((own, rest)) = args.split_at_checked(if moves { count as usize } else { 1 }) else { break };
            args = rest;
            given.push(match own {
                [same] if !moves => Given::Same(*same),
                own => Given::Moving(own.iter().map(|&arg| self.moving(arg, if place == 0 { "at" } else { "number" })).collect()),
            });
        }
        let ty = if target.group == Group::Gradient { "vec4f" } else { "f32" };
        let own = name.strip_prefix(self.context.prefix).unwrap_or(&name);
        let results: Vec<Text> = (0..count).map(|_| self.local(own)).collect();
        for result in &results {
            let start = self.scratch.len();
            self.scratch.extend_from_within(result.range());
            self.put(": ");
            self.put(ty);
            self.line("var ", start, ";");
        }
        let turn = self.local("i");
        let turn = self.written(turn).to_owned();
        let start = self.scratch.len();
        let _ = write!(self.scratch, "var {turn} = 0; {turn} < {count}; {turn}++");
        self.line("for (", start, ") {");
        self.depth += 1;
        self.move_up(&results);
        if let Some(result) = results.last() {
            let start = self.scratch.len();
            self.scratch.extend_from_within(result.range());
            let _ = write!(self.scratch, " = {name}(");
            for (i, given) in given.iter().enumerate() {
                if i > 0 {
                    self.put(", ");
                }
                match given {
                    Given::Same(arg) => self.put_number(*arg, 0),
                    Given::Moving(variables) => {
                        let first = variables.first().map_or(0..0, |variable| variable.range());
                        self.scratch.extend_from_within(first);
                    }
                }
            }
            self.line("", start, ");");
        }
        for given in &given {
            if let Given::Moving(variables) = given {
                self.move_up(variables);
            }
        }
        self.depth -= 1;
        self.line("}", self.scratch.len(), "");
        self.results.push((id, results));
    }

    /// A variable that begins as an argument.
    fn moving(&mut self, arg: ExprId, word: &str) -> Text {
        let variable = self.local(word);
        let start = self.scratch.len();
        self.assign(variable, arg);
        self.line("var ", start, ";");
        variable
    }

    /// Each of some variables takes the value of the next.
    fn move_up(&mut self, variables: &[Text]) {
        for (to, from) in variables.iter().zip(variables.iter().skip(1)) {
            let start = self.scratch.len();
            self.scratch.extend_from_within(to.range());
            self.put(" = ");
            self.scratch.extend_from_within(from.range());
            self.line("", start, ";");
        }
    }

    /// What a loop found in one of its turns.
    pub(super) fn put_item(&mut self, batch: ExprId, turn: u32) {
        let results = self.results.iter().find(|(id, _)| *id == batch);
        if let Some(result) = results.and_then(|(_, results)| results.get(turn as usize)) {
            self.scratch.extend_from_within(result.range());
        }
    }

    /// A name like this one that is not taken yet.
    pub(super) fn local(&mut self, word: &str) -> Text {
        let start = self.scratch.len();
        match self.context.prefix {
            "" => self.locals.write(word, Some(&self.context.module), &mut self.scratch),
            _ => self.locals.write_plain(word, &mut self.scratch),
        }
        Text { start: start as u32, length: (self.scratch.len() - start) as u32, strength: 9, atom: true }
    }
}
