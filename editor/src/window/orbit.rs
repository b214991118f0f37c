//! A camera that a person moves around a point.

use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use surefoot_compiler::compiled::Camera;

/// A camera that looks at a point from a distance. It stands upright: y is up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orbit {
    target: DVec3,
    distance: f64,
    /// Turn about y, radians; 0 looks along -z.
    yaw: f64,
    /// Height above the horizon, radians.
    pitch: f64,
    /// Vertical angle of view, radians.
    fov: f64,
}

/// Nearer to the vertical the picture would spin.
const STEEPEST: f64 = FRAC_PI_2 - 0.01;
/// Distances that 32 bits can tell apart from the target and from infinity.
const DISTANCES: (f64, f64) = (1e-3, 1e5);

impl Orbit {
    /// Takes over where a scene's camera stands.
    pub fn from_camera(camera: &Camera) -> Self {
        let (eye, target) = (DVec3::from(camera.eye), DVec3::from(camera.target));
        let away = (eye - target).try_normalize().unwrap_or(DVec3::Z);
        Self {
            target,
            distance: eye.distance(target).clamp(DISTANCES.0, DISTANCES.1),
            yaw: away.x.atan2(away.z),
            pitch: away.y.clamp(-1.0, 1.0).asin().clamp(-STEEPEST, STEEPEST),
            fov: camera.fov,
        }
    }

    /// Where it stands and looks.
    pub fn camera(&self) -> Camera {
        Camera {
            eye: (self.target + self.away() * self.distance).into(),
            target: self.target.into(),
            fov: self.fov,
        }
    }

    /// From the target to the eye; length one.
    fn away(&self) -> DVec3 {
        let (sin, cos) = self.pitch.sin_cos();
        DVec3::new(self.yaw.sin() * cos, sin, self.yaw.cos() * cos)
    }

    /// Turns, as if the scene were dragged: by parts of the picture's height, to the right and down.
    pub fn turn(&mut self, right: f64, down: f64) {
        self.yaw = (self.yaw - right * PI) % TAU;
        self.pitch = (self.pitch + down * PI).clamp(-STEEPEST, STEEPEST);
    }

    /// Moves sideways, so that what lies at the target's distance follows the pointer: by parts of the picture's height.
    pub fn pan(&mut self, right: f64, down: f64) {
        let away = self.away();
        let aside = DVec3::Y.cross(away).normalize_or(DVec3::X);
        let up = away.cross(aside);
        let height = 2.0 * self.distance * (self.fov / 2.0).tan();
        self.target += (up * down - aside * right) * height;
    }

    /// Goes nearer (a factor below one) or farther.
    pub fn dolly(&mut self, factor: f64) {
        self.distance = (self.distance * factor).clamp(DISTANCES.0, DISTANCES.1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: [f64; 3], b: [f64; 3]) -> bool {
        DVec3::from(a).distance(DVec3::from(b)) < 1e-9
    }

    const CAMERA: Camera = Camera { eye: [6.0, 4.0, 8.0], target: [0.0, 1.0, 0.0], fov: 0.8 };

    #[test]
    fn takes_over_without_a_jump() {
        let camera = Orbit::from_camera(&CAMERA).camera();
        assert!(near(camera.eye, CAMERA.eye) && near(camera.target, CAMERA.target));
    }

    #[test]
    fn dragging_right_shows_the_left_side_and_dragging_down_the_top() {
        let straight = Camera { eye: [0.0, 0.0, 5.0], target: [0.0; 3], fov: 0.8 };
        let mut orbit = Orbit::from_camera(&straight);
        orbit.turn(0.1, 0.0);
        assert!(orbit.camera().eye[0] < 0.0);
        orbit.turn(0.0, 0.1);
        assert!(orbit.camera().eye[1] > 0.0);
        orbit.turn(0.0, 100.0);
        assert!(orbit.camera().eye[1] < 5.0, "never quite from above");
    }

    #[test]
    fn what_is_dragged_follows_the_pointer() {
        let straight = Camera { eye: [0.0, 0.0, 5.0], target: [0.0; 3], fov: PI / 2.0 };
        let mut orbit = Orbit::from_camera(&straight);
        // The picture is 10 high at the target's distance.
        orbit.pan(0.1, 0.0);
        assert!(near(orbit.camera().target, [-1.0, 0.0, 0.0]));
        orbit.pan(0.0, 0.1);
        assert!(near(orbit.camera().target, [-1.0, 1.0, 0.0]));
    }

    #[test]
    fn a_camera_within_its_target_is_no_trouble() {
        let camera = Camera { eye: [1.0; 3], target: [1.0; 3], fov: 0.8 };
        let mut orbit = Orbit::from_camera(&camera);
        orbit.dolly(2.0);
        assert!(orbit.camera().eye.iter().all(|c| c.is_finite()));
    }
}
