//! Parameters and the blocks around a scene: cameras, lights, environment, rendering, physics, meshes.

use super::elsewhere;
use super::load::ItemRef;
use super::value::Value;
use super::{Elaborated, Elaborator, Env, Stop};
use crate::blocks::{LightNodes, SceneBlocks, Shadow};
use crate::interface::Parameter;
use crate::diagnostic::{Code, Diagnostic};
use crate::graph::kernel::Op;
use crate::graph::{Leaf, NodeId, ParameterComponent};
use crate::blocks::MeshNodes;
use crate::blocks::{BallsNodes, PhysicsNodes};
use crate::source::Span;
use crate::syntax::ast::{BlockKind, Entry, Expr, ExprKind, ItemKind, Name, Type};
use rustc_hash::FxHashMap;

const DEFAULT_EXTENT: f64 = 100.0;

impl SceneBlocks {
    /// Every node of the blocks.
    pub fn nodes(&self) -> Vec<NodeId> {
        let mut nodes = Vec::new();
        for camera in &self.cameras {
            nodes.extend(camera.eye.iter().chain(&camera.target).flatten());
            nodes.push(camera.fov);
            nodes.extend(camera.up.iter().flatten().chain(&camera.height).chain(&camera.lens).chain(&camera.focus));
        }
        for light in &self.lights {
            nodes.extend(light.vector.iter().chain(&light.color));
            nodes.push(light.intensity);
            nodes.extend(light.shadow.1);
        }
        if let Some((zenith, horizon)) = &self.sky {
            nodes.extend(zenith.iter().chain(horizon));
        }
        if let Some((reach, strength)) = self.ambient_occlusion {
            nodes.extend([reach, strength]);
        }
        nodes.extend(self.bloom);
        nodes.extend(self.fog.iter().flat_map(|(color, density)| color.iter().chain([density])));
        nodes.extend(self.capture.iter().flat_map(|capture| capture.place));
        nodes.extend(self.shadows.iter().chain(&self.max_distance).chain(&self.exposure).chain(&self.reflections));
        nodes.extend(self.physics.iter().flat_map(PhysicsNodes::nodes));
        nodes.extend(self.balls.iter().flat_map(BallsNodes::nodes));
        nodes.extend(self.meshes.iter().flat_map(MeshNodes::nodes));
        nodes
    }
}

/// The keys that a block knows.
pub fn keys(kind: BlockKind) -> &'static [&'static str] {
    match kind {
        BlockKind::Camera => &["eye", "target", "fov", "up", "projection", "height", "lens", "focus"],
        BlockKind::Light => &["direction", "position", "color", "intensity", "shadow", "size"],
        BlockKind::Environment => &["sky", "capture", "size"],
        BlockKind::Render => &[
            "ambient_occlusion", "shadows", "reflections", "max_distance", "extent", "exposure", "tone", "fog", "bloom", "unit",
        ],
        BlockKind::Physics => {
            &["gravity", "restitution", "friction", "rolling", "substeps", "bounds"]
        }
        BlockKind::Balls => &["count", "radius", "spawn", "velocity", "seed", "material", "color_by_speed"],
        BlockKind::Mesh => &["translate", "rotate", "scale", "material"],
    }
}

/// The word that begins a block.
pub fn block_words(kind: BlockKind) -> &'static str {
    match kind {
        BlockKind::Camera => "camera",
        BlockKind::Light => "light",
        BlockKind::Environment => "environment",
        BlockKind::Render => "render",
        BlockKind::Physics => "physics",
        BlockKind::Balls => "balls",
        BlockKind::Mesh => "mesh",
    }
}

