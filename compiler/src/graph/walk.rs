//! Walks over the graph: what nodes need, nodes made anew with other leaves, values over any algebra.

use super::algebra::Algebra;
use super::{Function, Graph, Leaf, Made, Node, NodeId, ShapeId};
use rustc_hash::FxHashMap;
use smallvec::SmallVec;

/// So many nodes are looked for in a list faster than in a set of all nodes of a large graph.
const FEW: usize = 48;

/// So many words hold a bit for each node of a small graph.
const SHORT: usize = 64;

impl Graph {
    /// Every node that the roots need, arguments before the nodes that use them, each once. Calls are not entered.
    pub fn reachable(&self, roots: &[NodeId]) -> Vec<NodeId> {
        self.reachable_among(roots, |_| true)
    }

    /// The same where it is a few nodes, in time that does not depend on how large the graph is.
    pub fn reachable_few(&self, roots: &[NodeId]) -> Option<Vec<NodeId>> {
        let mut found = Vec::new();
        self.few(roots, |id| self.arguments(id), |_| true, &mut found).then_some(found)
    }

    /// Every node without the arguments that are not `wanted`, and what only they need.
    pub fn reachable_among(&self, roots: &[NodeId], wanted: impl Fn(NodeId) -> bool) -> Vec<NodeId> {
        self.needed(roots, |id| self.arguments(id), wanted)
    }

