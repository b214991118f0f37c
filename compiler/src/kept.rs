//! Grids and outlines by number: how a formula names one.
//!
//! An operation of the graph has numbers for arguments, and nothing else. So what it reads has a number that is made of its content, the same in every
//! run, and who evaluates looks it up. A number means one thing as long as anybody holds that; nothing is held here.

use std::collections::BTreeMap;
use std::sync::{Arc, PoisonError, RwLock, Weak};

/// A number is below this, so that 32 bits hold it exactly.
const NUMBERS: u32 = 1 << 24;
/// Words of a head on a device.
pub const HEAD: usize = 16;

/// Data of one kind by its number.
pub type Known<T> = RwLock<BTreeMap<u32, Weak<T>>>;

/// Data that formulas read by its number.
pub trait Data: PartialEq + 'static {
    /// A number of all that it holds, the same on every machine; two seldom have the same.
    fn content(&self) -> u64;

    /// Its head on a device, and the words that follow it somewhere. `at`: where the first word after the head will stand.
    fn words(&self, at: u32) -> ([u32; HEAD], Vec<u32>);

    /// What is held of its kind.
    fn known() -> &'static Known<Self>
    where
        Self: Sized;
}

/// Data that formulas may read by its number, while it is held.
#[derive(Debug)]
pub struct Kept<T> {
    /// The number: whole, at least 1.
    pub number: f64,
    /// The data.
    pub data: Arc<T>,
}

impl<T> Clone for Kept<T> {
    fn clone(&self) -> Self {
        Self { number: self.number, data: self.data.clone() }
    }
}

impl<T: Data> Kept<T> {
    /// Gives data its number. What has the same content has the same, and is the same in memory.
    pub fn new(data: Arc<T>) -> Self {
        let mut known = T::known().write().unwrap_or_else(PoisonError::into_inner);
        known.retain(|_, data| data.strong_count() > 0);
        let mut number = ((data.content() >> 40) as u32).max(1);
        loop {
            match known.get(&number).and_then(Weak::upgrade) {
                Some(other) if *other == *data => return Self { number: number.into(), data: other },
                // Another one happens to have it: the next that is free.
                Some(_) => number = ((number + 1) % NUMBERS).max(1),
                None => break,
            }
        }
        known.insert(number, Arc::downgrade(&data));
        Self { number: number.into(), data }
    }

    /// The data of a number; none where nobody holds any.
    pub fn find(number: f64) -> Option<Arc<T>> {
        let known = T::known().read().unwrap_or_else(PoisonError::into_inner);
        known.get(&(number as u32)).filter(|_| number.fract() == 0.0)?.upgrade()
    }
}
