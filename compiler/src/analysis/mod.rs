//! Facts about the graph: ranges, regions, Lipschitz constants.
//!
//! Everything here holds for the whole range of every parameter and for any time.

pub mod branches;
pub mod dual;
pub mod matrix;
pub mod region;
pub mod search;
pub mod steep;
pub mod tape;

use crate::graph::algebra::Intervals;
use crate::graph::interval::Interval;
use crate::graph::{Exactness, Graph, Leaf, NodeId, ShapeId, WORLD};
use dual::Dual;
use rustc_hash::{FxHashMap, FxHashSet};
use std::collections::BinaryHeap;
use std::rc::Rc;
use tape::Tape;

/// A box: the product of three intervals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Box3(pub [Interval; 3]);

impl Box3 {
    /// All of space.
    pub const ALL: Self = Self([Interval::ALL; 3]);
    /// Nothing.
    pub const EMPTY: Self = Self([Interval::EMPTY; 3]);

    /// The cube about the origin with this half side.
    pub fn cube(half: f64) -> Self {
        Self([Interval::new(-half, half); 3])
    }

    /// One side; all numbers for an axis that does not exist.
    pub fn axis(&self, i: usize) -> Interval {
        self.0.get(i).copied().unwrap_or(Interval::ALL)
    }

    /// Replaces one side.
    pub fn with_axis(mut self, i: usize, side: Interval) -> Self {
        if let Some(slot) = self.0.get_mut(i) {
            *slot = side;
        }
        self
    }

    /// Whether it holds no point.
    pub fn is_empty(&self) -> bool {
        self.0.iter().any(|i| i.is_empty())
    }

    /// Whether all sides are finite.
    pub fn is_finite(&self) -> bool {
        self.0.iter().all(|i| i.is_finite())
    }

    /// Smallest box that holds both.
    pub fn hull(&self, other: &Self) -> Self {
        if self.is_empty() {
            return *other;
        }
        if other.is_empty() {
            return *self;
        }
        let mut sides = self.0;
        for (a, b) in sides.iter_mut().zip(&other.0) {
            *a = a.hull(*b);
        }
        Self(sides)
    }

    /// What both hold.
    pub fn intersect(&self, other: &Self) -> Self {
        let mut sides = self.0;
        for (a, b) in sides.iter_mut().zip(&other.0) {
            *a = a.intersect(*b);
        }
        Self(sides)
    }

    /// Grown by `amount` on every side.
    pub fn grow(&self, amount: f64) -> Self {
        Self(self.0.map(|i| i.grow(amount)))
    }

    /// Length of the longest side.
    pub fn size(&self) -> f64 {
        self.0.iter().map(|i| i.width()).fold(0.0, f64::max)
    }
}

/// Where a formula is looked at: a box of points, and an interval for each variable.
#[derive(Clone, Debug, PartialEq)]
pub struct Domain {
    /// Points of the own space.
    pub point: Box3,
    /// Variables in ascending order.
    pub variables: Vec<(u32, Interval)>,
    /// Whether what lies beyond the box is of no interest, because something around the formula has a region.
    pub narrowed: bool,
}

impl Domain {
    /// A box, with nothing known of variables.
    pub fn of(point: Box3) -> Self {
        Self { point, variables: Vec::new(), narrowed: false }
    }

    /// What is known of a variable.
    pub fn variable(&self, v: u32) -> Interval {
        match self.variables.binary_search_by_key(&v, |(v, _)| *v) {
            Ok(i) => self.variables.get(i).map_or(Interval::ALL, |(_, r)| *r),
            Err(_) => Interval::ALL,
        }
    }

    /// The same with another box.
    pub fn at(&self, point: Box3) -> Self {
        Self { point, variables: self.variables.clone(), narrowed: self.narrowed }
    }

    /// Smallest domain that holds both.
    pub fn hull(&self, other: &Self) -> Self {
        let mut variables = self.variables.clone();
        for (v, r) in &other.variables {
            match variables.binary_search_by_key(v, |(v, _)| *v) {
                Ok(i) => {
                    if let Some(slot) = variables.get_mut(i) {
                        slot.1 = slot.1.hull(*r);
                    }
                }
                Err(i) => variables.insert(i, (*v, *r)),
            }
        }
        Self { point: self.point.hull(&other.point), variables, narrowed: self.narrowed && other.narrowed }
    }

    /// Its bits, to look things up by.
    pub fn key(&self) -> Vec<u64> {
        let bits = |i: &Interval| [i.lo.to_bits(), i.hi.to_bits()];
        self.point.0.iter().chain(self.variables.iter().map(|(_, r)| r)).flat_map(bits).collect()
    }
}

