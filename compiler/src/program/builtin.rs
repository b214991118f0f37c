//! Functions that are not formulas of the prelude: the kernel's operations on numbers and vectors, constructors, matrices, hashes,
//! turns, and what takes a shape apart or gives it a material.

use super::value::Value;
use super::{Elaborated, Elaborator, Env};
use crate::analysis::Box3;
use crate::diagnostic::Code;
use crate::graph::kernel::{Op, KERNEL};
use crate::graph::{Leaf, Node, NodeId, NodeList, ShapeId};
use crate::source::Span;
use rustc_hash::FxHashSet;
use std::sync::LazyLock;

/// Names that can be called and are not declared in the prelude.
pub const FUNCTIONS: &[&str] = &[
    "min", "max", "abs", "sign", "floor", "ceil", "trunc", "round", "sqrt", "exp", "log", "pow", "sin", "cos", "asin",
    "acos", "atan", "atan2", "tanh", "length", "distance", "dot", "cross", "normalize", "vec2", "vec3", "vec4", "mat2",
    "mat3", "mat4", "transpose", "determinant", "inverse", "hash", "hash2", "hash3", "turn", "turn_about", "at",
    "material", "paint", "float", "int", "grid", "polar", "value",
    "low_corner", "high_corner", "mesh_field", "baked", "text", "path", "svg", "shader",
    "curve_of", "helix_of", "way_to", "frame_of", "swept_of", "twisted_of", "kinks_of", "known_in", "solid_of", "hull_of",
];

/// Those of them that only the prelude calls, which has a name for what each does.
pub const OF_PRELUDE: &[&str] = &["value", "curve_of", "helix_of", "way_to", "frame_of", "swept_of", "twisted_of", "kinks_of", "known_in", "solid_of", "hull_of"];

/// Names that stand for a value and are not declared in the prelude.
pub const NAMES: &[&str] =
    &["p", "world", "normal", "time", "pi", "tau", "x", "y", "z", "nothing", "on", "off", "true", "false"];

/// Whether a name can be called without being declared.
pub fn is_function(name: &str) -> bool {
    static SET: LazyLock<FxHashSet<&str>> = LazyLock::new(|| FUNCTIONS.iter().copied().collect());
    SET.contains(name)
}

