//! The graph as text, for people and tests, and the text as a graph.
//!
//! One line is one node: `%12 = sub %3 %7 "d" @0:40..52` with its name and its place in the source, where it has them. The nodes
//! of a shape or a material stand in its block, each in the first block that needs it; what no shape needs follows at the end.

use super::kernel::{KERNEL, Op};
use super::{
    Claim, ClaimGroup, Exactness, Factor, Function, Graph, Leaf, Material, MaterialId, Node, NodeId,
    ParameterComponent, Shape, ShapeId, ValueRange,
};
use crate::source::{FileId, Span};
use std::fmt::{self, Write};
use std::sync::Arc;

const AXES: [&str; 3] = ["x", "y", "z"];

/// The graph as text.
pub fn print(graph: &Graph) -> String {
    let mut out = String::new();
    let _ = print_to(graph, &mut out);
    out
}

fn print_to(graph: &Graph, out: &mut String) -> fmt::Result {
    writeln!(out, "variables {}", graph.next_variable)?;
    for p in &graph.parameters {
        let (of, i) = (p.parameter, p.component);
        writeln!(out, "parameter {of} {i} = {:?} in {:?} {:?}{}", p.default, p.min, p.max, if p.whole { " whole" } else { "" })?;
    }
    for f in &graph.factors {
        write!(out, "factor {} {} {:?} {}", quoted(&f.name), f.proof.name(), f.lipschitz, quoted(&f.reason))?;
        write_span(out, Some(f.span))?;
        out.push('\n');
    }
    let mut done = vec![false; graph.len()];
    for (i, m) in graph.materials.iter().enumerate() {
        writeln!(out, "material {i} {} {{", quoted(&m.name))?;
        let roots = m.look();
        print_nodes(graph, &roots, &mut done, out)?;
        for (key, ids) in ["color", "emission", "rest"].iter().zip(roots.chunks(3)) {
            write!(out, "  {key}")?;
            write_nodes(out, ids)?;
            out.push('\n');
        }
        writeln!(out, "  solid {}\n}}", u8::from(m.solid))?;
    }
    for (id, s) in graph.shapes() {
        write!(out, "shape {}", id.0)?;
        if let Some(name) = &s.name {
            write!(out, " {}", quoted(name))?;
        }
        writeln!(out, " {{")?;
        print_nodes(graph, &[s.value], &mut done, out)?;
        let exactness = match s.exactness {
            Exactness::Exact => "exact",
            Exactness::Formula => "formula",
        };
        write!(out, "  value %{} {}d {exactness}", s.value.0, s.dimensions)?;
        write_span(out, Some(s.span))?;
        out.push('\n');
        if let Some(material) = s.material {
            writeln!(out, "  material {}", material.0)?;
        }
        for (mask, material) in s.paints.iter() {
            writeln!(out, "  paint {} {}", mask.0, material.0)?;
        }
        writeln!(out, "}}")?;
    }
    let all: Vec<NodeId> = (0..graph.len() as u32).map(NodeId).collect();
    print_nodes(graph, &all, &mut done, out)
}

fn print_nodes(graph: &Graph, roots: &[NodeId], done: &mut [bool], out: &mut String) -> fmt::Result {
    let mut order = Vec::new();
    let mut stack = roots.to_vec();
    while let Some(id) = stack.pop() {
        if let Some(done) = done.get_mut(id.0 as usize).filter(|d| !**d) {
            *done = true;
            order.push(id);
            stack.extend_from_slice(graph.arguments(id));
            if let Node::Claim(_, Claim::Lipschitz(formula, ..)) = graph.node(id) {
                stack.push(*formula);
            }
        }
    }
    order.sort_unstable();
    for id in order {
        write!(out, "  %{} = ", id.0)?;
        print_node(graph.node(id), out)?;
        if let Some(name) = graph.node_name(id) {
            write!(out, " {}", quoted(name))?;
        }
        write_span(out, graph.location(id))?;
        out.push('\n');
    }
    Ok(())
}

