//! Formulas that jump: a ray stops before the jump and looks again just behind it.

use crate::analysis::formula::Formula;
use crate::analysis::tape::Step;
use crate::analysis::{Box3, Domain};
use crate::diagnostic::{Code, Diagnostic};
use crate::functions::bound_strategy::BoundStrategy;
use crate::functions::builder::Builder;
use crate::functions::limits::{HAIR, LONGEST_HAIR};
use crate::functions::made::Kind;
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::{Claim, Exactness, Node, NodeId, Proof, ShapeId};
use crate::source::Span;
use smallvec::{SmallVec, smallvec};

/// A sine times so much is meant to be random.
const SCATTERS: f64 = 1000.0;

/// An operation that makes a formula jump.
pub(super) struct Site {
    pub(super) node: NodeId,
    pub(super) op: Op,
    pub(super) args: Vec<NodeId>,
}

/// How far it is at least to where an operation jumps.
pub(super) enum Jump {
    /// It does not jump here.
    Nowhere,
    /// As far as this node says.
    From(NodeId),
    /// Nothing is known of how near it is.
    Unknown,
}

/// What of a step makes the formula jump.
#[derive(Clone, Copy, Default, PartialEq, PartialOrd)]
enum Blame {
    #[default]
    Nothing,
    /// The shapes that it calls.
    Calls,
    /// What it is made of, and not the step itself.
    Inside,
    /// All that jumps.
    All,
}

/// How far a ray steps across a jump in a domain.
pub(super) fn jump_epsilon(near: &Domain) -> f64 {
    (HAIR * near.point.size().max(0.25)).min(LONGEST_HAIR)
}

/// What changes so many times slower than it may is not what its constant says.
const LOOSE: f64 = 30.0;
/// At so many places is looked how fast that is.
const LOOKS: usize = 256;

/// How many nodes opening shapes may make.
const MOST_OPENED: usize = 200_000;

