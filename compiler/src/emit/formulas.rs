//! What depends on parameters and time alone: the host computes it once a frame in 64 bits, and to a shader it is a number of the
//! uniform block.

use crate::emit::code::Read;
use crate::emit::names::numbered;
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::{ANY_TIME, narrow};
use rustc_hash::FxHashMap;
use std::collections::BTreeSet;
use std::fmt::Write;

/// What one term of a formula is. Arguments are earlier terms.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Term {
    /// A number, by its bits.
    Constant(u64),
    /// Seconds.
    Time,
    /// A component of a parameter.
    Parameter(u32),
    /// An operation; zeros beyond the arguments that it takes.
    Op(Op, [u32; 4]),
}

/// One to four terms, as a number or a vector that a shader may read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Field {
    terms: [u32; 4],
    count: u8,
}

/// Formulas of parameters and time.
#[derive(Clone, Debug, Default)]
pub struct Formulas {
    terms: Vec<Term>,
    pub(super) ranges: Vec<Interval>,
    index: FxHashMap<Term, u32>,
    pub(super) fields: Vec<Field>,
    field_index: FxHashMap<Field, u32>,
    /// The terms of the uniform block's own fields: of each component.
    pub(super) leaves: FxHashMap<(u32, u8), u32>,
}

impl Formulas {
    /// The values of all terms, from those of what is live, each as 32 bits hold it. `parameter` gives the value of a component.
    pub fn values(&self, time: f64, parameter: impl Fn(u32) -> f64) -> Vec<f64> {
        let mut values: Vec<f64> = Vec::with_capacity(self.terms.len());
        for term in &self.terms {
            let of = |i: u32| values.get(i as usize).copied().unwrap_or(0.0);
            let value = match *term {
                Term::Constant(bits) => f64::from(narrow(f64::from_bits(bits))),
                Term::Time => f64::from(time as f32),
                Term::Parameter(i) => f64::from(parameter(i) as f32),
                Term::Op(op, args) => (op.row().value)(args.map(of)),
            };
            values.push(if value.is_finite() { value } else { 0.0 });
        }
        values
    }

    /// A component of a field, of the values of all terms.
    pub fn component(&self, values: &[f64], field: u32, i: u32) -> f32 {
        narrow(self.term_of(field, i as u8).and_then(|t| values.get(t as usize)).copied().unwrap_or(0.0))
    }

    /// All values that a component of a field can take.
    pub fn range(&self, field: u32, i: u8) -> Interval {
        self.term_of(field, i).and_then(|t| self.ranges.get(t as usize)).copied().unwrap_or(Interval::ALL)
    }

    /// How many components a field has.
    pub fn components(&self, field: u32) -> u8 {
        self.fields.get(field as usize).map_or(1, |f| f.count)
    }

    pub(super) fn term_of(&self, field: u32, i: u8) -> Option<u32> {
        let field = self.fields.get(field as usize)?;
        field.terms.get(..field.count.into())?.get(usize::from(i)).copied()
    }

    fn add(&mut self, term: Term, range: Interval) -> u32 {
        let (terms, ranges) = (&mut self.terms, &mut self.ranges);
        *self.index.entry(term).or_insert_with(|| {
            terms.push(term);
            ranges.push(range);
            terms.len() as u32 - 1
        })
    }

    pub(super) fn constant(&mut self, bits: u64) -> u32 {
        self.add(Term::Constant(bits), Interval::point(f64::from(narrow(f64::from_bits(bits)))))
    }

    /// Notes what a component of a uniform is. Factors are none of it: a host computes nothing from them.
    pub fn note(&mut self, read: Read, uniform: u32, component: u8, range: Interval) {
        let term = match read {
            Read::Time => self.add(Term::Time, ANY_TIME),
            Read::Parameter(i) => self.add(Term::Parameter(i), range),
            Read::Factor(_) => return,
        };
        self.leaves.insert((uniform, component), term);
    }

    pub(super) fn op(&mut self, op: Op, args: [u32; 4]) -> u32 {
        let ranges = args.map(|a| self.ranges.get(a as usize).copied().unwrap_or(Interval::ZERO));
        // As 32 bits hold what was computed.
        let range = (op.row().interval)(ranges);
        let range = Interval::new(f64::from((range.lo as f32).next_down()), f64::from((range.hi as f32).next_up()));
        self.add(Term::Op(op, args), range)
    }

    pub(super) fn field(&mut self, of: &[u32]) -> u32 {
        let mut field = Field { terms: [0; 4], count: of.len() as u8 };
        for (slot, term) in field.terms.iter_mut().zip(of) {
            *slot = *term;
        }
        let fields = &mut self.fields;
        *self.field_index.entry(field).or_insert_with(|| {
            fields.push(field);
            fields.len() as u32 - 1
        })
    }

