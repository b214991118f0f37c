//! The comment at a module's head: what it holds, what a host must write, and what was proven.

use crate::analysis::Box3;
use crate::emit::formulas::{Formulas, call_name};
use crate::emit::library;
use crate::emit::names::{identifier, vector_type};
use crate::emit::uniforms::Candidates;
use crate::frame::Frame;
use crate::graph::kernel::Op;
use crate::graph::{Factor, Graph, Proof, narrow};
use crate::interface::{Export, Options, Parameter, Uniform, UniformSource, Uniforms};
use crate::source::{Sources, written};
use crate::syntax::ast::Type;
use rustc_hash::FxHashSet;
use std::fmt::Write;

/// What the comment speaks of.
pub struct Facts<'a> {
    /// For factors.
    pub graph: &'a Graph,
    /// For the places of factors.
    pub sources: &'a Sources,
    /// The functions of the module.
    pub exports: &'a [Export],
    /// Prefix, group and binding.
    pub options: &'a Options,
    /// Live values.
    pub uniforms: &'a Candidates,
    /// What the host computes.
    pub formulas: &'a Formulas,
    /// Those that are read, laid out.
    pub fields: &'a [Uniform],
    /// Size of the block.
    pub size: u32,
    /// Defaults, ranges and descriptions.
    pub parameters: &'a [Parameter],
    /// Reach and strength of occlusion at the start.
    pub occlusion: (f64, f64),
    /// Radius of the scene.
    pub extent: f64,
    /// A box that holds what is solid, but planes.
    pub region: Option<Box3>,
    /// The scene at the start, where the module draws it.
    pub frame: Option<&'a Frame>,
}

/// The comment, and the lines in it of what a host computes.
pub fn write(facts: &Facts) -> (String, Vec<String>) {
    let mut text = String::from(
        "// A signed distance field, compiled by Surefoot: negative inside, positive outside.\n//\n",
    );
    for &export in facts.exports {
        let signature = library::signature(export).replace("sf_", &facts.options.prefix);
        let _ = writeln!(text, "//   {signature}");
    }
    if facts.frame.is_some() {
        let prefix = &facts.options.prefix;
        let _ = writeln!(text, "//   {prefix}vertex, {prefix}fragment: entry points that draw the scene: three vertices, no buffers, colour and depth");
    }
    if facts.fields.is_empty() {
        return (text, Vec::new());
    }
    let Options { group, binding, .. } = facts.options;
    let _ = write!(
        text,
        "//\n// Points are relative to `origin`, a point of the scene: zero, or near the eye where coordinates are large.\n//\n\
         {}:\n//\n",
        match facts.options.uniforms {
            Uniforms::Block => format!("// The uniform block (group {group}, binding {binding}) has {} bytes", facts.size),
            Uniforms::Private => format!("// What can be set is a private variable, {}uniforms. Whoever calls a function sets its fields before", facts.options.prefix),
            Uniforms::Separate => format!("// What can be set are uniform variables of group {group}; {} stands before each name", facts.options.prefix),
        }
    );
    let start = values(facts);
    // What is not in the block stands in no place of it.
    let inputs = facts.uniforms.all.iter().filter(|c| c.computes && !c.read);
    let inputs = inputs.map(|c| Uniform { name: c.name.clone(), source: c.source, components: c.components.into(), offset: u32::MAX });
    let fields: Vec<Uniform> = facts.fields.iter().cloned().chain(inputs).collect();
    let rows: Vec<[String; 5]> = (0..).zip(&fields).map(|(i, f)| row(facts, &start, (i, f))).collect();
    let place = if facts.options.uniforms == Uniforms::Separate { "binding" } else { "offset" };
    let head = [place, "type", "name", "default", "range"];
    let mut widths = head.map(str::len);
    for row in &rows {
        for (width, cell) in widths.iter_mut().zip(row) {
            *width = (*width).max(cell.chars().count());
        }
    }
    let mut line = |cells: [&str; 5], about: &str| {
        let mut row = String::from("//  ");
        for (i, (cell, width)) in cells.iter().zip(widths).enumerate() {
            let _ = match i {
                0 => write!(row, " {cell:>width$}"),
                _ => write!(row, "  {cell:<width$}"),
            };
        }
        if !about.is_empty() {
            let _ = write!(row, "  {about}");
        }
        let _ = writeln!(text, "{}", row.trim_end());
    };
    line(head, "");
    for (field, row) in fields.iter().zip(&rows) {
        let [a, b, c, d, e] = row;
        line([a, b, c, d, e], &one_line(&about(facts, field)));
    }
    let lines = computed(facts, &mut text);
    let extent = number(facts.extent);
    let has_factor = facts.fields.iter().any(|f| matches!(f.source, UniformSource::Factor(_)));
    if has_factor {
        let unproven = facts.graph.factors.iter().any(|f| f.proof == Proof::Measured);
        let but = if unproven { "// Those that are UNPROVEN may be too large: rays may step through.\n" } else { "" };
        let _ = write!(
            text,
            "//\n// A factor says how far a ray may step: the field times it is a bound. Each holds for every value that the\n\
             // parameters can take within their ranges, up to a distance of {extent} from the scene's own origin.\n{but}"
        );
    }
    let traces = |e: &Export| matches!(e, Export::Trace | Export::Shadow);
    if facts.exports.iter().any(traces) {
        let _ = write!(
            text,
            "//\n// Beyond a distance of {extent} from the scene's own origin nothing is traced.\n"
        );
    }
    (text, lines)
}

