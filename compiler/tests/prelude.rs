//! The prelude: it reads, every declaration is documented, its examples compile and what it claims is true.

use surefoot_compiler::diagnostic::render;
use surefoot_compiler::evaluate::Tape;
use surefoot_compiler::graph::Function as GraphFunction;
use surefoot_compiler::random::Random;
use surefoot_compiler::reference_text::{CHAPTERS, Entry, entries, language_reference};
use surefoot_compiler::source::Sources;
use surefoot_compiler::syntax::parse;
use surefoot_compiler::{MemoryLoader, Options, compile};

const FILES: [&str; 8] =
    ["numbers", "primitives", "drawings", "curves", "blends", "placement", "warps", "noise"];

fn text(name: &str) -> String {
    let path = format!("{}/prelude/{name}.sdf", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(path).expect("a file of the prelude")
}

fn assert_reads(name: &str, text: &str) {
    let mut sources = Sources::default();
    let file = sources.add(name, text);
    let (_, diagnostics) = parse(file, text);
    let shown: Vec<String> = diagnostics
        .iter()
        .map(|d| {
            let (n, l, c) = sources.position(d.span.file, d.span.start);
            format!("{n}:{l}:{c}: {} ({})", d.message, d.help)
        })
        .collect();
    assert!(shown.is_empty(), "{}", shown.join("\n"));
}

#[test]
fn it_reads_without_a_diagnostic() {
    for name in FILES {
        assert_reads(name, &text(name));
    }
}

#[test]
fn the_examples_read_without_a_diagnostic() {
    let folder = format!("{}/../examples", env!("CARGO_MANIFEST_DIR"));
    for folder in [folder.clone(), format!("{folder}/parts")] {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|e| e == "sdf") {
                let text = std::fs::read_to_string(&path).unwrap();
                assert_reads(&path.display().to_string(), &text);
            }
        }
    }
}

fn all_entries() -> Vec<Entry> {
    CHAPTERS.iter().flat_map(|(name, _, text)| entries(name, text)).collect()
}

#[test]
fn every_declaration_is_documented() {
    for entry in all_entries() {
        assert!(!entry.text.is_empty(), "{} has no words", entry.signature);
        assert!(!entry.source.is_empty(), "{} names no source", entry.signature);
        assert!(!entry.example.is_empty(), "{} has no example", entry.signature);
    }
}

/// `SUREFOOT_WRITE=1 cargo test -p surefoot-compiler --test compiler prelude::` writes the page anew, as `surefoot reference` does.
#[test]
fn the_reference_is_up_to_date() {
    let path = format!("{}/../docs/language.md", env!("CARGO_MANIFEST_DIR"));
    let page = language_reference();
    if std::env::var_os("SUREFOOT_WRITE").is_some() {
        std::fs::write(&path, &page).unwrap();
    }
    let written = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(written == page, "docs/language.md is not what `surefoot reference` writes");
}

/// A scene's field and bound, ready to be asked at points.
struct Probe {
    tape: Tape,
}

impl Probe {
    fn new(body: &str) -> Self {
        let text = format!("render {{ extent: 20 }}\nscene = {body}\n");
        let loader = MemoryLoader::new().with("scene.sdf", text);
        let outcome = compile(&loader, "scene.sdf", &Options::default());
        let shown = render(&outcome.sources, &outcome.diagnostics, false);
        assert!(!outcome.has_errors(), "{body}:\n{shown}");
        let compiled = outcome.compiled.unwrap();
        let formula = |f| compiled.functions.formulas[&(compiled.root, f)];
        let roots = [formula(GraphFunction::Field), formula(GraphFunction::Bound)];
        let live = compiled.live();
        let tape = Tape::new(&compiled.graph, &compiled.functions.formulas, &roots, &live, 1 << 20).unwrap();
        Self { tape }
    }

    /// Field and bound at each point.
    fn at(&self, points: &[[f64; 3]]) -> Vec<[f64; 2]> {
        let mut all = vec![[0.0; 2]; points.len()];
        self.tape.evaluator().at(points, &[], |i, v| all[i] = [v[0], v[1]]);
        all
    }
}

fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|c| c * c).sum::<f64>().sqrt()
}

fn along(p: [f64; 3], d: [f64; 3], t: f64) -> [f64; 3] {
    [0, 1, 2].map(|i| p[i] + t * d[i])
}

/// Gradients by central differences, of field and bound, where both sides agree (not across a kink or a jump).
fn gradient(probe: &Probe, p: [f64; 3]) -> [Option<[f64; 3]>; 2] {
    const H: f64 = 1e-5;
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mut points = vec![p];
    for axis in axes {
        points.extend([along(p, axis, H), along(p, axis, -H)]);
    }
    let values = probe.at(&points);
    [0, 1].map(|which| {
        let mut g = [0.0; 3];
        for i in 0..3 {
            let (a, b, c) = (values[2 * i + 1][which], values[0][which], values[2 * i + 2][which]);
            if (a - 2.0 * b + c).abs() > 1e-4 * H {
                return None;
            }
            g[i] = (a - c) / (2.0 * H);
        }
        Some(g)
    })
}

const POINTS: usize = 2_000;

/// What is convex and flatter than a distance is stepped by its gradient: that is never too far, and certified in `sound.rs`, but no Lipschitz
/// function.
const BY_GRADIENT: [&str; 3] = ["ellipsoid(", "ellipse(", ".stretch("];

/// The field is finite, no step that the bound allows crosses the surface, and the bound changes no faster than a distance.
fn assert_sound(body: &str) {
    println!("{body}");
    let probe = Probe::new(body);
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    for half in [1.3, 6.0] {
        let points: Vec<[f64; 3]> = (0..POINTS).map(|_| random.within(half)).collect();
        let values = probe.at(&points);
        for (p, [field, bound]) in points.iter().zip(&values) {
            assert!(field.is_finite() && bound.is_finite(), "{body}: {field} {bound} at {p:?}");
            assert!(
                field * bound >= 0.0 || field.abs() < 1e-6 || bound.abs() < 1e-6,
                "{body}: the field is {field} and the bound {bound} at {p:?}"
            );
        }
        let stepped: Vec<[f64; 3]> = points
            .iter()
            .zip(&values)
            .map(|(p, [_, bound])| {
                along(*p, random.direction(), 0.999 * bound.abs() * random.next().sqrt())
            })
            .collect();
        for (((p, q), a), b) in points.iter().zip(&stepped).zip(&values).zip(probe.at(&stepped)) {
            assert!(
                a[0] * b[0] >= 0.0 || b[0].abs() < 1e-6 || a[0].abs() < 1e-6,
                "{body}: from {p:?} (field {}, bound {}) a step to {q:?} crosses the surface (field {})",
                a[0],
                a[1],
                b[0]
            );
        }
        let by_gradient = BY_GRADIENT.iter().any(|name| body.contains(name));
        for p in points.iter().filter(|_| !by_gradient) {
            if let [_, Some(g)] = gradient(&probe, *p) {
                assert!(
                    length(g) < 1.0 + 2e-4,
                    "{body}: the bound's slope is {} at {p:?}",
                    length(g)
                );
            }
        }
    }
}

/// The value is the distance: its slope is 1, and that far along it lies the surface.
fn assert_exact(body: &str) {
    println!("{body}");
    let probe = Probe::new(body);
    let mut random = Random(0x1234_5678_9ABC_DEF1);
    let mut tried = 0;
    for _ in 0..POINTS {
        let p = random.within(2.0);
        let field = probe.at(&[p])[0][0];
        let [Some(g), _] = gradient(&probe, p) else { continue };
        tried += 1;
        assert!((length(g) - 1.0).abs() < 2e-4, "{body}: the slope is {} at {p:?}", length(g));
        let foot = probe.at(&[along(p, g, -field)])[0][0];
        assert!(foot.abs() < 5e-4, "{body}: {field} from {p:?} the field is {foot}");
    }
    assert!(tried > POINTS / 2, "{body}: only {tried} smooth points");
}

