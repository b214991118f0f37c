//! Where no constant is to be had: which term is to blame, and how steep the formula is at samples.

use super::search::spread;
use super::tape::Step;
use super::{Domain, Facts};
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::{Graph, Leaf, NodeId};

/// A term whose slope has no limit though the slopes of its arguments have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steep {
    /// The term.
    pub node: NodeId,
    /// Its operation; none for what is read from outside.
    pub op: Option<Op>,
    /// Whether it has no limit because it grows, and not where something reaches zero.
    pub grows: bool,
    /// Whether it grows by what time alone makes.
    pub by_time: bool,
    /// Whether what it is so steep at is kept away, though not far enough.
    pub kept_away: bool,
}

/// What time alone makes is without an end where it is larger than this.
const LONG: f64 = 1e5;

/// What to write for what grows.
const GROWS: &str = "keep the shape within a region with `.within(box(…))`, or clamp what grows";

impl Steep {
    /// A term that is read from outside.
    fn outside(node: NodeId) -> Self {
        Self { node, op: None, grows: false, by_time: false, kept_away: false }
    }

    /// Why it has no limit.
    pub fn why(&self) -> &'static str {
        match self.op {
            _ if self.by_time => "it grows without end as time goes on",
            _ if self.grows => "it grows without end",
            Some(Op::Div) if self.kept_away => "it is very steep where the divisor is least",
            Some(Op::Pow | Op::Sqrt | Op::Log) if self.kept_away => "it is very steep where its argument is least",
            Some(Op::Div) => "the divisor can reach zero",
            Some(Op::Pow) => "the power is infinitely steep where its base reaches zero, or grows without end",
            Some(Op::Sqrt) => "the root is infinitely steep where its argument reaches zero",
            Some(Op::Log) => "the logarithm is infinitely steep where its argument reaches zero",
            Some(Op::Asin | Op::Acos) => "it is infinitely steep where its argument reaches one",
            Some(Op::Atan2) => "the angle turns infinitely fast where both of its arguments reach zero",
            Some(Op::TurnU | Op::TurnV) => "the turn moves points the faster, the farther they are from its axis",
            Some(_) => "it grows without a limit that is known",
            None => "nothing is known of how it changes here",
        }
    }

    /// What to write instead, where the shape is `within` a region already or not.
    pub fn instead(&self, within: bool) -> &'static str {
        match self.op {
            _ if self.by_time => "let time come back, or end: `sin(time)`, `fract(time)` or `clamp(time, 0, 60)` in place of `time`",
            Some(Op::Exp) if within => "keep what it is the power of small, for example `exp(min(a, 4))`",
            _ if self.grows && within => "keep its value small, for example `clamp(f, -1, 1)`: the surface stays where it is",
            _ if self.grows => GROWS,
            Some(Op::Div) if self.kept_away => "keep the divisor farther from zero, or cut off where it is small with `.within(region)`",
            Some(Op::Pow | Op::Sqrt | Op::Log) if self.kept_away => "keep the argument farther from zero, or cut off where it is small with `.within(region)`",
            Some(Op::Div) => "keep the divisor away from zero as far as the shape allows, `max(d, 0.1)` rather than `max(d, 0.001)`, or cut its zero off with `.within(region)`",
            Some(Op::Pow | Op::Sqrt | Op::Log) => {
                "keep the argument away from zero, for example `max(a, 0.01)`, or cut its zero off with `.within(region)`"
            }
            Some(Op::Asin | Op::Acos) => "keep the argument within -0.99..0.99 with `clamp`",
            Some(Op::Atan2) => "keep the shape within a box that the axis does not meet, with `.within(box(…).translate(…))`; for copies about an axis write `polar`",
            _ => GROWS,
        }
    }
}

