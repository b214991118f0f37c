//! What is asked for, and a number that is known with an error.

use crate::graph::interval::Interval;
use crate::vector::Vec3;

/// The tolerance where none is said, as a part of the longest side.
pub(super) const FINE: f64 = 5e-6;

/// What to measure, and how well.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Settings {
    /// Lengths shall be known to this, the volume to this times the area; without one five millionths of the longest side.
    pub tolerance: Option<f64>,
    /// Least and greatest corner of a box at which the solid is cut off.
    pub within: Option<[Vec3; 2]>,
    /// The ends of a line along which the solid is met.
    pub line: Option<[Vec3; 2]>,
    /// Whether the thinnest wall and the narrowest gap are looked for.
    pub walls: bool,
}

/// A number and its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Known {
    /// The number.
    pub value: f64,
    /// It is no farther from the true one than this; where it is estimated, most probably.
    pub error: f64,
    /// What is proven of it: the number lies in here. Everything where nothing is.
    pub proven: Interval,
    /// Whether the error is what is proven; else it is estimated.
    pub is_proven: bool,
}

/// A solid that hangs together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Its volume, without its cavities.
    pub volume: Known,
    /// The area of its surface, with that of its cavities.
    pub area: Known,
    /// Vertices less edges plus triangles of its surface, with that of its cavities: 2 for a ball, 0 for a torus, 4 for a hollow ball.
    pub euler: i64,
    /// Closed surfaces inside of it.
    pub cavities: usize,
    /// Least and greatest corner of its box in the finest mesh.
    pub bounds: [Vec3; 2],
}

impl Known {
    /// What is proven to lie between two numbers.
    pub(super) fn proven(proven: Interval) -> Self {
        let value = proven.middle();
        Self { value, error: (proven.hi - value).max(value - proven.lo), proven, is_proven: true }
    }

    /// What is estimated, and nothing proven.
    pub(super) fn estimated(value: f64, error: f64) -> Self {
        Self { value, error, proven: Interval::ALL, is_proven: false }
    }

    /// What both say: the proven one where it is good enough, or better.
    pub(super) fn or(self, estimated: Self, enough: f64) -> Self {
        if self.error <= enough.max(estimated.error) {
            return self;
        }
        Self { value: estimated.value.clamp(self.proven.lo, self.proven.hi), error: estimated.error, is_proven: false, ..self }
    }

    /// With so much more error.
    pub(super) fn rounded(self, by: f64) -> Self {
        Self { error: self.error + by, ..self }
    }
}
