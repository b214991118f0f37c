//! What the compiler hands over: a module of WGSL, what a host must write into its uniform block, and the scene around it.

pub use crate::blocks::{CAPTURE_SIZES, CameraNodes, CaptureNodes, LightNodes, SceneBlocks, Shadow, Tone};
pub use crate::camera::{Camera, Home, Projection};
pub use crate::emit::table::{ModuleTables, Tables};
pub use crate::emit::{Formulas, Module};
pub use crate::frame::{Fog, Frame, Light, LightKind, MAX_BOUNCES, Sky};
pub use crate::interface::{Colors, Entry, Export, Options, Parameter, Rounding, Uniform, UniformSource, Uniforms, ViewField};
pub use crate::live::Live;
pub use crate::loader::{Loader, MemoryLoader};

use crate::camera::{EYE, FOV};
use crate::diagnostic::{Diagnostic, Severity};
use crate::frame::PLAIN_SKY;
use crate::functions::{self, Functions, Summary};
use crate::shading::usual_reflections;
use crate::graph::{FAR, Graph, Leaf, Node, NodeId, ShapeId, multiple_of};
use crate::source::{Sources, Span};
use crate::vector::{Vec3, length, sub};

/// Operations of a field of which the box is not looked for once more.
const LONG: usize = 5000;
/// A look that enters more shapes than these takes minutes.
const MOST_ENTERED: f64 = 2e6;

/// Where a scene does not say how far one sees: so far, or as far as its extent, or so many times as far as a camera is from what it looks at.
const FAR_ENOUGH: f64 = 100.0;
const SIGHT: f64 = 2.5;

/// A compiled scene.
#[derive(Clone, Debug)]
pub struct Compiled {
    /// The graph, with the functions of its shapes.
    pub graph: Graph,
    /// The scene's shape. Its space is that of the scene.
    pub root: ShapeId,
    /// Field, bound, distance, gradient and surface as nodes of the graph.
    pub functions: Functions,
    /// What is known of the scene, in numbers.
    pub summary: Summary,
    /// Parameters in the order of the text, those of imports after those of the file.
    pub parameters: Vec<Parameter>,
    /// What stands around the field.
    pub blocks: SceneBlocks,
    /// The emitted module.
    pub module: Module,
    /// Names of declarations of the scene's own file that nothing uses, and where they stand.
    pub unused: Vec<(String, Span)>,
    /// Where a camera stands of which the text says nothing, where there is one.
    pub home: Option<Box<Home>>,
    /// The scene as balls meet it, where that is another; see [`Compiled::ground`].
    pub apart: Option<Box<Compiled>>,
}

/// What came of a compilation.
#[derive(Debug)]
pub struct Outcome {
    /// All texts, for diagnostics.
    pub sources: Sources,
    /// Errors and warnings, in the order of their places.
    pub diagnostics: Vec<Diagnostic>,
    /// Every file that was read or looked for, the scene's own first: what a watcher should watch.
    pub files: Vec<String>,
    /// The scene, where nothing was an error.
    pub compiled: Option<Compiled>,
}

impl Outcome {
    /// Whether there is an error among the diagnostics.
    pub fn has_errors(&self) -> bool {
        self.diagnostics.iter().any(|d| d.severity == Severity::Error)
    }
}

impl Compiled {
    /// The scene as balls meet it: without the shapes that they pass through, and with what says how the others move. Live values are the
    /// same; in a scene without balls it is the scene.
    pub fn ground(&self) -> &Compiled {
        self.apart.as_deref().unwrap_or(self)
    }

    /// Least and greatest corner of a box that holds the solid, where there is one within the extent; looked for when it is asked for, unless the scene is long
    /// and some box is known.
    pub fn bounds(&self) -> Option<[[f64; 3]; 2]> {
        let ahead = &self.functions.ahead;
        if let (Some(solid), None, true) = (ahead.solid, ahead.planes, self.module.operations.0 > LONG) {
            return Some([solid.0.map(|side| side.lo), solid.0.map(|side| side.hi)]);
        }
        functions::bounds(&self.graph, self.root, &self.functions, self.blocks.extent)
    }

    /// Whether anything in the scene changes with time.
    pub fn reads_time(&self) -> bool {
        (0..self.graph.len()).any(|i| matches!(self.graph.node(NodeId(i as u32)), Node::Leaf(Leaf::Time)))
    }

    /// Whether one look enters so many shapes that none can be taken.
    pub(crate) fn is_vast(&self) -> bool {
        self.graph.entered(self.root) > MOST_ENTERED
    }

    /// Time zero and every parameter at its default.
    pub fn live(&self) -> Live {
        Live::start(&self.graph)
    }

    /// A camera of the scene as it stands for a picture that is so wide for its height: farther away where the text says nothing of it, and what there
    /// is to see would be cut off at the sides.
    pub fn camera_in(&self, camera: Camera, wide: f64) -> Camera {
        match &self.home {
            Some(home) if (home.camera(camera.fov).eye, home.camera(camera.fov).target) == (camera.eye, camera.target) => {
                let Camera { eye, target, .. } = home.camera_in(camera.fov, wide);
                Camera { eye, target, ..camera }
            }
            _ => camera,
        }
    }

    /// Values of nodes that read nothing but parameters and time.
    pub fn values(&self, live: &Live, nodes: &[NodeId]) -> Vec<f64> {
        live.values(&self.graph, nodes)
    }

    /// The uniform block's bytes. `origin` is the scene's point at which the module's `p` is zero.
    pub fn uniform_bytes(&self, live: &Live, origin: [f64; 3]) -> Vec<u8> {
        let mut bytes = vec![0; self.module.uniform_size as usize];
        let frame = self.frame(live);
        let occlusion = frame.ambient_occlusion;
        let computed = self.module.formulas.values(live.time, |i| live.component(&self.graph, i));
        for uniform in &self.module.uniforms {
            for i in 0..uniform.components {
                let value = match uniform.source {
                    UniformSource::Origin => origin.get(i as usize).copied().unwrap_or(0.0) as f32,
                    UniformSource::Time => live.time as f32,
                    UniformSource::Parameter(first) => live.component(&self.graph, first + i) as f32,
                    UniformSource::OcclusionReach => occlusion.0 as f32,
                    UniformSource::OcclusionStrength => occlusion.1 as f32,
                    UniformSource::Factor(f) => multiple_of(live.factor(&self.graph, f)),
                    UniformSource::Formula(field) => self.module.formulas.component(&computed, field, i),
                    UniformSource::View(field) => frame.view(field).get(i as usize).copied().unwrap_or(0.0) as f32,
                };
                let at = (uniform.offset + 4 * i) as usize;
                if let Some(slot) = bytes.get_mut(at..at + 4) {
                    slot.copy_from_slice(&value.to_le_bytes());
                }
            }
        }
        bytes
    }

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
            None => PLAIN_SKY,
        };
        let seen = cameras.iter().map(|(_, c)| length(sub(c.eye, c.target))).fold(0.0, f64::max);
        let far = blocks.extent.max(SIGHT * seen).clamp(FAR_ENOUGH, FAR);
        Frame {
            slice: live.slice,
            section: live.section,
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
        usual_reflections(&self.functions)
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
