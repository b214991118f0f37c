//! What a module has that draws the scene by itself: the shading, what surrounds the scene as values of parameters and time, and the entry points.

use crate::blocks::{LightNodes, SceneBlocks, Shadow};
use crate::emit::body::{Body, Space};
use crate::emit::code::{Code, ExprId};
use crate::emit::error::EmitError;
use crate::emit::library;
use crate::emit::names::{Scope, numbered, vector_type};
use crate::emit::plan::{Plan, Plans};
use crate::emit::tokens;
use crate::emit::write::{self, Context};
use crate::frame::{Frame, GROUND, LightKind, MAX_BOUNCES, MAX_LIGHTS, PLAIN_SKY, default_light};
use crate::functions::Functions;
use crate::graph::kernel::Op;
use crate::graph::simplify::Terms;
use crate::graph::{Graph, NodeId};
use crate::interface::{Colors, Export, Rounding, UniformSource, ViewField};
use crate::shading::{self, Parts, Shading};
use rustc_hash::FxHashMap;
use std::f64::consts::LN_2;
use std::fmt::Write;

/// What of the scene's surroundings is drawn.
pub struct Drawing<'a> {
    shading: Shading,
    blocks: &'a SceneBlocks,
    frame: &'a Frame,
    colors: Colors,
    parallel: bool,
    /// Of all that is read of the blocks.
    plan: Plan,
    nodes: Vec<NodeId>,
}

/// What the view is where rays come from the eye, and where they go side by side.
const PERSPECTIVE: &str = "scene.tan_half_fov = tan(clamp(0.5 * sf_uniforms.view_fov, 1e-4, 1.55));";
const PARALLEL: &str = "scene.away = select(1.0, far, far > 1e-9);\n    scene.tan_half_fov = 0.5 * sf_uniforms.view_height / scene.away;";
const DEPTH: &str = "far * (ahead - near) / (max(ahead, 1e-20) * (far - near))";
const PARALLEL_DEPTH: &str = "(ahead - near) / (far - near)";

/// So many levels has a channel of a screen's colour.
const LEVELS: f64 = 255.0;

impl<'a> Drawing<'a> {
    /// Of a scene that is `frame` at the start. Images, meshes and balls are not drawn: a scene with images for its sky is lit as one without.
    pub fn new(graph: &Graph, blocks: &'a SceneBlocks, functions: &Functions, frame: &'a Frame, colors: Colors, plans: &mut Plans) -> Self {
        let shading = Shading::of(graph, &SceneBlocks { environment: None, capture: None, ..blocks.clone() }, functions);
        let parallel = blocks.cameras.first().is_some_and(|camera| camera.orthographic);
        let mut nodes: Vec<NodeId> = Vec::new();
        let mut read = |of: &[NodeId]| nodes.extend_from_slice(of);
        blocks.sky.iter().for_each(|(zenith, horizon)| [zenith, horizon].into_iter().for_each(|color| read(color)));
        for light in blocks.lights.iter().take(MAX_LIGHTS) {
            [&light.vector, &light.color].into_iter().for_each(|vector| read(vector));
            read(&[light.intensity]);
            light.shadow.1.iter().for_each(|node| read(&[*node]));
        }
        blocks.fog.iter().for_each(|(color, density)| {
            read(color);
            read(&[*density]);
        });
        [blocks.shadows, blocks.max_distance, blocks.exposure, blocks.reflections].iter().flatten().for_each(|node| read(&[*node]));
        let plan = plans.plan(&nodes, [].into());
        // A lens is a point where one picture is all.
        Self { shading: Shading { optics: parallel, ..shading }, blocks, frame, colors, parallel, plan, nodes }
    }

    /// What of the view the module is told.
    pub fn view(&self) -> Vec<ViewField> {
        let other = if self.parallel { ViewField::Fov } else { ViewField::Height };
        ViewField::ALL.into_iter().filter(|field| *field != other).collect()
    }

    /// The functions that it calls.
    pub fn exports(&self) -> Vec<Export> {
        let Shading { shadows, occlusion, glass, emitters, .. } = self.shading;
        let all = [(true, Export::Trace), (true, Export::Gradient), (true, Export::Surface), (shadows, Export::Shadow), (occlusion, Export::Occlusion), (glass || emitters, Export::Bound)];
        all.into_iter().filter_map(|(is_needed, export)| is_needed.then_some(export)).collect()
    }

