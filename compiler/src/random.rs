//! Numbers by chance that are the same on every run.

use crate::vector::length;

/// Numbers in 0..1, the same on every run (SplitMix64, Steele 2014).
#[derive(Clone, Debug)]
pub struct Random(pub u64);

impl Random {
    /// The next number.
    #[allow(clippy::should_implement_trait)]
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Other numbers, for another thread.
    pub(crate) fn fork(&mut self) -> Self {
        Self((self.next() * 2f64.powi(53)) as u64)
    }

    /// A point of the cube from `-half` to `half`.
    pub fn within(&mut self, half: f64) -> [f64; 3] {
        [0; 3].map(|_| (2.0 * self.next() - 1.0) * half)
    }

    /// A vector of length one, any way as likely as another.
    pub fn direction(&mut self) -> [f64; 3] {
        loop {
            let v = self.within(1.0);
            let length = length(v);
            if (0.1..1.0).contains(&length) {
                return v.map(|c| c / length);
            }
        }
    }
}
