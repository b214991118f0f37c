//! Facts about the graph: ranges, regions, Lipschitz constants.
//!
//! Everything here holds for the whole range of every parameter and for any time.

mod account;
mod hc4_projections;
pub mod branches;
pub mod chain;
pub mod constant;
pub mod domain;
pub mod dual;
mod matrix;
pub mod analysis_cache;
mod outlines;
mod rigid_transform;
pub(crate) mod products;
pub mod region;
pub mod rules;
pub mod search;
mod slopes;
pub mod unbounded_blame;
pub mod tape;

use crate::graph::interval::Interval;
use crate::graph::kernel;
use crate::graph::{ANY_TIME, Exactness, Graph, Leaf, Node, NodeId, NodeList, ShapeId, WORLD};
use constant::{MOST_SEARCHED, STEPS};
pub use rules::noise_cells::has_cells;
use chain::DEEP;
pub use constant::Constant;
pub use domain::{Box3, Domain, Key};
use dual::Dual;
use analysis_cache::{Content, Memory};
use crate::rules::RuleSet;
use rustc_hash::{FxHashMap, FxHashSet};
use smallvec::SmallVec;
use std::rc::Rc;
use tape::Tape;

/// So many steps may one look run at a formula and all that it calls…
const MOST_IN_ONE: u64 = 2_000_000;
/// …and so many where one took more.
const MOST_IN_NEXT: u64 = 20_000;

/// So many ranges, and so many values with their slopes, are kept: of more the memory would grow with the square of what is compiled.
const MOST_KEPT: usize = 250_000;
/// How many steps of formulas may be looked at more closely for their outlines.
const OUTLINING: usize = 400_000;

/// What is known of the graph's nodes, kept so that nothing is computed twice.
pub struct Facts {
    /// What was found in this compilation and those before.
    pub memory: Memory,
    contents: FxHashMap<NodeId, Content>,
    tapes: FxHashMap<NodeId, Rc<Tape>>,
    weights: FxHashMap<NodeId, usize>,
    duals: FxHashMap<(ShapeId, Key), Dual>,
    ranges: FxHashMap<(ShapeId, Key), Interval>,
    live_ranges: FxHashMap<NodeId, Interval>,
    regions: FxHashMap<(NodeId, Key, u64), Box3>,
    sifted: FxHashMap<(NodeId, Key, u64), Box3>,
    outlines: FxHashMap<NodeId, Box3>,
    close_outlines: FxHashMap<NodeId, Box3>,
    region_outlines: FxHashMap<NodeId, Box3>,
    constants: FxHashMap<(NodeId, Key, usize), Constant>,
    maps: FxHashMap<(NodeList, Key, usize), Constant>,
    /// Boxes that hold all points at which a node is at most zero, where whoever made the node knows.
    solids: FxHashMap<NodeId, Box3>,
    /// How many more shapes the contraction at hand may enter.
    entries: u32,
    /// How many more unions may be looked at part by part for the region at hand.
    unions: u32,
    /// How many unions inside were looked at part by part so far.
    looks: u32,
    /// How many more shapes may be sifted for the region at hand.
    sifts: u32,
    /// How many steps of formulas a closer look at regions has cost so far.
    closer: u64,
    /// How many steps of a formula one constant may cost.
    pub steps: usize,
    /// Boxes evaluated so far.
    pub boxes: u64,
    /// Steps of formulas run so far, with their derivatives or without.
    pub ran: u64,
    /// How many shapes within each other are looked at just now, and how many steps had been run before the outermost.
    nested: (u32, u64),
    /// How many regions within each other are looked for just now.
    regions_open: u32,
    /// How many steps of formulas within each other are carried back through just now.
    walking: u32,
    /// How many steps of formulas closer looks at outlines may still cost.
    outlining: usize,
    /// How many looks at unions inside are under way within each other, and how many regions were found in such looks so far.
    looking: u32,
    looked: u32,
    /// How many steps one look may run: what calls itself twice, thirty times within each other, has no end.
    most_in_one: u64,
    /// Up to which step kinks are looked at side by side, for the box at hand.
    forks: Option<u64>,
    /// How many steps that has cost so far.
    forked: u64,
    /// How many steps searches for constants have cost so far.
    searched: u64,
    /// And those that are made aside: see [`Facts::turn_aside`].
    searched_aside: u64,
    /// How many they may cost, and those aside as many.
    most_searched: u64,
    /// How many steps all of the compilation may still cost, whoever asks for them.
    left: u64,
    /// Whether a search ended because of that.
    cut_short: bool,
    /// Values of the parameters, where these facts hold for those alone.
    pub pinned: Pinned,
    /// The rules that may be used.
    pub rules: RuleSet,
}

