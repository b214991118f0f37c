//! From the graph of a scene to the functions that a module holds: field, bound, distance, gradient, surface.
//!
//! The *field* is what the formulas say. The *bound* says how far a ray may step: operands of `min` and `max` are normalised one
//! by one, smooth groups as a whole, and a formula without a constant over all space behind its region. The *distance* is the
//! estimate that light and contact use: it is composed in the same way and never holds a factor.

use crate::analysis::search::{Search, Target, ROUNDING};
use crate::analysis::{Box3, Constant, Domain, Facts};
use crate::compiled::SceneBlocks;
use crate::diagnostic::{Code, Diagnostic};
use crate::graph::interval::Interval;
use crate::graph::kernel::{self, Op};
use crate::graph::{Claim, Exactness, Factor, Function, Graph, Leaf, MaterialId, Node, NodeId, Proof, ShapeId, FAR, WORLD};
use crate::source::Span;
use rustc_hash::{FxHashMap, FxHashSet};

/// The formulas of every function of every shape that the root's functions call.
#[derive(Clone, Debug, Default)]
pub struct Functions {
    /// Formula by shape and function, in the shape's own space: it reads `p`, the shape's variables, parameters, time, factors,
    /// and calls functions of other shapes. `Gradient(0..=2)` are present together or not at all.
    pub formulas: FxHashMap<(ShapeId, Function), NodeId>,
    /// The root's surface, in the scene's space: it reads `p`, `Normal`, and calls fields.
    pub surface: Surface,
    /// What each of [`Graph::factors`] was found from; none for one that is measured.
    pub searches: Vec<Option<Search>>,
}

/// How the surface at a point answers light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Surface {
    /// Linear colour.
    pub color: [NodeId; 3],
    /// Light of its own, linear.
    pub emission: [NodeId; 3],
    /// 0 to 1.
    pub roughness: NodeId,
    /// 0 to 1.
    pub metallic: NodeId,
    /// 0 to 1.
    pub reflectivity: NodeId,
}

/// What is known of a scene, in numbers that a person may ask for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Nodes of the graph of its field, calls not opened.
    pub nodes: usize,
    /// Shapes that are made of numbers alone.
    pub primitives: usize,
    /// The largest Lipschitz factor; 1 where none was needed.
    pub factor: f64,
    /// What is known of the field as a whole.
    pub kind: Kind,
    /// Least and greatest corner of a box that holds the solid, where there is one within the extent.
    pub bounds: Option<[[f64; 3]; 2]>,
}

/// What is known of a scene's value as a whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// The signed distance itself.
    Exact,
    /// Changes by no more than the distance of two points, times a factor.
    Lipschitz,
    /// A bound outside and inside that is no Lipschitz function: regions are in it.
    Bound,
    /// Something in it is only measured: rays may step too far.
    Unproven,
}

/// Boxes that one constant may cost.
const BUDGET: usize = 192;
/// How far a ray steps across a jump, for each unit of the size of what jumps: more than 32 bits can lose.
const HAIR: f64 = 4e-6;
/// How far a ray steps across a jump at most.
pub(crate) const LONGEST_HAIR: f64 = 25.0 * HAIR;
/// A formula that is steeper than this has no bound that is of any use.
const STEEPEST: f64 = 1e4;
/// A constant over all space up to here is not worth a region.
const GENTLE: f64 = 1.2;
/// A formula of more steps than this is given a region only where much is gained.
const LONG: usize = 150;
/// Points at which a formula is looked at where nothing is proven.
const SAMPLES: usize = 4096;
/// A constant up to here counts as one.
const UNIT: f64 = 1.0 + 1e-6;

/// How a formula becomes a bound.
#[derive(Clone, Copy, Debug)]
struct Treatment {
    constant: f64,
    jumps: bool,
    /// The formula is trusted only here; beyond it the distance to this box is the bound.
    region: Option<(Box3, f64)>,
    proof: Proof,
    /// Whether the constant is that of all space.
    everywhere: bool,
}

/// A constant, how it is known, and of what over which domain.
struct Known {
    lipschitz: f64,
    proof: Proof,
    search: Option<(Target, Domain)>,
}

/// The domain that the parts of a formula with a region need, the region, and how far beyond it the formula is trusted.
type Narrowed = (Domain, Box3, f64);

/// What is made on the way from graph to functions.
pub struct Builder<'a> {
    graph: &'a mut Graph,
    facts: &'a mut Facts,
    root: ShapeId,
    extent: f64,
    domains: FxHashMap<ShapeId, Domain>,
    treatments: FxHashMap<(ShapeId, NodeId, Vec<u64>, bool), Option<Treatment>>,
    regions: FxHashMap<(NodeId, Vec<u64>, bool), Option<Narrowed>>,
    built: Functions,
    /// What was found on the way.
    pub diagnostics: Vec<Diagnostic>,
    /// What is known of the whole.
    pub kind: Kind,
    /// Whether what can't be proven is an error.
    strict: bool,
    surfaces: FxHashMap<NodeId, Option<Look>>,
}

/// The nine numbers of a surface, or that nothing gives it a material.
type Look = [NodeId; 9];

/// The scene's shape with `world` bound: in the scene's own space the point of the scene is the point. So whatever reads it further in
/// is seen to move with the point.
pub fn bind_world(graph: &mut Graph, root: ShapeId) -> ShapeId {
    let Some(shape) = graph.shape(root).cloned() else { return root };
    let point = graph.point();
    let bound = graph.substitute(&[shape.value], |leaf| match leaf {
        Leaf::Variable(v) if v < WORLD + 3 => point.get((v - WORLD) as usize).copied(),
        _ => None,
    });
    let value = bound.first().copied().unwrap_or(shape.value);
    graph.add_shape(crate::graph::Shape { value, ..shape })
}