impl Facts {
    /// The first term under a node whose slope over a domain is more than `limit` while those of its arguments are less.
    pub fn steep_term(&mut self, graph: &Graph, node: NodeId, domain: &Domain, limit: f64) -> Option<Steep> {
        let tape = self.tape(graph, node);
        let duals = self.all_duals(graph, &tape, domain);
        let steep = |i: usize| duals.get(i).is_some_and(|d| d.norm > limit);
        for (i, step) in tape.steps.iter().enumerate() {
            if !steep(i) {
                continue;
            }
            let at = tape.nodes.get(i).copied().unwrap_or(node);
            return match step {
                Step::Op(op, args) => {
                    let power = args.get(1).and_then(|&a| duals.get(a)).is_some_and(|d| d.value.lo >= 1.0);
                    let grows = matches!(op, Op::Mul | Op::Square | Op::Exp) || *op == Op::Pow && power;
                    let is_time = |&a: &usize| {
                        let endless = duals.get(a).is_some_and(|d| d.value.magnitude() > LONG);
                        let moment = |&node: &NodeId| !graph.reads_point(node) && graph.leaves_under(&[node]).contains(&Leaf::Time);
                        endless && tape.nodes.get(a).is_some_and(moment)
                    };
                    let pole = if *op == Op::Div { args.get(1) } else { args.first() };
                    let kept_away = pole.and_then(|&a| duals.get(a)).is_some_and(|d| !d.value.contains(0.0));
                    Some(Steep { node: at, op: Some(*op), grows, by_time: grows && args.iter().any(is_time), kept_away })
                }
                Step::Call(shape, args) => {
                    let args: Vec<Interval> =
                        args.iter().map(|&a| duals.get(a).map_or(Interval::ALL, |d| d.value)).collect();
                    let s = graph.shape(*shape)?;
                    let own = super::call_domain(&s.variables, &args);
                    let value = s.value;
                    self.steep_term(graph, value, &own, limit).or(Some(Steep::outside(at)))
                }
                _ => Some(Steep::outside(at)),
            };
        }
        None
    }

    /// The slope that 99 of 100 points of a domain do not exceed (around a pole there is no steepest); infinite where at most points nothing
    /// is known of it.
    pub fn sampled_constant(&mut self, graph: &Graph, node: NodeId, domain: &Domain, samples: usize) -> f64 {
        self.sampled_slope(graph, node, domain, samples, 0.99)
    }

    /// The slope that such a share of the points of a domain do not exceed; infinite where at most points nothing is known of it.
    pub fn sampled_slope(&mut self, graph: &Graph, node: NodeId, domain: &Domain, samples: usize, share: f64) -> f64 {
        let tape = self.tape(graph, node);
        let pinned = self.pinned.clone();
        let samples = samples.min(MOST_STEPS / self.weight(graph, node).max(1)).max(64);
        let mut slopes: Vec<f64> = Vec::new();
        let end = self.account.ran + 4 * MOST_STEPS as u64;
        let least_left = self.account.left_by_one();
        let mut tried = 0;
        for i in 0..samples {
            if (self.account.ran > end || self.account.left <= least_left) && tried >= 64 {
                self.account.cut_short |= self.account.left <= least_left;
                break;
            }
            tried += 1;
            let (here, values) = spread(graph, domain, &pinned, i);
            let time = Interval::point(0.37 * i as f64 % 20.0);
            let leaf = |leaf| match leaf {
                crate::graph::Leaf::Time => super::dual::Dual::constant(time),
                other => super::leaf_dual(graph, &values, other, &here),
            };
            let duals = self.without_a_close_look(|facts| super::derivative::run(facts, graph, &tape, None, &mut None, &leaf));
            let norm = duals.and_then(|d| d.last().map(|d| d.norm)).unwrap_or(f64::INFINITY);
            // A pole itself is met by chance alone; what counts is how steep it is around.
            if norm.is_finite() {
                slopes.push(norm);
            }
        }
        slopes.sort_by(f64::total_cmp);
        let rank = (slopes.len() as f64 * share) as usize;
        if slopes.len() * 2 < tried { f64::INFINITY } else { slopes.get(rank).copied().unwrap_or(0.0) }
    }
}

/// How many steps all of the samples may cost.
const MOST_STEPS: usize = 1_000_000;

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]
mod tests {
    use crate::diagnostic::Code;
    use crate::{MemoryLoader, Options, compile};

    /// What is advised where a formula has no bound that is proven.
    fn advice(formula: &str) -> String {
        let text = format!("field f = {formula}\nscene = f.within(box(4))");
        let outcome = compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default());
        let found = outcome.diagnostics.into_iter().find(|d| matches!(d.code, Code::NoBound | Code::Unproven));
        found.map(|d| d.help).unwrap_or_default()
    }

    #[test]
    fn advice_helps() {
        // What grows away from its surface is cut off without being told.
        assert_eq!(advice("exp(20 * (length(p) - 1)) - 1"), "");
        assert_eq!(advice("pow(abs(p.x), 40) + pow(abs(p.y), 40) - 1"), "");
        // What is said to be done is not done yet.
        let folded = "{ let q = p, s = 1 for i in 0..2 { let k = 1.2 / max(dot(q, q), 0.01); q = q * k, s = s * k }; (length(q) - 0.5) / s }";
        assert!(advice(folded).contains("farther from zero"));
        assert!(advice("sqrt(abs(p.x)) + p.y").contains("max(a, 0.01)"));
        assert_eq!(advice("sqrt(max(abs(p.x), 0.01)) + p.y"), "");
    }
}
