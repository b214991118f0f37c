//! What nodes are called in the source, where they come from, and which function made them: for readers of the output and of diagnostics.

use super::kernel::Op;
use super::{Graph, Node, NodeId, NodeList};
use crate::source::Span;
use rustc_hash::FxHashMap;
use std::sync::Arc;

/// Names and places of nodes. The first of a node stays.
#[derive(Clone, Debug, Default)]
pub struct Labels {
    /// For each node one more than the number of its name, or 0.
    names: Vec<u32>,
    texts: Vec<Arc<str>>,
    numbers: FxHashMap<Arc<str>, u32>,
    places: Vec<Option<Span>>,
    results: FxHashMap<NodeId, Made>,
    apart: Vec<NodeId>,
}

/// A formula of fewer nodes is as good where it stands as by the name of what made it.
const LONG: usize = 40;

/// So many nodes more counts each hash but the first. A formula of several, as of a point that is strewn in a cell, is long; of one alone, as of noise's
/// lattice, drivers make better code where it stands.
const HASH: usize = 20;

/// What made a node.
#[derive(Clone, Debug, PartialEq)]
pub struct Made {
    /// The name of a function.
    pub by: Arc<str>,
    /// The numbers that it was given; the node depends on nothing else of its space.
    pub of: NodeList,
}

impl Labels {
    /// Gives a node a name.
    pub fn name(&mut self, id: NodeId, name: &str) {
        if self.number(id) != 0 {
            return;
        }
        let number = match self.numbers.get(name) {
            Some(&known) => known,
            None => {
                let text: Arc<str> = name.into();
                self.texts.push(text.clone());
                let number = self.texts.len() as u32;
                self.numbers.insert(text, number);
                number
            }
        };
        *slot(&mut self.names, id) = number;
    }

    /// The name of a node.
    pub fn name_of(&self, id: NodeId) -> Option<&str> {
        let number = (self.number(id) as usize).checked_sub(1)?;
        self.texts.get(number).map(|n| &**n)
    }

    /// Gives a node a place.
    pub fn locate(&mut self, id: NodeId, place: Span) {
        slot(&mut self.places, id).get_or_insert(place);
    }

    /// The place of a node.
    pub fn place_of(&self, id: NodeId) -> Option<Span> {
        self.places.get(id.0 as usize).copied().flatten()
    }

    /// Gives a node the name of another.
    pub fn pass_name(&mut self, from: NodeId, to: NodeId) {
        let number = self.number(from);
        if number != 0 && self.number(to) == 0 {
            *slot(&mut self.names, to) = number;
        }
    }

    /// Notes which function made a node.
    pub fn note_result(&mut self, id: NodeId, made: Made) {
        self.results.entry(id).or_insert(made);
    }

    /// Which function made a node.
    pub fn result(&self, id: NodeId) -> Option<&Made> {
        // Mostly there is none at all.
        if self.results.is_empty() { None } else { self.results.get(&id) }
    }

    /// Nodes that no simplification looks into, for now. The answer: how many there were before.
    pub fn stand_apart(&mut self, ids: &[NodeId]) -> usize {
        let before = self.apart.len();
        self.apart.extend_from_slice(ids);
        before
    }

    /// Lets those that came after so many be looked into again.
    pub fn stand_no_more(&mut self, before: usize) {
        self.apart.truncate(before);
    }

    /// Whether no simplification looks into a node: into what is written as a function, or what one is made of.
    pub fn stands_apart(&self, id: NodeId) -> bool {
        self.apart.contains(&id) || self.result(id).is_some()
    }

    fn number(&self, id: NodeId) -> u32 {
        self.names.get(id.0 as usize).copied().unwrap_or(0)
    }
}

impl Graph {
    /// Gives a node the name that it has in the source. The first name stays.
    pub fn name_node(&mut self, id: NodeId, name: &str) {
        if !matches!(self.node(id), Node::Constant(_) | Node::Leaf(_)) {
            self.labels.name(id, name);
        }
    }

    /// The name of a node in the source.
    pub fn node_name(&self, id: NodeId) -> Option<&str> {
        self.labels.name_of(id)
    }

    /// Gives a node the name of another that became it.
    pub(super) fn pass_name(&mut self, from: NodeId, to: NodeId) {
        if !matches!(self.node(to), Node::Constant(_) | Node::Leaf(_)) {
            self.labels.pass_name(from, to);
        }
    }

    /// Notes which function of numbers alone a long formula is the result of. The first stays.
    pub fn note_result(&mut self, id: NodeId, made: Made) {
        self.labels.note_result(id, made);
    }

    /// Which function of numbers a node is noted to be the result of.
    pub fn result(&self, id: NodeId) -> Option<&Made> {
        self.labels.result(id)
    }

    /// Whether a formula of these nodes is long.
    pub fn is_long(&self, nodes: impl ExactSizeIterator<Item = NodeId>) -> bool {
        let count = nodes.len();
        let hashes = || nodes.filter(|&id| matches!(self.node(id), Node::Op(Op::Hash, _))).count();
        count >= LONG || count + HASH * hashes().saturating_sub(1) >= LONG
    }

    /// Lets no simplification look into these nodes until [`Graph::stand_no_more`] takes the answer.
    pub fn stand_apart(&mut self, ids: &[NodeId]) -> usize {
        self.labels.stand_apart(ids)
    }

    /// Ends what [`Graph::stand_apart`] began.
    pub fn stand_no_more(&mut self, before: usize) {
        self.labels.stand_no_more(before);
    }

    /// Remembers where a node came from. The first place stays.
    pub fn locate(&mut self, id: NodeId, span: Span) {
        self.labels.locate(id, span);
    }

    /// Where a node came from.
    pub fn location(&self, id: NodeId) -> Option<Span> {
        self.labels.place_of(id)
    }
}

/// The entry of a node in a list that grows as far as is needed.
fn slot<T: Clone + Default>(list: &mut Vec<T>, id: NodeId) -> &mut T {
    let at = id.0 as usize;
    if at >= list.len() {
        list.resize(at + 1, T::default());
    }
    #[allow(clippy::indexing_slicing)] // It was made long enough.
    &mut list[at]
}