#[test]
fn every_example_compiles_and_is_sound() {
    let mut bodies: Vec<String> = all_entries().into_iter().map(|e| e.example).collect();
    bodies.sort();
    bodies.dedup();
    for body in bodies {
        assert_sound(&body);
    }
}

/// Solids and drawings whose value claims to be the distance, with ordinary and with odd arguments.
const EXACT: &[&str] = &[
    "sphere(0.7)",
    "plane((1, 2, -0.5), 0.3)",
    "box((1.6, 0.4, 1))",
    "box((1.6, 0, 1))",
    "rounded_box((1.6, 1, 1.2), 0.2)",
    "rounded_box((1.6, 1, 1.2), 0.9)",
    "octahedron(0.8)",
    "pyramid(1.6, 1.4)",
    "pyramid(0.6, 2)",
    "pyramid(2, 0.4)",
    "prism(3, 0.9, 1)",
    "prism(5, 0.9, 0.3)",
    "prism(6, 0.7, 2)",
    "torus(0.8, 0.3)",
    "capped_torus(0.8, 0.2, 60deg)",
    "capped_torus(0.8, 0.2, 250deg)",
    "capped_torus(0.8, 0.2, 360deg)",
    "link(0.7, 0.45, 0.17)",
    "cylinder(0.7, 1.4)",
    "cylinder((-0.7, -0.6, 0), (0.7, 0.6, 0.3), 0.4)",
    "capsule((-0.7, -0.5, 0), (0.7, 0.5, 0.3), 0.35)",
    "capsule((0.1, 0.2, 0.3), (0.1, 0.2, 0.3), 0.35)",
    "capsule(0.5, 1.8)",
    "capsule(0.5, 0.3)",
    "cone(0.8, 1.6)",
    "cone(1, 0.3)",
    "capped_cone(0.9, 0.4, 1.3)",
    "capped_cone(0.1, 1.2, 0.4)",
    "capped_cone(0.5, 0.5, 1)",
    "rounded_cone(0.6, 0.25, 1)",
    "rounded_cone(0.2, 0.7, 0.6)",
    "rounded_cone(0.9, 0.1, 0.3)",
    "box(0.5).scale(2.5).rotate((1, 2, 3), 40deg).translate(0.2, 0.1, -0.3)",
    "box((0.4, 0.3, 0.6)).mirror((1, 1, 0)).translate(0.5, 0, 0)",
    "circle(0.9).extrude(100)",
    "plane((0.5, 1), 0.2).extrude(100)",
    "rectangle((1.8, 1.1)).extrude(100)",
    "rounded_rectangle((1.8, 1.1), 0.3).extrude(100)",
    "regular_polygon(3, 1).extrude(100)",
    "regular_polygon(5, 1).extrude(100)",
    "regular_polygon(8, 1).extrude(100)",
    "star(5, 1.1, 0.5).extrude(100)",
    "star(7, 0.6, 1.1).extrude(100)",
    "star(2, 1.1, 0.2).extrude(100)",
    "polygon([(-1, -0.8), (1, -0.8), (0.4, 0), (1, 0.8), (-1, 0.8)]).extrude(100)",
    "polygon([(-1, 0.8), (1, 0.8), (0.4, 0), (1, -0.8), (-1, -0.8)]).extrude(100)",
    "segment((-0.9, -0.6), (0.9, 0.6)).extrude(100)",
    "arc(0.8, -30deg, 210deg).extrude(100)",
    "arc(0.8, 40deg, 60deg).extrude(100)",
    "arc(0.8, 60deg, -100deg).extrude(100)",
    "arc(0.8, 100deg, 460deg).extrude(100)",
    "bezier((-1, -0.6), (0, 1.4), (1, -0.6)).extrude(100)",
    "bezier((-1, -0.6), (0.01, 0.001), (1, 0.6)).extrude(100)",
    "bezier((-1, -0.6), (0, 0), (1, 0.6)).extrude(100)",
    "bezier((-1, 0), (1.5, 0.5), (-1, 0.2)).extrude(100)",
    "bezier((0.3, -1), (-2, 0.2), (0.9, 0.8)).extrude(100)",
    "segment((0.4, -0.6), (0.9, 0.6)).round(0.2).revolve()",
];

