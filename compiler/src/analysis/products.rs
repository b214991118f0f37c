//! Sums of products of what is known by a number, as nodes of a graph and steps of a tape are: written in one order, so that what comes to the same
//! looks the same.

use smallvec::SmallVec;

/// Factors, in their order; of a constant none.
pub(crate) type Product<Id> = SmallVec<[Id; 4]>;

/// Multiples of products.
pub(crate) type Sum<Id> = Vec<(Product<Id>, f64)>;

/// A sum so many times.
pub(crate) fn scaled<Id: Copy>(sum: &[(Product<Id>, f64)], by: f64) -> Sum<Id> {
    sum.iter().map(|(product, times)| (product.clone(), times * by)).collect()
}

/// Two sums multiplied out.
pub(crate) fn multiplied<Id: Copy + Ord>(a: &[(Product<Id>, f64)], b: &[(Product<Id>, f64)]) -> Sum<Id> {
    let times = |x: &(Product<Id>, f64), y: &(Product<Id>, f64)| {
        let mut product: Product<Id> = x.0.iter().chain(&y.0).copied().collect();
        product.sort_unstable();
        (product, x.1 * y.1)
    };
    a.iter().flat_map(|x| b.iter().map(move |y| times(x, y))).collect()
}

/// Each product once, in their order. What is left of multiples that cancel is nothing if it is no more than this part of the largest of them.
pub(crate) fn collected<Id: Copy + Ord>(mut sum: Sum<Id>, nothing: f64) -> Sum<Id> {
    sum.sort_by(|a, b| a.0.cmp(&b.0));
    let mut found: Vec<(Product<Id>, f64, f64)> = Vec::with_capacity(sum.len());
    for (product, times) in sum {
        match found.last_mut() {
            Some((known, all, most)) if *known == product => {
                *all += times;
                *most = most.max(times.abs());
            }
            _ => found.push((product, times, times.abs())),
        }
    }
    found.retain(|(_, all, most)| all.abs() > nothing * most);
    found.into_iter().map(|(product, all, _)| (product, all)).collect()
}
