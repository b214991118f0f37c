//! Grids by number: how a formula names one.
//!
//! An operation of the graph has numbers for arguments, and nothing else. So a grid has a number that is made of its content, the same in every
//! run, and who evaluates looks it up. A number means one grid as long as anybody holds that; nothing is held here.

use super::grid::Grid;
use std::collections::BTreeMap;
use std::sync::{Arc, PoisonError, RwLock, Weak};

/// A number is below this, so that 32 bits hold it exactly.
const NUMBERS: u32 = 1 << 24;

static KNOWN: RwLock<BTreeMap<u32, Weak<Grid>>> = RwLock::new(BTreeMap::new());

/// A grid that formulas may read by its number, while it is held.
#[derive(Clone, Debug)]
pub struct Kept {
    /// The number: whole, at least 1.
    pub number: f64,
    /// The grid.
    pub grid: Arc<Grid>,
}

impl Kept {
    /// Gives a grid its number. One with the same content has the same, and is the same in memory.
    pub fn new(grid: Arc<Grid>) -> Self {
        let mut known = KNOWN.write().unwrap_or_else(PoisonError::into_inner);
        known.retain(|_, grid| grid.strong_count() > 0);
        let mut number = ((grid.content() >> 40) as u32).max(1);
        loop {
            match known.get(&number).and_then(Weak::upgrade) {
                Some(other) if *other == *grid => return Self { number: number.into(), grid: other },
                // Another one happens to have it: the next that is free.
                Some(_) => number = (number + 1) % NUMBERS,
                None => break,
            }
        }
        known.insert(number, Arc::downgrade(&grid));
        Self { number: number.into(), grid }
    }

    /// The grid of a number; none where nobody holds one.
    pub fn find(number: f64) -> Option<Arc<Grid>> {
        let known = KNOWN.read().unwrap_or_else(PoisonError::into_inner);
        known.get(&(number as u32)).filter(|_| number.fract() == 0.0)?.upgrade()
    }
}
