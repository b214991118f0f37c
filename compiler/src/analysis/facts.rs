//! What is known of the graph's nodes, and what it may cost to find more.
//!
//! Everything here holds for the whole range of every parameter and for any time.

use super::account::Account;
use super::analysis_cache::{Content, Memory};
use super::domain::{Box3, Key, Pinned};
use super::dual::{Constant, Dual};
use super::formula::Formula;
use super::tape::Step;
use crate::graph::interval::Interval;
use crate::graph::{Graph, NodeId, NodeList, ShapeId};
use crate::rules::RuleSet;
use rustc_hash::FxHashMap;
use std::rc::Rc;

/// So many ranges, and so many values with their slopes, are kept: of more the memory would grow with the square of what is compiled.
pub(super) const MOST_KEPT: usize = 250_000;

/// What is known of the graph's nodes, kept so that nothing is computed twice.
#[derive(Default)]
pub struct Facts {
    /// What was found in this compilation and those before.
    pub memory: Memory,
    /// What searches have cost, and what they may.
    pub account: Account,
    /// Values of the parameters, where these facts hold for those alone.
    pub pinned: Pinned,
    /// The rules that may be used.
    pub rules: RuleSet,
    /// What is looked at just now.
    pub(super) looks: Looks,
    pub(super) contents: FxHashMap<NodeId, Content>,
    tapes: FxHashMap<NodeId, Rc<Formula>>,
    weights: FxHashMap<NodeId, usize>,
    pub(super) duals: FxHashMap<(ShapeId, Key), Dual>,
    pub(super) ranges: FxHashMap<(ShapeId, Key), Interval>,
    pub(super) live_ranges: FxHashMap<NodeId, Interval>,
    pub(super) regions: FxHashMap<(NodeId, Key, u64), Box3>,
    pub(super) sifted: FxHashMap<(NodeId, Key, u64), Box3>,
    pub(super) outlines: FxHashMap<NodeId, Box3>,
    pub(super) close_outlines: FxHashMap<NodeId, Box3>,
    pub(super) region_outlines: FxHashMap<NodeId, Box3>,
    pub(super) constants: FxHashMap<(NodeId, Key, usize), Constant>,
    pub(super) maps: FxHashMap<(NodeList, Key, usize), Constant>,
    /// Boxes that hold all points at which a node is at most zero, where whoever made the node knows.
    solids: FxHashMap<NodeId, Box3>,
}

/// What is looked at just now, within what, and how much further each look may lead.
#[derive(Clone, Debug, Default)]
pub(super) struct Looks {
    /// How many more shapes the contraction at hand may enter.
    pub entries: u32,
    /// How many more unions may be looked at part by part for the region at hand.
    pub unions: u32,
    /// How many more shapes may be sifted for the region at hand.
    pub sifts: u32,
    /// How many regions within each other are looked for.
    pub regions_open: u32,
    /// How many steps of formulas within each other are carried back through.
    pub walking: u32,
    /// How many looks at unions inside are under way within each other, how many there were so far, and how many regions were found in them.
    pub looking: u32,
    pub looked: u32,
    pub regions_looked: u32,
    /// How many shapes are looked at within each other, and how many steps had been run before the outermost.
    pub nested: (u32, u64),
    /// Up to which step kinks are looked at side by side, for the box at hand.
    pub forks: Option<u64>,
}

impl Facts {
    /// No facts, but what earlier compilations found, and the rules that may be used.
    pub fn with(memory: Memory, rules: RuleSet) -> Self {
        Self { memory, rules, ..Self::default() }
    }

    /// Nothing known yet; these parameters stand at one value, and these rules may be used.
    pub fn at(pinned: Pinned, rules: RuleSet) -> Self {
        Self { pinned, rules, ..Self::default() }
    }

    /// No facts, but boxes that hold all points at which nodes are at most zero.
    pub fn knowing(solids: FxHashMap<NodeId, Box3>) -> Self {
        Self { solids, ..Self::default() }
    }

    /// Remembers a box that holds every point at which a node is at most zero.
    pub fn know_solid(&mut self, node: NodeId, solid: Box3) {
        self.solids.insert(node, solid);
    }

    /// All such boxes.
    pub fn known_solids(&self) -> &FxHashMap<NodeId, Box3> {
        &self.solids
    }

    /// Such a box, where one is known.
    pub fn known_solid(&self, node: NodeId) -> Option<Box3> {
        self.solids.get(&node).copied()
    }

    /// The steps that compute a node, and what the rules read in them.
    pub fn tape(&mut self, graph: &Graph, node: NodeId) -> Rc<Formula> {
        if let Some(tape) = self.tapes.get(&node) {
            return tape.clone();
        }
        let tape = Rc::new(Formula::new(graph, &[node], self.rules).with_pinned(&self.pinned));
        self.tapes.insert(node, tape.clone());
        tape
    }

    /// How many steps one run of a node takes, those of the shapes that it calls counted in.
    pub fn weight(&mut self, graph: &Graph, node: NodeId) -> usize {
        if let Some(known) = self.weights.get(&node) {
            return *known;
        }
        let value = |shape: ShapeId| graph.shape(shape).map(|s| s.value);
        let inside = graph.called_below(node, |shape| value(shape).is_none_or(|value| self.weights.contains_key(&value)));
        for node in inside.into_iter().filter_map(value).chain([node]) {
            let tape = self.tape(graph, node);
            let mut weight = tape.steps.len();
            for step in &tape.steps {
                if let Step::Call(shape, _) = step {
                    let called = value(*shape).and_then(|value| self.weights.get(&value));
                    weight = weight.saturating_add(called.copied().unwrap_or(0));
                }
            }
            self.weights.insert(node, weight);
        }
        self.weights.get(&node).copied().unwrap_or(0)
    }

    /// Whether the look at hand may go on into another shape. Of one that took too long nothing is known.
    pub(super) fn enter(&mut self) -> bool {
        if self.looks.nested.0 == 0 {
            self.looks.nested.1 = self.account.ran;
        } else if !self.account.goes_on(self.looks.nested.1) {
            return false;
        }
        self.looks.nested.0 += 1;
        true
    }
}
