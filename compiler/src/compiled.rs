//! What the compiler hands over: a module of WGSL, what a host must write into its uniform block, and the scene around it.

pub use crate::emit::Formulas;
pub use crate::emit::table::{ModuleTables, Tables};
pub use crate::frame::{CAPTURE_SIZES, Camera, CameraNodes, CaptureNodes, Fog, Frame, Light, LightKind, LightNodes, MAX_BOUNCES, Projection, SceneBlocks, Shadow, Sky, Tone};

use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::emit::tracer::Ways;
use crate::followed::Followed;
use crate::functions::{self, Functions, Summary};
use crate::graph::algebra::Reals;
use crate::outlook;
use crate::pipeline::tidy;
pub use crate::home::Home;
use crate::graph::{multiple_of, Graph, Leaf, Node, NodeId, ShapeId};
pub use crate::loader::{Loader, MemoryLoader};
use crate::source::{Sources, Span};
use crate::srgb::{decode, encode};
use crate::syntax::ast::Type;
use crate::syntax::revise::Written;
use std::ops::Range;
use std::sync::Arc;

/// Functions that a module can hold, in the order in which they are emitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Export {
    /// `sf_field(p: vec3f) -> f32`
    Field,
    /// `sf_bound(p: vec3f) -> f32`
    Bound,
    /// `sf_distance(p: vec3f) -> f32`
    Distance,
    /// `sf_gradient(p: vec3f) -> vec4f`
    Gradient,
    /// `sf_trace(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32, footprint: f32) -> sf_Hit`
    Trace,
    /// `sf_shadow(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32, softness: f32) -> f32`
    Shadow,
    /// `sf_collision(center: vec3f, radius: f32) -> sf_Contact`
    Collision,
    /// `sf_occlusion(p: vec3f, normal: vec3f) -> f32`
    Occlusion,
    /// `sf_surface(p: vec3f, normal: vec3f) -> sf_Surface`
    Surface,
}

impl Export {
    /// All of them, in their order.
    pub const ALL: [Export; 9] = [
        Export::Field,
        Export::Bound,
        Export::Distance,
        Export::Gradient,
        Export::Trace,
        Export::Shadow,
        Export::Collision,
        Export::Occlusion,
        Export::Surface,
    ];

    /// The name on the command line, and in the module after its prefix.
    pub fn name(self) -> &'static str {
        match self {
            Export::Field => "field",
            Export::Bound => "bound",
            Export::Distance => "distance",
            Export::Gradient => "gradient",
            Export::Trace => "trace",
            Export::Shadow => "shadow",
            Export::Collision => "collision",
            Export::Occlusion => "occlusion",
            Export::Surface => "surface",
        }
    }
}

/// What a module shall hold and how it is named.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// The functions asked for. What they call is emitted too.
    pub exports: Vec<Export>,
    /// Before every name of the module.
    pub prefix: String,
    /// Bind group of the uniform block.
    pub group: u32,
    /// Binding of the uniform block.
    pub binding: u32,
    /// Values of parameters that replace those in the text, by the name that a person sees (`spin`, `column.flutes`):
    /// components of a number, colour or vector.
    pub set: Vec<(String, Vec<f64>)>,
    /// Choices of parameters that replace those in the text: the parameter's name and the choice's.
    pub choose: Vec<(String, String)>,
    /// Whether a formula of which no bound can be proven is an error.
    pub strict: bool,
    /// Whether what depends on parameters and time alone is computed in the shader, so that a host need write nothing else into the
    /// uniform block; else it has fields there ([`UniformSource::Formula`]).
    pub live_in_shader: bool,
    /// Radius about the origin within which a scene is drawn that does not say it: what is given, else 100 or what all that is solid needs.
    pub extent: Option<f64>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            exports: Export::ALL.to_vec(),
            prefix: "sf_".to_owned(),
            group: 0,
            binding: 0,
            set: Vec::new(),
            choose: Vec::new(),
            strict: false,
            live_in_shader: false,
            extent: None,
        }
    }
}

