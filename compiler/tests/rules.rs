//! What the language's rules say, as values: of expressions without a point, and of shapes at points.

use surefoot_compiler::diagnostic::render;
use surefoot_compiler::evaluate::Tape;
use surefoot_compiler::graph::Function;
use surefoot_compiler::{compile, Compiled, MemoryLoader, Options};

fn scene(text: &str) -> Compiled {
    let loader = MemoryLoader::new()
        .with("main.sdf", text)
        .with("one.sdf", "import \"two.sdf\"\nparam flutes: int = 4 in 1..9\nlet depth = 7\nshape both = sphere(1)\nscene = sphere(flutes)")
        .with("two.sdf", "let depth2 = 8\nshape both = box(2)\nshape twice(s: shape, k: float = 2) = s.scale(k)");
    let outcome = compile(&loader, "main.sdf", &Options::default());
    let said = render(&outcome.sources, &outcome.diagnostics, false);
    outcome.compiled.unwrap_or_else(|| panic!("{text}\n{said}"))
}

/// The value of an expression that needs no point, after some declarations.
fn number(declarations: &str, expression: &str) -> f64 {
    let scene = scene(&format!(
        "{declarations}\nscene = sphere(1)\ncamera {{ eye: ({expression}, 1e6, 0) }}"
    ));
    scene.values(&scene.live(), &[scene.blocks.cameras[0].eye.unwrap()[0]])[0]
}

/// The field of a scene at a point.
fn field(text: &str, point: [f64; 3]) -> f64 {
    let scene = scene(text);
    let root = scene.functions.formulas[&(scene.root, Function::Field)];
    let tape = Tape::new(&scene.graph, &scene.functions.formulas, &[root], &scene.live(), 100_000).unwrap();
    let mut value = f64::NAN;
    tape.evaluator().at(&[point], &[], |_, values| value = values[0]);
    value
}

#[track_caller]
fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-5, "{found} is not {expected}");
}

#[test]
fn operators_bind_as_the_rules_say() {
    for (expression, expected) in [
        ("7 / 2", 3.5),
        ("-7 % 3", 2.0),
        ("7 - 2 - 1", 4.0),
        ("2 + 3 * 4", 14.0),
        ("-pow(2, 2)", -4.0),
        ("if 1 < 2 && !(2 < 1) || false { 1 } else { 2 }", 1.0),
        ("if 1 != 2 == true { 1 } else { 2 }", 1.0),
        ("(1, 2, 3).zyx.xy.x", 3.0),
        ("#ff0000.r + (1, 2).g", 3.0),
        ("180deg + 0.5turn", std::f64::consts::TAU),
        ("{ let a = 2; let b = a * a; b + 1 }", 5.0),
    ] {
        near(number("", expression), expected);
    }
}

#[test]
fn functions_of_glsl_are_there() {
    for (expression, expected) in [
        ("vec3(2).y + vec3((1, 2), 3).z + vec2((1, 2, 3)).y", 7.0),
        ("(mat2(0, 1, -1, 0) * (1, 2)).x", -2.0),
        ("((1, 2) * mat2(0, 1, -1, 0)).x", 2.0),
        ("(mat3(2) / 4)[1].y + determinant(mat2(2)) + transpose(mat2(1, 2, 3, 4))[0].y", 7.5),
        ("(inverse(mat2(2, 0, 0, 4)) * (1, 1)).y", 0.25),
        ("clamp(3, 0, 1) + smoothstep(0, 2, 1) + step(1, 1)", 2.5),
        ("mix(1, 3, 0.25) + round(2.6) + length((3, 4))", 9.5),
        ("mix((0, 0), (2, 4), 0.5).y", 2.0),
        ("mod(-1, 3) + fract(-0.25) + trunc(-1.5) + ceil(0.5) + floor(-0.5)", 1.75),
        ("max(1, 2, 5) + min(3, 2, 1) + abs(-4) + sign(-2)", 9.0),
        ("cross(x, y).z + dot((1, 2), (3, 4)) + distance(x, -x)", 14.0),
        ("reflect((1, -1, 0), y).y + normalize((0, 0, 5)).z", 2.0),
        ("atan(1, 1) + atan(1) - radians(90)", 0.0),
        ("length1((3, -4)) + length_inf((3, -4)) + length8((2, 0))", 13.0),
        ("int(2.7) + float(true) + int(true) + pow(2, 3)", 12.0),
    ] {
        near(number("", expression), expected);
    }
}

