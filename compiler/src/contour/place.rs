//! Where a vertex stands: where the tangent planes at the crossings of its loop meet best, within its cell.

use super::at;
use crate::vector::{Vec3, add, dot, scale, sub, unit};

/// Of the spread of the normals, the part below which they are taken as those of one plane, or of one line.
const FLAT: f64 = 2e-3;
/// What the square of a way counts beside those of the distances to planes: so little that it decides only between places that are as good.
const SHORT: f64 = 1e-6;
/// The cosine of the angle by which normals may lie apart on what is smooth.
const SMOOTH: f64 = 0.98;

/// A vertex.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed {
    pub point: Vec3,
    /// The mean of the normals.
    pub normal: Vec3,
    /// Whether all normals are much the same.
    pub smooth: bool,
}

/// A vertex, and what else is known of its loop.
pub(super) struct Found {
    pub placed: Placed,
    /// The mean of the crossings.
    pub middle: Vec3,
    /// Where the planes meet, if that is outside of the cell.
    pub beyond: Option<Vec3>,
}

/// The vertex of a loop: the least of the sum of squared distances to the planes through `points` with `normals`, between `low` and `high`. A normal
/// of zero is none. Without `sharp` the mean of the points.
pub(super) fn place(points: &[Vec3], normals: &[Vec3], low: Vec3, high: Vec3, sharp: bool) -> Found {
    let middle = scale(points.iter().fold([0.0; 3], |sum, p| add(sum, *p)), 1.0 / points.len().max(1) as f64);
    let sum = normals.iter().fold([0.0; 3], |sum, n| add(sum, *n));
    let normal = unit(sum).or_else(|| normals.iter().find_map(|n| unit(*n))).unwrap_or([0.0, 0.0, 1.0]);
    let smooth = normals.iter().all(|n| dot(*n, normal) > SMOOTH);
    let mut spread = [[0.0; 3]; 3];
    let mut pull = [0.0; 3];
    for (p, n) in points.iter().zip(normals) {
        for (row, c) in spread.iter_mut().zip(n) {
            *row = add(*row, scale(*n, *c));
        }
        pull = add(pull, scale(*n, dot(*n, sub(*p, middle))));
    }
    let (offset, beyond) = if sharp { within(&spread, pull, sub(low, middle), sub(high, middle)) } else { ([0.0; 3], None) };
    let point = add(middle, offset);
    let placed = Placed { point: [0, 1, 2].map(|i| at(point, i).clamp(at(low, i), at(high, i))), normal, smooth };
    Found { placed, middle, beyond: beyond.map(|by| add(middle, by)) }
}

/// The least of `x·spread·x - 2 pull·x` between two corners: within, or else the best of those on the walls, edges and corners. Of those as good, the
/// shortest. And the least of all, if it is outside.
fn within(spread: &[Vec3; 3], pull: Vec3, low: Vec3, high: Vec3) -> (Vec3, Option<Vec3>) {
    let trace: f64 = (0..3).filter_map(|i| spread.get(i)?.get(i).copied()).sum();
    let slack = 1e-9 * dot(sub(high, low), [1.0; 3]);
    let inside = |x: Vec3| (0..3).all(|i| at(x, i) >= at(low, i) - slack && at(x, i) <= at(high, i) + slack);
    let free = least(*spread, pull, FLAT * trace);
    if inside(free) {
        return (free, None);
    }
    let mut best = (f64::INFINITY, [0.0; 3]);
    // Each coordinate is free, at its lower wall, or at its upper one.
    for walls in 1..27 {
        let wall = [walls % 3, walls / 3 % 3, walls / 9];
        let is_free = wall.map(|w| if w == 0 { 1.0 } else { 0.0 });
        let mut fixed = [0.0; 3];
        for (i, (c, w)) in fixed.iter_mut().zip(wall).enumerate() {
            *c = [0.0, at(low, i), at(high, i)].get(w).copied().unwrap_or(0.0);
        }
        // What is held is moved to the other side of the equations.
        let mut rest = *spread;
        let mut right = pull;
        for (i, (row, c)) in rest.iter_mut().zip(&mut right).enumerate() {
            *c = (*c - dot(*row, fixed)) * at(is_free, i);
            *row = [0, 1, 2].map(|j| at(*row, j) * at(is_free, i) * at(is_free, j));
        }
        let x = add(least(rest, right, FLAT * trace), fixed);
        let error = dot(x, spread.map(|row| dot(row, x))) - 2.0 * dot(pull, x) + SHORT * trace * dot(x, x);
        if inside(x) && error < best.0 {
            best = (error, x);
        }
    }
    (best.1, Some(free))
}