fn print_node(node: &Node, out: &mut String) -> fmt::Result {
    let axis = |i: &u8| AXES.get(usize::from(*i)).copied().unwrap_or("?");
    match node {
        Node::Constant(bits) => write!(out, "{:?}", f64::from_bits(*bits)),
        Node::Leaf(Leaf::P(i)) => write!(out, "p.{}", axis(i)),
        Node::Leaf(Leaf::Normal(i)) => write!(out, "normal.{}", axis(i)),
        Node::Leaf(Leaf::Time) => write!(out, "time"),
        Node::Leaf(Leaf::Parameter(i)) => write!(out, "parameter {i}"),
        Node::Leaf(Leaf::Variable(i)) => write!(out, "variable {i}"),
        Node::Factor(i) => write!(out, "factor {i}"),
        Node::Op(op, args) => {
            out.push_str(op.row().name);
            write_nodes(out, args)
        }
        Node::Call(shape, function, args) => {
            let name = match function {
                Function::Field => "field".to_owned(),
                Function::Bound => "bound".to_owned(),
                Function::Distance => "distance".to_owned(),
                Function::Gradient(i) => format!("gradient.{}", axis(i)),
            };
            write!(out, "call {} {name}", shape.0)?;
            write_nodes(out, args)
        }
        Node::Claim(args, claim) => {
            write!(out, "claim {}", claim.name())?;
            if let Claim::Lipschitz(formula, groups, range) = claim {
                write!(out, " %{}", formula.0)?;
                for group in groups.iter() {
                    match group {
                        ClaimGroup::Vector(n) => write!(out, " vector {n}")?,
                        ClaimGroup::Values(n) => write!(out, " values {n}")?,
                        ClaimGroup::Bounds(n) => write!(out, " bounds {n}")?,
                    }
                }
                if let Some(range) = range.map(ValueRange::interval) {
                    write!(out, " in {:?} {:?}", range.lo, range.hi)?;
                }
            }
            out.push_str(" of");
            write_nodes(out, args)
        }
    }
}

fn write_nodes(out: &mut String, ids: &[NodeId]) -> fmt::Result {
    ids.iter().try_for_each(|id| write!(out, " %{}", id.0))
}

fn write_span(out: &mut String, span: Option<Span>) -> fmt::Result {
    match span {
        Some(s) => write!(out, " @{}:{}..{}", s.file.0, s.start, s.end),
        None => Ok(()),
    }
}

fn quoted(text: &str) -> String {
    let plain = text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n");
    format!("\"{plain}\"")
}

/// The graph that a text says, or what is wrong with which line.
pub fn parse(text: &str) -> Result<Graph, String> {
    let mut reader = Reader::default();
    for (number, line) in text.lines().enumerate() {
        let wrong = |what: String| format!("line {}: {what}", number + 1);
        let mut words = Words { rest: line };
        reader.line(&mut words).map_err(wrong)?;
        if let Some(word) = words.word() {
            return Err(wrong(format!("`{word}` is too much")));
        }
    }
    reader.finish()
}

/// What is left of a line.
struct Words<'a> {
    rest: &'a str,
}

impl<'a> Words<'a> {
    fn word(&mut self) -> Option<&'a str> {
        let rest = self.rest.trim_start();
        let end = rest.find(char::is_whitespace).unwrap_or(rest.len());
        let (word, rest) = rest.split_at(end);
        self.rest = rest;
        (!word.is_empty()).then_some(word)
    }

    fn need(&mut self) -> Result<&'a str, String> {
        self.word().ok_or_else(|| "something is missing at its end".to_owned())
    }

    fn expect(&mut self, word: &str) -> Result<(), String> {
        let found = self.need()?;
        if found == word { Ok(()) } else { Err(format!("`{word}` stands where `{found}` is")) }
    }

    fn number<T: std::str::FromStr>(&mut self) -> Result<T, String> {
        let word = self.need()?;
        word.parse().map_err(|_| format!("`{word}` is not such a number"))
    }

    fn text(&mut self) -> Result<Option<String>, String> {
        let rest = self.rest.trim_start();
        let Some(inner) = rest.strip_prefix('"') else { return Ok(None) };
        let mut text = String::new();
        let mut chars = inner.char_indices();
        while let Some((at, c)) = chars.next() {
            match c {
                '"' => {
                    self.rest = inner.get(at + 1..).unwrap_or_default();
                    return Ok(Some(text));
                }
                '\\' => match chars.next() {
                    Some((_, 'n')) => text.push('\n'),
                    Some((_, c)) => text.push(c),
                    None => break,
                },
                c => text.push(c),
            }
        }
        Err("a name without its end".to_owned())
    }

    fn node(&mut self) -> Result<NodeId, String> {
        let word = self.need()?;
        node_id(word).ok_or_else(|| format!("`{word}` is no node"))
    }

    fn nodes(&mut self) -> Vec<NodeId> {
        let mut all = Vec::new();
        loop {
            let before = self.rest;
            match self.word().and_then(node_id) {
                Some(id) => all.push(id),
                None => {
                    self.rest = before;
                    return all;
                }
            }
        }
    }

    fn three(&mut self) -> Result<[NodeId; 3], String> {
        Ok([self.node()?, self.node()?, self.node()?])
    }

    fn span(&mut self) -> Result<Option<Span>, String> {
        let before = self.rest;
        let Some(word) = self.word() else { return Ok(None) };
        let Some(place) = word.strip_prefix('@') else {
            self.rest = before;
            return Ok(None);
        };
        let parsed = place.split_once(':').and_then(|(file, range)| {
            let (start, end) = range.split_once("..")?;
            let file = FileId(file.parse().ok()?);
            Some(Span { file, start: start.parse().ok()?, end: end.parse().ok()? })
        });
        parsed.map(Some).ok_or_else(|| format!("`{word}` is no place"))
    }
}

