//! What of a box lies on one side of a plane: its volume, and the integral of the place over it.

use crate::vector::{Vec3, add, cross, dot, mix, scale, sub};

/// A volume, and the integral of the place over it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Part {
    pub volume: f64,
    pub moment: Vec3,
}

impl Part {
    fn tetrahedron([a, b, c, d]: [Vec3; 4]) -> Self {
        let volume = dot(sub(b, a), cross(sub(c, a), sub(d, a))).abs() / 6.0;
        Self { volume, moment: scale(add(add(a, b), add(c, d)), 0.25 * volume) }
    }

    pub(super) fn plus(self, other: Self) -> Self {
        Self { volume: self.volume + other.volume, moment: add(self.moment, other.moment) }
    }

    fn minus(self, other: Self) -> Self {
        Self { volume: self.volume - other.volume, moment: sub(self.moment, other.moment) }
    }
}

/// What of a box about the origin, by half its sides, lies where `value + slope · p` is below zero.
pub(super) fn below(half: Vec3, value: f64, slope: Vec3) -> Part {
    let reach = half[0] * slope[0].abs() + half[1] * slope[1].abs() + half[2] * slope[2].abs();
    let whole = Part { volume: 8.0 * half[0] * half[1] * half[2], moment: [0.0; 3] };
    if value >= reach {
        return Part::default();
    }
    if value <= -reach {
        return whole;
    }
    let corner = |x: f64, y: f64, z: f64| {
        let p = [x * half[0], y * half[1], z * half[2]];
        (p, value + dot(slope, p))
    };
    let (first, last) = (corner(-1.0, -1.0, -1.0), corner(1.0, 1.0, 1.0));
    // Six tetrahedra about a diagonal, each by the two corners on a way from one of its ends to the other (Kuhn 1960).
    let [x, y, z] = [corner(1.0, -1.0, -1.0), corner(-1.0, 1.0, -1.0), corner(-1.0, -1.0, 1.0)];
    let [yz, xz, xy] = [corner(-1.0, 1.0, 1.0), corner(1.0, -1.0, 1.0), corner(1.0, 1.0, -1.0)];
    let ways = [(x, xy), (x, xz), (y, xy), (y, yz), (z, xz), (z, yz)];
    ways.into_iter().map(|(second, third)| clipped([first, second, third, last])).fold(Part::default(), Part::plus)
}

/// What of a tetrahedron lies where a linear function is below zero, by its corners and the values there.
fn clipped(mut corners: [(Vec3, f64); 4]) -> Part {
    corners.sort_unstable_by(|a, b| a.1.total_cmp(&b.1));
    let [a, b, c, d] = corners;
    // Where the function is zero between a corner below and another.
    let zero = |from: (Vec3, f64), to: (Vec3, f64)| mix(from.0, to.0, from.1 / (from.1 - to.1));
    match corners.iter().filter(|corner| corner.1 < 0.0).count() {
        0 => Part::default(),
        1 => Part::tetrahedron([a.0, zero(a, b), zero(a, c), zero(a, d)]),
        2 => {
            // A prism between two triangles, in three tetrahedra.
            let ([p, q, r], [s, t, u]) = ([a.0, zero(a, c), zero(a, d)], [b.0, zero(b, c), zero(b, d)]);
            [[p, q, r, u], [p, q, u, t], [p, t, u, s]].map(Part::tetrahedron).into_iter().fold(Part::default(), Part::plus)
        }
        3 => Part::tetrahedron([a.0, b.0, c.0, d.0]).minus(Part::tetrahedron([zero(a, d), zero(b, d), zero(c, d), d.0])),
        _ => Part::tetrahedron([a.0, b.0, c.0, d.0]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(part: Part, volume: f64, moment: Vec3) {
        let off = sub(part.moment, moment);
        assert!((part.volume - volume).abs() < 1e-12 && dot(off, off).sqrt() < 1e-12, "{part:?}, not {volume} {moment:?}");
    }

    #[test]
    fn a_box_is_clipped() {
        let half = [1.0, 2.0, 0.5];
        close(below(half, -9.0, [1.0, 1.0, 1.0]), 8.0, [0.0; 3]);
        close(below(half, 9.0, [1.0, 1.0, 1.0]), 0.0, [0.0; 3]);
        close(below(half, -1.0, [0.0; 3]), 8.0, [0.0; 3]);
        // Through the middle, whatever the way.
        for slope in [[1.0, 0.0, 0.0], [0.3, -0.7, 0.2], [0.0, 1e-9, 1.0]] {
            assert!((below(half, 0.0, slope).volume - 4.0).abs() < 1e-12);
        }
        // x < -0.5
        close(below(half, 0.5, [1.0, 0.0, 0.0]), 2.0, [-1.5, 0.0, 0.0]);
        // A corner: the tetrahedron of 0.5 along each axis.
        let corner = 0.125 / 6.0;
        close(below([1.0; 3], 2.5, [1.0; 3]), corner, [-0.875 * corner; 3]);
        close(below([1.0; 3], -2.5, [-1.0; 3].map(|c: f64| -c)), 8.0 - corner, [-0.875 * corner; 3]);
    }

    #[test]
    fn both_sides_are_the_box() {
        let (half, slope) = ([0.4, 0.3, 0.7], [0.2, -0.9, 0.5]);
        for value in [-0.5, -0.3, -0.1, 0.0, 0.17, 0.4] {
            let both = below(half, value, slope).plus(below(half, -value, slope.map(|c| -c)));
            close(both, 8.0 * 0.4 * 0.3 * 0.7, [0.0; 3]);
        }
    }
}
