//! The graph: formulas over numbers, shared by hash, and shapes made of formulas.
//!
//! A [`Node`] is a number (or a condition, 0 or 1) that depends on the point `p` of the space in which it stands, on parameters, on
//! time and on variables. A [`Shape`] is a node with a space of its own; other formulas ask for its value at a point through
//! [`Node::Call`]. A union is the `min` of two calls; a twist is a call at a twisted point: the structure that the analysis
//! needs is the structure of the formulas.

pub mod algebra;
mod blend;
pub(crate) mod index;
pub mod interval;
pub mod joint;
pub mod kernel;
mod labels;
mod list;
mod outside;
pub mod print;
mod reads;
pub mod simplify;
mod walk;

use crate::source::ImageFile;
use crate::source::Span;
use index::Index;
use interval::Interval;
use kernel::Op;
use labels::Labels;
pub use labels::Made;
pub use list::NodeList;
use reads::{Reads, Sets};
use rustc_hash::FxHasher;
use std::hash::{Hash, Hasher};
use std::sync::Arc;

/// Index of a node of the graph. A node's arguments have smaller indices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct NodeId(pub u32);

/// Index of a shape of the graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ShapeId(pub u32);

/// Index of a material of the graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct MaterialId(pub u32);

/// Stands for "no solid here": farther than anything, yet finite in 32 bits.
pub const FAR: f64 = 1e9;

/// Any time that a person may wait for, and what came before, in seconds.
pub const ANY_TIME: Interval = Interval { lo: -1e7, hi: 1e7 };

/// What a node reads from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Leaf {
    /// Component of the point in the own space of the shape: 0, 1, 2.
    P(u8),
    /// Component of the surface's normal in the scene's space, in materials; of a ray's direction in what is asked along a ray.
    Normal(u8),
    /// Seconds.
    Time,
    /// A component of a parameter: an index into [`Graph::parameters`].
    Parameter(u32),
    /// A number that a repetition or the caller binds: `cell`, or the point of the scene ([`WORLD`]).
    Variable(u32),
}

/// Variables 0, 1, 2 are the point of the scene; a scene's root binds them to its `p`.
pub const WORLD: u32 = 0;
/// The first variable that is free to be bound by a repetition.
pub const FIRST_VARIABLE: u32 = 3;

/// Which function of a shape is called.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Function {
    /// What the formulas say.
    Field,
    /// How far a ray may step.
    Bound,
    /// The estimate of the distance that light and contact use.
    Distance,
    /// Component 0, 1, 2 of the field's gradient.
    Gradient(u8),
}

/// A number, or a condition.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Node {
    /// A constant, as its bits, so that it can be hashed. Never NaN or infinite.
    Constant(u64),
    /// Read from outside.
    Leaf(Leaf),
    /// An operation of the kernel.
    Op(Op, NodeList),
    /// A function of a shape at a point: three coordinates (two of a drawing, then zero), then one value for
    /// each of the shape's variables.
    Call(ShapeId, Function, NodeList),
    /// The value of the first node, with what is known of it and can't be seen from its formula; the
    /// others are what the claim speaks of.
    Claim(NodeList, Claim),
    /// How far a field may be trusted, as a multiple: the reciprocal of a Lipschitz factor. An index into [`Graph::factors`].
    Factor(u32),
}

/// What is known of a value.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Claim {
    /// Its Lipschitz constant is at most the value of this formula, in which `Variable(i)` stands for
    /// the constant of the `i`-th group of the claim's other nodes; and its range, where that is known. From the prelude.
    Lipschitz(NodeId, Arc<[ClaimGroup]>, Option<ValueRange>),
    /// The jumps inside (of a cell's index) cancel: the value is continuous.
    Continuous,
}

/// All values that a formula can have: the bits of both ends, so that it can be hashed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ValueRange([u64; 2]);

impl ValueRange {
    /// From the least to the largest.
    pub fn new(least: f64, largest: f64) -> Self {
        Self([least, largest].map(f64::to_bits))
    }

    /// The same as an interval.
    pub fn interval(self) -> Interval {
        let [least, largest] = self.0.map(f64::from_bits);
        Interval::new(least, largest)
    }
}

