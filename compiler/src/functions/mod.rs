//! From the graph of a scene to the functions that a module holds: field, bound, distance, gradient, surface.
//!
//! The *field* is what the formulas say. The *bound* says how far a ray may step: operands of `min` and `max` are normalised one
//! by one, smooth groups as a whole, and a formula without a constant over all space behind its region. The *distance* is the
//! estimate that light and contact use: it is composed in the same way and never holds a factor.

mod agree;
mod ahead;
mod smooth_union_bound;
mod bodies;
mod bound;
mod capped;
mod cell;
mod convex;
mod counts;
mod measured_fallback;
mod distance;
mod domains;
mod uniform_material;
mod folds;
mod found;
mod gradient;
mod ground;
mod groups;
mod jump_magnitude;
mod jumps;
mod outlines;
mod seams;
mod sides;
mod staircase_relaxation;
mod surface;
mod template;
mod treatment;
mod trial;
pub mod loop_counters;
mod level_and_curvature_bounds;
pub mod unions;
mod one_sided_form;
mod zones;

pub use ahead::{Ahead, Planes, ample_extent};
pub use ground::{Carry, carry, firm};
pub use outlines::{Outline, Outlines, outline_beside};

use ahead::AMPLE;
use treatment::{Over, Treatment};
use crate::analysis::region::WORLD_SIDE;
use crate::analysis::search::{Search, Target};
use crate::analysis::{Box3, Domain, Facts, call_domain};
use crate::blocks::SceneBlocks;
use crate::diagnostic::{Code, Diagnostic};
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::images::TextureKind;
use crate::graph::{Function, Graph, Leaf, Node, NodeId, Opened, Proof, ShapeId, Slot, WORLD};
use crate::source::Span;
use rustc_hash::{FxHashMap, FxHashSet};
use smallvec::{SmallVec, smallvec};
use std::rc::Rc;

/// The formulas of every function of every shape that the root's functions call.
#[derive(Clone, Debug, Default)]
pub struct Functions {
    /// Formula by shape and function, in the shape's own space: it reads `p`, the shape's variables, parameters, time, factors,
    /// and calls functions of other shapes. `Gradient(0..=2)` are present together or not at all.
    pub formulas: Opened,
    /// The root's surface, in the scene's space: it reads `p`, `Normal`, and calls fields.
    pub surface: Surface,
    /// What meshes are made of whose material is not the same everywhere, each once, in the mesh's own space: of a layer the axes are those of
    /// that space too.
    pub meshes: Vec<Surface>,
    /// Of each mesh of the text the one among them; none where its material is the same everywhere.
    pub mesh_surfaces: Vec<Option<u32>>,
    /// What each of [`Graph::factors`] was found from; none for one that is measured.
    pub searches: Vec<Option<Search>>,
    /// Those of [`Graph::factors`] that stand for formulas which are gentle at their surface and many times as steep elsewhere: rays go by their
    /// curvature or their levels. With how many times as many steps that takes at half of the places as if they knew how steep it is.
    pub gentle: FxHashMap<u32, f64>,
    /// Unions of many operands, by the function that each one is.
    pub unions: FxHashMap<unions::Of, unions::Union>,
    /// What rays find without a search.
    pub ahead: Ahead,
    /// Whether the estimate of the distance may be much less than it ([`crate::emit::tracer::Ways::loose`]).
    pub loose: bool,
    /// How what is solid moves, where balls ask for it and it does.
    pub carry: Option<Carry>,
    /// Intersections, each with an operand that cuts nothing off, which bound and distance do without.
    pub absorbed: FxHashSet<(NodeId, NodeId)>,
    /// Boxes that hold all points at which nodes are at most zero, of nodes of which more is known than their formulas show.
    pub solids: FxHashMap<NodeId, Box3>,
    /// What stands for long formulas of a few numbers, and for folds of many.
    pub outlines: FxHashMap<NodeId, Outlines>,
}

impl Functions {
    /// How many operands the unions and folds of many have that the bound looks at, all together.
    pub fn operands(&self) -> usize {
        // Of drawings and folds the field is the bound.
        let is_bound = |of: &unions::Of| of.1 == Function::Bound || of.1 == Function::Field && !self.unions.contains_key(&(of.0, Function::Bound));
        let bounds = self.unions.iter().filter(|(of, _)| is_bound(of));
        // One that is the same as another function's has its operands there.
        let steps = bounds.filter_map(|(&(shape, _), union)| match union.same {
            Some(function) => Some(&self.unions.get(&(shape, function))?.steps),
            None => Some(&union.steps),
        });
        steps.flatten().filter(|step| matches!(step, unions::Step::Operand(..))).count()
    }

