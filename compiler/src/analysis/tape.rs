//! The steps that compute nodes, in order, ready to be run over any algebra again and again.

use crate::graph::algebra::Algebra;
use crate::graph::kernel::{self, Op};
use crate::graph::{Claim, Graph, Leaf, Node, NodeId, ShapeId};
use smallvec::SmallVec;
use crate::rules::RuleSet;

/// Earlier steps that a step needs: a few.
pub type Steps = SmallVec<[usize; 4]>;

/// As deep a step is looked into for where it is zero: what shares its parts may have endlessly many.
const DEEPEST: u32 = 8;

/// One step.
#[derive(Clone, Debug)]
pub enum Step {
    /// A constant.
    Constant(f64),
    /// A value from outside.
    Leaf(Leaf),
    /// An operation on earlier steps.
    Op(Op, Steps),
    /// A field of a shape at earlier steps.
    Call(ShapeId, Steps),
    /// A value and what it is known by: earlier steps.
    Claim(Claim, Steps),
}

/// Steps in order; each needs only those before it.
#[derive(Clone, Debug)]
pub struct Tape {
    /// The steps.
    pub steps: Vec<Step>,
    /// The node that each step computes.
    pub nodes: Vec<NodeId>,
    roots: Steps,
    /// The rules that may look at it.
    pub(super) rules: RuleSet,
    /// Whether the first coordinate is a distance, or its square, in the place of the point.
    by_distance: bool,
}

impl Tape {
    /// The steps of some nodes; with one root it is the last step. `rules` may look at them.
    pub fn new(graph: &Graph, roots: &[NodeId], rules: RuleSet) -> Self {
        let nodes = graph.reachable(roots);
        let at = |id: &NodeId| nodes.binary_search(id).unwrap_or(0);
        let steps = nodes
            .iter()
            .map(|&id| match graph.node(id) {
                Node::Constant(bits) => Step::Constant(f64::from_bits(*bits)),
                Node::Leaf(leaf) => Step::Leaf(*leaf),
                Node::Op(op, args) => Step::Op(*op, args.iter().map(at).collect()),
                Node::Call(shape, _, args) => Step::Call(*shape, args.iter().map(at).collect()),
                Node::Claim(args, claim) => Step::Claim(claim.clone(), args.iter().map(at).collect()),
                Node::Factor(i) => {
                    Step::Constant(graph.factors.get(*i as usize).map_or(1.0, |f| 1.0 / f.lipschitz))
                }
            })
            .collect();
        let roots = roots.iter().map(at).collect();
        Self { steps, nodes, roots, rules, by_distance: false }
    }

    /// The same tape at these values of the parameters, as if they were written in it: more is known of a power whose exponent is a number.
    pub(super) fn with_pinned(mut self, pinned: &[f64]) -> Self {
        for i in 0..if pinned.is_empty() { 0 } else { self.steps.len() } {
            let value = match self.steps.get(i) {
                Some(Step::Leaf(Leaf::Parameter(component))) => pinned.get(*component as usize).copied(),
                Some(Step::Op(op, args)) => {
                    let constants: Option<SmallVec<[f64; 4]>> = args.iter().map(|&a| self.constant(a)).collect();
                    constants.map(|constants| kernel::value(*op, &constants))
                }
                _ => None,
            };
            if let (Some(value), Some(step)) = (value.filter(|value| value.is_finite()), self.steps.get_mut(i)) {
                *step = Step::Constant(value);
            }
        }
        self
    }

    /// Steps in order, of which the last is the root, with their nodes.
    pub(super) fn of_steps(steps: Vec<Step>, nodes: Vec<NodeId>, rules: RuleSet) -> Self {
        let roots = steps.len().checked_sub(1).into_iter().collect();
        Self { steps, nodes, roots, rules, by_distance: false }
    }

    /// The same tape, whose first coordinate is a distance that is zero rarely, or the square of one.
    pub(super) fn of_distance(self) -> Self {
        Self { by_distance: true, ..self }
    }

    /// The value of a step that is a constant.
    pub(super) fn constant(&self, step: usize) -> Option<f64> {
        match self.steps.get(step)? {
            Step::Constant(c) => Some(*c),
            _ => None,
        }
    }

    /// The operation that a step does, and its operands.
    pub(super) fn operation(&self, step: usize) -> Option<(Op, &[usize])> {
        match self.steps.get(step)? {
            Step::Op(op, args) => Some((*op, args)),
            _ => None,
        }
    }

    /// Whether a step is never less than zero, and zero nowhere but at points and on curves, which are met by chance alone.
    pub(super) fn vanishes_rarely(&self, step: usize) -> bool {
        self.is_square(step, DEEPEST) && self.vanishing(step, DEEPEST).count_ones() > 1
    }

    /// Whether a step is never less than zero, and zero in planes at most.
    pub(super) fn touches_zero(&self, step: usize) -> bool {
        self.is_square(step, DEEPEST) && self.vanishing(step, DEEPEST) != 0
    }

    /// Whether a step is zero in planes at most, be it less than zero elsewhere or not.
    pub(super) fn is_zero_in_planes(&self, step: usize) -> bool {
        self.vanishing(step, DEEPEST) != 0
    }