/// A parameter as a person sees it.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// `spin`, or `column.flutes` for one of an import.
    pub name: String,
    /// `Bool`, `Int`, `Float`, `Vec(n)` or `Color`; `Str` where it chooses among names.
    pub ty: Type,
    /// Whether it is shown in degrees (its numbers are radians).
    pub degrees: bool,
    /// Its components at the start. A choice: the index of the name that the text chooses.
    pub default: Vec<f64>,
    /// Least value of each component.
    pub min: Vec<f64>,
    /// Greatest value of each component.
    pub max: Vec<f64>,
    /// The names that it chooses among; empty for numbers.
    pub choices: Vec<String>,
    /// What a person should know of it.
    pub description: Option<String>,
    /// Where it is declared.
    pub span: Span,
    /// Index of its first component in [`Graph::parameters`]; a choice has none, and recompiles.
    pub first: Option<u32>,
}

impl Parameter {
    /// The indices of its components in [`Graph::parameters`]; a choice has none.
    pub fn components(&self) -> Range<u32> {
        self.first.map_or(0..0, |first| first..first + self.default.len() as u32)
    }

    /// The name that the text chooses; none where it does not choose among names.
    pub fn choice(&self) -> Option<&str> {
        self.choices.get(*self.default.first()? as usize).map(String::as_str)
    }

    /// Decimals with which a ten-thousandth of its range can be told, as a person reads it: angles in degrees.
    pub fn decimals(&self, component: usize) -> usize {
        let ends = self.min.get(component).zip(self.max.get(component));
        let range = ends.map_or(0.0, |(min, max)| (max - min) / self.unit());
        match range > 0.0 && self.ty != Type::Int {
            true => (4.0 - range.log10()).ceil().clamp(1.0, 9.0) as usize,
            false if self.ty == Type::Int => 0,
            false => 3,
        }
    }

    /// How much 1 is, as a person reads it.
    pub fn unit(&self) -> f64 {
        if self.degrees { 1f64.to_radians() } else { 1.0 }
    }

    /// A number in a person's unit, with no more digits than its range tells apart and no zeros at the end.
    pub fn digits(&self, component: usize, shown: f64) -> String {
        let decimals = self.decimals(component);
        let text = format!("{shown:.decimals$}");
        let short = if decimals > 0 { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
        if short == "-0" { "0".to_owned() } else { short.to_owned() }
    }

    /// A number, vector, condition or colour as the text may have it, within the range.
    pub fn written(&self, value: &[f64]) -> Written {
        let number = |(i, value): (usize, &f64)| {
            let shown = value / self.unit();
            let short = self.digits(i, shown);
            let read = short.parse::<f64>().unwrap_or(shown) * self.unit();
            let within = self.min.get(i).is_none_or(|min| read >= *min) && self.max.get(i).is_none_or(|max| read <= *max);
            let unit = if self.degrees { "deg" } else { "" };
            if within { format!("{short}{unit}") } else { format!("{shown}{unit}") }
        };
        let all = |value: &[f64]| match value {
            [one] => number((0, one)),
            many => format!("({})", many.iter().enumerate().map(number).collect::<Vec<_>>().join(", ")),
        };
        let range = || Some(format!("{}..{}", all(&self.min), all(&self.max)));
        match (&self.ty, value) {
            (Type::Bool, [on]) => Written::Value((*on != 0.0).to_string(), None),
            (Type::Color, _) => Written::Value(self.color(value).unwrap_or_else(|| all(value)), None),
            _ => Written::Value(all(value), range()),
        }
    }

    /// A colour by its bytes, where it lies within those and its bytes within its range.
    fn color(&self, value: &[f64]) -> Option<String> {
        let bytes: Vec<f64> = value.iter().map(|c| (255.0 * encode(*c)).round()).collect();
        let mut ends = self.min.iter().zip(&self.max).zip(value.iter().zip(&bytes));
        let fits = ends.all(|((min, max), (c, byte))| (0.0..=1.0).contains(c) && (*min..=*max).contains(&decode(byte / 255.0)));
        fits.then(|| bytes.iter().fold("#".to_owned(), |text, byte| format!("{text}{:02x}", *byte as u8)))
    }
}

/// Values of what is live: time and the parameters' components.
#[derive(Clone, Debug, PartialEq)]
pub struct Live {
    /// Seconds.
    pub time: f64,
    /// A value for each of [`Graph::parameters`].
    pub components: Vec<f64>,
    /// Factors found for values of the parameters; they count only while the parameters still have these values.
    pub followed: Option<Followed>,
    /// Factors for the whole ranges that a longer search found, one for each of [`Graph::factors`]; or none.
    pub tightened: Vec<f64>,
}

impl Live {
    /// Time zero and every parameter of a graph at its default.
    pub fn start(graph: &Graph) -> Self {
        Self { time: 0.0, components: graph.parameters.iter().map(|p| p.default).collect(), followed: None, tightened: Vec::new() }
    }