impl Elaborator<'_> {
    /// The value of a parameter, which is met here for the first time or again.
    pub fn parameter(&mut self, item: ItemRef) -> Elaborated<Value> {
        match self.parameter_values.get(&item) {
            Some(Some(known)) => return known.clone(),
            Some(None) => {
                let modules = self.modules;
                let Some(name) = modules.item(item).and_then(super::load::item_name) else {
                    return Err(Stop);
                };
                return Err(self.error(
                    Code::EndlessCall,
                    name.span,
                    format!("the parameter `{}` needs its own value", name.text),
                    "write numbers for its value and its range",
                ));
            }
            None => {}
        }
        self.parameter_values.insert(item, None);
        let value = self.new_parameter(item);
        self.parameter_values.insert(item, Some(value.clone()));
        value
    }

    fn new_parameter(&mut self, item: ItemRef) -> Elaborated<Value> {
        let modules = self.modules;
        let Some(declared) = modules.item(item) else { return Err(Stop) };
        let ItemKind::Param { name, ty, value, domain, description } = &declared.kind else {
            return Err(Stop);
        };
        let env = Env::top(item.module);
        let shown = match modules.module_name(item.module) {
            Some(module) => format!("{module}.{}", name.text),
            None => name.text.to_string(),
        };
        if let Some(Expr { kind: ExprKind::List(choices), .. }) = domain {
            return self.chosen(name, shown, value, choices, description.clone(), &env);
        }
        let default = self.expression(value, &env)?;
        let default = match ty {
            Some((ty, _)) => self.coerce(default, ty, value.span, &env)?,
            None => default,
        };
        let is_color = matches!(value.kind, ExprKind::Color(_)) || matches!(ty, Some((Type::Color, _)));
        let ty = match (&default, ty) {
            (_, Some((ty, _))) => ty.clone(),
            (_, None) if is_color => Type::Color,
            // Without a type, 3 is a float: `int` must be asked for.
            (Value::Number(..), None) => Type::Float,
            (Value::Bool(_), None) => Type::Bool,
            (Value::Vector(v), None) => Type::Vec(v.len() as u8),
            (other, None) => {
                let found = other.describe(&self.graph);
                return Err(self.error(
                    Code::TypeMismatch,
                    value.span,
                    format!("a parameter can't be {found}"),
                    "let it be a number, a vector, a colour, `true` or `false`, or a name out of a list: `param style = doric in [doric, ionic]`",
                ));
            }
        };
        if !matches!(ty, Type::Bool | Type::Int | Type::Float | Type::Vec(_) | Type::Color) {
            return Err(self.error(
                Code::TypeMismatch,
                value.span,
                format!("a parameter can't be {}", super::value::type_words(&ty)),
                "let it be a number, a vector, a colour or a condition",
            ));
        }
        let nodes: Vec<NodeId> = match &default {
            Value::Number(n, _) | Value::Bool(n) => vec![*n],
            Value::Vector(v) => v.to_vec(),
            _ => return Err(Stop),
        };
        let mut defaults = Vec::new();
        for node in &nodes {
            defaults.push(self.to_constant(&Value::number(*node), value.span)?);
        }
        let (min, max) = self.domain(domain.as_ref(), &ty, &defaults, &env)?;
        for ((d, lo), hi) in defaults.iter().zip(&min).zip(&max) {
            // Written in degrees the two ends may differ by a rounding.
            if *d < lo - 1e-9 * lo.abs() || *d > hi + 1e-9 * hi.abs() {
                return Err(self.error(
                    Code::BadRange,
                    value.span,
                    format!("the value {} is outside of its range {}..{}", short(*d), short(*lo), short(*hi)),
                    "write a value within the range, or widen the range",
                ));
            }
        }
        if let Some((_, values)) = self.options.set.iter().find(|(n, _)| *n == shown) {
            for (i, value) in values.iter().enumerate() {
                if let (Some(slot), Some(lo), Some(hi)) = (defaults.get_mut(i), min.get(i), max.get(i))
                    && value.is_finite()
                {
                    *slot = value.clamp(*lo, *hi);
                }
            }
        }
        let first = self.graph.parameters.len() as u32;
        let index = self.parameters.len() as u32;
        for (i, default) in defaults.iter().enumerate() {
            self.graph.parameters.push(ParameterComponent {
                parameter: index,
                component: i as u8,
                default: *default,
                min: min.get(i).copied().unwrap_or(*default),
                max: max.get(i).copied().unwrap_or(*default),
                whole: matches!(ty, Type::Int | Type::Bool),
            });
        }
        let degrees = domain.iter().chain(std::iter::once(value)).any(in_degrees);
        self.parameters.push(Parameter {
            name: shown,
            ty: ty.clone(),
            degrees,
            length: self.written_length([Some(value), domain.as_ref()]),
            default: defaults.clone(),
            min,
            max,
            choices: Vec::new(),
            description: description.clone(),
            span: name.span,
            first: Some(first),
        });
        let leaves: Vec<NodeId> = (0..defaults.len() as u32)
            .map(|i| self.graph.leaf(Leaf::Parameter(first + i)))
            .collect();
        Ok(match (ty, leaves.as_slice()) {
            (Type::Bool, [leaf]) => {
                let half = self.graph.constant(0.5);
                Value::Bool(self.graph.op(Op::Lt, &[half, *leaf]))
            }
            (Type::Int, [leaf]) => Value::Number(*leaf, true),
            (_, [leaf]) => Value::number(*leaf),
            _ => Value::Vector(leaves.into()),
        })
    }

    fn domain(
        &mut self,
        domain: Option<&Expr>,
        ty: &Type,
        defaults: &[f64],
        env: &Env,
    ) -> Elaborated<(Vec<f64>, Vec<f64>)> {
        let n = defaults.len();
        let Some(domain) = domain else {
            return Ok(match ty {
                Type::Bool | Type::Color => (vec![0.0; n], vec![1.0; n]),
                _ => {
                    // A range that a person would try first.
                    let reach = |d: &f64| match *d {
                        0.0 => (-1.0, 1.0),
                        d if d > 0.0 => (0.0, 2.0 * d),
                        d => (2.0 * d, 0.0),
                    };
                    defaults.iter().map(reach).unzip()
                }
            });
        };
        let value = self.expression(domain, env)?;
        let Value::Range(range) = &value else {
            let found = value.describe(&self.graph);
            return Err(self.error(
                Code::BadRange,
                domain.span,
                format!("a range or a list of names is needed after `in`, and this is {found}"),
                "write `in 0..1`",
            ));
        };
        if matches!(ty, Type::Bool) {
            return Err(self.error(
                Code::BadRange,
                domain.span,
                "a condition has no range",
                "leave `in …` out",
            ));
        }
        let mut ends = Vec::new();
        for end in [&range.0, &range.1] {
            let cells = self.to_vector(end, n.max(1), domain.span);
            let cells = match (cells, end) {
                (Ok(cells), _) => cells.to_vec(),
                (Err(Stop), _) => return Err(Stop),
            };
            let mut numbers = Vec::new();
            for cell in cells {
                numbers.push(self.to_constant(&Value::number(cell), domain.span)?);
            }
            ends.push(numbers);
        }
        let (Some(max), Some(min)) = (ends.pop(), ends.pop()) else { return Err(Stop) };
        for (lo, hi) in min.iter().zip(&max) {
            if lo > hi || lo == hi && n == 1 {
                let message = format!("the range {}..{} is empty", short(*lo), short(*hi));
                let help = format!("write the smaller end first: {}..{}", short(*hi), short(*lo));
                let mut said = Diagnostic::new(Code::BadRange, domain.span, message, help);
                if let (ExprKind::Range(from, to), true) = (&domain.kind, lo > hi && n == 1) {
                    let ends = [to, from].map(|end| self.sources.text(end.span));
                    said = said.write(domain.span, ends.join(".."));
                }
                return Err(self.report(said));
            }
        }
        Ok((min, max))
    }

    #[allow(clippy::too_many_arguments)]
    fn chosen(
        &mut self,
        name: &Name,
        shown: String,
        value: &Expr,
        choices: &[Expr],
        description: Option<String>,
        env: &Env,
    ) -> Elaborated<Value> {
        let label = |expr: &Expr| expr.label().unwrap_or_else(|| format!("at {}", expr.span.start));
        let labels: Vec<String> = choices.iter().map(label).collect();
        let written = label(value);
        let twice = choices.iter().zip(&labels).enumerate().find(|(i, (_, name))| labels.iter().take(*i).any(|earlier| earlier == *name));
        if let Some((_, (choice, name))) = twice {
            return Err(self.error(Code::BadRange, choice.span, format!("`{name}` stands twice among the choices"), "leave one of the two out"));
        }
        let asked = self.options.choose.iter().find(|(n, _)| *n == shown).map(|(_, c)| c.clone());
        let wanted = asked.filter(|a| labels.contains(a)).unwrap_or_else(|| written.clone());
        let Some(index) = labels.iter().position(|l| *l == wanted) else {
            return Err(self.error(
                Code::BadRange,
                value.span,
                format!("`{wanted}` is not among the choices"),
                match labels.as_slice() {
                    [low, high] if low.parse::<f64>().is_ok() && high.parse::<f64>().is_ok() => {
                        format!("write one of {low}, {high}; `in {low}..{high}` is a slider between them")
                    }
                    _ => format!("write one of {}", labels.join(", ")),
                },
            ));
        };
        self.parameters.push(Parameter {
            name: shown,
            ty: Type::Str,
            degrees: false,
            length: None,
            default: vec![labels.iter().position(|l| *l == written).unwrap_or(index) as f64],
            min: vec![0.0],
            max: vec![labels.len() as f64 - 1.0],
            choices: labels,
            description,
            span: name.span,
            first: None,
        });
        let Some(choice) = choices.get(index) else { return Err(Stop) };
        // The others are looked at too, for their errors.
        for (i, other) in choices.iter().enumerate() {
            if i != index
                && let Ok(Value::Shape(shape)) = self.expression(other, env)
            {
                self.alternatives.push(shape);
            }
        }
        self.expression(choice, env)
    }

    /// What a choice is called: its name or number as written.
    /// The blocks of a text.
    pub fn blocks(&mut self, module: usize) -> SceneBlocks {
        let mut blocks = SceneBlocks { unit: self.unit, extent: self.options.extent.unwrap_or(DEFAULT_EXTENT), ..SceneBlocks::default() };
        let modules = self.modules;
        // The extent first: repetitions need it.
        for (_, item) in modules.items(module) {
            if let ItemKind::Block { kind, kind_span, name, file, entries } = &item.kind {
                let _ = self.block(module, *kind, *kind_span, name.as_ref(), file.as_ref(), entries, &mut blocks);
            }
        }
        self.extent = blocks.extent;
        self.balls_within_walls(module, &blocks);
        blocks
    }

    #[allow(clippy::too_many_arguments)]
    fn block(
        &mut self,
        module: usize,
        kind: BlockKind,
        kind_span: Span,
        name: Option<&Name>,
        file: Option<&(String, Span)>,
        entries: &[Entry],
        blocks: &mut SceneBlocks,
    ) -> Elaborated<()> {
        let env = Env::top(module);
        let mut seen: FxHashMap<&str, &Entry> = FxHashMap::default();
        let mut unknown = false;
        let known = keys(kind);
        let words = block_words(kind);
        for entry in entries {
            let key = &*entry.key.text;
            if !known.contains(&key) {
                unknown = true;
                // What stands in a block of its own, and means the same there.
                let other = elsewhere::BLOCKS.into_iter().find(|other| key != "size" && keys(*other).contains(&key)).map(block_words);
                let near = elsewhere::key(key, known);
                let help = match (near, other) {
                    (Some(near), _) => format!("did you mean `{near}`?"),
                    (_, Some(other)) => format!("it stands in `{other} {{ {key}: … }}`"),
                    _ => format!("the keys of `{words}` are {}", known.join(", ")),
                };
                let said = Diagnostic::new(Code::UnknownKey, entry.key.span, format!("`{words}` has no `{key}`"), help);
                self.report(said.write_if(entry.key.span, near));
                continue;
            }
            if seen.insert(key, entry).is_some() {
                self.error(
                    Code::TwiceDeclared,
                    entry.key.span,
                    format!("`{key}` is given twice"),
                    "delete one of them",
                );
            }
        }
        let entry = |key: &str| seen.get(key).map(|e| &e.value);
        let name_text = name.map_or(String::new(), |n| n.text.to_string());
        match kind {
            BlockKind::Camera => {
                let camera = self.camera(name_text, kind_span, &seen, &env)?;
                blocks.cameras.push(camera);
            }
            BlockKind::Light => {
                let position = entry("position");
                let direction = entry("direction");
                // What is missing was called something else.
                if unknown && position.is_none() && direction.is_none() {
                    return Err(Stop);
                }
                if position.is_some() == direction.is_some() {
                    return Err(self.error(
                        Code::MissingArgument,
                        name.map_or(kind_span, |n| n.span),
                        "a light has either a `direction` or a `position`",
                        "write `direction: (-1, -2, -1)` for a sun, `position: (2, 3, 1)` for a lamp",
                    ));
                }
                let vector =
                    self.vec3_entry(position.or(direction), &env, [0.0, -1.0, 0.0]);
                let color = self.color_entry(entry("color"), &env, [1.0; 3]);
                let intensity = self.number_entry(
                    entry("intensity"),
                    &env,
                    if position.is_some() { 20.0 } else { 3.0 },
                    Some((0.0, f64::INFINITY)),
                    "a number of at least zero",
                );
                let shadow = match (entry("shadow"), entry("size")) {
                    (Some(expr), None) => self.shadow(expr, &env),
                    (None, None) => Ok((Shadow::Soft(16.0), None)),
                    (None, Some(size)) => {
                        let (most, wanted) = match position.is_some() {
                            true => (f64::INFINITY, "the radius of the lamp, at least zero"),
                            false => (1.5, "half of the angle under which the sun is seen, from 0deg to 85deg"),
                        };
                        self.number_entry(Some(size), &env, 0.0, Some((0.0, most)), wanted).map(|size| (Shadow::Sized(0.0), Some(size)))
                    }
                    (Some(_), Some(size)) => {
                        let help = "delete one of the two: the shadow of a light with a size is as soft as the size makes it";
                        Err(self.error(Code::BadValue, size.span, "`size` and `shadow` both say how soft the shadow is", help))
                    }
                };
                let vector = vector?;
                if direction.is_some()
                    && vector.iter().all(|n| self.graph.as_constant(*n) == Some(0.0))
                {
                    return Err(self.error(
                        Code::BadValue,
                        direction.map_or(kind_span, |d| d.span),
                        "a direction of length zero points nowhere",
                        "write the direction in which the light travels, for example `(-1, -2, -1)`",
                    ));
                }
                blocks.lights.push(LightNodes {
                    name: name_text,
                    position: position.is_some(),
                    vector,
                    color: color?,
                    intensity: intensity?,
                    shadow: shadow?,
                    span: kind_span,
                });
            }
            BlockKind::Environment => {
                if let Some(sky) = entry("sky") {
                    self.sky(sky, &env, blocks)?;
                }
                if let Some(capture) = self.capture(entry("capture"), entry("size"), &env)? {
                    blocks.capture = Some(capture);
                }
            }
            BlockKind::Render => self.render(&seen, &env, blocks)?,
            BlockKind::Physics => {
                let physics = self.physics(&seen, &env)?;
                if blocks.physics.replace(physics).is_some() {
                    self.error(Code::TwiceDeclared, kind_span, "`physics` is given twice", "delete one of them");
                }
            }
            BlockKind::Balls => {
                let balls = self.balls(name_text, &seen, &env)?;
                blocks.balls.push(balls);
            }
            BlockKind::Mesh => {
                let mesh = self.mesh(name_text, kind_span, file, &seen, &env)?;
                blocks.meshes.push(mesh);
            }
        }
        Ok(())
    }

    fn render(
        &mut self,
        seen: &FxHashMap<&str, &Entry>,
        env: &Env,
        blocks: &mut SceneBlocks,
    ) -> Elaborated<()> {
        let entry = |key: &str| seen.get(key).map(|e| &e.value);
        let mut ok = true;
        if let Some(expr) = entry("ambient_occlusion") {
            let pair = self.expression(expr, env).and_then(|v| match v {
                Value::Bool(node) => {
                    let half = self.graph.constant(0.5);
                    let (zero, one) = (self.graph.constant(0.0), self.graph.constant(1.0));
                    Ok((half, self.graph.op(Op::Select, &[node, one, zero])))
                }
                other => {
                    let v = self.to_vector(&other, 2, expr.span)?;
                    let &[reach, strength] = &*v else { return Err(Stop) };
                    for (node, most) in [(reach, f64::INFINITY), (strength, 1.0)] {
                        if let Some(c) = self.graph.as_constant(node)
                            && !(0.0..=most).contains(&c)
                        {
                            let help = "write `(reach, strength)`: how far it reaches, at least 0, and how strong it is, from 0 to 1";
                            return Err(self.error(Code::BadValue, expr.span, format!("this is {}", short(c)), help));
                        }
                    }
                    Ok((reach, strength))
                }
            });
            match pair {
                Ok(pair) => blocks.ambient_occlusion = Some(pair),
                Err(Stop) => ok = false,
            }
        }
        if let Some(expr) = entry("shadows") {
            match self.expression(expr, env).and_then(|v| self.coerce(v, &Type::Bool, expr.span, env)) {
                Ok(Value::Bool(node)) => blocks.shadows = Some(node),
                _ => ok = false,
            }
        }
        if let Some(expr) = entry("reflections") {
            match self.reflections(expr, env) {
                Ok(node) => blocks.reflections = Some(node),
                Err(Stop) => ok = false,
            }
        }
        let positive = Some((1e-6, f64::INFINITY));
        let words = "a number greater than zero";
        if let Some(expr) = entry("max_distance") {
            match self.number_entry(Some(expr), env, 100.0, positive, words) {
                Ok(node) => blocks.max_distance = Some(node),
                Err(Stop) => ok = false,
            }
        }
        if let Some(expr) = entry("exposure") {
            match self.number_entry(Some(expr), env, 0.0, None, "") {
                Ok(node) => blocks.exposure = Some(node),
                Err(Stop) => ok = false,
            }
        }
        if let Some(expr) = entry("extent") {
            let constant = self
                .number_entry(Some(expr), env, DEFAULT_EXTENT, Some((1e-6, 1e7)), "a number between 1e-6 and 1e7")
                .and_then(|n| self.to_constant(&Value::number(n), expr.span));
            match constant {
                Ok(extent) => (blocks.extent, blocks.says_extent) = (extent, true),
                Err(Stop) => ok = false,
            }
        }
        ok &= self.film(seen, env, blocks).is_ok();
        if ok { Ok(()) } else { Err(Stop) }
    }

    /// The numbers of a range's ends: those of the lesser first.
    pub(super) fn range_of(&mut self, value: &Value, ty: &Type, span: Span, env: &Env) -> Elaborated<Vec<NodeId>> {
        let Value::Range(range) = value else {
            let found = value.describe(&self.graph);
            return Err(self.error(
                Code::TypeMismatch,
                span,
                format!("a range is needed here, and this is {found}"),
                if *ty == Type::Float { "write `0.02..0.06`" } else { "write `(-1, 0, -1)..(1, 2, 1)`" },
            ));
        };
        let from = self.coerce(range.0.clone(), ty, span, env)?;
        let to = self.coerce(range.1.clone(), ty, span, env)?;
        let nodes = |v: &Value| match v {
            Value::Number(n, _) => vec![*n],
            Value::Vector(v) => v.to_vec(),
            _ => Vec::new(),
        };
        let (mut ends, high) = (nodes(&from), nodes(&to));
        for (&a, &b) in ends.iter().zip(&high) {
            if let (Some(a), Some(b)) = (self.graph.as_constant(a), self.graph.as_constant(b))
                && a > b
            {
                return Err(self.error(
                    Code::BadRange,
                    span,
                    format!("the range {}..{} is empty", short(a), short(b)),
                    "write the smaller end first",
                ));
            }
        }
        ends.extend(high);
        Ok(ends)
    }

    pub(super) fn vec3_entry(
        &mut self,
        expr: Option<&Expr>,
        env: &Env,
        default: [f64; 3],
    ) -> Elaborated<[NodeId; 3]> {
        let Some(expr) = expr else { return Ok(default.map(|c| self.graph.constant(c))) };
        let value = self.expression(expr, env)?;
        if matches!(value, Value::Number(..)) {
            let found = value.describe(&self.graph);
            return Err(self.error(
                Code::TypeMismatch,
                expr.span,
                format!("a vec3 is needed here, and this is {found}"),
                "write `(x, y, z)`",
            ));
        }
        let v = self.to_vector(&value, 3, expr.span)?;
        let &[a, b, c] = &*v else { return Err(Stop) };
        Ok([a, b, c])
    }

    pub(super) fn color_entry(
        &mut self,
        expr: Option<&Expr>,
        env: &Env,
        default: [f64; 3],
    ) -> Elaborated<[NodeId; 3]> {
        let Some(expr) = expr else { return Ok(default.map(|c| self.graph.constant(c))) };
        let value = self.expression(expr, env)?;
        match self.coerce(value, &Type::Color, expr.span, env)? {
            Value::Vector(v) => match *v {
                [a, b, c] => Ok([a, b, c]),
                _ => Err(Stop),
            },
            _ => Err(Stop),
        }
    }

    pub(super) fn number_entry(
        &mut self,
        expr: Option<&Expr>,
        env: &Env,
        default: f64,
        limits: Option<(f64, f64)>,
        wanted: &str,
    ) -> Elaborated<NodeId> {
        let Some(expr) = expr else { return Ok(self.graph.constant(default)) };
        let value = self.expression(expr, env)?;
        let value = self.coerce(value, &Type::Float, expr.span, env)?;
        let node = self.to_number(&value, expr.span, env)?;
        if let (Some((lo, hi)), Some(c)) = (limits, self.graph.as_constant(node))
            && !(lo..=hi).contains(&c)
        {
            let is_angle = wanted.contains("deg");
            let found = if is_angle { format!("{}deg", short(c.to_degrees())) } else { short(c) };
            let bare = matches!(expr.kind, ExprKind::Int(_) | ExprKind::Float(_));
            let help = match is_angle && bare && (lo..=hi).contains(&c.to_radians()) {
                true => format!("write `{}deg`: a bare number is in radians", short(c)),
                false => format!("write {wanted}"),
            };
            return Err(self.error(Code::BadValue, expr.span, format!("this is {found}"), help));
        }
        Ok(node)
    }

    /// `none`, `hard`, `soft(k)`, `map`.
    fn shadow(&mut self, expr: &Expr, env: &Env) -> Elaborated<(Shadow, Option<NodeId>)> {
        match &expr.kind {
            ExprKind::Name(name) => match name.as_str() {
                "none" | "off" => return Ok((Shadow::None, None)),
                "hard" | "on" => return Ok((Shadow::Hard, None)),
                "soft" => return Ok((Shadow::Soft(16.0), None)),
                "map" => return Ok((Shadow::Map, None)),
                _ => {}
            },
            ExprKind::Call(callee, args) => {
                if let (ExprKind::Name(name), [arg]) = (&callee.kind, args.as_slice())
                    && name == "soft"
                {
                    let k = self.number_entry(
                        Some(&arg.value),
                        env,
                        16.0,
                        Some((1e-3, 1e6)),
                        "a number greater than zero: larger is sharper",
                    )?;
                    return Ok((Shadow::Soft(16.0), Some(k)));
                }
            }
            ExprKind::Hole => return Err(Stop),
            _ => {}
        }
        Err(self.error(
            Code::TypeMismatch,
            expr.span,
            "this is no kind of shadow",
            "write `none`, `hard`, `soft(16)` or `map`",
        ))
    }
}

/// Whether an expression has an angle that is read in degrees.
fn in_degrees(expr: &Expr) -> bool {
    use crate::syntax::ast::AngleUnit;
    match &expr.kind {
        ExprKind::Angle(_, AngleUnit::Deg | AngleUnit::Turn) => true,
        ExprKind::Range(a, b) => in_degrees(a) || in_degrees(b),
        ExprKind::Unary(_, a) | ExprKind::Paren(a) => in_degrees(a),
        _ => false,
    }
}

/// A number as a person would write it.
pub(super) fn short(value: f64) -> String {
    let rounded = (value * 1e6).round() / 1e6;
    format!("{rounded}")
}
