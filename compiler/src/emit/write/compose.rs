//! The text of one expression, from the texts of its arguments.

use crate::emit::body::FAR_OUT;
use crate::emit::code::{Code, ExprId};
use crate::emit::layers;
use crate::emit::library::helper_of;
use crate::emit::names::{ROW, VARIABLE, component_name, numbered, vector_type};
use crate::emit::write::writer::Writer;
use crate::graph::kernel::Op;
use std::ops::Range;

impl Writer<'_, '_> {
    pub(super) fn put(&mut self, text: &str) {
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
    pub(super) fn put_argument(&mut self, id: ExprId, least: u8) {
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
    pub(super) fn put_condition(&mut self, id: ExprId, least: u8) {
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
    pub(super) fn put_number(&mut self, id: ExprId, least: u8) {
        if self.body.is_condition(id) {
            self.put("select(0.0, 1.0, ");
            self.put_argument(id, 0);
            self.put(")");
        } else {
            self.put_argument(id, least);
        }
    }

    /// Writes an expression; the answer is how strongly it binds.
    pub(super) fn compose(&mut self, id: ExprId, code: Code, args: &[ExprId]) -> u8 {
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
                self.put(self.context.facing);
                9
            }
            Code::Variable(i) => {
                self.put(&numbered(VARIABLE, i as usize + 1));
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
                self.put(&numbered(ROW, piece as usize + 1));
                9
            }
            Code::Component(i) => {
                self.put_argument(first, 9);
                self.put(component_name(i));
                9
            }
            // A loop is written as lines of its own, and its name stands for it.
            Code::Batch(..) => 9,
            Code::Item(i) => {
                self.put_item(first, i);
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
            Code::Surface | Code::Carry | Code::Around => {
                self.scratch.push_str(self.context.prefix);
                self.put(match code {
                    Code::Carry => "Carry",
                    Code::Around => "Around",
                    _ => "Surface",
                });
                self.list(args)
            }
            Code::Layers(which) => {
                self.scratch.push_str(self.context.prefix);
                self.put(&layers::layers_name(which));
                self.list(args)
            }
            Code::Call(target) => {
                self.operations += self.context.operations.get(&target).copied().unwrap_or(0);
                if let Some(name) = self.context.functions.get(&target) {
                    self.scratch.push_str(name);
                }
                self.list(args)
            }
            Code::Op(op) | Code::Whole(op, _) => {
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
    pub(super) fn of_scene(&self, id: ExprId) -> Option<(u8, u16)> {
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
    pub(super) fn is_far_out(&self, code: Code, args: &[ExprId]) -> bool {
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
                self.context.helpers.need("div_all");
                self.scratch.push_str(self.context.prefix);
                self.put("div_all");
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