    /// Values of nodes that read nothing but parameters and time.
    pub fn values(&self, graph: &Graph, nodes: &[NodeId]) -> Vec<f64> {
        graph.evaluate(
            &mut Reals,
            nodes,
            |_, leaf| match leaf {
                Leaf::Time => self.time,
                Leaf::Parameter(i) => self.component(graph, i),
                _ => 0.0,
            },
            |_, _, _, _| 0.0,
        )
    }

    /// A component of a parameter, clamped to its range; its default where there is none.
    pub fn component(&self, graph: &Graph, index: u32) -> f64 {
        let Some(known) = graph.parameters.get(index as usize) else { return 0.0 };
        let value = self.components.get(index as usize).copied().unwrap_or(known.default);
        if value.is_finite() { value.clamp(known.min, known.max) } else { known.default }
    }
}

/// Where a field of the uniform block takes its value from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum UniformSource {
    /// The scene point at which `p` is zero: a `vec3f`.
    Origin,
    /// Seconds.
    Time,
    /// So many components from this index of [`Graph::parameters`] on.
    Parameter(u32),
    /// How far occlusion reaches.
    OcclusionReach,
    /// How strong occlusion is, 0 to 1.
    OcclusionStrength,
    /// The multiple of a factor: an index into [`Graph::factors`]; the value is one over its Lipschitz factor, rounded down.
    Factor(u32),
    /// What is computed from time and parameters: a field of [`Module::formulas`].
    Formula(u32),
}

/// A field of the uniform block.
#[derive(Clone, Debug, PartialEq)]
pub struct Uniform {
    /// Its name in the struct.
    pub name: String,
    /// Where its value comes from.
    pub source: UniformSource,
    /// Number of 32-bit floats: 1 to 4.
    pub components: u32,
    /// Byte offset in the block.
    pub offset: u32,
}

/// An emitted module.
#[derive(Clone, Debug)]
pub struct Module {
    /// The text.
    pub wgsl: String,
    /// The functions in it that were asked for or are needed by them.
    pub exports: Vec<Export>,
    /// Name of the uniform block's struct and variable, empty where there is none.
    pub uniform_name: String,
    /// Fields of the uniform block.
    pub uniforms: Vec<Uniform>,
    /// What the host computes for them once a frame.
    pub formulas: Arc<Formulas>,
    /// The same for people and other hosts, as the comment at the module's head has it: a line each, in their order, `of_melt = melt * 0.25`;
    /// then what the operations in them are that not every language has, `in which square(a) is: …`.
    pub computed: Vec<String>,
    /// Size of the uniform block in bytes, a multiple of 16; 0 where there is none.
    pub uniform_size: u32,
    /// Operations of the kernel in one evaluation of the field, and of the bound.
    pub operations: (usize, usize),
    /// What was left out of the module, and why.
    pub skipped: Vec<String>,
    /// What rounding in 32 bits grows with.
    pub rounding: Rounding,
    /// Where large numbers cancel each other, where they make the unit of rounding more than 1 and that is known.
    pub cancels: Option<NodeId>,
    /// More text, for what draws meshes: a function `sf_mesh_0(p: vec3f, normal: vec3f) -> sf_Surface` and so on for each of
    /// [`Functions::meshes`], and `sf_mesh_layers_0` with its struct for one that is layered. `p` is in the mesh's own space.
    pub meshes: String,
    /// Whether the bound is the estimate of the distance itself.
    pub one: bool,
    /// What its tracer is told.
    pub ways: Ways,
    /// The unions of many operands, which are tables; none in most modules.
    pub tables: Option<Arc<ModuleTables>>,
}

