//! The emitted text computes what the graph says: every example of the prelude and every scene, point by point, by an interpreter
//! of WGSL beside the evaluation in 64 bits.

use crate::common::Disk;
use surefoot_compiler::evaluate::Tape;
use surefoot_compiler::graph::{Function, kernel};
use surefoot_compiler::prelude::PRELUDE;
use surefoot_compiler::reference::{Reference, march::Ray};
use surefoot_compiler::{Compiled, MemoryLoader, Options, compile, emit};
use crate::wgsl::{Machine, Value};

/// Points that fill a ball evenly enough, the same on every run (the generalised golden ratio; Roberts 2018).
fn points(count: usize, half: f64) -> Vec<[f64; 3]> {
    let ratio = 1.220_744_084_605_759_5_f64;
    let part = |i: usize, k: i32| (0.5 + i as f64 / ratio.powi(k)).fract() * 2.0 - 1.0;
    (0..count).map(|i| [1, 2, 3].map(|k| f64::from((part(i, k) * half) as f32))).collect()
}

fn close(a: f64, b: f64) -> bool {
    // Literals are rounded to 32 bits, and the two round differently.
    (a - b).abs() <= 2e-5 * (1.0 + a.abs().max(b.abs()))
}

/// Compares a scene's functions at some points; the answer is what differs.
fn differences(name: &str, scene: &Compiled, half: f64, count: usize) -> Vec<String> {
    let (module, _) = emit::validate(&scene.module.wgsl).unwrap_or_else(|e| panic!("{name}: {e}"));
    let mut live = scene.live();
    live.time = 0.75;
    // As the GPU reads them.
    for value in &mut live.components {
        *value = f64::from(*value as f32);
    }
    let bytes = scene.uniform_bytes(&live, [0.0; 3]);
    let mut machine = Machine::new(&module, &bytes);
    let functions = [
        Function::Field,
        Function::Bound,
        Function::Distance,
        Function::Gradient(0),
        Function::Gradient(1),
        Function::Gradient(2),
    ];
    let mut roots: Vec<_> =
        functions.iter().map(|f| scene.functions.formulas[&(scene.root, *f)]).collect();
    let s = &scene.functions.surface;
    roots.extend(s.color.iter().chain(&s.emission).chain([&s.roughness, &s.metallic, &s.reflectivity]));
    let tape = Tape::new(&scene.graph, &scene.functions.formulas, &roots, &live, 4_000_000).unwrap();
    let points = points(count, half);
    let normal = [0.48, 0.6, 0.64];
    let mut expected = vec![Vec::new(); points.len()];
    let normals = vec![normal; points.len()];
    tape.evaluator().at(&points, &normals, |i, values| expected[i] = values.to_vec());
    let mut wrong = Vec::new();
    for (p, expected) in points.iter().zip(&expected) {
        let point = Value::vec3(*p);
        let all = |machine: &Machine| -> Vec<f64> {
            let one = |f: &str| machine.call(f, std::slice::from_ref(&point)).f();
            let mut got = vec![one("sf_field"), one("sf_bound"), one("sf_distance")];
            got.extend(&machine.call("sf_gradient", std::slice::from_ref(&point)).floats()[..3]);
            let surface = machine.call("sf_surface", &[point.clone(), Value::vec3(normal)]);
            let surface = surface.many();
            got.extend(surface[0].floats().into_iter().chain(surface[1].floats()));
            got.extend(surface[2..].iter().map(Value::f));
            got
        };
        machine.narrow = true;
        let narrow = all(&machine);
        assert!(narrow.iter().all(|x| x.is_finite()), "{name} at {p:?}: {narrow:?}");
        machine.narrow = false;
        let got = all(&machine);
        for (i, (a, b)) in got.iter().zip(expected).enumerate() {
            if !close(*a, *b) {
                wrong.push(format!("{name} at {p:?}: value {i} is {a}, not {b}"));
            }
        }
    }
    wrong
}

