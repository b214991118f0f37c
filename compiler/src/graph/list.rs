//! A few nodes in their order: the arguments of a node, the components of a vector.

use crate::graph::id::NodeId;
use std::fmt;
use std::hash::{Hash, Hasher};
use std::ops::Deref;
use std::sync::Arc;

/// Nodes in their order: a list that can't change. Few stand in the list itself.
#[derive(Clone)]
pub struct NodeList(Held);

#[derive(Clone)]
enum Held {
    Few(u8, [NodeId; FEW]),
    Many(Arc<[NodeId]>),
}

/// So many take no more room than what points to more.
const FEW: usize = 5;

impl NodeList {
    /// So many times the same node.
    pub fn of(node: NodeId, count: usize) -> Self {
        std::iter::repeat_n(node, count).collect()
    }
}

impl Deref for NodeList {
    type Target = [NodeId];
    fn deref(&self) -> &[NodeId] {
        match &self.0 {
            Held::Few(count, all) => all.get(..usize::from(*count)).unwrap_or(&[]),
            Held::Many(all) => all,
        }
    }
}

impl From<&[NodeId]> for NodeList {
    fn from(nodes: &[NodeId]) -> Self {
        if nodes.len() > FEW {
            return Self(Held::Many(nodes.into()));
        }
        let mut few = [NodeId::default(); FEW];
        for (slot, &node) in few.iter_mut().zip(nodes) {
            *slot = node;
        }
        Self(Held::Few(nodes.len() as u8, few))
    }
}

impl<const N: usize> From<[NodeId; N]> for NodeList {
    fn from(nodes: [NodeId; N]) -> Self {
        nodes[..].into()
    }
}

impl From<Vec<NodeId>> for NodeList {
    fn from(nodes: Vec<NodeId>) -> Self {
        nodes[..].into()
    }
}

impl FromIterator<NodeId> for NodeList {
    fn from_iter<I: IntoIterator<Item = NodeId>>(nodes: I) -> Self {
        let mut few = [NodeId::default(); FEW];
        let mut count = 0;
        let mut nodes = nodes.into_iter();
        while let Some(node) = nodes.next() {
            match few.get_mut(count) {
                Some(slot) => *slot = node,
                None => return Self(Held::Many(few.into_iter().chain([node]).chain(nodes).collect())),
            }
            count += 1;
        }
        Self(Held::Few(count as u8, few))
    }
}

impl PartialEq for NodeList {
    fn eq(&self, other: &Self) -> bool {
        self[..] == other[..]
    }
}

impl Eq for NodeList {}

impl Hash for NodeList {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self[..].hash(state);
    }
}

impl fmt::Debug for NodeList {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self[..].fmt(f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_is_what_it_was_made_of_whether_long_or_short() {
        assert_eq!(size_of::<NodeList>(), 24);
        for count in 0..9u32 {
            let list: Vec<NodeId> = (0..count).map(NodeId).collect();
            let nodes = NodeList::from(list.clone());
            assert_eq!(nodes[..], list[..]);
            assert_eq!(nodes, NodeList::from(&list[..]));
            assert_eq!(NodeList::of(NodeId(4), list.len())[..], vec![NodeId(4); list.len()]);
            assert_eq!(nodes, list.iter().copied().collect());
            assert_ne!(nodes, NodeList::from((0..=count).map(NodeId).collect::<Vec<_>>()));
        }
    }
}
