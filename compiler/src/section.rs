//! A section: a plane that cuts a picture open. What lies on one side of it is taken away from what rays from the eye see.

use crate::camera::{Basis, Camera};
use crate::vector::{Vec3, add, dot, scale};

/// What a section's plane is square to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Across {
    /// The axis x.
    #[default]
    X,
    /// The axis y.
    Y,
    /// The axis z.
    Z,
    /// The direction in which the camera looks.
    View,
}

impl Across {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::X, Self::Y, Self::Z, Self::View];

    /// As it is written.
    pub fn name(self) -> &'static str {
        match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
            Self::View => "view",
        }
    }
}

/// What of a section a pipeline is built for: all but its place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Cut {
    /// What the plane is square to.
    pub across: Across,
    /// Whether what lies above the place stays, and not what lies below it.
    pub keeps_above: bool,
}

/// A plane that cuts a picture open.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Section {
    /// How it lies, and which side stays.
    pub cut: Cut,
    /// Its place: the coordinate of an axis; along the camera's direction how far it is beyond what the camera looks at.
    pub at: f64,
}

/// The plane of a section for one camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Out of what stays, into what is taken away; length one.
    pub normal: Vec3,
    /// The product with it of each point of the plane.
    pub offset: f64,
    /// Along the plane, square to the stripes of what is cut.
    pub stripes: Vec3,
}

/// What a ray hardly comes nearer to is parallel to it.
const PARALLEL: f64 = 1e-9;

impl Section {
    /// A plane at a place; the side of a camera's eye is taken away.
    pub fn facing(across: Across, at: f64, camera: &Camera) -> Self {
        let below = Self { cut: Cut { across, keeps_above: false }, at };
        if below.plane(camera).height(camera.eye) < 0.0 { below.flipped() } else { below }
    }

    /// The same through what the camera looks at.
    pub fn through(across: Across, camera: &Camera) -> Self {
        let [x, y, z] = camera.target;
        let at = match across {
            Across::X => x,
            Across::Y => y,
            Across::Z => z,
            Across::View => 0.0,
        };
        Self::facing(across, at, camera)
    }

    /// The same plane, of which the other side stays.
    pub fn flipped(self) -> Self {
        Self { cut: Cut { keeps_above: !self.cut.keeps_above, ..self.cut }, ..self }
    }

    /// Where the plane is along what it is square to, from the scene's origin.
    pub fn place(&self, camera: &Camera) -> f64 {
        match self.cut.across {
            Across::View => self.at + dot(camera.target, Basis::of(camera).forward),
            _ => self.at,
        }
    }

    /// The plane.
    pub fn plane(&self, camera: &Camera) -> Plane {
        let (along, stripes) = match self.cut.across {
            Across::X => ([1.0, 0.0, 0.0], [0.0, 1.0, 1.0]),
            Across::Y => ([0.0, 1.0, 0.0], [1.0, 0.0, 1.0]),
            Across::Z => ([0.0, 0.0, 1.0], [1.0, 1.0, 0.0]),
            Across::View => {
                let basis = Basis::of(camera);
                (basis.forward, add(basis.right, basis.up))
            }
        };
        let side = if self.cut.keeps_above { -1.0 } else { 1.0 };
        Plane { normal: scale(along, side), offset: side * self.place(camera), stripes }
    }
}

impl Plane {
    /// How far a point is on the side that is taken away; below 0 where it stays.
    pub fn height(&self, point: Vec3) -> f64 {
        dot(self.normal, point) - self.offset
    }

    /// Whether a point of the plane lies in one of the darker stripes, which have this period.
    pub fn is_striped(&self, point: Vec3, period: f64) -> bool {
        (dot(self.stripes, point) / period).rem_euclid(1.0) < 0.3
    }

    /// The part of a ray between two ways along it that stays; where nothing of it does, its end is before its beginning. The twin is
    /// `scene_span` of runtime/src/passes/section/base.wgsl.
    pub fn span(&self, origin: Vec3, direction: Vec3, [begin, end]: [f64; 2]) -> [f64; 2] {
        let (height, rise) = (self.height(origin), dot(self.normal, direction));
        let is_removed = height > 0.0;
        if rise.abs() < PARALLEL {
            return if is_removed { [1.0, -1.0] } else { [begin, end] };
        }
        let plane = -height / rise;
        match (is_removed, rise > 0.0) {
            (true, true) => [1.0, -1.0],
            (true, false) => [begin.max(plane), end],
            (false, true) => [begin, end.min(plane)],
            (false, false) => [begin, end],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_keeps_its_part_on_the_side_that_stays() {
        let below = Section { cut: Cut { across: Across::Y, keeps_above: false }, at: 1.0 }.plane(&Camera::PLAIN);
        let (up, down, aside) = ([0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]);
        assert_eq!(below.span([0.0, 3.0, 0.0], down, [0.0, 9.0]), [2.0, 9.0]);
        assert_eq!(below.span([0.0, -3.0, 0.0], up, [0.0, 9.0]), [0.0, 4.0]);
        assert_eq!(below.span([0.0, -3.0, 0.0], down, [0.0, 9.0]), [0.0, 9.0]);
        assert_eq!(below.span([0.0, 0.5, 0.0], aside, [0.0, 9.0]), [0.0, 9.0]);
        for [begin, end] in [below.span([0.0, 3.0, 0.0], up, [0.0, 9.0]), below.span([0.0, 3.0, 0.0], aside, [0.0, 9.0])] {
            assert!(begin > end);
        }
        let above = Section { cut: Cut { across: Across::Y, keeps_above: true }, at: 1.0 }.plane(&Camera::PLAIN);
        assert_eq!(above.span([0.0, 3.0, 0.0], down, [0.0, 9.0]), [0.0, 2.0]);
        assert_eq!((below.height([0.0, 3.0, 0.0]), above.height([0.0, 3.0, 0.0])), (2.0, -2.0));
    }

    #[test]
    fn along_the_view_a_place_is_seen_from_what_the_camera_looks_at() {
        let camera = Camera { eye: [0.0, 0.0, 5.0], target: [0.0, 0.0, 2.0], ..Camera::PLAIN };
        let section = Section { cut: Cut { across: Across::View, keeps_above: true }, at: 0.5 };
        let plane = section.plane(&camera);
        // What is nearer to the eye is taken away.
        assert_eq!(plane.span(camera.eye, [0.0, 0.0, -1.0], [0.0, 9.0]), [3.5, 9.0]);
        assert!(plane.height([0.0, 0.0, 1.5]).abs() < 1e-12);
    }
}
