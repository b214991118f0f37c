//! Cameras: where one stands, and rays through the pixels of a picture.

use crate::vector::{Vec3, add, cross, dot, length, scale, sub, unit};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// Where a camera stands by which nothing that ends is to be seen, or of which only the target is said.
pub const EYE: Vec3 = [4.0, 3.0, 6.0];
/// What is smaller than this is not gone nearer to.
pub const SMALLEST: f64 = 1e-9;
/// A camera's vertical angle of view where none is said.
pub const FOV: f64 = 40f64.to_radians();
/// So much of the picture's height is filled.
pub(crate) const SHARE: f64 = 0.66;
/// So wide a picture is taken to be, for its height, if it is not narrower.
pub(crate) const WIDE: f64 = 1.3;
/// A point and direction of view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where the eye is.
    pub eye: [f64; 3],
    /// What it looks at.
    pub target: [f64; 3],
    /// Vertical angle of view, radians.
    pub fov: f64,
    /// What is up in the picture, of any length.
    pub up: [f64; 3],
    /// How rays go through the picture.
    pub projection: Projection,
    /// Radius of the lens; 0: all is sharp.
    pub lens: f64,
    /// How far ahead of the eye what is sharp lies; as far as the target where that is left out.
    pub focus: Option<f64>,
    /// How far off the axis each ray leans for each unit ahead, to the right and up: so a sample through another place of the lens sees
    /// what is in focus where the others do.
    pub lean: [f64; 2],
}

/// How rays go through a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// From the eye.
    Perspective,
    /// Side by side, over so much of the scene from the picture's lower edge to its upper one; as much as in perspective is seen at the target
    /// where that is left out.
    Orthographic(Option<f64>),
}

impl Camera {
    /// In front, above and to the right of the origin.
    pub const PLAIN: Self = Self {
        eye: EYE,
        target: [0.0; 3],
        fov: FOV,
        up: [0.0, 1.0, 0.0],
        projection: Projection::Perspective,
        lens: 0.0,
        focus: None,
        lean: [0.0; 2],
    };

    /// As the sample of a number sees through it: from another place of the lens, where it has one.
    pub fn sampled(&self, index: u32) -> Self {
        if self.lens <= 0.0 {
            return *self;
        }
        let basis = Basis::of(self);
        let far = length(sub(self.target, self.eye));
        let focus = self.focus.unwrap_or(far).max(1e-6);
        let [right, up] = lens_offset(index).map(|c| c * self.lens);
        let moved = add(scale(basis.right, right), scale(basis.up, up));
        let lean = [-right / focus, -up / focus];
        Self { eye: add(self.eye, moved), target: add(self.target, moved), lean, ..*self }
    }
}

/// A camera's own axes. The picture is seen along `forward`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Basis {
    /// To the right of the picture; length one.
    pub right: Vec3,
    /// To the top of the picture; length one.
    pub up: Vec3,
    /// Into the picture; length one.
    pub forward: Vec3,
    /// Half of the picture's height at distance one; of rays side by side, at that of the target.
    pub tan_half_fov: f64,
    /// Where rays go side by side: how far the target is, or 1 where that is no way.
    pub parallel: Option<f64>,
    /// How far rays lean for each unit ahead, to the right and up ([`Camera::lean`]).
    pub lean: [f64; 2],
}

impl Basis {
    /// The axes of a camera. One that looks along its own `up` has x to its right, or z where it looks along x; one without a target looks
    /// along -z.
    pub fn of(camera: &Camera) -> Self {
        let forward = unit(sub(camera.target, camera.eye)).unwrap_or([0.0, 0.0, -1.0]);
        let side = cross(forward, unit(camera.up).unwrap_or([0.0, 1.0, 0.0]));
        let across = |axis: Vec3| unit(sub(axis, scale(forward, dot(axis, forward))));
        let spare = if forward[0].abs() < 0.9 { [1.0, 0.0, 0.0] } else { [0.0, 0.0, 1.0] };
        // Views nearly along `up` would turn with the last digits of the target.
        let right = unit(side).filter(|_| length(side) > 1e-6).or_else(|| across(spare)).unwrap_or([1.0, 0.0, 0.0]);
        let up = cross(right, forward);
        // An angle of half a turn or more has no picture plane.
        let seen = (camera.fov / 2.0).clamp(1e-4, 1.55).tan();
        let far = Some(length(sub(camera.target, camera.eye))).filter(|far| *far > 1e-9).unwrap_or(1.0);
        let (tan_half_fov, parallel) = match camera.projection {
            Projection::Perspective => (seen, None),
            Projection::Orthographic(height) => (height.map_or(seen, |height| height / 2.0 / far), Some(far)),
        };
        Self { right, up, forward, tan_half_fov, parallel, lean: camera.lean }
    }

