//! Soft maxima and norms of higher powers that are written out, whose slopes are known though those of their parts have no limit.
//!
//! log Σ exp(aᵢ) has the gradient Σ wᵢ ∇aᵢ with weights wᵢ = exp(aᵢ)/Σ exp(aⱼ) that add up to one: it lies between those of the aᵢ. (The kernel
//! writes it as m + log Σ exp(aᵢ - m).)
//!
//! min(a, b) - g(|a - b|), as Quilez writes smooth minima, has the gradient (1 + g') ∇a - g' ∇b where a is less: as long as g' is between -1 and 0,
//! that lies between those of a and b too. The same holds of max(a, b) + g(|a - b|), which log(exp(a) + exp(b)) is as well, and, with the weights
//! 1 + g' and 1 - g', of half of a + b + g(a - b).
//!
//! N = (Σ aᵢᵏ)^(1/k) has the gradient Σ wᵢ ∇aᵢ with wᵢ = (aᵢ/N)^(k-1) and Σ (aᵢ/N)ᵏ = 1. For k >= 2 the wᵢ², and for k < 0 the wᵢ, add up to no more
//! than one; for 1 <= k < 2 the norm of the weights is at most n^(1/k - 1/2), by Hölder's inequality.

use crate::analysis::dual::Dual;
use crate::analysis::duals::Duals;
use crate::analysis::matrix::{Row, Rows, matrix_norm};
use crate::analysis::tape::{Step, Tape};
use crate::graph::algebra::Algebra;
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::{Graph, Leaf};
use smallvec::SmallVec;
use std::collections::BTreeSet;
use std::rc::Rc;

/// A step that is put together of others, by weights of which something is known.
#[derive(Clone, Debug)]
pub(in crate::analysis) struct Soft {
    rows: Vec<Operand>,
    weights: Weights,
    /// Whether it is put together with the sign changed.
    turned: bool,
    /// What the weights depend on, where that reads live numbers.
    slope: Option<Slope>,
}

/// How a step changes with a distance that it reads.
#[derive(Clone, Debug)]
struct Slope {
    /// The distance.
    apart: usize,
    /// All that is needed beside it, in order; the step itself is the last.
    steps: Vec<usize>,
    /// Whether the step is taken away.
    taken: bool,
    /// What it is added to: the less or the larger one of two, or their sum.
    of: Op,
}

/// What is put together.
#[derive(Clone, Debug)]
enum Operand {
    /// A step, which must be at least so much for the weights to be what is said of them; `rarely`: and must be zero rarely.
    Step { step: usize, least: f64, rarely: bool },
    /// The norm of a power of its own, which is no step.
    Inner(Soft),
}

/// What is known of the weights.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Weights {
    /// They are at least zero and add up to at most so much.
    Share(f64),
    /// Their magnitudes add up to at most one.
    Size,
    /// Their squares add up to at most the square of this.
    Norm(f64),
}

/// Longer sums are not looked at: what shares its parts may have endlessly many.
const MOST_TERMS: usize = 1000;

/// As deep a step is looked at as a power of another one, and norms within norms: what shares its parts may have endlessly many.
const DEEPEST: u32 = 10;
const INNER: u32 = 2;
/// A rest of more steps than this is not looked at.
const MOST_STEPS: usize = 32;
/// Into how many parts the range of a live number is cut.
const PARTS: usize = 8;

/// Two exponents that differ by less are one.
const SAME: f64 = 1e-9;

impl Soft {
    /// Whether a kink of a row goes through to the step: the constant is that of the larger side.
    pub(in crate::analysis) fn is_share(&self) -> bool {
        matches!(self.weights, Weights::Share(_)) && self.slope.is_none()
    }

    /// The steps that are put together.
    pub(in crate::analysis) fn steps(&self) -> SmallVec<[usize; 4]> {
        let of = |row: &Operand| match row {
            Operand::Step { step, .. } => SmallVec::from_slice(&[*step]),
            Operand::Inner(inner) => inner.steps(),
        };
        self.rows.iter().flat_map(of).collect()
    }

