//! From trees to a graph: names, types, calls, and the scene's blocks.
//!
//! The program is *elaborated*: every declaration that the scene uses is evaluated while compiling, and what is
//! left is a graph of formulas. Values are symbolic (a number is a node of the graph), so nothing is lost by it.

mod apply;
mod baked;
mod bind;
pub mod blocks;
pub mod builtin;
pub mod call;
mod camera;
mod capped;
mod choice;
mod convert;
mod curves;
mod elsewhere;
mod env;
pub mod expression;
mod faces;
mod film;
mod flush;
mod gaps;
mod grids;
mod growth;
mod hulls;
pub mod load;
mod loops;
mod many;
pub mod material;
mod mesh;
mod operator;
mod outlined;
mod overload;
pub mod physics;
pub mod polar;
mod reach;
pub mod repeat;
mod sampled;
mod shaders;
mod surroundings;
mod texture;
mod turn;
mod unit;
pub mod value;

pub use env::{Elaborated, Env, Scope, Stop};

use crate::analysis::Facts;
use crate::blocks::SceneBlocks;
use crate::diagnostic::{Code, Diagnostic};
use crate::figure::Ball;
use crate::graph::{Exactness, Graph, NodeId, NodeList, Shape, ShapeId};
use crate::interface::{Options, Parameter};
use crate::source::{Sources, Span};
use crate::syntax::ast::{self, FunctionKind, ItemKind};
use crate::unit::Unit;
use capped::Capped;
use faces::Faces;
use load::{ItemRef, Modules};
pub use grids::Grids;
use rustc_hash::{FxHashMap, FxHashSet};
use std::rc::Rc;
use std::sync::Arc;
use value::{Bound, Value};

/// How many nodes a program may make.
pub const NODE_LIMIT: usize = 400_000;
/// How many expressions may be evaluated.
const STEP_LIMIT: u64 = 1_000_000;
/// How many expressions may be evaluated to find the errors of one declaration that nothing calls. All of them together may take `STEP_LIMIT`.
const TRIAL_LIMIT: u64 = 100_000;
/// How deep expressions may nest, calls counted in. In WebAssembly the stack is the host's, mostly of 1 MiB, and can't grow.
const NESTING_LIMIT: usize = if cfg!(target_family = "wasm") { 128 } else { 4000 };
/// How deep calls may nest.
const CALL_LIMIT: usize = 200;

/// A program while it is elaborated.
pub struct Elaborator<'a> {
    /// All texts.
    pub modules: &'a Modules,
    /// The texts themselves, for what is said of a place.
    sources: &'a Sources,
    /// Where grids come from.
    grids: &'a Grids<'a>,
    /// What the host chose.
    pub options: &'a Options,
    /// The graph that is made.
    pub graph: Graph,
    /// What is known of its nodes.
    pub facts: Facts,
    /// What was found wrong.
    pub diagnostics: Vec<Diagnostic>,
    /// Parameters that were met, by declaration.
    pub parameters: Vec<Parameter>,
    parameter_values: FxHashMap<ItemRef, Option<Elaborated<Value>>>,
    lets: FxHashMap<ItemRef, Option<Elaborated<Value>>>,
    called: FxHashSet<ItemRef>,
    /// Shapes that another choice would put into the scene.
    alternatives: Vec<ShapeId>,
    memo: FxHashMap<(ItemRef, Option<Value>, Vec<Value>), Option<Value>>,
    /// Functions that made a long formula of numbers.
    long: FxHashSet<ItemRef>,
    depth: usize,
    /// Materials whose entries are being read.
    materials: Vec<ItemRef>,
    nesting: usize,
    steps: u64,
    /// The most that `steps` may become.
    step_limit: u64,
    /// Calls went too deep: nothing is evaluated until the outermost one has ended.
    endless: bool,
    /// The outermost call or loop that is being unfolded.
    unfolding: Option<Span>,
    /// The program unfolds to too much, and that has been said.
    full: bool,
    /// The user's call, while a declaration of the prelude is elaborated for it.
    outside: Option<Span>,
    /// While a declaration that nothing calls is tried with stand-in arguments: only errors that hold for all arguments are kept.
    trial: bool,
    /// What is known of the faces of shapes that are blended.
    faces: FxHashMap<ShapeId, Faces>,
    /// The balls of shapes whose hull is known.
    balls: FxHashMap<ShapeId, Rc<[Ball]>>,
    /// Where `x`, `y` and `z` stand for unit vectors.
    axes: FxHashSet<Span>,
    /// What one unit of the scene is, where it says that.
    unit: Option<Unit>,
    /// The scene's extent, needed while repetitions are made.
    pub extent: f64,
    /// Repetitions that do not look at all copies.
    capped: Vec<Capped>,
    /// How far from copies what stands around a repetition reads its value, by the place of the repetition; where that is farther than it looks
    /// by itself.
    read_up_to: FxHashMap<Span, f64>,
}