    /// How far a point of a picture, in pixels from its upper left corner, lies off its middle at distance one: to the right and up.
    fn aside(&self, at: (f64, f64), size: (u32, u32)) -> [f64; 2] {
        let (width, height) = (f64::from(size.0), f64::from(size.1));
        [(at.0 / width * 2.0 - 1.0) * self.tan_half_fov * width / height, (1.0 - at.1 / height * 2.0) * self.tan_half_fov]
    }

    /// The direction through a point of a picture, in pixels from its upper left corner; length one.
    pub fn direction(&self, at: (f64, f64), size: (u32, u32)) -> Vec3 {
        let [right, up] = if self.parallel.is_some() { [0.0; 2] } else { self.aside(at, size) };
        let plane = add(scale(self.right, right + self.lean[0]), scale(self.up, up + self.lean[1]));
        unit(add(self.forward, plane)).unwrap_or(self.forward)
    }

    /// Where the ray through such a point begins that is seen from an eye.
    pub fn start(&self, eye: Vec3, at: (f64, f64), size: (u32, u32)) -> Vec3 {
        let Some(far) = self.parallel else { return eye };
        let [right, up] = self.aside(at, size);
        add(eye, add(scale(self.right, far * right), scale(self.up, far * up)))
    }

    /// Width of a pixel at distance one, of a picture of this height in pixels.
    pub fn footprint(&self, height: u32) -> f64 {
        2.0 * self.tan_half_fov / f64::from(height.max(1))
    }
}

/// Where on a lens of radius one the sample of a number looks through: right and up. The first looks through the middle; all of them together
/// cover the disc evenly (Roberts' sequence of four numbers, of which [`sample_offset`] does not know the last two; Shirley and Chiu, "A Low
/// Distortion Map Between Disk and Square", 1997).
pub fn lens_offset(index: u32) -> [f64; 2] {
    // The third and fourth power of one over the root of x⁵ = x + 1.
    const STEPS: [f64; 2] = [0.628_706_721_037_808_6, 0.538_597_257_223_61];
    let [x, y] = STEPS.map(|step| 2.0 * ((0.5 + f64::from(index) * step).fract() - 0.5));
    let (radius, turn) = match x.abs() > y.abs() {
        true => (x, FRAC_PI_4 * y / x),
        false if y == 0.0 => (0.0, 0.0),
        false => (y, FRAC_PI_2 - FRAC_PI_4 * x / y),
    };
    [radius * turn.cos(), radius * turn.sin()]
}

/// Where a camera stands of which the text says nothing, and what it shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Home {
    /// What it looks at.
    pub(crate) target: Vec3,
    /// The way from there to the eye; of length one, but where it stands nearer or farther than what is to be seen asks for.
    pub(crate) way: Vec3,
    /// Places about what is solid and ends, from the target; none where nothing does.
    pub(crate) about: Vec<Vec3>,
    /// How many times as far away the eye is free as well.
    pub(crate) room: f64,
}

impl Home {
    /// The camera, of some angle of view.
    pub fn camera(&self, fov: f64) -> Camera {
        self.camera_in(fov, WIDE)
    }

