//! The graph: formulas over numbers, shared by hash, and shapes made of formulas.
//!
//! A [`Node`] is a number (or a condition, 0 or 1) that depends on the point `p` of the space in which it stands, on parameters, on
//! time and on variables. A [`Shape`] is a node with a space of its own; other formulas ask for its value at a point through
//! [`Node::Call`]. A union is the `min` of two calls; a twist is a call at a twisted point: the structure that the analysis
//! needs is the structure of the formulas.

pub mod algebra;
pub mod interval;
pub mod kernel;
pub mod print;

use crate::source::Span;
use algebra::Algebra;
use kernel::Op;
use rustc_hash::FxHashMap;
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

/// What a node reads from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Leaf {
    /// Component of the point in the own space of the shape: 0, 1, 2.
    P(u8),
    /// Component of the surface's normal in the scene's space; in materials only.
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
    Op(Op, Arc<[NodeId]>),
    /// A function of a shape at a point: three coordinates (two of a drawing, then zero), then one value for
    /// each of the shape's variables.
    Call(ShapeId, Function, Arc<[NodeId]>),
    /// The value of the first node, with what is known of it and can't be seen from its formula; the
    /// others are what the claim speaks of.
    Claim(Arc<[NodeId]>, Claim),
    /// How far a field may be trusted, as a multiple: the reciprocal of a Lipschitz factor. An index into [`Graph::factors`].
    Factor(u32),
}

/// What is known of a value.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Claim {
    /// Its Lipschitz constant is at most the value of this formula, in which `Variable(i)` stands for
    /// the constant of the `i`-th group of the claim's other nodes. From the prelude.
    Lipschitz(NodeId, Arc<[ClaimGroup]>),
    /// The jumps inside (of a cell's index) cancel: the value is continuous.
    Continuous,
}

/// So many nodes of a claim that stand for one argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ClaimGroup {
    /// Components of a vector (or one number): the constant is that of the vector.
    Vector(u8),
    /// Values of a shape at several points: the constant is the largest.
    Values(u32),
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
}

impl Factor {
    /// One over the Lipschitz factor as 32 bits hold it, rounded down.
    pub fn multiple(&self) -> f32 {
        let nearest = (1.0 / self.lipschitz) as f32;
        if f64::from(nearest) * self.lipschitz > 1.0 { nearest.next_down() } else { nearest }
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
    /// Whether balls meet it.
    pub solid: bool,
}

/// The graph of a program.
#[derive(Clone, Debug, Default)]
pub struct Graph {
    nodes: Vec<Node>,
    index: FxHashMap<Node, NodeId>,
    /// A name from the source for a node, for the reader of the output.
    names: FxHashMap<NodeId, Arc<str>>,
    /// Where a node came from, for a diagnostic.
    spans: FxHashMap<NodeId, Span>,
    shapes: Vec<Shape>,
    shape_index: FxHashMap<Shape, ShapeId>,
    /// Materials, in the order in which they were met.
    pub materials: Vec<Material>,
    /// Components of parameters.
    pub parameters: Vec<ParameterComponent>,
    /// Factors, in the order in which they were met.
    pub factors: Vec<Factor>,
    next_variable: u32,
}

impl Graph {
    /// An empty graph.
    pub fn new() -> Self {
        Self { next_variable: FIRST_VARIABLE, ..Self::default() }
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
        if let Some(&id) = self.index.get(&node) {
            return id;
        }
        let id = NodeId(self.nodes.len() as u32);
        self.nodes.push(node.clone());
        self.index.insert(node, id);
        id
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
        [self.leaf(Leaf::P(0)), self.leaf(Leaf::P(1)), self.leaf(Leaf::P(2))]
    }

    /// A variable that nothing else uses.
    pub fn fresh_variable(&mut self) -> u32 {
        self.next_variable += 1;
        self.next_variable - 1
    }

    /// An operation, folded where its arguments are constant and simplified where that changes no value.
    pub fn op(&mut self, op: Op, args: &[NodeId]) -> NodeId {
        if let Some(simple) = kernel::simplify(self, op, args) {
            return simple;
        }
        self.intern(Node::Op(op, args.into()))
    }

    /// A function of a shape at a point. `args`: three coordinates, then the shape's variables in their order.
    pub fn call(&mut self, shape: ShapeId, function: Function, args: &[NodeId]) -> NodeId {
        self.intern(Node::Call(shape, function, args.into()))
    }

