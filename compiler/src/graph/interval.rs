//! Intervals that hold every value that the real-valued operation can take, rounded outward.

/// A closed interval `[lo, hi]`; never NaN. Empty where `lo > hi`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub lo: f64,
    /// Upper end.
    pub hi: f64,
}

/// How far the results of the mathematics library may be from the true value, relative to one.
const LIBM: f64 = 4.0 * f64::EPSILON;

/// Whether a product of two numbers surely has no more digits than a number holds.
fn multiplies_exactly(a: f64, b: f64) -> bool {
    let digits = |x: f64| 53 - x.to_bits().trailing_zeros().min(52);
    (a * b).is_normal() && digits(a) + digits(b) <= 53
}

// Named as the operations of the kernel are; an interval is no number, so the operators stay free.
#[allow(clippy::should_implement_trait)]
impl Interval {
    /// All numbers.
    pub const ALL: Self = Self { lo: f64::NEG_INFINITY, hi: f64::INFINITY };
    /// No number.
    pub const EMPTY: Self = Self { lo: f64::INFINITY, hi: f64::NEG_INFINITY };
    /// Zero alone.
    pub const ZERO: Self = Self { lo: 0.0, hi: 0.0 };
    /// One alone.
    pub const ONE: Self = Self { lo: 1.0, hi: 1.0 };

    /// The interval between two numbers; an end that is not a number opens that side.
    #[inline]
    pub fn new(lo: f64, hi: f64) -> Self {
        Self {
            lo: if lo.is_nan() { f64::NEG_INFINITY } else { lo },
            hi: if hi.is_nan() { f64::INFINITY } else { hi },
        }
    }

    /// One number.
    #[inline]
    pub fn point(value: f64) -> Self {
        Self::new(value, value)
    }

    /// The interval between two computed numbers, each moved outward by one unit in the last place.
    #[inline]
    pub fn outward(lo: f64, hi: f64) -> Self {
        Self::new(lo.next_down(), hi.next_up())
    }

    /// The same for the results of the mathematics library.
    fn library(lo: f64, hi: f64) -> Self {
        Self::new(lo - LIBM * lo.abs().max(1e-300), hi + LIBM * hi.abs().max(1e-300))
    }

    /// Whether it holds no number.
    #[inline]
    pub fn is_empty(self) -> bool {
        self.lo > self.hi
    }

    /// Whether it is one number.
    #[inline]
    pub fn is_point(self) -> bool {
        self.lo == self.hi
    }

    /// Whether both ends are finite.
    #[inline]
    pub fn is_finite(self) -> bool {
        self.lo.is_finite() && self.hi.is_finite()
    }

    /// Whether it holds a number.
    #[inline]
    pub fn contains(self, value: f64) -> bool {
        self.lo <= value && value <= self.hi
    }

    /// Largest absolute value in it.
    #[inline]
    pub fn magnitude(self) -> f64 {
        if self.is_empty() { 0.0 } else { self.lo.abs().max(self.hi.abs()) }
    }

    /// Smallest absolute value in it.
    #[inline]
    pub fn mignitude(self) -> f64 {
        if self.contains(0.0) { 0.0 } else { self.lo.abs().min(self.hi.abs()) }
    }

    /// Length, infinite where an end is.
    #[inline]
    pub fn width(self) -> f64 {
        if self.is_empty() { 0.0 } else { self.hi - self.lo }
    }

    /// A number inside, near the middle, finite where there is one.
    pub fn middle(self) -> f64 {
        match (self.lo.is_finite(), self.hi.is_finite()) {
            (true, true) => self.lo + (self.hi - self.lo) / 2.0,
            (true, false) => (self.lo + 1.0).max(self.lo * 2.0),
            (false, true) => (self.hi - 1.0).min(self.hi * 2.0),
            (false, false) => 0.0,
        }
    }

    /// Smallest interval that holds both.
    #[inline]
    pub fn hull(self, other: Self) -> Self {
        if self.is_empty() {
            other
        } else if other.is_empty() {
            self
        } else {
            Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
        }
    }

    /// What both hold.
    #[inline]
    pub fn intersect(self, other: Self) -> Self {
        Self { lo: self.lo.max(other.lo), hi: self.hi.min(other.hi) }
    }

    /// Grown by `amount` on both sides.
    pub fn grow(self, amount: f64) -> Self {
        if self.is_empty() { self } else { Self::outward(self.lo - amount, self.hi + amount) }
    }

    /// `-x`
    #[inline]
    pub fn neg(self) -> Self {
        Self { lo: -self.hi, hi: -self.lo }
    }

    /// `a + b`
    #[inline]
    pub fn add(self, b: Self) -> Self {
        if self.is_empty() || b.is_empty() {
            return Self::EMPTY;
        }
        let (lo, hi) = (self.lo + b.lo, self.hi + b.hi);
        // A sum without rounding stays as it is: so whole numbers do, and the cells that they name.
        let exact = |x: f64, y: f64, sum: f64| sum - x == y && sum - y == x;
        Self::new(
            if exact(self.lo, b.lo, lo) { lo } else { lo.next_down() },
            if exact(self.hi, b.hi, hi) { hi } else { hi.next_up() },
        )
    }

    /// `a - b`
    #[inline]
    pub fn sub(self, b: Self) -> Self {
        self.add(b.neg())
    }

