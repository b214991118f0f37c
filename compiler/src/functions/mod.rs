//! From the graph of a scene to the functions that a module holds: field, bound, distance, gradient, surface.
//!
//! The *field* is what the formulas say. The *bound* says how far a ray may step: operands of `min` and `max` are normalised one
//! by one, smooth groups as a whole, and a formula without a constant over all space behind its region. The *distance* is the
//! estimate that light and contact use: it is composed in the same way and never holds a factor.

mod agree;
mod ahead;
mod bodies;
mod bound;
mod bound_strategy;
mod builder;
mod capped;
mod cell;
mod convex;
mod counts;
mod distance;
mod domains;
mod folds;
mod found;
mod gradient;
mod ground;
mod groups;
mod jump_magnitude;
mod jumps;
mod level_and_curvature_bounds;
mod limits;
pub mod loop_counters;
mod made;
mod measured_fallback;
mod one_sided_form;
mod outline;
mod outlines;
mod seams;
mod sides;
mod smooth_union_bound;
mod staircase_relaxation;
mod surface;
mod template;
mod trial;
mod uniform_material;
mod union;
pub mod unions;
mod zones;

pub use ahead::ample_extent;
pub use builder::Builder;
pub use ground::{carry, firm};
pub(crate) use limits::LONGEST_HAIR;
pub use made::{Ahead, Carry, Functions, Kind, Layer, Planes, Summary, Surface};
pub use outline::{Outline, Outlines, outline_beside};

use crate::analysis::region::WORLD_SIDE;
use crate::analysis::search::Search;
use crate::analysis::{Domain, Facts, call_domain};
use crate::blocks::SceneBlocks;
use crate::diagnostic::{Code, Diagnostic};
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::{Function, Graph, Leaf, Node, NodeId, ShapeId, WORLD};
use ahead::AMPLE;
use builder::whole_scene;
use limits::{ANYWHERE, MOST_PARTS};
use rustc_hash::FxHashSet;
use smallvec::{SmallVec, smallvec};

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

/// An opening that is less than this part of the scene's size is not looked at apart: what it does to the light is small.
const SEEN_OPENING: f64 = 0.2;

/// Builds the functions of a scene whose shape has been through [`bind_world`]. `searches` is what the graph's factors were found from.
pub fn build(
    graph: &mut Graph,
    facts: &mut Facts,
    root: ShapeId,
    blocks: &SceneBlocks,
    strict: bool,
    searches: Vec<Option<Search>>,
) -> (Functions, Summary, Vec<Diagnostic>) {
    let mut builder = Builder::new(graph, facts, root, (blocks, strict));
    builder.built.searches = searches;
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
    builder.build_meshes(&blocks.meshes);
    let surfaces = builder.built.meshes.iter().chain([&builder.built.surface]);
    let surface_nodes: Vec<NodeId> = surfaces.flat_map(Surface::nodes).collect();
    let mut nodes = Vec::new();
    let mut seen = Vec::new();
    let asked: Vec<_> = builder.calls(&surface_nodes, &mut nodes).collect();
    functions.extend(&asked);
    while let Some((shape, function)) = functions.pop() {
        if builder.built.formulas.contains_key(&(shape, function)) {
            continue;
        }
        let formulas = builder.formulas_of(shape, function);
        for (function, formula) in &formulas {
            builder.built.formulas.insert((shape, *function), *formula);
        }
        // The list is taken from its end: what a later component of a gradient calls need not be listed for an earlier one too.
        seen.clear();
        seen.resize(builder.graph.len() / 64 + 1, 0);
        let start = functions.len();
        for (_, formula) in formulas.iter().rev() {
            builder.graph.calling_more(*formula, &mut seen, &mut nodes);
            functions.extend(builder.called(&nodes).rev());
        }
        if let Some(new) = functions.get_mut(start..) {
            new.reverse();
        }
    }
    builder.built.unions = unions::find(builder.graph, builder.facts, &builder.built, &asked);
    builder.built.ahead = builder.ahead();
    let size = builder.built.ahead.region.map_or(0.0, |region| region.size());
    builder.built.loose = builder.opening > 0.0 && builder.opening >= SEEN_OPENING * size;
    builder.built.solids = builder.facts.known_solids().clone();
    let asked = builder.outline_all();
    builder.unite_folds(&asked);
    let summary = builder.summary();
    (builder.built, summary, builder.diagnostics)
}

/// Least and greatest corner of a box that holds the solid of a scene; none where there is nothing solid, or it leaves the extent.
pub fn bounds(graph: &Graph, root: ShapeId, functions: &Functions, extent: f64) -> Option<[[f64; 3]; 2]> {
    let mut facts = Facts::knowing(functions.solids.clone());
    let region = facts.region(graph, graph.shape(root)?.value, &whole_scene(extent), 0.0);
    let within = !region.is_empty() && region.0.iter().all(|i| i.lo > -extent && i.hi < extent);
    within.then(|| [region.0.map(|i| i.lo), region.0.map(|i| i.hi)])
}

