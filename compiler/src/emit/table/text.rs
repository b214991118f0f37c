//! The text of tables: a function for each class, and the loop.

use crate::emit::body::Body;
use crate::emit::code::{Code, ExprId, Read};
use crate::emit::error::EmitError;
use crate::emit::names::{ROW, VARIABLE, numbered, vector_type};
use crate::emit::table::{Action, BEGINS, CLASS_SHIFT, Class, ENDS, HEAD, Number, PUSH, Table, Tables};
use crate::emit::write::{self, Context};
use crate::functions::loop_counters::Turns;
use crate::graph::kernel::Op;
use crate::graph::simplify::Terms;
use crate::interface::UniformSource;
use crate::kept::{Data, Kept};
use std::fmt::Write;

/// Bytes of private variables that every implementation of WGSL takes ("Limits" in its specification).
const MOST_PRIVATE: usize = 8192;
/// How a table is declared that a shader picks from: of a constant, naga's SPIR-V copies all of it at each pick.
const PRIVATE: &str = "var<private>";
const CONSTANT: &str = "const";

/// A loop of so many operations no driver writes out: Mesa stops at 832 (`nir_opt_loop_unroll`: 32 turns of 26).
const LONG: usize = 1000;

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
    let name_of_steps = format!("{name}_step");
    let mut names = Vec::new();
    let mut operations = Vec::new();
    for (i, class) in table.classes.iter().enumerate() {
        let name = context.module.give(&numbered(&name_of_steps, i + 1));
        let arguments = arguments(class, table, ty);
        let _ = writeln!(text, "\nfn {name}({}) -> {ty} {{", arguments.join(", "));
        body.clear();
        let result = open(context, class, table, gradient, body)?;
        let in_rows = table.turns.is_none();
        let pieces = class.numbers.iter().filter_map(|n| Some(n.column()? / 4 + 1)).max().unwrap_or(0);
        let prefix = context.prefix;
        let mut words: Vec<String> = ["p", "d", "aside", "row"].map(str::to_owned).to_vec();
        words.extend((0..table.arguments()).map(|i| numbered(VARIABLE, i + 1)));
        for piece in (0..pieces).filter(|_| in_rows) {
            let at = if piece == 0 { "row".to_owned() } else { format!("row + {piece}u") };
            let name = numbered(ROW, piece as usize + 1);
            let _ = writeln!(text, "  let {name} = {prefix}table[{at}];");
            words.push(name);
        }
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        operations.push(write::write(context, body, result, &words, text));
        text.push_str("}\n");
        names.push(name);
    }
    let count = |entry: &u32| operations.get((entry >> CLASS_SHIFT) as usize).copied().unwrap_or(0);
    let operations: usize = table.entries.iter().map(count).sum();
    let p = context.prefix;
    let start = match gradient {
        false => format!("{:?}", table.start),
        true => format!("vec4f(0.0, 0.0, 0.0, {:?})", table.start),
    };
    let point = vector_type(table.dimensions);
    let variables = |ty: &str| -> String { (0..table.variables).map(|i| format!(", {}{ty}", numbered(VARIABLE, i + 1))).collect() };
    let (declared, given) = (variables(": f32"), variables(""));
    if let (Some(turns), Some(class)) = (&table.turns, names.first()) {
        let _ = write!(text, "\nfn {name}(p: {point}{declared}) -> {ty} {{\n  var d = {start};\n");
        // Of a short loop drivers look up uniforms to write it out. Of a long one they don't, and what is the same for all points is faster: the point is nought but beyond all numbers.
        let first = if operations < LONG {
            "select(0, 1, p.x > 3e38)".to_owned()
        } else {
            context.uniforms.read(UniformSource::Origin);
            format!("min(i32(abs({}.origin.x)), 0)", context.uniform_name)
        };
        count_turns(turns, &format!("d = {class}(p{given}"), &first, text);
        text.push_str("  return d;\n}\n");
        return Ok(operations);
    }
    context.helpers.need("span");
    let place = if table.dimensions == 3 { "p" } else { "vec3f(p, 0.0)" };
    let span = format!("{p}span({}u, {place})", HEAD * table.index);
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
    Ok(operations)
}