/// Builds the functions of a scene whose shape has been through [`bind_world`].
pub fn build(
    graph: &mut Graph,
    facts: &mut Facts,
    root: ShapeId,
    blocks: &SceneBlocks,
    strict: bool,
) -> (Functions, Summary, Vec<Diagnostic>) {
    let mut builder = Builder {
        graph,
        facts,
        root,
        extent: blocks.extent,
        domains: FxHashMap::default(),
        treatments: FxHashMap::default(),
        regions: FxHashMap::default(),
        built: Functions::default(),
        diagnostics: Vec::new(),
        kind: Kind::Exact,
        strict,
        surfaces: FxHashMap::default(),
    };
    builder.find_domains();
    let mut functions = vec![
        (root, Function::Field),
        (root, Function::Bound),
        (root, Function::Distance),
        (root, Function::Gradient(0)),
        (root, Function::Gradient(1)),
        (root, Function::Gradient(2)),
    ];
    builder.build_surface();
    let surface = builder.built.surface;
    let mut surface_nodes = surface.color.to_vec();
    surface_nodes.extend(surface.emission);
    surface_nodes.extend([surface.roughness, surface.metallic, surface.reflectivity]);
    functions.extend(builder.calls(&surface_nodes));
    while let Some((shape, function)) = functions.pop() {
        if builder.built.formulas.contains_key(&(shape, function)) {
            continue;
        }
        for (function, formula) in builder.formulas_of(shape, function) {
            builder.built.formulas.insert((shape, function), formula);
            functions.extend(builder.calls(&[formula]));
        }
    }
    let summary = builder.summary();
    (builder.built, summary, builder.diagnostics)
}

impl Kind {
    /// Its name in tables and in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Exact => "exact",
            Kind::Lipschitz => "lipschitz",
            Kind::Bound => "bound",
            Kind::Unproven => "unproven",
        }
    }
}