    /// What a step is put together of; none where it is nothing of the kind.
    pub(in crate::analysis) fn of(tape: &Tape, step: usize) -> Option<Self> {
        match tape.steps.get(step)? {
            Step::Op(op @ (Op::Add | Op::Sub), args) => {
                let (a, b) = (*args.first()?, *args.get(1)?);
                let taken = *op == Op::Sub;
                // `rest - min(a, b)` is `min(a, b) - rest` with its sign changed.
                let turned = || of_two(tape, b, a, taken).map(|soft| Soft { turned: taken, ..soft });
                let soft = of_two(tape, a, b, taken).or_else(turned);
                soft.or_else(|| if *op == Op::Add { soft_maximum(tape, a, b).or_else(|| soft_maximum(tape, b, a)) } else { None })
            }
            Step::Op(Op::Pow | Op::Sqrt, _) => {
                let (sum, exponent) = power(tape, step, DEEPEST);
                let (soft, raised) = norm_of(tape, sum, DEEPEST)?;
                ((raised * exponent - 1.0).abs() < SAME).then_some(soft)
            }
            _ => None,
        }
    }

    /// The gradient and its norm, of those of the steps. `point_norm` bounds the norm of a map whose rows are steps.
    pub(in crate::analysis) fn bound(&self, tape: &Tape, graph: &Graph, values: &[Dual], point_norm: &dyn Fn(&[usize]) -> f64) -> Option<Row> {
        if self.slope.as_ref().is_some_and(|slope| !slope.is_right(tape, values)) {
            return None;
        }
        let mut rows = Rows::new();
        let mut plain: Option<SmallVec<[usize; 4]>> = Some(SmallVec::new());
        for row in &self.rows {
            match row {
                Operand::Step { step, least, rarely } => {
                    let dual = values.get(*step)?;
                    if dual.value.lo < *least || *rarely && !graph.is_spread {
                        return None;
                    }
                    rows.push((dual.gradient, dual.norm));
                    plain.iter_mut().for_each(|plain| plain.push(*step));
                }
                Operand::Inner(inner) => {
                    rows.push(inner.bound(tape, graph, values, point_norm)?);
                    plain = None;
                }
            }
        }
        let norm = match self.weights {
            Weights::Share(sum) => sum * rows.iter().map(|(_, norm)| *norm).fold(0.0, f64::max),
            Weights::Size => rows.iter().map(|(_, norm)| *norm).fold(0.0, f64::max),
            Weights::Norm(most) => most * plain.map_or(f64::INFINITY, |plain| point_norm(&plain)).min(matrix_norm(&rows)),
        };
        // Each component by itself: what no row has, the whole has not.
        let side = Interval::new(-norm, norm);
        let mut gradient = [Interval::ZERO; 3];
        for (i, slot) in gradient.iter_mut().enumerate() {
            let of = |row: &Row| row.0.get(i).copied().unwrap_or(Interval::ALL);
            let hull = rows.iter().map(of).fold(Interval::ZERO, Interval::hull);
            *slot = match self.weights {
                Weights::Share(sum) if self.turned => hull.mul(Interval::point(-sum)),
                Weights::Share(sum) => hull.mul(Interval::point(sum)),
                Weights::Size | Weights::Norm(_) if hull == Interval::ZERO => hull,
                Weights::Size | Weights::Norm(_) => side,
            };
        }
        Some((gradient, norm))
    }
}