    /// What is made of the images of the field's surface and of the meshes', each once: which image, and for what. Those of the field come first.
    pub fn textures(&self) -> Vec<(u32, TextureKind)> {
        let mut textures = self.surface.textures();
        for texture in self.meshes.iter().flat_map(Surface::textures) {
            if !textures.contains(&texture) {
                textures.push(texture);
            }
        }
        textures
    }
}

/// How the surface at a point answers light.
#[derive(Clone, Debug, Default, PartialEq)]
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
    /// How steeply the surface looks to rise along each axis of the scene, where formulas say so.
    pub relief: Option<[NodeId; 3]>,
    /// How much light goes through, 0 to 1, and the index of refraction, where any does.
    pub glass: Option<[NodeId; 2]>,
    /// What images add to all this.
    pub layers: Vec<Layer>,
}

/// An image that lies on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// An index into [`Graph::images`].
    pub image: u32,
    /// What it says of the surface.
    pub slot: Slot,
    /// What its colour is multiplied by; zero where it does not lie.
    pub weight: [NodeId; 3],
    /// Where on it: a point of the shape's own space, in widths of the image.
    pub point: [NodeId; 3],
    /// How each coordinate of that point grows along the axes of the scene's space.
    pub axes: [[NodeId; 3]; 3],
    /// The power of the normal's components by which the three sides share the surface.
    pub sharpness: NodeId,
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
/// So far out lies whatever is solid anywhere.
const ANYWHERE: f64 = 1e30;
/// So many parts of a union are asked whether they have a width.
const MOST_PARTS: usize = 256;
/// Points at which a formula is looked at where nothing is proven.
const SAMPLES: usize = 4096;
/// A constant up to here counts as one.
const UNIT: f64 = 1.0 + 1e-6;

/// A constant, how it is known, and of what over which domain.
struct Known {
    lipschitz: f64,
    proof: Proof,
    search: Option<(Target, Domain)>,
}

/// The domain that the parts of a formula with a region need, the region, and how far beyond it the formula is trusted.
type Narrowed = (Domain, Box3, f64);

/// An intersection of which one operand need only hold where the other is at most a level.
#[derive(Clone, Debug)]
struct Cut {
    wild: NodeId,
    tame: NodeId,
    level: f64,
    /// Where that is.
    domain: Domain,
}

/// What is made on the way from graph to functions.
pub struct Builder<'a> {
    graph: &'a mut Graph,
    facts: &'a mut Facts,
    root: ShapeId,
    extent: f64,
    /// Whether the text says it.
    says_extent: bool,
    /// Whether there is a camera that frames what is solid.
    framed: bool,
    domains: FxHashMap<ShapeId, Domain>,
    found: found::Found,
    /// Whether the scene has so many parts that they may be a union of many; found when it is first asked for.
    crowded: Option<bool>,
    built: Functions,
    /// What was found on the way.
    pub diagnostics: Vec<Diagnostic>,
    /// What is known of the whole.
    pub kind: Kind,
    /// Whether what can't be proven is an error.
    strict: bool,
    /// Gradients of nodes by the point of their space, as far as they were asked for.
    slopes: gradient::Slopes,
    /// Jumps of shapes as light sees them, which shapes have any in or under them, and what fields are by which such shapes are told apart.
    walls: FxHashMap<ShapeId, Rc<Option<gradient::Wall>>>,
    walled: FxHashMap<ShapeId, bool>,
    beside: FxHashMap<(NodeId, bool), NodeId>,
    /// Outlines of claims, as far as they were asked for.
    outlines: FxHashMap<NodeId, Outlines>,
    /// Their shapes, by formula and dimensions.
    outlined: FxHashMap<(NodeId, u8), ShapeId>,
    /// Trees of one operation, and the shapes that stand for them.
    folds: folds::Folds,
    /// The variables that stand for numbers in them which do not move, and for those in which their parts differ.
    still: Vec<u32>,
    /// The one among them whose own gradient is being made.
    own: Option<ShapeId>,
    /// Whether a plane may be among the operands of a union.
    planes: FxHashMap<NodeId, bool>,
    surfaces: FxHashMap<NodeId, Option<Look>>,
    looks: FxHashMap<NodeId, surface::Looks>,
    dresses: FxHashMap<NodeId, uniform_material::Dress>,
    /// How many shapes of several materials were looked at.
    looked: usize,
    /// How wide the widest opening is of which the estimate of the distance tells a face that is not there.
    opening: f64,
    /// Within how many smooth unions, each taken apart, the bound that is being made lies.
    parting: u32,
}

