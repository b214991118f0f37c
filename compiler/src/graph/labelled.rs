//! The names, places and makers of a graph's nodes.

use crate::graph::kernel::Op;
use crate::graph::labels::Made;
use crate::graph::{Graph, Node, NodeId, ShapeId};
use crate::source::Span;

/// A formula of fewer nodes is as good where it stands as by the name of what made it.
const LONG: usize = 40;

/// So many nodes more counts each hash but the first. A formula of several, as of a point that is strewn in a cell, is long; of one alone, as of noise's
/// lattice, drivers make better code where it stands.
const HASH: usize = 20;

/// What is moved ends at most so many bytes before what moves it: between them stands what changes no shape, as a material.
const BESIDE: u32 = 80;

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

    /// Notes that a shape, which is one for all places that say the same, stands here too.
    pub fn note_place(&mut self, id: ShapeId, span: Span) {
        if self.shape(id).is_some_and(|shape| shape.span != span) {
            self.labels.note_place(id, span);
        }
    }

    /// Where a shape stands that another one calls, which stands at `outer`: within it, or right before it as what it moves, or where it was met first.
    pub fn place_in(&self, id: ShapeId, outer: Option<Span>) -> Option<Span> {
        let first = self.shape(id)?.span;
        let Some(outer) = outer else { return Some(first) };
        let all = || std::iter::once(first).chain(self.labels.places_of(id).iter().copied()).filter(|place| place.file == outer.file);
        let within = all().find(|place| place.start >= outer.start && place.end <= outer.end);
        let before = || all().filter(|place| place.end <= outer.start && outer.start - place.end <= BESIDE).max_by_key(|place| place.end);
        Some(within.or_else(before).unwrap_or(first))
    }
}
