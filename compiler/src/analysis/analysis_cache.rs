//! What searches found, kept from one compilation to the next by what they searched: an edit costs only the nodes that it changed.

use super::domain::Box3;
use super::dual::Constant;
use crate::sampled::{Grid, Off};
use rustc_hash::FxHashMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::Arc;

/// How many results are kept. Beyond that all are forgotten, which costs time and nothing else.
const MOST: usize = 1 << 16;

/// The content of a formula: the same for the same formula, whatever stands around it. 128 bits, so that no two are taken for each other.
pub type Content = u128;

/// Whether a jump agrees, as far as that is known, and what it cost to look.
pub type Agreement = (Option<bool>, u64);

/// More bytes of grids are not kept.
const MOST_SAMPLED: usize = 512 << 20;

/// A formula that was sampled, and how far its grid is from it.
#[derive(Clone, Debug)]
pub struct Sampled {
    /// The samples.
    pub grid: Arc<Grid>,
    /// How far they are off between them.
    pub off: Off,
}

/// Results of searches, by content, place and budget.
#[derive(Clone, Debug, Default)]
pub struct Memory {
    /// With what the search cost of what searches may, and of the account.
    pub(super) constants: FxHashMap<Content, (Constant, u64, u64)>,
    pub(super) regions: FxHashMap<Content, (Box3, u64)>,
    pub(super) agreements: FxHashMap<Content, Agreement>,
    /// Formulas that were sampled.
    samplings: FxHashMap<Content, Sampled>,
    /// Whether searches of the last compilation were cut short.
    pub(crate) fell_short: bool,
    /// Searches made since the memory began.
    pub searched: u64,
    /// Searches that were not made, because the result was known.
    pub remembered: u64,
    /// Steps of formulas that compilations ran since the memory began: what they cost, whatever the machine.
    pub steps: u64,
}

impl Memory {
    /// Whether no search is remembered.
    pub(crate) fn is_empty(&self) -> bool {
        self.constants.is_empty() && self.regions.is_empty() && self.agreements.is_empty()
    }

    /// Remembers no search any more.
    pub(crate) fn forget(&mut self) {
        self.constants.clear();
        self.regions.clear();
        self.agreements.clear();
    }

    pub(super) fn sampled(&self, key: Content) -> Option<Sampled> {
        self.samplings.get(&key).cloned()
    }

    pub(super) fn keep_sampled(&mut self, key: Content, found: Sampled) {
        let bytes = |all: &FxHashMap<Content, Sampled>| all.values().map(|sampled| sampled.grid.bytes()).sum::<usize>();
        if bytes(&self.samplings) + found.grid.bytes() > MOST_SAMPLED {
            self.samplings.clear();
        }
        self.samplings.insert(key, found);
    }

    pub(super) fn make_room(&mut self) {
        if self.constants.len() + self.regions.len() + self.agreements.len() > MOST {
            self.forget();
        }
    }
}

/// Two hashes of one value, each with a beginning of its own (SipHash, Aumasson and Bernstein 2012).
pub(super) fn digest(value: &impl Hash) -> Content {
    let half = |salt: u64| {
        let mut hasher = DefaultHasher::new();
        salt.hash(&mut hasher);
        value.hash(&mut hasher);
        u128::from(hasher.finish())
    };
    half(1) << 64 | half(2)
}