/// What elaboration gives.
pub struct Elaboration {
    /// The graph.
    pub graph: Graph,
    /// What is known of its nodes.
    pub facts: Facts,
    /// The scene's shape.
    pub root: Option<ShapeId>,
    /// Parameters.
    pub parameters: Vec<Parameter>,
    /// The scene's blocks.
    pub blocks: SceneBlocks,
    /// What was found wrong.
    pub diagnostics: Vec<Diagnostic>,
    /// Declarations of the first text that nothing uses: names and places.
    pub unused: Vec<(String, Span)>,
}

/// Elaborates the program whose texts are `modules`; the scene is that of the first text. `facts` know what was found before.
pub fn elaborate(modules: &Modules, sources: &Sources, grids: &Grids, options: &Options, facts: Facts) -> Elaboration {
    let (elaboration, read) = elaborate_reading((modules, sources, grids), options, facts, FxHashMap::default());
    if read.is_empty() {
        return elaboration;
    }
    let ran = elaboration.facts.account.ran;
    let mut facts = Facts::with(elaboration.facts.memory, elaboration.facts.rules);
    facts.account.ran = ran;
    elaborate_reading((modules, sources, grids), options, facts, read).0
}

/// The same with what is known of how far repetitions are read; and how far they are, where that is farther than they look.
fn elaborate_reading(
    (modules, sources, grids): (&Modules, &Sources, &Grids),
    options: &Options,
    facts: Facts,
    read_up_to: FxHashMap<Span, f64>,
) -> (Elaboration, FxHashMap<Span, f64>) {
    let mut e = Elaborator {
        modules,
        sources,
        grids,
        options,
        graph: Graph::new(),
        facts,
        diagnostics: Vec::new(),
        parameters: Vec::new(),
        parameter_values: FxHashMap::default(),
        lets: FxHashMap::default(),
        called: FxHashSet::default(),
        alternatives: Vec::new(),
        memo: FxHashMap::default(),
        long: FxHashSet::default(),
        depth: 0,
        materials: Vec::new(),
        nesting: 0,
        steps: 0,
        step_limit: STEP_LIMIT,
        endless: false,
        full: false,
        unfolding: None,
        outside: None,
        trial: false,
        faces: FxHashMap::default(),
        balls: FxHashMap::default(),
        axes: FxHashSet::default(),
        unit: None,
        extent: 100.0,
        capped: Vec::new(),
        read_up_to,
    };
    let main = modules.main;
    e.unit = e.scene_unit(main);
    // Parameters first and in their order: so they stand in the window, whether anything reads them yet or not.
    for module in modules.with_parameters() {
        for item in modules.items(module) {
            if let ItemKind::Param { .. } = item.1.kind {
                let _ = e.parameter(item.0);
            }
        }
    }
    let blocks = e.blocks(main);
    let mut root = None;
    let mut scenes = Vec::new();
    for (_, item) in modules.items(main) {
        if let ItemKind::Scene(expr) = &item.kind {
            let value = e.expression(expr, &Env::top(main));
            root = value.and_then(|v| e.to_shape(&v, 3, expr.span)).ok();
            scenes.push(root);
        }
    }
    if scenes.is_empty() && !modules.broken {
        let span = modules.head(main);
        let help = "write `scene = ` and a shape, for example `scene = sphere(1)`";
        let text = sources.get(span.file).map_or("", |file| &file.text);
        let end = Span::new(span.file, text.len(), text.len());
        let line = if text.is_empty() || text.ends_with('\n') { "scene = sphere(1)\n" } else { "\nscene = sphere(1)\n" };
        e.report(Diagnostic::new(Code::NoScene, span, "this file has no scene", help).write(end, line));
    }
    let read = root.map_or_else(FxHashMap::default, |root| e.read_in_gaps(root));
    let unused = e.uncalled(main);
    e.try_uncalled(main);
    e.unused_parameters(&blocks, &scenes);
    let elaboration = Elaboration {
        graph: e.graph,
        facts: e.facts,
        root,
        parameters: e.parameters,
        blocks,
        diagnostics: e.diagnostics,
        unused,
    };
    (elaboration, read)
}