impl Default for Facts {
    fn default() -> Self {
        Self {
            memory: Memory::default(),
            contents: FxHashMap::default(),
            tapes: FxHashMap::default(),
            weights: FxHashMap::default(),
            duals: FxHashMap::default(),
            ranges: FxHashMap::default(),
            live_ranges: FxHashMap::default(),
            regions: FxHashMap::default(),
            sifted: FxHashMap::default(),
            outlines: FxHashMap::default(),
            close_outlines: FxHashMap::default(),
            region_outlines: FxHashMap::default(),
            constants: FxHashMap::default(),
            maps: FxHashMap::default(),
            solids: FxHashMap::default(),
            entries: 0,
            unions: 0,
            sifts: 0,
            closer: 0,
            looks: 0,
            steps: STEPS,
            boxes: 0,
            ran: 0,
            nested: (0, 0),
            regions_open: 0,
            walking: 0,
            outlining: OUTLINING,
            looking: 0,
            looked: 0,
            most_in_one: MOST_IN_ONE,
            forks: None,
            forked: 0,
            searched: 0,
            searched_aside: 0,
            most_searched: MOST_SEARCHED,
            left: account::ALL,
            cut_short: false,
            pinned: Rc::new([]),
            rules: RuleSet::default(),
        }
    }
}

impl Facts {
    /// No facts, but what earlier compilations found, and the rules that may be used.
    pub fn with(memory: Memory, rules: RuleSet) -> Self {
        Self { memory, rules, ..Self::default() }
    }

    /// Nothing known yet; these parameters stand at one value.
    pub fn at(pinned: Pinned) -> Self {
        Self { pinned, ..Self::default() }
    }

    /// No facts, but boxes that hold all points at which nodes are at most zero.
    pub fn knowing(solids: FxHashMap<NodeId, Box3>) -> Self {
        Self { solids, ..Self::default() }
    }

    /// Remembers a box that holds every point at which a node is at most zero.
    pub fn know_solid(&mut self, node: NodeId, solid: Box3) {
        self.solids.insert(node, solid);
    }

    /// Remembers that a node is at most zero no farther than `reach` along its axes, where that is not seen at once; of what `is_fixed`, a closer box.
    pub fn know_reach(&mut self, graph: &Graph, node: NodeId, (reach, is_fixed): (f64, bool), dimensions: usize) {
        let side = Interval::new(-reach, reach);
        let seen = self.rough_region(graph, node, &Domain::of(Box3::ALL));
        let around = (0..dimensions).fold(Box3::ALL, |around, axis| around.with_axis(axis, side));
        if seen.intersect(&around) != seen {
            // A drawing has no third axis.
            let within = (dimensions..3).fold(around, |within, axis| within.with_axis(axis, Interval::ZERO));
            let closer = if is_fixed { self.on_top(|facts| facts.region(graph, node, &Domain::of(within), 0.0)) } else { within };
            self.know_solid(node, (0..dimensions).fold(Box3::ALL, |solid, axis| solid.with_axis(axis, closer.axis(axis))));
        }
    }

    /// All such boxes.
    pub fn known_solids(&self) -> &FxHashMap<NodeId, Box3> {
        &self.solids
    }

    /// Such a box, where one is known.
    pub fn known_solid(&self, node: NodeId) -> Option<Box3> {
        self.solids.get(&node).copied()
    }

