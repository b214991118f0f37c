//! From the graph to WGSL: a module that another program can paste, with names that its reader knows.
//!
//! [`plan`] finds the formulas that are needed and decides which become functions; [`body`] opens the others where they are
//! called; [`write`] turns expressions into text; [`library`] holds the WGSL that is the same for every scene. Nothing that
//! nobody reads is emitted, and the same source gives the same bytes. The graph is only read.

mod body;
mod header;
mod library;
mod names;
mod plan;
mod translate;
mod uniforms;
mod vector;
mod write;

#[cfg(test)]
mod tests;

pub use translate::{Target, translate, validate};

use crate::compiled::{Export, Live, Module, Options, Parameter, SceneBlocks, UniformSource};
use crate::functions::Functions;
use crate::graph::kernel::Terms;
use crate::graph::{Function, Graph, ShapeId, WORLD};
use body::{Body, Code, Space, world_count};
use library::Helpers;
use names::{Scope, identifier};
use plan::{Group, Plans, TargetId};
use rustc_hash::FxHashMap;
use std::borrow::Cow;
use std::fmt;
use std::fmt::Write;
use uniforms::Candidates;

/// Why there is no module. The compiler itself is at fault, or the prefix.
#[derive(Clone, Debug, PartialEq)]
pub enum EmitError {
    /// The prefix can't start a name of WGSL.
    Prefix(String),
    /// A function that is called has no formula.
    NoFormula(ShapeId, Function),
    /// A shape's function needs itself.
    Cycle(ShapeId),
    /// A component that is no parameter's.
    NoParameter(u32),
    /// A variable that nothing binds.
    Unbound(u32),
    /// A formula that is not a surface's reads the normal.
    NormalOutsideSurface,
}

impl fmt::Display for EmitError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            EmitError::Prefix(prefix) => write!(
                f,
                "`{prefix}` can't start the names of a module: take letters, digits and `_`, a letter first, and no WGSL keyword"
            ),
            EmitError::NoFormula(shape, function) => {
                write!(f, "shape {} is asked for its {function:?} and has no formula for it", shape.0)
            }
            EmitError::Cycle(shape) => write!(f, "shape {} is made of itself", shape.0),
            EmitError::NoParameter(i) => write!(f, "no parameter has the component {i}"),
            EmitError::Unbound(v) => write!(f, "nothing binds variable {v}"),
            EmitError::NormalOutsideSurface => {
                f.write_str("only a material may read the normal")
            }
        }
    }
}

impl std::error::Error for EmitError {}

