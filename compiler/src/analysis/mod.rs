//! Facts about the graph: ranges, regions, Lipschitz constants.
//!
//! Everything here holds for the whole range of every parameter and for any time.

pub mod dual;
pub mod region;
pub mod tape;

use crate::graph::algebra::Intervals;
use crate::graph::interval::Interval;
use crate::graph::{Exactness, Graph, Leaf, NodeId, ShapeId, WORLD};
use dual::{Dual, Duals};
use rustc_hash::{FxHashMap, FxHashSet};
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
#[derive(Default)]
pub struct Facts {
    tapes: FxHashMap<NodeId, Rc<Tape>>,
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
    /// Boxes evaluated so far.
    pub boxes: u64,
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
        tape.run(
            graph,
            &mut Intervals,
            |_, leaf| leaf_range(graph, leaf, domain),
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
        let mut dual = self.dual_of(graph, &tape, &domain);
        if exact {
            dual = dual.limited(1.0);
            dual.jumps = 0;
        }
        self.duals.insert(key, dual);
        dual
    }

    /// Value, gradient and its norm of a tape's last step over a domain.
    pub fn dual_of(&mut self, graph: &Graph, tape: &Tape, domain: &Domain) -> Dual {
        self.all_duals(graph, tape, domain)
            .last()
            .copied()
            .unwrap_or(Dual::constant(Interval::ALL))
    }

    /// The same for every step.
    pub fn all_duals(&mut self, graph: &Graph, tape: &Tape, domain: &Domain) -> Vec<Dual> {
        self.boxes += 1;
        dual::run(self, graph, tape, &mut Duals, |leaf| match leaf {
            Leaf::P(i) => Dual::coordinate(usize::from(i), domain.point.axis(usize::from(i))),
            // The scene's point moves with the point of every space, nobody here knows how.
            Leaf::Variable(v) if v < WORLD + 3 => Dual::unknown(domain.variable(v)),
            other => Dual::constant(leaf_range(graph, other, domain)),
        })
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
        let constant = self.supremum(domain, budget, |facts, d| {
            let dual = facts.dual_of(graph, &tape, d);
            (dual.norm, dual.jumps != 0)
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
        let constant = self.supremum(domain, budget, |facts, d| {
            let duals = facts.all_duals(graph, &tape, d);
            let jumps = rows.iter().any(|&r| duals.get(r).is_some_and(|d| d.jumps != 0));
            (dual::map_norm(&tape, &duals, &rows), jumps)
        });
        self.maps.insert(key, constant);
        constant
    }

    /// The largest of `norm` over a domain, the worst box split again and again.
    fn supremum(
        &mut self,
        domain: &Domain,
        budget: usize,
        mut norm: impl FnMut(&mut Self, &Domain) -> (f64, bool),
    ) -> Constant {
        let (first, jumps) = norm(self, domain);
        let whole = Constant { lipschitz: first, jumps };
        if !domain.point.is_finite() || budget <= 1 {
            return whole;
        }
        let mut any_jump = false;
        let mut least: f64 = 0.0;
        let mut open: Vec<(f64, bool, Box3)> = vec![(first, jumps, domain.point)];
        let mut used = 1;
        while used < budget {
            // The worst box is the last.
            let Some((worst, jump, region)) = open.pop() else { break };
            let middle = Box3(region.0.map(|i| Interval::point(i.middle())));
            let (at, _) = norm(self, &domain.at(middle));
            if at.is_finite() {
                least = least.max(at);
            }
            if worst <= least * 1.02 || region.size() < 1e-9 {
                open.push((worst, jump, region));
                break;
            }
            let widest = (0..3)
                .max_by(|&a, &b| region.axis(a).width().total_cmp(&region.axis(b).width()))
                .unwrap_or(0);
            let side = region.axis(widest);
            let half = side.middle();
            for part in [Interval::new(side.lo, half), Interval::new(half, side.hi)] {
                let part = region.with_axis(widest, part);
                let (norm, jump) = norm(self, &domain.at(part));
                used += 1;
                let at = open.partition_point(|(other, _, _)| {
                    // NaN never occurs; infinite sorts last.
                    *other <= norm
                });
                open.insert(at, (norm, jump, part));
            }
        }
        for (_, jump, _) in &open {
            any_jump |= *jump;
        }
        let largest = open.iter().map(|(n, _, _)| *n).fold(0.0, f64::max);
        Constant { lipschitz: largest.min(first), jumps: any_jump && jumps }
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

/// The domain of a shape's own formula, from the intervals of a call's arguments.
pub fn call_domain(variables: &[u32], args: &[Interval]) -> Domain {
    let arg = |i: usize| args.get(i).copied().unwrap_or(Interval::ALL);
    Domain {
        point: Box3([arg(0), arg(1), arg(2)]),
        variables: variables.iter().enumerate().map(|(i, &v)| (v, arg(3 + i))).collect(),
        narrowed: false,
    }
}

/// All values of a leaf.
pub fn leaf_range(graph: &Graph, leaf: Leaf, domain: &Domain) -> Interval {
    match leaf {
        Leaf::P(i) => domain.point.axis(usize::from(i)),
        Leaf::Normal(_) => Interval::new(-1.0, 1.0),
        // Any time that a person may wait for, and what came before.
        Leaf::Time => Interval::new(-1e7, 1e7),
        Leaf::Parameter(i) => graph
            .parameters
            .get(i as usize)
            .map_or(Interval::ALL, |p| Interval::new(p.min, p.max)),
        Leaf::Variable(v) => domain.variable(v),
    }
}

impl Graph {
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