/// The less or the larger one of two, or the sum, and a rest that reads nothing that moves but how far those are apart.
fn of_two(tape: &Tape, sharp: usize, rest: usize, taken: bool) -> Option<Soft> {
    let (op @ (Op::Min | Op::Max | Op::Add), &[u, v]) = tape.operation(sharp)? else { return None };
    let (mut open, mut steps, mut apart, mut settled) = (vec![rest], BTreeSet::new(), None, true);
    while let Some(step) = open.pop() {
        let between = match tape.steps.get(step)? {
            Step::Op(Op::Abs, args) if op != Op::Add => args.first().copied(),
            _ if op == Op::Add => Some(step),
            _ => None,
        };
        if between.is_some_and(|between| is_difference(tape, between, u, v)) {
            if apart.is_some_and(|known| known != step) {
                return None;
            }
            apart = Some(step);
            continue;
        }
        match tape.steps.get(step)? {
            _ if !steps.insert(step) => {}
            Step::Op(_, args) if steps.len() < MOST_STEPS => open.extend(args.iter().copied()),
            Step::Leaf(Leaf::Parameter(_) | Leaf::Time) => settled = false,
            Step::Constant(_) => {}
            _ => return None,
        }
    }
    let slope = Slope { apart: apart?, steps: steps.into_iter().collect(), taken, of: op };
    // Of constants it is known once and for all.
    if settled && !slope.is_right(tape, &[]) {
        return None;
    }
    let slope = (!settled).then_some(slope);
    let row = |step: usize| Operand::Step { step, least: f64::NEG_INFINITY, rarely: false };
    let weights = Weights::Share(if op == Op::Add { 2.0 } else { 1.0 });
    Some(Soft { rows: vec![row(u), row(v)], weights, turned: false, slope })
}

/// Whether a step is the difference of two, in whichever order and however that was simplified.
fn is_difference(tape: &Tape, step: usize, u: usize, v: usize) -> bool {
    match tape.operation(step) {
        Some((Op::Sub, &[x, y])) if (x, y) == (u, v) || (x, y) == (v, u) => true,
        Some((Op::Add | Op::Sub, _)) => [1.0, -1.0].into_iter().any(|sign| tape.cancels(&[(step, 1.0), (u, -sign), (v, sign)])),
        _ => false,
    }
}

impl Slope {
    /// Whether the two that are put together have weights that are at least zero and add up to one, whatever the live numbers are.
    fn is_right(&self, tape: &Tape, values: &[Dual]) -> bool {
        let range = |step: usize| values.get(step).map_or(Interval::ALL, |dual| dual.value);
        let live: Vec<usize> = self.steps.iter().copied().filter(|&s| matches!(tape.steps.get(s), Some(Step::Leaf(_))) && !range(s).is_point()).collect();
        match live.as_slice() {
            [] => self.is_right_for(tape, values, None),
            // A number that is read twice is not the same twice in intervals: parts of its range say more.
            &[one] if range(one).is_finite() => parts(range(one)).all(|part| self.is_right_for(tape, values, Some((one, part)))),
            _ => false,
        }
    }

    fn is_right_for(&self, tape: &Tape, values: &[Dual], live: Option<(usize, Interval)>) -> bool {
        let algebra = &mut Duals { pinned: Rc::new([]) };
        let apart = if self.of == Op::Add { Interval::ALL } else { Interval::new(0.0, f64::INFINITY) };
        let mut known: Vec<Dual> = Vec::with_capacity(self.steps.len());
        for &step in &self.steps {
            let of = |arg: usize| match self.steps.binary_search(&arg) {
                _ if arg == self.apart => Some(Dual::coordinate(0, apart)),
                Ok(i) => known.get(i).copied(),
                Err(_) => None,
            };
            let dual = match tape.steps.get(step) {
                Some(Step::Constant(c)) => Dual::constant(Interval::point(*c)),
                Some(Step::Op(op, args)) => {
                    let Some(args) = args.iter().map(|&a| of(a)).collect::<Option<SmallVec<[Dual; 4]>>>() else { return false };
                    let dual = algebra.op(*op, &args);
                    match op {
                        Op::Length2 | Op::Length3 | Op::Length4 => dual.limited(args.iter().map(|arg| arg.norm * arg.norm).sum::<f64>().sqrt()),
                        _ => dual,
                    }
                }
                _ => Dual::constant(match live {
                    Some((one, part)) if one == step => part,
                    _ => values.get(step).map_or(Interval::ALL, |dual| dual.value),
                }),
            };
            known.push(dual);
        }
        let Some(rest) = known.last() else { return false };
        let slope = if self.taken { rest.gradient[0].neg() } else { rest.gradient[0] };
        let right = match self.of {
            Op::Min => Interval::new(0.0, 1.0),
            Op::Max => Interval::new(-1.0, 0.0),
            _ => Interval::new(-1.0, 1.0),
        };
        // Only rounding outward leads beyond.
        rest.jumps == 0 && slope.lo >= right.lo - 1e-12 && slope.hi <= right.hi + 1e-12
    }
}

