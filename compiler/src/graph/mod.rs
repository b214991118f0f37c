//! The graph: formulas over numbers, shared by hash, and shapes made of formulas.
//!
//! A [`Node`] is a number (or a condition, 0 or 1) that depends on the point `p` of the space in which it stands, on parameters, on
//! time and on variables. A [`Shape`] is a node with a space of its own; other formulas ask for its value at a point through
//! [`Node::Call`]. A union is the `min` of two calls; a twist is a call at a twisted point: the structure that the analysis
//! needs is the structure of the formulas.

pub mod algebra;
mod blend;
mod factor;
mod id;
pub(crate) mod index;
pub mod interval;
pub mod joint;
pub mod kernel;
mod labelled;
mod labels;
mod leaves;
mod list;
mod node;
mod outside;
pub mod partials;
pub mod print;
mod reads;
mod shape;
pub mod simplify;
mod walk;

pub use factor::{Factor, Proof, multiple_of, narrow};
pub use id::{MaterialId, NodeId, ShapeId};
pub use labels::Made;
pub use list::NodeList;
pub use node::{ANY_TIME, Claim, ClaimGroup, FAR, FIRST_VARIABLE, Function, Leaf, Node, ParameterComponent, ValueRange, WORLD};
pub use shape::{Baked, Exactness, Material, MaterialImage, Shape, Slot};

use crate::figure::Figure;
use crate::kept::{Data, Kept};
use crate::outline::Outline;
use crate::sampled::Grid;
use crate::source::ImageFile;
use index::Index;
use kernel::{Kind, Op};
use labels::Labels;
use reads::{Reads, Sets};
use rustc_hash::FxHasher;
use simplify::Terms;
use std::hash::{Hash, Hasher};
use std::sync::Arc;

/// Formulas of shapes' functions, in the space of the shape.
pub type Opened = rustc_hash::FxHashMap<(ShapeId, Function), NodeId>;

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
    /// Grids that formulas read by their numbers.
    pub grids: Vec<Kept<Grid>>,
    /// The outlines that formulas read, in the order in which the text names them.
    pub outlines: Vec<Kept<Outline>>,
    /// The figures in space that formulas read, likewise.
    pub figures: Vec<Kept<Figure>>,
    /// Shapes that are read from grids of samples, in the order in which they were met.
    pub baked: Vec<Baked>,
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

    /// Whether a node is a number or a condition.
    pub fn kind(&self, id: NodeId) -> Kind {
        match self.node(id) {
            Node::Op(op, _) => op.row().result,
            _ => Kind::Number,
        }
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

    /// The variables that a node reads, in ascending order.
    pub(crate) fn variables_of(&self, id: NodeId) -> Arc<[u32]> {
        self.sets.get(self.reads(id).variables)
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

    /// The value of a grid at a point, beyond its box at the nearest place of that.
    pub fn sampled(&mut self, kept: &Kept<Grid>, [x, y, z]: [NodeId; 3]) -> NodeId {
        if self.grids.iter().all(|known| known.number != kept.number) {
            self.grids.push(kept.clone());
        }
        let number = self.constant(kept.number);
        self.op(Op::Sampled, &[number, x, y, z])
    }

    /// The signed distance to an outline.
    pub fn outlined(&mut self, kept: &Kept<Outline>, [x, y]: [NodeId; 2]) -> NodeId {
        if self.outlines.iter().all(|known| known.number != kept.number) {
            self.outlines.push(kept.clone());
        }
        let number = self.constant(kept.number);
        self.op(Op::Outlined, &[number, x, y])
    }

    /// The distance to a figure, below zero inside of a closed one.
    pub fn figured(&mut self, kept: &Kept<Figure>, [x, y, z]: [NodeId; 3]) -> NodeId {
        if self.figures.iter().all(|known| known.number != kept.number) {
            self.figures.push(kept.clone());
        }
        let number = self.constant(kept.number);
        self.op(Op::Figured, &[number, x, y, z])
    }

    /// The number of what an operation reads, where it is one that does.
    pub fn data_of(&self, id: NodeId) -> Option<(Op, f64)> {
        let Node::Op(op, args) = self.node(id) else { return None };
        let number = args.first().filter(|_| op.reads_data()).and_then(|number| self.as_constant(*number))?;
        Some((*op, number))
    }

    /// The content of what an operation reads.
    pub fn content_of(&self, id: NodeId) -> Option<u64> {
        let (op, number) = self.data_of(id)?;
        let grid = || self.grids.iter().find(|kept| kept.number == number).map(|kept| kept.data.content());
        let outline = || self.outlines.iter().find(|kept| kept.number == number).map(|kept| kept.data.content());
        let figure = || self.figures.iter().find(|kept| kept.number == number).map(|kept| kept.data.content());
        if op.reads_grid() {
            grid()
        } else if op.reads_figure() {
            figure()
        } else {
            outline()
        }
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

    /// 2 for a drawing, else 3.
    pub fn dimensions(&self, id: ShapeId) -> u8 {
        self.shape(id).map_or(3, |s| s.dimensions)
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

impl Terms for Graph {
    type Id = NodeId;
    fn as_constant(&self, id: NodeId) -> Option<f64> {
        Graph::as_constant(self, id)
    }
    fn operation(&self, id: NodeId) -> Option<(Op, &[NodeId])> {
        match self.node(id) {
            Node::Op(op, args) if !self.labels.stands_apart(id) => Some((*op, args)),
            _ => None,
        }
    }
    fn constant(&mut self, value: f64) -> NodeId {
        Graph::constant(self, value)
    }
    fn op(&mut self, op: Op, args: &[NodeId]) -> NodeId {
        Graph::op(self, op, args)
    }
    fn gathers(&self) -> bool {
        true
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
