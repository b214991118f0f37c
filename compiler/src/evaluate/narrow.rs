//! A shorter tape for a part of space: what can't matter there is left out.
//!
//! The tape is computed once over intervals that hold every point of the part. Of a `min` whose arguments' intervals are apart only the
//! smaller one is left, and so on; what nothing reads any more goes. Inside the part the values stay the same to the last bit. This is
//! how Keeter's "Massively Parallel Rendering of Complex Closed-Form Implicit Surfaces" (2020) shortens its tapes.

use super::build::{Value, ValueId, Values};
use super::{INPUTS, Tape};
use crate::graph::interval::Interval;
use crate::graph::kernel::{self, Op};

impl Tape {
    /// The same formulas for points of a box only.
    pub fn narrow(&self, region: [Interval; 3]) -> Tape {
        let mut values = Values::default();
        let mut known: Vec<(Interval, ValueId)> = Vec::with_capacity(self.registers as usize);
        for i in 0..INPUTS {
            // Normals have length one.
            let interval = region.get(i).copied().unwrap_or(Interval { lo: -1.0, hi: 1.0 });
            known.push((interval, values.add(Value::Input(i as u8))));
        }
        for &constant in &self.constants {
            known.push((Interval::point(constant), values.constant(constant)));
        }
        known.resize(self.registers as usize, (Interval::ZERO, 0));
        for instruction in &self.code {
            let arity = usize::from(instruction.op.row().arity);
            let mut intervals = [Interval::ZERO; 4];
            let mut from = [0; 4];
            for ((interval, id), &register) in
                intervals.iter_mut().zip(&mut from).zip(&instruction.from).take(arity)
            {
                if let Some(&(i, v)) = known.get(register as usize) {
                    (*interval, *id) = (i, v);
                }
            }
            let result =
                kernel::interval(instruction.op, intervals.get(..arity).unwrap_or(&intervals));
            let id = shorter(&mut values, instruction.op, &intervals, from, result)
                .unwrap_or_else(|| values.op_again(instruction.op, from));
            if let Some(slot) = known.get_mut(instruction.to as usize) {
                *slot = (result, id);
            }
        }
        let output = |&register: &u32| known.get(register as usize).map_or(0, |k| k.1);
        let outputs: Vec<ValueId> = self.outputs.iter().map(output).collect();
        values.tape(&outputs)
    }
}

/// A simpler value that an operation has for arguments in these intervals, if it has one.
fn shorter(
    values: &mut Values,
    op: Op,
    intervals: &[Interval; 4],
    from: [ValueId; 4],
    result: Interval,
) -> Option<ValueId> {
    let ([x, y, ..], [a, b, c, _]) = (*intervals, from);
    match op {
        Op::Min if x.hi < y.lo => Some(a),
        Op::Min if y.hi < x.lo => Some(b),
        Op::Max if x.lo > y.hi => Some(a),
        Op::Max if y.lo > x.hi => Some(b),
        Op::Abs if x.lo > 0.0 => Some(a),
        Op::Abs if x.hi < 0.0 => Some(values.op(Op::Neg, &[a])),
        Op::Select if x == Interval::ONE => Some(b),
        Op::Select if x == Interval::ZERO => Some(c),
        // What only takes certain values is known where its interval has one.
        Op::Lt
        | Op::Le
        | Op::Eq
        | Op::And
        | Op::Or
        | Op::Not
        | Op::Sign
        | Op::Floor
        | Op::Ceil
        | Op::Trunc
        | Op::Round
            if result.is_point() =>
        {
            Some(values.constant(result.lo))
        }
        _ => None,
    }
}
