//! What a scene says besides its field, as nodes over parameters and time.

use crate::graph::kernel::Op;
use crate::graph::{Graph, MaterialId, NodeId};
use crate::images::EnvironmentFile;
use crate::live::Live;
use crate::source::Span;
use crate::unit::Unit;

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
    /// Whether a host may let rays go side by side, though no camera of the text does.
    pub parallel: bool,
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
    /// What one unit is, where the text says it.
    pub unit: Option<Unit>,
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

/// The entries of a block `physics`, as nodes over parameters and time.
#[derive(Clone, Debug)]
pub struct PhysicsNodes {
    /// Acceleration.
    pub gravity: [NodeId; 3],
    /// Speed after a bounce over speed before, 0 to 1.
    pub restitution: NodeId,
    /// Coulomb's coefficient.
    pub friction: NodeId,
    /// The force that brakes a rolling ball, over the force that presses it.
    pub rolling: NodeId,
    /// Parts of a step.
    pub substeps: NodeId,
    /// Least and greatest corner of a box that no ball leaves.
    pub walls: Option<[[NodeId; 3]; 2]>,
}

/// The entries of a block `balls`, as nodes over parameters and time.
#[derive(Clone, Debug)]
pub struct BallsNodes {
    /// Its name.
    pub name: String,
    /// How many.
    pub count: NodeId,
    /// Least and greatest radius.
    pub radius: [NodeId; 2],
    /// Least and greatest corner of the box in which they begin.
    pub spawn: [[NodeId; 3]; 2],
    /// With which velocity.
    pub velocity: [NodeId; 3],
    /// What chance is made of.
    pub seed: NodeId,
    /// The material's colour, emission, roughness, metallic, reflectivity.
    pub look: Option<[NodeId; 9]>,
    /// The speed from which on balls are red, where their colour is that of their speed.
    pub red_at: Option<NodeId>,
}

impl PhysicsNodes {
    /// Every node of the block.
    pub fn nodes(&self) -> Vec<NodeId> {
        let mut nodes = self.gravity.to_vec();
        nodes.extend([self.restitution, self.friction, self.rolling, self.substeps]);
        nodes.extend(self.walls.iter().flatten().flatten());
        nodes
    }
}

impl BallsNodes {
    /// Every node of the block.
    pub fn nodes(&self) -> Vec<NodeId> {
        let mut nodes = vec![self.count, self.seed];
        nodes.extend(self.radius.iter().chain(self.spawn.iter().flatten()).chain(&self.velocity));
        nodes.extend(self.look.iter().flatten());
        nodes.extend(self.red_at);
        nodes
    }
}

/// The entries of a block `mesh`, as nodes over parameters and time.
#[derive(Clone, Debug)]
pub struct MeshNodes {
    /// Its name.
    pub name: String,
    /// Its file, as a loader is asked for it.
    pub file: String,
    /// Where the text names the file.
    pub span: Span,
    /// Where its origin stands.
    pub translate: [NodeId; 3],
    /// Angles in radians about x, then y, then z.
    pub rotate: [NodeId; 3],
    /// How much larger it is than in its file, along its own axes.
    pub scale: [NodeId; 3],
    /// What it is made of.
    pub material: Option<MaterialId>,
    /// The material's colour, emission, roughness, metallic, reflectivity.
    pub look: Option<[NodeId; 9]>,
}

impl MeshNodes {
    /// Every node of the block.
    pub fn nodes(&self) -> Vec<NodeId> {
        let mut nodes: Vec<NodeId> = [self.translate, self.rotate, self.scale].into_iter().flatten().collect();
        nodes.extend(self.look.iter().flatten());
        nodes
    }

    /// Where a point of its own space stands in the scene, as nodes.
    pub(crate) fn world(&self, graph: &mut Graph, point: [NodeId; 3]) -> [NodeId; 3] {
        let [x, y, z] = self.rotate.map(|angle| (graph.op(Op::Cos, &[angle]), graph.op(Op::Sin, &[angle])));
        let scaled: Vec<NodeId> = point.iter().zip(self.scale).map(|(p, k)| graph.op(Op::Mul, &[*p, k])).collect();
        let &[px, py, pz] = scaled.as_slice() else { return point };
        // Turned in a plane: the first coordinate toward the second.
        let mut turn = |(c, s): (NodeId, NodeId), a: NodeId, b: NodeId| {
            let [ca, sb, sa, cb] = [(c, a), (s, b), (s, a), (c, b)].map(|(k, v)| graph.op(Op::Mul, &[k, v]));
            (graph.op(Op::Sub, &[ca, sb]), graph.op(Op::Add, &[sa, cb]))
        };
        let (py, pz) = turn(x, py, pz);
        let (pz, px) = turn(y, pz, px);
        let (px, py) = turn(z, px, py);
        let mut at = [px, py, pz];
        for (c, origin) in at.iter_mut().zip(self.translate) {
            *c = graph.op(Op::Add, &[*c, origin]);
        }
        at
    }
}
