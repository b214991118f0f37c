//! What a ray finds without a search: planes, which it meets where their formula says, and the box about everything else.
//!
//! The bound is the distance in all directions. Of a plane that is far too little for a ray that goes along it, and for one that leaves it:
//! its way to a plane is the height over the slope along the ray. So planes that are united with the rest of a scene are met apart, and the
//! ray follows the bound of the rest alone.

use crate::analysis::chain::DEEP;
use crate::analysis::region::WORLD_SIDE;
use crate::analysis::{Box3, Facts};
use crate::blocks::SceneBlocks;
use crate::functions::builder::Builder;
use crate::functions::made::{Ahead, Planes};
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::{FAR, Function, Graph, Leaf, Node, NodeId, ShapeId};
use crate::rules::RuleSet;

/// A ray that is more level than this against a plane meets it where one of this slope does.
const LEVEL: f64 = 1e-9;

/// So many operands are looked at for planes.
const MOST_PARTS: usize = 512;
/// Near the ends of the scene everything goes over into the sky: so many times as far as what is solid the extent has to reach…
const LEAST: f64 = 1.5;
/// …and so many times does one that is made for it, as there may be a floor.
pub(super) const AMPLE: f64 = 5.0;
/// A box is wider than what is solid by so much of its widest side, so that a ray has looked twice before it is there.
const ROOM: f64 = 0.01;
/// Cells of that grid, as a share of the box's widest side, at most.
const FEW: f64 = 1.0 / 16.0;

/// The extent that a scene should have of which the text says none, where that is known and more than it has: five times as far as what is
/// solid but its planes.
pub fn ample_extent(graph: &mut Graph, facts: &mut Facts, root: ShapeId, blocks: &SceneBlocks) -> Option<f64> {
    Builder::new(graph, facts, root, (blocks, false)).ample_extent()
}

/// A box with room about it, so that a ray has looked twice before it is at what is solid.
fn with_room(solid: Box3) -> Box3 {
    let widest = solid.0.iter().map(|side| side.width()).fold(0.0, f64::max);
    solid.grow(ROOM * widest)
}

/// A box about another one, on a coarse grid, so that it mostly stays the same when that one changes a little.
///
/// It stands in the text of the module. The numbers of a table do not, so an edited one needs no new pipeline.
fn of_few_numbers(region: Box3) -> Box3 {
    let widest = region.0.iter().map(|side| side.width()).fold(0.0, f64::max);
    if !widest.is_normal() {
        return region;
    }
    let step = (widest * FEW).log2().floor().exp2();
    Box3(region.0.map(|side| Interval::new((side.lo / step).floor() * step, (side.hi / step).ceil() * step)))
}

