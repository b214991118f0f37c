//! A function as text of the language.

use super::program::{Body, Ex, Id, Step};
use rustc_hash::{FxHashMap, FxHashSet};
use std::fmt::Write;

/// Writes functions and constants.
pub struct Writer<'a> {
    /// What no name of a function may be: what is called in it, and what the language keeps for itself.
    pub reserved: &'a FxHashSet<String>,
    /// The names of the file where they are others than in the shader.
    pub renamed: &'a FxHashMap<String, String>,
}

/// How tightly operators bind; what is looser than where it stands gets brackets.
mod level {
    pub const LOWEST: u8 = 0;
    pub const OR: u8 = 1;
    pub const AND: u8 = 2;
    pub const COMPARED: u8 = 3;
    pub const SUM: u8 = 4;
    pub const PRODUCT: u8 = 5;
    pub const SIGN: u8 = 6;
    pub const TIGHT: u8 = 7;
}

impl Writer<'_> {
    /// `fn name(parameters) = body`. `names` has what each number stands for.
    pub fn function(&self, name: &str, parameters: &[(Id, &str)], names: &[String], body: &Body) -> String {
        let named = Named::new(self.reserved, parameters, names, body);
        let mut text = format!("fn {}(", self.file_name(name));
        for (i, (id, ty)) in parameters.iter().enumerate() {
            let _ = write!(text, "{}{}: {ty}", if i > 0 { ", " } else { "" }, named.name(*id));
        }
        text.push_str(") = ");
        if body.steps.is_empty() {
            self.ex(&body.value, level::LOWEST, &named, &mut text);
        } else {
            self.body(body, &named, &mut text);
        }
        text
    }

    /// An expression without names of a function.
    pub fn constant(&self, ex: &Ex) -> String {
        let mut text = String::new();
        self.ex(ex, level::LOWEST, &Named::default(), &mut text);
        text
    }

    fn file_name<'n>(&'n self, name: &'n str) -> &'n str {
        self.renamed.get(name).map_or(name, String::as_str)
    }

    fn body(&self, body: &Body, named: &Named, text: &mut String) {
        text.push_str("{ ");
        self.steps(&body.steps, named, text);
        self.ex(&body.value, level::LOWEST, named, text);
        text.push_str(" }");
    }

    fn steps(&self, steps: &[Step], named: &Named, text: &mut String) {
        for step in steps {
            match step {
                Step::Let(id, value) => {
                    let _ = write!(text, "let {} = ", named.name(*id));
                    self.ex(value, level::LOWEST, named, text);
                    text.push_str(";\n");
                }
                Step::Loop(turn) => {
                    text.push_str("let ");
                    for (i, (id, first, _)) in turn.turns.iter().enumerate() {
                        let _ = write!(text, "{}{} = ", if i > 0 { ", " } else { "" }, named.name(*id));
                        self.ex(first, level::LOWEST, named, text);
                    }
                    let _ = write!(text, " for {} in ", named.name(turn.index));
                    self.ex(&turn.from, level::TIGHT, named, text);
                    text.push_str("..");
                    self.ex(&turn.to, level::TIGHT, named, text);
                    if let Some(condition) = &turn.condition {
                        text.push_str(" while ");
                        self.ex(condition, level::LOWEST, named, text);
                    }
                    text.push_str(" {\n");
                    self.steps(&turn.steps, named, text);
                    for (i, (id, _, next)) in turn.turns.iter().enumerate() {
                        let _ = write!(text, "{}{} = ", if i > 0 { ", " } else { "" }, named.name(*id));
                        self.ex(next, level::LOWEST, named, text);
                    }
                    text.push_str(" };\n");
                }
                // None is left when a function is tidy.
                Step::Branch { .. } => {}
            }
        }
    }

    fn list(&self, all: &[Ex], named: &Named, text: &mut String) {
        for (i, ex) in all.iter().enumerate() {
            if i > 0 {
                text.push_str(", ");
            }
            self.ex(ex, level::LOWEST, named, text);
        }
    }

    fn ex(&self, ex: &Ex, at: u8, named: &Named, text: &mut String) {
        let own = match ex {
            Ex::Number(value) if *value < 0.0 => level::SIGN,
            Ex::Unary(..) => level::SIGN,
            Ex::If(..) => level::LOWEST,
            Ex::Binary(op, _, _) => match *op {
                "||" => level::OR,
                "&&" => level::AND,
                "+" | "-" => level::SUM,
                "*" | "/" | "%" => level::PRODUCT,
                _ => level::COMPARED,
            },
            _ => level::TIGHT,
        };
        let is_bracketed = own < at || at > level::LOWEST && matches!(ex, Ex::If(..));
        if is_bracketed {
            text.push('(');
        }
        match ex {
            Ex::Number(value) => {
                let _ = write!(text, "{value}");
            }
            Ex::Bool(value) => {
                let _ = write!(text, "{value}");
            }
            Ex::Id(id) => text.push_str(named.name(*id)),
            Ex::Global(name) | Ex::Unknown(name) => text.push_str(self.file_name(name)),
            Ex::Call(name, all) => {
                text.push_str(self.file_name(name));
                text.push('(');
                self.list(all, named, text);
                text.push(')');
            }
            Ex::Vector(all) => {
                text.push('(');
                self.list(all, named, text);
                text.push(')');
            }
            Ex::List(all) => {
                text.push('[');
                self.list(all, named, text);
                text.push(']');
            }
            Ex::Unary(op, of) => {
                text.push(*op);
                self.ex(of, level::SIGN, named, text);
            }
            Ex::Binary(op, a, b) => {
                // A comparison of comparisons would be none.
                self.ex(a, if own == level::COMPARED { own + 1 } else { own }, named, text);
                let _ = write!(text, " {op} ");
                self.ex(b, own + 1, named, text);
            }
            Ex::Part(of, part) => {
                self.ex(of, level::TIGHT, named, text);
                let _ = write!(text, ".{part}");
            }
            Ex::Index(of, index) => {
                self.ex(of, level::TIGHT, named, text);
                text.push('[');
                self.ex(index, level::LOWEST, named, text);
                text.push(']');
            }
            Ex::If(condition, yes, no) => {
                text.push_str("if ");
                self.ex(condition, level::LOWEST, named, text);
                text.push(' ');
                self.body(yes, named, text);
                text.push_str(" else ");
                match (&no.value, no.steps.is_empty()) {
                    (Ex::If(..), true) => self.ex(&no.value, level::LOWEST, named, text),
                    _ => self.body(no, named, text),
                }
            }
        }
        if is_bracketed {
            text.push(')');
        }
    }
}

