//! What modules look like, and that naga takes them.

use super::*;
use crate::graph::kernel::{self, Op};
use crate::graph::{Exactness, Factor, Function, Leaf, NodeId, ParameterComponent, Shape, WORLD};
use crate::interface::UniformSource;
use crate::source::{FileId, Span};
use crate::syntax::ast::Type;
use std::sync::Arc;

const SPAN: Span = Span { file: FileId(0), start: 0, end: 0 };

/// A scene under construction.
#[derive(Default)]
struct Bench {
    g: Graph,
    functions: Functions,
    parameters: Vec<Parameter>,
}

impl Bench {
    fn new() -> Self {
        let mut bench = Self { g: Graph::new(), ..Self::default() };
        let zero = bench.c(0.0);
        let one = bench.c(1.0);
        let facing = bench.g.leaf(Leaf::Normal(1));
        let p = bench.g.point();
        bench.functions.surface = crate::functions::Surface {
            color: [one, facing, one],
            emission: [zero; 3],
            roughness: p[0],
            metallic: zero,
            reflectivity: zero,
            ..Default::default()
        };
        bench
    }

    fn c(&mut self, value: f64) -> NodeId {
        self.g.constant(value)
    }

    fn shape(&mut self, name: Option<&str>, value: NodeId) -> ShapeId {
        self.g.add_shape(Shape {
            name: name.map(Arc::from),
            dimensions: 3,
            value,
            variables: Arc::default(),
            exactness: Exactness::Exact,
            material: None,
            paints: Arc::default(),
            span: SPAN,
        })
    }

    fn parameter(&mut self, name: &str, default: &[f64], min: f64, max: f64) -> Vec<NodeId> {
        let first = self.g.parameters.len() as u32;
        for (i, &value) in default.iter().enumerate() {
            let (parameter, component) = (self.parameters.len() as u32, i as u8);
            self.g.parameters.push(ParameterComponent { parameter, component, default: value, min, max, whole: false });
        }
        self.parameters.push(Parameter {
            name: name.to_owned(),
            ty: if default.len() == 1 { Type::Float } else { Type::Vec(default.len() as u8) },
            degrees: false,
            length: None,
            default: default.to_vec(),
            min: vec![min; default.len()],
            max: vec![max; default.len()],
            choices: Vec::new(),
            description: Some("a description".to_owned()),
            span: SPAN,
            first: Some(first),
        });
        (0..default.len() as u32).map(|i| self.g.leaf(Leaf::Parameter(first + i))).collect()
    }

    fn factor(&mut self, name: &str, lipschitz: f64) -> NodeId {
        let index = self.g.factors.len() as u32;
        let reason = "a twist".to_owned();
        self.g.factors.push(Factor { name: name.to_owned(), lipschitz, reason, span: SPAN, proof: crate::graph::Proof::Derived });
        self.g.intern(crate::graph::Node::Factor(index))
    }

    /// Field, bound, distance and a made-up gradient of a shape.
    fn all(&mut self, shape: ShapeId, factor: Option<NodeId>) {
        let value = self.g.shape(shape).unwrap().value;
        let variables = self.g.shape(shape).unwrap().variables.clone();
        let formulas = &mut self.functions.formulas;
        formulas.insert((shape, Function::Field), value);
        let mut args = self.g.point().to_vec();
        args.extend(variables.iter().map(|&v| self.g.leaf(Leaf::Variable(v))));
        let own = self.g.call(shape, Function::Field, &args);
        let bound = match factor {
            Some(factor) => self.g.op(Op::Mul, &[own, factor]),
            None => own,
        };
        self.functions.formulas.insert((shape, Function::Bound), bound);
        let g = [0, 1, 2].map(|i| self.g.call(shape, Function::Gradient(i), &args));
        let steepness = self.g.op(Op::Length3, &g);
        let distance = self.g.op(Op::Div, &[own, steepness]);
        let distance = if factor.is_some() { distance } else { own };
        self.functions.formulas.insert((shape, Function::Distance), distance);
        let p = self.g.point();
        let length = self.g.op(Op::Length3, &p);
        for (i, &x) in p.iter().enumerate() {
            let slope = self.g.op(Op::Div, &[x, length]);
            self.functions.formulas.insert((shape, Function::Gradient(i as u8)), slope);
        }
    }