    /// Coordinates (a bit each) that all have one value wherever a step is zero: where more than one has, that is no surface.
    fn vanishing(&self, step: usize, depth: u32) -> u8 {
        let Some(depth) = depth.checked_sub(1) else { return 0 };
        let constant = |step: usize| self.constant(step).is_some_and(|c| c != 0.0);
        let of = |args: &[usize], i: usize| args.get(i).map_or(0, |&a| self.vanishing(a, depth));
        match self.steps.get(step) {
            Some(Step::Leaf(Leaf::P(0))) if self.by_distance => 0b111,
            Some(Step::Leaf(Leaf::P(i))) => 1 << i,
            Some(Step::Op(Op::Length2 | Op::Length3 | Op::Length4, args)) => args.iter().fold(0, |all, &a| all | self.vanishing(a, depth)),
            Some(Step::Op(Op::Square | Op::Abs | Op::Neg, args)) => of(args, 0),
            // Below zero a root counts as zero.
            Some(Step::Op(Op::Sqrt, args)) if args.first().is_some_and(|&a| self.is_square(a, depth)) => of(args, 0),
            Some(Step::Op(Op::Mul, args)) => match *args.as_slice() {
                [a, b] if constant(a) || constant(b) => self.vanishing(if constant(a) { b } else { a }, depth),
                // Zero where either is.
                [a, b] => self.vanishing(a, depth) & self.vanishing(b, depth),
                _ => 0,
            },
            Some(Step::Op(Op::Div, args)) if args.get(1).is_some_and(|&a| constant(a)) => of(args, 0),
            Some(Step::Op(op @ (Op::Add | Op::Sub), args)) => match *args.as_slice() {
                [a, b] if constant(a) || constant(b) => self.vanishing_moved(if constant(a) { b } else { a }),
                // What is never less than zero adds up to zero only where all of it is zero.
                [a, b] if *op == Op::Add && self.is_square(a, depth) && self.is_square(b, depth) => self.vanishing(a, depth) | self.vanishing(b, depth),
                _ => 0,
            },
            _ => 0,
        }
    }

    /// The same of a step that something constant is added to: that of a coordinate.
    fn vanishing_moved(&self, step: usize) -> u8 {
        match self.steps.get(step) {
            Some(Step::Leaf(Leaf::P(i))) if !self.by_distance => 1 << i,
            _ => 0,
        }
    }

    /// Whether a step is never less than zero by the way it is written.
    fn is_square(&self, step: usize, depth: u32) -> bool {
        let Some(depth) = depth.checked_sub(1) else { return false };
        match self.steps.get(step) {
            Some(Step::Constant(c)) => *c >= 0.0,
            Some(Step::Leaf(Leaf::P(0))) => self.by_distance,
            Some(Step::Op(Op::Square | Op::Abs | Op::Sqrt | Op::Length2 | Op::Length3 | Op::Length4 | Op::Exp, _)) => true,
            Some(Step::Op(Op::Add | Op::Mul, args)) => args.iter().all(|&a| self.is_square(a, depth)),
            _ => false,
        }
    }

    /// Of a root of a length of squares, which is the root of a sum of fourth powers, or eighth powers and so on: what is raised.
    pub fn raised(&self, step: usize) -> Option<Steps> {
        match self.steps.get(step)? {
            Step::Op(Op::Length2 | Op::Length3 | Op::Length4, args) => Some(args.clone()),
            Step::Op(Op::Sqrt, args) => {
                let squared = |a: usize| match self.steps.get(a) {
                    Some(Step::Op(Op::Square, of)) => of.first().copied(),
                    _ => None,
                };
                self.raised(*args.first()?)?.into_iter().map(squared).collect()
            }
            _ => None,
        }
    }

    /// Whether any step reads a coordinate.
    pub fn reads(&self, coordinate: usize) -> bool {
        self.steps.iter().any(|s| matches!(s, Step::Leaf(Leaf::P(i)) if usize::from(*i) == coordinate))
    }

    /// The step of each root.
    pub fn roots(&self) -> impl Iterator<Item = usize> + use<'_> {
        self.roots.iter().copied()
    }

    /// Runs the steps; the answer has a value for each.
    pub fn run<A: Algebra>(
        &self,
        graph: &Graph,
        algebra: &mut A,
        leaf: impl FnMut(&mut A, Leaf) -> A::Value,
        call: impl FnMut(&mut A, ShapeId, &[A::Value]) -> A::Value,
    ) -> Vec<A::Value> {
        self.run_closely(graph, algebra, leaf, call, |_, value, _| value)
    }

    /// The same, with a closer look at each value, of which those before it are told.
    pub(super) fn run_closely<A: Algebra>(
        &self,
        graph: &Graph,
        algebra: &mut A,
        mut leaf: impl FnMut(&mut A, Leaf) -> A::Value,
        mut call: impl FnMut(&mut A, ShapeId, &[A::Value]) -> A::Value,
        mut closer: impl FnMut(usize, A::Value, &[A::Value]) -> A::Value,
    ) -> Vec<A::Value> {
        let mut values: Vec<A::Value> = Vec::with_capacity(self.steps.len());
        let mut buffer: Vec<A::Value> = Vec::new();
        for (i, step) in self.steps.iter().enumerate() {
            let mut gather = |args: &[usize], values: &[A::Value]| {
                buffer.clear();
                buffer.extend(args.iter().filter_map(|&a| values.get(a).cloned()));
            };
            let value = match step {
                Step::Constant(c) => algebra.constant(*c),
                Step::Leaf(l) => leaf(algebra, *l),
                Step::Op(op, args) => {
                    gather(args, &values);
                    algebra.op(*op, &buffer)
                }
                Step::Call(shape, args) => {
                    gather(args, &values);
                    call(algebra, *shape, &buffer)
                }
                Step::Claim(claim, args) => {
                    gather(args, &values);
                    match buffer.split_first() {
                        Some((value, of)) => algebra.claim(graph, value.clone(), claim, of),
                        None => algebra.constant(0.0),
                    }
                }
            };
            let value = closer(i, value, &values);
            values.push(value);
        }
        values
    }
}