impl Elaborator<'_> {
    /// Reports a diagnostic, unless it is one that a stand-in argument may have caused.
    pub fn report(&mut self, mut diagnostic: Diagnostic) -> Stop {
        let place = self.place(diagnostic.span);
        if matches!(diagnostic.code, Code::TooLarge | Code::EndlessCall) {
            diagnostic.span = place;
        } else if place != diagnostic.span {
            diagnostic = diagnostic.at(place, "because of this");
        }
        let caused_by_values = matches!(
            diagnostic.code,
            Code::BadValue
                | Code::NotConstant
                | Code::OutOfBounds
                | Code::EndlessCall
                | Code::TooLarge
                | Code::NoReach
                | Code::NoBound
                | Code::NotWhole
        );
        let known = self.is_known(diagnostic.code, diagnostic.span);
        let stands = !self.trial || !caused_by_values;
        if stands && !known {
            self.diagnostics.push(diagnostic);
        }
        Stop
    }

    /// Whether such a diagnostic was reported at a place already: what is called often is not worth another search for advice.
    pub fn is_known(&self, code: Code, span: Span) -> bool {
        self.diagnostics.iter().any(|d| d.code == code && d.span == span)
    }

    /// Reports an error with its advice.
    pub fn error(
        &mut self,
        code: Code,
        span: Span,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Stop {
        self.report(Diagnostic::new(code, span, message, help))
    }

    /// Where a person should look: the place itself, and for one in the prelude the user's call that came to it.
    pub fn place(&self, span: Span) -> Span {
        match self.outside {
            Some(call) if crate::prelude::in_prelude(span) => call,
            _ => span,
        }
    }

    /// Remembers where a node came from.
    pub fn locate(&mut self, node: NodeId, span: Span) {
        self.graph.locate(node, self.place(span));
    }

    /// Counts a step; an error where the program unfolds without measure.
    pub fn step(&mut self, span: Span) -> Elaborated<()> {
        self.steps_of(1, span)
    }

    /// Counts so many steps.
    pub fn steps_of(&mut self, count: usize, span: Span) -> Elaborated<()> {
        if self.endless || self.full {
            return Err(Stop);
        }
        self.steps += count as u64;
        if self.steps > self.step_limit || self.graph.len() > NODE_LIMIT {
            self.full = true;
            return Err(self.error(
                Code::TooLarge,
                self.unfolding.unwrap_or(span),
                "this unfolds to more than the compiler takes",
                "use fewer turns or copies (some 10,000 of a simple shape fit), or `grid` and `repeat` for many copies of one shape",
            ));
        }
        Ok(())
    }

    /// Runs `inside` one call deeper.
    pub fn deeper<T>(
        &mut self,
        span: Span,
        inside: impl FnOnce(&mut Self) -> Elaborated<T>,
    ) -> Elaborated<T> {
        if self.depth >= CALL_LIMIT {
            self.endless = true;
            return Err(self.error(
                Code::EndlessCall,
                span,
                "this calls itself without end",
                "let an `if` that is decided while compiling end the calls, for example `if level > 0 { … } else { … }`; a slider decides nothing then, a choice `in [1, 2, 3]` does",
            ));
        }
        self.depth += 1;
        let result = self.unfold(span, inside);
        self.depth -= 1;
        self.endless &= self.depth > 0;
        result
    }

    /// Runs `inside`, which a call or a loop unfolds to.
    pub fn unfold<T>(&mut self, span: Span, inside: impl FnOnce(&mut Self) -> T) -> T {
        let before = self.unfolding;
        self.unfolding = before.or(Some(span));
        let result = inside(self);
        self.unfolding = before;
        result
    }

    /// A new shape without a name.
    pub fn make_shape(&mut self, dimensions: u8, value: NodeId, span: Span) -> ShapeId {
        self.graph.add_shape(Shape {
            name: None,
            dimensions,
            value,
            variables: Arc::default(),
            exactness: Exactness::Formula,
            material: None,
            paints: Arc::default(),
            span: self.place(span),
        })
    }

    /// A shape with a name: the same shape where it has none, else one around it.
    pub fn name_shape(&mut self, id: ShapeId, name: &str, span: Span) -> ShapeId {
        let Some(shape) = self.graph.shape(id).cloned() else { return id };
        if shape.name.is_none() {
            return self.graph.add_shape(Shape { name: Some(name.into()), ..shape });
        }
        let point = self.graph.point();
        let value = self.graph.field(id, point);
        let outer = self.make_shape(shape.dimensions, value, span);
        match self.graph.shape(outer).cloned() {
            Some(outer) => self.graph.add_shape(Shape { name: Some(name.into()), ..outer }),
            None => outer,
        }
    }

    /// The declarations of a text that nothing called.
    fn uncalled(&self, module: usize) -> Vec<(String, Span)> {
        let modules = self.modules;
        let items = modules.items(module).filter(|(item, _)| !self.called.contains(item));
        let tried = items.filter(|(_, item)| matches!(item.kind, ItemKind::Function(_) | ItemKind::Material { .. }));
        tried.filter_map(|(_, item)| load::item_name(item).map(|n| (n.text.to_string(), n.span))).collect()
    }

    /// Tries every declaration of a text that nothing called, with stand-in arguments, for its errors.
    fn try_uncalled(&mut self, module: usize) {
        self.trial = true;
        self.steps = 0;
        for (item_ref, item) in self.modules.items(module) {
            if self.called.contains(&item_ref) {
                continue;
            }
            self.step_limit = STEP_LIMIT.min(self.steps + TRIAL_LIMIT);
            self.full = false;
            match &item.kind {
                ItemKind::Function(function) => {
                    let _ = self.try_function(item_ref, function);
                }
                ItemKind::Material { parameters, .. } => {
                    let args = self.stand_ins(parameters, false);
                    let _ = self.make_material(item_ref, &args, item.span);
                }
                ItemKind::Let(_) => {
                    let _ = self.top_let(item_ref);
                }
                _ => {}
            }
        }
        self.trial = false;
    }

    fn try_function(&mut self, item: ItemRef, function: &ast::Function) -> Elaborated<()> {
        let args = self.stand_ins(&function.parameters, function.kind == FunctionKind::Blend);
        let point = self.graph.point();
        let receiver = match function.kind {
            FunctionKind::Warp => Some(Value::Vector(point.into())),
            FunctionKind::Warp2 => {
                Some(Value::Vector(point.into_iter().take(2).collect()))
            }
            _ => None,
        };
        let args = args.into_iter().map(|a| a.map(|value| Bound { value, span: function.name.span, parts: Vec::new() })).collect();
        self.apply(item, receiver, args, function.name.span, None).map(|_| ())
    }

    /// A value for each parameter: its default, or a harmless one of its type.
    fn stand_ins(&mut self, parameters: &[ast::Parameter], blend: bool) -> Vec<Option<Value>> {
        let point = self.graph.point();
        parameters
            .iter()
            .map(|p| {
                if p.default.is_some() {
                    return None;
                }
                let one = self.graph.constant(1.0);
                let ty = p.ty.as_ref().map(|(t, _)| t.clone());
                Some(match ty {
                    Some(ty) => self.stand_in(&ty, p.name.span),
                    None if blend => {
                        Value::number(self.graph.op(crate::graph::kernel::Op::Length3, &point))
                    }
                    None => Value::number(one),
                })
            })
            .collect()
    }

    fn stand_in(&mut self, ty: &ast::Type, span: Span) -> Value {
        use ast::Type;
        let one = self.graph.constant(1.0);
        let point = self.graph.point();
        match ty {
            Type::Bool => Value::Bool(one),
            Type::Int => Value::Number(one, true),
            Type::Float | Type::Field | Type::Str => Value::number(one),
            Type::Vec(n) => Value::Vector(NodeList::of(one, usize::from(*n))),
            Type::Color => Value::Vector(NodeList::of(one, 3)),
            Type::Mat(n) => {
                let zero = self.graph.constant(0.0);
                let n = usize::from(*n);
                let cells = (0..n * n).map(|i| if i % (n + 1) == 0 { one } else { zero });
                Value::Matrix(n as u8, cells.collect())
            }
            Type::Shape | Type::Shape2 => {
                let dimensions = if *ty == Type::Shape { 3 } else { 2 };
                let length = if dimensions == 3 {
                    self.graph.op(crate::graph::kernel::Op::Length3, &point)
                } else {
                    self.graph.op(crate::graph::kernel::Op::Length2, &point[..2])
                };
                let value = self.graph.op(crate::graph::kernel::Op::Sub, &[length, one]);
                Value::Shape(self.make_shape(dimensions, value, span))
            }
            Type::Material => Value::Material(self.default_material()),
            Type::Curve => self.stand_in_curve().unwrap_or(Value::Nothing),
            Type::List(inner) => {
                let inner = self.stand_in(inner, span);
                Value::List(vec![inner.clone(), inner.clone(), inner].into())
            }
        }
    }

    /// Warns of parameters that nothing reads.
    fn unused_parameters(&mut self, blocks: &SceneBlocks, scenes: &[Option<ShapeId>]) {
        let Some((root, others)) = scenes.iter().copied().collect::<Option<Vec<_>>>().and_then(|all| all.split_first().map(|(r, o)| (*r, o.to_vec()))) else {
            return;
        };
        let mut read = self.graph.parameters_read(root, &blocks.nodes());
        read.extend(self.alternatives.iter().chain(&others).flat_map(|shape| self.graph.parameters_read(*shape, &[])));
        let modules = self.modules;
        let main_file = modules.file(modules.main);
        // A choice among names is no number that a formula could read; but some text says its name.
        let is_said = |p: &Parameter| modules.items(modules.main).any(|(item, declared)| declared_as(declared, p) && self.called.contains(&item));
        let is_read = |p: &Parameter| match p.first {
            Some(_) => p.components().any(|component| read.contains(&component)),
            None => is_said(p),
        };
        let own = self.parameters.iter().filter(|p| p.span.file == main_file);
        let unused: Vec<_> = own.filter(|p| !is_read(p)).map(|p| (p.name.clone(), p.span)).collect();
        for (name, span) in unused {
            let said = Diagnostic::new(Code::Unused, span, format!("nothing in the scene reads `{name}`"), "use it, or delete it");
            let whole = modules.items(modules.main).map(|(_, item)| item.span).find(|item| item.start <= span.start && span.end <= item.end);
            let lines = whole.map(|item| self.sources.lines_of(item));
            self.report(match lines {
                Some(lines) => said.write(lines, ""),
                None => said,
            });
        }
    }
}

/// Whether a parameter is declared here.
fn declared_as(item: &ast::Item, parameter: &Parameter) -> bool {
    load::item_name(item).is_some_and(|name| name.span == parameter.span)
}
