//! A camera that a person moves around a point.

use glam::{DQuat, DVec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use surefoot_compiler::compiled::{Camera, Projection};
use surefoot_compiler::camera::Basis;

/// A camera that looks at a point from a distance. It stands upright: the scene's camera says what is up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orbit {
    target: DVec3,
    distance: f64,
    /// Turn about what is up, radians; where that is y, 0 looks along -z.
    yaw: f64,
    /// Height above the horizon, radians.
    pitch: f64,
    /// From axes of which y is up to those of the scene.
    upright: DQuat,
    /// Whether rays go side by side, though the camera's do not.
    pub parallel: bool,
    /// The camera that it was, and how far away that stood.
    camera: Camera,
    began: f64,
}

/// From where one looks along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Along -z, where y is up.
    Front,
    /// Along -x.
    Right,
    /// From above.
    Top,
    /// From a corner: the three axes are as long as each other.
    Corner,
}

impl Side {
    /// All, with their names and keys.
    pub const ALL: [(&'static str, &'static str, Side); 4] = [("Front", "1", Side::Front), ("Right", "3", Side::Right), ("Top", "7", Side::Top), ("Isometric", "9", Side::Corner)];
}

/// Nearer to the vertical the picture would spin.
const STEEPEST: f64 = FRAC_PI_2 - 0.01;
/// Distances that 32 bits can tell apart from the target and from infinity.
const DISTANCES: (f64, f64) = (1e-3, 1e5);

impl Orbit {
    /// Takes over where a scene's camera stands.
    pub fn from_camera(camera: &Camera) -> Self {
        let (eye, target) = (DVec3::from(camera.eye), DVec3::from(camera.target));
        let upright = DQuat::from_rotation_arc(DVec3::Y, DVec3::from(camera.up).normalize_or(DVec3::Y));
        let away = upright.inverse() * (eye - target).try_normalize().unwrap_or(DVec3::Z);
        let distance = eye.distance(target).clamp(DISTANCES.0, DISTANCES.1);
        Self {
            target,
            distance,
            yaw: away.x.atan2(away.z),
            pitch: away.y.clamp(-1.0, 1.0).asin().clamp(-STEEPEST, STEEPEST),
            upright,
            parallel: false,
            camera: *camera,
            began: distance,
        }
    }

    /// Where it stands and looks.
    pub fn camera(&self) -> Camera {
        let nearer = self.distance / self.began;
        Camera {
            eye: (self.target + self.away() * self.distance).into(),
            target: self.target.into(),
            // Rays side by side see less where one goes nearer.
            projection: match self.camera.projection {
                // As high as what is seen at the target.
                Projection::Perspective if self.parallel => Projection::Orthographic(Some(2.0 * self.distance * (0.5 * self.camera.fov).tan())),
                Projection::Orthographic(Some(height)) => Projection::Orthographic(Some(height * nearer)),
                other => other,
            },
            ..self.camera
        }
    }

    /// From the target to the eye; length one.
    fn away(&self) -> DVec3 {
        let (sin, cos) = self.pitch.sin_cos();
        self.upright * DVec3::new(self.yaw.sin() * cos, sin, self.yaw.cos() * cos)
    }

    /// Turns, as if the scene were dragged: by parts of the picture's height, to the right and down.
    pub fn turn(&mut self, right: f64, down: f64) {
        self.yaw = (self.yaw - right * PI) % TAU;
        self.pitch = (self.pitch + down * PI).clamp(-STEEPEST, STEEPEST);
    }

    /// Moves sideways, so that what lies at the target's distance follows the pointer: by parts of the picture's height.
    pub fn pan(&mut self, right: f64, down: f64) {
        let away = self.away();
        let aside = (self.upright * DVec3::Y).cross(away).normalize_or(DVec3::X);
        let up = away.cross(aside);
        let height = 2.0 * self.distance * Basis::of(&self.camera()).tan_half_fov;
        self.target += (up * down - aside * right) * height;
    }

