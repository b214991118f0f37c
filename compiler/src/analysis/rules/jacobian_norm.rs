//! Norms of maps of points.

use super::isometry::Mirror;
use crate::analysis::dual::{Dual, Duals, add, on_side, pieces, side_of};
use crate::analysis::matrix::{Row, Rows, matrix_norm};
use crate::analysis::tape::{Step, Steps, Tape};
use crate::analysis::{Facts, Pinned};
use crate::analysis::branches::Side;
use crate::graph::algebra::Algebra;
use crate::graph::interval::Interval;
use crate::graph::{Graph, Leaf, WORLD};
use crate::graph::kernel::{self, Op};
use crate::rules::Rule;
use rustc_hash::FxHashMap;
use smallvec::SmallVec;
use std::rc::Rc;

/// A bound of the norm of the Jacobian whose rows are the gradients of these steps. A pair of coordinates that is another pair turned
/// by an angle t counts as that pair with its slip: (∇u - v∇t, ∇v + u∇t), for a turn is an isometry; so does one that is turned by way of its angle. A
/// point that is another one mirrored counts as that one.
pub fn map_norm(tape: &Tape, values: &[Dual], rows: &[usize]) -> f64 {
    if !tape.rules.has(Rule::JacobianNorm) {
        // Frobenius.
        return rows.iter().map(|&row| values.get(row).map_or(f64::INFINITY, |d| d.norm.powi(2))).sum::<f64>().sqrt().next_up();
    }
    norm_of_rows(tape, values, rows, &|_| true)
}

/// The same, or what the rows go through says where that is less.
pub fn point_norm(tape: &Tape, graph: &Graph, values: &[Dual], rows: &[usize]) -> f64 {
    let norm = map_norm(tape, values, rows);
    if norm > 1.0 { norm.min(chain_norm(tape, graph, values, rows)) } else { norm }
}

