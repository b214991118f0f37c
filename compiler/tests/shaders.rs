//! Functions of shaders: what becomes of them as text, and what is said of those that can't be.

use surefoot_compiler::compiled::Compiled;
use surefoot_compiler::diagnostic::{self, Severity};
use surefoot_compiler::evaluate::Tape;
use surefoot_compiler::graph::Function;
use surefoot_compiler::program::load::translate;
use surefoot_compiler::random::Random;
use surefoot_compiler::shader::{Language, Translation};
use surefoot_compiler::{MemoryLoader, Options, Outcome, compile, syntax};

fn shaders() -> Vec<(String, String)> {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/corpus/shaders");
    let mut shaders: Vec<(String, String)> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .map(|path| (path.file_name().unwrap().to_string_lossy().into_owned(), std::fs::read_to_string(&path).unwrap()))
        .collect();
    shaders.sort();
    shaders
}

fn outcome(files: &[(&str, &str)]) -> Outcome {
    let loader = files.iter().fold(MemoryLoader::new(), |loader, (name, text)| loader.with(name, *text));
    compile(&loader, "main.sdf", &Options::default())
}

fn compiled(files: &[(&str, &str)]) -> Compiled {
    let outcome = outcome(files);
    outcome.compiled.unwrap_or_else(|| panic!("{}", diagnostic::render(&outcome.sources, &outcome.diagnostics, false)))
}

fn values(scene: &Compiled, points: &[[f64; 3]]) -> Vec<f64> {
    let root = scene.functions.formulas[&(scene.root, Function::Field)];
    let mut live = scene.live();
    live.time = 0.75;
    let tape = Tape::new(&scene.graph, &scene.functions.formulas, &[root], &live, 4_000_000).unwrap();
    let mut all = vec![0.0; points.len()];
    tape.evaluator().at(points, &[], |i, values| all[i] = values[0]);
    all
}

fn made(name: &str, text: &str) -> Translation {
    translate(name, text, Language::of(name).unwrap()).unwrap_or_else(|why| panic!("{name}: {why:?}"))
}

#[test]
fn text_that_is_imported_has_the_values_of_the_shader() {
    let mut random = Random(3);
    let points: Vec<[f64; 3]> = (0..500).map(|_| [0; 3].map(|_| 4.0 * random.next() - 2.0)).collect();
    for (name, text) in shaders() {
        let written = made(&name, &text);
        assert_eq!(syntax::format(&written.text).unwrap(), written.text, "{name}: it is laid out");
        let left_out: Vec<&str> = written.left_out.iter().map(|(name, _)| name.as_str()).collect();
        assert!(left_out.is_empty() || left_out == ["mainImage"], "{name}: {:?}", written.left_out);
        let part = if written.functions.iter().find(|f| f.name == "map").unwrap().ty.starts_with("vec") { ".x" } else { "" };
        let imported = format!("{}field it = map(p){part}\nscene = it\nrender {{ extent: 6 }}", written.text);
        let imported = compiled(&[("main.sdf", &imported)]);
        let main = format!("import \"{name}\"\nfield it = shader(\"{name}\", map)\nscene = it\nrender {{ extent: 6 }}");
        let named = compiled(&[("main.sdf", &main), (&name, &text)]);
        assert_eq!(values(&imported, &points), values(&named, &points), "{name}");
    }
}

#[test]
fn names_are_kept() {
    let written = made("a.glsl", "uniform float size;\nconst float K = 2.0;\nstruct Hit { float d; float id; };\nHit unite(Hit a, Hit b) { if (a.d < b.d) return a; return b; }\n\
        float box(vec3 place, float side) { vec3 q = abs(place) - side; float sum = 0.0; for (int i = 0; i < 3; i++) { sum += q[i]; } return sum * K * size; }").text;
    for name in ["param size: float", "let K = 2", "fn unite_d(a_d: float, a_id: float, b_d: float, b_id: float)", "fn unite_id", "fn box(place: vec3, side: float)", "let q =", "sum =", "for i in 0..3"] {
        assert!(written.contains(name), "{name}:\n{written}");
    }
}

#[test]
fn words_of_the_language_are_no_names() {
    let text = "float field(vec3 p) { float shape = length(p); float mix = 0.5; float time = 2.0; return mix(shape, time, mix) - 1.0; }\nfloat map(vec3 scene) { float length = length(scene); return field(scene) + length; }";
    // A variable hides the function of its name in GLSL too, from its own declaration on.
    let text = text.replace("return mix(shape, time, mix) - 1.0", "return shape * time + mix - 1.0");
    let scene = compiled(&[("main.sdf", "scene = shader(\"a.glsl\")"), ("a.glsl", &text)]);
    assert_eq!(values(&scene, &[[3.0, 0.0, 4.0]]), [5.0 * 2.0 + 0.5 - 1.0 + 5.0]);
}