/// The numbers of a surface, and the images on it.
#[derive(Clone, Debug, PartialEq)]
struct Look {
    /// Colour, emission, roughness, metallic, reflectivity; then the relief's slope.
    values: [NodeId; 12],
    /// How much light goes through, and the index of refraction, where any does.
    glass: Option<[NodeId; 2]>,
    layers: Rc<[Layer]>,
}

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
    let mut builder = Builder::new(graph, facts, root, blocks);
    builder.built.searches = searches;
    builder.strict = strict;
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

fn with_room<K, V>(count: usize) -> FxHashMap<K, V> {
    FxHashMap::with_capacity_and_hasher(count, Default::default())
}

/// Where a scene is asked for: the cube of its extent, and the point of the scene within it.
fn whole_scene(extent: f64) -> Domain {
    let world = [0, 1, 2].map(|i| (WORLD + i, Interval::new(-extent, extent)));
    Domain { variables: world.to_vec(), ..Domain::of(Box3::cube(extent)) }
}

/// Least and greatest corner of a box that holds the solid of a scene; none where there is nothing solid, or it leaves the extent.
pub fn bounds(graph: &Graph, root: ShapeId, functions: &Functions, extent: f64) -> Option<[[f64; 3]; 2]> {
    let mut facts = Facts::knowing(functions.solids.clone());
    let region = facts.region(graph, graph.shape(root)?.value, &whole_scene(extent), 0.0);
    let within = !region.is_empty() && region.0.iter().all(|i| i.lo > -extent && i.hi < extent);
    within.then(|| [region.0.map(|i| i.lo), region.0.map(|i| i.hi)])
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

impl<'a> Builder<'a> {
    /// Nothing built yet.
    fn new(graph: &'a mut Graph, facts: &'a mut Facts, root: ShapeId, blocks: &SceneBlocks) -> Self {
        let shapes = graph.shapes().len();
        graph.is_spread = graph.spreads();
        Self {
            graph,
            facts,
            root,
            extent: blocks.extent,
            says_extent: blocks.says_extent,
            framed: blocks.is_framed(),
            domains: with_room(shapes),
            found: found::Found::default(),
            crowded: None,
            built: Functions { formulas: with_room(6 * shapes), ..Functions::default() },
            diagnostics: Vec::new(),
            kind: Kind::Exact,
            strict: false,
            slopes: Vec::new(),
            walls: FxHashMap::default(),
            walled: FxHashMap::default(),
            beside: FxHashMap::default(),
            outlines: FxHashMap::default(),
            outlined: FxHashMap::default(),
            folds: folds::Folds::default(),
            still: Vec::new(),
            own: None,
            planes: FxHashMap::default(),
            surfaces: FxHashMap::default(),
            looks: FxHashMap::default(),
            dresses: FxHashMap::default(),
            looked: 0,
            opening: 0.0,
            parting: 0,
        }
    }
}

impl Builder<'_> {
    /// The calls that the roots need. `nodes` is room for what they are found among.
    fn calls<'n>(&'n self, roots: &[NodeId], nodes: &'n mut Vec<NodeId>) -> impl Iterator<Item = (ShapeId, Function)> + use<'n> {
        self.graph.calling(roots, nodes);
        self.called(nodes)
    }

    fn called<'n>(&'n self, nodes: &'n [NodeId]) -> impl DoubleEndedIterator<Item = (ShapeId, Function)> + use<'n> {
        nodes.iter().filter_map(|id| match self.graph.node(*id) {
            Node::Call(shape, function, _) => Some((*shape, *function)),
            _ => None,
        })
    }

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
            && self.facts.is_nowhere(self.graph, value, &whole_scene(self.extent))
        {
            let span = self.place(self.root, value);
            let nothing_within = [WORLD_SIDE, ANYWHERE].map(|side| self.facts.is_nowhere(self.graph, value, &whole_scene(side)));
            let (message, instead) = match nothing_within {
                [true, true] => ("nothing of this scene is solid".to_owned(), "look for an `&` of shapes that do not meet, or a `-` that takes all away"),
                [true, false] => (
                    format!("nothing solid lies within {WORLD_SIDE} of the origin, and farther out the GPU's numbers are too coarse"),
                    "move the scene toward the origin",
                ),
                [false, _] if !self.says_extent => (
                    format!("nothing solid lies within the scene's extent of {}, which grows by itself only for what lies within {}", self.extent, WORLD_SIDE / AMPLE),
                    "move the scene toward the origin, or set `render { extent: … }` to what it needs",
                ),
                [false, _] => (
                    format!("nothing solid lies within the scene's extent of {}", self.extent),
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
            && let Some((shape, node)) = self.without_width(self.root, value, &whole_scene(self.extent), &mut FxHashSet::default())
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

    /// Whether a node is the same everywhere in the space in which it stands.
    fn is_uniform(&self, node: NodeId) -> bool {
        let reads = self.graph.reads(node);
        reads.nothing() && !reads.shapes
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
}
