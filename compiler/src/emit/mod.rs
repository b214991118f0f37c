//! From the graph to WGSL: a module that another program can paste, with names that its reader knows.
//!
//! [`plan`] finds the formulas that are needed and decides which become functions; [`body`] opens the others where they are
//! called; [`write`] turns expressions into text; [`library`] holds the WGSL that is the same for every scene. Nothing that
//! nobody reads is emitted, and the same source gives the same bytes. The graph is only read.

mod ahead;
mod arms;
mod body;
mod code;
mod computed;
pub mod counted;
mod draw;
mod error;
mod formulas;
mod header;
mod joined;
mod layers;
mod library;
mod module;
mod names;
mod plan;
mod rounding;
pub(crate) mod shadow;
mod space;
mod spirv;
mod straight;
pub mod table;
mod tokens;
pub mod tracer;
mod translate;
mod uniforms;
mod vector;
mod write;

#[cfg(test)]
mod tests;

pub use error::EmitError;
pub use formulas::Formulas;
pub use library::signature;
pub use module::Module;
pub use names::{letters, numbered};
pub use translate::{Target, translate, validate, vertex_shader};

use crate::analysis::Box3;
use crate::blocks::SceneBlocks;
use crate::frame::Frame;
use crate::functions::Functions;
use crate::graph::interval::Interval;
use crate::graph::simplify::Terms;
use crate::graph::{Graph, Leaf, Node, ShapeId};
use crate::interface::{Entry, Export, Options, Parameter, Rounding, UniformSource, Uniforms};
use crate::live::Live;
use crate::source::{Sources, Span};
use body::Body;
use code::{Code, ExprId};
use draw::Drawing;
use layers::{glass_function, layers_function, layers_struct, mesh_functions};
use library::{Helpers, prefixed};
use names::{Scope, identifier, vector_type};
use plan::{Group, Plan, Plans, TargetId};
use rounding::with_rounding;
use rustc_hash::FxHashMap;
use space::{own_space, scene_space, surface_plan, surface_struct};
use std::fmt::Write;
use std::sync::Arc;
use table::{ModuleTables, Tables};
use tracer::Ways;
use uniforms::Candidates;
use write::{Context, Room, unit};