/// So many nodes of a claim that stand for one argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ClaimGroup {
    /// Components of a vector (or one number): the constant is that of the vector.
    Vector(u8),
    /// Values of a shape at several points: the constant is the largest.
    Values(u32),
    /// The same of a shape of which bounds will do: the claim's value grows with them, and has the same sign for values of the same signs.
    Bounds(u32),
}

/// A parameter's component that a formula can read.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterComponent {
    /// Which parameter of the program.
    pub parameter: u32,
    /// Which of its components.
    pub component: u8,
    /// Its value at the start.
    pub default: f64,
    /// Least value.
    pub min: f64,
    /// Greatest value.
    pub max: f64,
    /// Whether its values are whole numbers.
    pub whole: bool,
}

/// A multiple by which a field becomes a bound.
#[derive(Clone, Debug, PartialEq)]
pub struct Factor {
    /// Name in the uniform struct.
    pub name: String,
    /// The Lipschitz factor: the field over this is a bound. Rounded up.
    pub lipschitz: f64,
    /// What it comes from.
    pub reason: String,
    /// Where that stands.
    pub span: Span,
    /// How it is known.
    pub proof: Proof,
}

/// Formulas of shapes' functions, in the space of the shape.
pub type Opened = rustc_hash::FxHashMap<(ShapeId, Function), NodeId>;

/// A number as the text of a module would hold it.
pub fn narrow(number: f64) -> f32 {
    let limit = f64::from(f32::MAX);
    let number = number.clamp(-limit, limit) as f32;
    if number.is_normal() { number } else { 0.0 }
}

/// One over a Lipschitz factor as 32 bits hold it, rounded down, and at most a million: what hardly changes takes no endless steps.
pub fn multiple_of(lipschitz: f64) -> f32 {
    let lipschitz = lipschitz.max(1e-6);
    let nearest = (1.0 / lipschitz) as f32;
    if f64::from(nearest) * lipschitz > 1.0 { nearest.next_down() } else { nearest }
}

/// How a constant is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Proof {
    /// By the rules of the kernel's operations, everywhere at once.
    Proven,
    /// By a closed form of the prelude, which its tests hold against the certified supremum.
    Claimed,
    /// By a search over boxes in which no part of the region is left out.
    Derived,
    /// By samples alone: it may be too small.
    Measured,
}

impl Proof {
    /// All of them.
    pub const ALL: [Proof; 4] = [Proof::Proven, Proof::Claimed, Proof::Derived, Proof::Measured];

    /// Its name in tables and in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Proof::Proven => "proven",
            Proof::Claimed => "claimed",
            Proof::Derived => "derived",
            Proof::Measured => "measured",
        }
    }
}

impl Factor {
    /// One over the Lipschitz factor as 32 bits hold it, rounded down.
    pub fn multiple(&self) -> f32 {
        multiple_of(self.lipschitz)
    }
}

/// What is known of the value of a shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Exactness {
    /// The signed distance itself.
    Exact,
    /// Known only through its formula and claims.
    Formula,
}

/// A formula with a space of its own.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Shape {
    /// Its name in the source, where a person gave one.
    pub name: Option<Arc<str>>,
    /// 2 for a drawing, 3 for a solid.
    pub dimensions: u8,
    /// Negative inside.
    pub value: NodeId,
    /// The variables that the value, the materials and the shapes inside read, in ascending order.
    pub variables: Arc<[u32]>,
    /// What is known of the value.
    pub exactness: Exactness,
    /// Its material, where it has one of its own; it hides those inside.
    pub material: Option<MaterialId>,
    /// Materials that it has where another shape (of the same space) is negative; the last one wins.
    pub paints: Arc<[(ShapeId, MaterialId)]>,
    /// Where it stands in the source.
    pub span: Span,
}

/// How a surface answers light. Each entry is a formula in `p` (of the space in which the material was given), `normal` and variables.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Material {
    /// Its name in the source.
    pub name: Arc<str>,
    /// Linear colour.
    pub color: [NodeId; 3],
    /// Light of its own, linear.
    pub emission: [NodeId; 3],
    /// 0 mirror to 1 matte.
    pub roughness: NodeId,
    /// 0 or 1, or between.
    pub metallic: NodeId,
    /// How much of the surroundings it mirrors, 0 to 1.
    pub reflectivity: NodeId,
    /// How much light goes through it, 0 to 1, and its index of refraction, where any does.
    pub glass: Option<[NodeId; 2]>,
    /// How high the surface looks; a formula of a length.
    pub relief: Option<NodeId>,
    /// Images that are laid on from three sides.
    pub images: Arc<[MaterialImage]>,
    /// Whether balls meet it.
    pub solid: bool,
}

