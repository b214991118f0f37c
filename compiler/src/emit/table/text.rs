//! The text of tables: a function for each class, and the loop.

use super::{Action, BEGINS, CLASS_SHIFT, Class, ENDS, Number, PUSH, Table, Tables};
use crate::emit::EmitError;
use crate::emit::body::{Body, Code, ExprId, Read};
use crate::emit::write::{self, Context};
use crate::graph::kernel::Op;
use crate::graph::simplify::Terms;
use std::fmt::Write;

/// Bytes of private variables that every implementation of WGSL takes ("Limits" in its specification).
const MOST_PRIVATE: usize = 8192;
/// How a table is declared that a shader picks from: of a constant, naga's SPIR-V copies all of it at each pick.
const PRIVATE: &str = "var<private>";
const CONSTANT: &str = "const";

/// Numbers in a union's head, which stands at the beginning of the lists.
pub const HEAD: u32 = 16;

/// Writes the function `name` of a union: its value, or its gradient and value. The answer: operations of one evaluation of all operands.
pub fn write(
    context: &mut Context,
    table: &Table,
    gradient: bool,
    name: &str,
    body: &mut Body,
    text: &mut String,
) -> Result<usize, EmitError> {
    let ty = if gradient { "vec4f" } else { "f32" };
    let mut names = Vec::new();
    let mut operations = Vec::new();
    for (i, class) in table.classes.iter().enumerate() {
        let name = context.module.give(&format!("{name}_{}", i + 1));
        let arguments = arguments(class, table, ty);
        let _ = writeln!(text, "\nfn {name}({}) -> {ty} {{", arguments.join(", "));
        body.clear();
        let result = open(context, class, table.dimensions, gradient, body)?;
        let pieces = class.numbers.iter().filter_map(|n| Some(n.column()? / 4 + 1)).max().unwrap_or(0);
        let prefix = context.prefix;
        let mut words: Vec<String> = ["p", "d", "aside", "row"].map(str::to_owned).to_vec();
        words.extend((0..table.variables).map(|i| format!("k{i}")));
        for piece in 0..pieces {
            let at = if piece == 0 { "row".to_owned() } else { format!("row + {piece}u") };
            let _ = writeln!(text, "  let r{piece} = {prefix}table[{at}];");
            words.push(format!("r{piece}"));
        }
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        operations.push(write::write(context, body, result, &words, text));
        text.push_str("}\n");
        names.push(name);
    }
    let p = context.prefix;
    let start = match gradient {
        false => format!("{:?}", table.start),
        true => format!("vec4f(0.0, 0.0, 0.0, {:?})", table.start),
    };
    let point = write::vector_type(table.dimensions);
    context.helpers.need("span");
    let place = if table.dimensions == 3 { "p" } else { "vec3f(p, 0.0)" };
    let span = format!("{p}span({}u, {place})", HEAD * table.index);
    let variables = |ty: &str| -> String { (0..table.variables).map(|i| format!(", k{i}{ty}")).collect() };
    let (declared, given) = (variables(": f32"), variables(""));
    let _ = write!(text, "\nfn {name}(p: {point}{declared}) -> {ty} {{\n  let span = {span};\n  var d = {start};\n");
    let join = table.join();
    // With one value aside at most and one way to join it, each entry is an operand.
    let (alone, stack) = (table.depth == 1 && join.is_some(), table.depth > 0);
    match alone {
        true => _ = writeln!(text, "  var waiting = {start};"),
        false if stack => _ = writeln!(text, "  var waiting: array<{ty}, {}>;\n  var top = 0u;", table.depth),
        false => {}
    }
    let (waiting, up, down) = if alone { ("waiting", "", "") } else { ("waiting[top]", "top += 1u;", "top -= 1u;") };
    let begin = [format!("{waiting} = d;"), up.to_owned(), format!("d = {start};")];
    let call = |i: usize| {
        let (class, name) = table.classes.get(i).zip(names.get(i))?;
        let row = if class.numbers.iter().any(|n| n.column().is_some()) { ", row" } else { "" };
        Some(match class.pops {
            true => [down.to_owned(), format!("d = {name}(d, {waiting}{row});")],
            false => [String::new(), format!("d = {name}(p{given}, d{row});")],
        })
    };
    let block = |by: &str, lines: &[String]| -> String { lines.iter().filter(|l| !l.is_empty()).map(|l| format!("{by}{l}\n")).collect() };
    let _ = writeln!(text, "  for (var i = span.x; i < span.y; i += 1u) {{\n    let step = {p}lists[i];");
    let _ = writeln!(text, "    let row = step & {}u;", (1u32 << CLASS_SHIFT) - 1);
    if join.is_some() {
        let _ = writeln!(text, "    if (step & {BEGINS}u) != 0u {{\n{}    }}", block("      ", &begin));
    }
    let cases: Vec<usize> = (0..table.classes.len()).filter(|&i| !(alone && join == Some(i as u32))).collect();
    match &cases[..] {
        [only] if alone || !stack => text.push_str(&block("    ", call(*only).as_ref().map_or(&[], |lines| lines))),
        _ => {
            let _ = writeln!(text, "    switch (step >> {CLASS_SHIFT}u) & {PUSH}u {{");
            for i in cases {
                let _ = write!(text, "      case {i}u: {{\n{}      }}\n", block("        ", call(i).as_ref().map_or(&[], |lines| lines)));
            }
            if stack && !alone {
                let _ = write!(text, "      case {PUSH}u: {{\n{}      }}\n", block("        ", &begin));
            }
            text.push_str("      default: {}\n    }\n");
        }
    }
    if let Some(lines) = join.and_then(|join| call(join as usize)) {
        let _ = writeln!(text, "    if (step & {ENDS}u) != 0u {{\n{}    }}", block("      ", &lines));
    }
    text.push_str("  }\n  return d;\n}\n");
    let count = |entry: &u32| operations.get((entry >> CLASS_SHIFT) as usize).copied().unwrap_or(0);
    Ok(table.entries.iter().map(count).sum())
}