/// What rounding in 32 bits grows with where a module computes the field: with coordinates, the way of a ray, and a length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rounding {
    /// The axes along which it grows with the distance from the scene's middle. Along the others it grows with that from the module's own origin
    /// alone: all that is read of the scene's point there are ways from places far out.
    pub reads_scene: [bool; 3],
    /// The length, which stands for what else is added in the formulas: 1 for scenes of ordinary size, less where all of a scene is smaller, and more
    /// where large numbers cancel each other.
    pub unit: f64,
}

impl Rounding {
    /// That of formulas of ordinary size, of which no axis is read as it is.
    pub const ORDINARY: Self = Self { reads_scene: [false; 3], unit: 1.0 };
}

impl Module {
    /// The text for a device of our own: without the comment at its head, which names places in the source, and with tables as buffers
    /// ([`ModuleTables`]).
    pub fn code(&self) -> &str {
        if let Some(tables) = &self.tables {
            return tables.code();
        }
        self.wgsl.get(self.head().len()..).unwrap_or(&self.wgsl)
    }

    /// The comment at its head.
    pub fn head(&self) -> &str {
        let head: usize = self.wgsl.split_inclusive('\n').take_while(|line| line.starts_with("//")).map(str::len).sum();
        self.wgsl.get(..head).unwrap_or("")
    }

    /// The module with its tables as storage buffers, which its comment names, and the bytes of the two; nothing where it has no tables. `options`: those
    /// that it was emitted with.
    pub fn with_buffers(&self, options: &Options) -> Option<(Module, [Vec<u8>; 2])> {
        let tables = self.tables.as_ref()?;
        let mut rows: Vec<u8> = tables.tables.rows.iter().flatten().flat_map(|number| number.to_le_bytes()).collect();
        // No buffer may be empty.
        rows.resize(rows.len().max(16), 0);
        let lists = tables.lists().iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<u8>>();
        let (group, binding) = (options.group, u64::from(options.binding));
        let wgsl = format!(
            "{}//\n// The tables of its unions are two storage buffers of group {group}, read only, little-endian:\n//\n\
             //   binding {}: array<vec4f>, {} bytes\n//   binding {}: array<u32>, {} bytes\n{}",
            self.head(),
            binding + 1,
            rows.len(),
            binding + 2,
            lists.len(),
            tables.code(),
        );
        Some((Module { wgsl, ..self.clone() }, [rows, lists]))
    }
}

/// Operations of a field of which the box is not looked for once more.
const LONG: usize = 5000;
/// A look that enters more shapes than these takes minutes.
const MOST_ENTERED: f64 = 2e6;

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

    /// What is wrong with what a camera sees at one moment: that of this name, or the first. That nothing is solid says why nothing is seen.
    pub fn outlook(&self, live: &Live, name: Option<&str>) -> Option<Diagnostic> {
        let is_said = self.diagnostics.iter().any(|d| d.code == Code::NothingSolid);
        outlook::outlook(self.compiled.as_ref()?, live, name).filter(|d| !is_said || d.code != Code::NothingSeen)
    }

    /// Adds what is wrong with what the cameras see: that takes a look at the scene through each, and some milliseconds.
    pub fn look(&mut self) {
        let Some(compiled) = &self.compiled else { return };
        let live = compiled.live();
        let is_said = self.diagnostics.iter().any(|d| d.code == Code::NothingSolid);
        let cameras = 0..compiled.blocks.cameras.len().max(1);
        let found: Vec<Diagnostic> = cameras.filter_map(|which| outlook::through(compiled, &live, which)).filter(|d| !is_said || d.code != Code::NothingSeen).collect();
        let coarse = outlook::few_digits(compiled, &live);
        self.diagnostics.extend(found.into_iter().chain(coarse));
        tidy(&mut self.diagnostics);
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
        let occlusion = self.frame(live).ambient_occlusion;
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
                };
                let at = (uniform.offset + 4 * i) as usize;
                if let Some(slot) = bytes.get_mut(at..at + 4) {
                    slot.copy_from_slice(&value.to_le_bytes());
                }
            }
        }
        bytes
    }
}