#[test]
fn a_shader_is_used_in_formulas_in_shapes_and_by_import() {
    let shader = "vec2 map(vec3 p) { return vec2(length(p) - 1.0, 2.0); }\nfloat part(vec3 p, float r) { return length(p) - r; }\nfloat flat_(vec2 p) { return length(p) - 0.5; }";
    for main in [
        "scene = shader(\"a.glsl\")",
        "scene = shader(\"a.glsl\", map).translate(1, 0, 0)",
        "scene = shader(\"a.glsl\", part, 0.5) | sphere(0.2)",
        "field egg(r: float) = shader(\"a.glsl\", part, r)\nscene = egg(0.4)",
        "scene = shader(\"a.glsl\", flat_).extrude(1)",
        "import \"a.glsl\"\nfield it = map(p).x\nmaterial m { color: #d04030 * map(p).y }\nscene = it.material(m)",
        "import \"a.glsl\" as a\nfield it = a.part(p, 0.3)\nscene = it",
    ] {
        compiled(&[("main.sdf", main), ("a.glsl", shader)]);
    }
}

#[test]
fn what_is_given_from_outside_is_a_slider() {
    let shader = "uniform float size;\nuniform vec3 off;\nfloat map(vec3 p) { return length(p - off) - size - 0.1 * sin(iTime); }";
    let scene = compiled(&[("main.sdf", "scene = shader(\"a.glsl\")\nrender { extent: 5 }"), ("a.glsl", shader)]);
    let names: Vec<&str> = scene.parameters.iter().map(|parameter| parameter.name.as_str()).collect();
    assert_eq!(names, ["a.size", "a.off"]);
}

/// What is wrong, where it stands (file, line), and a piece of what is said.
const WRONG: &[(&str, &str, &str)] = &[
    ("float map(vec3 p) {\n  float t = 0.0;\n  while (true) { t += 0.1; if (t > p.x) break; }\n  return t;\n}", "a.glsl:3", "how often this loop turns"),
    ("float map(vec3 p) {\n  for (float t = 1.0; t > 0.0; t += 1.0) { p *= 0.5; }\n  return p.x;\n}", "a.glsl:2", "more than 4096"),
    ("float map(vec3 p) {\n  for (int i = 0; i < int(p.x); i++) { p *= 0.5; }\n  return p.x;\n}", "a.glsl:2", "how often this loop turns"),
    ("float map(vec3 p) {\n  float s = 0.0;\n  for (int i = 0; i < int(p.x); i++) { s += 0.5; }\n  return s;\n}", "", ""),
    ("float map(vec3 p) {\n  return texture(iChannel0, p.xy).x;\n}", "a.glsl:2", "no textures"),
    ("float map(vec3 p) {\n  return dFdx(p.x);\n}", "a.glsl:2", "pixels beside"),
    ("float map(vec3 p) {\n  uint h = uint(p.x) ^ 3u;\n  return float(h);\n}", "a.glsl:2", "bits"),
    ("float map(vec3 p) {\n  return float(floatBitsToInt(p.x));\n}", "a.glsl:2", "bits of a number"),
    ("float map(vec3 p) {\n  if (p.x > 0.0) discard;\n  return p.x;\n}", "a.glsl:2", "discard"),
    ("float map(vec3 p) {\n  return 1.0 +;\n}", "a.glsl:2", "can't be read"),
    ("float map(vec3 p) {\n  return lenght(p);\n}", "a.glsl:2", "can't be read"),
    ("float map(vec3 p) {\n  return length(p) - vec2(1.0);\n}", "a.glsl", "can't be read"),
    ("float glow = 0.0;\nfloat map(vec3 p) {\n  glow += 0.1;\n  return length(p) - glow;\n}", "a.glsl:2", "has no before"),
    ("int n() { return 2147483000; }\nfloat map(vec3 p) {\n  return float(n()) * p.x;\n}", "a.glsl:1", "too large"),
    ("float sdf(vec3 p) { return length(p); }", "main.sdf:1", "no function `map`"),
    ("float map(float x) { return x; }", "main.sdf:1", "no point first"),
    ("float map(vec3 p, float r) { return length(p) - r; }", "main.sdf:1", "r"),
    ("mat2x3 m() { return mat2x3(1.0); }\nfloat map(vec3 p) { return m()[0].x * p.x; }", "a.glsl:1", "the language has not"),
    ("", "main.sdf:1", "no function `map`"),
    ("#if 1\nfloat map(vec3 p) { return 1.0; }", "a.glsl", ""),
    ("#define A B\n#define B A\nfloat map(vec3 p) { return A; }", "a.glsl", ""),
    ("\u{0}\u{1}\u{2}", "a.glsl", ""),
];