#[test]
fn whole_powers_take_negative_numbers() {
    for (base, exponent, expected) in
        [(-2.0, 2, 4.0), (-2.0, 3, -8.0), (-2.0, -1, -0.5), (-1.5, 0, 1.0), (-1.1, 17, -5.0544702849), (-1.1, 18, 5.5599173134), (-1.1, -19, -0.1635079831)]
    {
        let given = format!("param a = {base} in -3..3\nlet c = {base}\nfn power(t: float) = pow(t, {exponent})");
        // Written out, by a name, as an argument, live, and at a point.
        for expression in [format!("pow({base}, {exponent})"), format!("pow(c, {exponent})"), format!("power({base})"), format!("pow(a, {exponent})")] {
            near(number(&given, &expression), expected);
        }
        near(field(&format!("field f = pow(clamp(p.x, -2, -1), {exponent})\nscene = f"), [base, 0.0, 0.0]), expected);
    }
    near(number("", "for i in -3..3 by + { pow(i, 3) }"), -27.0);
    near(number("", "pow((-2, 3), 2).x"), 4.0);
    // What has no sign of its own.
    for (base, power) in [("length(p)", 18), ("sqrt(abs(p.x) + 0.5)", 36), ("abs(-p.x)", 18), ("-p.x * p.x", 18), ("1.1", 18)] {
        let expected = match base {
            "-p.x * p.x" => 30.9126805133,
            "sqrt(abs(p.x) + 0.5)" => 1.6f64.powi(18),
            _ => 5.5599173134,
        };
        near(field(&format!("field f = pow({base}, {power})\nscene = f"), [1.1, 0.0, 0.0]), expected);
    }
}

#[test]
fn arguments_are_named_wherever_they_are_taken() {
    for (expression, expected) in [
        ("min(b: 1, a: 2) + atan2(x: 1, y: 0) + length(v: (3, 4)) + dot(a: x, b: x)", 7.0),
        ("largest(v: (1, 2, 3)) + length1(v: (3, -4)) + round(a: 1.2)", 11.0),
        ("pow(2, b: 3) + hash(3, seed: 2) - hash(v: 3, seed: 2)", 8.0),
        ("turn(angle: 90deg, v: (1, 0)).y + turn_about(x, angle: 90deg, axis: z).y", 2.0),
        ("fbm(octaves: 2, v: (0.1, 0.2)) - fbm((0.1, 0.2), 2)", 0.0),
        ("mix(a: 1, b: 3, t: 0.5)", 2.0),
        // Brackets with nothing in them may be left off.
        ("(-1).abs + (1.2).floor + [3, 4][0].sq + twice.sq + mat2(2).determinant", 31.0),
        ("(3, 4).length + (2.5).double", 10.0),
    ] {
        near(number("let twice = 4\nfn double(t: float) = 2 * t", expression), expected);
    }
    // What stands first says which of several is meant, by name too.
    near(field("scene = scale(s: circle(1), k: 2).extrude(1)", [3.0, 0.0, 0.0]), 1.0);
    near(field("scene = mix(b: sphere(3), a: sphere(1), t: 0.5)", [4.0, 0.0, 0.0]), 2.0);
    near(field("scene = sphere(1).matrix(m: mat4(1))", [3.0, 0.0, 0.0]), 2.0);
    // A vector may be written out beside what is named.
    near(field("scene = sphere(1).repeat(4, 0, 4, count: (3, 1, 3))", [6.0, 0.0, 0.0]), 1.0);
    // Where a whole number is needed a slider's is rounded.
    for n in ["6", "5.6", "6.4"] {
        near(field(&format!("param n = {n} in 3..12\nscene = prism(n, 1, 0.5)"), [0.3, 0.9, 0.2]), field("scene = prism(6, 1, 0.5)", [0.3, 0.9, 0.2]));
    }
    // A combination of numbers is what it is of shapes.
    near(field("field f = round(length(p), 0.1) + length(p).round(0.25)\nscene = f", [1.0, 0.0, 0.0]), 1.65);
}

