//! Ground truth: what is certain of a scene's field, in 64 bits with intervals that round outward.
//!
//! It judges the bounds that the compiler derives, so it knows none of them: it reads the formula of the field and nothing else, no
//! claim, no factor, no kind of shape. Constants and live values are rounded to 32 bits first, so that the GPU's field is meant, each side
//! in its own precision.
//!
//! [`Truth`] is the field of a scene at fixed live values. A [`Prover`] (one for each thread) answers questions of it:
//!
//! - [`Prover::over`]: all values and gradients over a box; [`Prover::range`]: the values alone;
//! - [`Prover::empty_ball`]: whether a ball holds no surface; [`Prover::distance`]: how far the surface is;
//! - [`Prover::first_hit`]: where a ray meets the surface first;
//! - [`Prover::steepest`]: how steep the field is at most in a box;
//! - [`Prover::look`]: between which two planes the field can be zero in a box; [`Prover::side_of_triangle`]: its sign all over a triangle.
//!
//! All work by subdividing boxes. A box in which some branches of the code can't matter gets a shorter code (as in Keeter, "Massively
//! Parallel Rendering of Complex Closed-Form Implicit Surfaces", 2020); what is left is bounded by natural intervals and the mean-value
//! form (Moore, Kearfott and Cloud, "Introduction to Interval Analysis", 2009, § 6). Every question has a budget of boxes, and
//! says so when it is used up; nothing depends on a clock, so the same question has the same answer.
//!
//! [`falsify`] is the quick way for millions of points.

mod ball;
mod code;
mod falsify;
mod form;
mod forms;
mod forward;
mod jumps;
mod pieces;
mod plane;
mod prover;
mod ray;
mod steepest;
mod step;

pub use prover::{Box3, Prover, Truth};
use prover::{BRANCHES, NATURAL, Over, SHORT, SLOPES, joined, side};

pub use ball::{Ball, Distance};
pub use falsify::{Claim, Violation, falsify};
pub use plane::{Held, Look, Place, Slab};
pub use ray::Hit;
pub use steepest::Steepest;

use crate::compiled::Compiled;
use crate::live::Live;
use crate::evaluate::{Tape, TooLarge};
use crate::functions::Functions;
use crate::graph::interval::Interval;
use crate::graph::{Function, Graph, NodeId};
use code::{Code, Room};
use forward::{Domain, Slot};
use pieces::{Branches, Piece};
use std::sync::Arc;

impl Truth {
    /// The field of a scene. At most `limit` operations once every call is replaced by its formula.
    pub fn new(scene: &Compiled, live: &Live, limit: usize) -> Result<Self, TooLarge> {
        let shape = scene.graph.shape(scene.root).map(|s| s.value).unwrap_or_default();
        let root = scene.functions.formulas.get(&(scene.root, Function::Field)).copied().unwrap_or(shape);
        Self::of(&scene.graph, &scene.functions, root, live, limit)
    }

    /// Any formula in the scene's space: `root` is a node of `graph`, whose calls of fields `functions` has.
    pub fn of(graph: &Graph, functions: &Functions, root: NodeId, live: &Live, limit: usize) -> Result<Self, TooLarge> {
        let tape = Tape::new(graph, &functions.formulas, &[root], live, limit)?;
        Ok(Self { point: Arc::new(Code::new(&tape)), ray: Code::along(&tape) })
    }

    /// Number of steps of the field's code.
    pub fn steps(&self) -> usize {
        self.point.steps.len()
    }

    /// Room for answers.
    pub fn prover(&self) -> Prover<'_> {
        Prover {
            truth: self,
            boxes: 0,
            work: 0,
            most: u64::MAX,
            room: Room::default(),
            values: Vec::new(),
            ranges: Vec::new(),
            slots: Vec::new(),
            ray_slots: Vec::new(),
            branches: Branches::default(),
            ray_branches: Branches::default(),
            live: Vec::new(),
        }
    }
}

impl Prover<'_> {
    /// Boxes looked at since this prover was made.
    pub fn boxes(&self) -> u64 {
        self.boxes
    }

    /// How much was computed: an operation over a box counts as [`NATURAL`], with its slopes as [`SLOPES`].
    pub fn work(&self) -> u64 {
        self.work
    }

    /// From here on so much may be computed; then a question ends as one whose boxes are used up.
    pub fn allow(&mut self, work: u64) {
        (self.work, self.most) = (0, work);
    }

    /// An interval that holds all values of the field over a box.
    pub fn range(&mut self, range: Box3) -> Interval {
        self.boxes += 1;
        self.whole(range).1.range
    }

    /// The code for a box, and what its last step is there.
    fn whole(&mut self, range: Box3) -> (Arc<Code>, Slot<3>) {
        let code = self.narrowed(self.truth.point.clone(), &range).1;
        self.work += SLOPES * code.steps.len() as u64;
        let last = forward::full(&code, &Domain::new(range, None), &mut self.slots);
        (code, last)
    }

    /// The field at a point in 64 bits, not rounded outward.
    pub fn value(&mut self, at: [f64; 3]) -> f64 {
        self.truth.point.value(&at, &mut self.values)
    }

    /// What is known of the field over a box, kinks branch by branch.
    pub fn over(&mut self, range: Box3) -> Over {
        self.over_branches(range, BRANCHES)
    }

    /// The same, looking at so many branches, about; what is beyond them is taken together.
    pub fn over_branches(&mut self, range: Box3, branches: usize) -> Over {
        self.boxes += 1;
        let (code, last) = self.whole(range);
        let mut pieces = None;
        let looked = self.branches.each(&code, &self.slots, branches, |piece| {
            pieces = Some(joined(pieces, piece));
            true
        });
        self.work += SLOPES * looked;
        // Branches that all contradict each other are left by rounding only.
        let known = pieces.unwrap_or(Piece { gradient: last.gradient, norm: last.norm, jump: last.jump });
        Over { value: last.range, gradient: known.gradient, norm: known.norm.min(last.norm), jump: known.jump }
    }

    /// 1 or -1 where the field at a point is certainly above or below zero, else 0.
    fn sign<const D: usize>(&mut self, code: &Code, at: [f64; D]) -> i8 {
        self.work += NATURAL * code.steps.len() as u64;
        side(forward::natural(code, &at.map(Interval::point), &mut self.ranges))
    }

    /// The natural interval of a code over a box, and the shorter code for it where it is worth it.
    fn narrowed<const D: usize>(&mut self, code: Arc<Code>, range: &[Interval; D]) -> (Interval, Arc<Code>) {
        self.work += NATURAL * code.steps.len() as u64;
        let value = forward::natural(&code, range, &mut self.ranges);
        let ranges = &self.ranges;
        let shorter = code.shorter(|i| ranges.get(i).copied().unwrap_or(Interval::ALL), &mut self.room);
        (value, shorter.map_or(code, Arc::new))
    }
}