    /// `a b`, with zero times infinity as zero (an end that is infinite is never reached).
    #[inline]
    pub fn mul(self, b: Self) -> Self {
        if self.is_empty() || b.is_empty() {
            return Self::EMPTY;
        }
        if self == Self::ZERO || b == Self::ZERO {
            return Self::ZERO;
        }
        if self == Self::ONE {
            return b;
        }
        if b == Self::ONE {
            return self;
        }
        if self.is_point() && b.is_point() && multiplies_exactly(self.lo, b.lo) {
            return Self::point(if self.lo == 0.0 || b.lo == 0.0 { 0.0 } else { self.lo * b.lo });
        }
        let open = !(self.is_finite() && b.is_finite());
        let product = |x: f64, y: f64| if open && (x == 0.0 || y == 0.0) { 0.0 } else { x * y };
        let (p, q) = (product(self.lo, b.lo), product(self.lo, b.hi));
        let (r, s) = (product(self.hi, b.lo), product(self.hi, b.hi));
        let least = |x: f64, y: f64| if x < y { x } else { y };
        let most = |x: f64, y: f64| if x > y { x } else { y };
        Self::outward(least(least(p, q), least(r, s)), most(most(p, q), most(r, s)))
    }

    /// `x x`
    #[inline]
    pub fn square(self) -> Self {
        if self.is_empty() {
            return self;
        }
        let (small, large) = (self.mignitude(), self.magnitude());
        Self::new((small * small).next_down().max(0.0), (large * large).next_up())
    }

    /// `a / b`. Where `b` may be zero: all numbers (with the kernel's rule that `a / 0` is 0).
    pub fn div(self, b: Self) -> Self {
        if self.is_empty() || b.is_empty() {
            return Self::EMPTY;
        }
        if self == Self::ZERO {
            return Self::ZERO;
        }
        if b == Self::ZERO {
            return Self::ZERO;
        }
        if b.contains(0.0) {
            if b.lo < 0.0 && b.hi > 0.0 {
                return Self::ALL;
            }
            // One side only: the quotient keeps its sign; zero itself answers 0.
            let toward = if b.hi > 0.0 { b.hi } else { b.lo };
            let quotient = |x: f64| {
                if x == 0.0 || toward.is_infinite() { 0.0 } else { x / toward }
            };
            let far = |x: f64| if x == 0.0 { 0.0 } else { x * toward.signum() * f64::INFINITY };
            let ends = [quotient(self.lo), quotient(self.hi), far(self.lo), far(self.hi), 0.0];
            return Self::outward(
                ends.iter().copied().fold(f64::INFINITY, f64::min),
                ends.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            );
        }
        let quotient = |x: f64, y: f64| {
            if x == 0.0 {
                0.0
            } else if y.is_infinite() {
                // The limit is zero; a bound of either sign holds it.
                if x.is_infinite() { f64::NAN } else { 0.0 }
            } else {
                x / y
            }
        };
        let ends = [
            quotient(self.lo, b.lo),
            quotient(self.lo, b.hi),
            quotient(self.hi, b.lo),
            quotient(self.hi, b.hi),
        ];
        if ends.iter().any(|e| e.is_nan()) {
            return Self::ALL;
        }
        Self::outward(
            ends.iter().copied().fold(f64::INFINITY, f64::min),
            ends.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        )
    }

    /// Smaller of two.
    #[inline]
    pub fn min(self, b: Self) -> Self {
        if self.is_empty() || b.is_empty() {
            return Self::EMPTY;
        }
        Self { lo: self.lo.min(b.lo), hi: self.hi.min(b.hi) }
    }

    /// Larger of two.
    #[inline]
    pub fn max(self, b: Self) -> Self {
        if self.is_empty() || b.is_empty() {
            return Self::EMPTY;
        }
        Self { lo: self.lo.max(b.lo), hi: self.hi.max(b.hi) }
    }

    /// `|x|`
    #[inline]
    pub fn abs(self) -> Self {
        if self.is_empty() { self } else { Self { lo: self.mignitude(), hi: self.magnitude() } }
    }

    /// Image under a function that grows.
    pub fn monotone(self, f: impl Fn(f64) -> f64) -> Self {
        if self.is_empty() { self } else { Self::library(f(self.lo), f(self.hi)) }
    }

    /// Image under a step function that grows and is exact (floor and its kin).
    pub fn steps(self, f: impl Fn(f64) -> f64) -> Self {
        if self.is_empty() { self } else { Self::new(f(self.lo), f(self.hi)) }
    }

    /// `sqrt(max(x, 0))`
    pub fn sqrt(self) -> Self {
        if self.is_empty() {
            return self;
        }
        Self::new(
            self.lo.max(0.0).sqrt().next_down().max(0.0),
            self.hi.max(0.0).sqrt().next_up(),
        )
    }

    /// `cos x`
    pub fn cos(self) -> Self {
        if self.is_empty() {
            return self;
        }
        let tau = std::f64::consts::TAU;
        if !self.is_finite() || self.width() >= tau || self.magnitude() > 1e9 {
            return Self { lo: -1.0, hi: 1.0 };
        }
        // Reaches 1 at whole turns and -1 at half turns, looked for with a margin that holds what the division by a turn may lose.
        let margin = 1e-9 + 1e-15 * self.magnitude();
        let holds = |phase: f64| {
            let first = ((self.lo - phase) / tau - margin).ceil();
            first <= (self.hi - phase) / tau + margin
        };
        let (a, b) = (self.lo.cos(), self.hi.cos());
        let lo = if holds(std::f64::consts::PI) { -1.0 } else { (a.min(b) - LIBM).max(-1.0) };
        let hi = if holds(0.0) { 1.0 } else { (a.max(b) + LIBM).min(1.0) };
        Self { lo, hi }
    }

    /// `sin x`
    pub fn sin(self) -> Self {
        self.sub(Self::point(std::f64::consts::FRAC_PI_2)).cos()
    }
}
