//! Convex formulas. Where f is convex its first-order estimate is below it everywhere, so from a point with f > 0 the way to the solid is at
//! least f/|∇f| (Boyd and Vandenberghe 2004, § 3.1.3): a step that needs no constant, and comes near where f is flatter than a distance.

use crate::analysis::search::{Search, Target};
use crate::analysis::{Box3, Domain};
use crate::functions::builder::Builder;
use crate::functions::unions::MANY;
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::{Claim, Function, Leaf, Node, NodeId, ShapeId};
use crate::rules::Rule;
use rustc_hash::FxHashMap;

/// A formula is flat if its slope is less than this in such a share of places about its solid.
const FLAT: f64 = 0.8;
const SHARE: f64 = 0.25;
/// A longer formula is not worth its gradient at each step.
const LONGEST: usize = 40;
/// How many places say how steep it is.
const PLACES: usize = 33;

/// How a formula bends along straight lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Bend {
    /// It is the same at all points.
    Still,
    /// It is straight.
    Straight,
    /// It is convex.
    Convex,
    /// Nobody knows.
    Unknown,
}

impl Builder<'_> {
    /// What a formula that is no steeper than a distance, convex and flat, says of the way to its solid: outside over its gradient, inside as it
    /// is. None for any other.
    pub(super) fn convex_way(&mut self, node: NodeId, domain: &Domain) -> Option<NodeId> {
        if !self.facts.rules.has(Rule::Convex) {
            return None;
        }
        if self.is_crowded() || self.facts.weight(self.graph, node) > LONGEST || !self.is_convex(node, domain) || !self.is_flat(node, domain) {
            return None;
        }
        let gradient = self.gradient(node);
        let steepness = self.graph.op(Op::Length3, &gradient);
        // Where it is level it is nowhere less, so there is no solid if it is positive.
        let least = self.graph.constant(1e-6);
        let steepness = self.graph.op(Op::Max, &[steepness, least]);
        let outside = self.graph.op(Op::Div, &[node, steepness]);
        let zero = self.graph.constant(0.0);
        let is_outside = self.graph.op(Op::Lt, &[zero, node]);
        Some(self.graph.op(Op::Select, &[is_outside, outside, node]))
    }

    /// Whether the scene has so many parts that they may be a union of many: its cells are found by intervals, and a quotient by a gradient says
    /// little over one.
    pub(super) fn is_crowded(&mut self) -> bool {
        if let Some(known) = self.crowded {
            return known;
        }
        // A shape's users have larger indices, so what it calls is counted before it.
        let mut parts: FxHashMap<ShapeId, usize> = FxHashMap::default();
        let shapes: Vec<(ShapeId, NodeId)> = self.graph.shapes().map(|(id, s)| (id, s.value)).collect();
        let mut nodes = Vec::new();
        for (shape, value) in shapes {
            let inner = self.calls(&[value], &mut nodes).map(|(inner, _)| parts.get(&inner).copied().unwrap_or(1));
            let sum = inner.fold(0usize, usize::saturating_add);
            parts.insert(shape, sum.max(1));
        }
        let crowded = parts.get(&self.root).is_some_and(|parts| *parts >= MANY);
        self.crowded = Some(crowded);
        crowded
    }

    fn is_flat(&mut self, node: NodeId, domain: &Domain) -> bool {
        let region = self.facts.rough_region(self.graph, node, domain);
        if region.is_empty() || !region.is_finite() {
            return false;
        }
        // Along each axis by a part of its own: what is thin may be flat only where it is thin.
        let domain = domain.at(Box3(region.0.map(|side| Interval::new(side.lo - 0.25 * side.width(), side.hi + 0.25 * side.width()))));
        let target = Target::Value(node);
        let parameters = self.parameters_of(&target);
        Search { target, domain, parameters, rules: self.facts.rules }.quantile(self.graph, PLACES, SHARE) < FLAT
    }

    /// Whether a formula grows evenly along every straight line, as that of a plane does.
    pub(super) fn is_straight(&mut self, node: NodeId) -> bool {
        let short = !self.graph.reads(node).shapes && self.facts.weight(self.graph, node) <= LONGEST;
        short && self.bend_of(node, &Domain::of(Box3::ALL)) == Bend::Straight
    }

    fn is_convex(&mut self, node: NodeId, domain: &Domain) -> bool {
        self.bend_of(node, domain) == Bend::Convex
    }

    fn bend_of(&mut self, node: NodeId, domain: &Domain) -> Bend {
        let order = self.graph.reachable(&[node]);
        let mut bends: FxHashMap<NodeId, Bend> = FxHashMap::default();
        for &id in &order {
            let bend = self.bend(id, &bends, domain);
            bends.insert(id, bend);
        }
        bends.get(&node).copied().unwrap_or(Bend::Unknown)
    }

    /// Of `length(max(a, 0), max(b, 0)) + min(max(a, b), 0)`, the distance to where both are below zero, which grows with both and is convex: both.
    fn corner_of(&self, one: NodeId, other: NodeId) -> Option<[NodeId; 2]> {
        let but_zero = |id: NodeId, wanted: Op| {
            let (a, b) = self.graph.two(id, wanted)?;
            if self.graph.as_constant(b) == Some(0.0) { Some(a) } else { (self.graph.as_constant(a) == Some(0.0)).then_some(b) }
        };
        let (beyond, within) = if self.graph.two(one, Op::Length2).is_some() { (one, other) } else { (other, one) };
        let (a, b) = self.graph.two(beyond, Op::Length2)?;
        let (a, b) = (but_zero(a, Op::Max)?, but_zero(b, Op::Max)?);
        let largest = self.graph.two(but_zero(within, Op::Min)?, Op::Max)?;
        (largest == (a, b) || largest == (b, a)).then_some([a, b])
    }

    fn bend(&mut self, node: NodeId, bends: &FxHashMap<NodeId, Bend>, domain: &Domain) -> Bend {
        let of = |id: &NodeId| bends.get(id).copied().unwrap_or(Bend::Unknown);
        let node = self.graph.node(node).clone();
        let (op, args) = match &node {
            Node::Constant(_) => return Bend::Still,
            Node::Leaf(Leaf::P(_)) => return Bend::Straight,
            Node::Leaf(Leaf::Parameter(_) | Leaf::Time) => return Bend::Still,
            Node::Claim(args, Claim::Lipschitz(..)) => return args.first().map_or(Bend::Unknown, of),
            // A shape at a point that moves straight bends as it does by itself.
            Node::Call(shape, Function::Field, args) if args.iter().map(of).max().is_some_and(|worst| worst <= Bend::Straight) => {
                let value = self.graph.shape(*shape).filter(|shape| self.graph.reads(shape.value).variables == 0).map(|shape| shape.value);
                return value.map_or(Bend::Unknown, |value| self.bend_of(value, &Domain::of(Box3::ALL)));
            }
            Node::Op(op, args) => (*op, args),
            _ => return Bend::Unknown,
        };
        if args.iter().all(|a| of(a) == Bend::Still) {
            return Bend::Still;
        }
        let (Some(&a), b) = (args.first(), args.get(1).copied()) else { return Bend::Unknown };
        let worst = args.iter().map(of).max().unwrap_or(Bend::Unknown);
        let all_straight = worst <= Bend::Straight;
        if let (Op::Add, Some(b), Bend::Unknown) = (op, b, worst)
            && let Some(sides) = self.corner_of(a, b)
        {
            return if sides.iter().all(|side| of(side) < Bend::Unknown) { Bend::Convex } else { Bend::Unknown };
        }
        // What grows with what is not below zero.
        if matches!(op, Op::Square | Op::Length2 | Op::Length3 | Op::Length4) && worst == Bend::Convex {
            let mut grows = args.iter().map(|a| of(a) <= Bend::Straight || self.facts.range(self.graph, *a, domain).lo >= 0.0);
            return if grows.all(|grows| grows) { Bend::Convex } else { Bend::Unknown };
        }
        // A multiple of what bends must not turn it over.
        let mut multiple = |factor: NodeId, bend: Bend| match bend {
            Bend::Convex if self.facts.range(self.graph, factor, domain).lo < 0.0 => Bend::Unknown,
            bend => bend,
        };
        match (op, b) {
            (Op::Add | Op::Max, _) => match (op, worst) {
                (Op::Max, Bend::Straight) => Bend::Convex,
                (_, worst) => worst,
            },
            (Op::Sub, Some(b)) if of(&b) <= Bend::Straight => of(&a).max(of(&b)),
            (Op::Neg, _) if all_straight => worst,
            // Coordinates that are turned by an angle.
            (Op::TurnU | Op::TurnV, Some(b)) if args.get(2).is_some_and(|t| of(t) == Bend::Still) && of(&a).max(of(&b)) == Bend::Straight => Bend::Straight,
            (Op::Abs | Op::Square | Op::Length2 | Op::Length3 | Op::Length4, _) if all_straight => Bend::Convex,
            (Op::Mul, Some(b)) if of(&b) == Bend::Still => multiple(b, of(&a)),
            (Op::Mul, Some(b)) if of(&a) == Bend::Still => multiple(a, of(&b)),
            (Op::Div, Some(b)) if of(&b) == Bend::Still => multiple(b, of(&a)),
            _ => Bend::Unknown,
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]
mod tests {
    use crate::evaluate::Tape;
    use crate::graph::Function;
    use crate::{MemoryLoader, Options, compile};

    /// Of a scene the field, the bound and the estimate at a place.
    fn at(text: &str, place: [f64; 3]) -> [f64; 3] {
        let loader = MemoryLoader::new().with("main.sdf", text);
        let scene = compile(&loader, "main.sdf", &Options::default()).compiled.unwrap();
        let roots = [Function::Field, Function::Bound, Function::Distance].map(|f| scene.functions.formulas[&(scene.root, f)]);
        let tape = Tape::new(&scene.graph, &scene.functions.formulas, &roots, &scene.live(), 1_000_000).unwrap();
        let mut found = [0.0; 3];
        tape.evaluator().at(&[place], &[], |_, values| found.copy_from_slice(values));
        found
    }

    #[test]
    fn an_ellipsoid_is_as_near_as_its_gradient_says() {
        let text = "scene = ellipsoid((2, 0.1, 1))";
        // Along the longest axis the field is a twentieth of the distance, the bound and the estimate are all of it.
        let [field, bound, estimate] = at(text, [3.0, 0.0, 0.0]);
        assert!((field - 0.05).abs() < 1e-9 && (bound - 1.0).abs() < 1e-6 && (estimate - 1.0).abs() < 1e-6, "{field} {bound} {estimate}");
        // Inside it is the field: no solid's inside is convex.
        let [field, bound, estimate] = at(text, [1.0, 0.0, 0.0]);
        assert!(field < 0.0 && bound == field && estimate == field);
        // Half as steep as a whole it is twice as far, inside too, for the bound as for the estimate.
        let [field, bound, estimate] = at("field f = (length(p / (4, 1, 1)) - 1) / 2\nscene = f", [0.5, 0.1, 0.0]);
        assert!((bound - 2.0 * field).abs() < 1e-6 && (estimate - bound).abs() < 1e-6, "{field} {bound} {estimate}");
    }

    #[test]
    fn what_is_drawn_and_extruded_is_as_convex_as_the_drawing() {
        let [field, bound, estimate] = at("scene = ellipse((1, 0.3)).extrude(0.2)", [1.2, 0.0, 0.0]);
        assert!((field - 0.06).abs() < 1e-7 && (bound - 0.2).abs() < 1e-6 && (estimate - 0.2).abs() < 1e-6, "{field} {bound} {estimate}");
        // Beside an edge no more than the way to it.
        let [_, bound, estimate] = at("scene = ellipse((1, 0.3)).extrude(0.2)", [1.2, 0.0, 0.3]);
        assert!(bound <= 0.2f64.hypot(0.2) && bound > 0.2 && (estimate - bound).abs() < 1e-6, "{bound} {estimate}");
    }

    #[test]
    fn what_is_not_convex_or_stands_in_a_crowd_keeps_its_field() {
        let hollow = "field f = 1 - length(p / (4, 1, 1))\nscene = f & box(9)";
        let [field, bound, _] = at(hollow, [0.5, 0.1, 0.0]);
        assert!(bound <= field + 1e-12, "{field} {bound}");
        let many = "scene = for i in 0..30 { ellipsoid((2, 0.1, 1)).translate(0, i, 0) }";
        let [field, bound, _] = at(many, [3.0, 0.0, 0.0]);
        assert!((bound - field).abs() < 1e-9, "{field} {bound}");
    }
}
