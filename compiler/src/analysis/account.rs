//! One account for all searches of a compilation, in steps of formulas, so that a first answer comes soon whatever the scene, and is the same on
//! every machine. A search that finds it empty gives its safe answer at once: a larger factor, a measured one, or that a formula jumps.

/// What a compilation may spend: one is about the time in which one step of a formula gets its range.
const ALL: u64 = 8_000_000;
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
/// How many steps of a formula one constant may cost while a scene is compiled.
const STEPS: usize = 20_000;
/// How many steps all searches of a scene may cost while it is compiled; then formulas are looked at as a whole.
const MOST_SEARCHED: u64 = 1_500_000;
/// How many steps of formulas may be looked at more closely for their outlines.
const OUTLINING: usize = 400_000;
/// So many steps may one look run at a formula and all that it calls…
const MOST_IN_ONE: u64 = 2_000_000;
/// …and so many where one took more.
const MOST_IN_NEXT: u64 = 20_000;

/// What searches have cost, and what they may still cost.
#[derive(Clone, Debug)]
pub struct Account {
    /// How many steps of a formula one constant may cost.
    pub steps: usize,
    /// Boxes evaluated so far.
    pub boxes: u64,
    /// Steps of formulas run so far, with their derivatives or without.
    pub ran: u64,
    /// How many steps all of the compilation may still cost, whoever asks for them.
    pub(super) left: u64,
    /// Whether a search ended because of that.
    pub(super) cut_short: bool,
    /// How many steps searches for constants have cost so far.
    pub(super) searched: u64,
    /// And those that are made aside: see [`Account::turn_aside`].
    searched_aside: u64,
    /// How many they may cost, and those aside as many.
    pub(super) most_searched: u64,
    /// How many steps of formulas a closer look at regions has cost so far.
    pub(super) closer: u64,
    /// How many steps of formulas closer looks at outlines may still cost.
    pub(super) outlining: usize,
    /// How many steps looks at kinks side by side have cost so far.
    pub(super) forked: u64,
    /// How many steps one look may run: what calls itself twice, thirty times within each other, has no end.
    most_in_one: u64,
}

impl Default for Account {
    fn default() -> Self {
        Self {
            steps: STEPS,
            boxes: 0,
            ran: 0,
            left: ALL,
            cut_short: false,
            searched: 0,
            searched_aside: 0,
            most_searched: MOST_SEARCHED,
            closer: 0,
            outlining: OUTLINING,
            forked: 0,
            most_in_one: MOST_IN_ONE,
        }
    }
}

impl Account {
    /// An account for one search alone, whose constant may cost so many steps.
    pub fn of_one_search(steps: usize) -> Self {
        Self { steps, most_searched: u64::MAX, left: u64::MAX, ..Self::default() }
    }

    /// Puts into the account what a graph of so many nodes needs.
    pub fn open(&mut self, nodes: usize) {
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

    /// Counts a run of so many steps, and takes from the account what it costs: with their slopes or without, and more where the steps are `new`.
    pub(super) fn run(&mut self, steps: usize, (slopes, new): (bool, bool)) {
        let each = if slopes { SLOPES } else { 1 } + if new { SEEN } else { 0 };
        self.ran += steps as u64;
        self.spend(each * steps as u64);
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

    /// How many boxes a search may still have: one, where a scene has cost too much already.
    pub(super) fn affordable(&self, budget: usize) -> usize {
        if self.searched > self.most_searched || self.is_spent() { budget.min(1) } else { budget }
    }

    /// From here on searches are counted with those made aside, until this is asked again.
    pub fn turn_aside(&mut self) {
        std::mem::swap(&mut self.searched, &mut self.searched_aside);
    }

    /// Whether searches have cost less than half of what they may.
    pub fn has_leisure(&self) -> bool {
        self.searched < self.most_searched / 2 && !self.is_spent()
    }

    /// Whether a look that began when so many steps had been run may still go on. After one that took too long later ones end sooner.
    pub(super) fn goes_on(&mut self, began: u64) -> bool {
        let goes_on = self.ran - began <= self.most_in_one;
        if !goes_on {
            self.most_in_one = MOST_IN_NEXT;
        }
        goes_on
    }
}