#[test]
fn what_can_not_be_said_is_an_error_at_its_line() {
    let mut wrong = Vec::new();
    for (shader, place, words) in WRONG {
        let outcome = outcome(&[("main.sdf", "scene = shader(\"a.glsl\", map)"), ("a.glsl", shader)]);
        let errors: Vec<_> = outcome.diagnostics.iter().filter(|d| d.severity == Severity::Error).collect();
        let said = diagnostic::render(&outcome.sources, &outcome.diagnostics, false);
        let fits = |d: &&diagnostic::Diagnostic| {
            let (file, line, _) = outcome.sources.position(d.span.file, d.span.start);
            format!("{file}:{line}").starts_with(place) && d.message.contains(words)
        };
        if !errors.iter().any(|d| fits(&d)) {
            wrong.push(format!("{shader}\n{place}: {words}\n{said}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn what_would_take_too_long_or_too_deep_is_an_error() {
    let doubling: String = (0..40).map(|i| format!("#define A{i} A{} + A{}\n", i + 1, i + 1)).collect();
    for (shader, words) in [
        (format!("float map(vec3 p) {{ return {}1.0{}; }}", "(".repeat(5000), ")".repeat(5000)), "nest deeper"),
        (format!("float map(vec3 p) {{ return {}1.0; }}", "- ".repeat(5000)), "nest deeper"),
        (format!("float map(vec3 p) {{ {} p.x = 1.0; return p.x; }}", "if (p.x > 0.0) ".repeat(3000)), "nest deeper"),
        (format!("float map(vec3 p) {{ return {}1.0; }}", "p.x > 0.0 ? 2.0 : ".repeat(3000)), "nest deeper"),
        (format!("float map(vec3 p) {{ {} p.x = 1.0; return p.x; }}", "if (p.x > 0.0) p.x = 2.0; else ".repeat(1500)), "nest deeper"),
        (format!("{doubling}float map(vec3 p) {{ return A0; }}"), "macros written out"),
        (format!("#define A(x) x + x\nfloat map(vec3 p) {{ return {} 1.0 {}; }}", "A(".repeat(60), ")".repeat(60)), "macros written out"),
        (format!("float map(vec3 p) {{ return 1.0; }}\n{}", "// a line that says nothing\n".repeat(3000)), "read at most"),
        (format!("#define if_ if (p.x > 0.0)\n#define B {}\nfloat map(vec3 p) {{ {} p.x = 2.0; return p.x; }}", "if_ ".repeat(50), "B ".repeat(8)), "nest too deep"),
    ] {
        let outcome = outcome(&[("main.sdf", "scene = shader(\"a.glsl\", map)"), ("a.glsl", &shader)]);
        let said = diagnostic::render(&outcome.sources, &outcome.diagnostics, false);
        assert!(outcome.diagnostics.iter().any(|d| d.severity == Severity::Error && d.message.contains(words)), "{words}\n{}", &said[..said.len().min(2000)]);
    }
}

#[test]
fn wrong_calls_are_errors_at_their_place() {
    let shader = "float map(vec3 p) { return length(p) - 1.0; }\nfloat seen(vec3 p) { return texture(iChannel0, p.xy).x; }";
    for (main, words) in [
        ("scene = shader()", "lacks the name"),
        ("scene = shader(map)", "between quotes"),
        ("scene = shader(\"a.txt\", map)", "no shader by its name"),
        ("scene = shader(\"b.glsl\", map)", "can't be read"),
        ("scene = shader(\"a.glsl\", 3)", "name of a function"),
        ("scene = shader(\"a.glsl\", mapp)", "no function `mapp`"),
        ("scene = shader(\"a.glsl\", map, 3)", ""),
        ("import \"a.glsl\"\nfield it = seen(p)\nscene = it", "no textures"),
        ("import \"a.glsl\"\nfield it = sean(p)\nscene = it", "nothing is named"),
    ] {
        let outcome = outcome(&[("main.sdf", main), ("a.glsl", shader)]);
        let said = diagnostic::render(&outcome.sources, &outcome.diagnostics, false);
        assert!(outcome.diagnostics.iter().any(|d| d.severity == Severity::Error && d.message.contains(words)), "{main}: {words}\n{said}");
    }
}

#[test]
fn recursion_is_an_error() {
    let shader = "fn map(p: vec3f) -> f32 { return map(p * 0.5); }";
    let outcome = outcome(&[("main.sdf", "scene = shader(\"a.wgsl\", map)"), ("a.wgsl", shader)]);
    assert!(outcome.diagnostics.iter().any(|d| d.code == diagnostic::Code::Shader), "{:?}", outcome.diagnostics);
}

#[test]
fn the_step_of_a_loop_along_a_ray_is_found() {
    let step = |file: &str| {
        let (name, text) = shaders().into_iter().find(|(name, _)| name == file).unwrap();
        let (share, range) = made(&name, &text).functions.into_iter().find(|f| f.name == "map").unwrap().step?;
        Some((share, text[range].to_owned()))
    };
    assert_eq!(step("gyroid.glsl"), Some((0.8, "t += 0.8 * d".to_owned())));
    assert_eq!(step("terrain.glsl"), Some((0.2, "p += rd * h * 0.2".to_owned())));
    assert_eq!(step("blobs.glsl"), None);
}

/// Twisted towers are steep far from their axes. Each needs to be gentle about itself only, however its union is written.
#[test]
fn bodies_of_a_union_are_bounded_one_by_one() {
    let towers = "float box(vec3 p, vec3 b) { vec3 q = abs(p) - b; return length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0); }
        float tower(vec3 p) { float a = 1.2 * p.y; p.xz = mat2(cos(a), -sin(a), sin(a), cos(a)) * p.xz; return box(p, vec3(0.4, 1.5, 0.4)); }
        vec2 nearer(vec2 a, vec2 b) { return a.x < b.x ? a : b; }";
    let (left, right) = ("tower(p - vec3(2.0, 0.0, 0.0))", "tower(p + vec3(2.0, 0.0, 0.0))");
    for body in [
        format!("return min(min(p.y + 1.6, {left}), {right});"),
        format!("return 0.8 * (min(min(p.y + 1.6, {left}), {right}) - 0.05);"),
        format!("return nearer(nearer(vec2(p.y + 1.6, 1.0), vec2({left}, 2.0)), vec2({right}, 3.0)).x;"),
        format!("float d = p.y + 1.6; float a = {left}; if (a < d) {{ d = a; }} float b = {right}; if (d > b) {{ d = b; }} return d;"),
        format!("float d = {left}; float b = {right}; return max(d < b ? d : b, 0.8 - length(p));"),
    ] {
        let text = format!("{towers}\nfloat map(vec3 p) {{ {body} }}");
        let scene = compiled(&[("main.sdf", "scene = shader(\"a.glsl\")\nrender { extent: 40 }"), ("a.glsl", &text)]);
        let steepest = scene.graph.factors.iter().map(|factor| factor.lipschitz).fold(1.0, f64::max);
        assert!(steepest < 5.0, "{body}: {steepest}");
    }
}

/// Hashes of floating-point numbers, in common use: Hoskins' without sine, the one with it, and Quilez' of a place; noise of values by each.
#[test]
fn usual_hashes_and_noise_of_values_are_read() {
    for hash in [
        "vec3 q = fract(p * 0.1031); q += dot(q, q.zyx + 31.32); return fract((q.x + q.y) * q.z);",
        "return fract(sin(dot(p, vec3(12.9898, 78.233, 45.164))) * 43758.5453);",
        "p = fract(p * 0.3183099 + 0.1); p *= 17.0; return fract(p.x * p.y * p.z * (p.x + p.y + p.z));",
    ] {
        let shader = format!(
            "float hash(vec3 p) {{ {hash} }}\n\
             float noise(vec3 x) {{\n  vec3 i = floor(x), f = fract(x);\n  f = f * f * (3.0 - 2.0 * f);\n  return mix(mix(mix(hash(i), hash(i + vec3(1, 0, 0)), f.x), mix(hash(i + vec3(0, 1, 0)), hash(i + vec3(1, 1, 0)), f.x), f.y),\n    \
             mix(mix(hash(i + vec3(0, 0, 1)), hash(i + vec3(1, 0, 1)), f.x), mix(hash(i + vec3(0, 1, 1)), hash(i + vec3(1, 1, 1)), f.x), f.y), f.z);\n}}\n\
             float map(vec3 p) {{ return length(p) - 1.0 - 0.2 * noise(3.0 * p); }}"
        );
        let scene = compiled(&[("main.sdf", "scene = shader(\"a.glsl\", map).within(box(3))"), ("a.glsl", &shader)]);
        let found = values(&scene, &[[0.9, 0.3, 0.2], [0.1, -1.2, 0.4]]);
        assert!(found.iter().all(|value| value.abs() < 0.4), "{hash}: {found:?}");
    }
}
