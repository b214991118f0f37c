//! Norms of maps of points.

use super::isometry::Mirror;
use crate::analysis::dual::{Dual, add};
use crate::analysis::formula::Formula;
use crate::analysis::matrix::{Row, Rows, matrix_norm};
use crate::analysis::tape::{Step, Tape};
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::rules::Rule;
use smallvec::SmallVec;

/// A bound of the norm of the Jacobian whose rows are the gradients of these steps. A pair of coordinates that is another pair turned
/// by an angle t counts as that pair with its slip: (∇u - v∇t, ∇v + u∇t), for a turn is an isometry; so does one that is turned by way of its angle. A
/// point that is another one mirrored counts as that one.
pub fn map_norm(tape: &Formula, values: &[Dual], rows: &[usize]) -> f64 {
    if !tape.rules.has(Rule::JacobianNorm) {
        // Frobenius.
        return rows.iter().map(|&row| values.get(row).map_or(f64::INFINITY, |d| d.norm.powi(2))).sum::<f64>().sqrt().next_up();
    }
    norm_of_rows(tape, values, rows, &|_| true)
}

/// The norm of a map where of some rows only their own gradients are known.
pub(super) fn norm_of_rows(tape: &Formula, values: &[Dual], rows: &[usize], is_open: &dyn Fn(usize) -> bool) -> f64 {
    let dual = |i: usize| values.get(i).copied().unwrap_or(Dual::constant(Interval::ALL));
    let mut matrix: Rows =
        rows.iter().map(|&r| (dual(r).gradient, dual(r).norm)).collect();
    // Each row stands for itself or in one pair: the rows of a pair are those of what is turned, which as a whole is as steep.
    let mut paired: SmallVec<[bool; 4]> = SmallVec::from_elem(false, rows.len());
    let mut turning = 0.0;
    for i in 0..rows.len() {
        for j in 0..rows.len() {
            let (Some(&a), Some(&b), Some(false), Some(false)) = (rows.get(i), rows.get(j), paired.get(i), paired.get(j)) else { continue };
            if !tape.rules.has(Rule::TurnedPair) {
                continue;
            }
            let Some((pair, more)) = turned_pair(tape, &dual, [a, b], is_open) else { continue };
            turning += more;
            for (slot, row) in [i, j].into_iter().zip(pair) {
                matrix.get_mut(slot).into_iter().for_each(|slot| *slot = row);
                paired.get_mut(slot).into_iter().for_each(|slot| *slot = true);
            }
        }
    }
    let apart: Rows = rows.iter().map(|&r| steady(tape, values, r, 8)).collect();
    let rest = apart.iter().map(|(_, norm)| norm * norm).sum::<f64>().sqrt().next_up();
    let steady: Rows = apart.iter().map(|(g, _)| (*g, Dual::components_norm(g))).collect();
    let norm = (matrix_norm(&matrix) + turning).min(matrix_norm(&steady) + rest);
    // What is mirrored keeps its lengths, wherever the mirror stands.
    let still = |&step: &usize| dual(step).norm == 0.0;
    match Mirror::of(tape, rows).filter(|mirror| tape.rules.has(Rule::MirroredPoint) && norm > 0.0 && mirror.normal.iter().all(still)) {
        Some(mirror) => norm.min(norm_of_rows(tape, values, &mirror.of, is_open)),
        None => norm,
    }
}

/// The gradients of the pair that two steps are when it is turned, the first by its cosine, with their norms; and how much faster the two may move than
/// those. None where they are no such pair.
fn turned_pair(tape: &Formula, dual: &impl Fn(usize) -> Dual, [a, b]: [usize; 2], is_open: &dyn Fn(usize) -> bool) -> Option<([Row; 2], f64)> {
    if let (Some(Step::Op(Op::TurnU, first)), Some(Step::Op(Op::TurnV, second))) = (tape.steps.get(a), tape.steps.get(b)) {
        if first != second || !is_open(a) || !is_open(b) {
            return None;
        }
        let [u, v, t] = [0, 1, 2].map(|k| dual(first.get(k).copied().unwrap_or(0)));
        let slip = |coordinate: Dual, by: Interval| {
            let gradient = add(coordinate.gradient, t.scaled(by));
            let turned = if t.norm == 0.0 { 0.0 } else { by.magnitude() * t.norm };
            let norm = coordinate.norm + turned;
            (gradient, norm.min(Dual::components_norm(&gradient)))
        };
        return Some(([slip(u, v.value.neg()), slip(v, u.value)], 0.0));
    }
    let [a, b] = [a, b].map(|row| unshifted(tape, dual, row));
    let (first, second) = tape.around(a).zip(tape.around(b))?;
    let is_pair = first.is_pair(second) && is_open(a) && is_open(b);
    is_pair.then(|| (first.rows(dual), first.turning(dual)))
}

/// What a step is but for what is added to it that does not move.
fn unshifted(tape: &Tape, dual: &impl Fn(usize) -> Dual, mut step: usize) -> usize {
    while let Some((Op::Add | Op::Sub, &[a, b])) = tape.operation(step) {
        step = match [a, b].map(|side| dual(side).norm == 0.0) {
            [false, true] => a,
            [true, false] => b,
            _ => return step,
        };
    }
    step
}

/// A gradient as one that is the same in the whole box, and the norm of what is added to it.
fn steady(tape: &Tape, values: &[Dual], step: usize, depth: u32) -> ([Interval; 3], f64) {
    let Some(dual) = values.get(step) else { return ([Interval::ZERO; 3], f64::INFINITY) };
    if dual.gradient.iter().all(|g| g.is_point()) {
        return (dual.gradient, 0.0);
    }
    match tape.steps.get(step) {
        Some(Step::Op(op @ (Op::Add | Op::Sub), args)) if depth > 0 => {
            let part = |i: usize| args.get(i).map(|&a| steady(tape, values, a, depth - 1));
            let (Some((a, r)), Some((b, s))) = (part(0), part(1)) else { return ([Interval::ZERO; 3], dual.norm) };
            let b = if *op == Op::Add { b } else { b.map(Interval::neg) };
            (add(a, b), (r + s).next_up())
        }
        _ => ([Interval::ZERO; 3], dual.norm),
    }
}

#[cfg(test)]
mod tests {
    use crate::analysis::rules::tried::factors;
    use crate::rules::Rule;

    #[test]
    fn a_map_is_as_steep_as_its_rows_together_and_not_less() {
        // The golden ratio is the largest singular value of this shear.
        let [with, without] = factors(Rule::JacobianNorm, "scene = sphere(0.6).matrix(mat3((1, 0, 0), (1, 1, 0), (0, 0, 1)))");
        assert!((1.618..1.62).contains(&with) && without > 1.9, "{with} {without}");
        let [with, without] = factors(Rule::JacobianNorm, "scene = sphere(0.6).stretch((1, 2, 3))");
        assert_eq!(with, without, "one row alone is all there is");
        // A turn is an isometry; a pair whose halves are turned by two angles is none.
        let turned = |second: &str| format!("field f = {{ let a = 0.5 * p.x; let b = {second} * p.x; box((1, 2, 0.2)).at((cos(a) * p.x - sin(a) * p.z, p.y, sin(b) * p.x + cos(b) * p.z)) }}\nscene = f.within(box(2))");
        let [pair, _] = factors(Rule::TurnedPair, &turned("0.5"));
        let [other, without] = factors(Rule::TurnedPair, &turned("0.7"));
        assert!(pair < other && other == without, "{pair} {other} {without}");
    }
}