#[test]
fn what_is_exact_is_the_distance() {
    for body in EXACT {
        assert_exact(body);
    }
}

/// Formulas with a claim or a derived constant, with ordinary and with odd arguments.
const CLAIMED: &[&str] = &[
    "ellipsoid((0.15, 0.3, 1.5))",
    "box_frame((1.6, 1.2, 1.4), 0.3)",
    "superquadric((1, 0.5, 0.9), 1)",
    "superquadric((1, 0.5, 0.9), 1.4)",
    "superquadric((1, 0.5, 0.9), 3)",
    "superquadric((1, 0.5, 0.9), 60)",
    "gyroid(0.7, 0.1)",
    "schwarz_p(0.7, 0.1)",
    "heightfield(0.3 * sin(5 * p.x) * sin(4 * p.z))",
    "menger_sponge(1.6, 0)",
    "menger_sponge(2, 4)",
    "metaballs([(0, 0, 0, 1)], 0.5)",
    "metaballs([(0, 0, 0, 1), (0.1, 0, 0, 0.3), (0.2, 0.1, 0, 2), (0, 0.6, 0, 0.5)])",
    "ellipse((0.2, 1.3)).extrude(0.5)",
    "star(5, 1.1, 0.5).extrude(0.5, 0.3)",
    "(circle(0.2).translate(0.5, 0) | rectangle((0.3, 1.4))).revolve()",
    "rectangle(1.6).loft(star(5, 0.9, 0.3), 1.4)",
    "circle(0.1).sweep_helix(0.5, 0.4, 4)",
    "rectangle((0.5, 0.3)).sweep_helix(0.5, 1.5, 0.4)",
    "rectangle((0.3, 0.6)).rotate(20deg).sweep_helix(0.3, 1.2, 1.7)",
    "smooth_union(sphere(0.6), box(1).translate(0.6, 0.3, 0), 0)",
    "smooth_union(sphere(0.6), box(1).translate(0.6, 0.3, 0), 3)",
    "smooth_union(sphere(0.6), box(1).translate(0.6, 0.3, 0), 0.5 + 0.3 * sin(4 * p.x))",
    "smooth_intersection(sphere(0.9), box(1).translate(0.6, 0.3, 0), 0.4)",
    "smooth_difference(sphere(0.9), box(1).translate(0.6, 0.3, 0), 0.4)",
    "round_union(sphere(0.6), box(1).translate(0.6, 0.3, 0), 0.4)",
    "round_union(sphere(0.6), sphere(0.6).translate(0.1, 0, 0), 0.6 + 0.2 * sin(4 * p.y))",
    "round_intersection(sphere(0.9), box(1).translate(0.6, 0.3, 0), 0.4)",
    "round_difference(sphere(0.9), box(1).translate(0.6, 0.3, 0), 0.4)",
    "chamfer_union(sphere(0.6), box(1).translate(0.6, 0.3, 0), 0.4)",
    "chamfer_intersection(sphere(0.9), box(1).translate(0.6, 0.3, 0), 0.4)",
    "chamfer_difference(sphere(0.9), box(1).translate(0.6, 0.3, 0), 0.3 + 0.2 * sin(4 * p.y))",
    "stairs_union(sphere(0.6), box(1).translate(0.6, 0.3, 0), 0.6)",
    "stairs_union(sphere(0.6), box(1).translate(0.6, 0.3, 0), 0, 4)",
    "stairs_intersection(sphere(0.9), box(1).translate(0.6, 0.3, 0), 0.6, 1)",
    "stairs_difference(sphere(0.9), box(1).translate(0.6, 0.3, 0), 0.6, 7)",
    "smooth_union(round_union(sphere(0.5), box(0.7).translate(0.5, 0, 0), 0.2), torus(0.8, 0.1), 0.3)",
    "mix(sphere(0.9), box(1.4), 0.3)",
    "mix(sphere(0.9), box(1.4), saturate(p.y + 0.5)).within(box(2))",
    "xor(sphere(0.8), box(1.25))",
    "box(1).shell(0.1)",
    "box(1).offset(-0.1)",
    "box(1).round(0.1 + 0.05 * sin(9 * p.y))",
    "box((0.8, 1.8, 0.4)).twist(y, 2.5)",
    "box((0.8, 1.8, 0.4)).translate(0.5, 0, 0).twist(x, -1)",
    "box((2.2, 0.5, 0.7)).bend(z, x, 0.9)",
    "box((3, 0.5, 0.3)).bend_ring(0.8)",
    "sphere(0.3).translate(1.4, 0.2, 0.1).bend_ring(0.7)",
    "box((1.2, 1.8, 1.2)).taper(y, -0.9, 0.9, 0.3)",
    "box((1.2, 1.8, 1.2)).taper(x, -0.3, 0.5, 2)",
    "box((1.2, 1.8, 1.2)).shear(x, y, 1.5)",
    "torus(0.5, 0.2).stretch(0.5, 3, 1)",
    "torus(0.5, 0.2).elongate(0.9, 0, 0.3)",
    "box(0.5).translate(0.2, 0.1, 0).symmetry((1, 0.3, 0))",
    "box(0.5).translate(0.2, 0.1, 0).fold((1, 0.3, 0))",
    "sphere(0.3).translate(0.1, 0, 0.05).repeat((0.8, 0, 0.8))",
    "box((0.3, 0.5, 0.2)).rotate(z, 0.3).repeat(0.8, (3, 2, 4))",
    "box((0.5, 0.3, 0.2)).translate(0.8, 0.1, 0.05).repeat_polar(y, 7)",
    "box((0.5, 0.3, 0.2)).translate(0.8, 0.1, 0.05).repeat_polar(y, 1)",
    "sphere(0.8).displace(0.1 * value_noise(4 * p) + 0.05 * perlin(5 * p) + 0.03 * simplex(5 * p))",
    "heightfield(0.1 * value_noise(4 * p.xz) + 0.1 * perlin(3 * p.xz) + 0.05 * simplex(3 * p.xz))",
    "sphere(0.8).displace(0.3 * cellular(4 * p))",
    "heightfield(0.3 * cellular(4 * p.xz))",
    "sphere(0.8).displace(0.1 * fbm(3 * p, 4, 0.6, 1.9))",
    "sphere(0.8).detail(3, 0.6)",
    "box(1.3).carve(3, 0.4)",
    "heightfield(smoothstep(-0.2, 0.3, p.x) - smootherstep(0.5, 0.9, p.z))",
    "heightfield(smoothstep(0.2 * sin(3 * p.z) - 0.5, 0.5, p.x))",
    "heightfield(0.2 * asinh(9 * p.x) + triangle_wave(2 * p.z))",
    "heightfield(length8(3 * p.xz) / 3 - length_inf(p.xz))",
    "heightfield(0.4 * influence(1.7 * p, 1.1))",
];