/// A constant of a formula over a domain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constant {
    /// No two values differ by more than this times the distance of their points, on each piece.
    pub lipschitz: f64,
    /// Whether the formula may jump in the domain.
    pub jumps: bool,
}

/// What is known of the graph's nodes, kept so that nothing is computed twice.
pub struct Facts {
    tapes: FxHashMap<NodeId, Rc<Tape>>,
    weights: FxHashMap<NodeId, usize>,
    duals: FxHashMap<(ShapeId, Vec<u64>), Dual>,
    ranges: FxHashMap<(ShapeId, Vec<u64>), Interval>,
    regions: FxHashMap<(NodeId, Vec<u64>, u64), Box3>,
    constants: FxHashMap<(NodeId, Vec<u64>), Constant>,
    maps: FxHashMap<(Vec<NodeId>, Vec<u64>), Constant>,
    /// Boxes that hold all points at which a node is at most zero, where whoever made the node knows.
    solids: FxHashMap<NodeId, Box3>,
    /// How many more shapes the contraction at hand may enter.
    entries: u32,
    /// How many more unions may be looked at part by part for the region at hand.
    unions: u32,
    /// How many more shapes may be sifted for the region at hand.
    sifts: u32,
    /// How many steps of a formula one constant may cost.
    pub steps: usize,
    /// Boxes evaluated so far.
    pub boxes: u64,
    /// Values of the parameters, where these facts hold for those alone.
    pub pinned: Pinned,
}

impl Default for Facts {
    fn default() -> Self {
        Self {
            tapes: FxHashMap::default(),
            weights: FxHashMap::default(),
            duals: FxHashMap::default(),
            ranges: FxHashMap::default(),
            regions: FxHashMap::default(),
            constants: FxHashMap::default(),
            maps: FxHashMap::default(),
            solids: FxHashMap::default(),
            entries: 0,
            unions: 0,
            sifts: 0,
            steps: STEPS,
            boxes: 0,
            pinned: Rc::new([]),
        }
    }
}

impl Facts {
    /// Remembers a box that holds every point at which a node is at most zero.
    pub fn know_solid(&mut self, node: NodeId, solid: Box3) {
        self.solids.insert(node, solid);
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
        let tape = Rc::new(Tape::new(graph, &[node]));
        self.tapes.insert(node, tape.clone());
        tape
    }

    /// How many steps one run of a node takes, those of the shapes that it calls counted in.
    pub fn weight(&mut self, graph: &Graph, node: NodeId) -> usize {
        if let Some(known) = self.weights.get(&node) {
            return *known;
        }
        let tape = self.tape(graph, node);
        let mut weight = tape.steps.len();
        for step in &tape.steps {
            if let tape::Step::Call(shape, _) = step
                && let Some(s) = graph.shape(*shape)
            {
                weight = weight.saturating_add(self.weight(graph, s.value));
            }
        }
        self.weights.insert(node, weight);
        weight
    }

    /// All values of a node that reads nothing but parameters and time.
    pub fn live_range(&mut self, graph: &Graph, node: NodeId) -> Interval {
        self.range(graph, node, &Domain::of(Box3::ALL))
    }

    /// All values of a node over a domain.
    pub fn range(&mut self, graph: &Graph, node: NodeId, domain: &Domain) -> Interval {
        let tape = self.tape(graph, node);
        self.ranges_of(graph, &tape, domain).last().copied().unwrap_or(Interval::ALL)
    }

    /// The range of every step of a tape over a domain.
    pub fn ranges_of(&mut self, graph: &Graph, tape: &Tape, domain: &Domain) -> Vec<Interval> {
        self.boxes += 1;
        let pinned = self.pinned.clone();
        tape.run(
            graph,
            &mut Intervals,
            |_, leaf| leaf_range(graph, &pinned, leaf, domain),
            |_, shape, args| self.shape_range(graph, shape, args),
        )
    }

    /// All values of a shape's field over intervals of its arguments.
    pub fn shape_range(&mut self, graph: &Graph, shape: ShapeId, args: &[Interval]) -> Interval {
        let Some(s) = graph.shape(shape) else { return Interval::ALL };
        let domain = call_domain(&s.variables, args);
        let key = (shape, domain.key());
        if let Some(known) = self.ranges.get(&key) {
            return *known;
        }
        let range = self.range(graph, s.value, &domain);
        self.ranges.insert(key, range);
        range
    }