    fn sphere(&mut self, radius: f64) -> ShapeId {
        let p = self.g.point();
        let length = self.g.op(Op::Length3, &p);
        let radius = self.c(radius);
        let value = self.g.op(Op::Sub, &[length, radius]);
        let shape = self.shape(None, value);
        self.all(shape, None);
        shape
    }

    fn at(&mut self, shape: ShapeId, x: f64, y: f64, z: f64) -> NodeId {
        let p = self.g.point();
        let moved = [x, y, z];
        let mut point = p;
        for (slot, by) in point.iter_mut().zip(moved) {
            let by = self.c(by);
            *slot = self.g.op(Op::Sub, &[*slot, by]);
        }
        self.g.field(shape, point)
    }

    fn emit(&self, root: ShapeId, options: &Options) -> Module {
        let blocks = SceneBlocks { extent: 100.0, ..SceneBlocks::default() };
        emit(&self.g, root, &self.functions, &blocks, &self.parameters, options, &Sources::default(), None).unwrap()
    }

    fn check(&self, root: ShapeId, options: &Options) -> Module {
        let module = self.emit(root, options);
        if let Err(message) = validate(&module.wgsl) {
            panic!("{message}\n{}", module.wgsl);
        }
        assert_eq!(module.wgsl, self.emit(root, options).wgsl, "not the same bytes twice");
        tint(&module.wgsl);
        module
    }
}

/// A second WGSL implementation, where `SUREFOOT_TINT` names one.
fn tint(wgsl: &str) {
    let Some(program) = std::env::var_os("SUREFOOT_TINT") else { return };
    let hash = kernel::hash(wgsl.len() as f64, wgsl.bytes().map(f64::from).sum(), 0.0, 0.0);
    let path = std::env::temp_dir().join(format!("emit-{hash}-{}.wgsl", std::process::id()));
    std::fs::write(&path, wgsl).unwrap();
    let out = std::process::Command::new(program).args(["--format", "wgsl"]).arg(&path).output().unwrap();
    std::fs::remove_file(&path).unwrap();
    assert!(out.status.success(), "{}\n{wgsl}", String::from_utf8_lossy(&out.stderr));
}

/// Two named spheres, one of them twisted and live, in a smooth union.
fn pair() -> (Bench, ShapeId) {
    let mut b = Bench::new();
    let spin = b.parameter("spin", &[0.8], 0.0, 2.0)[0];
    let spot = b.parameter("column.spot", &[0.0, 1.0, 0.0], -2.0, 3.0);
    b.parameter("unused", &[1.0], 0.0, 1.0);
    let p = b.g.point();
    let angle = b.g.op(Op::Mul, &[p[1], spin]);
    let u = b.g.op(Op::TurnU, &[p[0], p[2], angle]);
    let v = b.g.op(Op::TurnV, &[p[0], p[2], angle]);
    let ball = b.sphere(1.0);
    let inside = b.g.field(ball, [u, p[1], v]);
    let drop = b.shape(Some("drop"), inside);
    let factor = b.factor("step_drop", 1.6);
    b.all(drop, Some(factor));
    let low = b.at(drop, 0.0, -1.0, 0.0);
    let q = [0, 1, 2].map(|i| b.g.op(Op::Sub, &[p[i], spot[i]]));
    let high = b.g.field(ball, q);
    let k = b.c(0.3);
    let apart = b.g.op(Op::Sub, &[low, high]);
    let apart = b.g.op(Op::Abs, &[apart]);
    let near = b.g.op(Op::Sub, &[k, apart]);
    let zero = b.c(0.0);
    let h = b.g.op(Op::Max, &[near, zero]);
    b.g.name_node(h, "length");
    let square = b.g.op(Op::Square, &[h]);
    let by = b.c(1.2);
    let dip = b.g.op(Op::Div, &[square, by]);
    let both = b.g.op(Op::Min, &[low, high]);
    let union = b.g.op(Op::Sub, &[both, dip]);
    let scene = b.shape(None, union);
    let factor = b.factor("step_scene", 1.7);
    b.all(scene, Some(factor));
    (b, scene)
}