    /// Looks at the same place from a side, as far away as before.
    pub fn look_from(&mut self, side: Side) {
        (self.yaw, self.pitch) = match side {
            Side::Front => (0.0, 0.0),
            Side::Right => (FRAC_PI_2, 0.0),
            Side::Top => (0.0, STEEPEST),
            Side::Corner => (0.25 * PI, (1.0 / 3f64.sqrt()).asin()),
        };
    }

    /// Looks at a point: so far away that a ball of this radius about it is seen, or half as far as before.
    pub fn frame(&mut self, point: [f64; 3], radius: Option<f64>) {
        self.target = point.into();
        let half = Basis::of(&self.camera()).tan_half_fov.atan();
        let distance = radius.map_or(0.5 * self.distance, |radius| 1.1 * radius / half.sin().max(1e-3));
        self.distance = distance.clamp(DISTANCES.0, DISTANCES.1);
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

    const CAMERA: Camera = Camera { eye: [6.0, 4.0, 8.0], target: [0.0, 1.0, 0.0], fov: 0.8, ..Camera::PLAIN };

    #[test]
    fn takes_over_without_a_jump() {
        let camera = Orbit::from_camera(&CAMERA).camera();
        assert!(near(camera.eye, CAMERA.eye) && near(camera.target, CAMERA.target));
    }

    #[test]
    fn dragging_right_shows_the_left_side_and_dragging_down_the_top() {
        let straight = Camera { eye: [0.0, 0.0, 5.0], target: [0.0; 3], fov: 0.8, ..Camera::PLAIN };
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
        let straight = Camera { eye: [0.0, 0.0, 5.0], target: [0.0; 3], fov: PI / 2.0, ..Camera::PLAIN };
        let mut orbit = Orbit::from_camera(&straight);
        // The picture is 10 high at the target's distance.
        orbit.pan(0.1, 0.0);
        assert!(near(orbit.camera().target, [-1.0, 0.0, 0.0]));
        orbit.pan(0.0, 0.1);
        assert!(near(orbit.camera().target, [-1.0, 1.0, 0.0]));
    }

    #[test]
    fn sides_and_frames_keep_what_is_seen_in_the_middle() {
        let mut orbit = Orbit::from_camera(&CAMERA);
        orbit.look_from(Side::Right);
        let camera = orbit.camera();
        assert!(near(camera.target, CAMERA.target) && camera.eye[0] > 9.0 && (camera.eye[1] - 1.0).abs() < 1e-9);
        orbit.look_from(Side::Top);
        assert!(orbit.camera().eye[1] > 9.0);
        orbit.look_from(Side::Front);
        assert!(orbit.camera().eye[2] > 9.0);
        orbit.look_from(Side::Corner);
        let camera = orbit.camera();
        let away = DVec3::from(camera.eye) - DVec3::from(camera.target);
        assert!(away.abs_diff_eq(DVec3::splat(away.x), 1e-9), "{away}");
        orbit.parallel = true;
        assert_eq!(orbit.camera().projection, Projection::Orthographic(Some(2.0 * away.length() * 0.4f64.tan())));
        orbit.parallel = false;
        orbit.frame([1.0, 2.0, 3.0], Some(0.5));
        let camera = orbit.camera();
        assert!(near(camera.target, [1.0, 2.0, 3.0]));
        // The ball just fits between the edges.
        let away = DVec3::from(camera.eye).distance(DVec3::from(camera.target));
        let seen = (0.5 / away).asin();
        assert!(seen < 0.4 && seen > 0.8 * 0.4, "{seen}");
    }

    #[test]
    fn a_camera_within_its_target_is_no_trouble() {
        let camera = Camera { eye: [1.0; 3], target: [1.0; 3], fov: 0.8, ..Camera::PLAIN };
        let mut orbit = Orbit::from_camera(&camera);
        orbit.dolly(2.0);
        assert!(orbit.camera().eye.iter().all(|c| c.is_finite()));
    }
}
