//! The estimate of the distance: what light, occlusion and contact use. No factor is ever in it.

use crate::analysis::search::{Search, Target, spread};
use crate::analysis::{Box3, Domain};
use crate::functions::builder::Builder;
use crate::functions::found::Uneven;
use crate::functions::limits::{BUDGET, STEEPEST, UNIT};
use crate::graph::kernel::Op;
use crate::graph::{Claim, Exactness, FAR, Function, Leaf, Node, NodeId, Shape, ShapeId};
use std::rc::Rc;

/// A moved shape of more parts than this is one formula: each part costs its own gradient.
const PARTS: usize = 16;

/// A formula that is no steeper than this is flat.
const FLAT: f64 = 0.99;

/// Up to this part of the scene's extent the estimate looks twice; a wider extent than this holds what stands around a scene.
const CLOSE: f64 = 0.01;
const WIDE: f64 = 20.0;

/// Of what may be more than so many times as steep as it is, the estimate looks twice wherever that is: what is proven of it would throw a shadow of the
/// region.
const GENTLER: f64 = 2.0;

/// How much of its first way the second look goes, and by how much it may shorten it.
const MOST: f64 = 0.75;

/// How much more the way is shortened than the second look says.
const OVER: f64 = 1.25;

/// By how much a way within a solid is shortened at least.
const BEHIND: f64 = 0.02;

/// How many times what is proven an estimate may be: for all values of the parameters, and for the gentlest of a few of them.
const TIMES: f64 = 3.75;
const TIMES_GENTLEST: f64 = 1.8;

/// Of what is gentle at its surface and many times as steep elsewhere, an estimate that looks twice may be so many times as much: there the
/// second look says what is too far.
const TIMES_NEAR: f64 = 16_777_216.0;

/// What is taken away ends just beyond the rest, if that is less than this part of how wide it is.
const JUST_BEYOND: f64 = 0.15;
/// And it is an opening, if it is so wide a part of the rest.
const WIDE_OPEN: f64 = 0.7;

/// At how many values of the parameters a constant is looked for again, and with how many boxes each.
const GENTLE_VALUES: usize = 4;
const GENTLE_BOXES: usize = 32;

/// How steep a formula may be: at most, and at the gentlest of a few values of its parameters.
#[derive(Clone)]
pub(super) struct Steepness {
    constant: f64,
    gentlest: f64,
    /// Whether it is much flatter than a distance at places, and nowhere steeper.
    flat: bool,
    /// What more is known of what is gentle at its surface and many times as steep elsewhere.
    uneven: Option<Rc<Uneven>>,
    /// How large the region is of which that is known; without end elsewhere.
    size: f64,
}

impl Steepness {
    fn same(constant: f64) -> Self {
        Steepness { constant, gentlest: constant, flat: false, uneven: None, size: f64::INFINITY }
    }
}

