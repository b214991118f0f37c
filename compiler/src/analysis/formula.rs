//! A tape and what the rules read in it, found when it is first asked for and kept.

use super::dual::Dual;
use super::rules::algebraic_enclosures::Tight;
use super::rules::polar_rotation::Around;
use super::rules::soft::Soft;
use super::tape::{Step, Steps, Tape};
use crate::graph::algebra::Intervals;
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::{Claim, Graph, Leaf, NodeId, ShapeId};
use crate::rules::{Rule, RuleSet};
use rustc_hash::FxHashMap;
use std::cell::{OnceCell, RefCell};
use std::ops::Deref;
use std::rc::Rc;

/// A tape and what the rules read in it. Who only wants ranges has no use for most of that.
#[derive(Clone, Debug)]
pub struct Formula {
    tape: Tape,
    kinks: OnceCell<Kinks>,
    /// The steps that are soft maxima or norms, in order.
    softs: OnceCell<Rc<[(usize, Soft)]>>,
    /// The steps of which more is known than follows step by step, in order.
    tight: OnceCell<Rc<[(usize, Tight)]>>,
    /// What coordinates go through, by their steps.
    pub(super) chains: RefCell<Chains>,
}

impl Deref for Formula {
    type Target = Tape;

    fn deref(&self) -> &Tape {
        &self.tape
    }
}

#[derive(Clone, Debug, Default)]
struct Kinks {
    /// Steps with a kink of which each side is worth a look by itself.
    steps: Vec<bool>,
    /// Coordinates that only `abs` reads: one half of the axis stands for both.
    mirrored: [bool; 3],
}

/// What some steps are made of by folds, turns and moves alone: so many times as steep as a cut below them, at most, wherever that is and
/// whatever the parameters are. A cut is up to three steps that are all that those above need of the point.
#[derive(Clone, Debug)]
pub struct Chain {
    pub(super) cut: Steps,
    pub(super) norm: f64,
    /// The variables, which must not move with the point.
    pub(super) variables: Rc<[usize]>,
}

/// So many steps are opened and followed for all chains of a tape.
const MOST_FOLLOWED: usize = 100_000;

/// The chains of a tape, found when they are first asked for.
#[derive(Clone, Debug)]
pub(super) struct Chains {
    pub known: FxHashMap<Steps, Option<Rc<Chain>>>,
    /// What each step can be that does not move with the point; the others are unknown.
    pub values: Vec<Dual>,
    /// The steps that are variables.
    pub variables: Rc<[usize]>,
    /// How many steps may still be opened and followed.
    pub left: usize,
}

impl Default for Chains {
    fn default() -> Self {
        Self { known: FxHashMap::default(), values: Vec::new(), variables: Rc::new([]), left: MOST_FOLLOWED }
    }
}

impl Formula {
    /// The steps of some nodes; with one root it is the last step. `rules` may look at them.
    pub fn new(graph: &Graph, roots: &[NodeId], rules: RuleSet) -> Self {
        Self::of(Tape::new(graph, roots, rules))
    }

    /// A tape, of which nothing is known yet.
    pub fn of(tape: Tape) -> Self {
        Self { tape, kinks: OnceCell::new(), softs: OnceCell::new(), tight: OnceCell::new(), chains: RefCell::default() }
    }

    /// The same at these values of the parameters, as if they were written in it.
    pub(super) fn with_pinned(self, pinned: &[f64]) -> Self {
        Self::of(self.tape.with_pinned(pinned))
    }

    fn softs(&self) -> &[(usize, Soft)] {
        self.softs.get_or_init(|| (0..if self.rules.has(Rule::Soft) { self.steps.len() } else { 0 }).filter_map(|i| Some((i, Soft::of(self, i)?))).collect())
    }

    /// What a step is put together of, where that is a soft maximum or a norm.
    pub(super) fn soft(&self, step: usize) -> Option<&Soft> {
        let softs = self.softs();
        softs.binary_search_by_key(&step, |(i, _)| *i).ok().and_then(|i| softs.get(i)).map(|(_, soft)| soft)
    }

    /// What is known of a step that is a length times the cosine or the sine of an angle.
    pub(super) fn around(&self, step: usize) -> Option<&Around> {
        let tight = self.tight();
        match tight.binary_search_by_key(&step, |(step, _)| *step).ok().and_then(|i| tight.get(i))? {
            (_, Tight::Around(around)) => Some(around),
            _ => None,
        }
    }

    /// Whether [`Tape::tight`] was found already.
    pub(super) fn is_seen(&self) -> bool {
        self.tight.get().is_some()
    }

