//! One triangle: the point of it that is closest to another, and the angle under which it is seen.

use crate::vector::{Vec3, add, along, cross, dot, length, scale, sub};

/// A triangle with less area than this share of its longest side's square is taken for its sides alone.
const FLAT: f64 = 1e-12;

/// The part of a triangle on which a point lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Within it.
    Face,
    /// On the side from the corner of this number to the next.
    Edge(u8),
    /// The corner of this number.
    Corner(u8),
}

/// Three corners and the direction that they face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// The corners, seen from the outside against the clock.
    pub corners: [Vec3; 3],
    /// Of length one; zero where the triangle has no area.
    pub normal: Vec3,
}

impl Triangle {
    /// The triangle of three corners.
    pub fn new(corners: [Vec3; 3]) -> Self {
        let [a, b, c] = corners;
        let sides = [sub(b, a), sub(c, b), sub(a, c)];
        let [ab, bc, ca] = sides.map(|side| dot(side, side));
        // Of the two shorter sides: of a needle it is what loses the fewest digits.
        let [first, second, longest] = match (ab >= bc, bc >= ca, ca >= ab) {
            (true, _, false) => [sides[1], sides[2], sides[0]],
            (false, true, _) => [sides[2], sides[0], sides[1]],
            _ => [sides[0], sides[1], sides[2]],
        };
        let doubled = cross(first, second);
        let area = length(doubled);
        let normal = if area > FLAT * dot(longest, longest) { scale(doubled, 1.0 / area) } else { [0.0; 3] };
        Self { corners, normal }
    }

    /// Whether it has no area.
    pub fn is_flat(&self) -> bool {
        self.normal == [0.0; 3]
    }

    /// Normal times area.
    pub fn area(&self) -> Vec3 {
        let [a, b, c] = self.corners;
        scale(cross(sub(b, a), sub(c, a)), 0.5)
    }

    /// The mean of its corners.
    pub fn middle(&self) -> Vec3 {
        let [a, b, c] = self.corners;
        scale(add(add(a, b), c), 1.0 / 3.0)
    }

    /// Squared distance, place and part of its point that is closest to `p`; none where that is not below `limit`, a squared distance.
    ///
    /// The seven regions are those of Ericson, "Real-Time Collision Detection", 2005, 5.1.5. They are told apart by heights over the sides
    /// within the plane, and not by barycentric coordinates, which lose all digits in needles. A point beyond some sides is closest to one of those.
    #[inline]
    pub fn closer(&self, p: Vec3, limit: f64) -> Option<(f64, Vec3, Part)> {
        let [a, b, c] = self.corners;
        let height = dot(sub(p, a), self.normal);
        // It is no closer than its plane.
        if height * height >= limit {
            return None;
        }
        let flat = self.is_flat();
        let mut within = !flat;
        let mut found = None;
        let mut best = limit;
        for (k, from, to) in [(0, a, b), (1, b, c), (2, c, a)] {
            let (side, q) = (sub(to, from), sub(p, from));
            if !flat && dot(cross(side, q), self.normal) >= 0.0 {
                continue;
            }
            within = false;
            let (way, whole) = (dot(side, q), dot(side, side));
            let (point, part) = if way <= 0.0 || whole == 0.0 {
                (from, Part::Corner(k))
            } else if way >= whole {
                (to, Part::Corner((k + 1) % 3))
            } else {
                (along(from, side, way / whole), Part::Edge(k))
            };
            let away = sub(p, point);
            let squared = dot(away, away);
            if squared < best {
                best = squared;
                found = Some((squared, point, part));
            }
        }
        if within { Some((height * height, along(p, self.normal, -height), Part::Face)) } else { found }
    }

    /// The solid angle under which it is seen from `p`, above zero from behind (van Oosterom and Strackee, "The Solid Angle of a Plane Triangle", 1983).
    pub fn solid_angle(&self, p: Vec3) -> f64 {
        let [a, b, c] = self.corners.map(|corner| sub(corner, p));
        let [la, lb, lc] = [a, b, c].map(length);
        let volume = dot(a, cross(b, c));
        let spread = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
        2.0 * volume.atan2(spread)
    }
}