impl Elaborator<'_> {
    /// Calls a built-in function.
    pub fn built_in(
        &mut self,
        name: &str,
        args: &[(Value, Span)],
        span: Span,
        env: &Env,
    ) -> Elaborated<Value> {
        let joins = match name {
            "min" => Some("shapes are joined by `a | b`; in a `blend` they are numbers, and have no type: `blend name(a, b, k: float) = …`"),
            "max" => Some("what shapes share is `a & b`, and what is left of `b` without `a` is `b - a`"),
            _ => None,
        };
        if let (Some(joins), None, Some((_, at))) = (joins, &env.point, args.iter().find(|(value, _)| matches!(value, Value::Shape(_)))) {
            return Err(self.error(Code::TypeMismatch, *at, format!("`{name}` is of numbers, and a shape is a number only inside a formula"), joins));
        }
        if matches!(name, "grid" | "polar") {
            let help = match (name, args.first()) {
                ("polar", Some((Value::Shape(_), _))) => "copies of a shape around an axis are `.repeat_polar(y, 6)`, of a drawing `.repeat_polar(6)`".to_owned(),
                _ => format!("write `for c in {name}(…) {{ … }}`"),
            };
            return Err(self.error(Code::TypeMismatch, span, format!("`{name}` stands only after `in`"), help));
        }
        // In a formula, a shape among numbers is its field.
        let takes_shape =
            matches!(name, "at" | "material" | "paint" | "value" | "low_corner" | "high_corner" | "baked" | "known_in" | "hull_of");
        let mut values: Vec<Value> = Vec::with_capacity(args.len());
        for (value, at) in args {
            values.push(match value {
                Value::Shape(_) | Value::Nothing if !takes_shape => {
                    Value::number(self.to_number(value, *at, env)?)
                }
                other => other.clone(),
            });
        }
        let place = |i: usize| args.get(i).map_or(span, |(_, s)| *s);
        let row = KERNEL.iter().find(|r| r.callable && r.name == name);
        match (name, values.as_slice()) {
            ("min" | "max", [first, second, rest @ ..]) => {
                let op = if name == "min" { Op::Min } else { Op::Max };
                let mut total = first.clone();
                for (i, value) in std::iter::once(second).chain(rest).enumerate() {
                    total = self.componentwise(&total, value, place(i + 1), |e, x, y| {
                        e.graph.op(op, &[x, y])
                    })?;
                }
                Ok(total)
            }
            ("atan", [one]) => self.each(one, span, Op::Atan),
            ("atan" | "atan2", [y, x]) => {
                self.componentwise(y, x, span, |e, y, x| e.graph.op(Op::Atan2, &[y, x]))
            }
            ("pow", [a, b]) => {
                self.check_power(a, b, span)?;
                self.componentwise(a, b, span, |e, x, y| e.graph.op(Op::Pow, &[x, y]))
            }
            ("length", [v]) => {
                let cells = self.cells(v, place(0))?;
                Ok(Value::number(self.length(&cells, span)))
            }
            ("distance", [a, b]) => {
                let v = self.componentwise(a, b, span, |e, x, y| e.graph.op(Op::Sub, &[x, y]))?;
                let cells = self.cells(&v, span)?;
                Ok(Value::number(self.length(&cells, span)))
            }
            ("dot", [a, b]) => {
                let v = self.componentwise(a, b, span, |e, x, y| e.graph.op(Op::Mul, &[x, y]))?;
                let cells = self.cells(&v, span)?;
                Ok(Value::number(self.sum(&cells)))
            }
            ("cross", [a, b]) => {
                let a = self.to_vector(a, 3, place(0))?;
                let b = self.to_vector(b, 3, place(1))?;
                let (&[a0, a1, a2], &[b0, b1, b2]) = (&*a, &*b) else { return Err(super::Stop) };
                let mut minor = |p: NodeId, q: NodeId, r: NodeId, s: NodeId| {
                    let x = self.graph.op(Op::Mul, &[p, q]);
                    let y = self.graph.op(Op::Mul, &[r, s]);
                    self.graph.op(Op::Sub, &[x, y])
                };
                let cells = [minor(a1, b2, a2, b1), minor(a2, b0, a0, b2), minor(a0, b1, a1, b0)];
                Ok(Value::Vector(cells.into()))
            }
            ("normalize", [v]) => {
                let cells = self.cells(v, place(0))?;
                let length = self.length(&cells, span);
                if self.graph.as_constant(length) == Some(0.0) {
                    return Err(self.error(
                        Code::BadValue,
                        place(0),
                        "a vector of length zero has no direction",
                        "write a vector that is not zero",
                    ));
                }
                let cells = cells.iter().map(|c| self.graph.op(Op::Div, &[*c, length]));
                Ok(Value::Vector(cells.collect()))
            }
            ("vec2" | "vec3" | "vec4", [_, ..]) => {
                let n = match name {
                    "vec2" => 2,
                    "vec3" => 3,
                    _ => 4,
                };
                if let [Value::Number(one, _)] = values.as_slice() {
                    return Ok(Value::Vector(NodeList::of(*one, n)));
                }
                let mut cells = Vec::new();
                for (i, value) in values.iter().enumerate() {
                    cells.extend_from_slice(&self.cells(value, place(i))?);
                }
                // A longer vector is cut, as GLSL does with one argument.
                if values.len() == 1 && cells.len() > n {
                    cells.truncate(n);
                }
                if cells.len() != n {
                    return Err(self.error(
                        Code::TypeMismatch,
                        span,
                        format!("`{name}` needs {n} components, and here are {}", cells.len()),
                        format!("write {n} numbers"),
                    ));
                }
                Ok(Value::Vector(cells.into()))
            }
            ("mat2" | "mat3" | "mat4", [_, ..]) => self.matrix(name, &values, span),
            ("transpose", [Value::Matrix(n, m)]) => {
                let size = usize::from(*n);
                let cells = (0..size * size)
                    .filter_map(|i| m.get((i % size) * size + i / size).copied())
                    .collect();
                Ok(Value::Matrix(*n, cells))
            }
            ("determinant", [Value::Matrix(n, m)]) => {
                let node = self.determinant(m, usize::from(*n));
                Ok(Value::number(node))
            }
            ("inverse", [Value::Matrix(n, m)]) => self.inverse(m, *n, span),
            ("hash" | "hash2" | "hash3", [v]) => self.hashes(name, v, None, place(0)),
            ("hash" | "hash2" | "hash3", [v, seed]) => {
                let seed = self.to_number(seed, place(1), env)?;
                self.hashes(name, v, Some(seed), place(0))
            }
            ("turn", [v, angle]) => {
                let v = self.to_vector(v, 2, place(0))?;
                let angle = self.to_number(angle, place(1), env)?;
                let &[a, b] = &*v else { return Err(super::Stop) };
                let cells = vec![
                    self.graph.op(Op::TurnU, &[a, b, angle]),
                    self.graph.op(Op::TurnV, &[a, b, angle]),
                ];
                Ok(Value::Vector(cells.into()))
            }
            ("turn_about", [v, axis, angle]) => {
                let v = self.to_vector(v, 3, place(0))?;
                let axis = self.to_vector(axis, 3, place(1))?;
                let angle = self.to_number(angle, place(2), env)?;
                let (&[a, b, c], &[i, j, k]) = (&*v, &*axis) else { return Err(super::Stop) };
                self.turn_about([a, b, c], [i, j, k], angle, place(1))
            }
            ("at", [Value::Shape(id), q]) => {
                let n = usize::from(self.graph.dimensions(*id));
                let q = self.to_vector(q, n, place(1))?;
                let q = self.fit_point(&q, *id, place(1))?;
                let node = self.graph.field(*id, q);
                self.locate(node, span);
                Ok(Value::number(node))
            }
            ("low_corner" | "high_corner", [Value::Shape(id)]) => {
                Ok(self.corner(*id, name == "high_corner"))
            }
            ("mesh_field", [_, _, _]) => match args {
                [file, resolution, padding] => self.mesh_field(file, [resolution, padding], span, env),
                _ => Err(super::Stop),
            },
            ("text", [_, _, _, _, _, _]) => match args {
                [words, size, font, align, spacing, leading] => self.text([words, size, font, align, spacing, leading], span, env),
                _ => Err(super::Stop),
            },
            ("path", [_]) => match args {
                [data] => self.path(data, span),
                _ => Err(super::Stop),
            },
            ("curve_of", [Value::Text(kind), points, Value::Bool(closed)]) => {
                let is_closed = self.to_constant(&Value::number(*closed), place(2))? != 0.0;
                self.curve_of(kind, (points, place(1)), is_closed)
            }
            ("helix_of", [radius, pitch, turns]) => self.helix_of([(radius, place(0)), (pitch, place(1)), (turns, place(2))], span),
            ("way_to", [Value::Curve(line), q]) => {
                let q = self.to_vector(q, 3, place(1))?;
                self.way_to(line, &q, span)
            }
            ("frame_of", [Value::Curve(line), i, count]) => self.frame_of(line, (i, place(1)), (count, place(2))),
            ("swept_of" | "twisted_of" | "kinks_of", [Value::Curve(line)]) => self.swept_of(line, span, name),
            ("known_in", [Value::Shape(shape), low, high]) => self.known_in(*shape, (low, place(1)), (high, place(2))),
            ("at", [Value::Curve(line), share]) => self.curve_at(line, (share, place(1))),
            ("solid_of", [points, faces]) => self.solid_of((points, place(0)), (faces, place(1)), span),
            ("hull_of", [Value::Nothing]) => Ok(Value::Nothing),
            ("hull_of", [Value::Shape(shape)]) => self.hull_of_shape((*shape, place(0)), span),
            ("hull_of", [points]) => self.hull_of((points, place(0)), span),
            ("svg", [_, _]) => match args {
                [file, size] => self.svg(file, size, span, env),
                _ => Err(super::Stop),
            },
            ("baked", [Value::Nothing, ..]) => Ok(Value::Nothing),
            ("baked", [Value::Shape(id), _, _]) => match args {
                [_, resolution, padding] => {
                    let settings = self.sampling([resolution, padding])?;
                    self.baked((*id, place(0)), settings, span, env)
                }
                _ => Err(super::Stop),
            },
            ("at", [Value::Nothing, _]) => Ok(Value::number(self.graph.constant(crate::graph::FAR))),
            ("material", [Value::Shape(id), m]) => {
                let Value::Material(m) = m else { return Err(self.not_material(m, place(1))) };
                Ok(self.with_material(*id, None, *m, span))
            }
            ("material", [Value::Nothing, Value::Material(_)]) => Ok(Value::Nothing),
            ("paint", [Value::Shape(id), Value::Shape(mask), m]) => {
                let Value::Material(m) = m else { return Err(self.not_material(m, place(2))) };
                if self.graph.dimensions(*id) != self.graph.dimensions(*mask) {
                    return Err(self.error(
                        Code::TypeMismatch,
                        place(1),
                        "the mask must have as many dimensions as what is painted",
                        "make a solid of the drawing with `.extrude(height)`",
                    ));
                }
                Ok(self.with_material(*id, Some(*mask), *m, span))
            }
            ("float", [Value::Number(n, _)]) => Ok(Value::number(*n)),
            ("int", [Value::Number(n, _)]) => {
                Ok(Value::Number(self.graph.op(Op::Trunc, &[*n]), true))
            }
            ("float" | "int", [Value::Bool(c)]) => {
                let (zero, one) = (self.graph.constant(0.0), self.graph.constant(1.0));
                Ok(Value::Number(self.graph.op(Op::Select, &[*c, one, zero]), name == "int"))
            }
            _ => {
                if let (Some(row), [one]) = (row, values.as_slice())
                    && row.arity == 1
                {
                    self.check_domain(name, one, span)?;
                    return self.each(one, span, row.op);
                }
                let found: Vec<String> = values.iter().map(|v| v.describe(&self.graph)).collect();
                let (usage, count) = usage(name);
                if values.len() < count {
                    return Err(self.error(
                        Code::MissingArgument,
                        span,
                        format!("`{name}` needs more arguments"),
                        format!("write `{usage}`"),
                    ));
                }
                if values.len() > count && !matches!(name, "at" | "material" | "paint") {
                    return Err(self.error(
                        Code::ExtraArgument,
                        place(count),
                        format!("`{name}` takes {count} argument{}", if count == 1 { "" } else { "s" }),
                        format!("write `{usage}`"),
                    ));
                }
                Err(self.error(
                    Code::TypeMismatch,
                    place(0),
                    format!("`{name}` does not take {}", found.join(" and ")),
                    format!("write `{usage}`"),
                ))
            }
        }
    }

    /// A corner of a box that surely holds a shape, whatever the parameters are. Where it has no end, the box ends far away.
    fn corner(&mut self, shape: ShapeId, high: bool) -> Value {
        const ENDLESS: f64 = 1e6;
        let graph = &mut self.graph;
        let region = self.facts.closer_and_closer(|facts, within| facts.body_region(graph, shape, &|_| None, within), Box3::cube(ENDLESS));
        let dimensions = usize::from(self.graph.dimensions(shape));
        let cells = (0..dimensions)
            .map(|i| {
                let side = region.axis(i);
                let end = if high { side.hi } else { side.lo };
                self.graph.constant(if side.is_empty() { 0.0 } else { end })
            })
            .collect();
        Value::Vector(cells)
    }

    /// Reports a constant for which a function has no value. The prelude knows what it does.
    fn check_domain(&mut self, name: &str, value: &Value, span: Span) -> Elaborated<()> {
        let (least, most, wanted) = match name {
            "sqrt" if self.outside.is_none() => (-1e-9, f64::INFINITY, "of at least 0"),
            "log" => (f64::MIN_POSITIVE, f64::INFINITY, "greater than 0"),
            "asin" | "acos" => (-1.0 - 1e-9, 1.0 + 1e-9, "from -1 to 1"),
            _ => return Ok(()),
        };
        let cells = match value {
            Value::Number(n, _) => std::slice::from_ref(n),
            Value::Vector(v) => v,
            _ => return Ok(()),
        };
        let constants = cells.iter().filter_map(|n| self.graph.as_constant(*n));
        match constants.into_iter().find(|c| !(least..=most).contains(c)) {
            Some(c) => Err(self.error(
                Code::BadValue,
                span,
                format!("`{name}` has no value for {c}"),
                format!("write a number {wanted}"),
            )),
            None => Ok(()),
        }
    }

    /// The same for a power.
    fn check_power(&mut self, base: &Value, exponent: &Value, span: Span) -> Elaborated<()> {
        if let (Value::Number(base, _), Value::Number(exponent, _)) = (base, exponent)
            && let (Some(b), Some(e)) =
                (self.graph.as_constant(*base), self.graph.as_constant(*exponent))
            && (b < 0.0 && e.fract() != 0.0 || b == 0.0 && e < 0.0)
        {
            return Err(self.error(
                Code::BadValue,
                span,
                format!("{b} to the power {e} has no value"),
                "write a base greater than 0, or an exponent that is a whole number of at least 0",
            ));
        }
        Ok(())
    }

    fn not_material(&mut self, value: &Value, span: Span) -> super::Stop {
        let found = value.describe(&self.graph);
        let help = match value {
            Value::Vector(v) if v.len() == 3 => "of a colour alone write `swatch(#f00)`; more is declared with `material name { color: #f00, roughness: 0.3 }`",
            _ => "declare one with `material name { color: #808080 }`, and write its name here",
        };
        self.error(Code::TypeMismatch, span, format!("a material is needed here, and this is {found}"), help)
    }

    /// The components of a number or vector.
    fn cells(&mut self, value: &Value, span: Span) -> Elaborated<NodeList> {
        match value {
            Value::Number(n, _) => Ok([*n].into()),
            Value::Vector(v) => Ok(v.clone()),
            other => {
                let found = other.describe(&self.graph);
                Err(self.error(
                    Code::TypeMismatch,
                    span,
                    format!("a vector is needed here, and this is {found}"),
                    "write a vector, for example `(1, 0, 0)`",
                ))
            }
        }
    }

    /// The Euclidean length of components.
    pub fn length(&mut self, cells: &[NodeId], span: Span) -> NodeId {
        let node = match cells.len() {
            1 => self.graph.op(Op::Abs, cells),
            2 => self.graph.op(Op::Length2, cells),
            3 => self.graph.op(Op::Length3, cells),
            _ => self.graph.op(Op::Length4, cells),
        };
        self.locate(node, span);
        node
    }

    fn matrix(&mut self, name: &str, values: &[Value], span: Span) -> Elaborated<Value> {
        let n: usize = match name {
            "mat2" => 2,
            "mat3" => 3,
            _ => 4,
        };
        if let [Value::Matrix(m, _)] = values
            && usize::from(*m) == n
            && let Some(same) = values.first()
        {
            return Ok(same.clone());
        }
        if let [Value::Number(diagonal, _)] = values {
            let zero = self.graph.constant(0.0);
            let cells =
                (0..n * n).map(|i| if i % (n + 1) == 0 { *diagonal } else { zero }).collect();
            return Ok(Value::Matrix(n as u8, cells));
        }
        let mut cells = Vec::new();
        for value in values {
            cells.extend_from_slice(&self.cells(value, span)?);
        }
        if cells.len() != n * n {
            return Err(self.error(
                Code::TypeMismatch,
                span,
                format!("`{name}` needs {} numbers, column by column, and here are {}", n * n, cells.len()),
                format!("write {n} vectors of {n}, or one number for the diagonal"),
            ));
        }
        Ok(Value::Matrix(n as u8, cells.into()))
    }

    /// Determinant by expansion along the first column.
    fn determinant(&mut self, m: &[NodeId], n: usize) -> NodeId {
        match m {
            [] => self.graph.constant(1.0),
            [one] => *one,
            _ => {
                let mut total = self.graph.constant(0.0);
                for row in 0..n {
                    let Some(&head) = m.get(row) else { continue };
                    let minor = minor(m, n, row, 0);
                    let inner = self.determinant(&minor, n - 1);
                    let term = self.graph.op(Op::Mul, &[head, inner]);
                    total =
                        self.graph.op(if row % 2 == 0 { Op::Add } else { Op::Sub }, &[total, term]);
                }
                total
            }
        }
    }

    /// Inverse by cofactors.
    fn inverse(&mut self, m: &[NodeId], n: u8, span: Span) -> Elaborated<Value> {
        let size = usize::from(n);
        let determinant = self.determinant(m, size);
        if self.graph.as_constant(determinant) == Some(0.0) {
            return Err(self.error(
                Code::BadValue,
                span,
                "this matrix has no inverse",
                "its columns must not lie in one plane",
            ));
        }
        let mut cells = Vec::new();
        for column in 0..size {
            for row in 0..size {
                let inner = minor(m, size, column, row);
                let cofactor = self.determinant(&inner, size - 1);
                let quotient = self.graph.op(Op::Div, &[cofactor, determinant]);
                cells.push(if (row + column) % 2 == 0 {
                    quotient
                } else {
                    self.graph.op(Op::Neg, &[quotient])
                });
            }
        }
        Ok(Value::Matrix(n, cells.into()))
    }

    /// Whether a number is not whole, or changes smoothly from place to place, so that it hardly ever is.
    fn is_hardly_whole(&self, node: NodeId, depth: usize) -> bool {
        match self.graph.node(node) {
            Node::Constant(bits) => f64::from_bits(*bits).fract() != 0.0,
            Node::Leaf(Leaf::P(_) | Leaf::Time) => true,
            Node::Op(Op::Add | Op::Sub | Op::Mul | Op::Div | Op::Neg, args) if depth > 0 => {
                let mut varying = args.iter().filter(|&&a| self.graph.as_constant(a).is_none()).peekable();
                varying.peek().is_some() && varying.all(|&a| self.is_hardly_whole(a, depth - 1))
            }
            _ => false,
        }
    }

    fn hashes(
        &mut self,
        name: &str,
        v: &Value,
        seed: Option<NodeId>,
        span: Span,
    ) -> Elaborated<Value> {
        let cells = self.cells(v, span)?;
        if cells.iter().any(|&cell| self.is_hardly_whole(cell, 4)) {
            let help = format!("write `{name}(i)` of what counts, `{name}(floor(a))` of cells, or `value_noise(a)` for what changes smoothly");
            self.warn(Code::NotWhole, span, format!("`{name}` is of whole numbers, and this is rounded to one"), help);
        }
        let zero = self.graph.constant(0.0);
        let four = self.graph.constant(4.0);
        let seed = match seed {
            Some(seed) => self.graph.op(Op::Mul, &[seed, four]),
            None => zero,
        };
        let cell = |i: usize| cells.get(i).copied().unwrap_or(zero);
        let count = match name {
            "hash" => 1,
            "hash2" => 2,
            _ => 3,
        };
        let nodes: Vec<NodeId> = (0..count)
            .map(|channel| {
                let channel = self.graph.constant(f64::from(channel));
                let word = self.graph.op(Op::Add, &[seed, channel]);
                self.graph.op(Op::Hash, &[cell(0), cell(1), cell(2), word])
            })
            .collect();
        Ok(match *nodes {
            [one] => Value::number(one),
            _ => Value::Vector(nodes.into()),
        })
    }
}