/// The module of a scene: the functions that `options` asks for, and what they need. `sources` are the texts that the graph came from. `frame` is the scene
/// at the start, where the module shall draw it: [`Options::entry`].
#[allow(clippy::too_many_arguments)]
pub fn emit(
    graph: &Graph,
    root: ShapeId,
    functions: &Functions,
    blocks: &SceneBlocks,
    parameters: &[Parameter],
    options: &Options,
    sources: &Sources,
    frame: Option<&Frame>,
) -> Result<Module, EmitError> {
    let prefix = &options.prefix;
    check_prefix(prefix)?;
    if prefix.is_empty() && options.uniforms == Uniforms::Separate {
        return Err(EmitError::Unnamed);
    }
    let tables = Tables::new(graph, functions);
    let mut plans = Plans::new(graph, functions, &tables);
    let mut skipped = Vec::new();
    let frame = frame.filter(|_| options.entry == Entry::Draw);
    let drawing = frame.map(|frame| Drawing::new(graph, blocks, functions, frame, options.colors, &mut plans));
    let needed = drawing.as_ref().map_or(Vec::new(), Drawing::exports);
    let exports = exports(options, &needed, &plans, root, functions.ahead.planes.is_some(), &mut skipped);
    // What is not there was said.
    let drawing = drawing.filter(|_| needed.iter().all(|export| exports.contains(export)));
    let frame = frame.filter(|_| drawing.is_some());

    // What the exports of this scene compute.
    let mut roots: Vec<(Export, TargetId)> = Vec::new();
    for &export in &exports {
        if let Some(group) = group_of(export) {
            let target = plans.target(root, group);
            roots.push((export, target));
        }
    }
    let asked = exports.contains(&Export::Surface);
    let surface = asked.then(|| surface_plan(graph, root, &functions.surface.look(), &mut plans));
    let layered = asked && functions.surface.is_layered();
    let layers = layered.then(|| surface_plan(graph, root, &functions.surface.layer_nodes(), &mut plans));
    let glass = functions.surface.glass.filter(|_| asked).map(|glass| surface_plan(graph, root, &glass, &mut plans));
    let carry = functions.carry.map(|carry| surface_plan(graph, root, &carry.nodes(), &mut plans));
    // Exports that are the same function are computed once.
    let mut counted: Vec<(TargetId, u64)> = Vec::new();
    for &(_, target) in &roots {
        if !counted.iter().any(|c| c.0 == target) {
            counted.push((target, 1));
        }
    }
    let mut meshes = Vec::new();
    for surface in functions.meshes.iter().filter(|_| asked) {
        let layers = surface.is_layered().then(|| plans.plan(&surface.layer_nodes(), [].into()));
        meshes.push((surface, plans.plan(&surface.look(), [].into()), layers));
    }
    let follows = exports.iter().any(|e| matches!(e, Export::Trace | Export::Shadow));
    let one = plans.is_one(root);
    let planes = functions.ahead.planes.filter(|_| follows).map(|planes| ahead::Plans::new(graph, root, &planes, one, &mut plans));
    let of_meshes = meshes.iter().flat_map(|(_, plan, layers)| std::iter::once(plan).chain(layers));
    let standing = plans.complete(&counted, surface.iter().chain(&layers).chain(&glass).chain(&carry).chain(planes.iter().flat_map(ahead::Plans::all)).chain(of_meshes))?;

    let mut module = reserved_names(prefix);
    let mut context = Context {
        graph,
        plans: &plans,
        functions: function_names(graph, root, &plans, &standing, prefix, &mut module),
        operations: FxHashMap::default(),
        module,
        prefix,
        uniform_name: format!("{prefix}uniforms"),
        uniforms: Candidates::new(graph, parameters, &drawing.as_ref().map_or(Vec::new(), Drawing::view)),
        helpers: Helpers::default(),
        numbers: FxHashMap::default(),
        room: Room::default(),
        rounding: Rounding::ORDINARY,
        sums: (0.0, None),
        called: FxHashMap::default(),
        tables: &tables,
        places: Vec::new(),
        facing: "normal",
    };
    let mut texts = String::with_capacity(24 * graph.len().min(100_000));
    let mut body = Body::new(graph.len(), (!options.live_in_shader && options.uniforms != Uniforms::Private).then(Formulas::default));
    for &id in &standing {
        shape_function(&mut context, id, &mut body, &mut texts)?;
        let sums = std::mem::take(&mut context.sums);
        context.called.insert(id, sums);
    }
    let rest = planes.as_ref().map(|planes| ahead::functions(&mut context, root, planes, &mut body, &mut texts)).transpose()?;
    let ways = Ways {
        one: rest.as_ref().map_or(one, |rest| rest.one),
        planes: rest.is_some(),
        region: functions.ahead.region.is_some() && rest.is_some() == functions.ahead.planes.is_some(),
        loose: functions.loose,
        lamps: blocks.has_lamps(),
    };
    let roots = Roots { root, targets: &roots, surface: surface.as_ref(), rest, ways, solid: functions.ahead.solid };
    let operations = export_functions(&mut context, &exports, &roots, &mut body, &mut texts)?;
    let (rounding, cancels) = (context.rounding, context.sums.1.filter(|_| context.rounding.unit > 1.0));
    if let Some(plan) = &layers {
        layers_function(&mut context, root, &functions.surface, plan, &mut body, &mut texts)?;
    }
    if let Some(plan) = &glass {
        glass_function(&mut context, root, plan, &mut body, &mut texts)?;
    }
    if let Some(drawing) = &drawing {
        drawing.write(&mut context, &mut body, rounding, &mut texts)?;
    }
    if let Some(plan) = &carry {
        carry_function(&mut context, root, plan, &mut body, &mut texts)?;
    }
    let places = std::mem::take(&mut context.places);
    let mut meshes_text = String::new();
    for (i, (surface, plan, layers)) in (0..).zip(&meshes) {
        mesh_functions(&mut context, i, surface, plan, layers.as_ref(), &mut body, &mut meshes_text)?;
    }

    // What the library reads.
    if follows {
        context.helpers.need("clip");
    }
    if exports.contains(&Export::Trace) && ways.region {
        context.helpers.need("within");
    }
    if exports.contains(&Export::Shadow) && ways.region {
        context.helpers.need("beside");
    }
    if exports.contains(&Export::Occlusion) {
        context.uniforms.read(UniformSource::OcclusionReach);
        context.uniforms.read(UniformSource::OcclusionStrength);
    }
    let around = graph.reachable(&blocks.nodes());
    let by_blocks = around.iter().filter_map(|id| match graph.node(*id) {
        Node::Leaf(Leaf::Parameter(component)) => Some(*component),
        _ => None,
    });
    skipped.extend(header::unread(parameters, &context.uniforms, &by_blocks.collect()));
    let (fields, size) = context.uniforms.layout();
    let formulas = body.formulas.take().unwrap_or_default();
    let facts = header::Facts {
        graph,
        sources,
        exports: &exports,
        options,
        uniforms: &context.uniforms,
        formulas: &formulas,
        fields: &fields,
        size,
        parameters,
        occlusion: blocks.occlusion(graph, &Live::start(graph)),
        extent: blocks.extent,
        region: functions.ahead.region,
        frame,
    };
    let (mut wgsl, computed) = header::write(&facts);
    let declared = |buffers: bool, text: &mut String| {
        declarations(&context, &facts, buffers, text);
        if layered {
            layers_struct(prefix, 0, &functions.surface, text);
        }
        if carry.is_some() {
            let _ = write!(text, "\nstruct {prefix}Carry {{\n  point: vec3f,\n  x: vec3f,\n  y: vec3f,\n  z: vec3f,\n}}\n");
        }
    };
    let needs_buffers = context.needs_buffers();
    declared(needs_buffers, &mut wgsl);
    let places = lines_of(graph, &places, wgsl.matches('\n').count() as u32 + 1, &texts);
    wgsl.push_str(&texts);
    let mut buffered = context.has_tables().then(|| {
        let mut code = String::with_capacity(texts.len() + 4096);
        declared(true, &mut code);
        code.push_str(&texts);
        code
    });
    let mut origin = format!("{}.origin", context.uniform_name);
    if options.uniforms == Uniforms::Separate {
        let scope = &mut context.module;
        let names: FxHashMap<&str, String> = fields.iter().map(|field| (field.name.as_str(), scope.give(&format!("{prefix}{}", field.name)))).collect();
        for text in [Some(&mut wgsl), Some(&mut meshes_text), buffered.as_mut()].into_iter().flatten() {
            *text = tokens::with_variables(text, &context.uniform_name, |field| names.get(field).cloned());
        }
        origin = names.get("origin").cloned().unwrap_or_default();
    }
    let uniform_name = if fields.is_empty() { String::new() } else { context.uniform_name };
    Ok(Module {
        wgsl,
        places,
        exports,
        uniform_name,
        origin,
        uniforms: fields,
        formulas: Arc::new(formulas),
        computed,
        uniform_size: size,
        operations,
        skipped,
        rounding,
        cancels,
        meshes: meshes_text,
        one,
        ways,
        needs_buffers,
        draws: drawing.is_some(),
        tables: buffered.map(|code| Arc::new(ModuleTables::new(tables, code))),
    })
}