#[test]
fn lists_and_folds() {
    let given = "let l = [1, 2, 4]\nparam i: int = 2 in 0..2\nlet q = [for i in 0..3 { (i, i * i) }]";
    for (expression, expected) in [
        ("l.count + l[1]", 5.0),
        ("l[i]", 4.0),
        ("q[2].y + q.count", 7.0),
        ("q[i].x", 2.0),
        ("for v in l by + { v }", 7.0),
        ("for v in l by * { 2 * v }", 64.0),
        ("for v in l by max { v } + for v in l by min { v }", 5.0),
        ("for v in l { v }", 1.0),
        ("for k in 0..0 by + { k }", 0.0),
        ("for k in 0..0 by * { k }", 1.0),
        ("for k in 0..i by + { k + 1 }", 3.0),
        ("for a in [[1, 2], [3]] by + { a.count }", 3.0),
    ] {
        near(number(given, expression), expected);
    }
}

#[test]
fn declarations_call_themselves_and_iterate() {
    let given = "fn f(k: int) = if k < 2 { 1 } else { k * f(k - 1) }\n\
        fn g(t) = { let a = 0, b = 1 for i in 0..t while b < 100 { let c = a + b; a = b, b = c }; b }\n\
        fn h(a: float, b: float = 2 * a, c: float = a + b) = a + 10 * b + 100 * c";
    for (expression, expected) in [
        ("f(5)", 120.0),
        ("g(5)", 8.0),
        ("g(50)", 144.0),
        ("h(1)", 321.0),
        ("h(1, c: 0)", 21.0),
        ("h(b: 1, a: 3)", 413.0),
    ] {
        near(number(given, expression), expected);
    }
    let tree = "shape tree(n: int) = if n > 0 { sphere(0.1).translate(n, 0, 0) | tree(n - 1) }\nscene = tree(3)";
    near(field(tree, [3.0, 0.5, 0.0]), 0.4);
    let chain = "field f(n: int) = if n > 0 { min(f(n - 1), length(p - (n, 0, 0)) - 0.1) } else { length(p) - 0.1 }\nscene = f(3)";
    near(field(chain, [2.0, 0.5, 0.0]), 0.4);
}

#[test]
fn every_form_of_a_parameter() {
    let given = "param n: int = 6 in 1..12\nparam on = true\nparam tint = #ff0000\n\
        param spot = (0, 1, 0) in (-2, 0, -2)..(2, 3, 2)\nparam style = b in [a, b]\nlet a = 3\nlet b = 4\n\
        param angle = 30deg in 0deg..90deg\nparam plain = 3";
    let text = format!("{given}\nscene = sphere(plain)\ncamera {{ eye: (n + spot.y + tint.r + style + sin(angle) + if on {{ 1 }} else {{ 0 }}, 9, 9) }}");
    let scene = scene(&text);
    let eye = scene.blocks.cameras[0].eye.unwrap()[0];
    let mut live = scene.live();
    near(scene.values(&live, &[eye])[0], 13.5);
    assert_eq!(scene.parameters.len(), 7);
    assert!(scene.parameters[5].degrees);
    assert_eq!(scene.parameters[6].max, [6.0]);
    let first = scene.parameters[0].first.unwrap() as usize;
    live.components[first] = 7.0;
    near(scene.values(&live, &[eye])[0], 14.5);
}

#[test]
fn names_are_hidden_in_their_order() {
    // Locals hide the file's, which hide imports', which hide the prelude's.
    near(number("let depth = 1\nimport \"one.sdf\"", "depth + { let depth = 5; depth }"), 6.0);
    near(number("import \"one.sdf\"", "depth + flutes"), 11.0);
    near(number("let pi = 3\nlet x = (7, 0, 0)\nfn length(v) = 5", "pi + x.x + length((1, 1))"), 15.0);
    near(number("import \"two.sdf\" as far\nfn far2(far: float) = far", "far.depth2 + far2(1)"), 9.0);
    let both = "import \"one.sdf\"\nimport \"two.sdf\" as t\nscene = t.both.translate(9, 0, 0) | both | sphere(1).t.twice(3).translate(0, 9, 0)";
    near(field(both, [0.0, 0.0, 2.0]), 1.0);
    near(field(both, [9.0, 0.0, 2.0]), 1.0);
    near(field(both, [0.0, 9.0, 4.0]), 1.0);
    let scene = scene("import \"one.sdf\"\nscene = sphere(flutes)");
    assert_eq!(scene.parameters[0].name, "one.flutes");
}

#[test]
fn words_of_the_language_are_names_behind_a_dot_and_before_a_colon() {
    let text = "shape by(s: shape, in: float, for: float = 2) = s.scale(2)\nscene = sphere(1).by(in: 7)";
    near(field(text, [5.0, 0.0, 0.0]), 3.0);
}