    /// Writes all of it.
    pub fn write(&self, context: &mut Context, body: &mut Body, rounding: Rounding, text: &mut String) -> Result<(), EmitError> {
        self.view().into_iter().for_each(|field| context.uniforms.read(UniformSource::View(field)));
        context.uniforms.read(UniformSource::Origin);
        let around = self.around(context, body, text)?;
        let shading = self.text(&around, rounding);
        let items = tokens::items(&shading);
        let needed = tokens::needed(&items, &["vertex", "fragment"]);
        let names = module_names(needed.iter().map(|item| item.name), context, text);
        for item in needed {
            text.push('\n');
            text.push_str(&tokens::renamed(&library::prefixed(item.text, context.prefix), &names));
        }
        Ok(())
    }

    /// The shading, for a scene whose surroundings are these assignments.
    fn text(&self, around: &str, rounding: Rounding) -> String {
        let Shading { lights, reflections, .. } = self.shading;
        let (linear, step) = match self.colors {
            Colors::Screen => (false, 1.0 / LEVELS),
            Colors::Linear | Colors::Light => (true, 0.0),
        };
        let film = match self.colors {
            Colors::Light => vec![shading::LIGHT_FILM],
            Colors::Screen | Colors::Linear => vec![self.shading.tone(), shading::FILM, shading::DITHER, shading::TARGET],
        };
        let (projection, depth) = if self.parallel { (PARALLEL, PARALLEL_DEPTH) } else { (PERSPECTIVE, DEPTH) };
        let [x, y, z] = rounding.reads_scene.map(|read| f32::from(u8::from(read)));
        let mut sections = vec![
            format!(
                "// How many lights there are.\nconst scene_lights: u32 = {lights}u;\n\n// How often a mirrored ray is followed at most.\nconst scene_bounces: u32 = {reflections}u;\n\n\
                 // Whether the target encodes what it is given, and what its levels are apart: 0 where that is not to be seen.\n\
                 const scene_linear: bool = {linear};\nconst scene_step: f32 = {step:?};\n"
            ),
            shading::BASE.replace("array<SceneLight, 16>", &format!("array<SceneLight, {lights}>")),
            shading::TRIANGLE.to_owned(),
            self.shading.eye().to_owned(),
        ];
        let parts = Parts { film, sky: shading::SKY, mirror: shading::MIRROR, lit: None, met: vec![shading::MET.into(), shading::MET_PLAIN.into()] };
        sections.extend(self.shading.sections(parts).into_iter().map(std::borrow::Cow::into_owned));
        sections.push(shading::VIEW.to_owned());
        sections.push(shading::DRAW.replace("PROJECTION", projection).replace("DEPTH", depth));
        sections.push(format!(
            "// Takes what surrounds the scene at this moment.\nfn scene_gather() {{\n{around}    scene.rounding = vec3f({x:?}, {y:?}, {z:?});\n    scene.unit = {:?};\n    scene.extent = {:?};\n}}\n",
            rounding.unit as f32,
            self.frame.extent as f32
        ));
        sections.join("\n")
    }