#[test]
fn what_is_claimed_is_true() {
    for body in CLAIMED {
        assert_sound(body);
    }
}

#[test]
fn the_programs_of_the_reference_compile() {
    let page = include_str!("../src/reference_text/head.md");
    let mut tried = 0;
    for block in page.split("\n```\n").skip(1).step_by(2) {
        if block.starts_with("file ") {
            continue; // The grammar.
        }
        // What the page has declared elsewhere, where this piece does not.
        let mut text = block.to_owned();
        for (name, declaration) in [
            ("scene", "scene = sphere(1)"),
            ("gold", "material gold { color: #d4af37 }"),
            ("doric", "let doric = cylinder(0.3, 2)"),
            ("ionic", "let ionic = cylinder(0.2, 2)"),
        ] {
            let declared = ["scene", "material", "let", "param"]
                .iter()
                .any(|kind| block.contains(&format!("{kind} {name} ")));
            let used = name == "scene" || block.contains(name);
            if used && !declared && !block.contains(&format!("{name} = ")) {
                text.push_str(&format!("\n{declaration}\n"));
            }
        }
        let loader = MemoryLoader::new().with("scene.sdf", text.clone()).with("statue.obj", "").with("rock.glsl", "float map(vec3 p) { return length(p) - 1.0; }");
        let outcome = compile(&loader, "scene.sdf", &Options::default());
        let shown = render(&outcome.sources, &outcome.diagnostics, false);
        assert!(!outcome.has_errors(), "{text}\n{shown}");
        tried += 1;
    }
    assert!(tried > 12, "only {tried} pieces of program were found");
}

