//! Rays through the pixels of a picture.

use super::vector::{Vec3, add, cross, scale, sub, unit};
use crate::compiled::Camera;

/// A camera's own axes. The picture is seen along `forward`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Basis {
    /// To the right of the picture; length one.
    pub right: Vec3,
    /// To the top of the picture; length one.
    pub up: Vec3,
    /// Into the picture; length one.
    pub forward: Vec3,
    /// Half of the picture's height at distance one.
    pub tan_half_fov: f64,
}

impl Basis {
    /// The axes of a camera that stands upright: y is up. One that looks straight up or down has x to its right; one without a
    /// target looks along -z.
    pub fn of(camera: &Camera) -> Self {
        let forward = unit(sub(camera.target, camera.eye)).unwrap_or([0.0, 0.0, -1.0]);
        let side = cross(forward, [0.0, 1.0, 0.0]);
        // Nearly vertical views would turn with the last digits of the target.
        let right =
            unit(side).filter(|_| super::vector::length(side) > 1e-6).unwrap_or([1.0, 0.0, 0.0]);
        let up = cross(right, forward);
        // An angle of half a turn or more has no picture plane.
        let half = (camera.fov / 2.0).clamp(1e-4, 1.55);
        Self { right, up, forward, tan_half_fov: half.tan() }
    }

    /// The direction through a point of a picture, in pixels from its upper left corner; length one.
    pub fn direction(&self, at: (f64, f64), size: (u32, u32)) -> Vec3 {
        let (width, height) = (f64::from(size.0), f64::from(size.1));
        let across = (at.0 / width * 2.0 - 1.0) * self.tan_half_fov * width / height;
        let down = (at.1 / height * 2.0 - 1.0) * self.tan_half_fov;
        let plane = sub(scale(self.right, across), scale(self.up, down));
        unit(add(self.forward, plane)).unwrap_or(self.forward)
    }

    /// Width of a pixel at distance one, of a picture of this height in pixels.
    pub fn footprint(&self, height: u32) -> f64 {
        2.0 * self.tan_half_fov / f64::from(height.max(1))
    }
}