#[test]
fn shapes_combine_and_move() {
    for (text, point, expected) in [
        ("sphere(1) | box(1).translate(4, 0, 0) & sphere(9) - sphere(0.1)", [0.0, 3.0, 0.0], 2.0),
        ("!sphere(1)", [3.0, 0.0, 0.0], -2.0),
        ("box(2) - sphere(0.5)", [0.0, 0.0, 0.0], 0.5),
        ("sphere(1).translate((1, 0, 0)).rotate(y, 90deg)", [0.0, 0.0, -3.0], 1.0),
        ("for i in 0..3 { sphere(0.5).translate(2 * i, 0, 0) }.translate(0, 1, 0)", [4.0, 3.0, 0.0], 1.5),
        ("for i in 0..3 by smooth_union(0.1) { sphere(0.5).translate(4 * i, 0, 0) }", [8.0, 2.0, 0.0], 1.5),
        ("for s in [sphere(1), box(2).translate(5, 0, 0)] { s }", [5.0, 3.0, 0.0], 2.0),
        ("for k in polar(y, 4) { sphere(0.5).translate(3, 0, 0) }", [0.0, 0.0, 5.0], 1.5),
        ("for c in grid((4, 0, 4)) { sphere(1 + 0.5 * min(abs(c.z), 1)) }", [4.0, 2.0, 8.0], 0.5),
        ("for c in grid((4, 4, 4), (2, 1, 1)) { sphere(1 + c.x / 8) }", [2.0, 0.0, 3.0], 1.875),
        ("for i in 0..4 { if i % 2 == 1 { sphere(0.5).translate(3 * i, 0, 0) } }", [6.0, 0.0, 0.0], 2.5),
        ("(if 1 > 2 { sphere(1) } else if 3 > 2 { sphere(2) } else { nothing })", [3.0, 0.0, 0.0], 1.0),
        ("mix(sphere(1), sphere(3), 0.5) | sphere(round(0.6))", [5.0, 0.0, 0.0], 3.0),
        ("sphere(1).round(0.5)", [2.0, 0.0, 0.0], 0.5),
        ("(rectangle(2, 1) - circle(0.1)).extrude(2)", [0.0, 3.0, 0.0], 2.5),
        ("circle(1).translate(2 * x + y).extrude(2)", [2.0, 4.0, 0.0], 2.0),
        ("circle(1).translate(2, 1).symmetry(x).extrude(2)", [-2.0, 4.0, 0.0], 2.0),
        ("circle(1).translate(2, 1).mirror(-y).extrude(2)", [2.0, -4.0, 0.0], 2.0),
        ("circle(1).repeat(4 * x, 3).extrude(2)", [4.0, 3.0, 0.0], 2.0),
        ("segment(-x, x + y).round(1).extrude(2)", [-3.0, 0.0, 0.0], 1.0),
        ("(for a in [x, y] { circle(1).translate(3 * a) }).extrude(2)", [0.0, 6.0, 0.0], 2.0),
    ] {
        near(field(&format!("scene = {text}"), point), expected);
    }
}

/// What joins two joins more of them, as it would one after the other.
#[test]
fn blends_of_many_are_folded_in_their_order() {
    let given = "let a = box(1)\nlet b = sphere(0.6).translate(0.4, 0, 0)\nlet c = box(0.8).translate(0, 0.5, 0)\nlet d = sphere(0.3).translate(0, 0, 0.5)\n";
    let mut calls: Vec<(String, String)> = Vec::new();
    for kind in ["union", "intersection", "difference"] {
        let fold = |name: &str, rest: &str| format!("{name}({name}({name}(a, b{rest}), c{rest}), d{rest})");
        calls.push((format!("{kind}(a, b, c, d)"), fold(kind, "")));
        calls.push((format!("{kind}([a, b, c, d])"), fold(kind, "")));
        for form in ["smooth", "round", "chamfer", "stairs"] {
            let name = format!("{form}_{kind}");
            let folded = fold(&name, ", 0.1");
            for call in ["(a, b, c, d, 0.1)", "([a, b, c, d], 0.1)", "(a, b, c, d, k: 0.1)", "([a, b], c, d, 0.1)"] {
                calls.push((format!("{name}{call}"), folded.clone()));
            }
            calls.push((format!("a.{name}(b, c, d, 0.1)"), folded.clone()));
            calls.push((format!("[a, b, c, d].{name}(0.1)"), folded));
        }
    }
    calls.push(("stairs_union(a, b, c, d, 0.1, 2)".into(), "stairs_union(stairs_union(stairs_union(a, b, 0.1, 2), c, 0.1, 2), d, 0.1, 2)".into()));
    let formula = |of: &str| format!("f.within(box(3))\nfield f = {of}");
    calls.push((formula("smooth_union(length(p), p.x, p.y, 0.3)"), formula("smooth_union(smooth_union(length(p), p.x, 0.3), p.y, 0.3)")));
    for (many, folded) in calls {
        for point in [[0.1, 0.2, 0.3], [0.55, 0.5, 0.3], [0.4, 0.62, 0.45]] {
            let [many, folded] = [&many, &folded].map(|text| field(&format!("{given}scene = {text}"), point));
            assert_eq!(many, folded, "{many}");
        }
    }
}