fn number(value: f64) -> String {
    format!("{}", value as f32)
}

fn numbers(values: &[f64]) -> String {
    values.iter().map(|v| number(*v)).collect::<Vec<_>>().join(", ")
}

fn parameter<'a>(facts: &Facts<'a>, field: &Uniform) -> Option<&'a Parameter> {
    let candidate = facts.uniforms.all.iter().find(|c| c.source == field.source)?;
    facts.parameters.get(candidate.parameter?)
}

fn row(facts: &Facts, start: &[f64], (place, field): (u32, &Uniform)) -> [String; 5] {
    let range = match field.source {
        UniformSource::Parameter(_) => {
            let same = |v: &[f64]| match v {
                [first, rest @ ..] if rest.iter().all(|x| x == first) => number(*first),
                _ => format!("({})", numbers(v)),
            };
            parameter(facts, field).map_or(String::new(), |p| format!("{}..{}", same(&p.min), same(&p.max)))
        }
        UniformSource::OcclusionReach => "0 or more".to_owned(),
        UniformSource::OcclusionStrength => "0..1".to_owned(),
        _ => String::new(),
    };
    let default = numbers(&value(facts, start, field));
    let ty = vector_type(field.components as u8).to_owned();
    let place = match facts.options.uniforms {
        _ if field.offset == u32::MAX => "-".to_owned(),
        Uniforms::Separate => (facts.options.binding + place).to_string(),
        _ => field.offset.to_string(),
    };
    [place, ty, field.name.clone(), default, range]
}

/// The value of a field at the start, of the values of all formulas then.
fn value(facts: &Facts, start: &[f64], field: &Uniform) -> Vec<f64> {
    match field.source {
        UniformSource::Origin => vec![0.0; 3],
        UniformSource::Time => vec![0.0],
        UniformSource::Parameter(_) => parameter(facts, field).map_or(Vec::new(), |p| p.default.clone()),
        UniformSource::OcclusionReach => vec![facts.occlusion.0],
        UniformSource::OcclusionStrength => vec![facts.occlusion.1],
        UniformSource::Factor(i) => facts.graph.factors.get(i as usize).map_or(Vec::new(), |f| vec![f.multiple().into()]),
        UniformSource::Formula(of) => (0..field.components).map(|i| facts.formulas.component(start, of, i).into()).collect(),
        UniformSource::View(of) => facts.frame.map_or(Vec::new(), |frame| frame.view(of)),
    }
}

/// The values of all fields at the start, as a struct of them is made.
pub fn start(facts: &Facts) -> String {
    let start = values(facts);
    let one = |field: &Uniform| {
        let numbers: Vec<String> = value(facts, &start, field).iter().map(|v| format!("{:?}", narrow(*v))).collect();
        if field.components == 1 { numbers.concat() } else { format!("{}({})", vector_type(field.components as u8), numbers.join(", ")) }
    };
    facts.fields.iter().map(one).collect::<Vec<_>>().join(", ")
}

/// The values of all formulas at the start.
fn values(facts: &Facts) -> Vec<f64> {
    facts.formulas.values(0.0, |i| facts.graph.parameters.get(i as usize).map_or(0.0, |p| p.default))
}