fn node_id(word: &str) -> Option<NodeId> {
    word.strip_prefix('%')?.parse().ok().map(NodeId)
}

struct Line {
    id: NodeId,
    node: Node,
    name: Option<String>,
    span: Option<Span>,
}

/// What is read so far.
#[derive(Default)]
struct Reader {
    graph: Graph,
    nodes: Vec<Line>,
    materials: Vec<Material>,
    shapes: Vec<Shape>,
}

impl Reader {
    fn line(&mut self, words: &mut Words) -> Result<(), String> {
        let Some(first) = words.word() else { return Ok(()) };
        if let Some(id) = node_id(first) {
            words.expect("=")?;
            let node = read_node(words)?;
            let name = words.text()?;
            let span = words.span()?;
            self.nodes.push(Line { id, node, name, span });
            return Ok(());
        }
        let nowhere = || format!("`{first}` stands in no block");
        match first {
            "variables" => self.graph.next_variable = words.number()?,
            "parameter" => {
                let (parameter, component) = (words.number()?, words.number()?);
                words.expect("=")?;
                let default = words.number()?;
                words.expect("in")?;
                let (min, max) = (words.number()?, words.number()?);
                let whole = match words.word() {
                    None => false,
                    Some("whole") => true,
                    Some(other) => return Err(format!("`whole` or nothing stands behind a range, and not `{other}`")),
                };
                let read = ParameterComponent { parameter, component, default, min, max, whole };
                self.graph.parameters.push(read);
            }
            "factor" => {
                let name = words.text()?.ok_or("a factor has a name")?;
                let proof = words.need()?;
                let proof = super::Proof::ALL.into_iter().find(|p| p.name() == proof).ok_or("a factor is not known so")?;
                let lipschitz = words.number()?;
                let reason = words.text()?.ok_or("a factor has a reason")?;
                let span = words.span()?.ok_or("a factor has a place")?;
                self.graph.factors.push(Factor { name, lipschitz, reason, span, proof });
            }
            "material" if words.rest.ends_with('{') => {
                let _: u32 = words.number()?;
                let name = words.text()?.ok_or("a material has a name")?;
                words.expect("{")?;
                let none = [NodeId(0); 3];
                self.materials.push(Material {
                    name: name.into(),
                    color: none,
                    emission: none,
                    roughness: NodeId(0),
                    metallic: NodeId(0),
                    reflectivity: NodeId(0),
                    glass: None,
                    relief: None,
                    images: Arc::default(),
                    solid: true,
                });
            }
            "shape" => {
                let _: u32 = words.number()?;
                let name = words.text()?.map(Arc::from);
                words.expect("{")?;
                self.shapes.push(Shape {
                    name,
                    dimensions: 3,
                    value: NodeId(0),
                    variables: Arc::default(),
                    exactness: Exactness::Formula,
                    material: None,
                    paints: Arc::default(),
                    span: Span { file: FileId(0), start: 0, end: 0 },
                });
            }
            "}" => {}
            "color" | "emission" | "rest" | "solid" => {
                let m = self.materials.last_mut().ok_or_else(nowhere)?;
                match first {
                    "color" => m.color = words.three()?,
                    "emission" => m.emission = words.three()?,
                    "rest" => [m.roughness, m.metallic, m.reflectivity] = words.three()?,
                    _ => m.solid = words.number::<u8>()? != 0,
                }
            }
            "value" => {
                let shape = self.shapes.last_mut().ok_or_else(nowhere)?;
                shape.value = words.node()?;
                shape.dimensions = match words.need()? {
                    "2d" => 2,
                    "3d" => 3,
                    other => return Err(format!("`{other}` is neither 2d nor 3d")),
                };
                shape.exactness = match words.need()? {
                    "exact" => Exactness::Exact,
                    "formula" => Exactness::Formula,
                    other => return Err(format!("`{other}` is neither exact nor formula")),
                };
                shape.span = words.span()?.ok_or("a shape has a place")?;
            }
            "material" => {
                let shape = self.shapes.last_mut().ok_or_else(nowhere)?;
                shape.material = Some(MaterialId(words.number()?));
            }
            "paint" => {
                let shape = self.shapes.last_mut().ok_or_else(nowhere)?;
                let paint = (ShapeId(words.number()?), MaterialId(words.number()?));
                shape.paints = shape.paints.iter().copied().chain([paint]).collect();
            }
            other => return Err(format!("`{other}` begins no line")),
        }
        Ok(())
    }

