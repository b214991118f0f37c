//! The scene around the field: cameras, lights, the sky; as nodes, and at one moment.

use crate::blocks::{Shadow, Tone};
use crate::camera::{Basis, Camera, Projection};
use crate::interface::ViewField;
use crate::section::Section;
use crate::vector::{length, sub};

/// Where light comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// From infinitely far: the direction in which it travels, not necessarily of length one.
    Direction([f64; 3]),
    /// From a point; its strength falls with the square of the distance.
    Position([f64; 3]),
}

/// A light at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Its name.
    pub name: String,
    /// Where it comes from.
    pub kind: LightKind,
    /// Linear colour times intensity.
    pub radiance: [f64; 3],
    /// How it throws shadows.
    pub shadow: Shadow,
}

/// What surrounds the scene, linear colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    /// Colour straight up.
    pub zenith: [f64; 3],
    /// Colour at the horizon and below.
    pub horizon: [f64; 3],
}

/// The sky of a scene that says nothing of it: dark enough for what is grey and lit to stand out from it.
pub const PLAIN_SKY: Sky = Sky { zenith: [0.49, 0.5, 0.511], horizon: [0.24, 0.238, 0.235] };

/// Fog, the same everywhere.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fog {
    /// What it scatters toward the eye, linear.
    pub color: [f64; 3],
    /// Of the light of what is `d` away the share `exp(-density d)` arrives; at least 0.
    pub density: f64,
}

impl Fog {
    /// How much of the light of what is so far away arrives.
    pub fn clear(&self, way: f64) -> f64 {
        (-self.density * way.max(0.0)).exp()
    }
}

/// Distance from the eye of the plane at which a depth begins or ends that a host does not say.
pub const NEAR: f64 = 0.01;

/// The size of a picture that a host does not say.
const SIZE: [f64; 2] = [640.0, 360.0];

/// Everything around the field at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Where the plane of a slice is: [`Live::slice`](crate::live::Live::slice).
    pub slice: f64,
    /// The plane that cuts the picture open: [`Live::section`](crate::live::Live::section).
    pub section: Option<Section>,
    /// Cameras with their names; the first is the one that is used. Never empty.
    pub cameras: Vec<(String, Camera)>,
    /// Lights in the order of the text.
    pub lights: Vec<Light>,
    /// What surrounds the scene.
    pub sky: Sky,
    /// Whether images stand for it.
    pub has_environment: bool,
    /// How far occlusion reaches and how strong it is, 0 to 1.
    pub ambient_occlusion: (f64, f64),
    /// Whether there are shadows at all.
    pub shadows: bool,
    /// Beyond this distance from the eye nothing is drawn.
    pub max_distance: f64,
    /// Radius about the origin beyond which nothing is drawn and nothing is proven.
    pub extent: f64,
    /// Exposure in stops.
    pub exposure: f64,
    /// How light becomes a screen's colour.
    pub tone: Tone,
    /// The share of light that is scattered over the picture, 0 to 1.
    pub bloom: f64,
    /// What is between the eye and what it sees.
    pub fog: Option<Fog>,
    /// How often a mirrored ray is followed through the field, 0 to [`MAX_BOUNCES`].
    pub reflections: u32,
    /// From where the scene itself is drawn into a cubemap, which stands for what surfaces mirror.
    pub capture: Option<[f64; 3]>,
}

impl Frame {
    /// What a module that draws is told of the view through the first camera.
    pub fn view(&self, field: ViewField) -> Vec<f64> {
        let camera = self.cameras.first().map_or(Camera::PLAIN, |(_, camera)| *camera);
        match field {
            ViewField::Eye => camera.eye.to_vec(),
            ViewField::LookAt => camera.target.to_vec(),
            ViewField::Up => camera.up.to_vec(),
            ViewField::Fov => vec![camera.fov],
            ViewField::Height => match camera.projection {
                Projection::Orthographic(Some(height)) => vec![height],
                _ => vec![2.0 * Basis::of(&camera).tan_half_fov * length(sub(camera.target, camera.eye)).max(1e-9)],
            },
            ViewField::Size => SIZE.to_vec(),
            ViewField::Corner => vec![0.0; 2],
            ViewField::Near => vec![NEAR],
            ViewField::Far => vec![self.max_distance],
        }
    }
}

/// A ray is mirrored at most so often.
pub const MAX_BOUNCES: u32 = 8;

/// The most lights that a picture takes; those beyond are left out.
pub const MAX_LIGHTS: usize = 16;

/// What the ground throws back of the sky's light, and of the light of lamps that are infinitely far.
pub const GROUND: (f64, f64) = (0.25, 0.07);

/// The light of a scene that has none.
pub fn default_light() -> Light {
    Light {
        name: String::new(),
        kind: LightKind::Direction([0.55, -0.8, -0.5]),
        radiance: [3.02, 2.95, 2.86],
        shadow: Shadow::Soft(12.0),
    }
}