fn check(scenes: Vec<(String, Compiled, f64)>, count: usize) {
    let mut bad = Vec::new();
    for (name, scene, half) in scenes {
        let wrong = differences(&name, &scene, half, count);
        println!("{name:<40} {:>5} of {} differ", wrong.len(), 15 * count);
        for line in wrong.iter().take(4) {
            println!("    {line}");
        }
        // On the edge of a jump the last bit decides.
        if wrong.len() > 15 * count / 200 {
            bad.push(name);
        }
    }
    assert!(bad.is_empty(), "{bad:?}");
}

fn scene(text: &str) -> Compiled {
    let loader = MemoryLoader::new().with("main.sdf", text);
    let outcome = compile(&loader, "main.sdf", &Options::default());
    outcome.compiled.unwrap_or_else(|| panic!("{text}: {:?}", outcome.diagnostics))
}

#[test]
fn the_prelude_is_emitted_as_it_is_meant() {
    let mut scenes = Vec::new();
    for (file, text) in PRELUDE {
        for (i, line) in text.lines().enumerate() {
            let Some(example) = line.trim().strip_prefix("/// Example:") else { continue };
            let name = format!("{}:{}", file.rsplit('/').next().unwrap(), i + 1);
            // The interpreter knows no tables, in which figures stand; `tests/tests/figures.rs` holds them against their formulas.
            let scene = scene(&format!("scene = {example}"));
            if scene.module.tables.is_none() {
                scenes.push((name, scene, 2.0));
            }
        }
    }
    assert!(scenes.len() > 60);
    check(scenes, 60);
}

#[test]
fn the_examples_are_emitted_as_they_are_meant() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples");
    let mut paths: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .filter_map(|e| e.ok().map(|e| e.path()))
        .filter(|p| p.extension().is_some_and(|e| e == "sdf"))
        .collect();
    paths.sort();
    // Whether each compiles is another test's question.
    let scenes: Vec<_> = paths
        .iter()
        .filter_map(|path| {
            let outcome = compile(&Disk, path.to_str().unwrap(), &Options::default());
            let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
            // The interpreter knows no tables; what stands in them is held against its formulas by the tests of large unions.
            Some((name, outcome.compiled.filter(|compiled| compiled.module.tables.is_none())?, 4.0))
        })
        .collect();
    assert!(scenes.len() > 8);
    check(scenes, 40);
}

#[test]
fn vectors_are_put_together_from_what_is_alike_only() {
    let formulas = [
        "length((p.x + 1, p.y - 2, p.z)) - 1",
        "length((1 - p.x, 2 - p.y, p.z)) - 1",
        "length((p.x + 0.3 * sin(p.y), p.y, p.z)) * 0.5 - 1",
        "length((p.x - 0.3 * sin(p.y), p.y - 0.1, p.z + 0.2)) * 0.5 - 1",
        "length((p.x - 0.3 * sin(p.y), p.y + 0.2 * cos(p.z), p.z)) * 0.5 - 1",
        "length((2 * p.x, p.y * 2, p.z * 2)) / 2 - 1",
        "length((p.x * 2, p.y * 3, p.z)) / 3 - 1",
        "length((p.x / 2, p.y / 2, p.z / 2)) - 1",
        "length((abs(p.x) + 0.1, abs(p.y) + 0.1, abs(p.x) + 0.1)) / 2 - 0.3",
        "length(max(abs(p) - (0.5, 0.4, 0.3), 0)) + min(max(abs(p.x) - 0.5, abs(p.y) - 0.4), 0)",
        "length(p.zyx - p.xxy * 0.1) * 0.7 - 1",
        "length(-p + (0.1, -0.2, -0.3)) - 1",
        "length(p + (-0.1, -0.2, -0.3)) - 1",
        "length(if p.x < 0.2 { (p.x, 0, p.y) } else { p * 0.5 }) * 0.5 - 1",
        "length(p * p.x) * 0.1 - 1 + 0.1 * (p.x * p.x)",
        "{ let q = abs(p) - 1; let r = q * q; 0.2 * (length(r) - r.x) - 0.1 }",
        "{ let q = floor(3 * p); let r = 3 * p - q; 0.1 * (length(r - 0.5) - 0.3 + dot(r, q) * 0.01) }",
    ];
    let scenes = formulas.iter().map(|f| {
        let text = format!("field odd = {f}\nscene = odd().within(box(6))");
        ((*f).to_owned(), scene(&text), 2.0)
    });
    check(scenes.collect(), 80);
}