#[test]
fn sphere_reads_like_one() {
    let mut b = Bench::new();
    let root = b.sphere(1.0);
    let options = Options { exports: vec![Export::Field], ..Options::default() };
    let module = b.check(root, &options);
    assert!(module.wgsl.contains("fn sf_field(p: vec3f) -> f32 {\n  let q = p + sf_uniforms.origin;\n  return length(q) - 1.0;\n}"), "{}", module.wgsl);
    assert_eq!(module.uniform_size, 16);
    assert_eq!(module.operations.0, 2);
}

#[test]
fn a_dear_arm_is_computed_where_it_is_taken() {
    let mut b = Bench::new();
    let p = b.g.point();
    // A sum of so many sines, and something that others read too.
    let dear = |b: &mut Bench, of: NodeId, count: usize| {
        (0..count).fold(of, |sum, i| {
            let k = b.c(1.5 + i as f64);
            let product = b.g.op(Op::Mul, &[of, k]);
            let sine = b.g.op(Op::Sin, &[product]);
            b.g.op(Op::Add, &[sum, sine])
        })
    };
    let shared = dear(&mut b, p[1], 20);
    let (left, right, cheap) = (dear(&mut b, p[0], 20), dear(&mut b, p[2], 20), dear(&mut b, p[2], 2));
    let sum = b.g.op(Op::Add, &[left, shared]);
    let is = b.g.op(Op::Lt, &[p[0], p[1]]);
    let one_arm = b.g.op(Op::Select, &[is, sum, cheap]);
    let is_not = b.g.op(Op::Lt, &[p[2], p[1]]);
    let both_arms = b.g.op(Op::Select, &[is_not, one_arm, right]);
    let all = b.g.op(Op::Add, &[both_arms, shared]);
    let root = b.shape(None, all);
    b.all(root, None);
    let wgsl = b.check(root, &Options { exports: vec![Export::Field], ..Options::default() }).wgsl;
    let body = wgsl.split("fn sf_field").last().unwrap();
    let (before, branches) = body.split_once("  if ").unwrap();
    // What both read comes first; of the branches the inner one stands in the outer one, and the cheap arm in none of its own.
    assert!(before.contains("sin(q.y * 20.5)") && !before.contains("q.x * 20.5"), "{wgsl}");
    let lines: Vec<&str> = branches.lines().filter(|l| l.contains("if ") || l.contains("else")).collect();
    assert_eq!(lines.len(), 2, "{wgsl}");
    assert!(lines[0].starts_with("    if ") && lines[1] == "  } else {", "{wgsl}");
}

#[test]
fn every_export_alone_and_together() {
    let (b, root) = pair();
    for export in Export::ALL {
        let options = Options { exports: vec![export], ..Options::default() };
        let module = b.check(root, &options);
        assert!(module.exports.contains(&export));
        for target in Target::ALL {
            let bytes = translate(&module, "sf_", target).unwrap();
            assert!(!bytes.is_empty());
        }
    }
    let module = b.check(root, &Options::default());
    println!("{}", module.wgsl);
    println!("{:#?}", module.skipped);
    assert_eq!(module.exports, Export::ALL);
    assert!(module.wgsl.contains("fn sf_drop("));
    assert!(!module.wgsl.contains("unused"));
    assert!(module.skipped.iter().any(|s| s.starts_with("unused")));
}