/// A T whose front and back are flush, made in several ways.
const FLUSH: [&str; 6] = [
    "(box((2, 1, 1)), box((0.6, 2, 1)).translate(0, 0.8, 0), 0.2)",
    "(rectangle(2, 1).extrude(1), rectangle(0.6, 2).translate(0, 0.8).extrude(1), 0.2)",
    "(box((2, 1, 1)).translate(1, 0, 0), box((0.6, 2, 1)).translate(1, 0.8, 0), 0.2).translate(-1, 0, 0)",
    "(box((1, 2, 1)).rotate(z, 90deg), box((0.6, 2, 1)).translate(0, -0.8, 0).mirror(y), 0.2)",
    "([box((2, 1, 1)), box((0.6, 2, 1)).translate(0, 0.8, 0), box((0.4, 1, 1)).translate(0.8, 0.1, 0)], 0.2)",
    "(rounded_box((2, 1, 1), 0.02), rounded_box((0.6, 2, 1), 0.02).translate(0, 0.8, 0), 0.2)",
];

/// Where faces of both lie in one plane a blend does not bulge over it, and its groove is as it was.
#[test]
fn flush_faces_stay_flat() {
    for (form, in_groove) in [("round", [0.34, 0.54]), ("smooth", [0.31, 0.51]), ("chamfer", [0.36, 0.56]), ("stairs", [0.33, 0.53])] {
        for given in FLUSH {
            let text = format!("scene = {form}_union{given}");
            for i in 0..400 {
                let (x, y) = (f64::from(i % 20) / 8.0 - 1.2, f64::from(i / 20) / 7.0 - 0.7);
                assert!(i % 7 > 0 || field(&text, [x, y, 0.5001]) > 0.0 && field(&text, [x, y, -0.5001]) > 0.0, "{text}: {x} {y}");
            }
            assert!(field(&text, [in_groove[0], in_groove[1], 0.2]) < 0.0, "{text}");
            assert!(field(&text, [0.0, 0.4, 0.49]) < 0.0, "{text}");
        }
    }
    // The edges of a drawing are flush too.
    let drawn = "scene = round_union(rectangle(2, 1), rectangle(0.6, 2).translate(0, 0.5), rectangle(0.4, 1).translate(0.8, 0), 0.2).extrude(2)";
    assert!(field(drawn, [0.0, -0.5001, 0.0]) > 0.0 && field(drawn, [0.8, -0.5001, 0.0]) > 0.0);
}

/// What is round there, or stands apart, is blended as ever.
#[test]
fn what_is_not_flush_is_not_cut_off() {
    for (text, point) in [
        ("smooth_union(sphere(0.5), sphere(0.5).translate(0.2, 0, 0), 0.3)", [0.1, 0.0, 0.55]),
        ("smooth_union(capsule(0.5, 2), capsule(0.5, 2).translate(0.2, 0, 0), 0.4)", [0.1, 0.0, 0.55]),
        ("round_union(cylinder(0.5, 1).rotate(x, 90deg), cylinder(0.5, 1).rotate(x, 90deg).translate(0, 0.9, 0.1), 0.2)", [0.0, 0.45, 0.53]),
        ("round_union(box((2, 1, 1)), box((0.6, 2, 1)).translate(0, 0.8, 0.05), 0.2)", [0.0, 0.2, 0.57]),
    ] {
        assert!(field(&format!("scene = {text}"), point) < 0.0, "{text}");
    }
}