/// Writes the bound of a union that lies in a region: `field` is its value.
pub fn write_region(context: &mut Context, table: &Table, field: &str, name: &str, text: &mut String) {
    let Some((_, row)) = table.region else { return };
    context.helpers.need("away");
    let p = context.prefix;
    let _ = write!(
        text,
        "\nfn {name}(p: vec3f) -> f32 {{\n  let away = {p}away({row}u, p);\n  if away > 0.0 {{\n    return away;\n  }}\n  return {field}(p);\n}}\n"
    );
}

fn arguments(class: &Class, table: &Table, ty: &str) -> Vec<String> {
    let mut arguments = Vec::new();
    if class.pops {
        arguments.extend([format!("d: {ty}"), format!("aside: {ty}")]);
    } else {
        arguments.push(format!("p: {}", write::vector_type(table.dimensions)));
        arguments.extend((0..table.variables).map(|i| format!("k{i}: f32")));
        arguments.push(format!("d: {ty}"));
    }
    if class.numbers.iter().any(|n| n.column().is_some()) {
        arguments.push("row: u32".to_owned());
    }
    arguments
}

/// The expressions of a class.
fn open(context: &Context, class: &Class, dimensions: u8, gradient: bool, body: &mut Body) -> Result<ExprId, EmitError> {
    let form = &class.filled.form;
    let whole = if gradient { 4 } else { 1 };
    // What is joined, or its component. In the value's own function there is none but the value.
    let joined = |body: &mut Body, code: Code, i: u8| {
        let all = body.add(code, &[]);
        match (gradient, i) {
            (true, i) => body.component(all, i),
            (false, 3) => all,
            (false, _) => body.constant(0.0),
        }
    };
    let (older, newer) = match class.pops {
        true => (Code::Aside(whole), Code::Value(whole)),
        false => (Code::Value(whole), Code::Constant(0)),
    };
    let mut values: Vec<ExprId> = Vec::with_capacity(form.steps.len());
    let mut points = form.points.iter().peekable();
    for (at, step) in form.steps.iter().enumerate() {
        let of = |i: u32| values.get(i as usize).copied().unwrap_or(0);
        let value = match step.action {
            Action::Number(i) => match class.numbers.get(i as usize) {
                Some(number @ (Number::Column(c) | Number::Opposite(c))) => {
                    let piece = body.add(Code::Row(c / 4), &[]);
                    let value = body.component(piece, (c % 4) as u8);
                    if matches!(number, Number::Opposite(_)) { body.op(Op::Neg, &[value]) } else { value }
                }
                Some(Number::Same(number)) => body.constant(*number),
                None => body.constant(0.0),
            },
            Action::Point(i) if i < dimensions => {
                let p = body.add(Code::Point(dimensions), &[]);
                body.component(p, i)
            }
            Action::Point(_) => body.constant(0.0),
            Action::Variable(i) => body.add(Code::Variable(i), &[]),
            Action::Time => body.outside(&context.uniforms, Read::Time)?,
            Action::Parameter(i) => body.outside(&context.uniforms, Read::Parameter(i))?,
            Action::Factor(i) => body.outside(&context.uniforms, Read::Factor(i))?,
            Action::Older(i) => joined(body, older, i),
            Action::Newer(i) => joined(body, newer, i),
            Action::Op(op) => {
                let arguments = step.arguments.map(of);
                body.op(op, arguments.get(..op.row().arity.into()).unwrap_or(&arguments))
            }
        };
        body.name(value, class.filled.names.get(at).copied().flatten());
        values.push(value);
        // The reader sees where each shape has its own space.
        while let Some(point) = points.peek().filter(|p| p.iter().all(|&i| i as usize <= at)) {
            let parts = point.map(|i| values.get(i as usize).copied().unwrap_or(0));
            body.prefer(Some(&parts));
            points.next();
        }
    }
    let results: Vec<ExprId> = form.results.iter().map(|&i| values.get(i as usize).copied().unwrap_or(0)).collect();
    Ok(match (gradient, &results[..]) {
        (true, [_, _, _, _]) => body.gradient(&results),
        _ => results.last().copied().unwrap_or(0),
    })
}