/// A line break, as in a description or a file's name, would end the comment.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn about(facts: &Facts, field: &Uniform) -> String {
    match field.source {
        UniformSource::Origin => "the point of the scene at which p is zero".to_owned(),
        UniformSource::Time => "seconds".to_owned(),
        UniformSource::Parameter(_) => {
            let Some(p) = parameter(facts, field) else { return String::new() };
            // Another name than in the scene, where two would be one or a word is WGSL's own.
            let renamed = (field.name != identifier(&p.name)).then(|| format!("`{}` of the scene", p.name));
            let unit = match p.ty {
                _ if p.degrees => Some("radians"),
                Type::Int => Some("a whole number"),
                Type::Bool => Some("0 or 1"),
                _ => None,
            };
            let notes = [renamed, unit.map(str::to_owned), p.description.clone()];
            notes.into_iter().flatten().filter(|note| !note.is_empty()).collect::<Vec<_>>().join("; ")
        }
        UniformSource::OcclusionReach => "how far occlusion reaches".to_owned(),
        UniformSource::OcclusionStrength => "how strong occlusion is".to_owned(),
        UniformSource::Factor(i) => match facts.graph.factors.get(i as usize) {
            Some(f) => factor(facts.sources, f),
            None => String::new(),
        },
        UniformSource::Formula(_) => "computed: see below".to_owned(),
        UniformSource::View(field) => field.about().to_owned(),
    }
}

/// What a host computes, and from what.
fn computed(facts: &Facts, text: &mut String) -> Vec<String> {
    let of = |f: &Uniform| match f.source {
        UniformSource::Formula(field) => Some(field),
        _ => None,
    };
    let fields: Vec<(u32, &str)> = facts.fields.iter().filter_map(|f| Some((of(f)?, f.name.as_str()))).collect();
    if fields.is_empty() {
        return Vec::new();
    }
    let (lines, functions) = facts.formulas.lines(&fields, &|i| facts.uniforms.component_name(i));
    text.push_str(
        "//\n// What depends on parameters and time alone is computed once a frame, best in 64 bits. A host in which one of them changes writes\n\
         // these too, in this order; what has no offset above stands in no place of the block:\n//\n",
    );
    for line in &lines {
        let _ = writeln!(text, "//   {line}");
    }
    // What is the same in every language needs no word.
    let known = |op: &Op| op.row().wgsl.starts_with(&format!("{}({{0}}", call_name(*op)));
    let mut lines = lines;
    for op in functions.into_iter().filter(|op| !known(op)) {
        let row = op.row();
        let letters = match op {
            Op::Select => ["c", "a", "b", ""],
            Op::TurnU | Op::TurnV => ["u", "v", "t", ""],
            _ => ["a", "b", "c", "d"],
        };
        let letters = letters.get(..row.arity.into()).unwrap_or(&[]);
        let line = format!("in which {}({}) is: {}", call_name(op), letters.join(", "), row.doc);
        let _ = writeln!(text, "//   {line}");
        lines.push(line);
    }
    lines
}

/// How a factor is known and what it comes from. Of the file only its own name, so that the same text gives the same module in any folder.
fn factor(sources: &Sources, factor: &Factor) -> String {
    let (_, operation) = written(sources, factor.span);
    let (file, line, column) = sources.position(factor.span.file, factor.span.start);
    let file = file.rsplit(['/', '\\']).next().unwrap_or(file);
    let proof = match factor.proof {
        Proof::Measured => "UNPROVEN, measured at samples",
        other => other.name(),
    };
    format!("factor: {proof}, {operation} at {file}:{line}:{column}")
}

/// The parameters that are in the text and not in the module, and why. `by_blocks` are the components that cameras, lights and the like read.
pub fn unread(parameters: &[Parameter], uniforms: &Candidates, by_blocks: &FxHashSet<u32>) -> Vec<String> {
    let mut out = Vec::new();
    for (index, parameter) in parameters.iter().enumerate() {
        let read = uniforms.all.iter().any(|c| c.parameter == Some(index) && (c.read || c.computes));
        if parameter.first.is_none() {
            out.push(format!("{}: a choice among names is part of the text of the module", parameter.name));
        } else if !read && parameter.components().any(|c| by_blocks.contains(&c)) {
            out.push(format!("{}: no function of the module reads it, only what stands around the scene: cameras, lights and the like", parameter.name));
        } else if !read {
            out.push(format!("{}: nothing in the module reads it", parameter.name));
        }
    }
    out
}
