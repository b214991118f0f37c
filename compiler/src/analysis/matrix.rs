//! Norms of matrices of intervals.

use crate::graph::interval::Interval;
use smallvec::SmallVec;

/// A row of a matrix, with a bound of its norm.
pub type Row = ([Interval; 3], f64);
/// Rows of a matrix: a few.
pub type Rows = SmallVec<[Row; 4]>;

/// A bound of the largest singular value of a matrix of intervals, given by rows with a bound of each row's norm.
pub fn matrix_norm(rows: &[Row]) -> f64 {
    let by_rows = match rows {
        [one] => return one.1,
        _ => rows.iter().map(|(_, n)| n * n).sum::<f64>().sqrt().next_up(),
    };
    // Rows that each act on an axis of their own, as those of a point that is moved along.
    let mut free = [true; 3];
    let apart = rows.iter().all(|(g, n)| {
        *n == 0.0 || {
            let mut touched = g.iter().zip(&mut free).filter(|(i, _)| **i != Interval::ZERO);
            touched.next().is_none_or(|(_, free)| std::mem::replace(free, false)) && touched.next().is_none()
        }
    });
    if apart {
        return rows.iter().map(|(_, n)| *n).fold(0.0, f64::max);
    }
    let used: Rows = rows.iter().filter(|(_, n)| *n > 0.0).copied().collect();
    if used.len() <= 1 {
        return used.first().map_or(0.0, |(_, n)| *n);
    }
    // Rows that share no column act on different axes: the norm is the largest of their blocks'.
    let touches = |g: &[Interval; 3]| g.map(|i| i != Interval::ZERO);
    if let Some((first, rest)) = used.split_first() {
        let mut columns = touches(&first.0);
        let mut block = Rows::from_slice(&[*first]);
        let mut others = Rows::from_slice(rest);
        loop {
            let (joined, apart): (Rows, Rows) = others
                .into_iter()
                .partition(|(g, _)| touches(g).iter().zip(&columns).any(|(a, b)| *a && *b));
            others = apart;
            if joined.is_empty() {
                break;
            }
            for (g, _) in &joined {
                for (column, touched) in columns.iter_mut().zip(touches(g)) {
                    *column |= touched;
                }
            }
            block.extend(joined);
        }
        if !others.is_empty() {
            return matrix_norm(&block).max(matrix_norm(&others));
        }
    }
    let magnitude = |r: usize, c: usize| {
        rows.get(r).and_then(|(g, _)| g.get(c)).map_or(0.0, |i| i.magnitude())
    };
    let n = rows.len();
    // The norm squared is at most the largest column sum times the largest row sum.
    let column = (0..3).map(|c| (0..n).map(|r| magnitude(r, c)).sum::<f64>()).fold(0.0, f64::max);
    let row = (0..n).map(|r| (0..3).map(|c| magnitude(r, c)).sum::<f64>()).fold(0.0, f64::max);
    let by_sums = if column == 0.0 || row == 0.0 {
        0.0
    } else if column == row {
        column
    } else {
        (column * row).sqrt().next_up()
    };
    // The norm of the middle, and the Frobenius norm of the half widths.
    let mut spread = 0.0;
    let mut gram = [[0.0; 3]; 3];
    for (g, _) in rows {
        let middle = g.map(|i| if i.is_point() { i.lo } else { i.middle() });
        for (i, interval) in g.iter().enumerate() {
            let m = middle.get(i).copied().unwrap_or(0.0);
            let half = (interval.hi - m).max(m - interval.lo);
            spread += half * half;
        }
        for (slot, a) in gram.iter_mut().zip(middle) {
            for (cell, b) in slot.iter_mut().zip(middle) {
                *cell += a * b;
            }
        }
    }
    let by_middle = if spread.is_finite() {
        largest_eigenvalue(gram).sqrt() * (1.0 + 1e-12) + spread.sqrt().next_up()
    } else {
        f64::INFINITY
    };
    let least = by_rows.min(by_sums).min(by_middle);
    // An isometry must not become a factor by rounding.
    if (least - 1.0).abs() < 1e-9 { 1.0 } else { least }
}

/// Largest eigenvalue of a symmetric 3 by 3 matrix with no negative one, by the trigonometric solution of its cubic (Smith 1961).
fn largest_eigenvalue(m: [[f64; 3]; 3]) -> f64 {
    let [[a, d, e], [_, b, f], [_, _, c]] = m;
    let off = d * d + e * e + f * f;
    let mean = (a + b + c) / 3.0;
    let spread = (a - mean).powi(2) + (b - mean).powi(2) + (c - mean).powi(2) + 2.0 * off;
    if spread <= 0.0 {
        return mean;
    }
    let p = (spread / 6.0).sqrt();
    let (a, b, c) = ((a - mean) / p, (b - mean) / p, (c - mean) / p);
    let (d, e, f) = (d / p, e / p, f / p);
    let determinant = a * (b * c - f * f) - d * (d * c - f * e) + e * (d * f - b * e);
    let angle = (determinant / 2.0).clamp(-1.0, 1.0).acos() / 3.0;
    (mean + 2.0 * p * angle.cos()) * (1.0 + 1e-12)
}
