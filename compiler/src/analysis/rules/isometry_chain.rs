//! What is folded, mirrored, turned and moved again and again keeps lengths, though the rows of its Jacobian do not say so.

use super::jacobian_norm::{map_norm, norm_of_rows};
use crate::analysis::domain::Pinned;
use crate::analysis::dual::{Dual, Side, on_side, side_of};
use crate::analysis::duals::Duals;
use crate::analysis::facts::Facts;
use crate::analysis::formula::{Chain, Chains, Formula};
use crate::analysis::tape::{Step, Steps, Tape};
use crate::graph::algebra::Algebra;
use crate::graph::interval::Interval;
use crate::graph::kernel::{self, Op};
use crate::graph::{Graph, Leaf, WORLD};
use crate::rules::Rule;
use smallvec::SmallVec;
use std::rc::Rc;

/// A bound of the norm of the Jacobian whose rows are the gradients of these steps, or what the rows go through says where that is less.
pub fn point_norm(tape: &Formula, graph: &Graph, values: &[Dual], rows: &[usize]) -> f64 {
    let norm = map_norm(tape, values, rows);
    if norm > 1.0 { norm.min(chain_norm(tape, graph, values, rows)) } else { norm }
}

/// A value of which nothing is known.
const UNKNOWN: Dual = Dual { value: Interval::ALL, gradient: [Interval::ALL; 3], norm: f64::INFINITY, jumps: 0 };

/// So many cuts are looked for, and no more where so many steps stand beside each other.
const MOST_CUTS: usize = 256;
const MOST_FRONT: usize = 64;
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
pub fn chain_norm(tape: &Formula, graph: &Graph, values: &[Dual], rows: &[usize]) -> f64 {
    let is_still = |&step: &usize| values.get(step).is_some_and(|d| d.norm == 0.0);
    chain(tape, graph, rows).filter(|chain| chain.variables.iter().all(is_still)).map_or(f64::INFINITY, |chain| {
        let norm = chain.norm * map_norm(tape, values, &chain.cut);
        if (norm - 1.0).abs() < 1e-9 { 1.0 } else { norm }
    })
}

/// What the coordinates `rows` go through; none where all is to be known from themselves.
pub fn chain(tape: &Formula, graph: &Graph, rows: &[usize]) -> Option<Rc<Chain>> {
    if !tape.rules.has(Rule::IsometryChain) {
        return None;
    }
    let chains = &mut *tape.chains.borrow_mut();
    if let Some(known) = chains.known.get(rows) {
        return known.clone();
    }
    if chains.values.is_empty() {
        chains.values = still_values(graph, tape);
        let is_variable = |step: &usize| matches!(tape.steps.get(*step), Some(Step::Leaf(Leaf::Variable(_))));
        chains.variables = (0..tape.steps.len()).filter(is_variable).collect();
    }
    let found = Peeled::of(graph, tape, rows, chains).chain(rows);
    let found = found.map(|(cut, norm)| Rc::new(Chain { cut, norm, variables: chains.variables.clone() }));
    chains.known.insert(rows.into(), found.clone());
    found
}

/// What each step of a tape can be that does not move with the point; variables count as what does not.
fn still_values(graph: &Graph, tape: &Formula) -> Vec<Dual> {
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
    tape: &'a Formula,
    opened: Vec<usize>,
    /// What is left where that is a cut, and how many steps are opened above it. The first is what all begins with.
    cuts: Vec<(Steps, usize)>,
    /// The steps' values; those that move are unknown but while they are followed.
    values: &'a mut [Dual],
    left: &'a mut usize,
}

impl<'a> Peeled<'a> {
    fn of(graph: &'a Graph, tape: &'a Formula, rows: &[usize], chains: &'a mut Chains) -> Self {
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
        Facts::at(Pinned::default(), self.tape.rules).pieces(self.graph, &Formula::of(Tape::of_steps(steps, nodes, self.tape.rules)), &leaf).0.norm
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
