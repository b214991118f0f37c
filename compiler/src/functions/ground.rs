//! What balls need to know beyond what is seen: the scene without the shapes that they pass through, and how what is solid moves.

use crate::functions::made::Carry;
use crate::functions::surface::slope;
use crate::graph::kernel::Op;
use crate::graph::{FAR, Function, Graph, Leaf, Node, NodeId, Shape, ShapeId};
use rustc_hash::FxHashMap;

/// More solids than this in one formula are taken for one.
const MOST: usize = 64;

/// The scene without what has a material that says `solid: off`; none where nothing has. What such a shape would cut is whole.
pub fn firm(graph: &mut Graph, root: ShapeId) -> Option<ShapeId> {
    if graph.materials.iter().all(|m| m.solid) {
        return None;
    }
    let firm = Firm { graph, done: FxHashMap::default() }.shape(root)?;
    (firm != root).then_some(firm)
}

struct Firm<'a> {
    graph: &'a mut Graph,
    done: FxHashMap<ShapeId, Option<ShapeId>>,
}

impl Firm<'_> {
    /// A shape without what is not solid; none where the graph has no such shape.
    fn shape(&mut self, id: ShapeId) -> Option<ShapeId> {
        if let Some(done) = self.done.get(&id) {
            return *done;
        }
        let new = self.graph.shape(id).cloned().map(|shape| {
            let solid = shape.material.map(|m| self.graph.materials.get(m.0 as usize).is_none_or(|m| m.solid));
            let value = match solid {
                // The outermost material counts.
                Some(true) => shape.value,
                Some(false) => self.graph.constant(FAR),
                None => self.formula(shape.value),
            };
            if value == shape.value { id } else { self.graph.add_shape(Shape { value, ..shape }) }
        });
        self.done.insert(id, new);
        new
    }

    /// A formula over shapes without what is not solid.
    fn formula(&mut self, root: NodeId) -> NodeId {
        if !self.graph.reads(root).shapes {
            return root;
        }
        let mut done: FxHashMap<NodeId, NodeId> = FxHashMap::default();
        for id in self.graph.reachable(&[root]) {
            let map = |a: &NodeId| done.get(a).copied().unwrap_or(*a);
            let new = match self.graph.node(id).clone() {
                Node::Call(shape, function, args) => {
                    let args: Vec<NodeId> = args.iter().map(map).collect();
                    self.call(shape, function, &args)
                }
                Node::Op(op, args) => {
                    let args: Vec<NodeId> = args.iter().map(map).collect();
                    self.join(op, &args)
                }
                Node::Claim(args, claim) => {
                    let args: Vec<NodeId> = args.iter().map(map).collect();
                    self.graph.intern(Node::Claim(args.into(), claim))
                }
                _ => id,
            };
            done.insert(id, new);
        }
        done.get(&root).copied().unwrap_or(root)
    }

    fn call(&mut self, shape: ShapeId, function: Function, args: &[NodeId]) -> NodeId {
        let firm = self.shape(shape).unwrap_or(shape);
        let variables = |graph: &Graph, s| graph.shape(s).map(|s| s.variables.clone()).unwrap_or_default();
        let (old, new) = (variables(self.graph, shape), variables(self.graph, firm));
        if let Some(far) = self.graph.shape(firm).map(|s| s.value).filter(|v| self.is_far(*v)) {
            return far;
        }
        // It may read less than it did.
        let mut kept: Vec<NodeId> = args.iter().take(3).copied().collect();
        kept.extend(new.iter().filter_map(|v| old.binary_search(v).ok().and_then(|i| args.get(3 + i).copied())));
        self.graph.call(firm, function, &kept)
    }

    fn is_far(&self, node: NodeId) -> bool {
        self.graph.as_constant(node).is_some_and(|c| c >= FAR)
    }

    /// An operation, of which what is nowhere is no part.
    fn join(&mut self, op: Op, args: &[NodeId]) -> NodeId {
        if let (Op::Min | Op::Max, &[a, b]) = (op, args) {
            let far = self.graph.constant(FAR);
            let away = self.graph.op(Op::Neg, &[far]);
            // Nothing is no operand of a union; of an intersection it leaves nothing. All of space is the other way round.
            let (neutral, all) = if op == Op::Min { (far, away) } else { (away, far) };
            for (one, other) in [(a, b), (b, a)] {
                if one == neutral {
                    return other;
                }
                if one == all {
                    return all;
                }
            }
        }
        self.graph.op(op, args)
    }
}

