//! The arguments of a node.

use super::NodeId;
use std::fmt;
use std::hash::{Hash, Hasher};
use std::ops::Deref;
use std::sync::Arc;

/// Arguments of a node, in their order: a list that can't change. Few stand in the node itself.
#[derive(Clone)]
pub struct Args(Held);

#[derive(Clone)]
enum Held {
    Few(u8, [NodeId; FEW]),
    Many(Arc<[NodeId]>),
}

/// So many take no more room than what points to more.
const FEW: usize = 5;

impl Deref for Args {
    type Target = [NodeId];
    fn deref(&self) -> &[NodeId] {
        match &self.0 {
            Held::Few(count, all) => all.get(..usize::from(*count)).unwrap_or(&[]),
            Held::Many(all) => all,
        }
    }
}

impl From<&[NodeId]> for Args {
    fn from(args: &[NodeId]) -> Self {
        if args.len() > FEW {
            return Self(Held::Many(args.into()));
        }
        let mut few = [NodeId::default(); FEW];
        for (slot, &arg) in few.iter_mut().zip(args) {
            *slot = arg;
        }
        Self(Held::Few(args.len() as u8, few))
    }
}

impl<const N: usize> From<[NodeId; N]> for Args {
    fn from(args: [NodeId; N]) -> Self {
        args[..].into()
    }
}

impl From<Vec<NodeId>> for Args {
    fn from(args: Vec<NodeId>) -> Self {
        args[..].into()
    }
}

impl PartialEq for Args {
    fn eq(&self, other: &Self) -> bool {
        self[..] == other[..]
    }
}

impl Eq for Args {}

impl Hash for Args {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self[..].hash(state);
    }
}

impl fmt::Debug for Args {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self[..].fmt(f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_is_what_it_was_made_of_whether_long_or_short() {
        assert_eq!(size_of::<Args>(), 24);
        for count in 0..9u32 {
            let list: Vec<NodeId> = (0..count).map(NodeId).collect();
            let args = Args::from(list.clone());
            assert_eq!(args[..], list[..]);
            assert_eq!(args, Args::from(&list[..]));
            assert_ne!(args, Args::from((0..=count).map(NodeId).collect::<Vec<_>>()));
        }
    }
}