    /// What a field is computed from: whether from time, and which components of parameters.
    pub fn reads(&self, field: u32) -> (bool, BTreeSet<u32>) {
        let (mut time, mut parameters, mut seen) = (false, BTreeSet::new(), BTreeSet::new());
        let mut stack: Vec<u32> = (0..self.components(field)).filter_map(|i| self.term_of(field, i)).collect();
        while let Some(term) = stack.pop() {
            if !seen.insert(term) {
                continue;
            }
            match self.terms.get(term as usize) {
                Some(Term::Time) => time = true,
                Some(Term::Parameter(i)) => {
                    parameters.insert(*i);
                }
                Some(Term::Op(op, args)) => stack.extend(args.iter().take(op.row().arity.into())),
                Some(Term::Constant(_)) | None => {}
            }
        }
        (time, parameters)
    }

    /// The formulas as lines `name = formula`, for hosts: in names, numbers, `+ - * /`, comparisons, parentheses and calls of functions.
    /// What several of them need comes first, under a name of its own. `fields`: the name of each that is wanted; `parameter` names a
    /// component. Also the functions that are called.
    pub fn lines(&self, fields: &[(u32, &str)], parameter: &dyn Fn(u32) -> String) -> (Vec<String>, BTreeSet<Op>) {
        let mut names: FxHashMap<u32, String> = FxHashMap::default();
        let mut uses: Vec<u32> = vec![0; self.terms.len()];
        for &(field, name) in fields {
            for i in 0..self.components(field) {
                let Some(term) = self.term_of(field, i) else { continue };
                if self.components(field) == 1 {
                    names.insert(term, name.to_owned());
                } else if let Some(uses) = uses.get_mut(term as usize) {
                    *uses += 1;
                }
            }
        }
        let wanted = |uses: &[u32], names: &FxHashMap<u32, String>, at: usize| {
            uses.get(at).is_some_and(|u| *u > 0) || names.contains_key(&(at as u32))
        };
        for (at, term) in self.terms.iter().enumerate().rev() {
            if let Term::Op(op, args) = term
                && wanted(&uses, &names, at)
            {
                for &arg in args.iter().take(op.row().arity.into()) {
                    if let Some(uses) = uses.get_mut(arg as usize) {
                        *uses += 1;
                    }
                }
            }
        }
        let (mut lines, mut functions, mut parts) = (Vec::new(), BTreeSet::new(), 0);
        let whole = |name: String| name.split('.').next().map(str::to_owned);
        let is_parameter = |name: &str| self.terms.iter().any(|term| matches!(term, Term::Parameter(i) if whole(parameter(*i)).as_deref() == Some(name)));
        let is_field = |name: &str| fields.iter().any(|(_, known)| *known == name);
        let mut part = || loop {
            parts += 1;
            let name = numbered("part", parts);
            if !is_parameter(&name) && !is_field(&name) {
                break name;
            }
        };
        // The text of each term, and how strongly it binds.
        let mut texts: Vec<(String, u8)> = Vec::with_capacity(self.terms.len());
        for (at, term) in self.terms.iter().enumerate() {
            let many = uses.get(at).is_some_and(|u| *u > 1);
            let mut text = match term {
                _ if !wanted(&uses, &names, at) => Default::default(),
                Term::Constant(bits) => {
                    let value = narrow(f64::from_bits(*bits));
                    let far = value != 0.0 && !(1e-4..1e7).contains(&value.abs());
                    (if far { format!("{value:e}") } else { value.to_string() }, if value < 0.0 { 8 } else { 9 })
                }
                Term::Time => ("time".to_owned(), 9),
                Term::Parameter(i) => (parameter(*i), 9),
                Term::Op(op, args) => {
                    if names.contains_key(&(at as u32)) || many {
                        let name = names.entry(at as u32).or_insert_with(&mut part);
                        let (text, _) = self.text(*op, args, &texts, &mut functions);
                        lines.push(format!("{name} = {text}"));
                        (name.clone(), 9)
                    } else {
                        self.text(*op, args, &texts, &mut functions)
                    }
                }
            };
            texts.push(std::mem::take(&mut text));
        }
        for &(field, name) in fields.iter().filter(|f| self.components(f.0) > 1) {
            let of = |i: u8| self.term_of(field, i).and_then(|t| texts.get(t as usize)).map_or("0", |t| t.0.as_str());
            let list: Vec<&str> = (0..self.components(field)).map(of).collect();
            lines.push(format!("{name} = vec{}({})", list.len(), list.join(", ")));
        }
        (lines, functions)
    }