/// The names of one function, so that each reads what it is meant to.
#[derive(Default)]
struct Named {
    names: Vec<String>,
}

impl Named {
    fn new(reserved: &FxHashSet<String>, parameters: &[(Id, &str)], names: &[String], body: &Body) -> Self {
        let mut taken: FxHashSet<String> = names.iter().cloned().collect();
        let mut named = Self { names: Vec::with_capacity(names.len()) };
        let mut count = 0;
        for name in names {
            let name = match name.as_str() {
                "" => loop {
                    count += 1;
                    let short = format!("t{count}");
                    if taken.insert(short.clone()) {
                        break short;
                    }
                },
                name if reserved.contains(name) => format!("{name}_"),
                name => name.to_owned(),
            };
            named.names.push(name);
        }
        // What is hidden where it is read makes what hides it another name.
        for _ in 0..names.len() {
            let mut scope: Vec<Id> = parameters.iter().map(|(id, _)| *id).collect();
            let Some(hides) = named.hides(body, &mut scope) else { break };
            let Some(slot) = named.names.get(hides as usize).cloned() else { break };
            let free = (2..).map(|n| format!("{}_{n}", slot.trim_end_matches('_'))).find(|name| taken.insert(name.clone()));
            if let (Some(place), Some(free)) = (named.names.get_mut(hides as usize), free) {
                *place = free;
            }
        }
        named
    }

    fn name(&self, id: Id) -> &str {
        self.names.get(id as usize).map_or("", String::as_str)
    }

    /// The first that hides another one that is read.
    fn hides(&self, body: &Body, scope: &mut Vec<Id>) -> Option<Id> {
        let before = scope.len();
        let found = self.hides_in(&body.steps, scope).or_else(|| self.hides_at(&body.value, scope));
        scope.truncate(before);
        found
    }

    fn hides_in(&self, steps: &[Step], scope: &mut Vec<Id>) -> Option<Id> {
        for step in steps {
            match step {
                Step::Let(id, value) => {
                    if let found @ Some(_) = self.hides_at(value, scope) {
                        return found;
                    }
                    scope.push(*id);
                }
                Step::Branch { .. } => {}
                Step::Loop(turn) => {
                    for ex in [&turn.from, &turn.to].into_iter().chain(turn.turns.iter().map(|(_, first, _)| first)) {
                        if let found @ Some(_) = self.hides_at(ex, scope) {
                            return found;
                        }
                    }
                    if turn.turns.iter().any(|(id, _, _)| self.name(*id) == self.name(turn.index)) {
                        return Some(turn.index);
                    }
                    scope.extend(turn.turns.iter().map(|(id, _, _)| *id));
                    let after = scope.len();
                    scope.push(turn.index);
                    if let found @ Some(_) = turn.condition.as_ref().and_then(|ex| self.hides_at(ex, scope)).or_else(|| self.hides_in(&turn.steps, scope)) {
                        return found;
                    }
                    for (_, _, next) in &turn.turns {
                        if let found @ Some(_) = self.hides_at(next, scope) {
                            return found;
                        }
                    }
                    scope.truncate(after);
                }
            }
        }
        None
    }

    fn hides_at(&self, ex: &Ex, scope: &mut Vec<Id>) -> Option<Id> {
        match ex {
            Ex::Id(id) => {
                let name = self.name(*id);
                let seen = scope.iter().rev().find(|other| self.name(**other) == name)?;
                (seen != id).then_some(*seen)
            }
            Ex::Number(_) | Ex::Bool(_) | Ex::Unknown(_) => None,
            Ex::Global(name) => scope.iter().rev().find(|other| self.name(**other) == name).copied(),
            Ex::Call(_, all) | Ex::Vector(all) | Ex::List(all) => all.iter().find_map(|ex| self.hides_at(ex, scope)),
            Ex::Unary(_, of) | Ex::Part(of, _) => self.hides_at(of, scope),
            Ex::Binary(_, a, b) | Ex::Index(a, b) => [a, b].into_iter().find_map(|ex| self.hides_at(ex, scope)),
            Ex::If(condition, yes, no) => {
                self.hides_at(condition, scope).or_else(|| self.hides(yes, scope)).or_else(|| self.hides(no, scope))
            }
        }
    }
}
