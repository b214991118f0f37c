//! The table of rules by which bounds become tighter: one row a rule, with its name, what it does, its source, and a scene that needs it.
//!
//! A rule is optional: without it every bound is still safe, and rays need more steps. So each can be switched off (`--without-rule ID`), and
//! `docs/rules.md` says what each gains. The searches themselves, and the walk back from a value to the coordinates, are no rules.

/// When a rule is tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Cost {
    /// It is seen in the formula, once: the same for every box.
    Once,
    /// It adds some steps to each box of a search.
    Box,
    /// It is a search of its own.
    Search,
}

impl Cost {
    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Cost::Once => "once",
            Cost::Box => "each box",
            Cost::Search => "a search",
        }
    }
}

/// What a rule gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Gives {
    /// A smaller range of values.
    Range,
    /// A smaller Lipschitz constant.
    Constant,
    /// That a formula is continuous, or by how much it jumps.
    Continuity,
    /// A smaller box about the solid.
    Region,
    /// A longer step from the same constants.
    Bound,
}

impl Gives {
    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Gives::Range => "range",
            Gives::Constant => "constant",
            Gives::Continuity => "continuity",
            Gives::Region => "region",
            Gives::Bound => "bound",
        }
    }
}

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// The rule.
    pub rule: Rule,
    /// Its name on the command line.
    pub id: &'static str,
    /// What it gives.
    pub gives: Gives,
    /// When it is tried.
    pub cost: Cost,
    /// The file in `compiler/src` that holds it.
    pub file: &'static str,
    /// What it matches, and what follows.
    pub what: &'static str,
    /// Its source in the literature, or its proof.
    pub source: &'static str,
    /// A scene that it makes cheaper: rays take more steps without it, a factor grows, or a box does.
    pub scene: &'static str,
}

macro_rules! rules {
    ($($rule:ident $id:literal $gives:ident $cost:ident $file:literal
        what $what:literal source $source:literal scene $scene:literal)*) => {
        /// The name of a rule.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Rule {
            $(#[doc = $what] $rule,)*
        }

        /// The table.
        pub const RULES: &[Row] = &[
            $(Row { rule: Rule::$rule, id: $id, gives: Gives::$gives, cost: Cost::$cost, file: $file, what: $what, source: $source, scene: $scene },)*
        ];
    };
}

/// Rules that may be used: all of them by default.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct RuleSet(u64);

impl Default for RuleSet {
    fn default() -> Self {
        Self(u64::MAX)
    }
}

impl RuleSet {
    /// Whether a rule may be used.
    pub fn has(self, rule: Rule) -> bool {
        self.0 >> (rule as u32) & 1 == 1
    }

    /// The same set without a rule.
    #[must_use]
    pub fn without(self, rule: Rule) -> Self {
        Self(self.0 & !(1 << (rule as u32)))
    }
}

impl Row {
    /// The row of a rule of this name.
    pub fn named(id: &str) -> Option<&'static Row> {
        RULES.iter().find(|row| row.id == id)
    }
}

rules! {
    Claims "claims" Constant Box "analysis/rules/claims.rs"
        what "The prelude says of a formula how steep it is, and within which range it stays."
        source "Stated beside each formula; `compiler/tests/ranges.rs` and `sound.rs` hold it against samples."
        scene "scene = sphere(1).displace(0.1 * fbm(3 * p))"
}