/// Parts of a range, each a multiple of the one before where that can be.
fn parts(range: Interval) -> impl Iterator<Item = Interval> {
    let end = move |i: usize| {
        let share = i as f64 / PARTS as f64;
        match i {
            0 => range.lo,
            PARTS => range.hi,
            _ if range.lo > 0.0 => range.lo * (range.hi / range.lo).powf(share),
            _ => range.lo + range.width() * share,
        }
    };
    (0..PARTS).map(move |i| Interval::new(end(i), end(i + 1).max(end(i))))
}

/// log Σ exp(aᵢ) of more than two, as m and the logarithm of the sum of all that is less by m.
fn soft_maximum(tape: &Tape, most: usize, rest: usize) -> Option<Soft> {
    let of = |step: usize, op: Op| tape.operation(step).filter(|(found, _)| *found == op).map(|(_, args)| args);
    let one = |step: usize| tape.constant(step) == Some(1.0);
    // m + log(max(Σ exp(aᵢ - m), 1)): the sum is never less than one.
    let &[first, second] = of(*of(rest, Op::Log)?.first()?, Op::Max)? else { return None };
    let sum = if one(second) { first } else if one(first) { second } else { return None };
    // Who writes this need not take the largest for m: then the whole is the larger one of m and the logarithm.
    let (mut open, mut rows) = (vec![sum], vec![Operand::Step { step: most, least: f64::NEG_INFINITY, rarely: false }]);
    while let Some(step) = open.pop() {
        match (of(step, Op::Add), of(step, Op::Exp)) {
            (Some(args), _) => open.extend(args),
            (_, Some(&[less])) => {
                let step = *of(less, Op::Sub).filter(|args| args.get(1) == Some(&most))?.first()?;
                rows.push(Operand::Step { step, least: f64::NEG_INFINITY, rarely: false });
            }
            _ => return None,
        }
        if rows.len() + open.len() > MOST_TERMS {
            return None;
        }
    }
    Some(Soft { rows, weights: Weights::Share(1.0), turned: false, slope: None })
}

/// The norm that a sum is a power of, and to what it is raised.
fn norm_of(tape: &Tape, sum: usize, depth: u32) -> Option<(Soft, f64)> {
    let depth = depth.checked_sub(1)?;
    let (terms, harmonic) = terms(tape, sum)?;
    let mut common: Option<f64> = None;
    let mut rows = Vec::new();
    for term in terms {
        let (base, exponent) = power(tape, term, DEEPEST);
        let inner = matches!(tape.steps.get(base), Some(Step::Op(Op::Add, _))).then(|| norm_of(tape, base, depth.min(INNER))).flatten();
        let (row, k) = match inner {
            Some((soft, raised)) => (Operand::Inner(soft), raised * exponent),
            None => {
                let (step, least) = match tape.steps.get(base) {
                    // The power of a size is as steep as that of what it is the size of.
                    Some(Step::Op(Op::Abs, args)) => (*args.first()?, f64::NEG_INFINITY),
                    _ => (base, if exponent % 2.0 == 0.0 { f64::NEG_INFINITY } else { 0.0 }),
                };
                // One over zero counts as zero; where zero is met by chance alone, that is nothing.
                let rarely = exponent < 0.0 && tape.vanishes_rarely(base);
                let least = if exponent < 0.0 && !rarely { f64::MIN_POSITIVE } else { least };
                (Operand::Step { step, least, rarely }, exponent)
            }
        };
        let k = if harmonic { -k } else { k };
        if common.is_some_and(|known| (known - k).abs() > SAME * known.abs()) {
            return None;
        }
        common = Some(k);
        rows.push(row);
    }
    let k = common?;
    let n = rows.len() as f64;
    let plain = rows.iter().all(|row| matches!(row, Operand::Step { .. }));
    let weights = match k {
        _ if k < 0.0 && plain => Weights::Size,
        _ if k >= 2.0 - SAME => Weights::Norm(1.0),
        _ if k > 1.0 => Weights::Norm(n.powf(1.0 / k - 0.5) * (1.0 + SAME)),
        _ => return None,
    };
    Some((Soft { rows, weights, turned: false, slope: None }, if harmonic { -k } else { k }))
}

