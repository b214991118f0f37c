//! The vectors that were made of numbers.

use crate::emit::code::ExprId;
use crate::graph::index::Index;
use rustc_hash::FxHasher;
use std::hash::Hasher;

/// A vector made of numbers.
#[derive(Clone, Copy, Debug)]
pub struct Joined {
    /// The vector.
    pub id: ExprId,
    /// How many vectors inside are put together from numbers that have nothing in common.
    pub gathers: u32,
    /// The newest number inside; numbers that are newer may be read from the vector.
    pub newest: ExprId,
}

/// The vectors that were made, by the numbers of which they were made.
#[derive(Debug, Default)]
pub struct JoinedVectors {
    all: Vec<([ExprId; 4], Joined)>,
    index: Index,
}

impl JoinedVectors {
    fn hash(key: [ExprId; 4]) -> u64 {
        let mut hasher = FxHasher::default();
        key.iter().for_each(|&id| hasher.write_u32(id));
        hasher.finish()
    }

    /// The vector that was made of these numbers.
    pub fn get(&self, key: [ExprId; 4]) -> Option<Joined> {
        let of = |at: u32| self.all.get(at as usize);
        let at = self.index.find(Self::hash(key), |at| of(at).is_some_and(|v| v.0 == key))?;
        of(at).map(|v| v.1)
    }

    /// Adds a vector that is not there.
    pub fn add(&mut self, key: [ExprId; 4], joined: Joined) {
        self.index.find_or_add(Self::hash(key), self.all.len() as u32, |_| false);
        self.all.push((key, joined));
    }

    /// Forgets all, and keeps the room.
    pub fn clear(&mut self) {
        self.all.clear();
        self.index.clear();
    }
}

/// Where else a number stands.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    /// The vector that was made of it and others.
    pub vector: ExprId,
    /// Which component it is.
    pub index: u8,
    /// Whether the vector is worth having for two of its components.
    pub plain: bool,
    /// The newest number inside the vector.
    pub newest: ExprId,
}