#[test]
fn what_is_done_again_and_again_is_computed_once_each_time() {
    // A turn about a slanting axis reads its point in three orders, and folds read numbers that are half done.
    let formulas = [
        ("fold(fold(fold(q, (1, 1, 0)), (1, 0, 1)), (0, 1, 1)) - 0.3", 30),
        ("{ let f = min(q.x + q.y, 0); let a = (q.x - f, q.y - f, q.z); let g = min(a.x + a.z, 0); (a.x - g, a.y, a.z - g) - 0.3 }", 31),
        ("rotate(abs(q) - 0.3, (1, 2, 0.5), t)", 40),
        ("{ let a = cross((1, 2, 0.5), q); 0.4 * cross(a, (0.3, 1, 0)) + 0.1 * a.zxy }", 20),
    ];
    let mut scenes = Vec::new();
    for (next, most) in formulas {
        let text = format!("param t = 0.4 in 0..1\nfield again = {{ let q = p for i in 0..6 {{ q = {next} }}; length(q) - 0.2 }}\nscene = again().within(box(3))");
        let scene = scene(&text);
        let operations = scene.module.operations.0;
        assert!(operations <= 6 * most + 16, "{next}: {operations} operations");
        scenes.push((next.to_owned(), scene, 1.5));
    }
    check(scenes, 80);
}

