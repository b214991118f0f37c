//! The scene around the field: cameras, lights, the sky; as nodes, and at one moment.

use crate::compiled::{Compiled, Live};
use crate::graph::{FAR, Graph, NodeId};
use crate::images::EnvironmentFile;
use crate::mesh::MeshNodes;
use crate::physics::{BallsNodes, PhysicsNodes};
use crate::reference::shade;
use crate::home::{EYE, FOV};
use crate::reference::camera::Basis;
use crate::reference::film::lens_offset;
use crate::vector::{Vec3, add, length, scale, sub};
use crate::source::Span;

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

/// How a light throws shadows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shadow {
    /// None.
    None,
    /// With a sharp edge.
    Hard,
    /// With a penumbra; larger is sharper.
    Soft(f64),
    /// With that of a light of this size: the radius of a lamp, the half-angle of a sun; of 0 with a sharp edge.
    Sized(f64),
    /// From a shadow map, the field's too; where there are none, as [`Shadow::Hard`].
    Map,
}

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

/// A tone curve: how much of linear light a screen shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Tone {
    /// Narkowicz' fit to the Academy's filmic curve.
    #[default]
    Aces,
    /// Sobotka's AgX, which takes colour from what is bright.
    Agx,
    /// Khronos PBR Neutral, which leaves the colours of what is lit well.
    Neutral,
    /// None: what is brighter than white is white.
    None,
}

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

/// Everything around the field at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
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

/// Where a scene does not say how far one sees: so far, or as far as its extent, or so many times as far as a camera is from what it looks at.
const FAR_ENOUGH: f64 = 100.0;
const SIGHT: f64 = 2.5;

/// A ray is mirrored at most so often.
pub const MAX_BOUNCES: u32 = 8;

/// Surfaces that a ray meets in a scene with glass.
const THROUGH_GLASS: u32 = 6;

/// The scene drawn into a cubemap.
#[derive(Clone, Copy, Debug)]
pub struct CaptureNodes {
    /// From where.
    pub place: [NodeId; 3],
    /// Pixels of a side of its faces: one of [`CAPTURE_SIZES`].
    pub size: u32,
}

/// Pixels of a captured face's side.
pub const CAPTURE_SIZES: [u32; 7] = [16, 32, 64, 128, 256, 512, 1024];

/// Entries of the scene's blocks, as nodes over parameters and time.
#[derive(Clone, Debug, Default)]
pub struct SceneBlocks {
    /// Cameras in the order of the text.
    pub cameras: Vec<CameraNodes>,
    /// Lights.
    pub lights: Vec<LightNodes>,
    /// Zenith and horizon.
    pub sky: Option<([NodeId; 3], [NodeId; 3])>,
    /// Images that stand for the sky; where they can't be had the sky is that of a scene that names none.
    pub environment: Option<EnvironmentFile>,
    /// Where the scene itself is drawn for what mirrors it.
    pub capture: Option<CaptureNodes>,
    /// How often a mirrored ray is followed; none or a constant 0: never.
    pub reflections: Option<NodeId>,
    /// Reach and strength.
    pub ambient_occlusion: Option<(NodeId, NodeId)>,
    /// A condition.
    pub shadows: Option<NodeId>,
    /// Distance from the eye.
    pub max_distance: Option<NodeId>,
    /// Radius about the origin; constant.
    pub extent: f64,
    /// Whether the text says it.
    pub says_extent: bool,
    /// Stops.
    pub exposure: Option<NodeId>,
    /// How light becomes a screen's colour.
    pub tone: Tone,
    /// The share of light that is scattered over the picture.
    pub bloom: Option<NodeId>,
    /// Colour and density of the fog.
    pub fog: Option<([NodeId; 3], NodeId)>,
    /// How balls move, where the text says.
    pub physics: Option<PhysicsNodes>,
    /// The groups of balls, in the order of the text.
    pub balls: Vec<BallsNodes>,
    /// The meshes, in the order of the text.
    pub meshes: Vec<MeshNodes>,
}

impl SceneBlocks {
    /// Whether a light has a place.
    pub fn has_lamps(&self) -> bool {
        self.lights.iter().any(|light| light.position)
    }

    /// Whether a camera stands where what is solid is well seen: one of which the text says neither eye nor target.
    pub fn is_framed(&self) -> bool {
        self.cameras.is_empty() || self.cameras.iter().any(|camera| camera.eye.or(camera.target).is_none())
    }

    /// How far occlusion reaches and how strong it is.
    pub fn occlusion(&self, graph: &Graph, live: &Live) -> (f64, f64) {
        let Some((reach, strength)) = self.ambient_occlusion else { return (0.5, 1.0) };
        let value = |node| live.values(graph, &[node]).first().copied().unwrap_or(0.0);
        (value(reach).max(0.0), value(strength).clamp(0.0, 1.0))
    }
}

/// A camera's entries as nodes.
#[derive(Clone, Debug)]
pub struct CameraNodes {
    /// Its name; empty where it has none.
    pub name: String,
    /// Where the eye is, where that is said.
    pub eye: Option<[NodeId; 3]>,
    /// What it looks at, where that is said.
    pub target: Option<[NodeId; 3]>,
    /// Vertical angle of view.
    pub fov: NodeId,
    /// What is up in the picture, where that is said.
    pub up: Option<[NodeId; 3]>,
    /// Whether rays go side by side.
    pub orthographic: bool,
    /// How much of the scene they cover then, where that is said.
    pub height: Option<NodeId>,
    /// Radius of the lens, where there is one.
    pub lens: Option<NodeId>,
    /// How far ahead what is sharp lies, where that is said.
    pub focus: Option<NodeId>,
    /// The word `camera`.
    pub span: Span,
}