    /// The same for a picture that is so wide for its height.
    pub fn camera_in(&self, fov: f64, wide: f64) -> Camera {
        let wide = wide.clamp(WIDE / self.room, WIDE);
        let basis = Basis::of(&Camera { eye: self.way, target: [0.0; 3], fov, ..Camera::PLAIN });
        // So far away a place is as high in the picture as it may be, or as far to a side.
        let needed = |place: &Vec3| {
            let height = dot(*place, basis.up).abs().max(dot(*place, basis.right).abs() / wide);
            height / (SHARE * basis.tan_half_fov) - dot(*place, basis.forward)
        };
        let far = if self.about.is_empty() { length(EYE) } else { self.about.iter().map(needed).fold(0.0, f64::max) };
        Camera { eye: add(self.target, scale(self.way, far)), target: self.target, fov, ..Camera::PLAIN }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: (u32, u32) = (200, 100);
    const CAMERA: Camera = Camera { eye: [0.0, 0.0, 5.0], target: [0.0; 3], fov: 0.8, ..Camera::PLAIN };

    fn near(a: Vec3, b: Vec3) -> bool {
        length(sub(a, b)) < 1e-9
    }

    #[test]
    fn up_is_where_the_camera_says() {
        let basis = |up| Basis::of(&Camera { up, ..CAMERA });
        assert!(near(basis([0.0, 3.0, 1.0]).right, [1.0, 0.0, 0.0]));
        assert!(near(basis([2.0, 0.0, 0.0]).up, [1.0, 0.0, 0.0]));
        assert!(near(basis([0.0, -1.0, 0.0]).right, [-1.0, 0.0, 0.0]));
        // Along the view, or nowhere, it says nothing.
        assert!(near(basis([0.0, 0.0, 1.0]).right, [1.0, 0.0, 0.0]));
        assert!(near(basis([0.0; 3]).up, [0.0, 1.0, 0.0]));
        let along_x = Basis::of(&Camera { eye: [5.0, 0.0, 0.0], up: [1.0, 0.0, 0.0], ..CAMERA });
        assert!(near(along_x.right, [0.0, 0.0, 1.0]));
    }

    #[test]
    fn parallel_rays_cover_the_height() {
        let basis = Basis::of(&Camera { projection: Projection::Orthographic(Some(4.0)), ..CAMERA });
        assert!(near(basis.start(CAMERA.eye, (200.0, 0.0), SIZE), [4.0, 2.0, 5.0]));
        assert!(near(basis.start(CAMERA.eye, (100.0, 100.0), SIZE), [0.0, -2.0, 5.0]));
        assert!(near(basis.direction((7.0, 93.0), SIZE), [0.0, 0.0, -1.0]));
        // As much as is seen in perspective at the target.
        let usual = Basis::of(&Camera { projection: Projection::Orthographic(None), ..CAMERA });
        let seen = Basis::of(&CAMERA);
        let [_, above, _] = add(CAMERA.eye, scale(seen.direction((100.0, 0.0), SIZE), 5.0 / seen.direction((100.0, 0.0), SIZE)[2].abs()));
        assert!((usual.start(CAMERA.eye, (100.0, 0.0), SIZE)[1] - above).abs() < 1e-9);
    }

    /// Through all places of a lens what is in focus is seen in the same pixel, and nothing else is.
    #[test]
    fn samples_through_a_lens_meet_in_focus() {
        let camera = Camera { lens: 0.3, focus: Some(2.0), ..CAMERA };
        let at = (150.0, 20.0);
        let place = |index: u32, ahead: f64| {
            let camera = camera.sampled(index);
            let direction = Basis::of(&camera).direction(at, SIZE);
            add(camera.eye, scale(direction, ahead / -direction[2]))
        };
        let mut widest: f64 = 0.0;
        for index in 1..64 {
            assert!(near(place(index, 2.0), place(0, 2.0)));
            widest = widest.max(length(sub(place(index, 4.0), place(0, 4.0))));
        }
        // Twice as far the disc of the lens is seen again.
        assert!((0.27..0.3001).contains(&widest), "{widest}");
        assert_eq!(Camera { lens: 0.0, ..camera }.sampled(9), Camera { lens: 0.0, ..camera });
    }
}