/// What the contract names, called as it says; `S` is a solid, `D` a drawing.
const CONTRACT: &str = "
sphere(1) | ellipsoid((1, 2, 1)) | plane(y) | plane((1, 2, 3), 0.5) | box(1) | box((1, 2, 3)) | rounded_box(1, 0.1)
box_frame(1, 0.1) | octahedron(1) | pyramid(1, 2) | prism(6, 1, 2)
torus(1, 0.2) | capped_torus(1, 0.2, 90deg) | link(1, 0.5, 0.1) | cylinder(1, 2) | cylinder((0, 0, 0), (1, 0, 0), 0.3)
capsule((0, 0, 0), (1, 0, 0), 0.3) | cone(1, 2) | capped_cone(1, 0.5, 2) | rounded_cone(1, 0.5, 2)
superquadric((1, 1, 2), 4) | gyroid(1, 0.1) | schwarz_p(1, 0.1) | heightfield(0.1 * sin(p.x)) | menger_sponge(1, 2)
metaballs([(0, 0, 0, 1), (0.5, 0, 0, 1)]) | metaballs([(0, 0, 0, 1)], threshold: 0.3)
(circle(1) | ellipse((1, 2)) | rectangle((1, 2)) | rounded_rectangle((1, 2), 0.1) | regular_polygon(5, 1)).extrude(1)
(star(5, 1, 0.5) | polygon([(0, 0), (1, 0), (0, 1)]) | segment((0, 0), (1, 1)).round(0.1)).extrude(1, 0.1)
(arc(1, 0, 90deg).round(0.1) | bezier((0, 0), (1, 1), (2, 0)).round(0.1)).extrude(1, bevel: 0.1)
union(S, box(1)) | intersection(S, box(1)) | difference(S, box(1)) | xor(S, box(1))
smooth_union(S, box(1), 0.1) | smooth_intersection(S, box(1), 0.1) | smooth_difference(S, box(1), 0.1)
round_union(S, box(1), 0.1) | round_intersection(S, box(1), 0.1) | round_difference(S, box(1), 0.1)
chamfer_union(S, box(1), 0.1) | chamfer_intersection(S, box(1), 0.1) | chamfer_difference(S, box(1), 0.1)
stairs_union(S, box(1), 0.1) | stairs_intersection(S, box(1), 0.1, 3) | stairs_difference(S, box(1), 0.1, steps: 5)
smooth_union(D, circle(1), 0.1).extrude(1) | S.smooth_union(box(1), 0.1)
mix(S, box(1), 0.5) | S.round(0.1) | S.shell(0.1) | S.offset(-0.1) | S.within(box(1)) | nothing
D.mix(circle(1), 0.5).round(0.1).shell(0.1).offset(0.1).within(circle(2)).extrude(1)
S.translate(1, 2, 3).rotate(x, 30deg).scale(2).stretch(1, 2, 1).shear(x, y, 0.5).mirror(x).symmetry(y).matrix(mat3(1))
D.translate(1, 2).rotate(30deg).scale(2).stretch(1, 2).mirror((1, 0)).symmetry((0, 1)).extrude(1)
S.matrix(mat4(1)).twist(y, 1).bend(z, x, 0.2).taper(y, -1, 1, 0.5).displace(0.1 * sin(p.x)).within(box(3))
box((4, 0.2, 0.2)).bend_ring(1) | S.repeat((4, 0, 4)) | S.repeat(4, 3) | S.repeat((4, 4, 4), (3, 1, 2)) | S.repeat_polar(y, 3)
D.extrude(1) | D.extrude(1, 0.1) | D.revolve() | S.elongate(1, 0, 0) | D.loft(circle(1), 2) | circle(0.1).sweep_helix(1, 0.5, 3)
sphere(hash(3)) | sphere(hash((1, 2, 3), seed: 4)) | box((hash2((1, 2)), 1)) | box(hash3((1, 2, 3), 5))
S.displace(0.01 * (value_noise(p) + value_noise(p.xz) + perlin(p) + perlin(p.xz) + simplex(p) + simplex(p.xz)))
S.displace(0.01 * (cellular(p) + cellular(p.xz) + fbm(p) + fbm(p.xz, 4) + fbm(p, octaves: 3, gain: 0.4, lacunarity: 2.1)))
S.detail(2, 0.5) | S.carve(2, 0.5) | (for i in 0..3 by smooth_union(0.1) { sphere(0.5).translate(i, 0, 0) })
S.displace(smooth_union(p.x, p.y, 0.1) / 9 + length(rotate(translate(p, (1, 0, 0)), y, 1)) / 99 + S.at(twist(p, y, 0.1)) / 99)
S.displace((length(scale(p, 2)) + length(stretch(p, (1, 2, 3))) + length(elongate(p, (1, 0, 0))) + length(mirror(p, x))) / 99)
S.displace(round(0.1) + mix(0.1, 0.2, 0.5) + length1(p) / 99 + length8(p) / 99 + length_inf(p) / 99 + clamp(p.x, 0, 0.1))
";