/// A light's entries as nodes.
#[derive(Clone, Debug)]
pub struct LightNodes {
    /// Its name.
    pub name: String,
    /// Whether `vector` is a position and not a direction.
    pub position: bool,
    /// Direction or position.
    pub vector: [NodeId; 3],
    /// Linear colour.
    pub color: [NodeId; 3],
    /// Intensity.
    pub intensity: NodeId,
    /// Shadow, and its penumbra's number where it is soft, or the light's size.
    pub shadow: (Shadow, Option<NodeId>),
    /// The word `light`.
    pub span: Span,
}

impl Compiled {
    /// The scene around the field at one moment.
    pub fn frame(&self, live: &Live) -> Frame {
        let one = |node: NodeId| self.values(live, &[node]).first().copied().unwrap_or(0.0);
        let three = |nodes: &[NodeId; 3]| {
            let v = self.values(live, nodes);
            [0, 1, 2].map(|i| v.get(i).copied().unwrap_or(0.0))
        };
        let blocks = &self.blocks;
        let mut cameras: Vec<(String, Camera)> = blocks
            .cameras
            .iter()
            .map(|nodes| {
                let said = [nodes.eye.as_ref().map(three), nodes.target.as_ref().map(three)];
                let plain = self.camera(said, one(nodes.fov));
                let camera = Camera {
                    up: nodes.up.as_ref().map_or(plain.up, three),
                    projection: match nodes.orthographic {
                        true => Projection::Orthographic(nodes.height.map(|height| one(height).max(1e-6))),
                        false => Projection::Perspective,
                    },
                    lens: nodes.lens.map_or(0.0, |lens| one(lens).max(0.0)),
                    focus: nodes.focus.map(one),
                    ..plain
                };
                (nodes.name.clone(), camera)
            })
            .collect();
        if cameras.is_empty() {
            cameras.push((String::new(), self.camera([None; 2], FOV)));
        }
        let lights = blocks
            .lights
            .iter()
            .map(|light| {
                let vector = three(&light.vector);
                let (color, intensity) = (three(&light.color), one(light.intensity));
                let shadow = match light.shadow {
                    (Shadow::Soft(_), Some(k)) => Shadow::Soft(one(k).max(0.1)),
                    (Shadow::Sized(_), Some(size)) => Shadow::Sized(one(size).max(0.0)),
                    (shadow, _) => shadow,
                };
                Light {
                    name: light.name.clone(),
                    kind: if light.position {
                        LightKind::Position(vector)
                    } else {
                        LightKind::Direction(vector)
                    },
                    radiance: color.map(|c| c * intensity),
                    shadow,
                }
            })
            .collect();
        let sky = match &blocks.sky {
            Some((zenith, horizon)) => Sky { zenith: three(zenith), horizon: three(horizon) },
            None => shade::PLAIN_SKY,
        };
        let seen = cameras.iter().map(|(_, c)| length(sub(c.eye, c.target))).fold(0.0, f64::max);
        let far = blocks.extent.max(SIGHT * seen).clamp(FAR_ENOUGH, FAR);
        Frame {
            cameras,
            lights,
            sky,
            has_environment: blocks.environment.is_some(),
            ambient_occlusion: blocks.occlusion(&self.graph, live),
            shadows: blocks.shadows.is_none_or(|s| one(s) != 0.0),
            max_distance: blocks.max_distance.map_or(far, |d| one(d).max(1e-3)),
            extent: blocks.extent,
            exposure: blocks.exposure.map_or(0.0, one),
            tone: blocks.tone,
            bloom: blocks.bloom.map_or(0.0, one).clamp(0.0, 1.0),
            fog: blocks.fog.as_ref().map(|(color, density)| Fog { color: three(color), density: one(*density).max(0.0) }),
            capture: blocks.capture.map(|capture| three(&capture.place)),
            reflections: blocks.reflections.map_or(f64::from(self.usual_reflections()), one).round().clamp(0.0, f64::from(MAX_BOUNCES)) as u32,
        }
    }

    /// How often a ray is followed where the text does not say: not at all, or where there is glass as often as it takes to look through some.
    pub fn usual_reflections(&self) -> u32 {
        if self.functions.surface.glass.is_some() { THROUGH_GLASS } else { 0 }
    }

    /// A camera of which eye and target are given or not.
    fn camera(&self, [eye, target]: [Option<Vec3>; 2], fov: f64) -> Camera {
        match &self.home {
            Some(home) if eye.or(target).is_none() => home.camera(fov),
            _ => Camera { eye: eye.unwrap_or(EYE), target: target.unwrap_or([0.0; 3]), fov, ..Camera::PLAIN },
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]
mod tests {
    use crate::{MemoryLoader, Options, compile};

    #[test]
    fn one_sees_what_a_camera_looks_at() {
        let far = |blocks: &str| {
            let loader = MemoryLoader::new().with("main.sdf", format!("scene = box(1)\n{blocks}"));
            let scene = compile(&loader, "main.sdf", &Options::default()).compiled.unwrap();
            scene.frame(&scene.live()).max_distance
        };
        assert_eq!(far(""), 100.0);
        assert_eq!(far("camera { eye: (0, 0, 200), target: (0, 0, 20) }"), 450.0);
        assert_eq!(far("render { extent: 300 }"), 300.0);
        assert_eq!(far("camera { eye: (0, 0, 1e30), target: (0, 0, 0) }"), 1e9);
        assert_eq!(far("param a = 0 in 0..1\ncamera { eye: (0, 0, 1 / a), target: (0, 0, 0) }"), 100.0);
        assert_eq!(far("camera { eye: (0, 0, 200), target: (0, 0, 0) }\nrender { max_distance: 50 }"), 50.0);
    }
}