/// The module of a scene: the functions that `options` asks for, and what they need.
pub fn emit(
    graph: &Graph,
    root: ShapeId,
    functions: &Functions,
    blocks: &SceneBlocks,
    parameters: &[Parameter],
    options: &Options,
) -> Result<Module, EmitError> {
    let prefix = &options.prefix;
    check_prefix(prefix)?;
    let mut plans = Plans::new(graph, functions);
    let mut skipped = Vec::new();
    let exports = exports(options, &plans, root, &mut skipped);

    // Plans: what the exports of this scene compute.
    let mut roots: Vec<(Export, TargetId)> = Vec::new();
    for &export in &exports {
        if let Some(group) = group_of(export) {
            let target = plans.target(root, group);
            roots.push((export, target));
        }
    }
    let surface = exports.contains(&Export::Surface).then(|| {
        let s = &functions.surface;
        let mut nodes = Vec::from(s.color);
        nodes.extend(s.emission);
        nodes.extend([s.roughness, s.metallic, s.reflectivity]);
        let variables = graph.shape(root).map(|s| s.variables.clone()).unwrap_or_default();
        plans.plan(&nodes, variables)
    });
    // Exports that are the same function are computed once.
    let mut counted: Vec<(TargetId, u64)> = Vec::new();
    for &(_, target) in &roots {
        if !counted.iter().any(|c| c.0 == target) {
            counted.push((target, 1));
        }
    }
    let standing = plans.complete(&counted, surface.as_ref())?;

    // Names: of the exports and the library first, so that none is taken from them.
    let mut module_names = Scope::default();
    let name = |text: &str| format!("{prefix}{text}");
    for export in Export::ALL {
        module_names.reserve(&name(export.name()));
    }
    for text in library::STRUCTURES.into_iter().chain(library::HELPERS.iter().map(|h| h.name)) {
        module_names.reserve(&name(text));
    }
    for text in ["extent", "vertex", "fragment", "Uniforms", "uniforms"] {
        module_names.reserve(&name(text));
    }
    let uniform_name = name("uniforms");
    let names = function_names(graph, root, &plans, &standing, prefix, &mut module_names);

    // Functions of shapes, callees first, then the exports.
    let mut uniforms = Candidates::new(graph, parameters);
    let mut helpers = Helpers::default();
    let mut operations: FxHashMap<TargetId, usize> = FxHashMap::default();
    let mut shapes_text = String::with_capacity(64 * graph.len().min(100_000));
    for &id in &standing {
        let Some(target) = plans.get(id) else { continue };
        let variables = &target.plan.variables;
        let dimensions = graph.shape(target.shape).map_or(3, |s| s.dimensions);
        let mut body = Body::with_capacity(2 * target.plan.steps.len());
        let (space, arguments) = own_space(&mut body, dimensions, variables);
        let results = body.open(&plans, graph, &target.plan, &space, &uniforms)?;
        let gradient = target.group == Group::Gradient;
        let result = if gradient { body.gradient(&results) } else { results.first().copied().unwrap_or(0) };
        let text = &mut shapes_text;
        let function_name = names.get(&id).map_or("", |n| n.as_str());
        let _ = write!(text, "\nfn {function_name}({})", arguments.join(", "));
        let _ = writeln!(text, " -> {} {{", if gradient { "vec4f" } else { "f32" });
        let words: Vec<&str> = arguments.iter().filter_map(|a| a.split(':').next()).collect();
        let mut context = write::Context {
            graph,
            plans: &plans,
            functions: &names,
            operations: &operations,
            module: &module_names,
            prefix,
            uniform_name: &uniform_name,
            uniforms: &mut uniforms,
            helpers: &mut helpers,
        };
        let count = write::write(&mut context, &mut body, result, &words, text);
        text.push_str("}\n");
        operations.insert(id, count);
    }

    let mut exports_text = String::with_capacity(16_384);
    let mut written: Vec<(TargetId, Export, usize)> = Vec::new();
    let mut counts = [0usize; 2];
    for &export in &exports {
        let text = &mut exports_text;
        let signature = prefixed(library::signature(export), prefix);
        if let Some(function) = library::function(export) {
            let _ = write!(text, "\n// {}\n{}", library::purpose(export), prefixed(function, prefix));
            continue;
        }
        let _ = write!(text, "\n// {}\nfn {signature} {{\n", library::purpose(export));
        let target = roots.iter().find(|r| r.0 == export).map(|r| r.1);
        let same = written.iter().find(|w| Some(w.0) == target).copied();
        let count = match same {
            Some((_, other, count)) => {
                let _ = writeln!(text, "  return {prefix}{}(p);", other.name());
                count
            }
            None => {
                let _ = writeln!(text, "  let q = p + {uniform_name}.origin;");
                uniforms.read(UniformSource::Origin);
                let mut body = Body::with_capacity(256);
                let space = scene_space(graph, root, &mut body, target.is_none());
                let result = match (target, &surface) {
                    (Some(target), _) => body.whole(&plans, graph, target, &space, &uniforms)?,
                    (None, Some(plan)) => {
                        let results = body.open(&plans, graph, plan, &space, &uniforms)?;
                        surface_struct(&mut body, &results)
                    }
                    (None, None) => body.constant(0.0),
                };
                let mut context = write::Context {
                    graph,
                    plans: &plans,
                    functions: &names,
                    operations: &operations,
                    module: &module_names,
                    prefix,
                    uniform_name: &uniform_name,
                    uniforms: &mut uniforms,
                    helpers: &mut helpers,
                };
                write::write(&mut context, &mut body, result, &["p", "q", "normal"], text)
            }
        };
        text.push_str("}\n");
        if let Some(target) = target {
            written.push((target, export, count));
        }
        match export {
            Export::Field => counts[0] = count,
            Export::Bound => counts[1] = count,
            _ => {}
        }
    }

    // What the library reads.
    let traces = exports.iter().any(|e| matches!(e, Export::Trace | Export::Shadow));
    if traces {
        helpers.need("clip");
    }
    if exports.contains(&Export::Occlusion) {
        uniforms.read(UniformSource::OcclusionReach);
        uniforms.read(UniformSource::OcclusionStrength);
    }
    let (fields, size) = uniforms.layout();
    skipped.extend(header::unread(parameters, &uniforms));
    let facts = header::Facts {
        graph,
        exports: &exports,
        options,
        uniforms: &uniforms,
        fields: &fields,
        size,
        parameters,
        occlusion: blocks.occlusion(graph, &Live::start(graph)),
        extent: blocks.extent,
    };
    let mut wgsl = header::write(&facts);
    if !fields.is_empty() {
        let _ = write!(wgsl, "\nstruct {prefix}Uniforms {{\n");
        for field in &fields {
            let ty = write::vector_type(field.components as u8);
            let _ = writeln!(wgsl, "  {}: {ty},", field.name);
        }
        let (group, binding) = (options.group, options.binding);
        let _ = write!(
            wgsl,
            "}}\n\n@group({group}) @binding({binding}) var<uniform> {uniform_name}: {prefix}Uniforms;\n"
        );
    }
    for &export in &exports {
        if let Some(text) = library::structure(export) {
            let _ = write!(wgsl, "\n{}", prefixed(text, prefix));
        }
    }
    if traces {
        let extent = (blocks.extent as f32).clamp(f32::MIN_POSITIVE, 1e18);
        let _ = write!(wgsl, "\nconst {prefix}extent: f32 = {extent:?};\n");
    }
    for piece in helpers.pieces() {
        let _ = write!(wgsl, "\n{}", prefixed(piece.text, prefix));
    }
    wgsl.push_str(&shapes_text);
    wgsl.push_str(&exports_text);
    Ok(Module {
        wgsl,
        exports,
        uniform_name: if fields.is_empty() { String::new() } else { uniform_name },
        uniforms: fields,
        uniform_size: size,
        operations: (counts[0], counts[1]),
        skipped,
    })
}