/// The shortest solution of `matrix x = right`, along those of the matrix's axes alone along which it is more than `flat`.
fn least(matrix: [Vec3; 3], right: Vec3, flat: f64) -> Vec3 {
    let (values, axes) = axes_of(matrix);
    let along = |(value, axis): (f64, Vec3)| if value > flat && value > 0.0 { scale(axis, dot(axis, right) / value) } else { [0.0; 3] };
    values.into_iter().zip(axes).map(along).fold([0.0; 3], add)
}

/// Eigenvalues and eigenvectors of a symmetric matrix, by Jacobi's rotations (Golub and Van Loan, "Matrix Computations", § 8.5).
#[allow(clippy::indexing_slicing)] // Indices are 0, 1, 2.
fn axes_of(mut m: [Vec3; 3]) -> (Vec3, [Vec3; 3]) {
    let mut axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for _ in 0..8 {
        if m[0][1].abs() + m[0][2].abs() + m[1][2].abs() <= 1e-15 * (m[0][0] + m[1][1] + m[2][2]).abs() {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if m[p][q].abs() <= 1e-30 {
                continue;
            }
            let theta = (m[q][q] - m[p][p]) / (2.0 * m[p][q]);
            let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
            let c = 1.0 / (t * t + 1.0).sqrt();
            let s = t * c;
            for row in &mut m {
                (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
            }
            for j in 0..3 {
                (m[p][j], m[q][j]) = (c * m[p][j] - s * m[q][j], s * m[p][j] + c * m[q][j]);
                (axes[p][j], axes[q][j]) = (c * axes[p][j] - s * axes[q][j], s * axes[p][j] + c * axes[q][j]);
            }
        }
    }
    ([m[0][0], m[1][1], m[2][2]], axes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vector::length;

    #[test]
    fn three_planes_meet_in_a_corner() {
        let normals = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.6, 0.8]];
        let points = [[0.3, 0.1, 0.2], [0.5, 0.4, 0.9], [0.8, 0.4, 0.7]];
        let placed = place(&points, &normals, [0.0; 3], [1.0; 3], true).placed;
        assert!(length(sub(placed.point, [0.3, 0.4, 0.7])) < 1e-12, "{placed:?}");
        assert!(!placed.smooth);
    }

    #[test]
    fn what_meets_outside_is_held_at_the_wall() {
        let normals = [[1.0, 0.0, 0.0], [0.6, 0.8, 0.0]];
        let points = [[0.9, 0.0, 0.5], [0.1, 0.9, 0.5]];
        let placed = place(&points, &normals, [0.0; 3], [1.0; 3], true).placed;
        assert!(placed.point.iter().all(|c| (0.0..=1.0).contains(c)), "{placed:?}");
        let smooth = place(&points, &normals, [0.0; 3], [1.0; 3], false).placed;
        assert!(length(sub(smooth.point, [0.5, 0.45, 0.5])) < 1e-12);
    }

    #[test]
    fn axes_of_a_matrix_are_its_own() {
        let m = [[2.0, 0.3, -0.1], [0.3, 1.0, 0.4], [-0.1, 0.4, 0.5]];
        let (values, axes) = axes_of(m);
        for (value, axis) in values.into_iter().zip(axes) {
            let image = m.map(|row| dot(row, axis));
            assert!(length(sub(image, scale(axis, value))) < 1e-12, "{values:?} {axes:?}");
        }
    }
}
