//! Lights that have a size. A light of softness k is a disc that is seen under the half-angle atan(1/k), square to the way to it; how much of it arrives
//! is the share of its points that are seen.

use crate::vector::{Vec3, add, cross, scale, unit};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// Where on a disc of radius one the sample of a number looks. The first looks at the middle; any number of them cover the disc evenly: the points of
/// Roberts ("The Unreasonable Effectiveness of Quasirandom Sequences", 2018) in a square, laid on the disc as Shirley and Chiu do ("A Low Distortion Map
/// Between Disk and Square", 1997).
pub fn on_disc(index: u32) -> [f64; 2] {
    let [x, y] = super::sample_offset(index).map(|c| 2.0 * c);
    let (radius, angle) = match (x, y) {
        (0.0, 0.0) => return [0.0; 2],
        _ if x.abs() > y.abs() => (x, FRAC_PI_4 * y / x),
        _ => (y, FRAC_PI_2 - FRAC_PI_4 * x / y),
    };
    [radius * angle.cos(), radius * angle.sin()]
}

/// What a picture of a film looks at of a light's disc: alone all of it, one of many a smaller disc within it, and the later ones points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// Its middle, on a disc of radius one.
    pub place: [f64; 2],
    /// How many times as sharp it is; 0 for a point.
    pub narrower: f64,
}

/// From this picture on, each looks at a point.
const POINTS: u32 = 48;

impl Part {
    /// All of the disc.
    pub const WHOLE: Self = Self { place: [0.0; 2], narrower: 1.0 };

    /// Of the picture with a number. Each is as large a part of the disc as all so far have of it on average, so that few already are smooth.
    pub fn of(sample: u32) -> Self {
        match sample {
            0 => Self::WHOLE,
            POINTS.. => Self { place: on_disc(sample), narrower: 0.0 },
            _ => {
                let narrower = f64::from(sample + 1).sqrt();
                Self { place: on_disc(sample).map(|c| c * (1.0 - 1.0 / narrower)), narrower }
            }
        }
    }
}

/// The direction to a point of a light's disc. `toward`: to its middle, of length one; `tangent`: the tangent of the half-angle under which the disc is
/// seen; `at`: the point, of a disc of radius one.
pub fn toward(toward: Vec3, tangent: f64, at: [f64; 2]) -> Vec3 {
    let [across, above] = square_to(toward);
    let aside = add(scale(across, at[0]), scale(above, at[1]));
    unit(add(toward, scale(aside, tangent))).unwrap_or(toward)
}

/// Two directions square to one and to each other, all of length one: Duff et al., "Building an Orthonormal Basis, Revisited" (2017).
fn square_to(direction: Vec3) -> [Vec3; 2] {
    let [x, y, z] = direction;
    let side = if z >= 0.0 { 1.0 } else { -1.0 };
    let a = x / (side + z);
    let across = [1.0 - side * x * a, -side * y * a, -side * x];
    [across, cross(direction, across)]
}