/// Text of the library under the prefix of a module.
fn prefixed<'t>(text: &'t str, prefix: &str) -> Cow<'t, str> {
    if prefix == "sf_" { Cow::Borrowed(text) } else { Cow::Owned(text.replace("sf_", prefix)) }
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

/// What was asked for and can be had, with what it needs, in the order of [`Export`].
fn exports(options: &Options, plans: &Plans, root: ShapeId, skipped: &mut Vec<String>) -> Vec<Export> {
    let mut exports = Vec::new();
    for export in Export::ALL {
        if !options.exports.contains(&export) {
            continue;
        }
        let all = || library::needs(export).iter().copied().chain([export]);
        let missing = all().find(|e| group_of(*e).is_some_and(|g| !plans.has(root, g)));
        match missing {
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
                    format!("part_{parts}")
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

/// The space of a function of a shape, and the function's arguments.
fn own_space(body: &mut Body, dimensions: u8, variables: &[u32]) -> (Space, Vec<String>) {
    let mut arguments = vec![format!("p: {}", write::vector_type(dimensions))];
    let p = body.add(Code::Point(dimensions), &[]);
    let x = body.component(p, 0);
    let y = body.component(p, 1);
    let z = if dimensions == 3 { body.component(p, 2) } else { body.constant(0.0) };
    let mut bound = Vec::with_capacity(variables.len());
    let world = world_count(variables);
    if world == 3 {
        arguments.push("world: vec3f".to_owned());
        let vector = body.add(Code::World, &[]);
        bound.extend([0, 1, 2].map(|i| body.component(vector, i)));
    }
    for i in 0..variables.len() - world {
        arguments.push(format!("k{i}: f32"));
        bound.push(body.add(Code::Variable(i as u32), &[]));
    }
    (Space { point: [x, y, z], normal: None, variables: bound }, arguments)
}

/// The space of the scene. Its point is `q`: the module's `p` and the origin.
fn scene_space(graph: &Graph, root: ShapeId, body: &mut Body, surface: bool) -> Space {
    let q = body.add(Code::Scene, &[]);
    let point = [0, 1, 2].map(|i| body.component(q, i));
    let variables = graph.shape(root).map(|s| s.variables.clone()).unwrap_or_default();
    // A scene has no variable but its own point; another is found when its formula is opened.
    let known = variables.iter().take_while(|&&v| v < WORLD + 3);
    let variables = known.filter_map(|&v| point.get(v as usize).copied()).collect();
    let normal = surface.then(|| body.add(Code::Normal, &[]));
    Space { point, normal, variables }
}

fn surface_struct(body: &mut Body, results: &[body::ExprId]) -> body::ExprId {
    let (vectors, numbers) = results.split_at_checked(6).unwrap_or((results, &[]));
    let mut fields: Vec<body::ExprId> = vectors.chunks(3).map(|v| body.vector(v)).collect();
    fields.extend_from_slice(numbers);
    body.add(Code::Surface, &fields)
}