/// Writes a loop in which a call that has begun is given what loops within each other count. It is one, whose counters are carried over as digits are, and where it begins (`first`) is no constant:
/// drivers write out all turns of a loop if they know how often it goes around.
fn count_turns(turns: &Turns, call: &str, first: &str, text: &mut String) {
    let of = |at: usize| turns.columns.iter().filter(move |(own, ..)| *own == at).map(|&(_, first, turn)| (first, turn));
    // A counter is the number itself where a turn adds one to the same whole number.
    let start = |at: usize| {
        let first = of(at).next().map_or(0.0, |column| column.0);
        let is_plain = first.fract() == 0.0 && first.abs() < 1e6 && of(at).all(|column| column == (first, 1.0));
        (if is_plain { first } else { 0.0 }, is_plain)
    };
    let _ = writeln!(text, "  // Nought, which no driver knows: so none writes out the turns.\n  let first = {first};");
    for at in 0..turns.counts.len() {
        let _ = writeln!(text, "  var {} = {:?};", counter(at), start(at).0);
    }
    let total: u32 = turns.counts.iter().product();
    let _ = write!(text, "  for (var i = first; i < {total}; i++) {{\n    {call}");
    for &(at, first, turn) in &turns.columns {
        let counter = counter(at);
        let _ = if start(at).1 { write!(text, ", {counter}") } else { write!(text, ", {first:?} + {turn:?} * {counter}") };
    }
    text.push_str(", d);\n");
    for (at, &count) in turns.counts.iter().enumerate().rev() {
        let (counter, over) = (counter(at), over(at));
        let more = if at + 1 == turns.counts.len() { "1.0".to_owned() } else { format!("select(0.0, 1.0, {})", self::over(at + 1)) };
        let _ = writeln!(text, "    {counter} += {more};");
        if at > 0 {
            let (first, _) = start(at);
            let _ = writeln!(text, "    let {over} = {counter} > {:?};\n    {counter} = select({counter}, {first:?}, {over});", first + count as f32 - 0.5);
        }
    }
    text.push_str("  }\n");
}

/// What a loop counts, and whether that has to begin anew.
fn counter(at: usize) -> String {
    numbered("i", at + 1)
}

