//! What the nodes of a graph read of the space in which they stand: found once, as a node is made.

use rustc_hash::FxHashMap;
use std::sync::Arc;

/// What one node reads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reads {
    /// Whether it reads the point, or the normal.
    pub point: bool,
    /// Whether it calls a shape.
    pub shapes: bool,
    /// Whether it rounds what reads the point, beyond what is claimed to be continuous.
    pub rounds: bool,
    /// The variables that it reads: a number of [`Sets`].
    pub variables: u32,
}

impl Reads {
    /// Whether it is the same wherever it stands: it reads nothing of a space.
    pub fn nothing(self) -> bool {
        !self.point && self.variables == 0
    }
}

/// Sets of variables, each once. The first is empty.
#[derive(Clone, Debug)]
pub struct Sets {
    all: Vec<Arc<[u32]>>,
    index: FxHashMap<Arc<[u32]>, u32>,
}

impl Default for Sets {
    fn default() -> Self {
        Self { all: vec![[].into()], index: FxHashMap::default() }
    }
}

impl Sets {
    /// The variables of a set, in ascending order.
    pub fn get(&self, set: u32) -> Arc<[u32]> {
        self.all.get(set as usize).cloned().unwrap_or_default()
    }

    /// The set of one variable.
    pub fn one(&mut self, variable: u32) -> u32 {
        self.find(&[variable])
    }

    /// The set of all variables of two.
    pub fn union(&mut self, a: u32, b: u32) -> u32 {
        if a == b || b == 0 {
            return a;
        }
        if a == 0 {
            return b;
        }
        let (Some(x), Some(y)) = (self.all.get(a as usize), self.all.get(b as usize)) else { return a };
        if y.iter().all(|v| x.binary_search(v).is_ok()) {
            return a;
        }
        let mut both: Vec<u32> = x.iter().chain(y.iter()).copied().collect();
        both.sort_unstable();
        both.dedup();
        self.find(&both)
    }

    /// The set of these variables, which are in ascending order.
    pub fn find(&mut self, variables: &[u32]) -> u32 {
        if let Some(&known) = self.index.get(variables) {
            return known;
        }
        let set: Arc<[u32]> = variables.into();
        let number = self.all.len() as u32;
        self.all.push(set.clone());
        self.index.insert(set, number);
        number
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_union_holds_what_both_hold_and_each_set_is_kept_once() {
        let mut sets = Sets::default();
        let (three, five) = (sets.one(3), sets.one(5));
        let both = sets.union(five, three);
        assert_eq!(sets.get(both)[..], [3, 5]);
        assert_eq!(sets.union(three, five), both);
        assert_eq!(sets.union(both, five), both);
        assert_eq!(sets.union(five, both), both);
        assert_eq!(sets.union(0, five), five);
        assert_eq!(sets.union(five, 0), five);
        assert_eq!(sets.one(3), three);
        assert!(sets.get(0).is_empty());
    }
}