    fn finish(mut self) -> Result<Graph, String> {
        self.nodes.sort_by_key(|line| line.id);
        for line in self.nodes {
            let id = self.graph.intern(line.node);
            if id != line.id {
                return Err(format!("%{} is missing, or a node stands twice", id.0));
            }
            if let Some(name) = line.name {
                self.graph.name_node(id, &name);
            }
            if let Some(span) = line.span {
                self.graph.locate(id, span);
            }
        }
        self.graph.materials = self.materials;
        for shape in self.shapes {
            self.graph.add_shape(shape);
        }
        Ok(self.graph)
    }
}

fn read_node(words: &mut Words) -> Result<Node, String> {
    let first = words.need()?;
    if let Ok(value) = first.parse::<f64>() {
        return Ok(Node::Constant(value.to_bits()));
    }
    if let Some((base, axis)) = first.split_once('.') {
        let i = AXES.iter().position(|a| *a == axis).ok_or_else(|| format!("`{axis}` is no axis"))?;
        return match base {
            "p" => Ok(Node::Leaf(Leaf::P(i as u8))),
            "normal" => Ok(Node::Leaf(Leaf::Normal(i as u8))),
            _ => Err(format!("`{base}` has no axes")),
        };
    }
    Ok(match first {
        "time" => Node::Leaf(Leaf::Time),
        "parameter" => Node::Leaf(Leaf::Parameter(words.number()?)),
        "variable" => Node::Leaf(Leaf::Variable(words.number()?)),
        "factor" => Node::Factor(words.number()?),
        "call" => {
            let shape = ShapeId(words.number()?);
            let function = match words.need()? {
                "field" => Function::Field,
                "bound" => Function::Bound,
                "distance" => Function::Distance,
                "gradient.x" => Function::Gradient(0),
                "gradient.y" => Function::Gradient(1),
                "gradient.z" => Function::Gradient(2),
                other => return Err(format!("a shape has no function `{other}`")),
            };
            Node::Call(shape, function, words.nodes().into())
        }
        "claim" => {
            let claim = match words.need()? {
                "continuous" => {
                    words.expect("of")?;
                    Claim::Continuous
                }
                "lipschitz" => {
                    let formula = words.node()?;
                    let (mut groups, mut range) = (Vec::new(), None);
                    loop {
                        match words.need()? {
                            "of" => break,
                            "vector" => groups.push(ClaimGroup::Vector(words.number()?)),
                            "values" => groups.push(ClaimGroup::Values(words.number()?)),
                            "bounds" => groups.push(ClaimGroup::Bounds(words.number()?)),
                            "in" => range = Some(ValueRange::new(words.number()?, words.number()?)),
                            other => return Err(format!("`{other}` is no group of a claim")),
                        }
                    }
                    Claim::Lipschitz(formula, groups.into(), range)
                }
                other => return Err(format!("there is no claim `{other}`")),
            };
            Node::Claim(words.nodes().into(), claim)
        }
        name => {
            let op: Op = KERNEL
                .iter()
                .find(|row| row.name == name)
                .map(|row| row.op)
                .ok_or_else(|| format!("there is no operation `{name}`"))?;
            let args = words.nodes();
            if args.len() != usize::from(op.row().arity) {
                return Err(format!("`{name}` takes {} arguments", op.row().arity));
            }
            Node::Op(op, args.into())
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPAN: Span = Span { file: FileId(1), start: 4, end: 9 };

    fn sample() -> Graph {
        let mut g = Graph::new();
        let p = g.point();
        let one = g.constant(1.0);
        let normal = g.leaf(Leaf::Normal(1));
        let stone = g.add_material(Material {
            name: "a \"stone\"\\".into(),
            color: [one, normal, p[0]],
            emission: [one; 3],
            roughness: one,
            metallic: p[2],
            reflectivity: one,
            glass: None,
            relief: None,
            images: Arc::default(),
            solid: false,
        });
        let shape = |value, name: Option<&str>| Shape {
            name: name.map(Arc::from),
            dimensions: 3,
            value,
            variables: Arc::default(),
            exactness: Exactness::Exact,
            material: None,
            paints: Arc::default(),
            span: SPAN,
        };
        let length = g.op(Op::Length3, &p);
        let cell = g.fresh_variable();
        let cell = g.leaf(Leaf::Variable(cell));
        let radius = g.op(Op::Div, &[cell, length]);
        let ball = g.op(Op::Sub, &[length, radius]);
        g.name_node(ball, "d");
        g.locate(ball, SPAN);
        let ball = g.add_shape(shape(ball, Some("ball")));
        g.parameters.push(ParameterComponent {
            parameter: 0,
            component: 1,
            default: 0.1 + 0.2,
            min: -1e-7,
            max: 1e12,
            whole: true,
        });
        let live = g.leaf(Leaf::Parameter(0));
        let time = g.leaf(Leaf::Time);
        let moved = g.op(Op::Add, &[p[0], time]);
        let call = g.call(ball, Function::Field, &[moved, p[1], p[2], live]);
        let slope = g.call(ball, Function::Gradient(2), &[moved, p[1], p[2], live]);
        let continuous = g.intern(Node::Claim([call].into(), Claim::Continuous));
        let groups = [ClaimGroup::Vector(2), ClaimGroup::Values(1)].into();
        let lipschitz = Claim::Lipschitz(one, groups, Some(ValueRange::new(-0.1, 1e9)));
        let claim = g.intern(Node::Claim([continuous, p[0], p[1], slope].into(), lipschitz));
        let (name, reason) = ("step_ball".to_owned(), "two\nlines".to_owned());
        g.factors.push(Factor { name, lipschitz: 1.5, reason, span: SPAN, proof: crate::graph::Proof::Derived });
        let factor = g.intern(Node::Factor(0));
        let value = g.op(Op::Mul, &[claim, factor]);
        let mut scene = shape(value, None);
        scene.material = Some(stone);
        scene.paints = [(ball, stone)].into();
        g.add_shape(scene);
        g.op(Op::Hash, &[p[0], p[1], p[2], one]);
        g
    }

    #[test]
    fn what_is_printed_reads_back() {
        let graph = sample();
        let text = print(&graph);
        let again = parse(&text).unwrap_or_else(|e| panic!("{e}\n{text}"));
        assert_eq!(print(&again), text);
        assert_eq!(again.len(), graph.len());
        for id in (0..graph.len() as u32).map(NodeId) {
            assert_eq!(again.node(id), graph.node(id));
            assert_eq!(again.node_name(id), graph.node_name(id));
            assert_eq!(again.location(id), graph.location(id));
        }
        let shapes: Vec<_> = graph.shapes().collect();
        assert_eq!(again.shapes().collect::<Vec<_>>(), shapes);
        assert_eq!((&again.materials, &again.parameters), (&graph.materials, &graph.parameters));
        assert_eq!((&again.factors, again.next_variable), (&graph.factors, graph.next_variable));
        assert!(text.contains("%8 = sub %5 %7 \"d\" @1:4..9"), "{text}");
    }

    #[test]
    fn what_is_wrong_is_said_with_its_line() {
        for (text, message) in [
            ("variables 3\n%0 = sum %1", "line 2: there is no operation `sum`"),
            ("%0 = add %1", "line 1: `add` takes 2 arguments"),
            ("%0 = p.w", "line 1: `w` is no axis"),
            ("%0 = time \"t", "line 1: a name without its end"),
            ("%1 = time", "%0 is missing, or a node stands twice"),
            ("%0 = time 3", "line 1: `3` is too much"),
            ("value %0", "line 1: `value` stands in no block"),
            ("shape 0 {\nvalue %0 4d", "line 2: `4d` is neither 2d nor 3d"),
            ("nonsense", "line 1: `nonsense` begins no line"),
        ] {
            assert_eq!(parse(text).map(|g| g.len()), Err(message.to_owned()), "{text}");
        }
    }
}