/// The norm of a map where of some rows only their own gradients are known.
fn norm_of_rows(tape: &Tape, values: &[Dual], rows: &[usize], is_open: &dyn Fn(usize) -> bool) -> f64 {
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
fn turned_pair(tape: &Tape, dual: &impl Fn(usize) -> Dual, [a, b]: [usize; 2], is_open: &dyn Fn(usize) -> bool) -> Option<([Row; 2], f64)> {
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

/// A value of which nothing is known.
const UNKNOWN: Dual = Dual { value: Interval::ALL, gradient: [Interval::ALL; 3], norm: f64::INFINITY, jumps: 0 };

/// What some steps are made of by folds, turns and moves alone: so many times as steep as a cut below them, at most, wherever that is and
/// whatever the parameters are. A cut is up to three steps that are all that those above need of the point.
#[derive(Clone, Debug)]
pub struct Chain {
    cut: Steps,
    norm: f64,
    /// The variables, which must not move with the point.
    variables: Rc<[usize]>,
}

/// So many cuts are looked for, and no more where so many steps stand beside each other.
const MOST_CUTS: usize = 256;
const MOST_FRONT: usize = 64;
/// So many steps are opened and followed for all chains of a tape.
const MOST_FOLLOWED: usize = 100_000;
/// From a cut to another are so many steps at most, and so many kinks, of which every side is looked at.
const SPAN: usize = 24;
const MOST_KINKS: usize = 2;
/// Chains of fewer folds and turns are followed side by side of their kinks anyway.
const LEAST_FOLDS: usize = 4;
/// Of what is one step so many cuts are looked at, with so many steps above them.
const MOST_HEADS: usize = 4;
const HEAD: usize = 48;

/// A bound of the norm of a map by what its coordinates go through one after another; infinite where that is not known. So whatever is folded
/// and turned again and again keeps lengths.
pub fn chain_norm(tape: &Tape, graph: &Graph, values: &[Dual], rows: &[usize]) -> f64 {
    let is_still = |&step: &usize| values.get(step).is_some_and(|d| d.norm == 0.0);
    tape.chain(graph, rows).filter(|chain| chain.variables.iter().all(is_still)).map_or(f64::INFINITY, |chain| {
        let norm = chain.norm * map_norm(tape, values, &chain.cut);
        if (norm - 1.0).abs() < 1e-9 { 1.0 } else { norm }
    })
}

/// The chains of a tape, found when they are first asked for.
#[derive(Clone, Debug)]
pub struct Chains {
    known: FxHashMap<Steps, Option<Rc<Chain>>>,
    /// What each step can be that does not move with the point; the others are unknown.
    values: Vec<Dual>,
    /// The steps that are variables.
    variables: Rc<[usize]>,
    /// How many steps may still be opened and followed.
    left: usize,
}

impl Default for Chains {
    fn default() -> Self {
        Self { known: FxHashMap::default(), values: Vec::new(), variables: Rc::new([]), left: MOST_FOLLOWED }
    }
}

impl Chains {
    /// The chain under some steps; none where all is to be known from themselves.
    pub fn under(&mut self, graph: &Graph, tape: &Tape, rows: &[usize]) -> Option<Rc<Chain>> {
        if let Some(known) = self.known.get(rows) {
            return known.clone();
        }
        if self.values.is_empty() {
            self.values = still_values(graph, tape);
            let is_variable = |step: &usize| matches!(tape.steps.get(*step), Some(Step::Leaf(Leaf::Variable(_))));
            self.variables = (0..tape.steps.len()).filter(is_variable).collect();
        }
        let found = Peeled::of(graph, tape, rows, self).chain(rows);
        let found = found.map(|(cut, norm)| Rc::new(Chain { cut, norm, variables: self.variables.clone() }));
        self.known.insert(rows.into(), found.clone());
        found
    }
}

/// What each step of a tape can be that does not move with the point; variables count as what does not.
fn still_values(graph: &Graph, tape: &Tape) -> Vec<Dual> {
    let mut values: Vec<Dual> = Vec::with_capacity(tape.steps.len());
    for step in &tape.steps {
        let known = match step {
            Step::Constant(c) => Some(Interval::point(*c)),
            Step::Leaf(Leaf::Time) => Some(Interval::ALL),
            Step::Leaf(Leaf::Variable(v)) if *v >= WORLD + 3 => Some(Interval::ALL),
            Step::Leaf(Leaf::Parameter(i)) => graph.parameters.get(*i as usize).map(|p| Interval::new(p.min, p.max)),
            Step::Op(op, args) => {
                let still = |&a: &usize| values.get(a).filter(|d| d.norm == 0.0).map(|d| d.value);
                let args: Option<SmallVec<[Interval; 4]>> = args.iter().map(still).collect();
                args.map(|args| kernel::interval(*op, &args))
            }
            _ => None,
        };
        values.push(known.map_or(UNKNOWN, Dual::constant));
    }
    values
}

/// Steps opened one after another, the uppermost first.
struct Peeled<'a> {
    graph: &'a Graph,
    tape: &'a Tape,
    opened: Vec<usize>,
    /// What is left where that is a cut, and how many steps are opened above it. The first is what all begins with.
    cuts: Vec<(Steps, usize)>,
    /// The steps' values; those that move are unknown but while they are followed.
    values: &'a mut [Dual],
    left: &'a mut usize,
}

impl<'a> Peeled<'a> {
    fn of(graph: &'a Graph, tape: &'a Tape, rows: &[usize], chains: &'a mut Chains) -> Self {
        let Chains { values, left, .. } = chains;
        let moves = |step: &usize| values.get(*step).is_some_and(|d| d.norm != 0.0);
        let mut front: Vec<usize> = rows.iter().copied().filter(|r| moves(r)).collect();
        let (mut cuts, mut opened) = (vec![(Steps::from(rows), 0)], Vec::new());
        front.sort_unstable();
        front.dedup();
        while cuts.len() < MOST_CUTS && front.len() < MOST_FRONT && *left > 0 {
            let Some(top) = front.pop() else { break };
            let Some(Step::Op(_, args)) = tape.steps.get(top) else { break };
            *left -= 1;
            opened.push(top);
            front.extend(args.iter().copied().filter(|a| moves(a)));
            front.sort_unstable();
            front.dedup();
            if front.len() <= 3 {
                cuts.push((Steps::from(front.as_slice()), opened.len()));
            }
        }
        Self { graph, tape, opened, cuts, values, left }
    }

    /// The cut at the end of the longest chain, and the norm of the way to it; none where it is short.
    fn chain(&mut self, rows: &[usize]) -> Option<(Steps, f64)> {
        if !self.is_long(0, self.opened.len()) {
            return None;
        }
        let cuts = std::mem::take(&mut self.cuts);
        // How many times as steep as each cut the uppermost is.
        let mut norms = vec![f64::INFINITY; cuts.len()];
        if rows.len() == 1 {
            let mut heads = 0;
            for ((cut, above), norm) in cuts.iter().zip(&mut norms) {
                if cut.len() == 3 && *above <= HEAD && heads < MOST_HEADS && self.is_long(*above, self.opened.len()) {
                    *norm = self.norm_of_head(cut, self.between(0, *above));
                    heads += 1;
                }
            }
        } else if let Some(first) = norms.first_mut() {
            *first = 1.0;
        }
        for (i, (above, from)) in cuts.iter().enumerate() {
            let known = norms.get(i).copied().filter(|norm| norm.is_finite());
            for (j, (below, to)) in cuts.iter().enumerate().skip(i + 1) {
                let Some(known) = known.filter(|_| to - from <= SPAN) else { break };
                let Some(norm) = self.norm_between((*from, *to), (above, below)) else { break };
                if let Some(slot) = norms.get_mut(j) {
                    *slot = slot.min(norm * known);
                }
            }
        }
        let last = norms.iter().rposition(|norm| norm.is_finite())?;
        let (cut, above) = cuts.get(last)?;
        self.is_long(0, *above).then(|| (cut.clone(), norms.get(last).copied().unwrap_or(f64::INFINITY)))
    }

    fn between(&self, from: usize, to: usize) -> &[usize] {
        self.opened.get(from..to).unwrap_or_default()
    }

    /// Whether so much is folded between two cuts that to follow the chain is worth it.
    fn is_long(&self, from: usize, to: usize) -> bool {
        let steps = self.between(from, to);
        steps.iter().filter(|step| self.folds(**step)).count() >= LEAST_FOLDS || steps.iter().any(|step| self.turns(*step))
    }

    fn folds(&self, step: usize) -> bool {
        matches!(self.tape.steps.get(step), Some(Step::Op(Op::Min | Op::Max | Op::Abs | Op::Select | Op::TurnU | Op::TurnV, _)))
    }

    /// Whether a step is a turn by an angle that is no number.
    fn turns(&self, step: usize) -> bool {
        let Some(Step::Op(Op::TurnU | Op::TurnV, args)) = self.tape.steps.get(step) else { return false };
        !args.last().is_some_and(|&a| matches!(self.tape.steps.get(a), Some(Step::Constant(_))))
    }

    /// How many times as steep as a cut the uppermost step is, side by side of the kinks of the steps between.
    fn norm_of_head(&self, cut: &[usize], opened: &[usize]) -> f64 {
        let mut known: Vec<usize> = cut.to_vec();
        let mut still = Vec::new();
        let mut steps: Vec<Step> = (0..cut.len() as u8).map(|i| Step::Leaf(Leaf::P(i))).collect();
        for &step in opened.iter().rev() {
            let Some(Step::Op(op, args)) = self.tape.steps.get(step) else { return f64::INFINITY };
            let mut of = Steps::new();
            for &arg in args {
                of.push(known.iter().position(|k| *k == arg).unwrap_or_else(|| {
                    steps.push(Step::Leaf(Leaf::Variable(still.len() as u32)));
                    still.push(arg);
                    known.push(arg);
                    known.len() - 1
                }));
            }
            steps.push(Step::Op(*op, of));
            known.push(step);
        }
        let nodes = known.iter().filter_map(|&k| self.tape.nodes.get(k).copied()).collect();
        let leaf = |leaf| match leaf {
            Leaf::P(i) => Dual::coordinate(usize::from(i), Interval::ALL),
            Leaf::Variable(v) => still.get(v as usize).and_then(|&s| self.values.get(s)).copied().unwrap_or(Dual::constant(Interval::ALL)),
            _ => Dual::constant(Interval::ALL),
        };
        pieces(&mut Facts { rules: self.tape.rules, ..Facts::default() }, self.graph, &Tape::of_steps(steps, nodes, self.tape.rules), &leaf).0.norm
    }

    /// The norm of a map from one cut to another, over all sides of the kinks between. None where they are too many.
    fn norm_between(&mut self, (from, to): (usize, usize), (above, below): (&[usize], &[usize])) -> Option<f64> {
        for (axis, &step) in below.iter().enumerate() {
            self.set(step, Dual::coordinate(axis, Interval::ALL));
        }
        let mut most: f64 = 0.0;
        let mut kinks: SmallVec<[Kink; MOST_KINKS]> = SmallVec::new();
        let mut piece = 0;
        while piece < 1 << kinks.len() {
            let followed = self.follow((from, to), piece, &mut kinks);
            if followed.is_none() {
                most = f64::INFINITY;
                break;
            }
            // Of a turn that is not opened its arguments are not within reach.
            let is_open = |row| self.between(from, to).contains(&row);
            most = most.max(norm_of_rows(self.tape, self.values, above, &is_open));
            piece += 1;
        }
        for at in from..to {
            if let Some(&step) = self.opened.get(at) {
                self.set(step, UNKNOWN);
            }
        }
        below.iter().for_each(|&step| self.set(step, UNKNOWN));
        Some(most).filter(|norm| norm.is_finite())
    }

    /// Computes the steps between two cuts on one side of each kink. None where there are too many of these, or it takes too long.
    fn follow(&mut self, (from, to): (usize, usize), piece: usize, kinks: &mut SmallVec<[Kink; MOST_KINKS]>) -> Option<()> {
        *self.left = self.left.checked_sub(to - from)?;
        let algebra = &mut Duals { pinned: Pinned::default() };
        for at in (from..to).rev() {
            let step = *self.opened.get(at)?;
            let Some(Step::Op(op, args)) = self.tape.steps.get(step) else { return None };
            let of: SmallVec<[Dual; 4]> = args.iter().filter_map(|&a| self.values.get(a).copied()).collect();
            let dual = match (Kink::of(*op, args), side_of(*op, &of)) {
                (Some(_), Some(side)) => on_side(*op, &of, side),
                (Some((kink, turned)), None) => {
                    let known = kinks.iter().position(|k| *k == kink);
                    let at = known.unwrap_or(kinks.len());
                    if known.is_none() {
                        kinks.push(kink);
                    }
                    if kinks.len() > MOST_KINKS {
                        return None;
                    }
                    on_side(*op, &of, if (piece >> at & 1 == 0) == turned { Side::Second } else { Side::First })
                }
                _ => algebra.op(*op, &of),
            };
            self.set(step, dual);
        }
        Some(())
    }

    fn set(&mut self, step: usize, dual: Dual) {
        if let Some(slot) = self.values.get_mut(step) {
            *slot = dual;
        }
    }
}

/// What decides between the sides of a kink: a condition, a sign, or which of two steps is the smaller.
#[derive(Clone, Copy, PartialEq)]
enum Kink {
    Condition(usize),
    Sign(usize),
    Order(usize, usize),
}

impl Kink {
    /// What decides at an operation, and whether its sides are the other way round.
    fn of(op: Op, args: &[usize]) -> Option<(Self, bool)> {
        match (op, args) {
            (Op::Select, &[condition, ..]) => Some((Self::Condition(condition), false)),
            (Op::Abs, &[a]) => Some((Self::Sign(a), false)),
            (Op::Min | Op::Max, &[a, b]) => Some((Self::Order(a.min(b), a.max(b)), (op == Op::Max) != (b < a))),
            _ => None,
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]
mod tests {
    use crate::diagnostic::Code;
    use crate::{MemoryLoader, Options, compile};

    /// The largest factor of a formula that iterates so, over all space.
    fn factor(turns: u32, next: &str, end: &str) -> f64 {
        let text = format!("param t = 0.5 in 0..1\nfield f = {{ let q = p for i in 0..{turns} {{ q = {next} }}; {end} }}\nscene = f");
        let outcome = compile(&MemoryLoader::new().with("main.sdf", text.as_str()), "main.sdf", &Options::default());
        assert!(outcome.diagnostics.iter().all(|d| d.code == Code::Unused), "{text}: {:?}", outcome.diagnostics);
        outcome.compiled.unwrap().graph.factors.iter().map(|f| f.lipschitz).fold(1.0, f64::max)
    }

    #[test]
    fn what_is_folded_and_turned_again_and_again_keeps_lengths() {
        let folded = "fold(fold(fold(q, (1, 1, 0)), (1, 0.3, 1)), (0, 1, 1)) - (0.5, 0.2, t)";
        let turned = "rotate(rotate(abs(q) - 0.5, z, t), x, t / 2)";
        let swapped = "{ let a = if q.x < q.y { q.yxz } else { q }; (if a.x < a.z { a.zyx } else { a }) - (0.5, 0.3, 0.2) }";
        let sorted = "{ let a = abs(q); (max(a.x, a.y), min(a.x, a.y), a.z) - 0.4 }";
        let mirrored = "fold(abs(q), (cos(t), -sin(t), 0.3 * t)) - (0.2, t, 0)";
        for next in [folded, turned, swapped, sorted, mirrored] {
            for end in ["length(q) - 0.2", "{ let d = abs(q) - 0.2; length(max(d, 0)) + min(max(d.x, max(d.y, d.z)), 0) }", "box(0.4).at(q)"] {
                assert_eq!(factor(8, next, end), 1.0, "{next}: {end}");
            }
        }
        // And each time twice as large, which the end takes back.
        assert_eq!(factor(8, &format!("2 * {folded}"), "length(q) / 256 - 0.01"), 1.0);
        // Not where one side of a fold is steeper.
        let half = factor(5, "(abs(q.x) - 0.5, 2 * abs(q.y) - 0.5, abs(q.z) - 0.5)", "length(q) - 0.2");
        assert!((31.9..32.1).contains(&half), "{half}");
        let sheared = factor(2, "rotate((q.x + 0.84 * q.y, q.y, q.z), x, 40deg)", "length(q) - 0.3");
        assert!((2.06..2.07).contains(&sheared), "{sheared}");
    }
}