impl Builder<'_> {
    /// What to write instead of noise that a person made of random numbers in cells: nobody sees that its cells agree at their walls.
    pub(super) fn own_noise(&self, node: NodeId) -> Option<&'static str> {
        let claimed = |id: NodeId| matches!(self.graph.node(id), Node::Claim(_, Claim::Lipschitz(..)));
        let own = self.graph.reachable_among(&[node], |id| !claimed(id));
        let large = |id: &NodeId| self.graph.as_constant(*id).is_some_and(|c| c.abs() >= SCATTERS);
        let sine = |id: &NodeId| matches!(self.graph.node(*id), Node::Op(Op::Sin | Op::Cos, _));
        let random = |id: &NodeId| match self.graph.node(*id) {
            Node::Op(Op::Hash, _) => true,
            // As shaders have it that know no whole numbers.
            Node::Op(Op::Mul, args) => args.iter().any(large) && args.iter().any(sine),
            _ => false,
        };
        let cells = |id: &NodeId| matches!(self.graph.node(*id), Node::Op(Op::Floor, _));
        (own.iter().any(cells) && own.iter().any(random)).then_some(
            "what is random in cells is not the same on both sides of their walls, as far as can be proven: of noise each corner of a cell must be the next cell's too, and in a loop over neighbouring cells what is in the farthest of them must be farther than what is in the nearest; `value_noise`, `perlin`, `simplex`, `cellular` and `fbm` have no walls, and their factors are known",
        )
    }

    /// A ray stops before a jump and looks again just behind it.
    pub(super) fn stop_at_jumps(
        &mut self,
        shape: ShapeId,
        node: NodeId,
        value: NodeId,
        domain: &Domain,
        strategy: &BoundStrategy,
    ) -> NodeId {
        let near = match strategy.region {
            Some((region, reach)) => domain.at(region.grow(reach)),
            None => domain.clone(),
        };
        let mut sites = self.sites(node, &near);
        let span = self.place(shape, node);
        let measured = strategy.proof == Proof::Measured;
        let (mut passed, mut is_told) = (Vec::new(), true);
        if !sites.is_empty() {
            let proven = !measured && self.past_jump(node, &sites, &[], &near, strategy).is_some();
            if !proven || self.are_nested(&sites) {
                (sites, passed) = self.without_agreeing(node, sites, proven, &near, span);
            }
            // Where rays are proven to get past, what seems not to jump is nobody's concern.
            is_told = !proven || !self.all_agree(node, &sites, &near);
        }
        let (mut nearest, mut stops, mut unknown): (Option<NodeId>, _, _) = (None, None, None);
        for site in &sites {
            let at = self.stands_at(site, span);
            match self.distance_to_jump(site.op, &site.args, &near) {
                Jump::Nowhere => {}
                Jump::Unknown => unknown = unknown.or(Some(at)),
                Jump::From(_) if measured && self.gaps(site.op, &site.args, &near).into_iter().any(|(a, _)| self.is_loose(a, &near)) => unknown = unknown.or(Some(at)),
                Jump::From(distance) => {
                    stops = stops.or(Some(at));
                    nearest = Some(match nearest {
                        Some(other) => self.graph.op(Op::Min, &[other, distance]),
                        None => distance,
                    });
                }
            }
        }
        if let Some(at) = stops.filter(|_| is_told) {
            self.diagnostics.push(Diagnostic::new(
                Code::Jump,
                at,
                "this formula jumps; rays stop before the jump and look again",
                self.own_noise(node)
                    .unwrap_or("steps that are meant need nothing; where both sides agree, write it without the jump, for example with `abs`, `min` or `repeat`"),
            ));
        }
        if let Some(at) = unknown {
            let message = match measured {
                true => "how near the jump of this formula is can't be known, so rays may pass it and leave holes",
                false => "how near the jump of this formula is can't be known, so rays creep all along it, and most get nowhere",
            };
            let instead = "write it without the jump, or keep what jumps away from where it is steep without end: an angle from its axis, a \
                           root from zero";
            self.diagnostics.push(Diagnostic::new(Code::Jump, at, message, instead));
            // Where no bound is proven anyway, a picture is better than none.
            if !measured {
                nearest = Some(self.graph.constant(0.0));
            }
        }
        let Some(nearest) = nearest else { return value };
        let epsilon = self.graph.constant(jump_epsilon(&near));
        let nearest = self.graph.op(Op::Max, &[nearest, epsilon]);
        let zero = self.graph.constant(0.0);
        let size = self.graph.op(Op::Abs, &[value]);
        let mut way = nearest;
        if let Some(past) = self.past_jump(node, &sites, &passed, &near, strategy) {
            way = self.graph.op(Op::Max, &[way, past]);
        }
        let mut step = self.graph.op(Op::Min, &[size, way]);
        if let Some(over) = self.over_jumps(node, &sites, &near, strategy.constant) {
            step = self.graph.op(Op::Max, &[step, over]);
        }
        let minus = self.graph.op(Op::Neg, &[step]);
        let inside = self.graph.op(Op::Lt, &[value, zero]);
        self.kind = self.kind.max(Kind::Bound);
        self.graph.op(Op::Select, &[inside, minus, step])
    }

    /// Where what jumps stands in the text; `else_at` where that is not known.
    fn stands_at(&self, site: &Site, else_at: Span) -> Span {
        let known = |n: &NodeId| self.graph.location(*n);
        known(&site.node).or_else(|| site.args.iter().find_map(known)).unwrap_or(else_at)
    }

    /// Whether where one of some jumps is follows from another one.
    fn are_nested(&self, sites: &[Site]) -> bool {
        sites.iter().any(|site| self.follows(&site.args, sites, Some(site.node)))
    }

    /// Whether some numbers are computed from one of some jumps, apart from this one.
    pub(super) fn follows(&self, numbers: &[NodeId], jumps: &[Site], but: Option<NodeId>) -> bool {
        let read = self.graph.reachable(numbers);
        jumps.iter().any(|jump| Some(jump.node) != but && read.binary_search(&jump.node).is_ok())
    }

    /// Some sites, parted by whether the two sides of each agree wherever one looks: those at which rays stop, and those that they pass. A person is
    /// told of the latter. Where rays are proven to get past all of them, some are as good as all.
    fn without_agreeing(&mut self, node: NodeId, sites: Vec<Site>, proven: bool, near: &Domain, span: Span) -> (Vec<Site>, Vec<Site>) {
        let (agreeing, mut jumping) = self.agreeing(node, sites, near);
        if proven && !jumping.is_empty() {
            jumping.extend(agreeing);
            return (jumping, Vec::new());
        }
        let (read, passed) = self.that_move(&jumping, agreeing, near);
        jumping.extend(read);
        if let Some(first) = passed.first() {
            self.kind = self.kind.max(Kind::Unproven);
            self.diagnostics.push(Diagnostic::new(
                Code::Unproven,
                self.stands_at(first, span),
                "this formula jumps; both sides agree at all places that were looked at, so rays pass it, which is no proof that they agree everywhere",
                "nothing need be done where the picture is right; written with `abs`, `min` or `repeat` it can be proven, and with `--strict` rays stop at each jump",
            ));
        }
        (jumping, passed)
    }

    /// Some seams, parted by whether a number by which one of some jumps comes about jumps at them: how near a jump is by how fast its number changes
    /// holds only as long as that does not jump itself.
    fn that_move(&mut self, jumps: &[Site], seams: Vec<Site>, near: &Domain) -> (Vec<Site>, Vec<Site>) {
        let mut numbers: Vec<(NodeId, Vec<NodeId>)> = Vec::new();
        for jump in jumps.iter().filter(|_| !seams.is_empty()) {
            let own = self.gaps(jump.op, &jump.args, near).into_iter().map(|(number, _)| number);
            let own: Vec<NodeId> = if jump.op == Op::Atan2 { jump.args.clone() } else { own.collect() };
            numbers.extend(own.into_iter().map(|number| (number, self.graph.reachable(&[number]))));
        }
        seams.into_iter().partition(|seam| {
            numbers.iter().any(|(number, read)| read.binary_search(&seam.node).is_ok() && self.jump_height(*number, seam, near) > 0.0)
        })
    }

    /// The operations by which a node jumps.
    pub(super) fn sites(&mut self, node: NodeId, near: &Domain) -> Vec<Site> {
        let mut sites = Vec::new();
        let most = self.graph.len() + MOST_OPENED;
        self.jump_sites(node, near, most, &mut sites);
        sites
    }

    /// The operations by which a node jumps, in the shapes that it calls too: what is claimed to be continuous is not to blame, nor what jumps
    /// and comes to the same on both sides.
    fn jump_sites(&mut self, root: NodeId, near: &Domain, most: usize, sites: &mut Vec<Site>) {
        let tape = Formula::new(self.graph, &[root], self.facts.rules);
        let duals = self.facts.all_duals(self.graph, &tape, near);
        let jumps = |i: usize| duals.get(i).is_some_and(|d| d.jumps != 0);
        let mut blamed = vec![Blame::Nothing; tape.steps.len()];
        if let (Some(last), true) = (blamed.last_mut(), jumps(tape.steps.len() - 1)) {
            *last = Blame::All;
        }
        let (mut opened, mut seams, before) = (Vec::new(), Vec::new(), sites.len());
        for (i, step) in tape.steps.iter().enumerate().rev() {
            let blame = blamed.get(i).copied().unwrap_or_default();
            let Some(&node) = tape.nodes.get(i).filter(|_| blame != Blame::Nothing) else { continue };
            let (args, passed) = match step {
                Step::Op(op, args) => {
                    let moving = args.iter().any(|&a| duals.get(a).is_some_and(|d| d.norm > 0.0));
                    let decided = duals.get(i).is_some_and(|d| d.value.is_point());
                    let known = sites.iter().any(|s| s.node == node);
                    if blame == Blame::All && op.row().jumps && moving && !decided && !known {
                        let args = args.iter().filter_map(|&a| tape.nodes.get(a).copied()).collect();
                        let site = Site { node, op: *op, args };
                        // That, too, makes nodes.
                        let has_room = self.graph.len() + MOST_OPENED / 2 < most;
                        match !has_room || self.jump_height(root, &site, near) > 0.0 {
                            true => sites.push(site),
                            false => seams.push(site),
                        }
                    }
                    // Where a choice is the same on both sides it is not the change from one to the other that jumps.
                    let meets = tape.meets(i).is_some();
                    if blame == Blame::All && meets
                        && let Some(slot) = args.first().and_then(|&condition| blamed.get_mut(condition))
                        && *slot < Blame::Inside
                    {
                        *slot = Blame::Inside;
                    }
                    let chosen = if meets { args.get(1..).unwrap_or_default() } else { args.as_slice() };
                    (chosen, if blame == Blame::Inside && *op != Op::Not { Blame::All } else { blame })
                }
                Step::Call(shape, args) => {
                    opened.extend(self.graph.shape(*shape).filter(|s| s.exactness != Exactness::Exact).map(|_| node));
                    (args.as_slice(), blame)
                }
                Step::Claim(Claim::Continuous, args) => (args.get(..1).unwrap_or_default(), Blame::Calls),
                Step::Claim(_, args) => (args.get(1..).unwrap_or_default(), blame),
                Step::Constant(_) | Step::Leaf(_) => continue,
            };
            for &arg in args.iter().filter(|&&a| jumps(a)) {
                if let Some(slot) = blamed.get_mut(arg)
                    && *slot < passed
                {
                    *slot = passed;
                }
            }
        }
        let moving = self.that_move(sites.get(before..).unwrap_or_default(), seams, near).0;
        sites.extend(moving);
        for call in opened {
            let Node::Call(shape, _, args) = self.graph.node(call).clone() else { continue };
            let Some(value) = self.graph.shape(shape).map(|s| s.value).filter(|_| self.graph.len() < most) else { continue };
            let inside = self.graph.open(shape, value, &args);
            self.jump_sites(inside, near, most, sites);
        }
    }

    /// Whether a formula calls a shape that jumps: its jumps are not those of operations of the formula, though the two may be the same nodes.
    pub(super) fn calls_what_jumps(&mut self, node: NodeId, near: &Domain) -> bool {
        let calls: Vec<NodeId> = self.graph.reachable(&[node]).into_iter().filter(|id| matches!(self.graph.node(*id), Node::Call(..))).collect();
        calls.into_iter().any(|call| self.facts.constant(self.graph, call, near, 1).jumps)
    }

    /// How far it is at least to where an operation jumps.
    pub(super) fn distance_to_jump(&mut self, op: Op, args: &[NodeId], near: &Domain) -> Jump {
        if let (Op::Atan2, &[a, b, ..]) = (op, args) {
            // The cut is the negative half of the second axis.
            let zero = self.graph.constant(0.0);
            let side = self.graph.op(Op::Abs, &[a]);
            let ahead = self.graph.op(Op::Max, &[b, zero]);
            let distance = self.graph.op(Op::Length2, &[side, ahead]);
            let map = self.facts.map_constant(self.graph, &[a, b], near, 16);
            if !map.lipschitz.is_finite() {
                return Jump::Unknown;
            }
            let over = self.graph.constant(map.lipschitz.max(1e-9));
            return Jump::From(self.graph.op(Op::Div, &[distance, over]));
        }
        let mut least = Jump::Nowhere;
        for (a, gap) in self.gaps(op, args, near) {
            least = match (least, self.way_across(gap, a, near)) {
                (Jump::From(a), Jump::From(b)) => Jump::From(self.graph.op(Op::Min, &[a, b])),
                (Jump::Nowhere, way) => way,
                // Nothing is known of how near the jump is.
                _ => return Jump::Unknown,
            };
        }
        least
    }

    /// Whether a number by which something jumps changes so much slower at most places than it may that rays would spend all of their steps before
    /// that.
    fn is_loose(&mut self, number: NodeId, near: &Domain) -> bool {
        let usual = self.facts.sampled_slope(self.graph, number, near, LOOKS, 0.5);
        self.facts.constant(self.graph, number, near, 16).lipschitz > LOOSE * usual
    }

    /// The numbers by which an operation jumps, each with how much it changes before that.
    pub(super) fn gaps(&mut self, op: Op, args: &[NodeId], near: &Domain) -> SmallVec<[(NodeId, NodeId); 4]> {
        let Some(&a) = args.first() else { return smallvec![] };
        match op {
            Op::Floor | Op::Ceil | Op::Trunc => {
                let whole = self.nearest_whole(op, a, near);
                let from = self.graph.op(Op::Sub, &[a, whole]);
                smallvec![(a, self.graph.op(Op::Abs, &[from]))]
            }
            Op::Round | Op::Hash => {
                let moving = args.iter().filter(|a| self.facts.constant(self.graph, **a, near, 16).lipschitz != 0.0);
                let moving: SmallVec<[NodeId; 4]> = moving.copied().collect();
                let gap = |&a: &NodeId| {
                    let whole = self.graph.op(Op::Round, &[a]);
                    let from = self.graph.op(Op::Sub, &[a, whole]);
                    let from = self.graph.op(Op::Abs, &[from]);
                    let half = self.graph.constant(0.5);
                    (a, self.graph.op(Op::Sub, &[half, from]))
                };
                moving.iter().map(gap).collect()
            }
            Op::Sign => smallvec![(a, self.graph.op(Op::Abs, &[a]))],
            Op::Lt | Op::Le | Op::Eq => {
                let Some(&b) = args.get(1) else { return smallvec![] };
                // Of squares as of lengths, which are as far apart as the points that they lead to.
                let [a, b] = match [a, b].map(|side| self.root_of_squares(side)) {
                    [Some(a), Some(b)] => [a, b],
                    _ => [a, b],
                };
                let difference = self.graph.op(Op::Sub, &[a, b]);
                smallvec![(difference, self.graph.op(Op::Abs, &[difference]))]
            }
            _ => smallvec![],
        }
    }

    /// The whole number nearest to an argument at which an operation jumps: not the one that it starts from, where it never crosses that.
    pub(super) fn nearest_whole(&mut self, op: Op, argument: NodeId, near: &Domain) -> NodeId {
        let whole = self.graph.op(Op::Round, &[argument]);
        let (inward, within) = match op {
            Op::Floor => (1.0, Op::Max),
            Op::Ceil => (-1.0, Op::Min),
            _ => return whole,
        };
        let end = |range: Interval| if op == Op::Floor { range.lo } else { range.hi };
        let [here, anywhere] = [near.clone(), near.at(Box3::ALL)].map(|domain| end(self.facts.range(self.graph, argument, &domain)));
        // Where one looks no farther, it may go on: but what is never below zero here is a distance.
        let end = if here == 0.0 { here } else { anywhere };
        if !end.is_finite() || end.fract() != 0.0 {
            return whole;
        }
        let next = self.graph.constant(end + inward);
        self.graph.op(within, &[whole, next])
    }

    /// The length of which a node is the square; of a number the root.
    fn root_of_squares(&mut self, node: NodeId) -> Option<NodeId> {
        if let Some(c) = self.graph.as_constant(node) {
            return (c >= 0.0).then(|| self.graph.constant(c.sqrt()));
        }
        let mut of: SmallVec<[NodeId; 4]> = SmallVec::new();
        let mut open: SmallVec<[NodeId; 4]> = smallvec![node];
        while let Some(term) = open.pop() {
            let Node::Op(op, args) = self.graph.node(term) else { return None };
            match (op, args.as_ref()) {
                (Op::Add, args) => open.extend(args.iter().rev().copied()),
                (Op::Square, &[x]) => of.push(x),
                (Op::Mul, &[x, y]) if x == y => of.push(x),
                _ => return None,
            }
            if of.len() + open.len() > 4 {
                return None;
            }
        }
        let op = match of.len() {
            1 => Op::Abs,
            2 => Op::Length2,
            3 => Op::Length3,
            _ => Op::Length4,
        };
        Some(self.graph.op(op, &of))
    }

    /// How far it is at least to where a node has changed by `gap`.
    pub(super) fn way_across(&mut self, gap: NodeId, node: NodeId, near: &Domain) -> Jump {
        let constant = self.facts.constant(self.graph, node, near, 16);
        if constant.lipschitz.is_finite() {
            let over = self.graph.constant(constant.lipschitz.max(1e-9));
            return Jump::From(self.graph.op(Op::Div, &[gap, over]));
        }
        // An angle is steep without end at its axis alone: from a point at a radius r it is r sin(gap) to a ray at an angle from it, and no nearer
        // than the axis to one behind.
        let Some((times, axes)) = self.angle(node) else { return Jump::Unknown };
        let map = self.facts.map_constant(self.graph, &axes, near, 16);
        if !map.lipschitz.is_finite() {
            return Jump::Unknown;
        }
        let [share, quarter] = [1.0 / times, std::f64::consts::FRAC_PI_2].map(|c| self.graph.constant(c));
        let angle = self.graph.op(Op::Mul, &[gap, share]);
        let angle = self.graph.op(Op::Min, &[angle, quarter]);
        let sine = self.graph.op(Op::Sin, &[angle]);
        let radius = self.graph.op(Op::Length2, &axes);
        let across = self.graph.op(Op::Mul, &[radius, sine]);
        let over = self.graph.constant(map.lipschitz.max(1e-9));
        Jump::From(self.graph.op(Op::Div, &[across, over]))
    }

    /// How many times as fast as an angle a node changes at most, between other jumps, and both axes of the angle.
    fn angle(&mut self, node: NodeId) -> Option<(f64, [NodeId; 2])> {
        let Node::Op(op, args) = self.graph.node(node).clone() else { return None };
        let a = *args.first()?;
        if matches!(op, Op::Sin | Op::Cos | Op::Abs | Op::Neg) {
            return self.angle(a);
        }
        let b = *args.get(1)?;
        if op == Op::Atan2 {
            return Some((1.0, [a, b]));
        }
        // What stays as it is to the next jump.
        let still = |builder: &Self, node: NodeId| {
            let steps = matches!(builder.graph.node(node), Node::Op(Op::Floor | Op::Ceil | Op::Trunc | Op::Round | Op::Sign, _));
            steps || builder.is_uniform(node)
        };
        let (inner, factor) = match op {
            Op::Add | Op::Sub if still(self, b) => (a, 1.0),
            Op::Add | Op::Sub if still(self, a) => (b, 1.0),
            Op::Mul if self.is_uniform(b) => (a, self.facts.live_range(self.graph, b).magnitude()),
            Op::Mul if self.is_uniform(a) => (b, self.facts.live_range(self.graph, a).magnitude()),
            Op::Div if self.is_uniform(b) => {
                let by = self.facts.live_range(self.graph, b);
                (a, 1.0 / if by.contains(0.0) { 0.0 } else { by.lo.abs().min(by.hi.abs()) })
            }
            _ => return None,
        };
        let (times, axes) = self.angle(inner)?;
        Some((times * factor, axes)).filter(|(times, _)| *times > 0.0 && times.is_finite())
    }
}