/// The lines of a text with the places in the source of what they compute, from places in the text. The text begins on line `first`.
fn lines_of(graph: &Graph, places: &[(usize, ShapeId)], first: u32, text: &str) -> Vec<(u32, Span)> {
    let (mut line, mut at) = (first, 0);
    let found = places.iter().filter_map(|&(byte, shape)| {
        line += text.get(at..byte)?.matches('\n').count() as u32;
        at = byte;
        Some((line, graph.shape(shape)?.span))
    });
    let mut found: Vec<_> = found.collect();
    found.sort_unstable_by_key(|(line, span)| (*line, span.file, span.start, span.end));
    found.dedup();
    found
}

/// Shapes have few variables and rows few pieces.
const MOST_NAMED: usize = 64;

/// Names of the exports and of the library, before any other is given.
fn reserved_names(prefix: &str) -> Scope {
    let mut names = Scope::default();
    let exports = Export::ALL.iter().map(|e| e.name());
    let helpers = library::HELPERS.iter().map(|h| h.name);
    let others = ["Around", "around", "extent", "vertex", "fragment", "Uniforms", "uniforms", "Layers", "layers", "Carry", "carry", "table", "lists", "planes", "ahead", "rest_bound", "rest_distance", "region_low", "region_high", "passage", "shares", "across", "grid_head", "outline_head", "figure_head", "bow", "face"];
    for text in exports.chain(helpers).chain(library::STRUCTURES).chain(others) {
        names.reserve(&format!("{prefix}{text}"));
    }
    if prefix.is_empty() {
        // What functions are given, or name themselves, must not hide another function.
        ["p", "q", "d", "normal", "direction", "aside", "row", "world", "span", "step", "first", "waiting", "top", "i", "away"].iter().for_each(|name| names.reserve(name));
        let lists = [names::VARIABLE, names::ROW].iter().flat_map(|name| (1..=MOST_NAMED).map(|i| numbered(name, i)));
        lists.for_each(|name| names.reserve(&name));
    }
    names
}