#[test]
fn what_is_asked_for_is_there_in_every_language() {
    for text in ["scene = plane(y) | sphere(1)", "scene = box(1).rotate(y, time)"] {
        let loader = crate::MemoryLoader::new().with("main.sdf", text);
        for export in Export::ALL {
            let options = Options { exports: vec![export], ..Options::default() };
            let module = crate::compile(&loader, "main.sdf", &options).compiled.unwrap().module;
            for target in [Target::Glsl, Target::Hlsl, Target::Msl] {
                let written = String::from_utf8(translate(&module, "sf_", target).unwrap()).unwrap();
                let name = format!(" sf_{}(", export.name());
                assert!(written.contains(&name), "{target:?} without{name} of `{text}`");
            }
        }
    }
}

#[test]
fn prefix_group_and_binding() {
    let (b, root) = pair();
    let options = Options { prefix: "blob".into(), group: 2, binding: 7, ..Options::default() };
    let module = b.check(root, &options);
    assert!(!module.wgsl.contains("sf_"));
    assert!(module.wgsl.contains("@group(2) @binding(7) var<uniform> blobuniforms"));
    let blocks = SceneBlocks::default();
    for prefix in ["1a", "a-b", "_", "é"] {
        let options = Options { prefix: prefix.into(), ..Options::default() };
        let result = emit(&b.g, root, &b.functions, &blocks, &b.parameters, &options, &Sources::default(), None);
        assert!(matches!(result, Err(EmitError::Prefix(_))), "{prefix}");
    }
}

#[test]
fn an_empty_prefix_stands_beside_the_built_in_names() {
    let (b, root) = pair();
    b.check(root, &Options { prefix: String::new(), ..Options::default() });
}

#[test]
fn offsets_are_those_that_naga_sees() {
    let mut b = Bench::new();
    // Each beside the point, so that the shader reads it.
    let [x, ..] = b.g.point();
    let mut sum = b.g.leaf(Leaf::Time);
    sum = b.g.op(Op::Mul, &[x, sum]);
    for (i, n) in [1, 2, 1, 3, 1, 4, 2, 3, 3, 1].into_iter().enumerate() {
        for part in b.parameter(&format!("p{i}"), &vec![0.5; n], 0.0, 1.0) {
            let part = b.g.op(Op::Mul, &[x, part]);
            sum = b.g.op(Op::Add, &[sum, part]);
        }
    }
    let root = b.shape(None, sum);
    b.all(root, None);
    let options = Options { exports: vec![Export::Field, Export::Occlusion], ..Options::default() };
    let module = b.check(root, &options);
    let (parsed, _) = validate(&module.wgsl).unwrap();
    let (members, span) = parsed
        .types
        .iter()
        .find_map(|(_, ty)| match &ty.inner {
            naga::TypeInner::Struct { members, span } => Some((members, *span)),
            _ => None,
        })
        .unwrap();
    assert_eq!(span, module.uniform_size);
    let theirs: Vec<_> = members.iter().map(|m| (m.name.clone().unwrap(), m.offset)).collect();
    let ours: Vec<_> = module.uniforms.iter().map(|u| (u.name.clone(), u.offset)).collect();
    assert_eq!(theirs, ours);
    assert_eq!(ours.len(), 1 + 1 + 10 + 2);
}