/// A row of houses on flat ground is one union still.
#[test]
fn a_chain_of_flush_blends_is_one_union() {
    for apart in ["1", "0.4", "0.45"] {
        let text = format!("scene = for i in 0..200 by smooth_union(0.1) {{ box((0.4, 1 + hash(i), 0.4)).translate({apart} * (i % 20), 0.5 + hash(i) / 2, {apart} * floor(i / 20)) }}");
        let scene = scene(&text);
        assert!(!scene.functions.unions.is_empty(), "{text}");
        assert!(apart == "1" || field(&text, [0.4, -0.0001, 0.4]) > 0.0, "{text}");
    }
}

#[test]
fn formulas_use_shapes_blends_and_warps() {
    for (text, point, expected) in [
        ("warp up(h: float) = p + (0, h, 0)\nfield f = length(up(p, 1)) - 1\nscene = f", [0.0, 3.0, 0.0], 3.0),
        ("field f = smooth_union(length(p) - 1, 5, 0.1)\nscene = f", [3.0, 0.0, 0.0], 2.0),
        ("field f = sphere(1).at(p - x) + 0.5\nscene = f", [4.0, 0.0, 0.0], 2.5),
        ("field f = length(rotate(p, y, 90deg) - x) - 0.5\nscene = f", [0.0, 0.0, -3.0], 1.5),
        ("field f = length(translate(p, 1, 0, 0)) - 0.5\nscene = f.translate(1, 0, 0)", [2.0, 3.0, 0.0], 2.5),
        ("field f(g: field) = length(p) - g\nscene = f(1 + 0.1 * sin(p.x))", [0.0, 3.0, 0.0], 2.0),
        ("blend b(a, b, r: field) = min(a, b) - r\nscene = b(sphere(1), sphere(2), 0.5)", [5.0, 0.0, 0.0], 2.5),
        ("field f = length(world) - 1\nscene = f.translate(5, 0, 0)", [3.0, 0.0, 0.0], 2.0),
        ("field2 f = dot(p - x, y + x) - 1\nscene = f.extrude(2)", [3.0, 1.0, 0.0], 2.0),
        ("let side = x\nfield2 f = length(p - 2 * side) - 1\nscene = f.extrude(2)", [5.0, 0.0, 0.0], 2.0),
    ] {
        near(field(text, point), expected);
    }
}

#[test]
fn turns_about_any_axis_go_by_the_right_hand() {
    // By Rodrigues' formula, with the angle as a number and as a slider.
    for axis in [[1.0, 1.0, 1.0], [1.0, 2.0, 0.5], [-0.3, 0.1, 2.0], [0.0, 1.0, 1.0], [1.0, -1e-3, 0.0]] {
        for degrees in [120.0, -35.0_f64] {
            let length = axis.iter().map(|c: &f64| c * c).sum::<f64>().sqrt();
            let k = axis.map(|c| c / length);
            let v = [0.4, -0.7, 1.1];
            let (sin, cos) = degrees.to_radians().sin_cos();
            let along: f64 = k.iter().zip(v).map(|(k, v)| k * v).sum();
            let crossed = [k[1] * v[2] - k[2] * v[1], k[2] * v[0] - k[0] * v[2], k[0] * v[1] - k[1] * v[0]];
            for (i, c) in ["x", "y", "z"].iter().enumerate() {
                let expected = v[i] * cos + crossed[i] * sin + k[i] * along * (1.0 - cos);
                let [i, j, l] = axis;
                for angle in [format!("{degrees}deg"), "turned".to_owned()] {
                    let declared = format!("param turned = {degrees}deg in -180deg..180deg");
                    let found = number(&declared, &format!("turn_about((0.4, -0.7, 1.1), normalize(({i}, {j}, {l})), {angle}).{c}"));
                    near(found, expected);
                }
            }
        }
    }
}

#[test]
fn a_complement_of_a_complement_is_the_shape() {
    for (twice, once) in [("!!sphere(1)", "sphere(1)"), ("!!!plane(y)", "!plane(y)"), ("(!!circle(1)).extrude(2)", "circle(1).extrude(2)")] {
        let [twice, once] = [twice, once].map(|text| scene(&format!("scene = {text}\n")));
        assert_eq!(twice.module.operations, once.module.operations);
        assert_eq!(twice.bounds(), once.bounds());
    }
    near(field("scene = !!sphere(1)", [0.0, 0.0, 3.0]), 2.0);
    near(field("scene = !!!sphere(1)", [0.0, 0.0, 3.0]), -2.0);
}