/// Writes the function that says where a point lies in the space of the part that it belongs to, and how each coordinate there grows.
fn carry_function(context: &mut Context, root: ShapeId, plan: &Plan, body: &mut Body, text: &mut String) -> Result<(), EmitError> {
    let prefix = context.prefix;
    let _ = writeln!(text, "\n// Where a point of the scene lies in the space of its part.\nfn {prefix}carry(p: vec3f) -> {prefix}Carry {{");
    let _ = writeln!(text, "  let q = p + {}.origin;", context.uniform_name);
    context.uniforms.read(UniformSource::Origin);
    body.clear();
    let space = scene_space(context.graph, root, body, false);
    let results = body.open(context.plans, context.graph, plan, &space, &context.uniforms)?;
    let fields: Vec<ExprId> = results.chunks(3).map(|v| body.vector(v)).collect();
    let result = body.add(Code::Carry, &fields);
    write::write(context, body, result, &["p", "q"], text);
    text.push_str("}\n");
    Ok(())
}

/// Writes a function of a shape.
fn shape_function(
    context: &mut Context,
    id: TargetId,
    body: &mut Body,
    text: &mut String,
) -> Result<(), EmitError> {
    let plans = context.plans;
    let Some(target) = plans.get(id) else { return Ok(()) };
    if let Some(table) = plans.table(target) {
        let name = context.functions.get(&id).cloned().unwrap_or_default();
        let gradient = target.group == Group::Gradient;
        let count = table::text::write(context, table, gradient, &name, body, text)?;
        context.operations.insert(id, count);
        return Ok(());
    }
    let callee = target.plan.callees().next().and_then(|c| context.functions.get(&c).cloned());
    if let (Some(table), Some(field)) = (plans.region(target), callee) {
        let name = context.functions.get(&id).cloned().unwrap_or_default();
        table::text::write_region(context, table, &field, &name, text);
        let count = target.plan.callees().filter_map(|c| context.operations.get(&c)).sum();
        context.operations.insert(id, count);
        return Ok(());
    }
    let dimensions = context.graph.shape(target.shape).map_or(3, |s| s.dimensions);
    body.clear();
    body.begin(context.graph, target.shape);
    let (space, arguments) = own_space(body, dimensions, &target.plan.variables);
    let results = body.open(plans, context.graph, &target.plan, &space, &context.uniforms)?;
    let (result, ty) = match target.group {
        Group::Gradient => (body.gradient(&results), "vec4f"),
        _ => (results.first().copied().unwrap_or(0), "f32"),
    };
    let name = context.functions.get(&id).map_or("", |n| n.as_str());
    let _ = writeln!(text, "\nfn {name}({}) -> {ty} {{", arguments.join(", "));
    let words: Vec<&str> = arguments.iter().filter_map(|a| a.split(':').next()).collect();
    let count = write::write(context, body, result, &words, text);
    text.push_str("}\n");
    context.operations.insert(id, count);
    Ok(())
}

/// What the exports compute.
struct Roots<'a> {
    root: ShapeId,
    targets: &'a [(Export, TargetId)],
    surface: Option<&'a Plan>,
    /// What is written of planes and the rest, where rays meet planes apart.
    rest: Option<ahead::Written>,
    ways: Ways,
    solid: Option<Box3>,
}

