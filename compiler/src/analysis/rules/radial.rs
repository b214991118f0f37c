//! Formulas of nothing but a distance, or of its square, looked at along that one number.
//!
//! A bump `exp(-d²)`, a ripple `cos(d)` or a well `1/(1 + d²)` is as steep all over a sphere, which boxes of space have to be small for to see: the
//! steepest place of each is a shell. With u the distance or its square, |∇f| is at most |df/du| |∇u|, where |∇u| is at most what the point's
//! own map is stretched by, or 2√u times that. Both are functions of u alone, so one dimension is searched instead of three.

use crate::analysis::dual::Dual;
use super::isometry_chain::point_norm;
use crate::analysis::tape::{Step, Steps, Tape};
use crate::analysis::derivative;
use crate::analysis::formula::Formula;
use crate::analysis::{Box3, Constant, Domain, Facts, leaf_dual};
use crate::analysis::constant::{Norm, Sought};
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::{Claim, Graph, Leaf};
use crate::rules::Rule;
use std::collections::BTreeSet;

/// A tape that reads the point through one step alone.
struct Radial {
    /// The steps behind that one, which is now the first coordinate.
    tape: Formula,
    /// All values of that step.
    values: Interval,
    /// Whether that is the square of a distance.
    squared: bool,
    /// How much the map is stretched by at most from whose image the distance is measured.
    stretch: f64,
}

impl Radial {
    /// The tape as a function of one distance, with what is known of its steps. None where there is none, or where the distance is all there is.
    fn of(graph: &Graph, tape: &Formula, duals: &[Dual]) -> Option<Self> {
        let moves = |step: &usize| duals.get(*step).is_none_or(|d| d.norm > 0.0 || d.jumps != 0);
        let last = tape.steps.len().checked_sub(1)?;
        let (mut open, mut behind) = (BTreeSet::from([last]), Vec::new());
        let waist = loop {
            let step = open.pop_last()?;
            if open.is_empty() && step != last && measured(tape, step).is_some() {
                break step;
            }
            let (Step::Op(_, args) | Step::Claim(Claim::Continuous, args)) = tape.steps.get(step)? else { return None };
            open.extend(args.iter().copied().filter(moves));
            behind.push(step);
        };
        let (rows, squared) = measured(tape, waist)?;
        let (stretch, values) = (point_norm(tape, graph, duals, &rows), duals.get(waist)?.value);
        // What does not move has been left out so far.
        let mut needed: BTreeSet<usize> = behind.iter().copied().collect();
        while let Some(step) = behind.pop() {
            let (Step::Op(_, args) | Step::Claim(_, args) | Step::Call(_, args)) = tape.steps.get(step)? else { continue };
            behind.extend(args.iter().copied().filter(|&a| a != waist && needed.insert(a)));
        }
        needed.insert(waist);
        let needed: Vec<usize> = needed.into_iter().collect();
        let at = |step: &usize| needed.binary_search(step).unwrap_or(0);
        let moved = |args: &Steps| args.iter().map(at).collect();
        let steps = needed.iter().filter_map(|&step| match tape.steps.get(step)? {
            _ if step == waist => Some(Step::Leaf(Leaf::P(0))),
            Step::Op(op, args) => Some(Step::Op(*op, moved(args))),
            Step::Claim(claim, args) => Some(Step::Claim(claim.clone(), moved(args))),
            Step::Call(shape, args) => Some(Step::Call(*shape, moved(args))),
            same => Some(same.clone()),
        });
        let nodes = needed.iter().filter_map(|&step| tape.nodes.get(step).copied());
        let rarely = tape.vanishes_rarely(waist);
        let tape = Tape::of_steps(steps.collect(), nodes.collect(), tape.rules);
        let tape = Formula::of(if rarely { tape.of_distance() } else { tape }).unmirrored();
        (stretch.is_finite() && values.is_finite()).then_some(Self { tape, values, squared, stretch })
    }

    /// The number itself over a part of its values, with how fast it changes on the way away from where it is least.
    fn number(&self, values: Interval) -> Dual {
        let stretch = Interval::new(0.0, self.stretch);
        let slope = if self.squared { values.sqrt().mul(Interval::point(2.0)).mul(stretch) } else { stretch };
        Dual { value: values, norm: slope.hi, gradient: [slope, Interval::ZERO, Interval::ZERO], jumps: 0 }
    }
}

/// The coordinates of which a step is the distance from zero, or its square (true).
fn measured(tape: &Tape, step: usize) -> Option<(Steps, bool)> {
    if let Step::Op(Op::Length2 | Op::Length3 | Op::Length4, args) = tape.steps.get(step)? {
        return Some((args.clone(), false));
    }
    let (mut open, mut rows) = (vec![step], Steps::new());
    while let Some(step) = open.pop() {
        match tape.steps.get(step)? {
            Step::Op(Op::Add, args) if open.len() + rows.len() < 4 => open.extend(args.iter().copied()),
            Step::Op(Op::Square, args) => rows.push(*args.first()?),
            Step::Op(Op::Mul, args) if args.first() == args.get(1) => rows.push(*args.first()?),
            _ => return None,
        }
    }
    Some((rows, true))
}

impl Facts {
    /// The constant of a tape that reads the point through one distance alone, wherever its value is within an interval; none where it does not.
    pub(in crate::analysis) fn along_distance(&mut self, graph: &Graph, tape: &Formula, domain: &Domain, within: Interval, budget: usize) -> Option<Constant> {
        if !self.rules.has(Rule::Radial) {
            return None;
        }
        let duals = self.all_duals(graph, tape, domain);
        if duals.last().is_none_or(|d| d.jumps != 0) {
            return None;
        }
        let radial = Radial::of(graph, tape, &duals)?;
        let line = Box3([radial.values, Interval::ZERO, Interval::ZERO]);
        let line = Domain { variables: domain.variables.clone(), ..Domain::of(line) };
        let found = self.supremum(graph, &radial.tape, &line, Sought::within(budget), |facts, part, ()| {
            let pinned = facts.pinned.clone();
            let leaf = |leaf| match leaf {
                Leaf::P(0) => radial.number(part.point.axis(0)),
                other => leaf_dual(graph, &pinned, other, part),
            };
            let (dual, runs) = derivative::hull_of_pieces(facts, graph, &radial.tape, &leaf);
            facts.account.boxes += runs as u64;
            let norm = if dual.value.intersect(within).is_empty() { 0.0 } else { dual.norm };
            (Norm { norm, jumps: dual.jumps != 0, runs }, ())
        });
        Some(found.constant).filter(|found| !found.jumps)
    }
}

#[cfg(test)]
mod tests {
    use crate::analysis::rules::tried::factors;
    use crate::rules::Rule;

    #[test]
    fn what_reads_one_distance_is_searched_along_it() {
        let [with, without] = factors(Rule::Radial, "field f = 0.5 - exp(-4 * dot(p, p))\nscene = f.within(box(6))");
        assert!(with < without, "{with} {without}");
        // At 1/√8 from the middle it is 4 √(1/2e) steep.
        assert!((1.715..1.75).contains(&with), "{with}");
        let [with, without] = factors(Rule::Radial, "field f = 0.5 - exp(-4 * dot(p, p)) * (1 + 0.1 * sin(9 * p.x))\nscene = f.within(box(6))");
        assert_eq!(with, without, "a coordinate is read beside the distance");
    }
}