#[test]
fn a_repeated_cell_binds_its_variables() {
    let mut b = Bench::new();
    let cell = [b.g.fresh_variable(), b.g.fresh_variable(), b.g.fresh_variable()];
    let c = cell.map(|v| b.g.leaf(Leaf::Variable(v)));
    let world = [0, 1, 2].map(|i| b.g.leaf(Leaf::Variable(WORLD + i)));
    let p = b.g.point();
    let zero = b.c(0.0);
    let h = b.g.op(Op::Hash, &[c[0], c[1], c[2], zero]);
    b.g.name_node(h, "height");
    let wave = b.g.op(Op::Sin, &[world[0]]);
    let length = b.g.op(Op::Length3, &[p[0], p[1], p[2]]);
    let radius = b.g.op(Op::Add, &[h, wave]);
    let value = b.g.op(Op::Sub, &[length, radius]);
    let value = b.g.op(Op::Add, &[value, world[1]]);
    let value = b.g.op(Op::Mul, &[value, world[2]]);
    let pillar = b.shape(Some("pillar"), value);
    b.all(pillar, None);
    assert_eq!(b.g.shape(pillar).unwrap().variables.len(), 6);
    let two = b.c(2.0);
    let n = [0, 1, 2].map(|i| {
        let scaled = b.g.op(Op::Div, &[p[i], two]);
        b.g.op(Op::Round, &[scaled])
    });
    let mut args: Vec<NodeId> = (0..3)
        .map(|i| {
            let middle = b.g.op(Op::Mul, &[n[i], two]);
            b.g.op(Op::Sub, &[p[i], middle])
        })
        .collect();
    args.extend(world);
    args.extend(n);
    let cells = b.g.call(pillar, Function::Field, &args);
    let root = b.shape(None, cells);
    b.all(root, None);
    let module = b.check(root, &Options::default());
    println!("{}", module.wgsl);
    assert!(module.wgsl.contains("fn sf_pillar(p: vec3f, world: vec3f, k_a: f32, k_b: f32, k_c: f32) -> f32 {"));
    assert!(module.wgsl.contains("let height = sf_hash(k_a, k_b, k_c, 0.0);"));
}

#[test]
fn ten_thousand_spheres() {
    let mut b = Bench::new();
    let ball = b.sphere(0.1);
    let mut level: Vec<NodeId> = (0..10_000)
        .map(|i| b.at(ball, f64::from(i % 100), f64::from(i / 100), 0.5))
        .collect();
    while level.len() > 1 {
        level = level.chunks(2).map(|pair| match *pair {
            [x, y] => b.g.op(Op::Min, &[x, y]),
            _ => pair[0],
        }).collect();
    }
    let root = b.shape(None, level[0]);
    b.all(root, None);
    b.check(root, &Options { exports: vec![Export::Field], ..Options::default() });
}

#[test]
fn a_chain_of_ten_thousand_shapes() {
    let mut b = Bench::new();
    let ball = b.sphere(0.1);
    let mut chain = ball;
    for i in 0..10_000 {
        let p = b.g.point();
        let inner = b.g.field(chain, p);
        let next = b.at(ball, f64::from(i), 0.0, 0.0);
        let both = b.g.op(Op::Min, &[inner, next]);
        chain = b.shape(None, both);
        b.functions.formulas.insert((chain, Function::Field), both);
    }
    b.check(chain, &Options { exports: vec![Export::Field], ..Options::default() });
}

#[test]
fn every_operation_is_valid_wgsl() {
    for row in kernel::KERNEL {
        let mut b = Bench::new();
        let p = b.g.point();
        let x = b.g.op(Op::Add, &[p[0], p[1]]);
        let is = b.g.op(Op::Lt, &[p[0], p[1]]);
        let args: Vec<NodeId> = (0..usize::from(row.arity))
            .map(|i| match row.op {
                Op::And | Op::Or | Op::Not => is,
                Op::Select if i == 0 => is,
                _ if i == 1 => x,
                _ => p[i % 3],
            })
            .collect();
        let args = match row.op {
            Op::And | Op::Or => vec![is, b.g.op(Op::Not, &[is])],
            _ => args,
        };
        let mut value = b.g.op(row.op, &args);
        if row.result == kernel::Kind::Condition {
            value = b.g.op(Op::Select, &[value, p[0], p[1]]);
        }
        let root = b.shape(None, value);
        b.all(root, None);
        b.check(root, &Options { exports: vec![Export::Field], ..Options::default() });
    }
}

#[test]
fn conditions_keep_their_parentheses() {
    let mut b = Bench::new();
    let p = b.g.point();
    let zero = b.c(0.0);
    let one = b.c(1.0);
    let less = [0, 1, 2].map(|i| b.g.op(Op::Lt, &[p[i], zero]));
    let and = b.g.op(Op::And, &[less[0], less[1]]);
    let or = b.g.op(Op::Or, &[and, less[2]]);
    let le = b.g.op(Op::Le, &[p[0], one]);
    let both = b.g.op(Op::And, &[or, le]);
    let not = b.g.op(Op::Not, &[both]);
    let minus = b.g.op(Op::Neg, &[p[0]]);
    let a = b.g.op(Op::Select, &[not, minus, one]);
    let on = b.parameter("on", &[1.0], 0.0, 1.0)[0];
    let value = b.g.op(Op::Select, &[on, a, p[2]]);
    let root = b.shape(None, value);
    b.all(root, None);
    let module = b.check(root, &Options { exports: vec![Export::Field], ..Options::default() });
    println!("{}", module.wgsl);
}