    /// What more is known of steps than follows step by step, in order.
    pub(super) fn tight(&self) -> &[(usize, Tight)] {
        self.tight.get_or_init(|| Tight::of(self).into())
    }

    /// The range of every step.
    pub(super) fn ranges(
        &self,
        graph: &Graph,
        leaf: impl FnMut(&mut Intervals, Leaf) -> Interval,
        call: impl FnMut(&mut Intervals, ShapeId, &[Interval]) -> Interval,
    ) -> Vec<Interval> {
        let mut tight = self.tight().iter().peekable();
        self.run_closely(graph, &mut Intervals, leaf, call, |i, value, before: &[Interval]| match tight.next_if(|(step, _)| *step == i) {
            Some((_, tight)) => {
                let both = value.intersect(tight.values(|step| before.get(step).copied().unwrap_or(Interval::ALL)));
                if both.is_empty() { value } else { both }
            }
            None => value,
        })
    }

    fn kinks(&self) -> &Kinks {
        self.kinks.get_or_init(|| self.find_kinks())
    }

    /// A kink whose result goes through nothing but `min`, `max` and their like to the only root needs no look at each side: the constant is
    /// the larger one. Below a claim it is the claim that counts.
    fn find_kinks(&self) -> Kinks {
        #[derive(Clone, Copy, PartialEq, PartialOrd)]
        enum State {
            Quiet,
            Through,
            Apart,
        }
        let n = self.steps.len();
        let mut states = vec![State::Quiet; n];
        let mut users = vec![0u32; n];
        let from_root = if self.roots().count() == 1 { State::Through } else { State::Apart };
        for root in self.roots() {
            if let Some(slot) = states.get_mut(root) {
                *slot = from_root;
            }
        }
        let mut kinks = vec![false; n];
        for (i, step) in self.steps.iter().enumerate().rev() {
            let state = states.get(i).copied().unwrap_or(State::Quiet);
            let (args, below): (&[usize], State) = match step {
                Step::Constant(_) | Step::Leaf(_) => continue,
                Step::Claim(Claim::Lipschitz(..), args) => (args, State::Quiet),
                Step::Claim(Claim::Continuous, args) => (args, state),
                Step::Op(Op::Min | Op::Max | Op::Neg | Op::Abs | Op::Select, args) if state == State::Through => {
                    (args, State::Through)
                }
                Step::Op(_, args) | Step::Call(_, args) => {
                    (args, if state == State::Quiet { State::Quiet } else { State::Apart })
                }
            };
            if let (Step::Op(Op::Min | Op::Max | Op::Abs | Op::Select | Op::Atan2, _), State::Apart, Some(slot)) =
                (step, state, kinks.get_mut(i))
            {
                *slot = true;
            }
            for &a in args {
                if let Some(count) = users.get_mut(a) {
                    *count += 1;
                }
            }
            // Of a soft maximum it is what it is put together of that counts, and of that as under a plain one.
            let soft = if state == State::Quiet { None } else { self.soft(i) };
            let put_together = soft.map(Soft::steps);
            let below = match soft {
                Some(soft) if soft.is_share() => state,
                _ => below,
            };
            for &a in put_together.as_deref().unwrap_or(args) {
                if let Some(slot) = states.get_mut(a)
                    && *slot < below
                {
                    *slot = below;
                }
            }
        }
        let mut mirrored = [false; 3];
        for step in self.steps.iter().filter(|_| self.rules.has(Rule::Mirror)) {
            if let Step::Op(Op::Abs, args) = step
                && let Some(&a) = args.first()
                && let Some(Step::Leaf(Leaf::P(i))) = self.steps.get(a)
                && users.get(a) == Some(&1)
                && let Some(slot) = mirrored.get_mut(usize::from(*i))
            {
                *slot = true;
            }
        }
        Kinks { steps: kinks, mirrored }
    }

    /// Whether a step has a kink of which each side is worth a look by itself.
    pub fn is_kink(&self, step: usize) -> bool {
        self.kinks().steps.get(step).copied().unwrap_or(false)
    }

    /// Whether a coordinate is read by one `abs` alone.
    pub fn is_mirrored(&self, coordinate: u8) -> bool {
        self.kinks().mirrored.get(usize::from(coordinate)).copied().unwrap_or(false)
    }

    /// The same tape, of which it is not known that coordinates are read by one `abs` alone.
    pub fn unmirrored(&self) -> Self {
        let kinks = Kinks { mirrored: [false; 3], ..self.kinks().clone() };
        Self { kinks: kinks.into(), ..self.clone() }
    }
}
