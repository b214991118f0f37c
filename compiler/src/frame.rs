//! The scene around the field: cameras, lights, the sky; as nodes, and at one moment.

use crate::compiled::{Compiled, Live};
use crate::graph::{FAR, Graph, NodeId};
use crate::images::EnvironmentFile;
use crate::mesh::MeshNodes;
use crate::physics::{BallsNodes, PhysicsNodes};
use crate::reference::shade;
use crate::graph::interval::Interval;
use crate::reference::camera::Basis;
use crate::reference::vector::{Vec3, add, dot, length, scale, sub};
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
    /// How often a mirrored ray is followed through the field, 0 to [`MAX_BOUNCES`].
    pub reflections: u32,
    /// From where the scene itself is drawn into a cubemap, which stands for what surfaces mirror.
    pub capture: Option<[f64; 3]>,
}

/// Where a scene does not say how far one sees: so far, or as far as its extent, or so many times as far as a camera is from what it looks at.
const FAR_ENOUGH: f64 = 100.0;
const SIGHT: f64 = 2.5;

/// Where a camera stands of which nothing is said.
pub const EYE: Vec3 = [4.0, 3.0, 6.0];
/// What is smaller than this is not gone nearer to.
pub const SMALLEST: f64 = 1e-3;
/// What fills less of the picture's height than this is gone nearer to.
const LEAST_SHARE: f64 = 0.1;
/// So much farther away than it would fill the picture from, all that is solid is looked at.
const MARGIN: f64 = 1.1;
/// So wide a picture is taken to be, for its height.
const WIDE: f64 = 1.3;

/// A ray is mirrored at most so often.
pub const MAX_BOUNCES: u32 = 8;

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
    /// How balls move, where the text says.
    pub physics: Option<PhysicsNodes>,
    /// The groups of balls, in the order of the text.
    pub balls: Vec<BallsNodes>,
    /// The meshes, in the order of the text.
    pub meshes: Vec<MeshNodes>,
}