    /// Value, gradient and its norm of a shape's field over intervals of its arguments.
    pub fn shape_dual(&mut self, graph: &Graph, shape: ShapeId, args: &[Interval]) -> Dual {
        let Some(s) = graph.shape(shape) else { return Dual::constant(Interval::ALL) };
        let domain = call_domain(&s.variables, args);
        let key = (shape, domain.key());
        if let Some(known) = self.duals.get(&key) {
            return *known;
        }
        let value = s.value;
        let exact = s.exactness == Exactness::Exact;
        let tape = self.tape(graph, value);
        let dual = if exact {
            // Known without a look at its kinks.
            let plain = self.all_duals(graph, &tape, &domain).last().copied().unwrap_or(Dual::constant(Interval::ALL));
            let pinned = self.pinned.clone();
            let whole = dual::both_sides(&tape, plain, &|leaf| leaf_dual(graph, &pinned, leaf, &domain));
            Dual { jumps: 0, ..whole.limited(1.0) }
        } else {
            self.dual_of(graph, &tape, &domain).0
        };
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

    /// A Lipschitz constant of a node over a domain, looked for with at most `budget` boxes.
    pub fn constant(
        &mut self,
        graph: &Graph,
        node: NodeId,
        domain: &Domain,
        budget: usize,
    ) -> Constant {
        let key = (node, domain.key());
        if let Some(known) = self.constants.get(&key) {
            return *known;
        }
        let tape = self.tape(graph, node);
        let weight = self.weight(graph, node);
        let budget = budget.min((self.steps / weight.max(1)).max(8));
        let constant = self.supremum(&tape, domain, budget, |facts, d| {
            let (dual, runs) = facts.dual_of(graph, &tape, d);
            Norm { norm: dual.norm, jumps: dual.jumps != 0, runs }
        });
        self.constants.insert(key, constant);
        constant
    }

    /// A bound of the norm of the Jacobian of a point's three coordinates over a domain.
    pub fn map_constant(
        &mut self,
        graph: &Graph,
        point: &[NodeId],
        domain: &Domain,
        budget: usize,
    ) -> Constant {
        let key = (point.to_vec(), domain.key());
        if let Some(known) = self.maps.get(&key) {
            return *known;
        }
        let tape = Tape::new(graph, point);
        let rows: Vec<usize> = tape.roots().collect();
        let budget = budget.min((self.steps / tape.steps.len().max(1)).max(8));
        let constant = self.supremum(&tape, domain, budget, |facts, d| {
            let mut norm = Norm { norm: 0.0, jumps: false, runs: 0 };
            let pinned = facts.pinned.clone();
            let leaf = |leaf| leaf_dual(graph, &pinned, leaf, d);
            let runs = branches::each_piece(facts, graph, &tape, &leaf, &mut |duals| {
                norm.jumps |= rows.iter().any(|&r| duals.get(r).is_some_and(|d| d.jumps != 0));
                norm.norm = norm.norm.max(dual::map_norm(&tape, duals, &rows));
            });
            facts.boxes += runs as u64;
            Norm { runs, ..norm }
        });
        self.maps.insert(key, constant);
        constant
    }

    /// The largest of `norm` over a domain, the worst box split again and again.
    fn supremum(
        &mut self,
        tape: &Tape,
        domain: &Domain,
        budget: usize,
        mut norm: impl FnMut(&mut Self, &Domain) -> Norm,
    ) -> Constant {
        let first = norm(self, domain);
        // What the formula does not read needs no splitting.
        let axes: Vec<usize> = (0..3).filter(|&i| tape.reads(i)).collect();
        let splits = axes.iter().all(|&i| domain.point.axis(i).is_finite()) && !axes.is_empty();
        if !splits || budget <= 1 {
            return Constant { lipschitz: first.norm, jumps: first.jumps };
        }
        let mut least: f64 = 0.0;
        let mut open = BinaryHeap::from([Part { norm: first.norm, jumps: first.jumps, region: domain.point }]);
        let mut used = first.runs;
        while used < budget {
            let Some(worst) = open.pop() else { break };
            let width = |i: &usize| worst.region.axis(*i).width();
            let Some(&widest) = axes.iter().max_by(|a, b| width(a).total_cmp(&width(b))) else { break };
            // Not the middle itself, where what is symmetric has its kinks.
            let inside = Box3(worst.region.0.map(|i| Interval::point(if i.is_finite() { i.lo + 0.4837 * i.width() } else { i.middle() })));
            let at = norm(self, &domain.at(inside));
            if at.norm.is_finite() {
                least = least.max(at.norm);
            }
            if worst.norm <= least * 1.02 || width(&widest) < 1e-9 {
                open.push(worst);
                break;
            }
            let side = worst.region.axis(widest);
            let half = side.middle();
            for part in [Interval::new(side.lo, half), Interval::new(half, side.hi)] {
                let region = worst.region.with_axis(widest, part);
                let found = norm(self, &domain.at(region));
                used += found.runs;
                open.push(Part { norm: found.norm, jumps: found.jumps, region });
            }
        }
        let largest = open.peek().map_or(0.0, |p| p.norm);
        let jumps = first.jumps && open.iter().any(|p| p.jumps);
        Constant { lipschitz: largest.min(first.norm), jumps }
    }

    /// A box that holds all of a repetition's body, over all of its cells.
    pub fn body_region(
        &mut self,
        graph: &mut Graph,
        shape: ShapeId,
        cells: &dyn Fn(u32) -> Option<(f64, f64)>,
        extent: f64,
    ) -> Box3 {
        let Some(s) = graph.shape(shape) else { return Box3::ALL };
        let value = s.value;
        let variables: Vec<(u32, Interval)> = s
            .variables
            .iter()
            .map(|&v| (v, cells(v).map_or(Interval::ALL, |(lo, hi)| Interval::new(lo, hi))))
            .collect();
        let domain = Domain { point: Box3::cube(extent), variables, narrowed: false };
        self.region(graph, value, &domain, 0.0)
    }
}

/// How many steps of a formula one constant may cost while a scene is compiled.
const STEPS: usize = 20_000;

/// What one box tells.
struct Norm {
    /// A bound of the gradient's norm.
    norm: f64,
    /// Whether the formula may jump in it.
    jumps: bool,
    /// How often the formula was run.
    runs: usize,
}

/// A box that waits to be split; the one with the largest norm comes first.
struct Part {
    norm: f64,
    jumps: bool,
    region: Box3,
}

impl PartialEq for Part {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Part {}

impl PartialOrd for Part {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Part {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        let corner = |p: &Self| p.region.0.map(|i| i.lo);
        // Ties by place, so that the order depends on nothing else.
        self.norm.total_cmp(&other.norm).then_with(|| {
            let pairs = corner(self).into_iter().zip(corner(other));
            pairs.map(|(a, b)| a.total_cmp(&b)).find(|o| o.is_ne()).unwrap_or(std::cmp::Ordering::Equal)
        })
    }
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
        point: Box3([arg(0), arg(1), arg(2)]),
        variables: variables.iter().enumerate().map(|(i, &v)| (v, arg(3 + i))).collect(),
        narrowed: false,
    }
}

/// Parameters that stand at one value, where the facts are not meant for their whole range: components by their index.
pub type Pinned = Rc<[f64]>;

/// All values of a leaf.
pub fn leaf_range(graph: &Graph, pinned: &[f64], leaf: Leaf, domain: &Domain) -> Interval {
    match leaf {
        Leaf::P(i) => domain.point.axis(usize::from(i)),
        Leaf::Normal(_) => Interval::new(-1.0, 1.0),
        // Any time that a person may wait for, and what came before.
        Leaf::Time => Interval::new(-1e7, 1e7),
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
        let mut read = FxHashSet::default();
        let mut seen: FxHashSet<ShapeId> = FxHashSet::default();
        let mut roots: Vec<NodeId> = nodes.to_vec();
        while !roots.is_empty() {
            for id in self.reachable(&std::mem::take(&mut roots)) {
                match self.node(id) {
                    crate::graph::Node::Leaf(Leaf::Parameter(i)) => {
                        read.insert(*i);
                    }
                    crate::graph::Node::Call(s, ..) if seen.insert(*s) => roots.extend(self.shape(*s).map(|s| s.value)),
                    crate::graph::Node::Claim(_, crate::graph::Claim::Lipschitz(formula, _)) => roots.push(*formula),
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
                    roots.extend(m.color.iter().chain(&m.emission));
                    roots.extend([m.roughness, m.metallic, m.reflectivity]);
                }
                shapes.extend(shape.paints.iter().map(|(s, _)| *s));
            }
            for id in self.reachable(&std::mem::take(&mut roots)) {
                match self.node(id) {
                    crate::graph::Node::Leaf(Leaf::Parameter(i)) => {
                        read.insert(*i);
                    }
                    crate::graph::Node::Call(s, _, _) if !seen.contains(s) => shapes.push(*s),
                    _ => {}
                }
            }
        }
        read
    }
}
