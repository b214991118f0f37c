//! Where a shape is asked for its value: the domain of every shape, and the region that holds the solid of a formula.

use crate::analysis::chain::DEEP;
use crate::analysis::{Box3, Constant, Domain};
use crate::functions::builder::{Builder, whole_scene};
use crate::functions::found::{Cut, Narrowed};
use crate::functions::limits::{BUDGET, GENTLE, LONG, STEEPEST, UNIT};
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::{Claim, Exactness, Function, Graph, Leaf, Node, NodeId, ShapeId};
use crate::rules::Rule;
use rustc_hash::FxHashSet;
use smallvec::SmallVec;

/// A constant up to here needs no other region than a box.
const MILD: f64 = 2.0;
/// A constant beyond this is that of something wild.
pub(super) const STEEP: f64 = 16.0;
/// How many steps of formulas may tell which parts of intersections cut nothing off; the others are looked at.
const ABSORBING: u64 = 2_000_000;
/// Where a shape is asked is found without a tape, as far as it takes no more operations within each other.
const NEAR: u32 = 3;
/// How many times as many boxes a constant may cost where conditions leave something out.
pub(super) const LONGER: usize = 16;

impl Builder<'_> {
    /// Where each shape's formula is asked for, from the extent of the scene inward.
    pub(super) fn find_domains(&mut self) {
        self.domains.insert(self.root, whole_scene(self.scene.extent));
        let mut order: Vec<ShapeId> = vec![self.root];
        let mut seen: FxHashSet<ShapeId> = order.iter().copied().collect();
        let (mut at, mut nodes) = (0, Vec::new());
        while let Some(&shape) = order.get(at) {
            at += 1;
            let Some(s) = self.graph.shape(shape) else { continue };
            let masks = s.paints.iter().map(|(m, _)| *m);
            let inner = self.calls(&[s.value], &mut nodes).map(|(s, _)| s).chain(masks);
            for shape in inner.collect::<Vec<_>>() {
                if seen.insert(shape) {
                    order.push(shape);
                }
            }
        }
        // A shape's users have larger indices.
        order.sort_unstable_by(|a, b| b.cmp(a));
        for shape in order {
            let (Some(domain), Some(s)) = (self.domains.get(&shape).cloned(), self.graph.shape(shape)) else {
                continue;
            };
            let (value, paints) = (s.value, s.paints.clone());
            for (mask, _) in paints.iter() {
                self.widen(*mask, domain.clone());
            }
            self.visit(value, &domain);
        }
    }

    /// Widens the domains of the shapes that a formula calls, each by what it is asked for: behind a region, only near it.
    pub(super) fn visit(&mut self, node: NodeId, domain: &Domain) {
        if !self.graph.reads(node).shapes {
            return;
        }
        match self.graph.node(node).clone() {
            Node::Op(op @ (Op::Min | Op::Max), args) => {
                let near = if op == Op::Max { self.narrowed(node, domain) } else { None };
                let inner = near.as_ref().map_or(domain, |(d, _, _)| d).clone();
                let cut = if op == Op::Max { self.cut(node, &inner) } else { None };
                for &arg in args.iter() {
                    match &cut {
                        Some(cut) if cut.wild == arg => self.visit(arg, &cut.domain),
                        _ => self.visit(arg, &inner),
                    }
                }
            }
            Node::Op(Op::Neg, args) | Node::Claim(args, Claim::Continuous) => {
                if let Some(arg) = args.first() {
                    self.visit(*arg, domain);
                }
            }
            Node::Op(Op::Select, args) if args.first().is_some_and(|c| self.is_uniform(*c)) => {
                for arg in args.iter().skip(1) {
                    self.visit(*arg, domain);
                }
            }
            Node::Call(_, Function::Field, _) => {
                let near = self.narrowed(node, domain);
                let inner = near.as_ref().map_or(domain, |(d, _, _)| d).clone();
                self.visit_all(node, &inner);
            }
            _ => self.visit_all(node, domain),
        }
    }

    pub(super) fn visit_all(&mut self, node: NodeId, domain: &Domain) {
        let mut nodes = Vec::new();
        self.graph.calling(&[node], &mut nodes);
        // What is made of the calls does not matter, where they ask does.
        for id in nodes {
            let Node::Call(inner, _, args) = self.graph.node(id) else { continue };
            let (inner, args) = (*inner, args.clone());
            let ranges: SmallVec<[Interval; 4]> = args.iter().map(|&a| self.facts.near_range(self.graph, a, domain, NEAR)).collect();
            let variables = self.graph.shape(inner).map(|s| s.variables.clone()).unwrap_or_default();
            let mut own = crate::analysis::call_domain(&variables, &ranges);
            own.narrowed = domain.narrowed;
            // What stands at the same point is within the same.
            let here = |(i, a): (usize, &NodeId)| *self.graph.node(*a) == Node::Leaf(Leaf::P(i as u8));
            if args.iter().take(3).enumerate().all(here) {
                own.within.clone_from(&domain.within);
            }
            self.widen(inner, own);
        }
    }

    /// Of an intersection of two what is left where the other cuts nothing off: it is below zero all over the box that holds the solid of what is
    /// left, wherever sliders stand and at any time. A hole beside its solid is such a one. Both have the same surface, so what follows the surface
    /// need not look at it; the field is another away from it, and stays.
    pub(super) fn without_absorbed(&mut self, node: NodeId, domain: &Domain) -> Option<NodeId> {
        if !self.facts.rules.has(Rule::Absorbed) {
            return None;
        }
        let key = (node, domain.key());
        if let Some(known) = self.found.absorbed.get(&key) {
            return *known;
        }
        let Node::Op(Op::Max, args) = self.graph.node(node) else { return None };
        let (a, b) = (*args.first()?, *args.get(1)?);
        let left = [(a, b), (b, a)].into_iter().find(|&(left, other)| self.is_absorbed(other, left, domain));
        if let Some((_, other)) = left {
            self.built.absorbed.insert((node, other));
        }
        let left = left.map(|(left, _)| left);
        self.found.absorbed.insert(key, left);
        left
    }

    fn is_absorbed(&mut self, node: NodeId, by: NodeId, domain: &Domain) -> bool {
        // What is no shape and no part of one only says where another one is looked at.
        if !self.graph.reads(node).shapes || !self.graph.reads(by).shapes {
            return false;
        }
        // Far away an operand may say more than one that is divided by its constant; a hole says nothing there.
        let hole = matches!(self.graph.node(node), Node::Op(Op::Neg, _));
        if !hole && self.rough_constant(by, &domain.at(Box3::ALL)) > UNIT {
            return false;
        }
        if self.found.absorbing > ABSORBING {
            return false;
        }
        let first = self.facts.account.ran;
        let solid = self.facts.outline(self.graph, by).intersect(&domain.point);
        let holds = !solid.is_empty() && solid.is_finite() && solid != domain.point && self.facts.range(self.graph, node, &domain.at(solid)).hi < 0.0;
        self.found.absorbing += self.facts.account.ran - first;
        holds
    }

    /// For an intersection or a moved shape that has no constant over all space: its region, how far beyond it is trusted, and the domain
    /// that its parts then need. None where it needs no region.
    pub(super) fn narrowed(&mut self, node: NodeId, domain: &Domain) -> Option<Narrowed> {
        let key = (node, domain.key(), domain.narrowed);
        if let Some(known) = self.found.regions.get(&key) {
            return known.clone();
        }
        let found = self.find_narrowed(node, domain);
        self.found.regions.insert(key, found.clone());
        found
    }

    pub(super) fn find_narrowed(&mut self, node: NodeId, domain: &Domain) -> Option<Narrowed> {
        let everywhere = domain.at(Box3::ALL);
        let unbounded = match self.graph.node(node).clone() {
            Node::Call(_, _, args) => {
                let point = args.get(..3).unwrap_or(&args);
                self.facts.map_constant(self.graph, point, &everywhere, 1).lipschitz > STEEPEST
            }
            Node::Op(_, args) => args.iter().any(|&a| {
                self.rough_constant(a, &everywhere) > STEEPEST && self.facts.constant(self.graph, a, &everywhere, 1).lipschitz > STEEPEST
            }),
            _ => false,
        };
        if !unbounded {
            return None;
        }
        let (region, reach) = self.region_of(node, domain)?;
        if region == domain.point {
            return None;
        }
        let inner = Domain { narrowed: true, ..domain.at(region.grow(reach)) };
        Some((inner, region, reach))
    }

    /// A constant over all space that follows from those of the parts: found at once, and no smaller than what a look at the whole finds.
    fn rough_constant(&mut self, node: NodeId, everywhere: &Domain) -> f64 {
        let key = (node, everywhere.key());
        if let Some(known) = self.found.rough.get(&key) {
            return *known;
        }
        self.found.deep += 1;
        if self.found.deep > DEEP {
            let (value, key) = (|graph: &Graph, shape| graph.shape(shape).map(|s| s.value), Domain::of(Box3::ALL).key());
            let known = |shape| value(self.graph, shape).is_none_or(|value| self.found.rough.contains_key(&(value, key.clone())));
            for shape in self.graph.called_below(node, known) {
                if let Some(value) = value(self.graph, shape) {
                    self.rough_constant(value, &Domain::of(Box3::ALL));
                }
            }
        }
        let found = match self.graph.node(node).clone() {
            Node::Constant(_) => 0.0,
            Node::Op(Op::Min | Op::Max, args) => args.iter().map(|a| self.rough_constant(*a, everywhere)).fold(0.0, f64::max),
            Node::Op(Op::Add | Op::Sub, args) => args.iter().map(|a| self.rough_constant(*a, everywhere)).sum(),
            Node::Op(Op::Neg | Op::Abs, args) | Node::Claim(args, Claim::Continuous) => {
                args.first().map_or(f64::INFINITY, |a| self.rough_constant(*a, everywhere))
            }
            Node::Call(shape, Function::Field, args) => self.rough_of_call(shape, &args, everywhere).unwrap_or_else(|| {
                self.facts.constant(self.graph, node, everywhere, 1).lipschitz
            }),
            _ => self.facts.constant(self.graph, node, everywhere, 1).lipschitz,
        };
        self.found.deep -= 1;
        self.found.rough.insert(key, found);
        found
    }

    /// The same of a shape at a moved point: how the point moves, times what is known of the shape. None where its variables count.
    fn rough_of_call(&mut self, shape: ShapeId, args: &[NodeId], everywhere: &Domain) -> Option<f64> {
        let s = self.graph.shape(shape)?;
        let (value, exact) = (s.value, s.exactness == Exactness::Exact);
        let moving = args.iter().skip(3).any(|a| self.graph.reads(*a).point || self.graph.reads(*a).shapes);
        if moving || (!exact && args.len() > 3) {
            return None;
        }
        let inner = if exact { 1.0 } else { self.rough_constant(value, &Domain::of(Box3::ALL)) };
        Some(inner * self.facts.map_constant(self.graph, args.get(..3)?, everywhere, 1).lipschitz)
    }

    /// For an intersection of something wild with something tame: the wild operand need only hold near the tame one, if there it is less
    /// steep by much. Unlike a box the tame one may leave out an axis, or a hole.
    pub(super) fn cut(&mut self, node: NodeId, domain: &Domain) -> Option<Cut> {
        let key = (node, domain.key());
        if let Some(known) = self.found.cuts.get(&key) {
            return known.clone();
        }
        let found = self.find_cut(node, domain);
        self.found.cuts.insert(key, found.clone());
        found
    }

    fn find_cut(&mut self, node: NodeId, domain: &Domain) -> Option<Cut> {
        if !self.facts.rules.has(Rule::Cut) {
            return None;
        }
        let args = self.graph.arguments(node).to_vec();
        let &[a, b] = args.as_slice() else { return None };
        if !domain.point.is_finite() {
            return None;
        }
        let everywhere = Domain { within: Vec::new(), ..domain.at(Box3::ALL) };
        for (wild, tame) in [(a, b), (b, a)] {
            if self.rough_constant(wild, &everywhere) <= STEEPEST {
                continue;
            }
            let of_tame = self.facts.constant(self.graph, tame, &everywhere, 1);
            if of_tame.lipschitz > UNIT || of_tame.jumps || self.graph.reads(tame).variables != 0 {
                continue;
            }
            if self.facts.constant(self.graph, wild, &everywhere, 1).lipschitz <= STEEPEST {
                continue;
            }
            // What moves a shape is judged by itself: the shape has a bound of its own.
            let moves = match self.graph.node(wild).clone() {
                Node::Call(_, Function::Field, args) => {
                    let here = |(i, a): (usize, &NodeId)| *self.graph.node(*a) == Node::Leaf(Leaf::P(i as u8));
                    let point = args.get(..3).unwrap_or(&args).to_vec();
                    (!point.iter().enumerate().all(here)).then_some(point)
                }
                _ => None,
            };
            if let Some(point) = moves
                && self.facts.map_constant(self.graph, &point, domain, BUDGET).lipschitz <= STEEP
            {
                continue;
            }
            let formula = match self.graph.node(wild) {
                Node::Call(shape, ..) => self.graph.shape(*shape).map_or(wild, |shape| shape.value),
                _ => wild,
            };
            // What goes by cells is the same in all of them, and so near the tame operand.
            if self.graph.reads(formula).rounds && self.constant_of_a_cell(formula, domain).is_some_and(|found| found.lipschitz <= STEEP) {
                continue;
            }
            let whole = self.facts.constant(self.graph, wild, domain, BUDGET);
            if whole.lipschitz <= MILD {
                continue;
            }
            // What is not that steep is worth a shorter look and one level, and none where it is long.
            let wild_indeed = whole.lipschitz > STEEP;
            if !wild_indeed && self.facts.weight(self.graph, wild) > LONG {
                continue;
            }
            let (longer, levels) = if wild_indeed { (LONGER, 3) } else { (LONGER / 4, 1) };
            let (_, reach) = self.region_of(node, domain)?;
            // Nearer to the tame operand it may be gentler still.
            let mut found: Option<Cut> = None;
            let mut least = 0.85 * whole.lipschitz.min(STEEPEST);
            let farthest = self.facts.range(self.graph, tame, domain).hi;
            for level in [2.0 * reach, 0.5 * reach, 0.125 * reach].into_iter().take(levels) {
                // What leaves nothing out says nothing.
                if farthest <= level {
                    continue;
                }
                let mut near = domain.clone();
                near.within.push((tame, level));
                let here = self.constant_within(wild, &near, longer);
                if here.lipschitz < least {
                    least = 0.5 * here.lipschitz;
                    found = Some(Cut { wild, tame, level, domain: near });
                }
                if here.lipschitz < 2.0 {
                    break;
                }
            }
            if found.is_some() {
                return found;
            }
        }
        None
    }

    /// A constant over a domain; where what is steep is left out by conditions, it takes more boxes to see it.
    pub(super) fn constant_within(&mut self, node: NodeId, domain: &Domain, longer: usize) -> Constant {
        let first = self.facts.constant(self.graph, node, domain, BUDGET);
        // Such looks cost more than all else, and must not be the reason that the next formula gets no search at all.
        if domain.within.is_empty() || first.lipschitz <= GENTLE || !self.facts.account.has_leisure() {
            return first;
        }
        self.constant_of_more(node, domain, longer)
    }

    /// A constant over a domain that may cost so many times as many boxes as others.
    pub(super) fn constant_of_more(&mut self, node: NodeId, domain: &Domain, longer: usize) -> Constant {
        let steps = self.facts.account.steps;
        self.facts.account.steps *= longer;
        let found = self.facts.constant(self.graph, node, domain, BUDGET * longer);
        self.facts.account.steps = steps;
        found
    }

    /// Does what costs more than all else, and must not be the reason that the next formula gets no search: it is counted with all else that is done so.
    pub(super) fn aside<T>(&mut self, work: impl FnOnce(&mut Self) -> T) -> T {
        self.facts.account.turn_aside();
        let done = work(self);
        self.facts.account.turn_aside();
        done
    }

    /// The same for a map of points.
    pub(super) fn map_of_more(&mut self, point: &[NodeId], domain: &Domain, longer: usize) -> Constant {
        let steps = self.facts.account.steps;
        self.facts.account.steps *= longer;
        let found = self.facts.map_constant(self.graph, point, domain, BUDGET * longer);
        self.facts.account.steps = steps;
        found
    }

    /// The bound of what is wild, no longer than the way out of the part in which it holds: the distance to there is at least the level less
    /// the value of the tame operand, which is no steeper than one.
    pub(super) fn kept_within(&mut self, cut: &Cut, bound: NodeId) -> NodeId {
        let level = self.graph.constant(cut.level);
        let room = self.graph.op(Op::Sub, &[level, cut.tame]);
        self.graph.op(Op::Min, &[bound, room])
    }

    pub(super) fn widen(&mut self, shape: ShapeId, domain: Domain) {
        let wider = match self.domains.get(&shape) {
            Some(known) => known.hull(&domain),
            None => domain,
        };
        self.domains.insert(shape, wider);
    }

    pub(super) fn domain(&self, shape: ShapeId) -> Domain {
        self.domains.get(&shape).cloned().unwrap_or(Domain::of(Box3::cube(self.scene.extent)))
    }

    /// Where a formula is solid within its domain, and how far beyond that it is trusted. None where it is nowhere solid.
    pub(super) fn region_of(&mut self, node: NodeId, domain: &Domain) -> Option<(Box3, f64)> {
        let region = self.facts.solid_region(self.graph, node, domain);
        if region.is_empty() {
            return None;
        }
        // Rounded up, so that the text of the module is short and the box surely holds the solid.
        let unit = 2f64.powf((region.size().max(1e-3)).log2().floor() - 9.0);
        let rounded = Box3(region.0.map(|i| {
            Interval::new((i.lo / unit).floor() * unit, (i.hi / unit).ceil() * unit)
        }))
        .intersect(&domain.point);
        // A thin solid does not get a thick coat, in which it would be as steep as far from its axis.
        let narrowest = rounded.0.iter().map(|i| i.width()).fold(f64::INFINITY, f64::min);
        let thick = rounded.size().min(2.0 * narrowest).max(0.1 * rounded.size());
        let reach = (0.05 * thick).max(1e-4);
        let reach = (reach / unit).ceil() * unit;
        Some((rounded, reach))
    }

    /// Where a map only turns points about an axis: how far from it the solid of the shape reaches, which the turn does not change. None where
    /// that says no more than the region does.
    pub(super) fn tube(&mut self, inner: ShapeId, point: &[NodeId], region: &Box3) -> Option<(usize, f64)> {
        if !self.facts.rules.has(Rule::Tube) {
            return None;
        }
        let turned = |graph: &Graph, axis: usize| {
            let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
            let is = |node: Option<&NodeId>, k: usize| {
                node.is_some_and(|n| matches!(graph.node(*n), Node::Leaf(Leaf::P(c)) if usize::from(*c) == k))
            };
            let parts = |k: usize| match point.get(k).map(|n| graph.node(*n)) {
                Some(Node::Op(op @ (Op::TurnU | Op::TurnV), args)) => Some((*op, args.to_vec())),
                _ => None,
            };
            let (Some((first, a)), Some((second, b))) = (parts(i), parts(j)) else { return false };
            let of_both = is(a.first(), i) && is(a.get(1), j) || is(a.first(), j) && is(a.get(1), i);
            first != second && a == b && of_both
        };
        let axis = (0..3).find(|&axis| turned(self.graph, axis))?;
        let value = self.graph.shape(inner)?.value;
        let own = self.domain(inner);
        let solid = self.facts.solid_region(self.graph, value, &own);
        let far = |i: usize| solid.axis((axis + i) % 3).magnitude();
        let radius = far(1).hypot(far(2));
        // Rounded up, so that the text is short.
        let unit = 2f64.powf(radius.max(1e-3).log2().floor() - 9.0);
        let radius = (radius / unit).ceil() * unit;
        let corner = |i: usize| region.axis((axis + i) % 3).magnitude();
        (!solid.is_empty() && radius < 0.95 * corner(1).hypot(corner(2))).then_some((axis, radius))
    }
}
