//! A form of which more is known than its operations tell one by one: a mix of two values, and a polynomial of one value, as noise and
//! smooth steps are made of, and what rounding leaves. `t t (3 - 2 t)` lies between 0 and 1 with t, but the product of its factors' intervals does not.

// A step names only steps before it, so every index is in range.
#![allow(clippy::indexing_slicing)]

use crate::graph::interval::Interval;

/// What the value of a step also is. The arguments of [`Step::Form`](crate::certify::step::Step::Form) are that step, then those of the form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Form {
    /// `a (1 - t) + b t`.
    Mix,
    /// A polynomial of one argument: this one of the code's.
    Polynomial(u16),
    /// What is left of a value when a whole number is taken off: between these two.
    Rest(f64, f64),
}

/// Coefficients, those of the lowest power first; each holds the true one.
pub(super) type Polynomial = Vec<Interval>;

/// The highest power that is looked at.
pub(super) const DEGREE: usize = 8;
/// Binomial coefficients up to that power.
const BINOMIAL: [[f64; DEGREE + 1]; DEGREE + 1] = {
    let mut all = [[0.0; DEGREE + 1]; DEGREE + 1];
    let mut n = 0;
    while n <= DEGREE {
        all[n][0] = 1.0;
        let mut k = 1;
        while k <= n {
            all[n][k] = all[n - 1][k - 1] + all[n - 1][k];
            k += 1;
        }
        n += 1;
    }
    all
};
/// Of a degree, an index of the basis of Bernstein and a power: how much of the power's coefficient is in that of the basis, at most 1.
const SHARES: [[[f64; DEGREE + 1]; DEGREE + 1]; DEGREE + 1] = {
    let mut all = [[[0.0; DEGREE + 1]; DEGREE + 1]; DEGREE + 1];
    let mut n = 0;
    while n <= DEGREE {
        let mut i = 0;
        while i <= n {
            let mut k = 0;
            while k <= i {
                all[n][i][k] = BINOMIAL[i][k] / BINOMIAL[n][k];
                k += 1;
            }
            i += 1;
        }
        n += 1;
    }
    all
};
/// What rounding loses in [`image`], of the sum of the sizes of all terms: no term goes through as many as 64 roundings.
const LOST: f64 = 64.0 * f64::EPSILON;

impl Form {
    /// How many arguments it has.
    pub(super) fn arity(self) -> usize {
        match self {
            Self::Mix => 3,
            Self::Polynomial(_) => 1,
            Self::Rest(..) => 0,
        }
    }

    /// All values. `arguments`: those of the form.
    pub(super) fn range(self, polynomials: &[Polynomial], arguments: [Interval; 3]) -> Interval {
        let [a, b, t] = arguments;
        match self {
            Self::Mix => mixed(a, b, t),
            Self::Polynomial(i) => polynomials.get(usize::from(i)).map_or(Interval::ALL, |p| image(p, a)),
            Self::Rest(lo, hi) => Interval { lo, hi },
        }
    }

    /// All gradients that the form tells of, from the ranges and gradients of its arguments.
    pub(super) fn gradient<const D: usize>(self, polynomials: &[Polynomial], ranges: [Interval; 3], gradients: [[Interval; D]; 3]) -> [Interval; D] {
        let [a, b, t] = ranges;
        let [mut gradient, by_b, by_t] = gradients;
        match self {
            Self::Mix => {
                let apart = b.sub(a);
                for ((x, y), by_t) in gradient.iter_mut().zip(by_b).zip(by_t) {
                    *x = mixed(*x, y, t).add(apart.mul(by_t));
                }
            }
            Self::Polynomial(i) => {
                let slope = polynomials.get(usize::from(i)).map_or(Interval::ALL, |p| slope(p, a));
                gradient.iter_mut().for_each(|x| *x = x.mul(slope));
            }
            Self::Rest(..) => gradient = [Interval::ALL; D],
        }
        gradient
    }
}