    /// The same with what is `inside` of a node in place of its arguments: nodes that are older.
    pub fn needed<'g>(&'g self, roots: &[NodeId], inside: impl Fn(NodeId) -> &'g [NodeId], wanted: impl Fn(NodeId) -> bool) -> Vec<NodeId> {
        let mut order = Vec::with_capacity(16);
        self.find_needed(roots, inside, wanted, &mut order);
        order
    }

    /// Every node that the values of the roots are computed from, in the same order: without what claims speak of. Into `order`.
    pub fn computed(&self, roots: &[NodeId], order: &mut Vec<NodeId>) {
        self.computed_from(roots, |id| self.operands(id), order);
    }

    /// The same with other operands of nodes, which are older than they.
    pub fn computed_from<'g>(&'g self, roots: &[NodeId], operands: impl Fn(NodeId) -> &'g [NodeId], order: &mut Vec<NodeId>) {
        self.find_needed(roots, operands, |_| true, order);
    }

    /// The nodes that the value of a node is computed from. Of a claim that is what it is about.
    pub fn operands(&self, id: NodeId) -> &[NodeId] {
        match self.node(id) {
            Node::Claim(args, _) => args.get(..1).unwrap_or(&[]),
            _ => self.arguments(id),
        }
    }

    /// The nodes that are reachable without what calls no shape, into `order`.
    pub fn calling(&self, roots: &[NodeId], order: &mut Vec<NodeId>) {
        let roots: SmallVec<[NodeId; 16]> = roots.iter().copied().filter(|r| self.reads(*r).shapes).collect();
        self.find_needed(&roots, |id| self.arguments(id), |id| self.reads(id).shapes, order);
    }

    /// The same of one root, without what was `seen` by such a walk before: a bit for each node of the graph.
    pub fn calling_more(&self, root: NodeId, seen: &mut [u64], order: &mut Vec<NodeId>) {
        let is_new = |id: NodeId| self.reads(id).shapes && seen.get(id.0 as usize / 64).is_some_and(|word| word >> (id.0 % 64) & 1 == 0);
        let root = is_new(root).then_some(root);
        self.find_needed(root.as_slice(), |id| self.arguments(id), is_new, order);
        for id in order {
            seen.get_mut(id.0 as usize / 64).into_iter().for_each(|word| *word |= 1 << (id.0 % 64));
        }
    }

    /// How many shapes one look at a shape enters, itself among them: one that two others call counts twice.
    pub fn entered(&self, shape: ShapeId) -> f64 {
        let mut order = Vec::new();
        // What a shape calls was made before it.
        let mut counts: Vec<f64> = Vec::with_capacity(shape.0 as usize + 1);
        for (_, shape) in self.shapes().take(shape.0 as usize + 1) {
            self.calling(&[shape.value], &mut order);
            let called = order.iter().filter_map(|id| match self.node(*id) {
                Node::Call(called, ..) => counts.get(called.0 as usize),
                _ => None,
            });
            counts.push(1.0 + called.sum::<f64>());
        }
        counts.last().copied().unwrap_or(0.0)
    }

    /// The roots and what is inside of them, without what is not `wanted`, into `order`.
    fn find_needed<'g>(
        &'g self,
        roots: &[NodeId],
        inside: impl Fn(NodeId) -> &'g [NodeId],
        wanted: impl Fn(NodeId) -> bool,
        order: &mut Vec<NodeId>,
    ) {
        order.clear();
        let Some(last) = roots.iter().map(|r| r.0 as usize).max() else { return };
        // Arguments have smaller indices, so one pass from the last root down finds all, in order.
        let mut short = [0u64; SHORT];
        let mut long = Vec::new();
        let marked: &mut [u64] = match short.get_mut(..=last / 64) {
            Some(short) => short,
            None => {
                if self.few(roots, &inside, &wanted, order) {
                    return;
                }
                order.clear();
                long.resize(last / 64 + 1, 0);
                &mut long
            }
        };
        // How many are marked and not yet looked at.
        let mut open = 0u32;
        let mark = |marked: &mut [u64], open: &mut u32, id: NodeId| {
            if let Some(word) = marked.get_mut(id.0 as usize / 64) {
                let bit = 1 << (id.0 % 64);
                *open += u32::from(*word & bit == 0);
                *word |= bit;
            }
        };
        for &root in roots {
            mark(marked, &mut open, root);
        }
        for index in (0..marked.len()).rev() {
            // Marking can add lower bits to the word at hand.
            let mut below = u64::MAX;
            while let Some(word) = marked.get(index).map(|w| w & below).filter(|w| *w != 0) {
                let bit = 63 - word.leading_zeros();
                below = (1 << bit) - 1;
                let id = NodeId((index * 64) as u32 + bit);
                order.push(id);
                open -= 1;
                for &argument in inside(id).iter().filter(|a| wanted(**a)) {
                    mark(marked, &mut open, argument);
                }
            }
            if open == 0 {
                break;
            }
        }
        order.reverse();
    }

    /// The same where it is a few nodes, in time that does not depend on how large the graph is. The answer: whether it is.
    fn few<'g>(
        &'g self,
        roots: &[NodeId],
        inside: impl Fn(NodeId) -> &'g [NodeId],
        wanted: impl Fn(NodeId) -> bool,
        found: &mut Vec<NodeId>,
    ) -> bool {
        let mut stack: SmallVec<[NodeId; 32]> = SmallVec::from_slice(roots);
        while let Some(id) = stack.pop() {
            if found.contains(&id) {
                continue;
            }
            if found.len() == FEW {
                return false;
            }
            found.push(id);
            stack.extend(inside(id).iter().copied().filter(|a| wanted(*a)));
        }
        // Arguments have smaller indices.
        found.sort_unstable();
        true
    }

    /// The roots again, with leaves replaced: a leaf that `replace` answers for becomes that node.
    pub fn substitute(
        &mut self,
        roots: &[NodeId],
        replace: impl Fn(Leaf) -> Option<NodeId>,
    ) -> Vec<NodeId> {
        let order = self.reachable(roots);
        self.rewrite(&order, roots, &[], replace, |_, _| None)
    }

    /// The nodes of a formula that [`Graph::abstracted`] makes anew. None where it reads the point, the normal or one of the leaves beside the places, or calls a shape.
    pub fn within_places(&self, root: NodeId, places: &[(NodeId, Leaf)]) -> Option<Vec<NodeId>> {
        let is_place = |id: NodeId| places.iter().any(|(place, _)| *place == id);
        let order = self.reachable_among(&[root], |id| !is_place(id));
        let outside = |id: &NodeId| match self.node(*id) {
            Node::Leaf(Leaf::P(_) | Leaf::Normal(_)) => true,
            Node::Leaf(leaf) => places.iter().any(|(_, other)| other == leaf),
            _ => false,
        };
        (!is_place(root) && !self.reads(root).shapes && !order.iter().any(outside)).then_some(order)
    }

    /// A formula with leaves in the places of some nodes. `order` is [`Graph::within_places`] of it.
    pub fn abstracted(&mut self, root: NodeId, order: &[NodeId], places: &[(NodeId, Leaf)]) -> NodeId {
        self.abstracted_with(root, order, places, |_, _| None)
    }

    /// The same with other nodes for some arguments: `given` answers for a node and its argument's place.
    pub fn abstracted_with(
        &mut self,
        root: NodeId,
        order: &[NodeId],
        places: &[(NodeId, Leaf)],
        given: impl Fn(NodeId, usize) -> Option<NodeId>,
    ) -> NodeId {
        let places: Vec<(NodeId, NodeId)> = places.iter().map(|(place, leaf)| (*place, self.leaf(*leaf))).collect();
        self.rewrite(order, &[root], &places, |_| None, given).first().copied().unwrap_or(root)
    }

    /// The roots with the nodes of `order` made anew, leaves replaced; of others those that `known` pairs with something else are that, the rest stay.
    /// `given` may answer for an argument of an operation or a claim in a certain place.
    fn rewrite(
        &mut self,
        order: &[NodeId],
        roots: &[NodeId],
        known: &[(NodeId, NodeId)],
        replace: impl Fn(Leaf) -> Option<NodeId>,
        given: impl Fn(NodeId, usize) -> Option<NodeId>,
    ) -> Vec<NodeId> {
        let mut done: Vec<NodeId> = Vec::with_capacity(order.len());
        let find = |done: &[NodeId], a: &NodeId| match order.binary_search(a) {
            Ok(i) => done.get(i).copied().unwrap_or(*a),
            Err(_) => known.iter().find(|(old, _)| old == a).map_or(*a, |(_, new)| *new),
        };
        for &id in order {
            let map = |a: &NodeId| find(&done, a);
            let of = |(i, a): (usize, &NodeId)| given(id, i).unwrap_or_else(|| map(a));
            let new = match self.node(id).clone() {
                Node::Leaf(leaf) => replace(leaf).unwrap_or(id),
                Node::Op(op, args) => {
                    let new: Vec<NodeId> = args.iter().enumerate().map(of).collect();
                    if new[..] == args[..] { id } else { self.op(op, &new) }
                }
                Node::Call(shape, function, args) => {
                    let new: Vec<NodeId> = args.iter().map(map).collect();
                    if new[..] == args[..] { id } else { self.call(shape, function, &new) }
                }
                Node::Claim(args, claim) => {
                    let new: Vec<NodeId> = args.iter().enumerate().map(of).collect();
                    self.intern(Node::Claim(new.into(), claim))
                }
                Node::Constant(_) | Node::Factor(_) => id,
            };
            if new != id {
                self.pass_name(id, new);
                if let Some(made) = self.result(id) {
                    let made = Made { by: made.by.clone(), of: made.of.iter().map(map).collect() };
                    self.note_result(new, made);
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
        let [opened] = self.open_all(shape, [root], args);
        opened
    }

    /// The same for so many formulas of one shape.
    pub fn open_all<const N: usize>(&mut self, shape: ShapeId, roots: [NodeId; N], args: &[NodeId]) -> [NodeId; N] {
        self.open_list(shape, &roots, args).try_into().unwrap_or(roots)
    }

    /// The same for several formulas of one shape.
    pub fn open_list(&mut self, shape: ShapeId, roots: &[NodeId], args: &[NodeId]) -> Vec<NodeId> {
        let Some(variables) = self.shape(shape).map(|s| s.variables.clone()) else { return roots.to_vec() };
        // What reads nothing of the space stays as it is.
        if roots.iter().all(|&r| self.reads(r).nothing()) {
            return roots.to_vec();
        }
        let order = self.reachable_among(roots, |id| !self.reads(id).nothing());
        self.rewrite(&order, roots, &[], |leaf| match leaf {
            Leaf::P(i) => args.get(i as usize).copied(),
            Leaf::Variable(v) => {
                let at = variables.binary_search(&v).ok()?;
                args.get(3 + at).copied()
            }
            _ => None,
        }, |_, _| None)
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