    /// Writes the function that gives what surrounds the scene. The answer: the lines that take it over.
    fn around(&self, context: &mut Context, body: &mut Body, text: &mut String) -> Result<String, EmitError> {
        let prefix = context.prefix;
        body.clear();
        let zero = body.constant(0.0);
        let space = Space { point: [zero; 3], normal: None, variables: Vec::new() };
        let results = body.open(context.plans, context.graph, &self.plan, &space, &context.uniforms)?;
        let known: FxHashMap<NodeId, ExprId> = self.nodes.iter().copied().zip(results.iter().copied()).collect();
        let mut values = Values { body, known: &known };
        let mut fields: Vec<(String, ExprId)> = Vec::new();
        let mut lines = String::new();
        let mut take = |name: String, to: &str, value: ExprId| {
            let _ = writeln!(lines, "    scene.{to} = around.{name};");
            fields.push((name, value));
        };
        let (zenith, horizon) = match &self.blocks.sky {
            Some((zenith, horizon)) => (values.three(zenith), values.three(horizon)),
            None => (values.constants(PLAIN_SKY.zenith), values.constants(PLAIN_SKY.horizon)),
        };
        let lamps = self.lamps(&mut values);
        let far = lamps.iter().filter(|lamp| lamp.kind == 0).fold(values.scaled(horizon, GROUND.0), |sum, lamp| {
            let [_, y, _] = lamp.vector;
            let zero = values.body.constant(0.0);
            let high = values.body.op(Op::Max, &[y, zero]);
            let light = values.scaled(lamp.radiance, GROUND.1).map(|c| values.body.op(Op::Mul, &[c, high]));
            values.sum(sum, light)
        });
        for (name, vector) in [("zenith", zenith), ("horizon", horizon), ("ground", far)] {
            take(name.to_owned(), name, values.body.vector(&vector));
        }
        let exposure = self.blocks.exposure.map_or(0.0, |_| LN_2);
        let stops = values.optional(self.blocks.exposure, 0.0);
        let by = values.body.constant(exposure);
        let stops = values.body.op(Op::Mul, &[stops, by]);
        take("exposure".to_owned(), "exposure", values.body.op(Op::Exp, &[stops]));
        let distance = values.optional(self.blocks.max_distance, self.frame.max_distance);
        take("max_distance".to_owned(), "max_distance", values.at_least(distance, 1e-3));
        if let Some((color, density)) = &self.blocks.fog {
            let color = values.three(color);
            take("fog".to_owned(), "fog", values.body.vector(&color));
            let density = values.one(*density);
            take("density".to_owned(), "density", values.at_least(density, 0.0));
        }
        let mut followed = None;
        if self.shading.reflections > 0 {
            let times = values.optional(self.blocks.reflections, self.shading.reflections.into());
            let rounded = values.body.op(Op::Round, &[times]);
            let times = values.at_least(rounded, 0.0);
            let most = values.body.constant(MAX_BOUNCES.into());
            followed = Some(values.body.op(Op::Min, &[times, most]));
        }
        if let Some(times) = followed {
            fields.push(("reflections".to_owned(), times));
            lines.push_str("    scene.reflections = u32(around.reflections);\n");
        }
        for (i, lamp) in lamps.iter().enumerate() {
            let [vector, radiance, softness] = ["vector", "radiance", "softness"].map(|name| numbered(name, i + 1));
            let origin = if lamp.kind > 0 { " - sf_uniforms.origin".to_owned() } else { String::new() };
            let _ = writeln!(lines, "    scene.lights[{i}] = SceneLight(around.{vector}{origin}, {}u, around.{radiance}, around.{softness});", lamp.kind);
            fields.push((vector, values.body.vector(&lamp.vector)));
            fields.push((radiance, values.body.vector(&lamp.radiance)));
            fields.push((softness, lamp.softness));
        }
        let _ = write!(text, "\n// What surrounds the scene at this moment: linear colours, and each light as it meets a surface.\nstruct {prefix}Around {{\n");
        for (name, value) in &fields {
            let _ = writeln!(text, "  {name}: {},", vector_type(values.body.components(*value)));
        }
        let _ = write!(text, "}}\n\nfn {prefix}around() -> {prefix}Around {{\n");
        let list: Vec<ExprId> = fields.iter().map(|(_, value)| *value).collect();
        let result = body.add(Code::Around, &list);
        write::write(context, body, result, &[], text);
        text.push_str("}\n");
        // Names of the module get their prefix with the rest of the shading.
        Ok(format!("    let around = sf_around();\n{lines}"))
    }

    /// The lights, or the one of a scene that has none; as `reference::shade::lamps` makes them.
    fn lamps(&self, values: &mut Values) -> Vec<Lamp> {
        let mut lamps: Vec<Lamp> = self.blocks.lights.iter().take(MAX_LIGHTS).map(|light| values.lamp(light, self.blocks.shadows)).collect();
        if lamps.is_empty() {
            let light = default_light();
            let softness = if let Shadow::Soft(softness) = light.shadow { softness } else { -1.0 };
            let (LightKind::Direction(vector) | LightKind::Position(vector)) = light.kind;
            let vector = values.constants(vector);
            let softness = values.body.constant(softness);
            let softness = values.where_thrown(softness, self.blocks.shadows);
            lamps.push(Lamp { vector: values.opposite(vector), kind: 0, radiance: values.constants(light.radiance), softness });
        }
        lamps
    }
}

/// A light as `shading/base.wgsl` has it.
struct Lamp {
    vector: [ExprId; 3],
    kind: u32,
    radiance: [ExprId; 3],
    softness: ExprId,
}

/// What is computed of the values of nodes.
struct Values<'b> {
    body: &'b mut Body,
    known: &'b FxHashMap<NodeId, ExprId>,
}