/// Writes the exports. The answer: operations of the field and of the bound.
fn export_functions(
    context: &mut Context,
    exports: &[Export],
    roots: &Roots,
    body: &mut Body,
    text: &mut String,
) -> Result<(usize, usize), EmitError> {
    let (graph, plans, prefix) = (context.graph, context.plans, context.prefix);
    let mut written: Vec<(TargetId, Export, usize)> = Vec::new();
    let target_of = |export| roots.targets.iter().find(|r| r.0 == export).map(|r| r.1);
    let alike = |target: Option<TargetId>| [Export::Bound, Export::Distance].into_iter().find(|e| target.is_some() && target_of(*e) == target);
    for &export in exports {
        let _ = writeln!(text, "\n// {}", library::purpose(export));
        if matches!(export, Export::Trace | Export::Shadow) {
            context.rounding.unit = unit(context.sums.0, roots.solid);
        }
        if let Some(function) = library::function(export, roots.ways, context.rounding) {
            text.push_str(&prefixed(&function, prefix));
            continue;
        }
        let _ = writeln!(text, "fn {} {{", prefixed(library::signature(export), prefix));
        let target = target_of(export);
        let same = written.iter().find(|w| Some(w.0) == target).copied();
        let count = if let Some((_, other, count)) = same {
            let _ = writeln!(text, "  return {prefix}{}(p);", other.name());
            count
        } else if let Some((rest, count)) = roots.rest.as_ref().zip(alike(target)).and_then(|(written, of)| written.rest(of)) {
            let _ = writeln!(text, "  return min({prefix}{rest}(p), {prefix}planes(p));");
            count
        } else {
            let _ = writeln!(text, "  let q = p + {}.origin;", context.uniform_name);
            context.uniforms.read(UniformSource::Origin);
            body.clear();
            body.begin(graph, roots.root);
            let space = scene_space(graph, roots.root, body, target.is_none());
            let result = match (target, roots.surface) {
                (Some(target), _) => body.whole(plans, graph, target, &space, &context.uniforms)?,
                (None, Some(plan)) => {
                    let results = body.open(plans, graph, plan, &space, &context.uniforms)?;
                    surface_struct(body, &results)
                }
                (None, None) => body.constant(0.0),
            };
            let (rounding, sums) = (context.rounding, context.sums);
            let count = write::write(context, body, result, &["p", "q", "normal"], text);
            // What is drawn on a surface does not move it.
            if target.is_none() {
                (context.rounding, context.sums) = (rounding, sums);
            }
            count
        };
        text.push_str("}\n");
        if let Some(target) = target {
            written.push((target, export, count));
        }
    }
    let count = |export| written.iter().find(|w| w.1 == export).map_or(0, |w| w.2);
    Ok((count(Export::Field), count(Export::Bound)))
}

/// Writes the uniform block, structs, constants and helpers. `buffers`: whether tables are buffers, and not text.
fn declarations(context: &Context, facts: &header::Facts, buffers: bool, wgsl: &mut String) {
    let prefix = context.prefix;
    let Options { group, binding, uniforms, .. } = facts.options;
    let name = &context.uniform_name;
    if *uniforms == Uniforms::Separate {
        for (binding, field) in (*binding..).zip(facts.fields) {
            // The variable's own name is put in with those of all that read it.
            let _ = write!(wgsl, "\n@group({group}) @binding({binding}) var<uniform> {name}.{}: {};", field.name, vector_type(field.components as u8));
        }
        wgsl.push_str(if facts.fields.is_empty() { "" } else { "\n" });
    } else if !facts.fields.is_empty() {
        let _ = write!(wgsl, "\nstruct {prefix}Uniforms {{\n");
        for field in facts.fields {
            let ty = vector_type(field.components as u8);
            let _ = writeln!(wgsl, "  {}: {ty},", field.name);
        }
        let _ = match uniforms {
            Uniforms::Private => write!(wgsl, "}}\n\nvar<private> {name}: {prefix}Uniforms = {prefix}Uniforms({});\n", header::start(facts)),
            _ => write!(wgsl, "}}\n\n@group({group}) @binding({binding}) var<uniform> {name}: {prefix}Uniforms;\n"),
        };
    }
    if context.has_tables() {
        match buffers {
            true => table::text::declare_buffers(prefix, *group, facts.options.first_buffer(facts.fields.len()), wgsl),
            false => table::text::declare_text(context, wgsl),
        }
    }
    for text in facts.exports.iter().filter_map(|e| library::structure(*e)) {
        let _ = write!(wgsl, "\n{}", prefixed(text, prefix));
    }
    if context.helpers.pieces().any(|p| p.name == "clip") {
        let extent = (facts.extent as f32).clamp(f32::MIN_POSITIVE, 1e18);
        let _ = write!(wgsl, "\nconst {prefix}extent: f32 = {extent:?};\n");
    }
    if let Some(region) = facts.region.filter(|_| context.helpers.pieces().any(|p| ["within", "beside"].contains(&p.name))) {
        let corner = |of: fn(Interval) -> f64| region.0.map(|side| format!("{:?}", of(side) as f32)).join(", ");
        // No array: HLSL's front ends take no call for a constant, as which naga writes one.
        let (low, high) = (corner(|i| i.lo), corner(|i| i.hi));
        let _ = write!(wgsl, "\nconst {prefix}region_low = vec3f({low});\nconst {prefix}region_high = vec3f({high});\n");
    }
    let Tables { tables, grids, .. } = context.tables;
    let first = table::HEAD * tables.len() as u32;
    if context.has_shapes() {
        // A text has no heads but those of outlines and figures, after its lists.
        let before = if buffers { first + table::HEAD * grids.len() as u32 } else { table::text::entries(context.tables).iter().map(Vec::len).sum::<usize>() as u32 };
        if context.has_outlines() {
            table::text::heads(context, "outline", before, &context.tables.outlines, wgsl);
        }
        if context.has_figures() {
            table::text::heads(context, "figure", before + table::HEAD * context.tables.outlines.len() as u32, &context.tables.figures, wgsl);
        }
    }
    if context.has_grids() {
        table::text::heads(context, "grid", first, &context.tables.grids, wgsl);
    }
    for piece in context.helpers.pieces().filter(|p| buffers || p.name != "span") {
        let _ = write!(wgsl, "\n{}", prefixed(&with_rounding(piece.text, context.rounding), prefix));
    }
}