/// How what is solid in a scene moves; none where no part of it does, other than that its formula changes.
pub fn carry(graph: &mut Graph, root: ShapeId) -> Option<Carry> {
    let here = graph.point();
    let point = Own { graph, done: FxHashMap::default() }.shape(root);
    let moves = |graph: &Graph, node: &NodeId| matches!(graph.node(*node), Node::Leaf(Leaf::Time | Leaf::Parameter(_)));
    if !graph.reachable(&point).iter().any(|node| moves(graph, node)) {
        return None;
    }
    let slopes = point.map(|q| here.map(|axis| slope(graph, q, axis)));
    Some(Carry { point, slopes })
}

struct Own<'a> {
    graph: &'a mut Graph,
    done: FxHashMap<ShapeId, [NodeId; 3]>,
}

impl Own<'_> {
    /// Where a shape's point lies in the space of its part. The point itself where its parts keep their places in it.
    fn shape(&mut self, id: ShapeId) -> [NodeId; 3] {
        if let Some(done) = self.done.get(&id) {
            return *done;
        }
        let own = match self.graph.shape(id).map(|s| s.value) {
            Some(value) => self.formula(value),
            None => self.graph.point(),
        };
        self.done.insert(id, own);
        own
    }

    fn formula(&mut self, node: NodeId) -> [NodeId; 3] {
        let here = self.graph.point();
        if !self.graph.reads(node).shapes {
            return here;
        }
        match self.graph.node(node).clone() {
            Node::Op(op @ (Op::Min | Op::Max), args) if args.len() == 2 => {
                let (Some(&a), Some(&b)) = (args.first(), args.get(1)) else { return here };
                let (first, second) = (self.formula(a), self.formula(b));
                let wins = if op == Op::Min { [a, b] } else { [b, a] };
                self.pick(wins, first, second)
            }
            Node::Op(Op::Neg, args) | Node::Claim(args, _) => args.first().map_or(here, |a| self.formula(*a)),
            Node::Call(shape, Function::Field, args) => self.call(shape, &args),
            _ => self.nearest(node),
        }
    }

    fn call(&mut self, shape: ShapeId, args: &[NodeId]) -> [NodeId; 3] {
        let here = self.graph.point();
        let mut args = args.to_vec();
        if self.graph.shape(shape).is_none_or(|s| s.dimensions != 3) {
            // A drawing can't tell where it is along its third axis. It stays there where the other two know nothing of that.
            let [_, _, along] = here;
            let plane: Vec<NodeId> = args.iter().take(2).copied().collect();
            if self.graph.reachable(&plane).contains(&along) {
                return here;
            }
            if let Some(third) = args.get_mut(2) {
                *third = along;
            }
        }
        let own = self.shape(shape);
        let place: Vec<NodeId> = args.iter().take(3).copied().collect();
        let moves = |node: &NodeId| matches!(self.graph.node(*node), Node::Leaf(Leaf::Time | Leaf::Parameter(_)));
        if own == here && !self.graph.reachable(&place).iter().any(moves) {
            return here;
        }
        self.graph.open_all(shape, own, &args)
    }

    /// In a blend, the part whose surface is nearest.
    fn nearest(&mut self, node: NodeId) -> [NodeId; 3] {
        let here = self.graph.point();
        let solids: Vec<NodeId> = self
            .graph
            .reachable(&[node])
            .into_iter()
            .filter(|id| matches!(self.graph.node(*id), Node::Call(_, Function::Field, _)))
            .collect();
        let Some((&first, others)) = solids.split_first().filter(|_| solids.len() <= MOST) else { return here };
        let mut best = (self.graph.op(Op::Abs, &[first]), self.formula(first));
        for &other in others {
            let (far, own) = (self.graph.op(Op::Abs, &[other]), self.formula(other));
            let picked = self.pick([best.0, far], best.1, own);
            best = (self.graph.op(Op::Min, &[best.0, far]), picked);
        }
        best.1
    }

    /// The first where the first of the values is no greater.
    fn pick(&mut self, [a, b]: [NodeId; 2], first: [NodeId; 3], second: [NodeId; 3]) -> [NodeId; 3] {
        if first == second {
            return first;
        }
        let wins = self.graph.op(Op::Le, &[a, b]);
        let mut picked = first;
        for (slot, other) in picked.iter_mut().zip(second) {
            *slot = self.graph.op(Op::Select, &[wins, *slot, other]);
        }
        picked
    }
}
