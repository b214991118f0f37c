//! Sums of products in which no number is multiplied by itself, as noise between the corners of a cell is when it is multiplied out:
//! a + (b - a)u + (c - a)v + (a - b - c + d)uv.
//!
//! Such a sum is linear in each of its numbers, so over a box it is least and greatest at corners: those of a few numbers by which all products are
//! covered, at each of which it is linear in all the others at once (multi-affine forms; Rockafellar 1970, *Convex Analysis*, § 32 for the corners).

use crate::analysis::dual::{self, Dual};
use crate::analysis::products::{self, Sum, collected, multiplied, scaled};
use crate::analysis::tape::{Step, Tape};
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use smallvec::{SmallVec, smallvec};

/// Longer sums are not looked at, nor those of which so many numbers must be put to their ends.
const MOST_TERMS: usize = 32;
const MOST_COVERING: usize = 4;
/// What rounding may lead beyond, against the size of what is added up.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// A product of steps.
type Product = products::Product<usize>;
/// Multiples of products.
#[derive(Clone, Debug)]
pub(in crate::analysis) struct Multilinear {
    terms: Sum<usize>,
    /// The steps that are put to their ends.
    covering: SmallVec<[usize; MOST_COVERING]>,
}

impl Multilinear {
    /// Those of a tape's steps, in order, of which this says more than step by step is known; what `is_known` says more of by itself is a number.
    pub(in crate::analysis) fn of(tape: &Tape, is_known: impl Fn(usize) -> bool) -> Vec<(usize, Multilinear)> {
        let mut written: Vec<Sum<usize>> = Vec::with_capacity(tape.steps.len());
        let mut found: Vec<(usize, Multilinear)> = Vec::new();
        for (i, step) in tape.steps.iter().enumerate() {
            let sum = match step {
                Step::Constant(c) => Some(vec![(Product::new(), *c)]),
                // One less a number is the same number.
                Step::Op(op, args) if !is_known(i) || args.iter().filter(|&&arg| tape.constant(arg).is_none()).count() == 1 => expanded(*op, args, &written),
                _ => None,
            };
            if let Some(form) = sum.as_ref().and_then(|sum| Self::new(sum)) {
                found.push((i, form));
            }
            written.push(sum.unwrap_or_else(|| vec![(smallvec![i], 1.0)]));
        }
        // A part of a longer one is not asked for.
        let mut used = vec![true; tape.steps.len()];
        for &(i, _) in &found {
            if let Some(slot) = used.get_mut(i) {
                *slot = tape.roots().any(|root| root == i);
            }
        }
        for (i, step) in tape.steps.iter().enumerate() {
            let (Step::Op(_, args) | Step::Call(_, args) | Step::Claim(_, args)) = step else { continue };
            if found.iter().any(|(other, _)| *other == i) {
                continue;
            }
            for &arg in args {
                if let Some(slot) = used.get_mut(arg) {
                    *slot = true;
                }
            }
        }
        found.retain(|(i, _)| used.get(*i).copied().unwrap_or(true));
        found
    }

    /// A sum in which a number stands in more than one product; none of any other.
    fn new(terms: &[(Product, f64)]) -> Option<Self> {
        let products = || terms.iter().filter(|(product, _)| product.len() > 1);
        let again = |step: &usize| terms.iter().filter(|(product, _)| product.contains(step)).count() > 1;
        if !products().any(|(product, _)| product.iter().any(again)) {
            return None;
        }
        let mut covering = SmallVec::new();
        loop {
            let open: Vec<&Product> = products().map(|(p, _)| p).filter(|p| p.iter().filter(|step| !covering.contains(*step)).count() > 1).collect();
            let count = |step: usize| open.iter().filter(|product| product.contains(&step)).count();
            let Some(&next) = open.iter().flat_map(|p| p.iter()).filter(|step| !covering.contains(*step)).max_by_key(|&&step| (count(step), step)) else {
                return Some(Self { terms: terms.to_vec(), covering });
            };
            if covering.len() == MOST_COVERING {
                return None;
            }
            covering.push(next);
        }
    }

    /// Its values, of those of the steps.
    pub(in crate::analysis) fn values(&self, value: impl Fn(usize) -> Interval) -> Interval {
        self.over(&value, None)
    }