    /// The field of a shape at a point, its variables passed through from here.
    pub fn field(&mut self, shape: ShapeId, point: [NodeId; 3]) -> NodeId {
        let variables = self.shape(shape).map(|s| s.variables.clone()).unwrap_or_default();
        let mut args = point.to_vec();
        for &variable in variables.iter() {
            args.push(self.leaf(Leaf::Variable(variable)));
        }
        self.call(shape, Function::Field, &args)
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

    /// Gives a node the name that it has in the source. The first name stays.
    pub fn name_node(&mut self, id: NodeId, name: &str) {
        if !matches!(self.node(id), Node::Constant(_) | Node::Leaf(_)) {
            self.names.entry(id).or_insert_with(|| name.into());
        }
    }

    /// The name of a node in the source.
    pub fn node_name(&self, id: NodeId) -> Option<&str> {
        self.names.get(&id).map(|n| &**n)
    }

    /// Remembers where a node came from. The first place stays.
    pub fn locate(&mut self, id: NodeId, span: Span) {
        self.spans.entry(id).or_insert(span);
    }

    /// Where a node came from.
    pub fn location(&self, id: NodeId) -> Option<Span> {
        self.spans.get(&id).copied()
    }

    /// A shape. None for an index from another graph.
    pub fn shape(&self, id: ShapeId) -> Option<&Shape> {
        self.shapes.get(id.0 as usize)
    }

    /// All shapes with their indices; a shape's parts have smaller indices.
    pub fn shapes(&self) -> impl Iterator<Item = (ShapeId, &Shape)> {
        self.shapes.iter().enumerate().map(|(i, s)| (ShapeId(i as u32), s))
    }

    /// Adds a shape, or finds one that is the same. Its variables are found here.
    pub fn add_shape(&mut self, mut shape: Shape) -> ShapeId {
        let mut roots = vec![shape.value];
        let mut variables = Vec::new();
        for material in shape.material.iter().chain(shape.paints.iter().map(|(_, m)| m)) {
            if let Some(m) = self.materials.get(material.0 as usize) {
                roots.extend(m.color.iter().chain(&m.emission));
                roots.extend([m.roughness, m.metallic, m.reflectivity]);
            }
        }
        for (mask, _) in shape.paints.iter() {
            variables.extend(self.shape(*mask).iter().flat_map(|s| s.variables.iter().copied()));
        }
        variables.extend(self.free_variables(&roots));
        variables.sort_unstable();
        variables.dedup();
        shape.variables = variables.into();
        if let Some(&id) = self.shape_index.get(&shape) {
            return id;
        }
        let id = ShapeId(self.shapes.len() as u32);
        self.shapes.push(shape.clone());
        self.shape_index.insert(shape, id);
        id
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

    /// Every node that the roots need, arguments before the nodes that use them, each once. Calls are not entered.
    pub fn reachable(&self, roots: &[NodeId]) -> Vec<NodeId> {
        let Some(last) = roots.iter().map(|r| r.0 as usize).max() else { return Vec::new() };
        // Arguments have smaller indices, so one pass from the last root down finds all, in order.
        let mut marked = vec![0u64; last / 64 + 1];
        let mark = |marked: &mut [u64], id: NodeId| {
            if let Some(word) = marked.get_mut(id.0 as usize / 64) {
                *word |= 1 << (id.0 % 64);
            }
        };
        for &root in roots {
            mark(&mut marked, root);
        }
        let mut order = Vec::new();
        for index in (0..marked.len()).rev() {
            // Marking can add lower bits to the word at hand.
            let mut below = u64::MAX;
            while let Some(word) = marked.get(index).map(|w| w & below).filter(|w| *w != 0) {
                let bit = 63 - word.leading_zeros();
                below = (1 << bit) - 1;
                let id = NodeId((index * 64) as u32 + bit);
                order.push(id);
                for &argument in self.arguments(id) {
                    mark(&mut marked, argument);
                }
            }
        }
        order.reverse();
        order
    }

    /// The variables that the roots read, in ascending order.
    pub fn free_variables(&self, roots: &[NodeId]) -> Vec<u32> {
        let mut variables: Vec<u32> = self
            .reachable(roots)
            .into_iter()
            .filter_map(|id| match self.node(id) {
                Node::Leaf(Leaf::Variable(v)) => Some(*v),
                _ => None,
            })
            .collect();
        variables.sort_unstable();
        variables.dedup();
        variables
    }

    /// The roots again, with leaves replaced: a leaf that `replace` answers for becomes that node.
    pub fn substitute(
        &mut self,
        roots: &[NodeId],
        replace: impl Fn(Leaf) -> Option<NodeId>,
    ) -> Vec<NodeId> {
        let order = self.reachable(roots);
        let mut done: Vec<NodeId> = Vec::with_capacity(order.len());
        let find = |done: &[NodeId], a: &NodeId| {
            order.binary_search(a).ok().and_then(|i| done.get(i).copied()).unwrap_or(*a)
        };
        for &id in &order {
            let map = |a: &NodeId| find(&done, a);
            let new = match self.node(id).clone() {
                Node::Leaf(leaf) => replace(leaf).unwrap_or(id),
                Node::Op(op, args) => {
                    let new: Vec<NodeId> = args.iter().map(map).collect();
                    if new[..] == args[..] { id } else { self.op(op, &new) }
                }
                Node::Call(shape, function, args) => {
                    let new: Vec<NodeId> = args.iter().map(map).collect();
                    if new[..] == args[..] { id } else { self.call(shape, function, &new) }
                }
                Node::Claim(args, claim) => {
                    let new: Arc<[NodeId]> = args.iter().map(map).collect();
                    self.intern(Node::Claim(new, claim))
                }
                Node::Constant(_) | Node::Factor(_) => id,
            };
            if new != id {
                if let Some(name) = self.names.get(&id).cloned() {
                    self.name_node(new, &name);
                }
                if let Some(span) = self.location(id) {
                    self.locate(new, span);
                }
            }
            done.push(new);
        }
        roots.iter().map(|r| find(&done, r)).collect()
    }

    /// The formula of a shape with its point and variables replaced by the arguments of a call.
    pub fn open(&mut self, shape: ShapeId, root: NodeId, args: &[NodeId]) -> NodeId {
        let Some(variables) = self.shape(shape).map(|s| s.variables.clone()) else { return root };
        let new = self.substitute(&[root], |leaf| match leaf {
            Leaf::P(i) => args.get(i as usize).copied(),
            Leaf::Variable(v) => {
                let at = variables.binary_search(&v).ok()?;
                args.get(3 + at).copied()
            }
            _ => None,
        });
        new.first().copied().unwrap_or(root)
    }

    /// The roots with every call of a field replaced by the formula that it stands for, everywhere.
    /// Answers `None` where that makes more than `limit` nodes.
    pub fn flatten(&mut self, roots: &[NodeId], limit: usize) -> Option<Vec<NodeId>> {
        let mut memo = FxHashMap::default();
        let start = self.len();
        roots.iter().map(|&root| self.flatten_one(root, start + limit, &mut memo)).collect()
    }

    fn flatten_one(
        &mut self,
        root: NodeId,
        limit: usize,
        memo: &mut FxHashMap<NodeId, NodeId>,
    ) -> Option<NodeId> {
        for id in self.reachable(&[root]) {
            if memo.contains_key(&id) {
                continue;
            }
            if self.len() > limit {
                return None;
            }
            let map = |a: &NodeId| memo.get(a).copied().unwrap_or(*a);
            let new = match self.node(id).clone() {
                Node::Op(op, args) => {
                    let args: Vec<NodeId> = args.iter().map(map).collect();
                    self.op(op, &args)
                }
                Node::Claim(args, _) => args.first().map_or(id, map),
                Node::Call(shape, Function::Field, args) => {
                    let args: Vec<NodeId> = args.iter().map(map).collect();
                    match self.shape(shape).map(|s| s.value) {
                        Some(value) => {
                            let opened = self.open(shape, value, &args);
                            self.flatten_one(opened, limit, memo)?
                        }
                        None => id,
                    }
                }
                _ => id,
            };
            if let (true, Some(name)) = (new != id, self.names.get(&id).cloned()) {
                self.name_node(new, &name);
            }
            memo.insert(id, new);
        }
        memo.get(&root).copied()
    }

    /// Computes the roots over any algebra: reals, intervals, intervals with derivatives, or nodes of a graph.
    /// `leaf` gives the values from outside; `call` those of other shapes.
    pub fn evaluate<A: Algebra>(
        &self,
        algebra: &mut A,
        roots: &[NodeId],
        mut leaf: impl FnMut(&mut A, Leaf) -> A::Value,
        mut call: impl FnMut(&mut A, ShapeId, Function, &[A::Value]) -> A::Value,
    ) -> Vec<A::Value> {
        let mut values: FxHashMap<NodeId, A::Value> = FxHashMap::default();
        let mut buffer: Vec<A::Value> = Vec::new();
        for id in self.reachable(roots) {
            buffer.clear();
            buffer.extend(self.arguments(id).iter().filter_map(|a| values.get(a).cloned()));
            let value = match self.node(id) {
                Node::Constant(bits) => algebra.constant(f64::from_bits(*bits)),
                Node::Leaf(l) => leaf(algebra, *l),
                Node::Op(op, _) => algebra.op(*op, &buffer),
                Node::Call(shape, function, _) => call(algebra, *shape, *function, &buffer),
                Node::Claim(_, claim) => match buffer.split_first() {
                    Some((value, of)) => algebra.claim(self, value.clone(), claim, of),
                    None => algebra.constant(0.0),
                },
                Node::Factor(i) => {
                    let lipschitz = self.factors.get(*i as usize).map_or(1.0, |f| f.lipschitz);
                    algebra.constant(1.0 / lipschitz)
                }
            };
            values.insert(id, value);
        }
        roots.iter().filter_map(|r| values.get(r).cloned()).collect()
    }
}