/// The matrix without one row and one column.
fn minor(m: &[NodeId], n: usize, row: usize, column: usize) -> Vec<NodeId> {
    m.iter()
        .enumerate()
        .filter(|(i, _)| i % n != row && i / n != column)
        .map(|(_, c)| *c)
        .collect()
}

/// The names of a built-in function's arguments, by which they may be written; none where there may be any number of them.
pub fn argument_names(name: &str, count: usize) -> &'static [&'static str] {
    match name {
        "min" | "max" if count > 2 => &[],
        "min" | "max" | "pow" | "distance" | "dot" | "cross" => &["a", "b"],
        "atan" if count < 2 => &["t"],
        "atan" | "atan2" => &["y", "x"],
        "length" | "normalize" => &["v"],
        "transpose" | "inverse" | "determinant" => &["m"],
        "turn" => &["v", "angle"],
        "turn_about" => &["v", "axis", "angle"],
        "hash" | "hash2" | "hash3" => &["v", "seed"],
        "at" => &["s", "q"],
        "material" => &["s", "m"],
        "paint" => &["s", "mask", "m"],
        "low_corner" | "high_corner" => &["s"],
        "mesh_field" => &["file", "resolution", "padding"],
        "baked" => &["s", "resolution", "padding"],
        "text" => &["words", "size", "font", "align", "spacing", "leading"],
        "path" => &["data"],
        "svg" => &["file", "size"],
        "shader" => &["file", "function"],
        "curve_of" => &["kind", "points", "closed"],
        "helix_of" => &["radius", "pitch", "turns"],
        "way_to" => &["curve", "q"],
        "frame_of" => &["curve", "i", "count"],
        "swept_of" | "twisted_of" | "kinks_of" => &["curve"],
        "known_in" => &["s", "low", "high"],
        "solid_of" => &["points", "faces"],
        "hull_of" => &["points"],
        _ if KERNEL.iter().any(|row| row.callable && row.name == name) => &["a"],
        _ => &[],
    }
}