    /// The steps that compute a node.
    pub fn tape(&mut self, graph: &Graph, node: NodeId) -> Rc<Tape> {
        if let Some(tape) = self.tapes.get(&node) {
            return tape.clone();
        }
        let tape = Rc::new(Tape::new(graph, &[node], self.rules).with_pinned(&self.pinned));
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
                if let tape::Step::Call(shape, _) = step {
                    let called = value(*shape).and_then(|value| self.weights.get(&value));
                    weight = weight.saturating_add(called.copied().unwrap_or(0));
                }
            }
            self.weights.insert(node, weight);
        }
        self.weights.get(&node).copied().unwrap_or(0)
    }

    /// All values of a node that reads nothing but parameters and time. Each node is looked at once: loops ask for chains that grow with
    /// every turn.
    pub fn live_range(&mut self, graph: &Graph, node: NodeId) -> Interval {
        let everywhere = Domain::of(Box3::ALL);
        let pinned = self.pinned.clone();
        let mut open = vec![node];
        while let Some(&id) = open.last() {
            if self.live_ranges.contains_key(&id) {
                open.pop();
                continue;
            }
            let args = graph.arguments(id);
            let before = open.len();
            open.extend(args.iter().copied().filter(|a| !self.live_ranges.contains_key(a)));
            if open.len() > before {
                continue;
            }
            let known: Vec<Interval> =
                args.iter().map(|a| self.live_ranges.get(a).copied().unwrap_or(Interval::ALL)).collect();
            let range = match graph.node(id) {
                Node::Constant(bits) => Interval::point(f64::from_bits(*bits)),
                Node::Leaf(leaf) => leaf_range(graph, &pinned, *leaf, &everywhere),
                Node::Op(op, _) => kernel::interval(*op, &known),
                Node::Call(shape, _, _) => self.shape_range(graph, *shape, &known),
                Node::Claim(..) => known.first().copied().unwrap_or(Interval::ALL),
                Node::Factor(i) => Interval::point(graph.factors.get(*i as usize).map_or(1.0, |f| 1.0 / f.lipschitz)),
            };
            self.live_ranges.insert(id, range);
            open.pop();
        }
        self.live_ranges.get(&node).copied().unwrap_or(Interval::ALL)
    }

    /// All values of a node over a domain.
    pub fn range(&mut self, graph: &Graph, node: NodeId, domain: &Domain) -> Interval {
        let tape = self.tape(graph, node);
        self.ranges_of(graph, &tape, domain).last().copied().unwrap_or(Interval::ALL)
    }

    /// The same, at once where the node is made of few others.
    pub fn near_range(&mut self, graph: &Graph, node: NodeId, domain: &Domain, depth: u32) -> Interval {
        match graph.node(node) {
            Node::Constant(bits) => Interval::point(f64::from_bits(*bits)),
            Node::Leaf(leaf) => leaf_range(graph, &self.pinned, *leaf, domain),
            Node::Op(op, args) if depth > 0 => {
                let args: SmallVec<[Interval; 4]> = args.iter().map(|&a| self.near_range(graph, a, domain, depth - 1)).collect();
                kernel::interval(*op, &args)
            }
            _ => self.range(graph, node, domain),
        }
    }

    /// The range of every step of a tape over a domain.
    pub fn ranges_of(&mut self, graph: &Graph, tape: &Tape, domain: &Domain) -> Vec<Interval> {
        self.boxes += 1;
        self.ran += tape.steps.len() as u64;
        self.spend_on(tape, false);
        let pinned = self.pinned.clone();
        tape.ranges(
            graph,
            |_, leaf| leaf_range(graph, &pinned, leaf, domain),
            |_, shape, args| self.shape_range(graph, shape, args),
        )
    }

    /// All values of a shape's field over intervals of its arguments.
    pub fn shape_range(&mut self, graph: &Graph, shape: ShapeId, args: &[Interval]) -> Interval {
        let Some(s) = graph.shape(shape) else { return Interval::ALL };
        self.range_in(graph, shape, &call_domain(&s.variables, args))
    }

    /// The same over a domain of its own.
    fn range_in(&mut self, graph: &Graph, shape: ShapeId, domain: &Domain) -> Interval {
        let Some(s) = graph.shape(shape) else { return Interval::ALL };
        let key = (shape, domain.key());
        if let Some(known) = self.ranges.get(&key) {
            return *known;
        }
        if !self.enter() {
            return Interval::ALL;
        }
        if self.nested.0 >= DEEP {
            let known = |facts: &Self, shape, domain: &Domain| facts.ranges.contains_key(&(shape, domain.key()));
            self.look_from_below(graph, s.value, domain, known, |facts, shape, domain| {
                facts.range_in(graph, shape, &domain);
            });
        }
        let range = self.range(graph, s.value, domain);
        self.nested.0 -= 1;
        if self.ranges.len() >= MOST_KEPT {
            self.ranges.clear();
        }
        self.ranges.insert(key, range);
        range
    }

    /// Whether the look at hand may go on into another shape. Of one that took too long nothing is known, and later ones end sooner.
    fn enter(&mut self) -> bool {
        if self.nested.0 == 0 {
            self.nested.1 = self.ran;
        } else if self.ran - self.nested.1 > self.most_in_one {
            self.most_in_one = MOST_IN_NEXT;
            return false;
        }
        self.nested.0 += 1;
        true
    }

    /// Value, gradient and its norm of a shape's field over intervals of its arguments.
    pub fn shape_dual(&mut self, graph: &Graph, shape: ShapeId, args: &[Interval]) -> Dual {
        let Some(s) = graph.shape(shape) else { return Dual::constant(Interval::ALL) };
        self.dual_in(graph, shape, &call_domain(&s.variables, args))
    }

    /// The same over a domain of its own.
    fn dual_in(&mut self, graph: &Graph, shape: ShapeId, domain: &Domain) -> Dual {
        let Some(s) = graph.shape(shape) else { return Dual::constant(Interval::ALL) };
        let key = (shape, domain.key());
        if let Some(known) = self.duals.get(&key) {
            return *known;
        }
        if !self.enter() {
            return Dual { jumps: u8::MAX, ..Dual::unknown(Interval::ALL) };
        }
        let value = s.value;
        if self.nested.0 >= DEEP {
            let known = |facts: &Self, shape, domain: &Domain| facts.duals.contains_key(&(shape, domain.key()));
            self.look_from_below(graph, value, domain, known, |facts, shape, domain| {
                facts.dual_in(graph, shape, &domain);
            });
        }
        let exact = s.exactness == Exactness::Exact;
        let tape = self.tape(graph, value);
        let dual = if exact {
            // Known without a look at its kinks.
            let plain = self.all_duals(graph, &tape, domain).last().copied().unwrap_or(Dual::constant(Interval::ALL));
            let pinned = self.pinned.clone();
            let whole = dual::both_sides(&tape, plain, &|leaf| leaf_dual(graph, &pinned, leaf, domain));
            Dual { jumps: 0, ..whole.limited(1.0) }
        } else {
            self.dual_of(graph, &tape, domain).0
        };
        self.nested.0 -= 1;
        if self.duals.len() >= MOST_KEPT {
            self.duals.clear();
        }
        self.duals.insert(key, dual);
        dual
    }

    /// Value, gradient and its norm of a tape's last step over a domain, each of its pieces by itself; and how often it was run.
    pub fn dual_of(&mut self, graph: &Graph, tape: &Tape, domain: &Domain) -> (Dual, usize) {
        let pinned = self.pinned.clone();
        let (dual, runs) = dual::hull_of_pieces(self, graph, tape, &|leaf| leaf_dual(graph, &pinned, leaf, domain));
        self.boxes += runs as u64;
        (dual, runs)
    }

    /// The same for every step, kinks as their hull.
    pub fn all_duals(&mut self, graph: &Graph, tape: &Tape, domain: &Domain) -> Vec<Dual> {
        self.boxes += 1;
        let pinned = self.pinned.clone();
        dual::run(self, graph, tape, None, &mut None, &|leaf| leaf_dual(graph, &pinned, leaf, domain)).unwrap_or_default()
    }

    /// A box that holds all of a repetition's body, over all of its cells.
    pub fn body_region(
        &mut self,
        graph: &mut Graph,
        shape: ShapeId,
        cells: &dyn Fn(u32) -> Option<(f64, f64)>,
        within: Box3,
    ) -> Box3 {
        let Some(value) = graph.shape(shape).map(|s| s.value) else { return Box3::ALL };
        let domain = Domain { variables: cell_ranges(graph, shape, cells), ..Domain::of(within) };
        self.solid_region(graph, value, &domain)
    }
}