#[test]
fn what_the_contract_names_is_there() {
    for body in CONTRACT.trim().lines() {
        let text = format!("let S = sphere(0.5)\nlet D = rectangle(0.8)\nscene = {body}\n");
        let loader = MemoryLoader::new().with("scene.sdf", text.clone());
        let outcome = compile(&loader, "scene.sdf", &Options::default());
        let shown = render(&outcome.sources, &outcome.diagnostics, false);
        assert!(!outcome.has_errors(), "{text}\n{shown}");
    }
}

/// Arguments that can't be, each of which the documentation rules out.
const WRONG: &[&str] = &[
    "sphere(-1)",
    "ellipsoid((1, 0, 1))",
    "box((1, -1, 1))",
    "rounded_box(1, -0.1)",
    "prism(2, 1, 1)",
    "torus(1, -0.1)",
    "cylinder(-1, 2)",
    "capsule((0, 0, 0), (1, 0, 0), -0.1)",
    "superquadric(1, 0.5)",
    "gyroid(0, 0.1)",
    "star(1, 1, 0.5).extrude(1)",
    "arc(-1, 1, 0).extrude(1)",
    "polygon([(0, 0), (1, 1)]).extrude(1)",
    "circle(1).extrude(-1)",
    "smooth_union(sphere(1), box(1), -0.1)",
    "sphere(1).scale(0)",
    "sphere(1).stretch(1, 0, 1)",
    "sphere(1).taper(y, 1, 1, 0.5)",
    "sphere(1).taper(y, 0, 1, 0)",
    "sphere(1).round(-0.1)",
    "box(1).bend_ring(0)",
    "sphere(1).rotate((0, 0, 0), 1)",
    "sphere(1).repeat_polar(y, 0)",
    "menger_sponge(0, 1)",
    "circle(0.1).sweep_helix(1, 0, 2)",
];

#[test]
fn what_can_not_be_is_an_error() {
    for body in WRONG {
        let loader = MemoryLoader::new().with("scene.sdf", format!("scene = {body}\n"));
        let outcome = compile(&loader, "scene.sdf", &Options::default());
        assert!(outcome.has_errors(), "{body} compiles");
        let names: Vec<&str> = outcome.diagnostics.iter().map(|d| d.code.row().name).collect();
        assert!(names.contains(&"bad-value"), "{body}: {names:?}");
    }
}