/// What a sum is made of, without constants; and whether it is 1/(1/x + 1/y), written as xy/(x + y).
fn terms(tape: &Tape, sum: usize) -> Option<(Vec<usize>, bool)> {
    if let Step::Op(Op::Div, parts) = tape.steps.get(sum)?
        && let (Step::Op(Op::Mul, product), Step::Op(Op::Add, of)) = (tape.steps.get(*parts.first()?)?, tape.steps.get(*parts.get(1)?)?)
        && (product == of || product.iter().rev().eq(of.iter()))
    {
        return Some((product.to_vec(), true));
    }
    let (mut open, mut terms) = (vec![sum], Vec::new());
    while let Some(step) = open.pop() {
        match tape.steps.get(step)? {
            Step::Op(Op::Add, args) => open.extend(args.iter().copied()),
            Step::Constant(c) if *c >= 0.0 => {}
            _ => terms.push(step),
        }
        if terms.len() + open.len() > MOST_TERMS {
            return None;
        }
    }
    Some((terms, false))
}

/// A step as a power of another one: that, and the exponent.
fn power(tape: &Tape, step: usize, depth: u32) -> (usize, f64) {
    let Some(depth) = depth.checked_sub(1) else { return (step, 1.0) };
    let Some(Step::Op(op, args)) = tape.steps.get(step) else { return (step, 1.0) };
    let constant = |i: usize| args.get(i).and_then(|&a| tape.constant(a));
    let of = |i: usize| args.get(i).map(|&a| power(tape, a, depth));
    let found = match op {
        Op::Square => of(0).map(|(base, e)| (base, 2.0 * e)),
        Op::Sqrt => of(0).map(|(base, e)| (base, 0.5 * e)),
        Op::Pow => of(0).zip(constant(1)).map(|((base, e), by)| (base, e * by)),
        Op::Div if constant(0) == Some(1.0) => of(1).map(|(base, e)| (base, -e)),
        Op::Mul => of(0).zip(of(1)).filter(|((a, _), (b, _))| a == b).map(|((base, e), (_, more))| (base, e + more)),
        _ => None,
    };
    found.unwrap_or((step, 1.0))
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]
mod tests {
    use crate::diagnostic::Code;
    use crate::{MemoryLoader, Options, compile};

    /// The factor of a formula, and whether it is proven.
    fn factor(text: &str) -> (f64, bool) {
        let text = if text.contains("scene") { text.to_owned() } else { format!("field f = {text}\nscene = f.within(box(4))") };
        let outcome = compile(&MemoryLoader::new().with("main.sdf", text.clone()), "main.sdf", &Options::default());
        let proven = !outcome.diagnostics.iter().any(|d| d.code == Code::Unproven);
        (outcome.compiled.unwrap_or_else(|| panic!("{text}: {:?}", outcome.diagnostics)).summary.factor, proven)
    }

    #[test]
    fn where_a_slider_stands_they_are_as_steep_as_if_its_value_were_written() {
        let exponential = "blend e(a, b, k: float) = -log(exp(-k * a) + exp(-k * b)) / k\nparam k = 8 in 1..40\n\
            scene = e(e(sphere(0.6).translate(-0.6, 0, 0), sphere(0.5), k), torus(0.8, 0.15), k)";
        let cubic = "blend c(a, b, k: float) = { let h = max(k - abs(a - b), 0) / k; min(a, b) - h * h * h * k / 6 }\n\
            param k = 0.5 in 0.05..1\nscene = c(box((2, 0.6, 1)), cylinder(0.3, 2), k)";
        let norm = "param n = 4 in 2..12\nfield f = pow(pow(abs(p.x), n) + pow(abs(p.y), n) + pow(abs(p.z), n), 1 / n) - 1\nscene = f.within(box(4))";
        for text in [exponential, cubic, norm] {
            let outcome = compile(&MemoryLoader::new().with("main.sdf", text.to_owned()), "main.sdf", &Options::default());
            let scene = outcome.compiled.unwrap_or_else(|| panic!("{text}: {:?}", outcome.diagnostics));
            let mut live = scene.live();
            for share in [0.0, 0.3, 1.0] {
                let range = &scene.graph.parameters[0];
                live.components[0] = range.min + share * (range.max - range.min);
                scene.follow(&mut live, crate::Compiled::QUICK);
                for index in 0..scene.graph.factors.len() as u32 {
                    let factor = live.factor(&scene.graph, index);
                    assert!(factor < 1.001, "{factor} at {}: {text}", live.components[0]);
                }
            }
        }
    }