    fn text(&self, op: Op, args: &[u32; 4], texts: &[(String, u8)], functions: &mut BTreeSet<Op>) -> (String, u8) {
        let row = op.row();
        let args = args.get(..row.arity.into()).unwrap_or(args);
        let sign = match op {
            Op::Add => Some((" + ", 6)),
            Op::Sub => Some((" - ", 6)),
            Op::Mul => Some((" * ", 7)),
            Op::Div if args.get(1).and_then(|&b| self.ranges.get(b as usize)).is_some_and(|r| r.mignitude() > 0.0) => Some((" / ", 7)),
            Op::Neg => Some(("-", 8)),
            Op::Lt => Some((" < ", 4)),
            Op::Le => Some((" <= ", 4)),
            Op::Eq => Some((" == ", 4)),
            _ => None,
        };
        let mut out = String::new();
        let Some((sign, strength)) = sign else {
            functions.insert(op);
            let list: Vec<&str> = args.iter().filter_map(|&a| texts.get(a as usize)).map(|t| t.0.as_str()).collect();
            let _ = write!(out, "{}({})", call_name(op), list.join(", "));
            return (out, 9);
        };
        for (i, &arg) in args.iter().enumerate() {
            let Some((text, own)) = texts.get(arg as usize) else { continue };
            out.push_str(if i + 1 == args.len() { sign } else { "" });
            // Two signs beside each other would be another operator in some languages.
            let least = if i == 0 && args.len() > 1 && strength > 4 { strength } else { strength + 1 };
            let wrap = *own < least || i + 1 == args.len() && text.starts_with('-');
            let _ = if wrap { write!(out, "({text})") } else { write!(out, "{text}") };
        }
        (out, strength)
    }
}

/// What an operation is called in formulas for hosts, in which `and`, `or` and `not` may be words of the host's language.
pub fn call_name(op: Op) -> &'static str {
    match op {
        Op::And => "both",
        Op::Or => "either",
        Op::Not => "no",
        Op::Atan => "atan",
        _ => op.row().name,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_are_written_for_a_host_and_share_what_they_have_in_common() {
        let mut f = Formulas::default();
        f.note(Read::Time, 1, 0, Interval::ALL);
        f.note(Read::Parameter(0), 2, 0, Interval::new(0.5, 2.0));
        let (time, k) = (f.leaves[&(1, 0)], f.leaves[&(2, 0)]);
        let two = f.constant(2f64.to_bits());
        let minus = f.constant((-0.25f64).to_bits());
        let difference = f.op(Op::Sub, [time, minus, 0, 0]);
        let sum = f.op(Op::Add, [two, difference, 0, 0]);
        let product = f.op(Op::Mul, [sum, k, 0, 0]);
        let sine = f.op(Op::Sin, [product, 0, 0, 0]);
        let over = f.op(Op::Div, [sine, k, 0, 0]);
        let by_time = f.op(Op::Div, [product, time, 0, 0]);
        let fields = [f.field(&[over]), f.field(&[sine, two, by_time])];
        let (lines, functions) = f.lines(&[(fields[0], "a"), (fields[1], "v")], &|_| "k".to_owned());
        assert_eq!(
            lines,
            [
                "part_a = (2 + (time - (-0.25))) * k",
                "part_b = sin(part_a)",
                "a = part_b / k",
                "v = vec3(part_b, 2, div(part_a, time))"
            ]
        );
        assert_eq!(functions, [Op::Div, Op::Sin].into());
        // A name of a parameter is no other value's.
        let (lines, _) = f.lines(&[(fields[0], "part_b"), (fields[1], "v")], &|_| "part_a".to_owned());
        assert_eq!(lines[0], "part_c = (2 + (time - (-0.25))) * part_a");
        let values = f.values(1.0, |_| 0.5);
        let expected = (2.0f64 + 1.25) * 0.5;
        assert_eq!(f.component(&values, fields[0], 0), (expected.sin() / 0.5) as f32);
        assert_eq!(f.component(&values, fields[1], 2), expected as f32);
        assert_eq!(f.reads(fields[1]), (true, [0].into()));
        let range = f.range(fields[0], 0);
        assert!(range.lo <= -2.0 && range.hi >= 2.0 && range.magnitude() < 2.1, "{range:?}");
    }

    #[test]
    fn nothing_infinite_reaches_a_shader() {
        let mut f = Formulas::default();
        f.note(Read::Time, 1, 0, Interval::ALL);
        let time = f.leaves[&(1, 0)];
        let mut term = time;
        for _ in 0..12 {
            term = f.op(Op::Square, [term, 0, 0, 0]);
        }
        let field = f.field(&[term]);
        for time in [10.0, 1e30, f64::INFINITY] {
            assert!(f.component(&f.values(time, |_| 0.0), field, 0).is_finite());
        }
    }
}