fn over(at: usize) -> String {
    numbered("over", at + 1)
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

impl Table {
    /// How many numbers the function of a class is given beside the point: those of the union, then those that loops count.
    fn arguments(&self) -> usize {
        self.variables + self.turns.as_ref().map_or(0, |turns| turns.columns.len())
    }
}

fn arguments(class: &Class, table: &Table, ty: &str) -> Vec<String> {
    let mut arguments = Vec::new();
    if class.pops {
        arguments.extend([format!("d: {ty}"), format!("aside: {ty}")]);
    } else {
        arguments.push(format!("p: {}", vector_type(table.dimensions)));
        arguments.extend((0..table.arguments()).map(|i| format!("{}: f32", numbered(VARIABLE, i + 1))));
        arguments.push(format!("d: {ty}"));
    }
    if table.turns.is_none() && class.numbers.iter().any(|n| n.column().is_some()) {
        arguments.push("row: u32".to_owned());
    }
    arguments
}

/// The expressions of a class.
fn open(context: &Context, class: &Class, table: &Table, gradient: bool, body: &mut Body) -> Result<ExprId, EmitError> {
    let (form, dimensions) = (&class.filled.form, table.dimensions);
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
                    let value = if table.turns.is_some() {
                        body.add(Code::Variable(table.variables as u32 + c), &[])
                    } else {
                        let piece = body.add(Code::Row(c / 4), &[]);
                        body.component(piece, (c % 4) as u8)
                    };
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

/// Declares the tables as buffers, from a binding on.
pub fn declare_buffers(prefix: &str, group: u32, binding: u32, wgsl: &mut String) {
    for (i, (name, ty)) in [("table", "vec4f"), ("lists", "u32")].into_iter().enumerate() {
        let binding = binding as usize + i;
        let _ = write!(wgsl, "\n@group({group}) @binding({binding}) var<storage, read> {prefix}{name}: array<{ty}>;\n");
    }
}

/// Writes the function that says where the head of a grid, an outline or a figure stands: that of the first at `first`, in words.
pub fn heads<T>(context: &Context, name: &str, first: u32, all: &[Kept<T>], wgsl: &mut String) {
    let _ = write!(wgsl, "\n// Where the head of the {name} of a number stands.\nfn {}{name}_head({name}: f32) -> u32 {{\n", context.prefix);
    for (kept, at) in all.iter().skip(1).zip(1..) {
        let _ = writeln!(wgsl, "  if {name} == {:?} {{\n    return {}u;\n  }}", kept.number, first + HEAD * at);
    }
    let _ = write!(wgsl, "  return {first}u;\n}}\n");
}

/// Entries of the lists that stand in a text before the heads of the outlines and the figures.
pub fn entries(tables: &Tables) -> Vec<Vec<u32>> {
    let mut all: Vec<&Table> = tables.tables.values().collect();
    all.sort_unstable_by_key(|t| t.index);
    all.into_iter().map(|t| t.fused(t.entries.iter().copied())).collect()
}

/// The outlines and the figures as words from a place on: their heads, and what these name.
fn shape_words(tables: &Tables, first: usize) -> Vec<u32> {
    let count = tables.outlines.len() + tables.figures.len();
    let mut words = vec![0; HEAD as usize * count];
    for at in 0..count {
        let begin = (first + words.len()) as u32;
        let outline = || tables.outlines.get(at).map(|kept| kept.data.words(begin));
        let figure = || tables.figures.get(at - tables.outlines.len()).map(|kept| kept.data.words(begin));
        let Some((head, rest)) = outline().or_else(figure) else { continue };
        if let Some(slot) = words.get_mut(HEAD as usize * at..HEAD as usize * (at + 1)) {
            slot.copy_from_slice(&head);
        }
        words.extend(rest);
    }
    words
}

/// Declares the tables as text, so that the module needs nothing else.
pub fn declare_text(context: &Context, wgsl: &mut String) {
    let p = context.prefix;
    let Tables { rows, tables, .. } = context.tables;
    let lists = entries(context.tables);
    let mut entries: Vec<u32> = lists.concat();
    if context.has_shapes() {
        entries.extend(shape_words(context.tables, entries.len()));
    }
    if entries.is_empty() {
        // No array is empty.
        entries.push(0);
    }
    let bytes = size_of::<[f32; 4]>() * rows.len().max(1) + size_of::<u32>() * entries.len();
    let held = if bytes <= MOST_PRIVATE { PRIVATE } else { CONSTANT };
    if !tables.is_empty() {
        let _ = write!(wgsl, "\n// The numbers of what differs in numbers alone.\n{held} {p}table = array<vec4f, {}>(\n", rows.len().max(1));
        for [x, y, z, w] in rows {
            let _ = writeln!(wgsl, "  vec4f({x:?}, {y:?}, {z:?}, {w:?}),");
        }
        if rows.is_empty() {
            wgsl.push_str("  vec4f(0.0),\n");
        }
        wgsl.push_str(");\n");
    }
    let what = match (tables.is_empty(), context.has_shapes()) {
        (false, false) => "What is united, one after the other: what is done, and below that its row.",
        (true, _) => "Outlines: their cells, the lists of these, and the pieces. Figures: their boxes and the pieces.",
        (false, true) => "What is united, one after the other: what is done, and below that its row. Then outlines: their cells, the lists of these, and the pieces; and figures: their boxes and the pieces.",
    };
    let _ = write!(wgsl, "\n// {what}\n{held} {p}lists = array<u32, {}>(\n", entries.len());
    for line in entries.chunks(12) {
        let words: Vec<String> = line.iter().map(|e| format!("{e}u")).collect();
        let _ = writeln!(wgsl, "  {},", words.join(", "));
    }
    wgsl.push_str(");\n");
    if tables.is_empty() {
        return;
    }
    let _ = write!(wgsl, "\n// Where the list of a union begins and ends.\nfn {p}span(head: u32, p: vec3f) -> vec2u {{\n  switch head {{\n");
    let mut first = 0;
    let mut all: Vec<&Table> = tables.values().collect();
    all.sort_unstable_by_key(|t| t.index);
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