    #[test]
    fn soft_minima_are_as_steep_as_what_they_are_of() {
        for formula in [
            "{ let a = length(p) - 1; let b = p.y; let h = max(0.2 - abs(a - b), 0) / 0.2; min(a, b) - h * h * 0.2 / 4 }",
            "{ let a = length(p) - 1; let b = p.y; let h = max(0.2 - abs(a - b), 0) / 0.2; max(a, b) + h * h * h * 0.2 / 6 }",
            "{ let a = length(p) - 1; let b = p.y; 0.5 * (a + b - sqrt((a - b) * (a - b) + 0.04)) }",
            "{ let a = length(p) - 1; let b = p.y; let m = 0.5 * (a + b - sqrt((a - b) * (a - b) + 0.04)); let c = p.x; \
             0.5 * (m + c - sqrt((m - c) * (m - c) + 0.04)) }",
            "-log(exp(-8 * p.x) + exp(-8 * p.y) + exp(-8 * (length(p) - 1))) / 8",
            "-log(max(exp(-8 * p.x) + exp(-8 * p.y) + exp(-8 * (length(p) - 1)), 0.000001)) / 8",
            "pow(pow(abs(p.x), 2.5) + pow(abs(p.y), 2.5) + pow(abs(p.z), 2.5), 1 / 2.5) - 1",
            "pow(pow(length(p - x), -4) + pow(length(p + x), -4), -1 / 4) - 0.4",
        ] {
            let (found, proven) = factor(formula);
            assert!(proven && found < 8.01, "{formula}: {found}");
            assert!(formula.contains("log") || found < 1.0 + 1e-6, "{formula}: {found}");
        }
    }

    #[test]
    fn what_only_looks_like_one_is_not_taken_for_one() {
        for (formula, steep) in [
            // The number that is taken away is not the largest.
            ("{ let m = 5 * p.x; m + log(max(exp(p.y - m) + exp(p.z - m), 1)) }", 5.0),
            // Too much is taken away.
            ("{ let h = max(0.2 - abs(p.x - p.y), 0) / 0.2; min(p.x, p.y) - 3 * h * h * 0.2 }", 5.0),
            // By a size, whose sign does not count.
            ("sqrt(p.x * p.x * (p.y * p.y) / (p.x * p.x + p.y * p.y)) - p.x + 0.2 * p.z", 2.0),
            // A logarithm of less than nothing stays as it is.
            ("log(p.x - 2.5) + 0.4 * p.x + 0.1 * p.y + 86", 0.41),
        ] {
            let (found, _) = factor(formula);
            assert!(found >= steep * (1.0 - 1e-9), "{formula}: {found}");
        }
        // One over zero is zero all over a box.
        for region in [
            "{ let d = length(max(abs(p) - 0.5, 0)); 1 - 0.2 / d }",
            "{ let d = dot(max(p, 0), max(p, 0)); 2 - min(1 / d, 4) }",
            "field g = 1 - 0.2 / length(p)\nscene = g.elongate((0.5, 0.5, 0.5)).within(box(4))",
        ] {
            assert!(!factor(region).1, "{region}");
        }
        // A sum that shares its parts has more terms than there is time for.
        let shared = "{ let s = exp(p.x - p.y) for i in 0..60 { s = s + (s + exp(p.z - p.y)) }; p.y + log(max(s, 1)) - 1 }";
        assert!(factor(shared).0.is_finite());
        // At a point alone it is not met.
        assert!(factor("1 - 0.2 / length(p - 0.3)").1);
    }
}