#[test]
fn noise_is_written_once_and_called_in_loops() {
    // Text, the functions that stand for formulas in it, and how often they are called in loops.
    let scenes = [
        ("scene = sphere(1).displace(0.2 * fbm(2 * p))", &["perlin", "fbm"][..], &[5][..]),
        // What waits for other noise stands in a loop of its own.
        ("scene = sphere(1).displace(0.1 * fbm(p + 0.3 * (fbm(p), fbm(p + 5), fbm(p + 9))))", &["perlin", "fbm"], &[5, 3]),
        // What is in a cell is written in the loop over them.
        ("scene = sphere(1).displace(0.05 * fbm(3 * p, 4) + 0.1 * cellular(2 * p))", &["perlin", "fbm", "cellular"], &[4]),
        // Of numbers that do not move by the shape's own point at all: the place in the scene, and a cell's.
        ("scene = sphere(1).displace(0.1 * fbm(2 * world, 3)).rotate(x, 0.3)", &["perlin", "fbm"], &[]),
        ("scene = for c in grid((3, 3, 3)) { sphere(0.5).displace(0.1 * fbm(c + 0.5, 3) + 0.1 * fbm(1.3 * c, 3)) }", &["perlin", "fbm"], &[2]),
        // Numbers that jump, that stay, and that are an index; where all of six move it is written out.
        ("fn strewn(v: vec3, c: vec3) = distance(v, c + hash3(c))\nscene = sphere(1).displace(0.1 * min(strewn(p, floor(2 * p)), strewn(2 * p, (1, time, 3))))", &["strewn", "strewn_b"], &[]),
        ("fn strewn(v: vec3, c: vec3) = distance(v, c + hash3(c))\nscene = for c in grid((3, 3, 3)) { sphere(0.6).displace(0.1 * min(1, (for i in 0..14 by min { strewn(p, c + i * i) }))) }", &["strewn"], &[14]),
        ("fn strewn(v: vec3, c: vec3) = distance(v, c + 0.1 * hash3(floor(c)))\nscene = sphere(1).displace(0.1 * strewn(p, 2 * p))", &[], &[]),
        // Of the plane, of space, and of space where one coordinate is always the same.
        ("scene = heightfield(0.3 * fbm(p.xz, 3) + 0.1 * fbm((p.x, 0.5, time))).within(box(4))", &["perlin", "perlin_b", "perlin_c", "fbm", "fbm_b"], &[3, 4]),
        // Many calls are several loops.
        ("scene = sphere(1).displace(0.02 * (for i in 0..40 by + { perlin(p * (1 + i / 9)) }))", &["perlin"], &[14, 12]),
        // An arm by itself, and what only one of them needs.
        ("field f = length(p) - 1 - 0.1 * (if p.x < 0.1 { fbm(2 * p, 3) } else { fbm(3 * p + fbm(p, 3), 4) })\nscene = f.within(box(4))", &["perlin", "fbm", "fbm_b"], &[3, 4]),
        // A cell's index is read as a number of its own.
        ("scene = for cell in grid((3, 3, 3)) { sphere(0.6).displace(0.1 * fbm(2 * p + cell, 3)) }", &["perlin", "fbm"], &[3]),
        // Functions of a person: of a number as it is, of one that moves, and one that jumps.
        ("fn wave(v: vec3) = { let s = 0, q = v for i in 0..4 { s = s + sin(q.x) * cos(q.y) + sin(q.z), q = 1.7 * q.yzx + 1 }; s / 8 }\nscene = sphere(1).displace(0.1 * wave(p) + 0.05 * wave(3 * p) + 0.02 * wave(p + time))", &["wave"], &[3]),
        ("fn cells(v: vec2, k: float) = { let s = 0, q = v for i in 0..4 { s = s + k * abs(floor(2 * q.x) - q.y), q = q.yx * 1.3 - 0.7 }; s / 20 }\nscene = heightfield(0.1 * cells(p.xz, 1) + 0.1 * cells(2 * p.xz, 1 + 0.1 * p.x)).within(box(3))", &["cells"], &[]),
    ];
    let mut all = Vec::new();
    for (text, functions, turns) in scenes {
        let scene = scene(text);
        let wgsl = &scene.module.wgsl;
        let is_own = |name: &&str| !name.ends_with("_gradient") && ["perlin", "fbm", "cellular", "cell_distance", "wave", "cells", "strewn"].iter().any(|own| name.starts_with(own));
        let own = wgsl.lines().filter_map(|line| line.strip_prefix("fn sf_")?.split('(').next()).filter(is_own);
        let (mut own, mut functions) = (own.collect::<Vec<_>>(), functions.to_vec());
        own.sort();
        functions.sort();
        assert_eq!(own, functions, "{text}\n{wgsl}");
        for count in turns {
            assert!(wgsl.contains(&format!(" < {count}; i")), "{text}: {count}\n{wgsl}");
        }
        all.push((text.to_owned(), scene, 1.5));
    }
    check(all, 80);
}

#[test]
fn the_hash_is_the_same_to_the_last_bit() {
    let scene = scene("scene = for cell in grid((2, 2, 2)) { sphere(0.2 + 0.3 * hash(cell)) }");
    let (module, _) = emit::validate(&scene.module.wgsl).unwrap();
    let machine = Machine::new(&module, &scene.uniform_bytes(&scene.live(), [0.0; 3]));
    for i in -300..300 {
        let x = f64::from(i);
        let args = [x, x * 77_777.0, -x * 9e6, x + 0.5];
        let got = machine.call("sf_hash", &args.map(|a| Value::F(f64::from(a as f32)))).f();
        let [a, b, c, d] = args.map(|a| f64::from(a as f32));
        assert_eq!(got, kernel::hash(a, b, c, d));
    }
}