    /// All values of the sum, or of how fast it changes with one of its steps.
    fn over(&self, value: &impl Fn(usize) -> Interval, by: Option<usize>) -> Interval {
        let ends: SmallVec<[Interval; MOST_COVERING]> = self.covering.iter().map(|&step| value(step)).collect();
        if !ends.iter().all(|end| end.is_finite()) {
            return Interval::ALL;
        }
        let mut hull = Interval::EMPTY;
        for corner in 0..1usize << ends.len() {
            let end = |step: usize| {
                let at = self.covering.iter().position(|&covering| covering == step)?;
                ends.get(at).map(|end| if corner >> at & 1 == 1 { end.hi } else { end.lo })
            };
            let (mut linear, mut constant, mut size) = (SmallVec::<[(usize, f64); 8]>::new(), 0.0, 0.0f64);
            for (product, times) in &self.terms {
                if by.is_some_and(|by| !product.contains(&by)) {
                    continue;
                }
                let (mut times, mut left) = (*times, None);
                for &step in product.iter().filter(|&&step| Some(step) != by) {
                    match end(step) {
                        Some(end) => times *= end,
                        None => left = Some(step),
                    }
                }
                size += times.abs();
                match left {
                    None => constant += times,
                    Some(step) => match linear.iter_mut().find(|(known, _)| *known == step) {
                        Some((_, sum)) => *sum += times,
                        None => linear.push((step, times)),
                    },
                }
            }
            let mut at = Interval::point(constant).grow(ROUNDING * size);
            for (step, times) in linear {
                let of = value(step);
                at = at.add(Interval::point(times).grow(ROUNDING * size).mul(of));
            }
            hull = hull.hull(at);
        }
        hull
    }

    /// A step with what more is known of it.
    pub(in crate::analysis) fn bound(&self, dual: Dual, of: impl Fn(usize) -> Dual) -> Dual {
        let value = |step: usize| of(step).value;
        let both = dual.value.intersect(self.values(value));
        let dual = if both.is_empty() { dual } else { Dual { value: both, ..dual } };
        let mut steps: Vec<usize> = self.terms.iter().flat_map(|(product, _)| product.iter().copied()).collect();
        steps.sort_unstable();
        steps.dedup();
        let (mut gradient, mut norm) = ([Interval::ZERO; 3], 0.0);
        for step in steps {
            let moves = of(step);
            if moves.norm == 0.0 {
                continue;
            }
            let speed = self.over(&value, Some(step));
            if !speed.is_finite() || !moves.norm.is_finite() {
                return dual;
            }
            gradient = dual::add(gradient, moves.scaled(speed));
            norm += speed.magnitude() * moves.norm;
        }
        dual.within(gradient, (norm * (1.0 + ROUNDING)).min(Dual::components_norm(&gradient)))
    }
}

/// An operation on sums of products as such a sum. None of anything else, and where a number would be multiplied by itself.
fn expanded(op: Op, args: &[usize], written: &[Sum<usize>]) -> Option<Sum<usize>> {
    let a = written.get(*args.first()?)?;
    let b = args.get(1).and_then(|&b| written.get(b));
    let sum = match (op, b) {
        (Op::Neg, _) => scaled(a, -1.0),
        (Op::Add | Op::Sub, Some(b)) => {
            let mut sum = a.clone();
            sum.extend(scaled(b, if op == Op::Sub { -1.0 } else { 1.0 }));
            sum
        }
        (Op::Mul, Some(b)) if a.len() * b.len() <= MOST_TERMS => {
            let shares = |x: &Product| b.iter().any(|(y, _)| x.iter().any(|step| y.contains(step)));
            if a.iter().any(|(x, _)| shares(x)) {
                return None;
            }
            multiplied(a, b)
        }
        _ => return None,
    };
    let sum = collected(sum, 0.0);
    (sum.len() <= MOST_TERMS).then_some(sum)
}

#[cfg(test)]
mod tests {
    use crate::analysis::rules::tried::factors;
    use crate::rules::Rule;

    #[test]
    fn sums_of_products_take_their_ends_at_corners_and_squares_do_not() {
        let noise = |mixed: &str| format!("fn n(v: vec2) = {{ let i = floor(v); let f = fract(v); let u = f * f * (3 - 2 * f); let a = hash(i); let b = hash(i + (1, 0)); let c = hash(i + (0, 1)); let d = hash(i + (1, 1)); {mixed} }}\nfield land = p.y - n(p.xz)\nscene = land.within(box(6))");
        let [with, without] = factors(Rule::Multilinear, &noise("a + (b - a) * u.x + (c - a) * u.y + (a - b - c + d) * u.x * u.y"));
        assert!(with < 0.8 * without, "{with} {without}");
        let [with, without] = factors(Rule::Multilinear, &noise("a * a + b * b"));
        assert_eq!(with, without);
    }
}