/// All that the variables of a repetition's body can be.
pub fn cell_ranges(graph: &Graph, shape: ShapeId, cells: &dyn Fn(u32) -> Option<(f64, f64)>) -> Vec<(u32, Interval)> {
    let variables = graph.shape(shape).map(|s| s.variables.clone()).unwrap_or_default();
    variables.iter().map(|&v| (v, cells(v).map_or(Interval::ALL, |(lo, hi)| Interval::new(lo, hi)))).collect()
}

/// A leaf as a function of the point of its space.
pub fn leaf_dual(graph: &Graph, pinned: &[f64], leaf: Leaf, domain: &Domain) -> Dual {
    match leaf {
        Leaf::P(i) => Dual::coordinate(usize::from(i), domain.point.axis(usize::from(i))),
        // The scene's point moves with the point of every space, nobody here knows how.
        Leaf::Variable(v) if v < WORLD + 3 => Dual::unknown(domain.variable(v)),
        other => Dual::constant(leaf_range(graph, pinned, other, domain)),
    }
}

/// The domain of a shape's own formula, from the intervals of a call's arguments.
pub fn call_domain(variables: &[u32], args: &[Interval]) -> Domain {
    let arg = |i: usize| args.get(i).copied().unwrap_or(Interval::ALL);
    Domain {
        variables: variables.iter().enumerate().map(|(i, &v)| (v, arg(3 + i))).collect(),
        ..Domain::of(Box3([arg(0), arg(1), arg(2)]))
    }
}