impl Values<'_> {
    fn one(&mut self, node: NodeId) -> ExprId {
        self.known.get(&node).copied().unwrap_or_else(|| self.body.constant(0.0))
    }

    fn three(&mut self, nodes: &[NodeId; 3]) -> [ExprId; 3] {
        nodes.map(|node| self.one(node))
    }

    fn constants(&mut self, values: [f64; 3]) -> [ExprId; 3] {
        values.map(|value| self.body.constant(value))
    }

    fn optional(&mut self, node: Option<NodeId>, otherwise: f64) -> ExprId {
        match node {
            Some(node) => self.one(node),
            None => self.body.constant(otherwise),
        }
    }

    fn at_least(&mut self, value: ExprId, least: f64) -> ExprId {
        let least = self.body.constant(least);
        self.body.op(Op::Max, &[value, least])
    }

    fn scaled(&mut self, vector: [ExprId; 3], by: f64) -> [ExprId; 3] {
        let by = self.body.constant(by);
        vector.map(|c| self.body.op(Op::Mul, &[c, by]))
    }

    fn sum(&mut self, a: [ExprId; 3], b: [ExprId; 3]) -> [ExprId; 3] {
        let [[ax, ay, az], [bx, by, bz]] = [a, b];
        [(ax, bx), (ay, by), (az, bz)].map(|(a, b)| self.body.op(Op::Add, &[a, b]))
    }

    /// The direction against a vector; up where that is none.
    fn opposite(&mut self, vector: [ExprId; 3]) -> [ExprId; 3] {
        let length = self.body.op(Op::Length3, &vector);
        let zero = self.body.constant(0.0);
        let is_none = self.body.op(Op::Le, &[length, zero]);
        let up = self.constants([0.0, 1.0, 0.0]);
        let [x, y, z] = vector;
        let [ux, uy, uz] = up;
        [(x, ux), (y, uy), (z, uz)].map(|(c, up)| {
            let share = self.body.op(Op::Div, &[c, length]);
            let against = self.body.op(Op::Neg, &[share]);
            self.body.op(Op::Select, &[is_none, up, against])
        })
    }

    /// How soft a shadow is where a scene has shadows at all.
    fn where_thrown(&mut self, softness: ExprId, shadows: Option<NodeId>) -> ExprId {
        let Some(node) = shadows else { return softness };
        let (condition, none) = (self.one(node), self.body.constant(-1.0));
        self.body.op(Op::Select, &[condition, softness, none])
    }

    fn lamp(&mut self, light: &LightNodes, shadows: Option<NodeId>) -> Lamp {
        let (vector, color, intensity) = (self.three(&light.vector), self.three(&light.color), self.one(light.intensity));
        let radiance = color.map(|c| self.body.op(Op::Mul, &[c, intensity]));
        let number = |values: &mut Self, otherwise| values.optional(light.shadow.1, otherwise);
        let (softness, is_sized) = match light.shadow.0 {
            Shadow::None => (self.body.constant(-1.0), false),
            Shadow::Hard | Shadow::Map => (self.body.constant(0.0), false),
            Shadow::Soft(k) => {
                let k = number(self, k);
                (self.at_least(k, 0.1), false)
            }
            Shadow::Sized(size) => {
                let size = number(self, size);
                let zero = self.body.constant(0.0);
                let is_point = self.body.op(Op::Le, &[size, zero]);
                let (above, below) = if light.position {
                    (self.body.constant(1.0), size)
                } else {
                    let most = self.body.constant(1.5);
                    let angle = self.at_least(size, 1e-6);
                    let angle = self.body.op(Op::Min, &[angle, most]);
                    (self.body.op(Op::Cos, &[angle]), self.body.op(Op::Sin, &[angle]))
                };
                let sharpness = self.body.op(Op::Div, &[above, below]);
                (self.body.op(Op::Select, &[is_point, zero, sharpness]), light.position)
            }
        };
        let softness = if light.shadow.0 == Shadow::None { softness } else { self.where_thrown(softness, shadows) };
        let vector = if light.position { vector } else { self.opposite(vector) };
        Lamp { vector, kind: u32::from(light.position) + u32::from(is_sized), radiance, softness }
    }
}

/// A name of the module for each of the shading's items: with its prefix, and another than all that is written already.
fn module_names<'t>(items: impl Iterator<Item = &'t str>, context: &mut Context, text: &str) -> FxHashMap<&'t str, String> {
    let taken = tokens::names(text);
    let prefix = context.prefix;
    let entry = |name: &str| matches!(name, "vertex" | "fragment");
    let give = |scope: &mut Scope, name: &str| loop {
        // The entry points are known by their names, which nothing else has.
        let given = if entry(name) { format!("{prefix}{name}") } else { scope.give(&format!("{prefix}{name}")) };
        if entry(name) || !taken.contains(given.as_str()) {
            return given;
        }
    };
    items.map(|name| (name, give(&mut context.module, name))).collect()
}