/// Declares the tables as buffers.
pub fn declare_buffers(prefix: &str, group: u32, binding: u32, wgsl: &mut String) {
    for (i, (name, ty)) in [("table", "vec4f"), ("lists", "u32")].into_iter().enumerate() {
        let binding = binding as usize + 1 + i;
        let _ = write!(wgsl, "\n@group({group}) @binding({binding}) var<storage, read> {prefix}{name}: array<{ty}>;\n");
    }
}

/// Declares the tables as text, so that the module needs nothing else.
pub fn declare_text(context: &Context, wgsl: &mut String) {
    let p = context.prefix;
    let Tables { rows, tables, .. } = context.tables;
    let mut all: Vec<&Table> = tables.values().collect();
    all.sort_unstable_by_key(|t| t.index);
    let lists: Vec<Vec<u32>> = all.iter().map(|t| t.fused(t.entries.iter().copied())).collect();
    let entries: Vec<u32> = lists.concat();
    let bytes = size_of::<[f32; 4]>() * rows.len().max(1) + size_of::<u32>() * entries.len();
    let held = if bytes <= MOST_PRIVATE { PRIVATE } else { CONSTANT };
    let _ = write!(wgsl, "\n// The numbers of what differs in numbers alone.\n{held} {p}table = array<vec4f, {}>(\n", rows.len().max(1));
    for [x, y, z, w] in rows {
        let _ = writeln!(wgsl, "  vec4f({x:?}, {y:?}, {z:?}, {w:?}),");
    }
    if rows.is_empty() {
        wgsl.push_str("  vec4f(0.0),\n");
    }
    let _ = write!(wgsl, ");\n\n// What is united, one after the other: what is done, and below that its row.\n{held} {p}lists = array<u32, {}>(\n", entries.len());
    for line in entries.chunks(12) {
        let words: Vec<String> = line.iter().map(|e| format!("{e}u")).collect();
        let _ = writeln!(wgsl, "  {},", words.join(", "));
    }
    let _ = write!(wgsl, ");\n\n// Where the list of a union begins and ends.\nfn {p}span(head: u32, p: vec3f) -> vec2u {{\n  switch head {{\n");
    let mut first = 0;
    for (table, list) in all.into_iter().zip(lists) {
        let end = first + list.len();
        let _ = writeln!(wgsl, "    case {}u: {{ return vec2u({first}u, {end}u); }}", HEAD * table.index);
        first = end;
    }
    wgsl.push_str("    default: { return vec2u(0u, 0u); }\n  }\n}\n");
}

/// The text of a module with its tables as constants, for languages that read those in place; Metal has no private variables at all.
pub fn with_constants(wgsl: &str, prefix: &str) -> String {
    ["table", "lists"].iter().fold(wgsl.to_owned(), |text, name| {
        text.replacen(&format!("\n{PRIVATE} {prefix}{name} = "), &format!("\n{CONSTANT} {prefix}{name} = "), 1)
    })
}