#[test]
fn a_constant_quarter_turn_has_no_cosine() {
    let mut b = Bench::new();
    let p = b.g.point();
    let quarter = b.c(std::f64::consts::FRAC_PI_2);
    let u = b.g.op(Op::TurnU, &[p[0], p[2], quarter]);
    let v = b.g.op(Op::TurnV, &[p[0], p[2], quarter]);
    let value = b.g.op(Op::Min, &[u, v]);
    let root = b.shape(None, value);
    b.all(root, None);
    let module = b.check(root, &Options { exports: vec![Export::Field], ..Options::default() });
    assert!(module.wgsl.contains("return min(-q.z, q.x);"), "{}", module.wgsl);
}

#[test]
fn what_is_missing_is_said() {
    let mut b = Bench::new();
    let root = b.sphere(1.0);
    b.functions.formulas.remove(&(root, Function::Gradient(1)));
    let module = b.check(root, &Options::default());
    assert!(!module.exports.contains(&Export::Gradient));
    assert!(!module.exports.contains(&Export::Collision));
    assert_eq!(module.skipped.len(), 2, "{:?}", module.skipped);
}

#[test]
fn nothing_is_read_for_nothing() {
    let (b, root) = pair();
    let options = Options { exports: vec![Export::Field], ..Options::default() };
    let module = b.check(root, &options);
    let factor = |u: &crate::interface::Uniform| matches!(u.source, UniformSource::Factor(_));
    assert!(!module.uniforms.iter().any(factor));
    assert!(!module.wgsl.contains("struct sf_Hit"));
    assert!(!module.wgsl.contains("fn sf_div"));
}

#[test]
fn glsl_chooses_without_branches() {
    let text = "// (a ? b : c)\nfloat f(bool c) {\n    return (c ? (((1.0 < x) ? y : f(2.0)) + 1.0) : 0.0);\n}\n";
    let straight = super::straight::choices(text, "pick");
    assert!(straight.starts_with("// (a ? b : c)\n") && straight.contains("return pick(0.0, (pick(f(2.0), y, (1.0 < x)) + 1.0), c);"), "{straight}");
    assert_eq!(super::straight::choices("int a = (b + c);\n", "pick"), "int a = (b + c);\n");
    // A name that the text has is not taken again.
    assert!(super::straight::choices("float pick(float a) {\n    return (a < 0.0 ? a : pick(1.0));\n}\n", "pick").contains("return picked(pick(1.0), a, a < 0.0);"));
    // A module with a shadow, lights and reflections holds nothing that naga writes under a condition of its own.
    let scene = "light { direction: (0, -1, 0) }\nrender { reflections: 2 }\nmaterial mirror { roughness: 0.1 }\nscene = plane(y) | box(1).twist(y, 0.3).material(mirror)\n";
    let loader = crate::MemoryLoader::new().with("main.sdf", scene);
    let options = Options { entry: crate::compiled::Entry::Draw, live_in_shader: true, ..Options::default() };
    let outcome = crate::compile(&loader, "main.sdf", &options);
    let module = outcome.compiled.unwrap_or_else(|| panic!("{:?}", outcome.diagnostics)).module;
    let written = String::from_utf8(translate(&module, "sf_", Target::Glsl).unwrap()).unwrap();
    let code: Vec<&str> = written.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
    assert!(code.iter().any(|line| line.contains("sf_pick(")) && !code.iter().any(|line| line.contains(" ? ") || line.contains("loop_init")), "{written}");
}