impl SceneBlocks {
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
    /// Shadow, and its penumbra's number where it is soft.
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
                (nodes.name.clone(), self.camera(said, one(nodes.fov)))
            })
            .collect();
        if cameras.is_empty() {
            cameras.push((String::new(), self.camera([None; 2], 0.7)));
        }
        let lights = blocks
            .lights
            .iter()
            .map(|light| {
                let vector = three(&light.vector);
                let (color, intensity) = (three(&light.color), one(light.intensity));
                let shadow = match light.shadow {
                    (Shadow::Soft(_), Some(k)) => Shadow::Soft(one(k).max(0.1)),
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
            capture: blocks.capture.map(|capture| three(&capture.place)),
            reflections: blocks.reflections.map_or(0.0, one).round().clamp(0.0, f64::from(MAX_BOUNCES)) as u32,
        }
    }

    /// A camera of which eye and target are given or not. Where neither is it stands as usual if all that is solid is well seen from there, else so
    /// far away from that, in the same direction, that it is.
    fn camera(&self, [eye, target]: [Option<Vec3>; 2], fov: f64) -> Camera {
        let usual = Camera { eye: eye.unwrap_or(EYE), target: target.unwrap_or([0.0; 3]), fov };
        let Some(region) = self.functions.ahead.home.filter(|r| eye.or(target).is_none() && r.size() > SMALLEST) else {
            return usual;
        };
        let (middle, sides) = (region.0.map(Interval::middle), region.0.map(|side| side.width()));
        let radius = 0.5 * length(sides);
        let basis = Basis::of(&usual);
        let is_seen = |corner: u32| {
            let of = |i: u32, side: Interval| if corner >> i & 1 == 0 { side.lo } else { side.hi };
            let [x, y, z] = region.0;
            let way = sub([of(0, x), of(1, y), of(2, z)], EYE);
            let reach = basis.tan_half_fov * dot(way, basis.forward);
            dot(way, basis.up).abs() < reach && dot(way, basis.right).abs() < WIDE * reach
        };
        let is_large = radius > LEAST_SHARE * length(EYE) * basis.tan_half_fov;
        if is_large && (0..8).all(is_seen) {
            return usual;
        }
        let away = scale(EYE, MARGIN * radius / basis.tan_half_fov / length(EYE));
        Camera { eye: add(middle, away), target: middle, fov }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]
mod tests {
    use crate::reference::vector::{length, sub};
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

    #[test]
    fn a_scene_without_a_camera_is_seen_whole() {
        let seen = |text: &str| {
            let scene = compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default()).compiled.unwrap();
            let frame = scene.frame(&scene.live());
            (frame.cameras[0].1, frame.extent)
        };
        // What is well seen from the usual place is seen from there.
        for usual in ["scene = sphere(1)", "scene = torus(1.5, 0.5) | plane(y, -1)", "scene = box(2)\ncamera { fov: 40deg }"] {
            let (camera, extent) = seen(usual);
            assert_eq!((camera.eye, camera.target, extent), ([4.0, 3.0, 6.0], [0.0; 3], 100.0), "{usual}");
        }
        for other in ["scene = box(20)", "scene = sphere(0.01)", "scene = sphere(1).translate(0, 0, 30)", "scene = sphere(400) | plane(y, -400)", "param r = 10 in 1..1000\nscene = box(2 * r)"] {
            let (camera, extent) = seen(other);
            let away = length(sub(camera.eye, camera.target));
            let (middle, radius) = match other {
                o if o.contains("0.01") => ([0.0; 3], 0.01),
                o if o.contains("30)") => ([0.0, 0.0, 30.0], 1.0),
                o if o.contains("400") => ([0.0; 3], 400.0),
                _ => ([0.0; 3], 10.0),
            };
            assert!(length(sub(camera.target, middle)) < 0.1 * radius, "{other}: {camera:?}");
            assert!(away > 2.5 * radius && away < 8.0 * radius, "{other}: {camera:?}");
            assert!(extent > 1.4 * radius, "{other}: {extent}");
        }
        // Of these shapes a first look says next to nothing of where they end.
        for (other, radius) in [
            ("scene = prism(6, 30, 30)", 42.0),
            ("scene = pyramid(300, 300)", 260.0),
            ("scene = superquadric((10, 10, 10), 4)", 12.0),
            ("scene = star(5, 400, 200).extrude(50)", 530.0),
            ("scene = box(30).shear(y, x, 0.3)", 29.0),
            ("scene = cylinder((-60, -60, 0), (60, 60, 5), 4)", 89.0),
            ("scene = (rectangle((300, 200)) - for i in 0..11 { circle(4).translate(80, 0).rotate(i / 11 * 1turn) }).extrude(10)", 180.0),
            ("scene = for i in 0..200 by smooth_union(2) { sphere(3).translate(10 * (i - 100), 0, 0) }", 1000.0),
            ("param n: int = 6 in 3..12\nscene = prism(n, 300, 50)", 400.0),
            ("scene = sphere(3).translate(300, 0, 0).repeat_polar(y, 40)", 430.0),
            ("scene = box(10).translate(150, 0, 0).repeat_polar(y, 12) | sphere(20)", 220.0),
            ("scene = (for c in polar(30) { circle(3).translate(400, 0) }).extrude(4)", 570.0),
            ("scene = sphere(101).repeat(250, (2, 1, 2))", 330.0),
        ] {
            let (camera, extent) = seen(other);
            let away = length(sub(camera.eye, camera.target));
            assert!(length(camera.target) < 0.1 * radius, "{other}: {camera:?}");
            assert!(away > 1.5 * radius && away < 8.0 * radius, "{other}: {camera:?}");
            assert!(extent > 1.4 * radius, "{other}: {extent}");
        }
        // A tree whose branches are turned, again and again: its middle is in the picture.
        let tree = "shape tree(n: int, len: float) = {
  let trunk = capsule((0, 0, 0), (0, len, 0), 0.08 * len);
  if n == 0 { trunk } else {
    trunk
    | tree(n - 1, 0.7 * len).rotate(z, 30deg).translate(0, len, 0)
    | tree(n - 1, 0.7 * len).rotate(z, -25deg).rotate(y, 70deg).translate(0, len, 0)
    | tree(n - 1, 0.6 * len).rotate(x, 35deg).translate(0, len, 0)
  }
}";
        for (branches, height) in [(4, 2.7), (5, 3.0), (7, 3.2)] {
            let (camera, _) = seen(&format!("{tree}\nscene = tree({branches}, 1)"));
            let away = length(sub(camera.eye, camera.target));
            assert!((camera.target[1] - 0.5 * height).abs() < 0.5, "{branches}: {camera:?}");
            assert!(away > 1.2 * height && away < 4.0 * height, "{branches}: {camera:?}");
        }
        // Who says where the camera stands has it there.
        let (camera, extent) = seen("scene = box(20)\ncamera { eye: (0, 0, 50) }\nrender { extent: 30 }");
        assert_eq!((camera.eye, extent), ([0.0, 0.0, 50.0], 30.0));
    }
}