impl Builder<'_> {
    /// The estimate of the distance: composed under `min` and `max`, a field where it is no steeper than a distance, else the field over
    /// its gradient (Hart 1996), which may not exceed a multiple ([`TIMES`]) of what is proven, or one of what is
    /// proven for the gentlest of a few values of the parameters, if that is more.
    pub(super) fn distance(&mut self, shape: ShapeId, node: NodeId, domain: &Domain) -> NodeId {
        match self.graph.node(node).clone() {
            Node::Constant(_) => node,
            _ if self.is_exact(shape, node) => node,
            Node::Op(Op::Max, _) if let Some(left) = self.without_absorbed(node, domain) => self.distance(shape, left, domain),
            Node::Op(op @ (Op::Min | Op::Max), args) => {
                if op == Op::Max && self.is_solid(shape) {
                    self.opening = self.opening.max(self.opening_of(node, &args, domain));
                }
                let args: Vec<NodeId> = {
                    let near = if op == Op::Max { self.narrowed(node, domain) } else { None };
                    let inner = near.as_ref().map_or(domain, |(d, _, _)| d);
                    args.iter().map(|a| self.distance(shape, *a, inner)).collect()
                };
                self.graph.op(op, &args)
            }
            Node::Op(Op::Neg, args) => {
                let inner = args.first().map_or(node, |a| self.distance(shape, *a, domain));
                self.graph.op(Op::Neg, &[inner])
            }
            Node::Op(Op::Select, args) if args.first().is_some_and(|c| self.is_uniform(*c)) && !self.choice_blends_more(&args) => {
                let (Some(&c), Some(&a), Some(&b)) = (args.first(), args.get(1), args.get(2)) else {
                    return node;
                };
                let a = self.distance(shape, a, domain);
                let b = self.distance(shape, b, domain);
                self.graph.op(Op::Select, &[c, a, b])
            }
            Node::Claim(args, Claim::Continuous) => {
                args.first().map_or(node, |a| self.distance(shape, *a, domain))
            }
            Node::Claim(args, Claim::Lipschitz(..)) if let Some(stretched) = args.first().and_then(|&a| self.stretched(a)) => stretched,
            Node::Op(Op::Mul, args)
                if args.len() == 2
                    && let Some(scaled) = self.scaled_distance(&args, domain) =>
            {
                scaled
            }
            Node::Call(inner, Function::Field, args) => {
                let everywhere = domain.at(Box3::ALL);
                let point = args.get(..3).unwrap_or(&args);
                let all = self.facts.map_constant(self.graph, point, &everywhere, 1);
                if all.lipschitz <= UNIT {
                    let point = point.to_vec();
                    let stretched = self.stretched_distance(node, &point);
                    return stretched.unwrap_or_else(|| self.graph.call(inner, Function::Distance, &args));
                }
                let whole = self.facts.constant(self.graph, node, &everywhere, 1);
                if whole.lipschitz <= UNIT {
                    return self.over_gradient(node, &Steepness::same(whole.lipschitz));
                }
                let Some((region, reach)) = self.region_of(node, domain) else { return node };
                let near = domain.at(region.grow(reach));
                let known = whole.lipschitz <= STEEPEST;
                let constant = if known { whole } else { self.facts.constant(self.graph, node, &near, BUDGET) };
                let steepness = self.steepness(node, if known { &everywhere } else { &near }, constant.lipschitz);
                let uneven = self.uneven(node, &near, constant.lipschitz);
                let is_uneven = uneven.is_some();
                let steepness = Steepness { uneven, size: region.grow(reach).size(), ..steepness };
                let mut estimate = self.part_by_part(node, &steepness);
                if is_uneven {
                    // Far from its surface the shape knows more of itself; nothing is nearer by more than the map stretches.
                    let point = point.to_vec();
                    let map = if all.lipschitz <= STEEPEST { all } else { self.facts.map_constant(self.graph, &point, &near, BUDGET) };
                    let moved = self.graph.call(inner, Function::Distance, &args);
                    let stretch = self.graph.constant(map.lipschitz.max(1.0));
                    let moved = self.graph.op(Op::Div, &[moved, stretch]);
                    estimate = self.further(node, estimate, [moved, moved]);
                }
                self.no_less_than_to(region, estimate)
            }
            _ => {
                let Some((node, strategy)) = self.treated(shape, node, domain, true) else { return node };
                let near = strategy.region.map(|(region, reach)| domain.at(region.grow(reach)));
                let around = near.as_ref().unwrap_or(domain);
                let uneven = if around.point.is_finite() { self.uneven(node, around, strategy.constant) } else { None };
                let steepness = Steepness { uneven, size: around.point.size(), ..self.steepness(node, around, strategy.constant) };
                // Where the bound takes that way; what is flatter than a distance as a whole is divided by its constant.
                let way = match (strategy.constant - 1.0).abs() <= 1e-6 && strategy.region.is_none() {
                    true => self.convex_way(node, domain),
                    false => None,
                };
                let estimate = way.unwrap_or_else(|| self.over_gradient(node, &steepness));
                match strategy.region {
                    Some((region, _)) => self.no_less_than_to(region, estimate),
                    None => estimate,
                }
            }
        }
    }

    fn is_solid(&self, shape: ShapeId) -> bool {
        self.graph.shape(shape).is_some_and(|shape| shape.dimensions == 3)
    }

    /// How wide an opening is whose face a ray may pass though it is not there: what an intersection takes away ends at a side of the rest, or only a
    /// little beyond it. 0 where there is none.
    fn opening_of(&mut self, node: NodeId, args: &[NodeId], domain: &Domain) -> f64 {
        let taken: Vec<NodeId> = args
            .iter()
            .filter_map(|&a| match self.graph.node(a) {
                Node::Op(Op::Neg, inner) => inner.first().copied(),
                _ => None,
            })
            .collect();
        if taken.is_empty() {
            return 0.0;
        }
        let rest = self.facts.rough_region_at(self.graph, node, domain, 0.0);
        let mut widest = 0.0;
        for taken in taken {
            let taken = self.facts.rough_region_at(self.graph, taken, domain, 0.0);
            // A face that is not there is as large as what is taken away; one of a small hole stands among faces that are there.
            let wide = |axis: usize| taken.axis(axis).width() >= WIDE_OPEN * rest.axis(axis).width();
            for ((side, rest), axis) in taken.0.iter().zip(rest.0).zip(0..) {
                let is_wide = (0..3).all(|other| other == axis || wide(other));
                let little = JUST_BEYOND * side.width();
                let ends = |beyond: f64| beyond > -0.01 * little && beyond < little;
                if is_wide && (side.lo < rest.hi && ends(side.hi - rest.hi) || side.hi > rest.lo && ends(rest.lo - side.lo)) {
                    let across = (0..3).filter(|other| *other != axis).map(|other| taken.axis(other).width());
                    widest = across.fold(f64::INFINITY, f64::min).max(widest);
                }
            }
        }
        widest
    }

    /// How steep a node is that is no steeper than `constant`. A parameter's whole range says little about one of its values: at a few values
    /// the constant is looked for again.
    fn steepness(&self, node: NodeId, domain: &Domain, constant: f64) -> Steepness {
        if constant <= UNIT {
            return Steepness::same(constant);
        }
        let target = Target::Value(node);
        let parameters = self.parameters_of(&target);
        if parameters.is_empty() && !self.graph.leaves_under(&[node]).contains(&Leaf::Time) {
            return Steepness::same(constant);
        }
        let search = Search { target, domain: domain.clone(), parameters, rules: self.facts.rules };
        let at = |i: usize| {
            let time = i as f64;
            let mut values: Vec<f64> = spread(self.graph, domain, &[], i).1.to_vec();
            values.push(time);
            search.run(self.graph, values.into(), GENTLE_BOXES)
        };
        let same = Steepness::same(constant);
        Steepness { gentlest: (0..GENTLE_VALUES).map(at).filter(|c| c.is_finite()).fold(constant, f64::min), ..same }
    }

    /// An estimate, or outside of a region the distance to it, if that is more: far from its solid a formula may say anything.
    fn no_less_than_to(&mut self, region: Box3, estimate: NodeId) -> NodeId {
        if region.is_empty() {
            return self.graph.constant(FAR);
        }
        let ways = self.graph.beyond((0..3).map(|i| (i, region.axis(i))));
        let Some(away) = self.graph.together(&ways) else { return estimate };
        let zero = self.graph.constant(0.0);
        let outside = self.graph.op(Op::Lt, &[zero, away]);
        let more = self.graph.op(Op::Max, &[estimate, away]);
        self.graph.op(Op::Select, &[outside, more, estimate])
    }

    fn choice_blends_more(&mut self, args: &[NodeId]) -> bool {
        args.get(1).zip(args.get(2)).is_some_and(|(&a, &b)| self.blends_more(a, b))
    }

    /// Of what is carried by a map that stretches space along some directions and not along others: the distance of the shape itself is as much too
    /// little as that stretches. None for any other map.
    pub(super) fn stretched_distance(&mut self, node: NodeId, point: &[NodeId]) -> Option<NodeId> {
        let rigid = self.facts.is_rigid(self.graph, point);
        if rigid || self.is_crowded() || !point.iter().all(|&q| self.is_straight(q)) {
            return None;
        }
        Some(self.over_gradient(node, &Steepness { flat: true, ..Steepness::same(1.0) }))
    }

    /// The same of a multiple of a shape at a point.
    fn stretched(&mut self, node: NodeId) -> Option<NodeId> {
        let (factor, call) = match self.graph.node(node) {
            Node::Op(Op::Mul, args) => match (*args.first()?, *args.get(1)?) {
                (a, b) if self.is_uniform(a) => (Some(a), b),
                (a, b) if self.is_uniform(b) => (Some(b), a),
                _ => return None,
            },
            _ => (None, node),
        };
        let Node::Call(_, Function::Field, args) = self.graph.node(call) else { return None };
        let mut point = args.get(..3)?.to_vec();
        for q in &mut point {
            *q = factor.map_or(*q, |factor| self.graph.op(Op::Mul, &[factor, *q]));
        }
        self.stretched_distance(node, &point)
    }

    pub(super) fn scaled_distance(&mut self, args: &[NodeId], domain: &Domain) -> Option<NodeId> {
        let (&a, &b) = (args.first()?, args.get(1)?);
        let (factor, inner) = if self.is_uniform(a) {
            (a, b)
        } else if self.is_uniform(b) {
            (b, a)
        } else {
            return None;
        };
        if self.facts.live_range(self.graph, factor).lo <= 0.0 {
            return None;
        }
        self.scaled_call(factor, inner, domain, Function::Distance)
    }

    /// Of a moved shape: what it is a union or an intersection of, each over its own gradient, for the nearest need not be the least in value.
    fn part_by_part(&mut self, node: NodeId, steepness: &Steepness) -> NodeId {
        if steepness.constant <= UNIT || !(2..=PARTS).contains(&self.parts(node, PARTS + 1)) {
            return self.over_gradient(node, steepness);
        }
        if let Some(within) = self.corner(node) {
            let zero = self.graph.constant(0.0);
            let inside = self.graph.op(Op::Lt, &[within, zero]);
            let (within, outside) = (self.part_by_part(within, steepness), self.over_gradient(node, steepness));
            return self.graph.op(Op::Select, &[inside, within, outside]);
        }
        match self.graph.node(node).clone() {
            Node::Op(op @ (Op::Min | Op::Max | Op::Neg), args) => {
                let args: Vec<NodeId> = args.iter().map(|&a| self.part_by_part(a, steepness)).collect();
                self.graph.op(op, &args)
            }
            Node::Claim(args, _) => args.first().map_or(node, |&a| self.part_by_part(a, steepness)),
            Node::Call(shape, Function::Field, args) => {
                let Some(value) = self.graph.shape(shape).map(|s| s.value) else { return node };
                let opened = self.graph.open(shape, value, &args);
                self.part_by_part(opened, steepness)
            }
            _ => self.over_gradient(node, steepness),
        }
    }

    /// What a formula is where that is negative, if it is `length(max(a, 0), max(b, 0), …) + min(max(a, b, …), 0)`: the greatest of a, b, ….
    fn corner(&self, node: NodeId) -> Option<NodeId> {
        let op = |node: NodeId| match self.graph.node(node) {
            Node::Op(op, args) => Some((*op, args.as_ref())),
            _ => None,
        };
        // The other one of two arguments, where one is zero.
        let beside_zero = |node: NodeId, wanted: Op| {
            let (found, args) = op(node)?;
            let &[a, b] = args else { return None };
            let zero = |n: NodeId| self.graph.as_constant(n) == Some(0.0);
            if found != wanted {
                None
            } else if zero(b) {
                Some(a)
            } else {
                zero(a).then_some(b)
            }
        };
        let (Op::Add, &[a, b]) = op(node)? else { return None };
        let (length, greatest) = match beside_zero(b, Op::Min) {
            Some(greatest) => (a, greatest),
            None => (b, beside_zero(a, Op::Min)?),
        };
        let (Op::Length2 | Op::Length3 | Op::Length4, sides) = op(length)? else { return None };
        let mut sides: Vec<NodeId> = sides.iter().map(|&s| beside_zero(s, Op::Max)).collect::<Option<_>>()?;
        let (mut open, mut found) = (vec![greatest], Vec::new());
        while let Some(node) = open.pop() {
            match op(node) {
                _ if sides.contains(&node) => found.push(node),
                Some((Op::Max, args)) => open.extend(args),
                _ => match self.graph.node(node) {
                    Node::Claim(args, _) => open.push(*args.first()?),
                    _ => return None,
                },
            }
        }
        sides.sort_unstable();
        found.sort_unstable();
        (sides == found).then_some(greatest)
    }

    /// Of how many parts a formula is the least or the greatest, through the shapes that it calls; no more than `most` are counted.
    fn parts(&self, node: NodeId, most: usize) -> usize {
        if let Some(within) = self.corner(node) {
            return self.parts(within, most);
        }
        match self.graph.node(node) {
            Node::Op(Op::Min | Op::Max | Op::Neg, args) => args.iter().fold(0, |sum, &a| if sum < most { sum + self.parts(a, most - sum) } else { sum }),
            Node::Claim(args, _) => args.first().map_or(1, |&a| self.parts(a, most)),
            Node::Call(shape, Function::Field, _) => self.graph.shape(*shape).map_or(1, |s| self.parts(s.value, most)),
            _ => 1,
        }
    }

    /// The field over its gradient: right to first order. Close to the surface a second look further on tells how the field goes on.
    pub(super) fn over_gradient(&mut self, node: NodeId, steepness: &Steepness) -> NodeId {
        let &Steepness { constant, gentlest, flat, ref uneven, size } = steepness;
        // What is flatter than a distance everywhere is as much less than one.
        if constant < FLAT && constant > 1e-6 {
            let steepness = self.graph.constant(constant);
            return self.graph.op(Op::Div, &[node, steepness]);
        }
        if constant <= UNIT && !flat || !constant.is_finite() {
            return node;
        }
        let least = (constant / TIMES).min(gentlest / TIMES_GENTLEST);
        let may_be_gentler = uneven.is_some() || least > GENTLER;
        let least = self.graph.constant(least);
        // What comes from around the shape moves with the point in ways that are not seen further on.
        if self.graph.reads(node).variables != 0 {
            let gradient = self.gradient(node);
            let length = self.length_of(gradient, least);
            return self.graph.op(Op::Div, &[node, length]);
        }
        // A shape of its own, so that both looks are calls of one function.
        let Some(span) = self.graph.shape(self.root).map(|s| s.span) else { return node };
        let exactness = Exactness::Formula;
        let part = Shape { name: None, dimensions: 3, value: node, variables: [].into(), exactness, material: None, paints: [].into(), span };
        let part = self.graph.add_shape(part);
        // No wall is met where a ray only passes one.
        self.gradients.walled.insert(part, false);
        let here = self.graph.point();
        let [node, gradient @ ..] = self.seen_from(part, here);
        let slope = self.graph.op(Op::Length3, &gradient);
        let length = self.graph.op(Op::Max, &[slope, least]);
        let proven = self.graph.op(Op::Div, &[node, length]);
        if may_be_gentler {
            // Nothing of it is farther away than its region is large.
            let size = if size.is_finite() { size } else { self.scene.extent };
            let [times, share] = [1.0 / TIMES_NEAR, 1.0 / size].map(|c| self.graph.constant(c));
            let value = self.graph.op(Op::Abs, &[node]);
            let across = self.graph.op(Op::Mul, &[value, share]);
            let least = self.graph.op(Op::Mul, &[least, times]);
            let least = self.graph.op(Op::Max, &[least, across]);
            let length = self.graph.op(Op::Max, &[slope, least]);
            let first = self.graph.op(Op::Div, &[node, length]);
            let less = self.too_far(part, node, gradient, length, least);
            let less = self.graph.op(Op::Mul, &[first, less]);
            let nearer = self.graph.op(Op::Sub, &[first, less]);
            let estimate = self.further(node, nearer, [proven, proven]);
            return match uneven {
                Some(uneven) => self.gentler_way(node, estimate, uneven),
                None => estimate,
            };
        }
        let near = self.graph.constant(CLOSE * self.scene.extent.min(WIDE));
        let [one, two, end] = [1.0, 2.0, 1.5].map(|c| self.graph.constant(c));
        let away = self.graph.op(Op::Abs, &[proven]);
        let away = self.graph.op(Op::Div, &[away, near]);
        let is_near = self.graph.op(Op::Lt, &[away, end]);
        // All of it where it is near, less and less up to half as far again.
        let weight = self.graph.op(Op::Sub, &[end, away]);
        let weight = self.graph.op(Op::Mul, &[weight, two]);
        let weight = self.graph.op(Op::Min, &[weight, one]);
        let less = self.too_far(part, node, gradient, length, least);
        let less = self.graph.op(Op::Mul, &[weight, less]);
        let less = self.graph.op(Op::Mul, &[proven, less]);
        let nearer = self.graph.op(Op::Sub, &[proven, less]);
        self.graph.op(Op::Select, &[is_near, nearer, proven])
    }

    /// By which part of it the way `node / length` against the gradient is too far. Most of that way further on the tangent plane is as far from here
    /// as the turn of the gradient and the value there say (Newton's second step); the foot itself may lie on an edge. Where the gradient turned so
    /// much that it must have come over an edge, the chord of both values says it.
    fn too_far(&mut self, part: ShapeId, node: NodeId, gradient: [NodeId; 3], length: NodeId, least: NodeId) -> NodeId {
        let [zero, one] = [0.0, 1.0].map(|c| self.graph.constant(c));
        let square = self.graph.op(Op::Square, &[length]);
        let most = self.graph.constant(MOST);
        let way = self.graph.op(Op::Div, &[node, square]);
        let way = self.graph.op(Op::Mul, &[way, most]);
        let mut further = self.graph.point();
        for (p, g) in further.iter_mut().zip(gradient) {
            let step = self.graph.op(Op::Mul, &[way, g]);
            *p = self.graph.op(Op::Sub, &[*p, step]);
        }
        let [value, x, y, z] = self.seen_from(part, further);
        let steepness = self.length_of([x, y, z], least);
        let products = gradient.into_iter().zip([x, y, z]).map(|(a, b)| self.graph.op(Op::Mul, &[a, b]));
        let products: Vec<NodeId> = products.collect();
        let dot = products.into_iter().fold(zero, |sum, product| self.graph.op(Op::Add, &[sum, product]));
        let lengths = self.graph.op(Op::Mul, &[length, steepness]);
        let cosine = self.graph.op(Op::Div, &[dot, lengths]);
        let rest = self.graph.op(Op::Div, &[value, node]);
        let beyond = self.graph.op(Op::Div, &[length, steepness]);
        let beyond = self.graph.op(Op::Mul, &[rest, beyond]);
        let along = self.graph.op(Op::Mul, &[cosine, most]);
        let plane = self.graph.op(Op::Add, &[along, beyond]);
        let fallen = self.graph.op(Op::Sub, &[one, rest]);
        let fallen = self.graph.op(Op::Max, &[fallen, most]);
        let chord = self.graph.op(Op::Div, &[most, fallen]);
        // From a turn of 60 degrees to one of 45.
        let [turned, rate] = [0.5, 5.0].map(|c| self.graph.constant(c));
        let smooth = self.graph.op(Op::Sub, &[cosine, turned]);
        let smooth = self.graph.op(Op::Mul, &[smooth, rate]);
        let smooth = self.graph.op(Op::Max, &[smooth, zero]);
        let smooth = self.graph.op(Op::Min, &[smooth, one]);
        let other = self.graph.op(Op::Sub, &[plane, chord]);
        let other = self.graph.op(Op::Mul, &[smooth, other]);
        let share = self.graph.op(Op::Add, &[chord, other]);
        // A third step lands on a surface: that is as far from here as both ways together, in whichever direction.
        let turn = self.graph.op(Op::Max, &[cosine, zero]);
        let turn = self.graph.op(Op::Mul, &[turn, beyond]);
        let across = self.graph.op(Op::Mul, &[most, turn]);
        let double = self.graph.op(Op::Add, &[across, across]);
        let squares = [most, beyond].map(|way| self.graph.op(Op::Square, &[way]));
        let squares = self.graph.op(Op::Add, &squares);
        let square = self.graph.op(Op::Add, &[squares, double]);
        let landing = self.graph.op(Op::Sqrt, &[square]);
        let share = self.graph.op(Op::Min, &[share, landing]);
        // What two looks do not see takes as a rule away what they saw taken away, a little more.
        let less = self.graph.op(Op::Sub, &[one, share]);
        let over = self.graph.constant(OVER);
        let less = self.graph.op(Op::Mul, &[less, over]);
        let less = self.graph.op(Op::Min, &[less, most]);
        // Within a solid the nearest surface may lie behind, where neither look sees it.
        let inside = self.graph.op(Op::Lt, &[node, zero]);
        let behind = self.graph.constant(BEHIND);
        let least = self.graph.op(Op::Select, &[inside, behind, zero]);
        self.graph.op(Op::Max, &[less, least])
    }

    /// The field of a shape at a point, and its gradient there.
    fn seen_from(&mut self, part: ShapeId, point: [NodeId; 3]) -> [NodeId; 4] {
        let functions = [Function::Field, Function::Gradient(0), Function::Gradient(1), Function::Gradient(2)];
        functions.map(|function| self.graph.call(part, function, &point))
    }

    /// The length of a gradient, and no less than `least`.
    fn length_of(&mut self, gradient: [NodeId; 3], least: NodeId) -> NodeId {
        let length = self.graph.op(Op::Length3, &gradient);
        self.graph.op(Op::Max, &[length, least])
    }
}