/// A mix goes straight with each of its arguments, so its extremes are at the ends of `t`.
fn mixed(a: Interval, b: Interval, t: Interval) -> Interval {
    let at = |t: f64| {
        let t = Interval::point(t);
        a.mul(Interval::ONE.sub(t)).add(b.mul(t))
    };
    if t.is_empty() { t } else if t.is_finite() { at(t.lo).hull(at(t.hi)) } else { Interval::ALL }
}

/// The values of a polynomial's derivative.
fn slope(polynomial: &[Interval], over: Interval) -> Interval {
    let mut derivative = [Interval::ZERO; DEGREE];
    for (i, (into, c)) in derivative.iter_mut().zip(polynomial.iter().skip(1)).enumerate() {
        *into = c.mul(Interval::point((i + 1) as f64));
    }
    image(&derivative[..polynomial.len().saturating_sub(1)], over)
}

/// The values of a polynomial: within the least and the largest of its coefficients in the basis of Bernstein (Moore, Kearfott and Cloud, § 7.2;
/// Cargo and Shisha, "The Bernstein form of a polynomial", 1966). In plain numbers, with what rounding may have lost added at the end.
fn image(polynomial: &[Interval], over: Interval) -> Interval {
    if !over.is_finite() || over.is_empty() || polynomial.is_empty() {
        return if polynomial.is_empty() { Interval::ZERO } else { Interval::ALL };
    }
    // As a polynomial of s in 0..1 with x = lo + width s.
    let (lo, width) = (over.lo, if over.is_point() { 0.0 } else { (over.hi - over.lo).next_up() });
    let reach = lo.abs() + width;
    let mut shifted = [0.0; DEGREE + 1];
    let degree = polynomial.len() - 1;
    let (mut size, mut unknown) = (0.0, 0.0);
    for (i, c) in polynomial.iter().enumerate().rev() {
        size = size * reach + c.magnitude();
        unknown = unknown * reach + c.width();
        // Times (lo + width s), plus the next coefficient.
        for k in (0..=degree - i).rev() {
            let below = if k > 0 { shifted[k - 1] * width } else { c.middle() };
            shifted[k] = shifted[k] * lo + below;
        }
    }
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for (i, shares) in SHARES[degree].iter().enumerate().take(degree + 1) {
        let sum = shifted.iter().zip(shares).take(i + 1).fold(0.0, |sum, (coefficient, share)| sum + coefficient * share);
        (least, most) = (least.min(sum), most.max(sum));
    }
    let lost = LOST * size + 2.0 * unknown;
    if lost.is_finite() { Interval::outward(least - lost, most + lost) } else { Interval::ALL }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    /// Of a polynomial over an interval: every value is in the image, and of a step that only rises the image is hardly more than them.
    #[test]
    fn an_image_holds_the_values_and_little_else() {
        let mut random = Random(7);
        let value = |p: &[Interval], x: f64| p.iter().rev().fold(0.0, |sum, c| sum * x + c.lo);
        for i in 0..2000 {
            let scale = 10f64.powf(4.0 * random.next() - 2.0);
            let polynomial: Polynomial = (0..2 + i % 7).map(|_| Interval::point(scale * (2.0 * random.next() - 1.0))).collect();
            let lo = 4.0 * random.next() - 2.0;
            let over = Interval { lo, hi: lo + 2.0 * random.next().powi(4) };
            let image = image(&polynomial, over);
            for k in 0..=50 {
                let x = (lo + over.width() * f64::from(k) / 50.0).min(over.hi);
                assert!(image.contains(value(&polynomial, x)), "{polynomial:?} at {x} is not in {image:?}");
            }
        }
        let smooth: Polynomial = [0.0, 0.0, 3.0, -2.0].map(Interval::point).to_vec();
        for (lo, hi) in [(0.0, 1.0), (0.2, 0.4), (0.7, 0.7)] {
            let image = image(&smooth, Interval { lo, hi });
            assert!((image.lo - value(&smooth, lo)).abs() < 1e-12 && (image.hi - value(&smooth, hi)).abs() < 1e-12, "{image:?} over {lo} to {hi}");
        }
    }
}
