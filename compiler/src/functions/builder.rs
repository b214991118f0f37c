//! What the rules of the functions read and what grows while they work.

use crate::analysis::search::Target;
use crate::analysis::{Box3, Domain, Facts};
use crate::blocks::SceneBlocks;
use crate::diagnostic::{Code, Diagnostic};
use crate::functions::found::{Found, Folds, Gradients, Materials};
use crate::functions::made::{Functions, Kind};
use crate::graph::interval::Interval;
use crate::graph::{Function, Graph, Node, NodeId, ShapeId, WORLD};
use crate::source::Span;
use rustc_hash::FxHashMap;

/// What the scene says of how its functions are to be.
pub(super) struct Asked {
    /// Half the side of the cube within which it is drawn.
    pub extent: f64,
    /// Whether the text says it.
    pub says_extent: bool,
    /// Whether there is a camera that frames what is solid.
    pub framed: bool,
    /// Whether what can't be proven is an error.
    pub strict: bool,
}

/// What is made on the way from graph to functions.
pub struct Builder<'a> {
    pub(super) graph: &'a mut Graph,
    pub(super) facts: &'a mut Facts,
    pub(super) root: ShapeId,
    pub(super) scene: Asked,
    pub(super) domains: FxHashMap<ShapeId, Domain>,
    pub(super) found: Found,
    /// Whether the scene has so many parts that they may be a union of many; found when it is first asked for.
    pub(super) crowded: Option<bool>,
    pub(super) built: Functions,
    /// What was found on the way.
    pub diagnostics: Vec<Diagnostic>,
    /// What is known of the whole.
    pub kind: Kind,
    /// Gradients and the jumps that light sees.
    pub(super) gradients: Gradients,
    /// Materials of surfaces.
    pub(super) materials: Materials,
    /// Formulas that become functions, and trees of one operation.
    pub(super) folds: Folds,
    /// Whether a plane may be among the operands of a union.
    pub(super) planes: FxHashMap<NodeId, bool>,
    /// How wide the widest opening is of which the estimate of the distance tells a face that is not there.
    pub(super) opening: f64,
    /// Within how many smooth unions, each taken apart, the bound that is being made lies.
    pub(super) parting: u32,
}

fn with_room<K, V>(count: usize) -> FxHashMap<K, V> {
    FxHashMap::with_capacity_and_hasher(count, Default::default())
}

/// Where a scene is asked for: the cube of its extent, and the point of the scene within it.
pub(super) fn whole_scene(extent: f64) -> Domain {
    let world = [0, 1, 2].map(|i| (WORLD + i, Interval::new(-extent, extent)));
    Domain { variables: world.to_vec(), ..Domain::of(Box3::cube(extent)) }
}

impl<'a> Builder<'a> {
    /// Nothing built yet.
    pub(super) fn new(graph: &'a mut Graph, facts: &'a mut Facts, root: ShapeId, (blocks, strict): (&SceneBlocks, bool)) -> Self {
        let shapes = graph.shapes().len();
        graph.is_spread = graph.spreads();
        Self {
            graph,
            facts,
            root,
            scene: Asked { extent: blocks.extent, says_extent: blocks.says_extent, framed: blocks.is_framed(), strict },
            domains: with_room(shapes),
            found: Found::default(),
            crowded: None,
            built: Functions { formulas: with_room(6 * shapes), ..Functions::default() },
            diagnostics: Vec::new(),
            kind: Kind::Exact,
            gradients: Gradients::default(),
            materials: Materials::default(),
            folds: Folds::default(),
            planes: FxHashMap::default(),
            opening: 0.0,
            parting: 0,
        }
    }
}

impl Builder<'_> {
    /// The calls that the roots need. `nodes` is room for what they are found among.
    pub(super) fn calls<'n>(&'n self, roots: &[NodeId], nodes: &'n mut Vec<NodeId>) -> impl Iterator<Item = (ShapeId, Function)> + use<'n> {
        self.graph.calling(roots, nodes);
        self.called(nodes)
    }

    /// Those of some nodes.
    pub(super) fn called<'n>(&'n self, nodes: &'n [NodeId]) -> impl DoubleEndedIterator<Item = (ShapeId, Function)> + use<'n> {
        nodes.iter().filter_map(|id| match self.graph.node(*id) {
            Node::Call(shape, function, _) => Some((*shape, *function)),
            _ => None,
        })
    }

    /// Whether a node is the same everywhere in the space in which it stands.
    pub(super) fn is_uniform(&self, node: NodeId) -> bool {
        let reads = self.graph.reads(node);
        reads.nothing() && !reads.shapes
    }

    /// The components of parameters that a constant depends on.
    pub(super) fn parameters_of(&self, target: &Target) -> Vec<u32> {
        let nodes = match target {
            Target::Value(node) => std::slice::from_ref(node),
            Target::Map(point) => point,
        };
        let mut read: Vec<u32> = self.graph.parameters_under(nodes).into_iter().collect();
        read.sort_unstable();
        read
    }

    /// Where a node of a shape stands in the source.
    pub(super) fn place(&self, shape: ShapeId, node: NodeId) -> Span {
        let of_shape = self.graph.shape(shape).map(|s| s.span);
        self.graph.location(node).or(of_shape).unwrap_or(Span::new(crate::source::FileId(0), 0, 0))
    }

    /// Says that the bound of a node is made within the extent alone.
    pub(super) fn extent_used(&mut self, shape: ShapeId, node: NodeId) {
        let span = self.place(shape, node);
        self.diagnostics.push(Diagnostic::new(
            Code::ExtentUsed,
            span,
            format!(
                "this has no bound over all space; it is proven and drawn within the scene's extent of {}",
                self.scene.extent
            ),
            "keep it within a region with `.within(box(…))`, or set `render { extent: … }` to what the scene needs",
        ));
    }
}