/// Parameters that stand at one value, where the facts are not meant for their whole range: components by their index, and behind them
/// the time, where that stands too.
pub type Pinned = Rc<[f64]>;

/// All values of a leaf.
pub fn leaf_range(graph: &Graph, pinned: &[f64], leaf: Leaf, domain: &Domain) -> Interval {
    match leaf {
        Leaf::P(i) => domain.point.axis(usize::from(i)),
        Leaf::Normal(_) => Interval::new(-1.0, 1.0),
        Leaf::Time => pinned.get(graph.parameters.len()).map_or(ANY_TIME, |t| Interval::point(*t)),
        Leaf::Parameter(i) => match (pinned.get(i as usize), graph.parameters.get(i as usize)) {
            (Some(value), _) => Interval::point(*value),
            (None, Some(p)) => Interval::new(p.min, p.max),
            (None, None) => Interval::ALL,
        },
        Leaf::Variable(v) => domain.variable(v),
    }
}

impl Graph {
    /// Components of parameters that nodes depend on, through the shapes that they call.
    pub fn parameters_under(&self, nodes: &[NodeId]) -> FxHashSet<u32> {
        let parameter = |leaf| if let Leaf::Parameter(i) = leaf { Some(i) } else { None };
        self.leaves_under(nodes).into_iter().filter_map(parameter).collect()
    }

    /// The leaves that nodes read, through the shapes that they call.
    pub fn leaves_under(&self, nodes: &[NodeId]) -> FxHashSet<Leaf> {
        let mut read = FxHashSet::default();
        let mut seen: FxHashSet<ShapeId> = FxHashSet::default();
        let mut roots: Vec<NodeId> = nodes.to_vec();
        while !roots.is_empty() {
            for id in self.reachable(&std::mem::take(&mut roots)) {
                match self.node(id) {
                    Node::Leaf(leaf) => {
                        read.insert(*leaf);
                    }
                    Node::Call(s, ..) if seen.insert(*s) => roots.extend(self.shape(*s).map(|s| s.value)),
                    Node::Claim(_, crate::graph::Claim::Lipschitz(formula, ..)) => roots.push(*formula),
                    _ => {}
                }
            }
        }
        read
    }

    /// Components of parameters that a shape and nodes read.
    pub fn parameters_read(&self, root: ShapeId, nodes: &[NodeId]) -> FxHashSet<u32> {
        let mut read = FxHashSet::default();
        let mut shapes = vec![root];
        let mut seen: FxHashSet<ShapeId> = FxHashSet::default();
        let mut roots: Vec<NodeId> = nodes.to_vec();
        while !shapes.is_empty() || !roots.is_empty() {
            while let Some(id) = shapes.pop() {
                if !seen.insert(id) {
                    continue;
                }
                let Some(shape) = self.shape(id) else { continue };
                roots.push(shape.value);
                let materials = shape.material.iter().chain(shape.paints.iter().map(|(_, m)| m));
                for m in materials.filter_map(|m| self.materials.get(m.0 as usize)) {
                    roots.extend(m.nodes());
                }
                shapes.extend(shape.paints.iter().map(|(s, _)| *s));
            }
            for id in self.reachable(&std::mem::take(&mut roots)) {
                match self.node(id) {
                    Node::Leaf(Leaf::Parameter(i)) => {
                        read.insert(*i);
                    }
                    Node::Call(s, _, _) if !seen.contains(s) => shapes.push(*s),
                    _ => {}
                }
            }
        }
        read
    }
}
