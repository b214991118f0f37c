//! A field as a straight line of steps, each written once, and its shorter forms for parts of space.

// A step names only steps before it: `Code::new` and `Code::shorter` see to that, so every index is in range.
#![allow(clippy::indexing_slicing)]

use crate::certify::form::Polynomial;
use crate::certify::forms::formed;
use crate::certify::step::{Known, Step, known};
use crate::evaluate::Tape;
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use std::sync::Arc;

/// Steps, the last of which is the field.
#[derive(Clone, Debug, Default)]
pub(super) struct Code {
    pub steps: Vec<Step>,
    /// Of which the forms of some steps are.
    pub polynomials: Arc<[Polynomial]>,
}

/// Where the point of a ray's code stands: the parameter, then origin and direction, then their products and sums.
const RAY: [usize; 3] = [1, 4, 10];

impl Code {
    /// The code of a tape's first formula over the three coordinates of a point.
    pub(super) fn new(tape: &Tape) -> Self {
        Self::after((0..3).map(Step::Input).collect(), [0, 1, 2], tape)
    }

    /// The same over the parameter of a ray, whose origin and direction [`Code::aim`] sets.
    pub(super) fn along(tape: &Tape) -> Self {
        let mut steps = vec![Step::Input(0)];
        steps.extend([Step::Constant(0.0); 6]);
        steps.extend((4..7).map(|direction| Step::Op(Op::Mul, [0, direction, 0, 0])));
        steps.extend((1..4).map(|origin| Step::Op(Op::Add, [origin, origin + 6, 0, 0])));
        Self::after(steps, [10, 11, 12], tape)
    }

    fn after(mut steps: Vec<Step>, point: [u32; 3], tape: &Tape) -> Self {
        let given = steps.len();
        let zero = given as u32;
        // A field reads no normal.
        steps.push(Step::Constant(0.0));
        let mut places = point.to_vec();
        places.extend([zero; 3]);
        for &constant in tape.constants() {
            places.push(steps.len() as u32);
            steps.push(Step::Constant(constant));
        }
        places.resize(tape.registers(), zero);
        for (op, to, from) in tape.instructions() {
            let from = from.map(|register| places[register as usize]);
            places[to as usize] = steps.len() as u32;
            steps.push(Step::Op(op, from));
        }
        let field = tape.output(0).map_or(zero, |register| places[register as usize]);
        steps.truncate(field as usize + 1);
        let (steps, polynomials) = formed(steps, given);
        Self { steps, polynomials }
    }

    /// Sets the ray of a code made by [`Code::along`].
    pub(super) fn aim(&mut self, origin: [f64; 3], direction: [f64; 3]) {
        for (first, vector) in [(RAY[0], origin), (RAY[1], direction)] {
            for (i, component) in vector.into_iter().enumerate() {
                if let Some(step) = self.steps.get_mut(first + i) {
                    *step = Step::Constant(component);
                }
            }
        }
    }

    /// The value in 64 bits at an argument. `values` is room for every step's value.
    pub(super) fn value(&self, at: &[f64], values: &mut Vec<f64>) -> f64 {
        values.clear();
        for step in &self.steps {
            values.push(match *step {
                Step::Input(i) => at[usize::from(i)],
                Step::Constant(value) => value,
                Step::Op(op, from) => (op.row().value)(from.map(|i| values[i as usize])),
                Step::Form(_, from) => values[from[0] as usize],
            });
        }
        values.last().copied().unwrap_or(0.0)
    }

    /// The same function where every step's values lie in `range`, with less steps; none where it would save too little.
    pub(super) fn shorter(&self, range: impl Fn(usize) -> Interval, room: &mut Room) -> Option<Self> {
        let Room { live, place } = room;
        live.clear();
        live.resize(self.steps.len(), false);
        *live.last_mut()? = true;
        let mut kept = 0;
        for (i, step) in self.steps.iter().enumerate().rev() {
            if !live[i] {
                continue;
            }
            if let Step::Form(_, from) = *step {
                live[from[0] as usize] = true;
            } else if let Step::Op(op, from) = *step {
                match known(op, from.map(|a| range(a as usize)), range(i)) {
                    Known::Argument(k) => {
                        live[from[k] as usize] = true;
                        continue;
                    }
                    Known::Negated => live[from[0] as usize] = true,
                    Known::Constant(_) => {}
                    Known::Open => from[..usize::from(op.row().arity)].iter().for_each(|&a| live[a as usize] = true),
                }
            }
            kept += 1;
        }
        if kept * 10 > self.steps.len() * 9 {
            return None;
        }
        place.clear();
        place.resize(self.steps.len(), 0);
        let mut steps = Vec::with_capacity(kept);
        for (i, step) in self.steps.iter().enumerate() {
            if !live[i] {
                continue;
            }
            let step = match *step {
                Step::Op(op, from) => {
                    let to = from.map(|a| place[a as usize]);
                    match known(op, from.map(|a| range(a as usize)), range(i)) {
                        Known::Argument(k) => {
                            place[i] = to[k];
                            continue;
                        }
                        Known::Negated => Step::Op(Op::Neg, [to[0], 0, 0, 0]),
                        Known::Constant(value) => Step::Constant(value),
                        Known::Open => {
                            let mut arguments = [0; 4];
                            let arity = usize::from(op.row().arity);
                            arguments[..arity].copy_from_slice(&to[..arity]);
                            Step::Op(op, arguments)
                        }
                    }
                }
                Step::Form(form, from) => {
                    let value = place[from[0] as usize];
                    // What it was made of may have gone.
                    let gone = from[1..=form.arity()].iter().any(|&a| !live[a as usize]);
                    if gone || matches!(steps.get(value as usize), Some(Step::Constant(_))) {
                        place[i] = value;
                        continue;
                    }
                    let mut arguments = [0; 4];
                    arguments.iter_mut().zip(&from[..=form.arity()]).for_each(|(to, a)| *to = place[*a as usize]);
                    Step::Form(form, arguments)
                }
                other => other,
            };
            place[i] = steps.len() as u32;
            steps.push(step);
        }
        Some(Self { steps, polynomials: self.polynomials.clone() })
    }
}

/// Room for [`Code::shorter`].
#[derive(Clone, Debug, Default)]
pub(super) struct Room {
    live: Vec<bool>,
    place: Vec<u32>,
}