impl Builder<'_> {
    /// What is ahead of rays in the scene. Asked when all formulas and unions are known.
    pub(super) fn ahead(&mut self) -> Ahead {
        let root = |function| self.built.formulas.get(&(self.root, function)).copied();
        let all = [Function::Field, Function::Bound, Function::Distance].map(root);
        let [Some(field), Some(bound), Some(distance)] = all else { return Ahead::default() };
        let is_table = [Function::Bound, Function::Distance].iter().any(|f| self.built.unions.contains_key(&(self.root, *f)));
        let mut planes = if is_table { Vec::new() } else { self.planes_among(bound) };
        for other in [distance, field] {
            let known = if planes.is_empty() { Vec::new() } else { self.planes_among(other) };
            planes.retain(|plane| known.contains(plane));
        }
        let solid = if planes.is_empty() { Some(field) } else { self.without(field, &planes) };
        let is_nothing = solid.is_none();
        let (solid, home) = solid.map_or((None, None), |solid| self.where_solid(solid));
        let region = if is_nothing { Some(Box3::cube(ROOM)) } else { solid.map(with_room) };
        let region = if self.is_all_table() { region.map(of_few_numbers) } else { region };
        let Some(&first) = planes.first() else { return Ahead { planes: None, solid, region, home } };
        let (rest_bound, rest_distance) = (self.without(bound, &planes), self.without(distance, &planes));
        let mut distance = first;
        let mut way = self.way_to(first);
        for &plane in planes.iter().skip(1) {
            let another = self.way_to(plane);
            distance = self.graph.op(Op::Min, &[distance, plane]);
            way = self.graph.op(Op::Min, &[way, another]);
        }
        let far = self.graph.constant(FAR);
        let rest = |node: Option<NodeId>| node.unwrap_or(far);
        let planes = Planes { distance, way, rest_bound: rest(rest_bound), rest_distance: rest(rest_distance) };
        Ahead { planes: Some(planes), solid, region, home }
    }

    /// The extent that the scene should have, where that is known and more than it has. Its formula alone tells.
    pub(super) fn ample_extent(&mut self) -> Option<f64> {
        let field = self.graph.shape(self.root)?.value;
        let planes = self.planes_among(field);
        let solid = if planes.is_empty() { field } else { self.without(field, &planes)? };
        let (solid, box_about) = self.box_about(solid)?;
        let reach = |solid: Box3| solid.0.map(Interval::magnitude).into_iter().fold(0.0, f64::hypot);
        let known = |reach: &f64| AMPLE * reach < WORLD_SIDE;
        // Where parameters may put it anywhere, it is somewhere at first.
        let reach = Some(reach(box_about)).filter(known).or_else(|| {
            let home = self.home(solid);
            (!home.is_empty()).then(|| reach(home)).filter(known)
        })?;
        (LEAST * reach > self.scene.extent).then_some(AMPLE * reach)
    }

    /// Whether the scene is a union that is a table, wherever that stands, and nothing else.
    fn is_all_table(&self) -> bool {
        let mut of = (self.root, Function::Field);
        while !self.built.unions.contains_key(&of) {
            match self.built.formulas.get(&of).map(|formula| self.graph.node(*formula)) {
                Some(Node::Call(shape, function, _)) => of = (*shape, *function),
                _ => return false,
            }
        }
        true
    }

    /// The formula of a shape's function; the field's is known before any are built.
    fn formula(&self, shape: ShapeId, function: Function) -> Option<NodeId> {
        let field = || (function == Function::Field).then(|| self.graph.shape(shape)).flatten().map(|s| s.value);
        self.built.formulas.get(&(shape, function)).copied().or_else(field)
    }

    /// The planes that a formula in the scene's space is the least of, each once; none where they are many, or stand among very much.
    fn planes_among(&mut self, node: NodeId) -> Vec<NodeId> {
        let mut open = vec![node];
        let mut planes = Vec::new();
        for _ in 0..MOST_PARTS {
            let Some(node) = open.pop() else { return planes };
            match self.operands(node) {
                Some(parts) => open.extend(parts),
                None if !planes.contains(&node) && self.is_straight(node) => planes.push(node),
                None => {}
            }
        }
        Vec::new()
    }

    /// Whether a plane may be among the operands of which a formula is the least, in whatever space.
    fn may_hold_plane(&mut self, node: NodeId) -> bool {
        if let Some(known) = self.planes.get(&node) {
            return *known;
        }
        self.found.deep += 1;
        if self.found.deep > DEEP {
            let formula = |builder: &Self, shape| builder.formula(shape, Function::Field);
            let known = |shape| formula(self, shape).is_none_or(|formula| self.planes.contains_key(&formula));
            for shape in self.graph.called_below(node, known) {
                if let Some(formula) = formula(self, shape) {
                    self.may_hold_plane(formula);
                }
            }
        }
        let holds = match self.graph.node(node).clone() {
            Node::Op(Op::Min, args) => args.iter().any(|&a| self.may_hold_plane(a)),
            Node::Call(shape, function, _) if !self.built.unions.contains_key(&(shape, function)) => {
                self.formula(shape, function).is_some_and(|formula| self.may_hold_plane(formula))
            }
            _ => self.is_straight(node),
        };
        self.found.deep -= 1;
        self.planes.insert(node, holds);
        holds
    }

    /// A formula in the scene's space without planes that it is the least of; none where nothing else is there.
    fn without(&mut self, node: NodeId, planes: &[NodeId]) -> Option<NodeId> {
        if planes.contains(&node) {
            return None;
        }
        let Some(parts) = self.operands(node) else { return Some(node) };
        let rest: Vec<Option<NodeId>> = parts.iter().map(|part| self.without(*part, planes)).collect();
        if rest.iter().zip(&parts).all(|(rest, part)| *rest == Some(*part)) {
            return Some(node);
        }
        rest.into_iter().flatten().reduce(|a, b| self.graph.op(Op::Min, &[a, b]))
    }

    /// The operands of which a formula is the least: its own, or what it calls, opened, if that may hold a plane. None where it is no such formula.
    fn operands(&mut self, node: NodeId) -> Option<Vec<NodeId>> {
        match self.graph.node(node).clone() {
            Node::Op(Op::Min, args) => Some(args.to_vec()),
            Node::Call(shape, function, args) if !self.built.unions.contains_key(&(shape, function)) => {
                let formula = self.formula(shape, function)?;
                self.may_hold_plane(formula).then(|| vec![self.graph.open(shape, formula, &args)])
            }
            _ => None,
        }
    }

    /// How far ahead a plane is. Within it there is no way.
    fn way_to(&mut self, plane: NodeId) -> NodeId {
        let gradient = self.gradient(plane);
        let zero = self.graph.constant(0.0);
        let mut slope = zero;
        for (axis, along) in (0..3).zip(gradient) {
            let direction = self.graph.leaf(Leaf::Normal(axis));
            let part = self.graph.op(Op::Mul, &[along, direction]);
            slope = self.graph.op(Op::Add, &[slope, part]);
        }
        let (level, far) = (self.graph.constant(LEVEL), self.graph.constant(FAR));
        let fall = self.graph.op(Op::Neg, &[slope]);
        let fall = self.graph.op(Op::Max, &[fall, level]);
        let height = self.graph.op(Op::Max, &[plane, zero]);
        let way = self.graph.op(Op::Div, &[height, fall]);
        let least = self.graph.op(Op::Min, &[plane, slope]);
        let is_met = self.graph.op(Op::Lt, &[least, zero]);
        self.graph.op(Op::Select, &[is_met, way, far])
    }

    /// The box about what is solid where all parameters are as the text gives them.
    fn home(&mut self, solid: NodeId) -> Box3 {
        let (graph, far) = (&*self.graph, self.far());
        let look = |facts: &mut Facts, far: f64| facts.close_outline(graph, solid, far).intersect(&facts.outline_in_regions(graph, solid, 0));
        if graph.parameters.is_empty() {
            return self.facts.on_top(|facts| look(facts, far));
        }
        let pinned = graph.parameters.iter().map(|p| p.default).collect();
        look(&mut Facts::at(pinned, RuleSet::default()), self.scene.extent)
    }

    /// What reaches farther is looked at more closely. Nothing is where the text says from where and how far one sees.
    fn far(&self) -> f64 {
        if self.scene.framed || !self.scene.says_extent { self.scene.extent } else { f64::INFINITY }
    }

    /// The box about what is solid, and that box as the text gives the parameters.
    fn where_solid(&mut self, solid: NodeId) -> (Option<Box3>, Option<Box3>) {
        let Some((solid, box_about)) = self.box_about(solid) else { return (None, None) };
        let extent = self.scene.extent;
        let ends = |solid: &Box3| solid.0.iter().all(|side| side.magnitude() < extent);
        let known = Some(box_about).filter(ends);
        // What holds for all parameters holds for these, and may say more where looks are spent.
        let home = self.scene.framed.then(|| self.home(solid).intersect(&box_about)).filter(|home| !home.is_empty() && ends(home));
        (known, home)
    }

    /// What is solid but the planes, or all of it where nothing else is within the extent, and a box that holds it. None where nothing is solid.
    fn box_about(&mut self, solid: NodeId) -> Option<(NodeId, Box3)> {
        if self.scene.extent > WORLD_SIDE {
            return None;
        }
        // What is nowhere within the extent may be beyond it.
        let whole = self.graph.shape(self.root).map(|shape| shape.value);
        let (graph, far) = (&*self.graph, self.far());
        [Some(solid), whole].into_iter().flatten().find_map(|solid| {
            let outline = self.facts.on_top(|facts| facts.close_outline(graph, solid, far));
            (!outline.is_empty()).then_some((solid, outline))
        })
    }
}
