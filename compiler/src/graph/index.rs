//! Finds an entry of a list by what it holds.

/// The numbers of a list's entries, by their hashes. The list itself holds what is compared, so nothing is kept twice.
#[derive(Clone, Debug, Default)]
pub struct Index {
    /// The lower half of a hash and the entry's number, at the hash's place or soon after it. The length is a power of two.
    slots: Vec<(u32, u32)>,
    count: usize,
}

/// The number of no entry.
const FREE: u32 = u32::MAX;

impl Index {
    /// Room for so many entries, a power of two, before it grows.
    pub fn with_room(count: usize) -> Self {
        Self { slots: vec![(0, FREE); 2 * count], count: 0 }
    }

    /// The entry with this hash for which `same` holds.
    pub fn find(&self, hash: u64, mut same: impl FnMut(u32) -> bool) -> Option<u32> {
        let half = hash as u32;
        let mask = self.slots.len().wrapping_sub(1);
        let mut at = half as usize & mask;
        while let Some(&(other, entry)) = self.slots.get(at)
            && entry != FREE
        {
            if other == half && same(entry) {
                return Some(entry);
            }
            at = (at + 1) & mask;
        }
        None
    }

    /// The entry with this hash for which `same` holds; where there is none, `new` becomes that entry.
    pub fn find_or_add(&mut self, hash: u64, new: u32, mut same: impl FnMut(u32) -> bool) -> Option<u32> {
        // A quarter stays free, so that few slots are looked at.
        if 4 * (self.count + 1) > 3 * self.slots.len() {
            self.grow();
        }
        let half = hash as u32;
        let mask = self.slots.len().wrapping_sub(1);
        let mut at = half as usize & mask;
        while let Some(slot) = self.slots.get_mut(at) {
            if slot.1 == FREE {
                *slot = (half, new);
                self.count += 1;
                return None;
            }
            if slot.0 == half && same(slot.1) {
                return Some(slot.1);
            }
            at = (at + 1) & mask;
        }
        None
    }

    fn grow(&mut self) {
        let slots = vec![(0, FREE); (2 * self.slots.len()).max(16)];
        for (half, entry) in std::mem::replace(&mut self.slots, slots) {
            if entry != FREE {
                self.put(half, entry);
            }
        }
    }

    /// Forgets all entries, and keeps the room.
    pub fn clear(&mut self) {
        self.slots.fill((0, FREE));
        self.count = 0;
    }

    fn put(&mut self, half: u32, entry: u32) {
        let mask = self.slots.len().wrapping_sub(1);
        let mut at = half as usize & mask;
        while let Some(slot) = self.slots.get_mut(at) {
            if slot.1 == FREE {
                *slot = (half, entry);
                return;
            }
            at = (at + 1) & mask;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_entry_is_found_and_nothing_else_even_where_hashes_are_the_same() {
        let mut index = Index::default();
        for spread in [0u64, 1, 16, 0x9e37_79b9_7f4a_7c15] {
            let hash = |i: u32| u64::from(i).wrapping_mul(spread);
            for i in 0..500 {
                assert_eq!(index.find(hash(i), |e| e == i), None);
                assert_eq!(index.find_or_add(hash(i), i, |e| e == i), None);
            }
            for i in 0..500 {
                assert_eq!(index.find_or_add(hash(i), 1000, |e| e == i), Some(i));
                assert_eq!(index.find(hash(i), |e| e == i), Some(i));
            }
            assert_eq!(index.find_or_add(hash(7), 2000, |_| false), None);
            assert_eq!(index.find_or_add(hash(7), 3000, |e| e == 2000), Some(2000));
            index.clear();
        }
    }
}
