//! Factors: by how much a field becomes a bound, and how that is known.

use crate::source::Span;

/// A multiple by which a field becomes a bound.
#[derive(Clone, Debug, PartialEq)]
pub struct Factor {
    /// Name in the uniform struct.
    pub name: String,
    /// The Lipschitz factor: the field over this is a bound. Rounded up.
    pub lipschitz: f64,
    /// What it comes from.
    pub reason: String,
    /// Where that stands.
    pub span: Span,
    /// How it is known.
    pub proof: Proof,
}

/// A number as the text of a module would hold it.
pub fn narrow(number: f64) -> f32 {
    let limit = f64::from(f32::MAX);
    let number = number.clamp(-limit, limit) as f32;
    if number.is_normal() { number } else { 0.0 }
}

/// One over a Lipschitz factor as 32 bits hold it, rounded down, and at most a million: what hardly changes takes no endless steps.
pub fn multiple_of(lipschitz: f64) -> f32 {
    let lipschitz = lipschitz.max(1e-6);
    let nearest = (1.0 / lipschitz) as f32;
    if f64::from(nearest) * lipschitz > 1.0 { nearest.next_down() } else { nearest }
}

/// How a constant is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Proof {
    /// By the rules of the kernel's operations, everywhere at once.
    Proven,
    /// By a closed form of the prelude, which its tests hold against the certified supremum.
    Claimed,
    /// By a search over boxes in which no part of the region is left out.
    Derived,
    /// By samples alone: it may be too small.
    Measured,
}

impl Proof {
    /// All of them.
    pub const ALL: [Proof; 4] = [Proof::Proven, Proof::Claimed, Proof::Derived, Proof::Measured];

    /// Its name in tables and in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Proof::Proven => "proven",
            Proof::Claimed => "claimed",
            Proof::Derived => "derived",
            Proof::Measured => "measured",
        }
    }
}

impl Factor {
    /// One over the Lipschitz factor as 32 bits hold it, rounded down.
    pub fn multiple(&self) -> f32 {
        multiple_of(self.lipschitz)
    }
}
