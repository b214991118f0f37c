//! Searches whose results earlier compilations may have left: they are made only where nothing is remembered.

use super::analysis_cache::{Agreement, Content, digest, Sampled};
use super::domain::{Box3, Domain, cell_ranges};
use super::dual::Constant;
use super::facts::Facts;
use crate::graph::{Claim, Exactness, Graph, Leaf, Node, NodeId, ShapeId};

impl Facts {
    /// A constant that was found before, or else by `search`.
    pub(super) fn remembered_constant(
        &mut self,
        graph: &Graph,
        nodes: &[NodeId],
        domain: &Domain,
        budget: usize,
        search: impl FnOnce(&mut Self) -> Constant,
    ) -> Constant {
        if !self.pinned.is_empty() {
            return search(self);
        }
        let contents: Vec<Content> = nodes.iter().map(|&n| self.content(graph, n)).collect();
        let key = digest(&(contents, self.content_of_domain(graph, domain), budget, self.account.steps, self.account.has_leisure()));
        if let Some(&(known, cost, spent)) = self.memory.constants.get(&key) {
            self.memory.remembered += 1;
            // As if it had been searched: what is left for others must not depend on what is remembered.
            self.account.searched += cost;
            self.account.spend(spent);
            return known;
        }
        let before = (self.account.searched, self.account.left, std::mem::take(&mut self.account.cut_short));
        let found = search(self);
        self.memory.searched += 1;
        // What was cut short may be found better by another compilation.
        if !self.account.cut_short && !self.account.is_spent() {
            self.memory.make_room();
            self.memory.constants.insert(key, (found, self.account.searched - before.0, before.1 - self.account.left));
        }
        self.account.cut_short |= before.2;
        found
    }

    /// A box within the domain that holds every point at which the node is at most zero; found before, or now.
    pub fn solid_region(&mut self, graph: &Graph, node: NodeId, domain: &Domain) -> Box3 {
        let key = digest(&(self.content(graph, node), self.content_of_domain(graph, domain), domain.narrowed));
        if let Some(&(known, spent)) = self.memory.regions.get(&key) {
            self.memory.remembered += 1;
            self.account.spend(spent);
            return known;
        }
        let (left, before) = (self.account.left, std::mem::take(&mut self.account.cut_short));
        let found = self.region(graph, node, domain, 0.0);
        self.memory.searched += 1;
        if !self.account.cut_short && !self.account.is_spent() {
            self.memory.make_room();
            self.memory.regions.insert(key, (found, left - self.account.left));
        }
        self.account.cut_short |= before;
        found
    }

    /// By what it is kept whether the jump of an operation agrees in a formula; and whether it does and what it cost to look, where that is known.
    pub fn agreement(&mut self, graph: &Graph, [root, site]: [NodeId; 2], domain: &Domain, most: u64) -> (Content, Option<Agreement>) {
        let key = digest(&(self.content(graph, root), self.content(graph, site), self.content_of_domain(graph, domain), most));
        let known = self.memory.agreements.get(&key).copied();
        self.memory.remembered += u64::from(known.is_some());
        (key, known)
    }

    /// Keeps what [`Facts::agreement`] asks for.
    pub fn keep_agreement(&mut self, key: Content, found: Agreement) {
        self.memory.searched += 1;
        self.memory.make_room();
        self.memory.agreements.insert(key, found);
    }

    /// By what it is kept how a formula was sampled within a box.
    pub fn sampling(&mut self, graph: &Graph, node: NodeId, settings: (u32, u64), bounds: [[f64; 3]; 2]) -> Content {
        digest(&(self.content(graph, node), settings, bounds.map(|corner| corner.map(f64::to_bits))))
    }

    /// What [`Facts::keep_sampled`] kept.
    pub fn sampled(&self, key: Content) -> Option<Sampled> {
        self.memory.sampled(key)
    }

    /// Keeps what a formula was sampled to, from one compilation to the next.
    pub fn keep_sampled(&mut self, key: Content, found: Sampled) {
        self.memory.keep_sampled(key, found);
    }

    fn content_of_domain(&mut self, graph: &Graph, domain: &Domain) -> Content {
        let within: Vec<(Content, u64)> =
            domain.within.iter().map(|(node, level)| (self.content(graph, *node), level.to_bits())).collect();
        digest(&(domain.plain_key(), domain.ids(), within, graph.is_spread, self.rules))
    }

    /// The content of a node.
    fn content(&mut self, graph: &Graph, node: NodeId) -> Content {
        if let Some(known) = self.contents.get(&node) {
            return *known;
        }
        // From below, so that no stack follows how many shapes stand within each other.
        for shape in graph.called_below(node, |shape| graph.shape(shape).is_none_or(|s| self.contents.contains_key(&s.value))) {
            self.content_of_shape(graph, shape);
        }
        for id in graph.reachable(&[node]) {
            if self.contents.contains_key(&id) {
                continue;
            }
            let args: Vec<Content> =
                graph.arguments(id).iter().map(|a| self.contents.get(a).copied().unwrap_or(0)).collect();
            let own = match graph.node(id) {
                Node::Constant(bits) => digest(&(0, bits)),
                Node::Leaf(Leaf::Parameter(i)) => {
                    let range = graph.parameters.get(*i as usize).map(|p| (p.min.to_bits(), p.max.to_bits()));
                    digest(&(1, i, range))
                }
                Node::Leaf(leaf) => digest(&(2, leaf)),
                // The number of a grid or an outline may be another one's by now.
                Node::Op(op, _) if op.reads_data() => digest(&(8, op, args, graph.content_of(id))),
                Node::Op(op, _) => digest(&(3, op, args)),
                Node::Call(shape, function, _) => digest(&(4, self.content_of_shape(graph, *shape), function, args)),
                Node::Claim(_, Claim::Continuous) => digest(&(5, args)),
                Node::Claim(_, Claim::Lipschitz(formula, groups, range)) => {
                    digest(&(6, self.content(graph, *formula), groups, range, args))
                }
                Node::Factor(i) => digest(&(7, graph.factors.get(*i as usize).map(|f| f.lipschitz.to_bits()))),
            };
            let solid = self.known_solid(id).map(|b| b.0.map(|i| (i.lo.to_bits(), i.hi.to_bits())));
            self.contents.insert(id, digest(&(own, solid)));
        }
        self.contents.get(&node).copied().unwrap_or(0)
    }

    fn content_of_shape(&mut self, graph: &Graph, shape: ShapeId) -> Content {
        let Some(s) = graph.shape(shape) else { return 0 };
        let (value, variables, exact) = (s.value, s.variables.clone(), s.exactness == Exactness::Exact);
        digest(&(self.content(graph, value), variables, exact))
    }

    /// A box that holds all of a repetition's body, over all of its cells.
    pub fn body_region(
        &mut self,
        graph: &mut Graph,
        shape: ShapeId,
        cells: &dyn Fn(u32) -> Option<(f64, f64)>,
        within: Box3,
    ) -> Box3 {
        let Some(value) = graph.shape(shape).map(|s| s.value) else { return Box3::ALL };
        let domain = Domain { variables: cell_ranges(graph, shape, cells), ..Domain::of(within) };
        self.solid_region(graph, value, &domain)
    }
}