impl Material {
    /// Its formulas: colour, emission, roughness, metallic, reflectivity.
    pub fn look(&self) -> [NodeId; 9] {
        let ([r, g, b], [x, y, z]) = (self.color, self.emission);
        [r, g, b, x, y, z, self.roughness, self.metallic, self.reflectivity]
    }

    /// All nodes of it.
    pub fn nodes(&self) -> Vec<NodeId> {
        let images = self.images.iter().flat_map(|i| i.weight.into_iter().chain([i.scale, i.sharpness]));
        self.look().into_iter().chain(self.relief).chain(images).chain(self.glass.into_iter().flatten()).collect()
    }

    /// Takes other nodes for its own, in the order of [`Material::nodes`].
    pub fn put_nodes(&mut self, nodes: &[NodeId]) {
        let images = Arc::make_mut(&mut self.images).iter_mut().flat_map(|i| i.weight.iter_mut().chain([&mut i.scale, &mut i.sharpness]));
        let look = self.color.iter_mut().chain(&mut self.emission);
        let look = look.chain([&mut self.roughness, &mut self.metallic, &mut self.reflectivity]);
        for (slot, node) in look.chain(&mut self.relief).chain(images).chain(self.glass.iter_mut().flatten()).zip(nodes) {
            *slot = *node;
        }
    }
}

/// An image that a material is made of.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct MaterialImage {
    /// An index into [`Graph::images`].
    pub image: u32,
    /// What it says of the surface.
    pub slot: Slot,
    /// What its colour is multiplied by, and then added to what the formulas say.
    pub weight: [NodeId; 3],
    /// How many of its widths a unit holds.
    pub scale: NodeId,
    /// How sharply one side's image goes over into another's: the power of the normal's components.
    pub sharpness: NodeId,
}

/// What an image says of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Slot {
    /// Its colour.
    Color,
    /// Its roughness, by the image's green.
    Roughness,
    /// How metallic it is, by the image's blue.
    Metallic,
    /// How high it looks, by the image's green: its weight is the height of white.
    Relief,
}

/// More nodes than most scenes have. Room that is not used costs nothing, and a list that grows is copied.
const ROOM: usize = 1 << 15;
/// As many as a small scene has: room in the index is filled at once.
const INDEXED: usize = 1 << 12;

/// The graph of a program.
#[derive(Clone, Debug, Default)]
pub struct Graph {
    nodes: Vec<Node>,
    index: Index,
    /// What each node reads of its space.
    reads: Vec<Reads>,
    sets: Sets,
    labels: Labels,
    /// The point, once it was asked for.
    point: Option<[NodeId; 3]>,
    shapes: Vec<Shape>,
    shape_index: Index,
    /// Materials, in the order in which they were met.
    pub materials: Vec<Material>,
    /// Files of images that materials are made of.
    pub images: Vec<ImageFile>,
    /// Components of parameters.
    pub parameters: Vec<ParameterComponent>,
    /// Factors, in the order in which they were met.
    pub factors: Vec<Factor>,
    /// Whether no shape is asked at one point of its own for all points of a region.
    pub(crate) is_spread: bool,
    next_variable: u32,
}

impl Graph {
    /// An empty graph.
    pub fn new() -> Self {
        let (nodes, reads) = (Vec::with_capacity(ROOM), Vec::with_capacity(ROOM));
        Self { nodes, reads, index: Index::with_room(INDEXED), next_variable: FIRST_VARIABLE, ..Self::default() }
    }

