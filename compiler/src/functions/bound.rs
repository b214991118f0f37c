//! How far a ray may step: operands one by one, groups as a whole, each over its Lipschitz factor and behind its region where it needs one.

use crate::analysis::search::{ROUNDING, Search, Target};
use crate::analysis::{Box3, Constant, Domain, has_cells};
use crate::diagnostic::{Code, Diagnostic};
use crate::functions::bound_strategy::{BoundStrategy, Known, Over};
use crate::functions::builder::Builder;
use crate::functions::domains::LONGER;
use crate::functions::limits::{BUDGET, GENTLE, LONG, SAMPLES, STEEPEST, UNIT};
use crate::functions::made::Kind;
use crate::functions::measured_fallback::DEAR;
use crate::graph::kernel::Op;
use crate::graph::{Claim, Exactness, FAR, Factor, Function, Leaf, Node, NodeId, Proof, ShapeId};
use crate::prelude::in_prelude;
use crate::rules::Rule;

/// No formula may be steeper than this, though it is gentle at its surface: 32 bits can't hold what its bound is made of.
const STEEPEST_OF_ALL: f64 = 1e7;
/// A measured factor above this may cost a ray more steps than it has.
const SLOW: f64 = 100.0;

/// A part of a group whose constant is this much of the group's makes it steep.
const BLAMED: f64 = 0.9;