impl Builder<'_> {
    fn summary(&mut self) -> Summary {
        let mut shapes = vec![self.root];
        let mut seen: FxHashSet<ShapeId> = FxHashSet::default();
        let mut values = Vec::new();
        let mut primitives = 0;
        let mut nodes = Vec::new();
        while let Some(shape) = shapes.pop() {
            let Some(s) = self.graph.shape(shape) else { continue };
            if !seen.insert(shape) {
                continue;
            }
            values.push(s.value);
            primitives += usize::from(!self.graph.reads(s.value).shapes && self.graph.as_constant(s.value).is_none());
            shapes.extend(self.calls(&[s.value], &mut nodes).map(|(s, _)| s));
        }
        let factor = self.graph.factors.iter().map(|f| f.lipschitz).fold(1.0, f64::max);
        // Who writes `nothing` means it: there may be meshes.
        let value = self.graph.shape(self.root).map(|s| s.value).filter(|v| self.graph.as_constant(*v).is_none());
        if let Some(value) = value
            && self.facts.is_nowhere(self.graph, value, &whole_scene(self.scene.extent))
        {
            let span = self.place(self.root, value);
            let nothing_within = [WORLD_SIDE, ANYWHERE].map(|side| self.facts.is_nowhere(self.graph, value, &whole_scene(side)));
            let (message, instead) = match nothing_within {
                [true, true] => ("nothing of this scene is solid".to_owned(), "look for an `&` of shapes that do not meet, or a `-` that takes all away"),
                [true, false] => (
                    format!("nothing solid lies within {WORLD_SIDE} of the origin, and farther out the GPU's numbers are too coarse"),
                    "move the scene toward the origin",
                ),
                [false, _] if !self.scene.says_extent => (
                    format!("nothing solid lies within the scene's extent of {}, which grows by itself only for what lies within {}", self.scene.extent, WORLD_SIDE / AMPLE),
                    "move the scene toward the origin, or set `render { extent: … }` to what it needs",
                ),
                [false, _] => (
                    format!("nothing solid lies within the scene's extent of {}", self.scene.extent),
                    "move the scene toward the origin, or set `render { extent: … }` to what it needs",
                ),
            };
            self.diagnostics.push(Diagnostic::new(Code::NothingSolid, span, message, instead));
        } else if let Some(value) = value
            && self.built.ahead.region.is_some_and(|region| region.0.iter().all(|side| side.width() < 1e-9))
        {
            let (message, instead) = ("what is solid of this scene is a single point, which nobody sees", "give it a size: a radius or an edge is 0 here");
            self.diagnostics.push(Diagnostic::new(Code::NothingSolid, self.place(self.root, value), message, instead));
        } else if let Some(value) = value
            && let Some((shape, node)) = self.without_width(self.root, value, &whole_scene(self.scene.extent), &mut FxHashSet::default())
        {
            let (message, instead) = ("this is made of a drawing without an inside, so that it is as thin as a hair", "give the drawing a width, for example `segment(a, b).round(0.05)`");
            self.diagnostics.push(Diagnostic::new(Code::NothingSolid, self.place(shape, node), message, instead));
        }
        Summary { nodes: self.graph.reachable(&values).len(), primitives, factor, kind: self.kind }
    }

    /// A part of a union that is made of drawings and is zero at the least, so that it has a surface and no inside.
    fn without_width(&mut self, shape: ShapeId, node: NodeId, domain: &Domain, seen: &mut FxHashSet<NodeId>) -> Option<(ShapeId, NodeId)> {
        if !seen.insert(node) || seen.len() > MOST_PARTS {
            return None;
        }
        match self.graph.node(node).clone() {
            Node::Op(Op::Min, args) => args.iter().find_map(|&a| self.without_width(shape, a, domain, seen)),
            Node::Call(inner, Function::Field, args) => {
                let s = self.graph.shape(inner)?.clone();
                if s.dimensions == 2 {
                    return None;
                }
                let args: Vec<Interval> = args.iter().map(|&a| self.facts.range(self.graph, a, domain)).collect();
                self.without_width(inner, s.value, &call_domain(&s.variables, &args), seen)
            }
            _ => {
                let mut nodes = Vec::new();
                let is_flat = |s: &ShapeId| self.graph.shape(*s).is_some_and(|s| s.dimensions == 2);
                let is_drawn = self.calls(&[node], &mut nodes).any(|(s, _)| is_flat(&s));
                (is_drawn && self.facts.range(self.graph, node, domain).lo == 0.0).then_some((shape, node))
            }
        }
    }

    /// The formula of a function of a shape; of a gradient, all three.
    fn formulas_of(&mut self, shape: ShapeId, function: Function) -> SmallVec<[(Function, NodeId); 3]> {
        let Some(s) = self.graph.shape(shape) else { return SmallVec::new() };
        let value = s.value;
        match function {
            Function::Field => smallvec![(function, value)],
            Function::Bound => {
                let domain = self.domain(shape);
                let bound = self.bound(shape, value, &domain, false);
                smallvec![(function, bound)]
            }
            Function::Distance => {
                let domain = self.domain(shape);
                let distance = self.distance(shape, value, &domain);
                smallvec![(function, distance)]
            }
            Function::Gradient(_) => {
                let gradient = self.gradient_with_walls(shape, value);
                (0..3).zip(gradient).map(|(i, g)| (Function::Gradient(i), g)).collect()
            }
        }
    }
}
