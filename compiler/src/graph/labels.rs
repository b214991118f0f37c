//! What nodes are called in the source, where they come from, and which function made them: for readers of the output and of diagnostics.

use crate::graph::id::{NodeId, ShapeId};
use crate::graph::list::NodeList;
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
    /// Where shapes stand in the source beside the first place.
    again: FxHashMap<ShapeId, Vec<Span>>,
}

/// So many places of one shape are remembered beside the first.
const MOST_PLACES: usize = 256;

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

    /// Notes that a shape stands in another place too.
    pub fn note_place(&mut self, id: ShapeId, place: Span) {
        let places = self.again.entry(id).or_default();
        if places.len() < MOST_PLACES && !places.contains(&place) {
            places.push(place);
        }
    }

    /// Where a shape stands beside the first place.
    pub fn places_of(&self, id: ShapeId) -> &[Span] {
        self.again.get(&id).map_or(&[], |places| places)
    }

    fn number(&self, id: NodeId) -> u32 {
        self.names.get(id.0 as usize).copied().unwrap_or(0)
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