impl Builder<'_> {
    fn calls(&self, roots: &[NodeId]) -> Vec<(ShapeId, Function)> {
        self.graph
            .reachable(roots)
            .into_iter()
            .filter_map(|id| match self.graph.node(id) {
                Node::Call(shape, function, _) => Some((*shape, *function)),
                _ => None,
            })
            .collect()
    }

    fn summary(&mut self) -> Summary {
        let mut shapes = vec![self.root];
        let mut seen: FxHashSet<ShapeId> = FxHashSet::default();
        let mut nodes: FxHashSet<NodeId> = FxHashSet::default();
        let mut primitives = 0;
        while let Some(shape) = shapes.pop() {
            let Some(s) = self.graph.shape(shape) else { continue };
            if !seen.insert(shape) {
                continue;
            }
            nodes.extend(self.graph.reachable(&[s.value]));
            let inner = self.calls(&[s.value]);
            primitives += usize::from(inner.is_empty() && self.graph.as_constant(s.value).is_none());
            shapes.extend(inner.into_iter().map(|(s, _)| s));
        }
        let factor = self.graph.factors.iter().map(|f| f.lipschitz).fold(1.0, f64::max);
        let domain = self.domain(self.root);
        let bounds = self
            .graph
            .shape(self.root)
            .map(|s| s.value)
            .map(|value| self.facts.rough_region(self.graph, value, &domain))
            .filter(|r| !r.is_empty() && r.0.iter().all(|i| i.lo > -self.extent && i.hi < self.extent))
            .map(|r| [r.0.map(|i| i.lo), r.0.map(|i| i.hi)]);
        Summary { nodes: nodes.len(), primitives, factor, kind: self.kind, bounds }
    }

    /// Where each shape's formula is asked for, from the extent of the scene inward.
    fn find_domains(&mut self) {
        let world = [0, 1, 2].map(|i| (WORLD + i, Interval::new(-self.extent, self.extent)));
        let root = Domain { point: Box3::cube(self.extent), variables: world.to_vec(), narrowed: false, tube: None };
        self.domains.insert(self.root, root);
        let mut order: Vec<ShapeId> = vec![self.root];
        let mut seen: FxHashSet<ShapeId> = order.iter().copied().collect();
        let mut at = 0;
        while let Some(&shape) = order.get(at) {
            at += 1;
            let Some(s) = self.graph.shape(shape) else { continue };
            let masks = s.paints.iter().map(|(m, _)| *m);
            let inner = self.calls(&[s.value]).into_iter().map(|(s, _)| s).chain(masks);
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
    fn visit(&mut self, node: NodeId, domain: &Domain) {
        match self.graph.node(node).clone() {
            Node::Op(op @ (Op::Min | Op::Max), args) => {
                let near = if op == Op::Max { self.narrowed(node, domain) } else { None };
                let inner = near.as_ref().map_or(domain, |(d, _, _)| d).clone();
                for arg in args.iter() {
                    self.visit(*arg, &inner);
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

    fn visit_all(&mut self, node: NodeId, domain: &Domain) {
        let tape = self.facts.tape(self.graph, node);
        let ranges = self.facts.ranges_of(self.graph, &tape, domain);
        for step in &tape.steps {
            if let crate::analysis::tape::Step::Call(inner, args) = step {
                let args: Vec<Interval> = args
                    .iter()
                    .map(|&a| ranges.get(a).copied().unwrap_or(Interval::ALL))
                    .collect();
                let variables =
                    self.graph.shape(*inner).map(|s| s.variables.clone()).unwrap_or_default();
                let mut own = crate::analysis::call_domain(&variables, &args);
                own.narrowed = domain.narrowed;
                self.widen(*inner, own);
            }
        }
    }

    /// For an intersection or a moved shape that has no constant over all space: its region, how far beyond it is trusted, and the domain
    /// that its parts then need. None where it needs no region.
    fn narrowed(&mut self, node: NodeId, domain: &Domain) -> Option<Narrowed> {
        let key = (node, domain.key(), domain.narrowed);
        if let Some(known) = self.regions.get(&key) {
            return known.clone();
        }
        let found = self.find_narrowed(node, domain);
        self.regions.insert(key, found.clone());
        found
    }

    fn find_narrowed(&mut self, node: NodeId, domain: &Domain) -> Option<Narrowed> {
        let everywhere = domain.at(Box3::ALL);
        let unbounded = match self.graph.node(node).clone() {
            Node::Call(_, _, args) => {
                let point = args.get(..3).unwrap_or(&args);
                self.facts.map_constant(self.graph, point, &everywhere, 1).lipschitz > STEEPEST
            }
            Node::Op(_, args) => args.iter().any(|&a| {
                self.facts.constant(self.graph, a, &everywhere, 1).lipschitz > STEEPEST
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

    fn widen(&mut self, shape: ShapeId, domain: Domain) {
        let wider = match self.domains.get(&shape) {
            Some(known) => known.hull(&domain),
            None => domain,
        };
        self.domains.insert(shape, wider);
    }

    fn domain(&self, shape: ShapeId) -> Domain {
        self.domains.get(&shape).cloned().unwrap_or(Domain::of(Box3::cube(self.extent)))
    }

    /// The formula of a function of a shape; of a gradient, all three.
    fn formulas_of(&mut self, shape: ShapeId, function: Function) -> Vec<(Function, NodeId)> {
        let Some(s) = self.graph.shape(shape) else { return Vec::new() };
        let value = s.value;
        match function {
            Function::Field => vec![(function, value)],
            Function::Bound => {
                let domain = self.domain(shape);
                let bound = self.bound(shape, value, &domain, false);
                vec![(function, bound)]
            }
            Function::Distance => {
                let domain = self.domain(shape);
                let distance = self.distance(shape, value, &domain);
                vec![(function, distance)]
            }
            Function::Gradient(_) => {
                let gradient = self.gradient(value);
                (0..3).zip(gradient).map(|(i, g)| (Function::Gradient(i), g)).collect()
            }
        }
    }

    /// Whether a node is the same everywhere in the space in which it stands.
    fn is_uniform(&self, node: NodeId) -> bool {
        !self.graph.reachable(&[node]).iter().any(|&id| {
            matches!(
                self.graph.node(id),
                Node::Leaf(Leaf::P(_) | Leaf::Normal(_) | Leaf::Variable(_)) | Node::Call(..)
            )
        })
    }

    /// How far a ray may step by a formula of a shape. `continuous`: jumps of the formula itself cancel.
    fn bound(&mut self, shape: ShapeId, node: NodeId, domain: &Domain, continuous: bool) -> NodeId {
        match self.graph.node(node).clone() {
            Node::Constant(_) => node,
            Node::Op(op @ (Op::Min | Op::Max), args) => {
                let near = if op == Op::Max { self.narrowed(node, domain) } else { None };
                let inner = near.as_ref().map_or(domain, |(d, _, _)| d);
                let args: Vec<NodeId> =
                    args.iter().map(|a| self.bound(shape, *a, inner, continuous)).collect();
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
                let a = self.bound(shape, a, domain, continuous);
                let b = self.bound(shape, b, domain, continuous);
                self.graph.op(Op::Select, &[c, a, b])
            }
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
                let has_parts = matches!(
                    self.graph.node(inner),
                    Node::Op(Op::Min | Op::Max | Op::Neg | Op::Select | Op::Mul | Op::Div, _)
                        | Node::Call(..)
                        | Node::Claim(_, Claim::Continuous)
                );
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
            _ => self.normalised(shape, node, domain, continuous),
        }
    }

    /// A function of a shape that is scaled as a whole, `k s(p / k)`: it is scaled in the same way. None where the map does more than that.
    fn scaled_call(
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
        let constant = match (numerators, self.graph.as_constant(factor)) {
            (Some(numerators), _) => self.facts.map_constant(self.graph, &numerators, &everywhere, 1).lipschitz,
            (None, Some(k)) => k * self.facts.map_constant(self.graph, point, &everywhere, 1).lipschitz,
            _ => return None,
        };
        if moving || constant > UNIT {
            return None;
        }
        let inner = self.graph.call(shape, function, &args);
        Some(self.graph.op(Op::Mul, &[factor, inner]))
    }

    /// The bound of another shape at a moved point.
    fn bound_of_call(
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
        if all.jumps && !continuous {
            return self.normalised(shape, node, domain, continuous);
        }
        let call = self.graph.call(inner, Function::Bound, args);
        if all.lipschitz <= UNIT {
            return call;
        }
        let of_map = |constant: &Constant, domain: Domain, proof: Proof| Known {
            lipschitz: constant.lipschitz,
            proof,
            search: Some((Target::Map(point.to_vec()), domain)),
        };
        if all.lipschitz <= STEEPEST {
            self.kind = self.kind.max(Kind::Lipschitz);
            return self.scaled(call, of_map(&all, everywhere, Proof::Proven), node, shape);
        }
        let Some((region, reach)) = self.region_of(node, domain) else { return self.graph.constant(FAR) };
        let tube = self.tube(inner, point, &region);
        let tube_and_reach = tube.map(|(axis, radius)| (axis, radius + reach));
        let near = Domain { tube: tube_and_reach, ..domain.at(region.grow(reach)) };
        let constant = self.facts.map_constant(self.graph, point, &near, BUDGET);
        if constant.lipschitz > STEEPEST {
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
        self.behind(region, tube, reach, inside)
    }

    /// A formula over its constant, behind its region where it needs one.
    fn normalised(&mut self, shape: ShapeId, node: NodeId, domain: &Domain, continuous: bool) -> NodeId {
        let treatment = match self.treatment(shape, node, domain, continuous) {
            Some(treatment) => treatment,
            None => match self.measured(shape, node, domain) {
                Some(treatment) => treatment,
                None => return node,
            },
        };
        self.kind = self.kind.max(if self.is_exact(shape, node) { Kind::Exact } else { Kind::Lipschitz });
        let mut value = if (treatment.constant - 1.0).abs() <= 1e-6 {
            node
        } else {
            let at = match treatment.region {
                Some((region, reach)) => domain.at(region.grow(reach)),
                None if treatment.everywhere => domain.at(Box3::ALL),
                None => domain.clone(),
            };
            let known = Known {
                lipschitz: treatment.constant,
                proof: treatment.proof,
                search: (treatment.proof != Proof::Measured).then_some((Target::Value(node), at)),
            };
            self.scaled(node, known, node, shape)
        };
        if treatment.jumps && !continuous {
            value = self.stop_at_jumps(shape, node, value, domain, &treatment);
        }
        match treatment.region {
            Some((region, reach)) => self.behind(region, None, reach, value),
            None => value,
        }
    }

    /// Where nothing finite is proven: what 99 of 100 samples do not exceed, and half as much again. None where not even samples help.
    fn measured(&mut self, shape: ShapeId, node: NodeId, domain: &Domain) -> Option<Treatment> {
        let span = self.place(shape, node);
        let region = self.region_of(node, domain);
        let term = self.facts.steep_term(self.graph, node, domain, STEEPEST);
        let (at, why, instead) = match &term {
            Some(term) => (self.graph.location(term.node).unwrap_or(span), term.why(), term.instead()),
            None => (span, "it grows without a limit that is known", "keep the shape within a region with `.within(box(…))`"),
        };
        let Some((region, reach)) = region else {
            let region = Some((Box3::EMPTY, 0.0));
            return Some(Treatment { constant: 1.0, jumps: false, region, proof: Proof::Proven, everywhere: false });
        };
        let near = domain.at(region.grow(reach).intersect(&Box3::cube(self.extent)));
        let steepest = self.facts.sampled_constant(self.graph, node, &near, SAMPLES);
        // So steep that a ray would not get anywhere.
        let finite = steepest > 0.0 && steepest < 100.0 * STEEPEST;
        let (code, message) = if !finite {
            (Code::NoBound, format!("no finite bound is known for this formula, so no ray could step safely: {why}"))
        } else if self.strict {
            (Code::NoBound, format!("no bound is proven for this formula: {why}"))
        } else {
            (Code::Unproven, format!("no bound is proven for this formula; it is drawn with a measured factor: {why}"))
        };
        self.diagnostics.push(Diagnostic::new(code, at, message, instead));
        self.kind = self.kind.max(Kind::Unproven);
        finite.then_some(Treatment {
            constant: 1.5 * steepest,
            jumps: self.facts.constant(self.graph, node, &near, 1).jumps,
            region: Some((region, reach)),
            proof: Proof::Measured,
            everywhere: false,
        })
    }

    fn is_exact(&self, shape: ShapeId, node: NodeId) -> bool {
        self.graph
            .shape(shape)
            .is_some_and(|s| s.value == node && s.exactness == Exactness::Exact)
    }

    /// What a formula needs in order to be a bound; none where nothing finite is known.
    fn treatment(
        &mut self,
        shape: ShapeId,
        node: NodeId,
        domain: &Domain,
        continuous: bool,
    ) -> Option<Treatment> {
        let key = (shape, node, domain.key(), continuous);
        if let Some(known) = self.treatments.get(&key) {
            return *known;
        }
        let found = self.find_treatment(shape, node, domain, continuous);
        self.treatments.insert(key, found);
        found
    }

    fn find_treatment(
        &mut self,
        shape: ShapeId,
        node: NodeId,
        domain: &Domain,
        continuous: bool,
    ) -> Option<Treatment> {
        let everywhere = domain.at(Box3::ALL);
        let mut all = self.facts.constant(self.graph, node, &everywhere, 1);
        if self.is_exact(shape, node) {
            all = Constant { lipschitz: 1.0, jumps: false };
        }
        if all.lipschitz == 0.0 {
            // The same everywhere: any step is right, and so is this.
            return Some(Treatment { constant: 1.0, jumps: all.jumps, region: None, proof: Proof::Proven, everywhere: true });
        }
        let claimed = matches!(self.graph.node(node), Node::Claim(_, Claim::Lipschitz(..)));
        let mut by_rule = if claimed { Proof::Claimed } else { Proof::Proven };
        let plain = all.lipschitz.is_finite() && (!all.jumps || continuous);
        if plain && all.lipschitz > UNIT && !claimed {
            // What repeats, and what is a sum, can be searched over all space.
            all = self.facts.constant(self.graph, node, &everywhere, BUDGET);
            by_rule = Proof::Derived;
        }
        let long = self.facts.weight(self.graph, node) > LONG;
        if plain && all.lipschitz <= if long { 4.0 } else { GENTLE } {
            return Some(Treatment { constant: all.lipschitz, jumps: false, region: None, proof: by_rule, everywhere: true });
        }
        // A region of its own: tighter, or the only way.
        let Some((region, reach)) = self.region_of(node, domain) else {
            // Nothing solid in the extent.
            let region = Some((Box3::EMPTY, 0.0));
            return Some(Treatment { constant: 1.0, jumps: false, region, proof: Proof::Proven, everywhere: false });
        };
        let bounded = region != domain.point;
        let near = domain.at(region.grow(reach));
        let constant = self.facts.constant(self.graph, node, &near, BUDGET);
        if plain && all.lipschitz <= STEEPEST && (!bounded || constant.lipschitz > 0.85 * all.lipschitz) {
            return Some(Treatment { constant: all.lipschitz, jumps: false, region: None, proof: by_rule, everywhere: true });
        }
        if constant.lipschitz > STEEPEST || constant.lipschitz.is_nan() {
            return None;
        }
        if !bounded && !domain.narrowed && !all.lipschitz.is_finite() {
            self.extent_used(shape, node);
        }
        let needed = bounded || !domain.narrowed && !all.lipschitz.is_finite();
        let lipschitz = constant.lipschitz.max(1e-6);
        Some(Treatment {
            constant: lipschitz,
            jumps: constant.jumps && !continuous,
            region: needed.then_some((region, reach)),
            proof: Proof::Derived,
            everywhere: false,
        })
    }

    /// Where a formula is solid within its domain, and how far beyond that it is trusted. None where it is nowhere solid.
    fn region_of(&mut self, node: NodeId, domain: &Domain) -> Option<(Box3, f64)> {
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
    fn tube(&mut self, inner: ShapeId, point: &[NodeId], region: &Box3) -> Option<(usize, f64)> {
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

    /// `inside` near the region, the distance to the region beyond; the region is cut down to a tube about an axis where there is one.
    fn behind(&mut self, region: Box3, tube: Option<(usize, f64)>, reach: f64, inside: NodeId) -> NodeId {
        if region.is_empty() {
            return self.graph.constant(FAR);
        }
        self.kind = self.kind.max(Kind::Bound);
        let point = self.graph.point();
        let zero = self.graph.constant(0.0);
        let mut outside = Vec::new();
        if let Some((axis, radius)) = tube {
            let across: Vec<NodeId> = (1..3).filter_map(|i| point.get((axis + i) % 3).copied()).collect();
            let from = self.graph.op(Op::Length2, &across);
            let radius = self.graph.constant(radius);
            let beyond = self.graph.op(Op::Sub, &[from, radius]);
            outside.push(self.graph.op(Op::Max, &[beyond, zero]));
        }
        for (i, coordinate) in point.into_iter().enumerate() {
            if tube.is_some_and(|(axis, _)| axis != i) {
                continue;
            }
            let side = region.axis(i);
            if !side.is_finite() {
                continue;
            }
            let middle = self.graph.constant(side.middle());
            let half = self.graph.constant((side.hi - side.middle()).max(side.middle() - side.lo));
            let from = self.graph.op(Op::Sub, &[coordinate, middle]);
            let from = self.graph.op(Op::Abs, &[from]);
            let beyond = self.graph.op(Op::Sub, &[from, half]);
            outside.push(self.graph.op(Op::Max, &[beyond, zero]));
        }
        let distance = match outside.len() {
            0 => return inside,
            1 => outside.first().copied().unwrap_or(zero),
            2 => self.graph.op(Op::Length2, &outside),
            _ => self.graph.op(Op::Length3, &outside),
        };
        self.graph.name_node(distance, "outside");
        let limit = self.graph.constant(reach);
        let far = self.graph.op(Op::Lt, &[limit, distance]);
        self.graph.op(Op::Select, &[far, distance, inside])
    }

    /// A value times the multiple of a new factor.
    fn scaled(&mut self, value: NodeId, constant: Known, at: NodeId, shape: ShapeId) -> NodeId {
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
            Search { target, domain, parameters }
        });
        let known = self.graph.factors.iter().zip(&self.built.searches).position(|(f, s)| *f == factor && *s == search);
        let index = known.unwrap_or_else(|| {
            self.graph.factors.push(factor);
            self.built.searches.push(search);
            self.graph.factors.len() - 1
        });
        let factor = self.graph.intern(Node::Factor(index as u32));
        self.graph.op(Op::Mul, &[value, factor])
    }

    /// The components of parameters that a constant depends on.
    fn parameters_of(&self, target: &Target) -> Vec<u32> {
        let nodes = match target {
            Target::Value(node) => std::slice::from_ref(node),
            Target::Map(point) => point,
        };
        let mut read: Vec<u32> = self.graph.parameters_under(nodes).into_iter().collect();
        read.sort_unstable();
        read
    }

    fn place(&self, shape: ShapeId, node: NodeId) -> Span {
        let of_shape = self.graph.shape(shape).map(|s| s.span);
        self.graph.location(node).or(of_shape).unwrap_or(Span::new(crate::source::FileId(0), 0, 0))
    }

    fn extent_used(&mut self, shape: ShapeId, node: NodeId) {
        let span = self.place(shape, node);
        self.diagnostics.push(Diagnostic::new(
            Code::ExtentUsed,
            span,
            format!(
                "this has no bound over all space; it is proven and drawn within the scene's extent of {}",
                self.extent
            ),
            "keep it within a region with `.within(box(…))`, or set `render { extent: … }` to what the scene needs",
        ));
    }

    /// A ray stops before a jump and looks again just behind it.
    fn stop_at_jumps(
        &mut self,
        shape: ShapeId,
        node: NodeId,
        value: NodeId,
        domain: &Domain,
        treatment: &Treatment,
    ) -> NodeId {
        let near = match treatment.region {
            Some((region, reach)) => domain.at(region.grow(reach)),
            None => domain.clone(),
        };
        // The jumps of shapes inside stand in their own formulas: all is laid open.
        let Some(flat) = self.graph.flatten(&[node], 200_000) else { return value };
        let tape = crate::analysis::tape::Tape::new(self.graph, &flat);
        let duals = self.facts.all_duals(self.graph, &tape, &near);
        let mut sites: Vec<(Op, Vec<NodeId>)> = Vec::new();
        for (i, step) in tape.steps.iter().enumerate() {
            let crate::analysis::tape::Step::Op(op, args) = step else { continue };
            let moving = args.iter().any(|&a| duals.get(a).is_some_and(|d| d.norm > 0.0));
            let decided = duals.get(i).is_some_and(|d| d.value.is_point());
            if !moving || decided || !op.row().jumps {
                continue;
            }
            sites.push((*op, args.iter().filter_map(|&a| tape.nodes.get(a).copied()).collect()));
        }
        let span = self.place(shape, node);
        let at = sites
            .iter()
            .flat_map(|(_, args)| args)
            .find_map(|a| self.graph.location(*a))
            .unwrap_or(span);
        self.diagnostics.push(Diagnostic::new(
            Code::Jump,
            at,
            "this formula jumps; rays stop before the jump and look again",
            "where both sides agree, write it without the jump, for example with `abs`, `min` or `repeat`",
        ));
        let mut nearest: Option<NodeId> = None;
        for (op, args) in sites {
            let Some(distance) = self.distance_to_jump(op, &args, &near) else { continue };
            nearest = Some(match nearest {
                Some(other) => self.graph.op(Op::Min, &[other, distance]),
                None => distance,
            });
        }
        let Some(nearest) = nearest else { return value };
        let hair = self.graph.constant((HAIR * near.point.size().max(0.25)).min(LONGEST_HAIR));
        let nearest = self.graph.op(Op::Max, &[nearest, hair]);
        let zero = self.graph.constant(0.0);
        let size = self.graph.op(Op::Abs, &[value]);
        let step = self.graph.op(Op::Min, &[size, nearest]);
        let minus = self.graph.op(Op::Neg, &[step]);
        let inside = self.graph.op(Op::Lt, &[value, zero]);
        self.kind = self.kind.max(Kind::Bound);
        self.graph.op(Op::Select, &[inside, minus, step])
    }

    /// How far it is at least to where an operation jumps.
    fn distance_to_jump(&mut self, op: Op, args: &[NodeId], near: &Domain) -> Option<NodeId> {
        let zero = self.graph.constant(0.0);
        let a = *args.first()?;
        let (distance, of) = match op {
            Op::Floor | Op::Ceil | Op::Trunc => {
                let whole = self.graph.op(Op::Round, &[a]);
                let from = self.graph.op(Op::Sub, &[a, whole]);
                (self.graph.op(Op::Abs, &[from]), a)
            }
            Op::Round | Op::Hash => {
                let mut least: Option<NodeId> = None;
                for &a in args {
                    let constant = self.facts.constant(self.graph, a, near, 16);
                    if constant.lipschitz == 0.0 {
                        continue;
                    }
                    // Nothing is known of how near the jump is.
                    if !constant.lipschitz.is_finite() {
                        return Some(zero);
                    }
                    let whole = self.graph.op(Op::Round, &[a]);
                    let from = self.graph.op(Op::Sub, &[a, whole]);
                    let from = self.graph.op(Op::Abs, &[from]);
                    let half = self.graph.constant(0.5);
                    let gap = self.graph.op(Op::Sub, &[half, from]);
                    let over = self.graph.constant(constant.lipschitz);
                    let gap = self.graph.op(Op::Div, &[gap, over]);
                    least = Some(match least {
                        Some(other) => self.graph.op(Op::Min, &[other, gap]),
                        None => gap,
                    });
                }
                return least;
            }
            Op::Sign => (self.graph.op(Op::Abs, &[a]), a),
            Op::Lt | Op::Le | Op::Eq => {
                let b = *args.get(1)?;
                let difference = self.graph.op(Op::Sub, &[a, b]);
                (self.graph.op(Op::Abs, &[difference]), difference)
            }
            Op::Atan2 => {
                let b = *args.get(1)?;
                // The cut is the negative half of the second axis.
                let side = self.graph.op(Op::Abs, &[a]);
                let ahead = self.graph.op(Op::Max, &[b, zero]);
                let distance = self.graph.op(Op::Length2, &[side, ahead]);
                let map = self.facts.map_constant(self.graph, &[a, b], near, 16);
                if !map.lipschitz.is_finite() {
                    return Some(zero);
                }
                let over = self.graph.constant(map.lipschitz.max(1e-9));
                return Some(self.graph.op(Op::Div, &[distance, over]));
            }
            _ => return None,
        };
        let constant = self.facts.constant(self.graph, of, near, 16);
        if !constant.lipschitz.is_finite() {
            return Some(zero);
        }
        let over = self.graph.constant(constant.lipschitz.max(1e-9));
        Some(self.graph.op(Op::Div, &[distance, over]))
    }

    /// The estimate of the distance: composed under `min` and `max`, a field where it is no steeper than a distance, else the field over
    /// its gradient (Hart 1996), which may not exceed four times what is proven.
    fn distance(&mut self, shape: ShapeId, node: NodeId, domain: &Domain) -> NodeId {
        match self.graph.node(node).clone() {
            Node::Constant(_) => node,
            Node::Op(op @ (Op::Min | Op::Max), args) => {
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
            Node::Op(Op::Select, args) if args.first().is_some_and(|c| self.is_uniform(*c)) => {
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
                    return self.graph.call(inner, Function::Distance, &args);
                }
                let whole = self.facts.constant(self.graph, node, &everywhere, 1);
                if whole.lipschitz <= STEEPEST {
                    return self.over_gradient(node, whole.lipschitz);
                }
                let near = match self.region_of(node, domain) {
                    Some((region, reach)) => domain.at(region.grow(reach)),
                    None => return node,
                };
                let constant = self.facts.constant(self.graph, node, &near, BUDGET);
                self.over_gradient(node, constant.lipschitz)
            }
            _ => {
                let Some(treatment) = self.treatment(shape, node, domain, true) else { return node };
                self.over_gradient(node, treatment.constant)
            }
        }
    }

    fn scaled_distance(&mut self, args: &[NodeId], domain: &Domain) -> Option<NodeId> {
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

    fn over_gradient(&mut self, node: NodeId, constant: f64) -> NodeId {
        if constant <= UNIT || !constant.is_finite() {
            return node;
        }
        let gradient = self.gradient(node);
        let length = self.graph.op(Op::Length3, &gradient);
        let least = self.graph.constant(constant / 4.0);
        let length = self.graph.op(Op::Max, &[length, least]);
        self.graph.op(Op::Div, &[node, length])
    }

    /// The gradient of a node by the point of its space, as nodes: forward, by the kernel's partial derivatives.
    pub fn gradient(&mut self, root: NodeId) -> [NodeId; 3] {
        let zero = self.graph.constant(0.0);
        let one = self.graph.constant(1.0);
        let order = self.graph.reachable(&[root]);
        let mut gradients: Vec<[NodeId; 3]> = Vec::with_capacity(order.len());
        for &id in &order {
            let of = |a: &NodeId, g: &[[NodeId; 3]]| {
                order.binary_search(a).ok().and_then(|i| g.get(i).copied()).unwrap_or([zero; 3])
            };
            let gradient = match self.graph.node(id).clone() {
                Node::Leaf(Leaf::P(i)) => {
                    let mut unit = [zero; 3];
                    if let Some(slot) = unit.get_mut(usize::from(i)) {
                        *slot = one;
                    }
                    unit
                }
                Node::Op(op @ (Op::Min | Op::Max), args) => {
                    let (Some(&a), Some(&b)) = (args.first(), args.get(1)) else {
                        gradients.push([zero; 3]);
                        continue;
                    };
                    let (ga, gb) = (of(&a, &gradients), of(&b, &gradients));
                    let first = self.graph.op(Op::Le, &if op == Op::Min { [a, b] } else { [b, a] });
                    self.pick(first, ga, gb)
                }
                Node::Op(Op::Select, args) => {
                    let (Some(&c), Some(a), Some(b)) = (args.first(), args.get(1), args.get(2)) else {
                        gradients.push([zero; 3]);
                        continue;
                    };
                    self.pick(c, of(a, &gradients), of(b, &gradients))
                }
                Node::Op(op, args) => {
                    let inner: Vec<[NodeId; 3]> = args.iter().map(|a| of(a, &gradients)).collect();
                    if inner.iter().all(|g| *g == [zero; 3]) {
                        [zero; 3]
                    } else {
                        let partials = kernel::partials(self.graph, op, &args, id);
                        self.chain_rule(&partials, &inner)
                    }
                }
                Node::Call(shape, Function::Field, args) => {
                    let inner: Vec<[NodeId; 3]> = args.iter().map(|a| of(a, &gradients)).collect();
                    if inner.iter().skip(3).any(|g| *g != [zero; 3]) {
                        // A variable moves too: the formula is opened here.
                        let Some(value) = self.graph.shape(shape).map(|s| s.value) else {
                        gradients.push([zero; 3]);
                        continue;
                    };
                        let opened = self.graph.open(shape, value, &args);
                        self.gradient(opened)
                    } else {
                        let partials: Vec<NodeId> = (0..3)
                            .map(|i| self.graph.call(shape, Function::Gradient(i), &args))
                            .collect();
                        self.chain_rule(&partials, &inner)
                    }
                }
                Node::Claim(args, _) => args.first().map_or([zero; 3], |a| of(a, &gradients)),
                _ => [zero; 3],
            };
            gradients.push(gradient);
        }
        gradients.last().copied().unwrap_or([zero; 3])
    }

    fn pick(&mut self, condition: NodeId, a: [NodeId; 3], b: [NodeId; 3]) -> [NodeId; 3] {
        let mut chosen = a;
        for (slot, other) in chosen.iter_mut().zip(b) {
            *slot = self.graph.op(Op::Select, &[condition, *slot, other]);
        }
        chosen
    }

    fn chain_rule(&mut self, partials: &[NodeId], inner: &[[NodeId; 3]]) -> [NodeId; 3] {
        let mut total = [self.graph.constant(0.0); 3];
        for (partial, gradient) in partials.iter().zip(inner) {
            for (slot, g) in total.iter_mut().zip(gradient) {
                let term = self.graph.op(Op::Mul, &[*partial, *g]);
                *slot = self.graph.op(Op::Add, &[*slot, term]);
            }
        }
        total
    }

    /// The surface of the scene.
    fn build_surface(&mut self) {
        let point = self.graph.point();
        let variables = self.graph.shape(self.root).map(|s| s.variables.clone()).unwrap_or_default();
        let mut args = point.to_vec();
        args.extend(variables.iter().map(|&v| {
            if v < WORLD + 3 { point.get((v - WORLD) as usize).copied().unwrap_or(point[0]) } else { self.graph.constant(0.0) }
        }));
        let look = match self.look_of_shape(self.root, &args) {
            Some(look) => look,
            None => self.default_look(),
        };
        let [r, g, b, er, eg, eb, roughness, metallic, reflectivity] = look;
        self.built.surface =
            Surface { color: [r, g, b], emission: [er, eg, eb], roughness, metallic, reflectivity };
    }

    fn default_look(&mut self) -> Look {
        let grey = self.graph.constant(0.55);
        let zero = self.graph.constant(0.0);
        let roughness = self.graph.constant(0.6);
        [grey, grey, grey, zero, zero, zero, roughness, zero, zero]
    }

    /// The material of a shape at a point of the scene's space; none where nothing in it has one.
    fn look_of_shape(&mut self, shape: ShapeId, args: &[NodeId]) -> Option<Look> {
        let s = self.graph.shape(shape)?.clone();
        let mut look = match s.material {
            Some(material) => self.look_of_material(shape, material, args),
            None => {
                let value = self.graph.open(shape, s.value, args);
                self.look(value)
            }
        };
        for (mask, material) in s.paints.iter() {
            let painted = self.look_of_material(shape, *material, args);
            let below = look.unwrap_or(self.default_look());
            let mask_args = self.pass_variables(shape, *mask, args);
            let field = self.graph.call(*mask, Function::Field, &mask_args);
            let zero = self.graph.constant(0.0);
            let inside = self.graph.op(Op::Lt, &[field, zero]);
            look = painted.map(|p| self.pick_look(inside, p, below)).or(Some(below));
        }
        look
    }

    fn pass_variables(&mut self, outer: ShapeId, inner: ShapeId, args: &[NodeId]) -> Vec<NodeId> {
        let of = |graph: &Graph, s: ShapeId| graph.shape(s).map(|s| s.variables.to_vec()).unwrap_or_default();
        let outer = of(self.graph, outer);
        let mut passed: Vec<NodeId> = args.iter().take(3).copied().collect();
        for v in of(self.graph, inner) {
            let known = outer.binary_search(&v).ok().and_then(|i| args.get(3 + i).copied());
            passed.push(known.unwrap_or_else(|| self.graph.leaf(Leaf::Variable(v))));
        }
        passed
    }

    fn look_of_material(&mut self, shape: ShapeId, material: MaterialId, args: &[NodeId]) -> Option<Look> {
        let m = self.graph.materials.get(material.0 as usize)?.clone();
        let [r, g, b] = m.color;
        let [er, eg, eb] = m.emission;
        let nodes = [r, g, b, er, eg, eb, m.roughness, m.metallic, m.reflectivity];
        Some(self.graph.open_all(shape, nodes, args))
    }

    /// The material at the zero set of a formula in the scene's space.
    fn look(&mut self, node: NodeId) -> Option<Look> {
        if let Some(known) = self.surfaces.get(&node) {
            return *known;
        }
        let found = self.find_look(node);
        self.surfaces.insert(node, found);
        found
    }

    fn find_look(&mut self, node: NodeId) -> Option<Look> {
        match self.graph.node(node).clone() {
            Node::Op(op @ (Op::Min | Op::Max), args) => {
                let (a, b) = (*args.first()?, *args.get(1)?);
                let (first, second) = match (self.look(a), self.look(b)) {
                    (None, None) => return None,
                    (Some(first), Some(second)) => (first, second),
                    // A cut shows the cutter's material if it has one; a part of a union without one looks as it would alone.
                    (Some(one), None) if op == Op::Max => return Some(one),
                    (None, Some(one)) if op == Op::Max => return Some(one),
                    (Some(first), None) => (first, self.default_look()),
                    (None, Some(second)) => (self.default_look(), second),
                };
                if first == second {
                    return Some(first);
                }
                let wins = self.graph.op(Op::Le, &if op == Op::Min { [a, b] } else { [b, a] });
                Some(self.pick_look(wins, first, second))
            }
            Node::Op(Op::Neg, args) => self.look(*args.first()?),
            Node::Op(Op::Select, args) if args.first().is_some_and(|c| self.is_uniform(*c)) => {
                let (c, a, b) = (*args.first()?, *args.get(1)?, *args.get(2)?);
                match (self.look(a), self.look(b)) {
                    (Some(a), Some(b)) => Some(self.pick_look(c, a, b)),
                    (a, b) => a.or(b),
                }
            }
            Node::Claim(args, _) => self.look(*args.first()?),
            Node::Call(shape, Function::Field, args) => self.look_of_shape(shape, &args),
            _ => self.mixed_look(node),
        }
    }

    /// Of a formula over several shapes: their materials, by how much the value follows each of them.
    fn mixed_look(&mut self, node: NodeId) -> Option<Look> {
        let calls: Vec<NodeId> = self
            .graph
            .reachable(&[node])
            .into_iter()
            .filter(|&id| matches!(self.graph.node(id), Node::Call(_, Function::Field, _)))
            .collect();
        let mut looks: Vec<(NodeId, Look)> = Vec::new();
        for call in calls {
            if let Some(look) = self.look(call) {
                looks.push((call, look));
            }
        }
        let (_, first) = *looks.first()?;
        if looks.iter().all(|(_, l)| *l == first) {
            return Some(first);
        }
        let weights: Vec<NodeId> = looks
            .iter()
            .map(|(call, _)| {
                let slope = self.slope(node, *call);
                self.graph.op(Op::Abs, &[slope])
            })
            .collect();
        let mut total = self.graph.constant(1e-12);
        for weight in &weights {
            total = self.graph.op(Op::Add, &[total, *weight]);
        }
        let zero = self.graph.constant(0.0);
        let mut mixed = [zero; 9];
        for ((_, look), weight) in looks.iter().zip(weights) {
            let share = self.graph.op(Op::Div, &[weight, total]);
            for (slot, entry) in mixed.iter_mut().zip(look) {
                let term = self.graph.op(Op::Mul, &[share, *entry]);
                *slot = self.graph.op(Op::Add, &[*slot, term]);
            }
        }
        Some(mixed)
    }

    /// The derivative of a node by another node inside it.
    fn slope(&mut self, node: NodeId, by: NodeId) -> NodeId {
        let zero = self.graph.constant(0.0);
        let one = self.graph.constant(1.0);
        let order = self.graph.reachable(&[node]);
        let mut slopes: Vec<NodeId> = Vec::with_capacity(order.len());
        for &id in &order {
            let of = |a: &NodeId, s: &[NodeId]| {
                order.binary_search(a).ok().and_then(|i| s.get(i).copied()).unwrap_or(zero)
            };
            let slope = if id == by {
                one
            } else {
                match self.graph.node(id).clone() {
                    Node::Op(Op::Min | Op::Max, args) if args.len() == 2 => {
                        let (a, b) = (args.first().copied().unwrap_or(id), args.get(1).copied().unwrap_or(id));
                        let first = matches!(self.graph.node(id), Node::Op(Op::Min, _));
                        let wins = self.graph.op(Op::Le, &if first { [a, b] } else { [b, a] });
                        let (sa, sb) = (of(&a, &slopes), of(&b, &slopes));
                        self.graph.op(Op::Select, &[wins, sa, sb])
                    }
                    Node::Op(op, args) => {
                        let inner: Vec<NodeId> = args.iter().map(|a| of(a, &slopes)).collect();
                        if inner.iter().all(|s| *s == zero) {
                            zero
                        } else {
                            let partials = kernel::partials(self.graph, op, &args, id);
                            let mut total = zero;
                            for (partial, s) in partials.iter().zip(inner) {
                                let term = self.graph.op(Op::Mul, &[*partial, s]);
                                total = self.graph.op(Op::Add, &[total, term]);
                            }
                            total
                        }
                    }
                    Node::Claim(args, _) => args.first().map_or(zero, |a| of(a, &slopes)),
                    _ => zero,
                }
            };
            slopes.push(slope);
        }
        slopes.last().copied().unwrap_or(zero)
    }

    fn pick_look(&mut self, condition: NodeId, a: Look, b: Look) -> Look {
        let mut chosen = a;
        for (slot, other) in chosen.iter_mut().zip(b) {
            *slot = self.graph.op(Op::Select, &[condition, *slot, other]);
        }
        chosen
    }
}