    /// The arguments of all calls of shapes.
    pub fn calls(&self) -> impl Iterator<Item = &[NodeId]> {
        self.nodes.iter().filter_map(|node| if let Node::Call(_, _, args) = node { Some(args.as_ref()) } else { None })
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether it has no node.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// A node. An index from another graph answers with a zero.
    pub fn node(&self, id: NodeId) -> &Node {
        const ZERO: Node = Node::Constant(0);
        self.nodes.get(id.0 as usize).unwrap_or(&ZERO)
    }

    /// Adds a node, or finds it. No simplification; see [`Graph::op`].
    pub fn intern(&mut self, node: Node) -> NodeId {
        let new = self.nodes.len() as u32;
        let found = self.index.find_or_add(hash_node(&node), new, |i| self.nodes.get(i as usize) == Some(&node));
        found.map_or_else(|| self.add(node), NodeId)
    }

    /// Adds a node that is not there, and that the index has already.
    fn add(&mut self, node: Node) -> NodeId {
        let id = self.nodes.len() as u32;
        let reads = match &node {
            Node::Leaf(Leaf::P(_) | Leaf::Normal(_)) => Reads { point: true, ..Reads::default() },
            Node::Leaf(Leaf::Variable(v)) => Reads { variables: self.sets.one(*v), ..Reads::default() },
            Node::Op(_, args) | Node::Call(_, _, args) | Node::Claim(args, _) => {
                let mut all = Reads { shapes: matches!(node, Node::Call(..)), ..Reads::default() };
                for &arg in args.iter() {
                    let of = self.reads(arg);
                    all.point |= of.point;
                    all.shapes |= of.shapes;
                    all.rounds |= of.rounds;
                    all.variables = self.sets.union(all.variables, of.variables);
                }
                match node {
                    Node::Op(op, _) if op.part().is_some() => all.rounds = all.point,
                    Node::Claim(_, Claim::Continuous) => all.rounds = false,
                    _ => {}
                }
                all
            }
            _ => Reads::default(),
        };
        self.nodes.push(node);
        self.reads.push(reads);
        NodeId(id)
    }

    /// What a node reads of the space in which it stands.
    pub(crate) fn reads(&self, id: NodeId) -> Reads {
        self.reads.get(id.0 as usize).copied().unwrap_or_default()
    }

    /// Whether a node reads the point or the normal of its space.
    pub fn reads_point(&self, id: NodeId) -> bool {
        self.reads(id).point
    }

    /// A constant. What is not finite becomes the nearest finite number of 32 bits, NaN becomes 0.
    pub fn constant(&mut self, value: f64) -> NodeId {
        let limit = f64::from(f32::MAX);
        let value = if value.is_nan() { 0.0 } else { value.clamp(-limit, limit) };
        // One zero only.
        self.intern(Node::Constant(if value == 0.0 { 0 } else { value.to_bits() }))
    }

    /// A value from outside.
    pub fn leaf(&mut self, leaf: Leaf) -> NodeId {
        self.intern(Node::Leaf(leaf))
    }

    /// The point of the own space.
    pub fn point(&mut self) -> [NodeId; 3] {
        let point = match self.point {
            Some(point) => point,
            None => [0, 1, 2].map(|i| self.leaf(Leaf::P(i))),
        };
        self.point = Some(point);
        point
    }

    /// A variable that nothing else uses.
    pub fn fresh_variable(&mut self) -> u32 {
        self.next_variable += 1;
        self.next_variable - 1
    }

    /// An operation, folded where its arguments are constant and simplified where that changes no value.
    pub fn op(&mut self, op: Op, args: &[NodeId]) -> NodeId {
        if let Some(simple) = simplify::simplify(self, op, args) {
            return simple;
        }
        if let (Op::Add | Op::Sub, &[a, b]) = (op, args)
            && let Some(blend) = self.recognised(op, a, b)
        {
            return blend;
        }
        let known = |node: Option<&Node>| matches!(node, Some(Node::Op(o, a)) if *o == op && **a == *args);
        let new = self.nodes.len() as u32;
        let found = self.index.find_or_add(hash(op_key(op), args), new, |i| known(self.nodes.get(i as usize)));
        found.map_or_else(|| self.add(Node::Op(op, args.into())), NodeId)
    }

    /// An associative operation over many nodes as a balanced tree; over none it is `neutral`.
    pub fn balanced(&mut self, op: Op, nodes: &[NodeId], neutral: f64) -> NodeId {
        simplify::balanced(self, op, nodes).unwrap_or_else(|| self.constant(neutral))
    }

    /// A function of a shape at a point. `args`: three coordinates, then the shape's variables in their order.
    pub fn call(&mut self, shape: ShapeId, function: Function, args: &[NodeId]) -> NodeId {
        self.intern(Node::Call(shape, function, args.into()))
    }

    /// The field of a shape at a point, its variables passed through from here.
    pub fn field(&mut self, shape: ShapeId, point: [NodeId; 3]) -> NodeId {
        let variables = self.shape(shape).map(|s| s.variables.clone()).unwrap_or_default();
        let variables = variables.iter().map(|&v| self.leaf(Leaf::Variable(v)));
        let args: NodeList = point.into_iter().chain(variables).collect();
        self.intern(Node::Call(shape, Function::Field, args))
    }

    /// The constant that a node is, if it is one.
    pub fn as_constant(&self, id: NodeId) -> Option<f64> {
        match self.node(id) {
            Node::Constant(bits) => Some(f64::from_bits(*bits)),
            _ => None,
        }
    }

    /// The arguments of a node, in their order.
    pub fn arguments(&self, id: NodeId) -> &[NodeId] {
        match self.node(id) {
            Node::Op(_, args) | Node::Call(_, _, args) | Node::Claim(args, _) => args,
            _ => &[],
        }
    }

    /// A shape. None for an index from another graph.
    pub fn shape(&self, id: ShapeId) -> Option<&Shape> {
        self.shapes.get(id.0 as usize)
    }

    /// All shapes with their indices; a shape's parts have smaller indices.
    pub fn shapes(&self) -> impl ExactSizeIterator<Item = (ShapeId, &Shape)> {
        self.shapes.iter().enumerate().map(|(i, s)| (ShapeId(i as u32), s))
    }

    /// Adds a shape, or finds one that is the same. Its variables are found here.
    pub fn add_shape(&mut self, mut shape: Shape) -> ShapeId {
        let mut variables = self.reads(shape.value).variables;
        let materials = shape.material.iter().chain(shape.paints.iter().map(|(_, m)| m));
        let looks = materials.filter_map(|m| self.materials.get(m.0 as usize)).flat_map(Material::nodes);
        for node in looks.collect::<Vec<_>>() {
            variables = self.sets.union(variables, self.reads(node).variables);
        }
        for (mask, _) in shape.paints.iter() {
            let of_mask = self.shape(*mask).map(|s| s.variables.clone()).unwrap_or_default();
            let of_mask = self.sets.find(&of_mask);
            variables = self.sets.union(variables, of_mask);
        }
        shape.variables = self.sets.get(variables);
        let mut hasher = FxHasher::default();
        shape.hash(&mut hasher);
        let known = |id: u32| self.shapes.get(id as usize) == Some(&shape);
        let new = self.shapes.len() as u32;
        if let Some(id) = self.shape_index.find_or_add(hasher.finish(), new, known) {
            return ShapeId(id);
        }
        self.shapes.push(shape);
        ShapeId(new)
    }

    /// Adds a material, or finds one that is the same.
    pub fn add_material(&mut self, material: Material) -> MaterialId {
        let found = self.materials.iter().position(|m| *m == material);
        let index = found.unwrap_or_else(|| {
            self.materials.push(material);
            self.materials.len() - 1
        });
        MaterialId(index as u32)
    }
}

/// A number that is different for each operation.
fn op_key(op: Op) -> u64 {
    6 << 40 | op as u64
}

fn hash(key: u64, args: &[NodeId]) -> u64 {
    let mut hasher = FxHasher::default();
    hasher.write_u32((key >> 32) as u32);
    hasher.write_u32(key as u32);
    for arg in args {
        hasher.write_u32(arg.0);
    }
    hasher.finish()
}

fn hash_node(node: &Node) -> u64 {
    let leaf = |kind: u64, number: u32| hash(kind << 40 | u64::from(number), &[]);
    match node {
        Node::Constant(bits) => hash(*bits, &[]),
        Node::Leaf(Leaf::P(i)) => leaf(1, (*i).into()),
        Node::Leaf(Leaf::Normal(i)) => leaf(2, (*i).into()),
        Node::Leaf(Leaf::Time) => leaf(3, 0),
        Node::Leaf(Leaf::Parameter(i)) => leaf(4, *i),
        Node::Leaf(Leaf::Variable(v)) => leaf(5, *v),
        Node::Op(op, args) => hash(op_key(*op), args),
        // The functions of a shape, and the claims of a node, are few.
        Node::Call(shape, _, args) => hash(7 << 40 | u64::from(shape.0), args),
        Node::Claim(args, _) => hash(8 << 40, args),
        Node::Factor(i) => leaf(9, *i),
    }
}