impl Builder<'_> {
    /// How far a ray may step by a formula of a shape. `continuous`: jumps of the formula itself cancel.
    pub(super) fn bound(&mut self, shape: ShapeId, node: NodeId, domain: &Domain, continuous: bool) -> NodeId {
        if self.is_exact(shape, node) {
            self.kind = self.kind.max(Kind::Exact);
            return node;
        }
        match self.graph.node(node).clone() {
            Node::Constant(_) => node,
            // What jumps by itself, and hardly beside the others, is a group.
            Node::Op(Op::Min | Op::Max, _) if !continuous && self.meets_at_walls(node, domain) => {
                self.normalised(shape, node, domain, continuous)
            }
            Node::Op(Op::Max, _) if let Some(left) = self.without_absorbed(node, domain) => self.bound(shape, left, domain, continuous),
            Node::Op(op @ (Op::Min | Op::Max), args) => {
                let near = if op == Op::Max { self.narrowed(node, domain) } else { None };
                let inner = near.as_ref().map_or(domain, |(d, _, _)| d);
                let cut = if op == Op::Max { self.cut(node, inner) } else { None };
                let args: Vec<NodeId> = args
                    .iter()
                    .map(|&a| match &cut {
                        Some(cut) if cut.wild == a => {
                            let bound = self.bound(shape, a, &cut.domain, continuous);
                            self.kept_within(cut, bound)
                        }
                        _ => self.bound(shape, a, inner, continuous),
                    })
                    .collect();
                let value = self.graph.op(op, &args);
                match near {
                    Some((_, region, reach)) => self.behind(region, None, reach, value),
                    None => value,
                }
            }
            Node::Op(Op::Neg, args) => {
                let inner = args.first().map_or(node, |a| self.bound(shape, *a, domain, continuous));
                self.graph.op(Op::Neg, &[inner])
            }
            Node::Op(Op::Select, args) if args.first().is_some_and(|c| self.is_uniform(*c)) => {
                let (Some(&c), Some(&a), Some(&b)) = (args.first(), args.get(1), args.get(2)) else {
                    return node;
                };
                if self.blends_more(a, b) {
                    return self.normalised(shape, node, domain, continuous);
                }
                let a = self.bound(shape, a, domain, continuous);
                let b = self.bound(shape, b, domain, continuous);
                self.graph.op(Op::Select, &[c, a, b])
            }
            Node::Op(Op::Add | Op::Sub, _) if let Some(apart) = self.moved_apart(node) => self.bound(shape, apart, domain, continuous),
            // A positive multiple has the same zero set.
            Node::Op(op @ (Op::Mul | Op::Div), args) => {
                let (Some(&a), Some(&b)) = (args.first(), args.get(1)) else { return node };
                let (inner, factor) = if self.is_uniform(b) {
                    (a, b)
                } else if op == Op::Mul && self.is_uniform(a) {
                    (b, a)
                } else {
                    return self.normalised(shape, node, domain, continuous);
                };
                let range = self.facts.live_range(self.graph, factor);
                if op == Op::Mul
                    && range.lo > 0.0
                    && let Some(scaled) = self.scaled_call(factor, inner, domain, Function::Bound)
                {
                    return scaled;
                }
                let has_parts = self.has_parts(inner) && !self.is_stretched_back(node, inner, domain);
                if has_parts && range.lo > 0.0 {
                    self.bound(shape, inner, domain, continuous)
                } else if has_parts && range.hi < 0.0 {
                    let inner = self.bound(shape, inner, domain, continuous);
                    self.graph.op(Op::Neg, &[inner])
                } else {
                    self.normalised(shape, node, domain, continuous)
                }
            }
            Node::Claim(args, Claim::Continuous) => {
                args.first().map_or(node, |a| self.bound(shape, *a, domain, true))
            }
            Node::Call(inner, Function::Field, args) => {
                self.bound_of_call(shape, node, inner, &args, domain, continuous)
            }
            Node::Claim(args, Claim::Lipschitz(formula, groups, _)) if self.facts.rules.has(Rule::GroupBounds) => self
                .by_bounds(shape, node, &args, (formula, &groups), domain)
                .unwrap_or_else(|| self.normalised(shape, node, domain, continuous)),
            _ => self.normalised(shape, node, domain, continuous),
        }
    }

    /// A union or an intersection that a number is added to, as the union of what it is added to: `min(a, b) - r` is `min(a - r, b - r)`. So each
    /// operand has a bound and a region of its own. None of what has a bound over all space as it is.
    fn moved_apart(&mut self, node: NodeId) -> Option<NodeId> {
        let (op, joined, by) = self.moved(node)?;
        if self.facts.constant(self.graph, joined, &Domain::of(Box3::ALL), 1).is_within(STEEPEST) {
            return None;
        }
        let Node::Op(joins, parts) = self.graph.node(joined).clone() else { return None };
        let parts: Vec<NodeId> = parts.iter().map(|&part| self.graph.op(op, &[part, by])).collect();
        Some(self.graph.op(joins, &parts))
    }

    /// A union or an intersection, and the number that is added to it or taken from it.
    fn moved(&self, node: NodeId) -> Option<(Op, NodeId, NodeId)> {
        let Node::Op(op @ (Op::Add | Op::Sub), args) = self.graph.node(node) else { return None };
        let (joined, by) = match *args.as_ref() {
            [a, b] if self.is_uniform(b) => (a, b),
            [a, b] if *op == Op::Add && self.is_uniform(a) => (b, a),
            _ => return None,
        };
        matches!(self.graph.node(joined), Node::Op(Op::Min | Op::Max, _)).then_some((*op, joined, by))
    }

    /// Whether a multiple of a shape at a moved point is gentler than what moves the point: that may stretch by what the value is divided by.
    fn is_stretched_back(&mut self, multiple: NodeId, call: NodeId, domain: &Domain) -> bool {
        let Node::Call(_, Function::Field, args) = self.graph.node(call).clone() else { return false };
        let everywhere = domain.at(Box3::ALL);
        let map = self.facts.map_constant(self.graph, args.get(..3).unwrap_or(&args), &everywhere, 1).lipschitz;
        let whole = |builder: &mut Self| builder.facts.constant(builder.graph, multiple, &everywhere, 1);
        map > UNIT && whole(self).is_within(UNIT.max(BLAMED * map))
    }

    /// Whether a formula is put together of others, each of which has a bound of its own; by themselves a sign and a multiple put nothing together.
    fn has_parts(&self, node: NodeId) -> bool {
        match self.graph.node(node) {
            Node::Op(Op::Min | Op::Max | Op::Select, _) | Node::Call(..) | Node::Claim(_, Claim::Continuous) => true,
            Node::Op(Op::Neg, args) => args.first().is_some_and(|&a| self.has_parts(a)),
            Node::Op(Op::Add | Op::Sub, _) => self.moved(node).is_some(),
            Node::Op(Op::Mul | Op::Div, args) => match *args.as_ref() {
                [a, b] if self.is_uniform(b) => self.has_parts(a),
                [a, b] if self.is_uniform(a) => self.has_parts(b),
                _ => false,
            },
            _ => false,
        }
    }

    /// Whether one side of a choice is the other one blended with more. By themselves the two would ask for the same shape by two functions, and
    /// a chain of such choices would ask for what is at its beginning as often as it is long.
    pub(super) fn blends_more(&mut self, a: NodeId, b: NodeId) -> bool {
        if matches!(self.graph.node(a), Node::Op(Op::Min | Op::Max | Op::Neg, _)) || !matches!(self.graph.node(b), Node::Call(..)) {
            return false;
        }
        let mut calls = Vec::new();
        self.graph.calling(&[a], &mut calls);
        a != b && calls.contains(&b)
    }

    /// A function of a shape that is scaled as a whole, `k s(p / k)`: it is scaled in the same way. None where the map does more than that.
    pub(super) fn scaled_call(
        &mut self,
        factor: NodeId,
        call: NodeId,
        domain: &Domain,
        function: Function,
    ) -> Option<NodeId> {
        let Node::Call(shape, Function::Field, args) = self.graph.node(call).clone() else { return None };
        let everywhere = domain.at(Box3::ALL);
        let moving = args.iter().skip(3).any(|v| {
            self.facts.constant(self.graph, *v, &everywhere, 1).lipschitz > 0.0
        });
        let point = args.get(..3)?;
        let numerators: Option<Vec<NodeId>> = point
            .iter()
            .map(|&q| match self.graph.node(q) {
                Node::Op(Op::Div, parts) if parts.get(1) == Some(&factor) => parts.first().copied(),
                _ if self.graph.as_constant(q) == Some(0.0) => Some(q),
                _ => None,
            })
            .collect();
        let scaled: Vec<NodeId> = match numerators {
            Some(numerators) => numerators,
            None => {
                self.graph.as_constant(factor)?;
                point.iter().map(|&q| self.graph.op(Op::Mul, &[factor, q])).collect()
            }
        };
        let map = self.facts.map_constant(self.graph, &scaled, &everywhere, 1);
        if moving || map.jumps || map.lipschitz > UNIT {
            return None;
        }
        if !self.facts.is_rigid(self.graph, &scaled) {
            self.kind = self.kind.max(Kind::Lipschitz);
            let whole = self.graph.op(Op::Mul, &[factor, call]);
            if function == Function::Distance && let Some(stretched) = self.stretched_distance(whole, &scaled) {
                return Some(stretched);
            }
        }
        let inner = self.graph.call(shape, function, &args);
        Some(self.graph.op(Op::Mul, &[factor, inner]))
    }

    /// The bound of another shape at a moved point.
    pub(super) fn bound_of_call(
        &mut self,
        shape: ShapeId,
        node: NodeId,
        inner: ShapeId,
        args: &[NodeId],
        domain: &Domain,
        continuous: bool,
    ) -> NodeId {
        let point = args.get(..3).unwrap_or(args);
        let moved = args.get(3..).unwrap_or(&[]);
        let everywhere = domain.at(Box3::ALL);
        if moved.iter().any(|&v| {
            let c = self.facts.constant(self.graph, v, &everywhere, 1);
            c.lipschitz > 0.0
        }) {
            return self.normalised(shape, node, domain, continuous);
        }
        let all = self.facts.map_constant(self.graph, point, &everywhere, 1);
        let all = self.by_counts(point, all, |facts, graph, point| facts.map_constant(graph, point, &everywhere, 1));
        if all.jumps && !continuous {
            return self.normalised(shape, node, domain, continuous);
        }
        let call = self.graph.call(inner, Function::Bound, args);
        if all.lipschitz <= UNIT {
            if !self.facts.is_rigid(self.graph, point) {
                self.kind = self.kind.max(Kind::Lipschitz);
            }
            return call;
        }
        let of_map = |constant: &Constant, domain: Domain, proof: Proof| Known {
            lipschitz: constant.lipschitz,
            proof,
            search: Some((Target::Map(point.to_vec()), domain)),
        };
        // Of noise a region has but a few cells, each of which can be looked at.
        let cells = all.lipschitz > GENTLE && has_cells(self.graph, point);
        let bounded = |builder: &mut Self| builder.region_of(node, domain).is_some_and(|(region, _)| region != domain.point);
        if all.lipschitz <= STEEPEST && !(cells && bounded(self)) {
            self.kind = self.kind.max(Kind::Lipschitz);
            return self.scaled(call, of_map(&all, everywhere, Proof::Proven), node, shape);
        }
        let Some((region, reach)) = self.region_of(node, domain) else { return self.graph.constant(FAR) };
        let tube = self.tube(inner, point, &region);
        let tube_and_reach = tube.map(|(axis, radius)| (axis, radius + reach));
        let near = Domain { tube: tube_and_reach, ..domain.at(region.grow(reach)) };
        let constant = self.facts.map_constant(self.graph, point, &near, BUDGET);
        let constant = self.by_counts(point, constant, |facts, graph, point| facts.map_constant(graph, point, &near, BUDGET));
        let mut constant = constant;
        if constant.lipschitz > DEAR {
            let more = self.aside(|builder| builder.map_of_more(point, &near, LONGER));
            constant.lipschitz = constant.lipschitz.min(more.lipschitz);
        }
        if constant.lipschitz > STEEPEST || self.is_dear(node, &near, constant.lipschitz) {
            return self.normalised(shape, node, domain, continuous);
        }
        let known = of_map(&constant, near, Proof::Derived);
        if region == domain.point && domain.narrowed {
            return self.scaled(call, known, node, shape);
        }
        if region == domain.point {
            self.extent_used(shape, node);
        }
        let inside = self.scaled(call, known, node, shape);
        let inside = if region == domain.point && tube.is_none() { self.in_zones(inside, call, point, &domain.at(region), node, shape) } else { inside };
        self.behind(region, tube, reach, inside)
    }

    /// A formula over its constant, behind its region where it needs one.
    pub(super) fn normalised(&mut self, shape: ShapeId, node: NodeId, domain: &Domain, continuous: bool) -> NodeId {
        let (node, strategy) = match self.treated(shape, node, domain, continuous) {
            Some(treated) => treated,
            None => match self.measured(shape, node, domain) {
                Some(strategy) => (node, strategy),
                None => return node,
            },
        };
        if let Some(parts) = self.by_operands(shape, node, domain, continuous, &strategy) {
            return parts;
        }
        self.over_its_constant(shape, node, domain, continuous, strategy)
    }

    /// A formula over a constant of its own, behind its region where it has one.
    pub(super) fn over_its_constant(&mut self, shape: ShapeId, node: NodeId, domain: &Domain, continuous: bool, strategy: BoundStrategy) -> NodeId {
        let strategy = self.affordable(shape, node, domain, strategy);
        self.kind = self.kind.max(if self.is_exact(shape, node) { Kind::Exact } else { Kind::Lipschitz });
        let mut value = if (strategy.constant - 1.0).abs() <= 1e-6 {
            match strategy.region.is_none() && !self.is_exact(shape, node) {
                true => self.convex_way(node, domain).inspect(|_| self.kind = self.kind.max(Kind::Bound)).unwrap_or(node),
                false => node,
            }
        } else {
            let at = strategy.holds_in(domain);
            let uneven = match strategy.proof {
                Proof::Derived if at.point.is_finite() => self.uneven(node, &at, strategy.constant).filter(|u| !u.is_unknown()),
                _ => None,
            };
            let cell = if strategy.over == Over::Cell { self.one_cell(node, &at) } else { None };
            let (sought, at) = cell.map_or((node, at), |cell| (cell.0, cell.1.clone()));
            let known = Known {
                lipschitz: strategy.constant,
                proof: strategy.proof,
                search: (strategy.proof != Proof::Measured).then_some((Target::Value(sought), at)),
            };
            let factor = self.factor(known, node, shape);
            let way = self.times(node, factor);
            match uneven {
                Some(uneven) => {
                    let steps = self.steps_over_slope(node, &strategy.holds_in(domain), strategy.constant, &uneven);
                    self.built.gentle.insert(factor, steps);
                    self.gentler_way(node, way, &uneven)
                }
                None => way,
            }
        };
        if strategy.jumps && !continuous {
            value = self.stop_at_jumps(shape, node, value, domain, &strategy);
        }
        match strategy.region {
            Some((region, reach)) => self.behind(region, None, reach, value),
            None => value,
        }
    }

    /// Where nothing finite is proven: what 99 of 100 samples do not exceed, and half as much again. None where not even samples help.
    pub(super) fn measured(&mut self, shape: ShapeId, node: NodeId, domain: &Domain) -> Option<BoundStrategy> {
        let span = self.place(shape, node);
        let region = self.region_of(node, domain);
        let term = self.facts.steep_term(self.graph, node, domain, STEEPEST);
        let (at, why, instead) = match &term {
            Some(term) if self.parts_of_waves(node, term.node) => (
                self.graph.location(term.node).unwrap_or(span),
                "a parameter that need not be whole multiplies an angle, and part of a wave ends in a jump",
                "write `param n: int = 6` for what multiplies the angle: then whole waves go round",
            ),
            Some(term) => (self.graph.location(term.node).unwrap_or(span), term.why(), term.instead(domain.narrowed)),
            None => (span, "it grows without a limit that is known", "keep the shape within a region with `.within(box(…))`"),
        };
        let Some((region, reach)) = region else {
            let region = Some((Box3::EMPTY, 0.0));
            return Some(BoundStrategy { constant: 1.0, jumps: false, region, proof: Proof::Proven, over: Over::Region });
        };
        let near = domain.at(region.grow(reach).intersect(&Box3::cube(self.scene.extent)));
        let mut steepest = self.facts.sampled_constant(self.graph, node, &near, SAMPLES);
        if !steepest.is_finite() {
            // Of a shape that moves no slope may be known anywhere.
            steepest = self.slope_by_differences(node, &near, 0.99).unwrap_or(steepest);
        }
        // So steep that a ray would not get anywhere.
        let finite = steepest > 0.0 && steepest < 100.0 * STEEPEST;
        let (code, message) = if !finite {
            (Code::NoBound, format!("no finite bound is known for this formula, so no ray could step safely: {why}"))
        } else if self.scene.strict {
            (Code::NoBound, format!("no bound is proven for this formula: {why}"))
        } else if steepest > SLOW {
            let message = "no bound is proven for this formula, and it is so steep where samples lie that rays may stop on their way and leave holes";
            (Code::Unproven, format!("{message}: {why}"))
        } else {
            (Code::Unproven, format!("no bound is proven for this formula; it is drawn with a measured factor: {why}"))
        };
        self.diagnostics.push(Diagnostic::new(code, at, message, self.own_noise(node).unwrap_or(instead)));
        self.kind = self.kind.max(Kind::Unproven);
        finite.then_some(BoundStrategy {
            constant: 1.5 * steepest,
            jumps: self.facts.constant(self.graph, node, &near, 1).jumps,
            region: Some((region, reach)),
            proof: Proof::Measured,
            over: Over::Region,
        })
    }

    pub(super) fn is_exact(&self, shape: ShapeId, node: NodeId) -> bool {
        self.graph
            .shape(shape)
            .is_some_and(|s| s.value == node && s.exactness == Exactness::Exact)
    }

    /// What a formula needs in order to be a bound; none where nothing finite is known.
    pub(super) fn strategy(
        &mut self,
        shape: ShapeId,
        node: NodeId,
        domain: &Domain,
        continuous: bool,
    ) -> Option<BoundStrategy> {
        let key = (shape, node, domain.key(), continuous);
        if let Some(known) = self.found.strategies.get(&key) {
            return *known;
        }
        let found = self.find_treatment(shape, node, domain, continuous);
        self.found.strategies.insert(key, found);
        found
    }

    pub(super) fn find_treatment(
        &mut self,
        shape: ShapeId,
        node: NodeId,
        domain: &Domain,
        continuous: bool,
    ) -> Option<BoundStrategy> {
        let everywhere = domain.at(Box3::ALL);
        let mut all = self.facts.constant(self.graph, node, &everywhere, 1);
        if self.is_exact(shape, node) {
            all = Constant { lipschitz: 1.0, jumps: false };
        }
        if all.lipschitz == 0.0 {
            // The same everywhere: any step is right, and so is this.
            return Some(BoundStrategy { constant: 1.0, jumps: all.jumps, region: None, proof: Proof::Proven, over: Over::Space });
        }
        let claimed = matches!(self.graph.node(node), Node::Claim(_, Claim::Lipschitz(..)));
        let mut by_rule = if claimed { Proof::Claimed } else { Proof::Proven };
        let plain = all.lipschitz.is_finite() && (!all.jumps || continuous);
        if plain && all.lipschitz > UNIT && !claimed {
            // What repeats, and what is a sum, can be searched over all space.
            all = self.facts.constant(self.graph, node, &everywhere, BUDGET);
            all = self.constant_by_counts(node, &everywhere, all);
            by_rule = Proof::Derived;
        }
        let gentle = all.lipschitz <= GENTLE || all.lipschitz <= 4.0 && self.facts.weight(self.graph, node) > LONG;
        if plain && gentle {
            return Some(BoundStrategy { constant: all.lipschitz, jumps: false, region: None, proof: by_rule, over: Over::Space });
        }
        // A region of its own: tighter, or the only way.
        let Some((region, reach)) = self.region_of(node, domain) else {
            // Nothing solid in the extent.
            let region = Some((Box3::EMPTY, 0.0));
            return Some(BoundStrategy { constant: 1.0, jumps: false, region, proof: Proof::Proven, over: Over::Region });
        };
        let bounded = region != domain.point;
        let near = domain.at(region.grow(reach));
        let (constant, in_a_cell) = self.constant_near(node, &near, all.jumps);
        let constant = if in_a_cell { constant } else { self.constant_by_counts(node, &near, constant) };
        // What is that steep in few places needs the region in which the others are known.
        let is_uneven = bounded && all.lipschitz > DEAR && self.uneven(node, &near, constant.lipschitz).is_some_and(|uneven| !uneven.is_unknown());
        if plain && all.lipschitz <= STEEPEST && !is_uneven && (!bounded || constant.lipschitz > 0.85 * all.lipschitz) {
            return Some(BoundStrategy { constant: all.lipschitz, jumps: false, region: None, proof: by_rule, over: Over::Space });
        }
        if constant.lipschitz > STEEPEST_OF_ALL || constant.lipschitz.is_nan() {
            return None;
        }
        // What is gentle at its surface may be steeper elsewhere.
        if constant.lipschitz > STEEPEST && self.uneven(node, &near, constant.lipschitz).is_none_or(|u| u.gentlest() > STEEPEST) {
            return None;
        }
        if !bounded && !domain.narrowed && !all.lipschitz.is_finite() {
            self.extent_used(shape, node);
        }
        let needed = bounded || !domain.narrowed && !all.lipschitz.is_finite();
        let lipschitz = constant.lipschitz.max(1e-6);
        Some(BoundStrategy {
            constant: lipschitz,
            jumps: constant.jumps && !continuous,
            region: needed.then_some((region, reach)),
            proof: Proof::Derived,
            over: if in_a_cell { Over::Cell } else { Over::Region },
        })
    }

    fn constant_by_counts(&mut self, node: NodeId, domain: &Domain, known: Constant) -> Constant {
        self.by_counts(&[node], known, |facts, graph, of| of.iter().map(|&node| facts.constant(graph, node, domain, BUDGET)).next().unwrap_or(known))
    }

    /// Whether an angle of a formula is multiplied by a parameter that need not be whole.
    fn parts_of_waves(&self, node: NodeId, angle: NodeId) -> bool {
        let is_loose = |id: NodeId| matches!(self.graph.node(id), Node::Leaf(Leaf::Parameter(i)) if self.graph.parameters.get(*i as usize).is_some_and(|p| !p.whole));
        let multiplies = |id: NodeId| match self.graph.node(id) {
            Node::Op(Op::Mul, args) => args.contains(&angle) && args.iter().any(|&a| is_loose(a)),
            _ => false,
        };
        matches!(self.graph.node(angle), Node::Op(Op::Atan2, _)) && self.graph.reachable(&[node]).into_iter().any(multiplies)
    }

    /// `inside` near the region, the distance to the region beyond; the region is cut down to a tube about an axis where there is one.
    pub(super) fn behind(&mut self, region: Box3, tube: Option<(usize, f64)>, reach: f64, inside: NodeId) -> NodeId {
        if region.is_empty() {
            return self.graph.constant(FAR);
        }
        self.kind = self.kind.max(Kind::Bound);
        let Some(distance) = self.outside(region, tube) else { return inside };
        self.graph.name_node(distance, "outside");
        let limit = self.graph.constant(reach);
        let far = self.graph.op(Op::Lt, &[limit, distance]);
        self.graph.op(Op::Select, &[far, distance, inside])
    }

    /// The distance to a region outside of it; none where it is all of space.
    pub(super) fn outside(&mut self, region: Box3, tube: Option<(usize, f64)>) -> Option<NodeId> {
        let mut outside = Vec::new();
        if let Some((axis, radius)) = tube {
            let (point, zero) = (self.graph.point(), self.graph.constant(0.0));
            let across: Vec<NodeId> = (1..3).filter_map(|i| point.get((axis + i) % 3).copied()).collect();
            let from = self.graph.op(Op::Length2, &across);
            let radius = self.graph.constant(radius);
            let beyond = self.graph.op(Op::Sub, &[from, radius]);
            outside.push(self.graph.op(Op::Max, &[beyond, zero]));
        }
        let axes = (0..3).filter(|i| tube.is_none_or(|(axis, _)| axis == *i));
        outside.extend(self.graph.beyond(axes.map(|i| (i, region.axis(i)))));
        self.graph.together(&outside)
    }

    /// A value times the multiple of a factor for a constant.
    pub(super) fn scaled(&mut self, value: NodeId, constant: Known, at: NodeId, shape: ShapeId) -> NodeId {
        let factor = self.factor(constant, at, shape);
        self.times(value, factor)
    }

    fn times(&mut self, value: NodeId, factor: u32) -> NodeId {
        let factor = self.graph.intern(Node::Factor(factor));
        self.graph.op(Op::Mul, &[value, factor])
    }

    /// The part of a claimed group that makes it steep, which is what a person wants to see: of `wavy.extrude(1)` the waves in the drawing. The
    /// group itself where it is steep by itself.
    fn steep_within(&mut self, at: NodeId, shape: ShapeId, lipschitz: f64) -> (NodeId, ShapeId) {
        let mut found = (at, shape);
        let mut inside = match self.graph.node(at) {
            Node::Claim(args, Claim::Lipschitz(..)) => args.get(1..).unwrap_or_default().to_vec(),
            _ => return found,
        };
        let mut shape = shape;
        loop {
            let steep = |n: &NodeId| self.facts.constant(self.graph, *n, &Domain::of(Box3::ALL), 1).lipschitz;
            let constants: Vec<f64> = inside.iter().map(steep).collect();
            let steepest = inside.iter().zip(constants).max_by(|a, b| a.1.total_cmp(&b.1));
            let Some((&node, _)) = steepest.filter(|(_, c)| *c > BLAMED * lipschitz) else { return found };
            inside = match self.graph.node(node) {
                Node::Call(called, Function::Field, _) => {
                    shape = *called;
                    self.graph.shape(shape).map(|s| s.value).into_iter().collect()
                }
                Node::Op(Op::Min | Op::Max | Op::Select, args) => args.to_vec(),
                Node::Claim(args, Claim::Lipschitz(..)) => args.get(1..).unwrap_or_default().to_vec(),
                _ => Vec::new(),
            };
            if self.graph.location(node).is_some_and(|span| !in_prelude(span)) {
                found = (node, shape);
            }
        }
    }

    /// The factor for a constant, which may be there already: its index in the graph.
    fn factor(&mut self, constant: Known, at: NodeId, shape: ShapeId) -> u32 {
        let (at, shape) = self.steep_within(at, shape, constant.lipschitz);
        let span = self.place(shape, at);
        // Found by searching: a little is added for the rounding of the search itself.
        let lipschitz = constant.lipschitz * (1.0 + ROUNDING);
        let name = self
            .graph
            .node_name(at)
            .map(str::to_owned)
            .or_else(|| self.graph.shape(shape).and_then(|s| s.name.as_deref().map(str::to_owned)))
            .unwrap_or_else(|| "group".to_owned());
        let reason = match self.graph.node(at) {
            Node::Call(..) => "the point is moved by a map that stretches space",
            Node::Claim(..) => "a group that is known as a whole",
            _ => "a formula",
        };
        let factor = Factor { name, lipschitz, reason: reason.to_owned(), span, proof: constant.proof };
        let search = constant.search.map(|(target, domain)| {
            let parameters = self.parameters_of(&target);
            Search { target, domain, parameters, rules: self.facts.rules }
        });
        let known = self.graph.factors.iter().zip(&self.built.searches).position(|(f, s)| *f == factor && *s == search);
        let index = known.unwrap_or_else(|| {
            self.graph.factors.push(factor);
            self.built.searches.push(search);
            self.graph.factors.len() - 1
        });
        index as u32
    }
}