fn check_prefix(prefix: &str) -> Result<(), EmitError> {
    let plain = prefix.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    let starts = prefix.is_empty() || prefix.starts_with(|c: char| c.is_ascii_alphabetic());
    // Every name that is a word of WGSL with the prefix before it would have to change; only exports can be.
    let words = Export::ALL.iter().all(|e| {
        let name = format!("{prefix}{}", e.name());
        prefix.is_empty() || !names::is_taken(&name)
    });
    if plain && starts && words { Ok(()) } else { Err(EmitError::Prefix(prefix.to_owned())) }
}

fn group_of(export: Export) -> Option<Group> {
    match export {
        Export::Field => Some(Group::Field),
        Export::Bound => Some(Group::Bound),
        Export::Distance => Some(Group::Distance),
        Export::Gradient => Some(Group::Gradient),
        _ => None,
    }
}

/// What was asked for and can be had, with what it needs, in the order of [`Export`]. `needed` is asked for too.
/// `planes`: whether rays meet planes apart, and follow functions of their own.
fn exports(options: &Options, needed: &[Export], plans: &Plans, root: ShapeId, planes: bool, skipped: &mut Vec<String>) -> Vec<Export> {
    let mut exports = Vec::new();
    for export in Export::ALL {
        if !options.exports.contains(&export) && !needed.contains(&export) {
            continue;
        }
        let all = || library::needs(export).iter().copied().chain([export]);
        let missing = all().find(|e| group_of(*e).is_some_and(|g| !plans.has(root, g)));
        match missing {
            None if planes && matches!(export, Export::Trace | Export::Shadow) => exports.push(export),
            None => exports.extend(all()),
            Some(missing) => skipped.push(format!(
                "{}{}: the scene has no {}",
                options.prefix,
                export.name(),
                missing.name()
            )),
        }
    }
    exports.sort_unstable();
    exports.dedup();
    for export in Export::ALL {
        if !options.exports.contains(&export) && !exports.contains(&export) {
            skipped.push(format!("{}{}: not asked for", options.prefix, export.name()));
        }
    }
    exports
}

/// A name for each function that stands alone.
fn function_names(
    graph: &Graph,
    root: ShapeId,
    plans: &Plans,
    standing: &[TargetId],
    prefix: &str,
    scope: &mut Scope,
) -> FxHashMap<TargetId, String> {
    let mut shapes: FxHashMap<ShapeId, String> = FxHashMap::default();
    let mut parts = 0;
    let mut names = FxHashMap::default();
    for &id in standing {
        let Some(target) = plans.get(id) else { continue };
        let base = shapes.entry(target.shape).or_insert_with(|| {
            let given = graph.shape(target.shape).and_then(|s| s.name.as_deref());
            let text = match given {
                Some(given) => identifier(given),
                None if target.shape == root => "scene".to_owned(),
                None => {
                    parts += 1;
                    numbered("part", parts)
                }
            };
            scope.give(&format!("{prefix}{text}"))
        });
        let name = match target.group.suffix() {
            // The base was given for the shape as a whole.
            "" => base.clone(),
            suffix => scope.give(&format!("{base}{suffix}")),
        };
        names.insert(id, name);
    }
    names
}
