//! A formula as a function of the distances in it.
//!
//! The lengths, the other shapes and the claims in a formula have gradients of known norm. If f's partial derivatives by them all have
//! known signs s, then |∇f| <= Σ |∂f/∂a| |∇a| = Σ ∂f/∂a s |∇a|, which is the derivative of f along one direction: there what
//! cancels between the terms does cancel. So every smooth union that is written out keeps the constant of its operands.

use crate::analysis::branches::Branches;
use crate::analysis::dual::{Dual, Side, side_of};
use crate::analysis::tape::{Step, Tape};
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::Claim;

/// What the norm of a step's gradient comes from.
#[derive(Clone, Copy, PartialEq)]
enum Part {
    /// It does not move.
    Still,
    /// Its own norm counts.
    Atom,
    /// What it is made of counts.
    Open,
}

/// A bound of the norm of the gradient of a tape's last step on one piece; infinite where this way leads nowhere.
pub fn norm_by_atoms(tape: &Tape, duals: &[Dual], branches: Option<&Branches>) -> f64 {
    let n = tape.steps.len();
    let parts = parts(tape, duals);
    let value = |i: usize| duals.get(i).map_or(Interval::ALL, |d| d.value);
    // Partial derivatives of the last step by every other, from the last backward.
    let mut by = vec![Interval::ZERO; n];
    if let Some(last) = by.last_mut() {
        *last = Interval::ONE;
    }
    let mut slopes: Vec<Vec<(usize, Interval)>> = vec![Vec::new(); n];
    for i in (0..n).rev() {
        let along = by.get(i).copied().unwrap_or(Interval::ZERO);
        if along == Interval::ZERO || parts.get(i) != Some(&Part::Open) {
            continue;
        }
        let Some(partials) = partials(tape, duals, branches, i) else { return f64::INFINITY };
        for (a, slope) in &partials {
            if let Some(slot) = by.get_mut(*a) {
                *slot = slot.add(along.mul(*slope));
            }
        }
        if let Some(slot) = slopes.get_mut(i) {
            *slot = partials;
        }
    }
    let (mut sum, mut slack): (f64, f64) = (0.0, 0.0);
    let mut signed = true;
    // The derivative along the direction in which every atom moves as its sign says.
    let mut along = vec![Interval::ZERO; n];
    for i in 0..n {
        let Some(slope) = by.get(i).copied() else { continue };
        if parts.get(i) == Some(&Part::Atom) && slope != Interval::ZERO {
            let norm = duals.get(i).map_or(f64::INFINITY, |d| d.norm);
            sum += slope.magnitude() * norm;
            let positive = slope.hi > -slope.lo;
            // Rounding outward may reach beyond zero.
            let beyond = if positive { -slope.lo } else { slope.hi }.max(0.0);
            signed &= norm.is_finite() && beyond < 1e-12;
            slack += 2.0 * beyond * norm;
            if let Some(slot) = along.get_mut(i) {
                *slot = Interval::point(if positive { norm } else { -norm });
            }
        }
    }
    if !signed {
        return sum;
    }
    for i in 0..n {
        let Some(partials) = slopes.get(i).filter(|s| !s.is_empty()) else { continue };
        let linear = matches!(tape.steps.get(i), Some(Step::Op(Op::Add | Op::Sub, _)));
        let mut total = Interval::ZERO;
        for (a, slope) in partials {
            let moved = along.get(*a).copied().unwrap_or(Interval::ZERO);
            if moved != Interval::ZERO {
                total = total.add(if linear && *slope == Interval::ONE { moved } else { moved.mul(*slope) });
            }
        }
        // What cancels up to rounding cancels.
        if total.magnitude() < 1e-12 {
            total = Interval::ZERO;
        }
        if let (Some(slot), true) = (along.get_mut(i), value(i) != Interval::EMPTY) {
            *slot = total;
        }
    }
    let directional = along.last().map_or(f64::INFINITY, |t| t.magnitude() + slack);
    let nearest = (directional * 1e9).round() / 1e9;
    let directional = if (directional - nearest).abs() < 1e-12 { nearest } else { directional };
    sum.min(directional)
}

fn parts(tape: &Tape, duals: &[Dual]) -> Vec<Part> {
    let mut parts: Vec<Part> = Vec::with_capacity(tape.steps.len());
    // Whether a step is made of atoms.
    let mut made: Vec<bool> = Vec::with_capacity(tape.steps.len());
    for (i, step) in tape.steps.iter().enumerate() {
        let of_atoms = |args: &[usize]| {
            args.iter().any(|&a| made.get(a) == Some(&true) && duals.get(a).is_some_and(|d| d.norm > 0.0))
        };
        let still = duals.get(i).is_none_or(|d| d.norm == 0.0 && d.jumps == 0);
        let (part, atoms) = match step {
            _ if still => (Part::Still, false),
            Step::Constant(_) => (Part::Still, false),
            Step::Leaf(_) => (Part::Atom, false),
            Step::Call(..) | Step::Claim(Claim::Lipschitz(..), _) => (Part::Atom, true),
            Step::Claim(Claim::Continuous, args) => (Part::Open, of_atoms(args)),
            Step::Op(Op::Length2 | Op::Length3 | Op::Length4, args) if !of_atoms(args) => (Part::Atom, true),
            Step::Op(_, args) => (Part::Open, of_atoms(args)),
        };
        parts.push(part);
        made.push(atoms);
    }
    parts
}

/// The partial derivatives of a step by its arguments; none where it stands at a kink that is not decided.
fn partials(tape: &Tape, duals: &[Dual], branches: Option<&Branches>, i: usize) -> Option<Vec<(usize, Interval)>> {
    let (op, args) = match tape.steps.get(i)? {
        Step::Op(op, args) => (*op, args),
        Step::Claim(Claim::Continuous, args) => return Some(vec![(*args.first()?, Interval::ONE)]),
        _ => return None,
    };
    let of: Vec<Dual> = args.iter().filter_map(|&a| duals.get(a).copied()).collect();
    let values: Vec<Interval> = of.iter().map(|d| d.value).collect();
    if matches!(op, Op::Min | Op::Max | Op::Abs | Op::Select) {
        let first = side_of(op, &of).or(branches.and_then(|b| b.side(i)))? == Side::First;
        return Some(match op {
            Op::Abs => vec![(*args.first()?, if first { Interval::ONE } else { Interval::ONE.neg() })],
            Op::Select => vec![(*args.get(if first { 1 } else { 2 })?, Interval::ONE)],
            _ => vec![(*args.get(usize::from(!first))?, Interval::ONE)],
        });
    }
    let value = duals.get(i)?.value;
    let mut slopes = crate::analysis::slopes::slopes(op, &values, value);
    if matches!(op, Op::Length2 | Op::Length3 | Op::Length4) {
        for slope in &mut slopes {
            *slope = slope.intersect(Interval::new(-1.0, 1.0));
        }
    }
    Some(args.iter().copied().zip(slopes).collect())
}
