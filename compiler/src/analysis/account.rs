//! One account for all searches of a compilation, in steps of formulas, so that a first answer comes soon whatever the scene, and is the same on
//! every machine. A search that finds it empty gives its safe answer at once: a larger factor, a measured one, or that a formula jumps.

use super::Facts;
use super::tape::Tape;

/// What a compilation may spend: one is about the time in which one step of a formula gets its range.
pub(super) const ALL: u64 = 8_000_000;
/// And so much more for each node of its graph: each is looked at, without a search.
const PER_NODE: u64 = 100;
/// No search takes more than one in so many of the steps that are left.
const SHARE: u64 = 4;
/// What a step costs with its slopes.
const SLOPES: u64 = 8;
/// What it costs a step to see what more is known of it, once.
const SEEN: u64 = 16;
/// So many additions of numbers cost as much as a step.
const ADDITIONS: u64 = 64;

impl Facts {
    /// Puts into the account what a graph of so many nodes needs.
    pub fn open_account(&mut self, nodes: usize) {
        self.left = self.left.saturating_add(PER_NODE * nodes as u64);
    }

    /// Takes so many steps from the account.
    pub(super) fn spend(&mut self, steps: u64) {
        self.left = self.left.saturating_sub(steps);
    }

    /// Takes from it what it costs to compute so many numbers.
    pub fn spend_on_numbers(&mut self, additions: u64) {
        self.spend(additions / ADDITIONS);
    }

    /// Takes from it what a run of a tape costs, with the slopes of its steps or without.
    pub(super) fn spend_on(&mut self, tape: &Tape, slopes: bool) {
        let each = if slopes { SLOPES } else { 1 } + if tape.is_seen() { 0 } else { SEEN };
        self.spend(each * tape.steps.len() as u64);
    }

    /// Whether nothing is left.
    pub fn is_spent(&self) -> bool {
        self.left == 0
    }

    /// Whether less than half is left: what is seldom of use leaves that to others.
    pub fn is_half_spent(&mut self) -> bool {
        let is_spent = self.left < ALL / 2;
        self.cut_short |= is_spent;
        is_spent
    }

    /// Whether a search was cut short, so that what was found depends on what the others cost.
    pub fn fell_short(&self) -> bool {
        self.cut_short || self.is_spent()
    }

    /// What is left when one search has taken all that it may.
    pub(super) fn left_by_one(&self) -> u64 {
        self.left - self.left / SHARE
    }

    /// How many numbers one search may compute: a power of two, so that it is the same for most edits.
    pub fn numbers(&self) -> u64 {
        let most = self.left.saturating_mul(ADDITIONS / 2);
        most.checked_ilog2().map_or(0, |log| 1 << log)
    }
}