/// Far out no digit is lost near the eye: the module's origin is there, and the way from a place is taken from it.
#[test]
fn what_is_far_out_is_as_exact_as_what_is_near() {
    for text in [
        "scene = sphere(1).translate(100000, 100000, -100000)",
        "scene = plane(y).translate(100000, 100000, -100000)",
        "scene = torus(0.8, 0.1).translate(100000, 100000, -100000)",
        "scene = link(0.8, 0.4, 0.1).translate(100000, 100000, -100000) | torus(0.8, 0.1).translate(100000, 100000, -100000)",
        "scene = smooth_union(box(1).rotate(x, 30deg), sphere(0.6).translate(0.5, 0, 0), 0.2).translate(100000, 100000, -100000)",
    ] {
        let far = scene(text);
        let near = scene(&text.replace(".translate(100000, 100000, -100000)", ""));
        assert!(far.module.wgsl.contains("let size = length(origin) + 1.0;"), "{text}");
        let value = |scene: &Compiled, origin: [f64; 3], p: [f64; 3]| {
            let (module, _) = emit::validate(&scene.module.wgsl).unwrap();
            let mut machine = Machine::new(&module, &scene.uniform_bytes(&scene.live(), origin));
            machine.narrow = true;
            machine.call("sf_field", &[Value::vec3(p)]).f()
        };
        for p in points(50, 3.0) {
            // The eye stands a little off.
            let eye = [100_003.0, 100_002.0, -99_996.0];
            let [a, b] = [value(&far, eye, [p[0] - 3.0, p[1] - 2.0, p[2] - 4.0]), value(&near, [0.0; 3], p)];
            assert!((a - b).abs() < 4e-6, "{text} at {p:?}: {a}, not {b}");
        }
    }
    // Where the point itself is read too, rays end as rounding has it.
    let both = scene("scene = sphere(1).translate(100000, 0, 0) | sphere(1)");
    assert!(both.module.wgsl.contains("length(origin + sf_uniforms.origin)"));
}

#[test]
fn rays_go_as_the_reference_goes() {
    let scene = scene(
        "scene = sphere(1).translate(0, 0.2, 0) | torus(1.6, 0.3) - box(0.7).rotate(y, 0.3).twist(y, 0.6)",
    );
    let live = scene.live();
    let (module, _) = emit::validate(&scene.module.wgsl).unwrap();
    let origin = [3.0, -2.0, 1.0];
    let machine = Machine::new(&module, &scene.uniform_bytes(&live, origin));
    let reference = Reference::new(&scene, &live).unwrap();
    let mut hits = 0;
    for target in points(150, 2.5) {
        let eye = [4.0, 3.0, -5.0];
        let to = [0, 1, 2].map(|i| target[i] - eye[i]);
        let length = to.iter().map(|c| c * c).sum::<f64>().sqrt();
        let direction = to.map(|c| c / length);
        let from = Value::vec3([0, 1, 2].map(|i| eye[i] - origin[i]));
        let ray = Ray { origin: eye, direction, t_min: 0.1, t_max: 40.0 };
        let args = |last: f64| {
            [from.clone(), Value::vec3(direction), Value::F(0.1), Value::F(40.0), Value::F(last)]
        };
        let hit = machine.call("sf_trace", &args(0.002));
        let extent = scene.blocks.extent;
        let expected = reference.trace(&[ray], 0.002, extent)[0];
        assert_eq!(hit.many()[1], Value::B(expected.hit), "{target:?}");
        assert!((hit.many()[0].f() - expected.t).abs() < 1e-4, "{target:?}: {hit:?} {expected:?}");
        hits += u32::from(expected.hit);
        for softness in [0.0, 8.0] {
            let lit = machine.call("sf_shadow", &args(softness)).f();
            let expected = reference.shadow(&[ray], softness, extent)[0];
            assert!((lit - expected).abs() < 1e-3, "{target:?}: {lit} {expected}");
        }
    }
    assert!(hits > 20 && hits < 140, "{hits}");
}