/// What an argument is where it is left out.
#[derive(Clone, Copy, Debug)]
pub enum Usual {
    /// A number.
    Number(f64),
    /// A text.
    Words(&'static str),
}

impl std::fmt::Display for Usual {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number}"),
            Self::Words(words) => write!(f, "{words:?}"),
        }
    }
}

/// What the arguments of a built-in function are where they are left out; none of those that can't be.
pub fn defaults(name: &str) -> &'static [Option<Usual>] {
    use Usual::{Number, Words};
    match name {
        "mesh_field" => &[None, Some(Number(64.0)), Some(Number(0.05))],
        "baked" => &[None, Some(Number(128.0)), Some(Number(0.05))],
        "text" => &[None, Some(Number(1.0)), Some(Words("")), Some(Words("left")), Some(Number(0.0)), Some(Number(1.2))],
        "svg" => &[None, Some(Number(0.0))],
        _ => &[],
    }
}

/// How a built-in function is called, and with how many arguments at least.
fn usage(name: &str) -> (String, usize) {
    match name {
        "min" | "max" | "pow" | "atan2" | "distance" | "dot" | "cross" | "turn" | "turn_about" => {
            let names = argument_names(name, 2);
            (format!("{name}({})", names.join(", ")), names.len())
        }
        "at" => ("s.at(q)".into(), 2),
        "material" => ("s.material(m)".into(), 2),
        "low_corner" | "high_corner" => (format!("{name}(s)"), 1),
        "paint" => ("s.paint(mask, m)".into(), 3),
        "mesh_field" => ("mesh_field(\"duck.obj\", resolution: 64)".into(), 3),
        "baked" => ("s.baked(resolution: 128)".into(), 3),
        "text" => ("text(\"Surefoot\", size: 1)".into(), 6),
        "path" => ("path(\"M 0 0 H 1 V 1 Z\")".into(), 1),
        "svg" => ("svg(\"logo.svg\", size: 1)".into(), 2),
        "shader" => ("shader(\"rock.glsl\", map)".into(), 2),
        "curve_of" | "helix_of" | "frame_of" => (format!("{name}({})", argument_names(name, 3).join(", ")), 3),
        "way_to" => ("way_to(curve, q)".into(), 2),
        "swept_of" | "twisted_of" | "kinks_of" => (format!("{name}(curve)"), 1),
        "known_in" => ("s.known_in(low, high)".into(), 3),
        "solid_of" => ("solid_of(points, faces)".into(), 2),
        "vec2" => ("vec2(x, y)".into(), 1),
        "vec3" => ("vec3(x, y, z)".into(), 1),
        "vec4" => ("vec4(x, y, z, w)".into(), 1),
        _ => (format!("{name}(v)"), 1),
    }
}
